//! The examples and errors of `docs/lens-format.md`: every example is a lens, and every text of the table of errors
//! is refused as documented.

use realistic_optics::prescription::{Blades, Coating, Medium, Prescription, Shape, SurfaceCoating, read};

const TEXT: &str = include_str!("../../docs/lens-format.md");

/// Returns the blocks that are marked as lenses.
fn lenses() -> Vec<Prescription> {
    let blocks = TEXT.split("```lens\n").skip(1).map(|rest| rest.split("```").next().expect("its end"));
    blocks
        .map(|text| read("example", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}")))
        .collect()
}

#[test]
fn every_example_is_a_lens() {
    let lenses = lenses();
    let [
        double_gauss,
        two,
        eye,
        doublet,
        flint,
        silica,
        singlet,
        squeeze,
        telescope,
        fold,
        iris,
        coated,
        window,
        zoom,
    ] = lenses.as_slice()
    else {
        panic!("{}", lenses.len())
    };
    assert!(lenses.iter().all(|lens| lens.title.is_some() && lens.remarks.is_empty()));
    assert_eq!(
        double_gauss.interfaces,
        realistic_optics::prescription::catalogue::find("dgauss.50mm").expect("listed").interfaces
    );
    assert_eq!((two.interfaces.len(), two.stop_index()), (5, Some(2)));
    assert_eq!(eye.image_medium(), Medium::Glass { n_d: 1.3377, abbe: None });
    assert_eq!(doublet.glasses.len(), 2);
    let absorbs = flint.transmittances()[0].clone().expect("what its line says");
    assert!((absorbs.coefficient(400.0) * 25.0 + 0.61_f64.ln()).abs() < 1e-3);
    assert_eq!(silica.wavelength, Some(248.0));
    assert!(matches!(singlet.interfaces[1].shape, Shape::Asphere(asphere) if asphere.conic == -2.25));
    assert!(!squeeze.is_centred() && squeeze.film_break.is_none());
    let mirrors =
        |lens: &Prescription| lens.interfaces.iter().filter(|interface| interface.is_mirror).count();
    assert_eq!((mirrors(telescope), telescope.is_centred()), (2, true));
    assert_eq!((mirrors(fold), fold.film_break.is_some(), fold.nominal_film_distance), (1, true, Some(19.0)));
    assert_eq!(iris.blades(), Some(Blades { count: 7, rotation: 12.0, curvature: 0.25 }));
    let quarter = SurfaceCoating::Named { coating: Coating::QuarterWave, wavelength: 520.0 };
    assert_eq!(coated.coatings, Some(vec![quarter.clone(), quarter.clone(), quarter, Coating::Bare.into()]));
    // Layers of a quarter, a half and a quarter wave at 550 nm are the definition of this name.
    let stack = window.coatings.as_ref().map(|own| own[0].from_air()).expect("a stack");
    let named = SurfaceCoating::from(Coating::ThreeLayer).from_air();
    assert_eq!(stack.len(), named.len());
    for (own, named) in stack.iter().zip(&named) {
        assert!(own.index == named.index && (own.thickness - named.thickness).abs() < 0.01);
    }
    let positions = zoom.positions.as_ref().expect("four");
    assert_eq!((positions.columns.len(), positions.gaps.as_slice()), (4, [1, 4].as_slice()));
    assert_eq!(positions.columns[2].object_distance, Some(400.0));
    let layout = positions.layout();
    assert_eq!((layout.zooms, layout.steps), (2, 2));
}

#[test]
fn every_documented_error_refuses_its_text() {
    let (_, section) = TEXT.split_once("## What is refused").expect("the section");
    let (section, _) = section.split_once("\n## ").expect("the next section");
    let rows =
        section.lines().filter_map(|line| line.strip_prefix("| `")?.strip_suffix(" |")?.split_once("` | "));
    let mut count = 0;
    for (text, message) in rows {
        let error = read("file", text.replace(" / ", "\n").as_bytes()).expect_err(text).to_string();
        let mut rest = error.as_str();
        for part in message.split('…') {
            let at = rest.find(part).unwrap_or_else(|| panic!("{text}: {error:?} lacks {part:?}"));
            rest = &rest[at + part.len()..];
        }
        count += 1;
    }
    assert!(count >= 20, "{count}");
}
