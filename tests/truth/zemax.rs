//! Zemax files with the meaning that Zemax gives them: small files with correct values from closed forms and from
//! traces by hand, and the list of every statement's fate.

use realistic_optics::{
    imaging::moving::MovingGroups,
    lens::{Lens, first_order::FirstOrder},
    prescription::{Aperture, Fate, Outline, Prescription, Shape, read},
    trace::{Direction, Path, Ray},
};

use super::support::by_kernel;

/// A biconvex lens of index 1.5, whose stop is the first surface, with f = 50.675676 mm.
const SINGLET: &str = "MODE SEQ\nUNIT MM X W X CM MR CPMM\nENPD 10\nFTYP 0 0 1 1 0 0 0\nXFLN 0\nYFLN 10\nWAVM 1 0.58756 1\nPWAV 1\n\
    SURF 0\n  TYPE STANDARD\n  CURV 0\n  DISZ INFINITY\n\
    SURF 1\n  STOP\n  TYPE STANDARD\n  CURV 0.02\n  DISZ 4\n  GLAS ___BLANK 1 0 1.5 0 0\n  DIAM 8 1\n\
    SURF 2\n  TYPE STANDARD\n  CURV -0.02\n  DISZ 48\n  DIAM 8 1\n\
    SURF 3\n  CURV 0\n  DISZ 0\n";

/// Returns [`SINGLET`] with some of its texts replaced; each of these texts occurs once.
fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SINGLET.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

#[track_caller]
fn lens(text: &str) -> Prescription {
    read("lens.zmx", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(text: &str, parts: &[&str]) {
    let message = read("lens.zmx", text.as_bytes()).expect_err("refused").to_string();
    for part in parts {
        assert!(message.contains(part), "{message} lacks {part:?}");
    }
}

fn optics(lens: &Prescription) -> FirstOrder {
    FirstOrder::of(&Lens::at_own_wavelength(lens)).expect("focal")
}

#[track_caller]
fn near(found: f64, right: f64, most: f64) {
    assert!((found - right).abs() <= most, "{found} is not {right}");
}

fn stop_diameter(lens: &Prescription) -> f64 {
    2.0 * lens.interfaces[lens.stop_index().expect("a stop")].semi_diameter
}

/// Returns the only finding of a statement.
#[track_caller]
fn fate<'a>(lens: &'a Prescription, statement: &str) -> (Fate, Vec<usize>, &'a str) {
    let found: Vec<_> = lens.findings.iter().filter(|own| own.statement == statement).collect();
    let [one] = found[..] else { panic!("{statement}: {found:?}") };
    (one.fate, one.lines(), &one.reason)
}

/// Traces a ray that is parallel to the axis at a given height through the last surface, by the walk and in lanes of
/// two precisions. Returns the ray's crossings with the axis relative to the last vertex.
fn crossings(lens: &Prescription, height: f64) -> [f64; 3] {
    let lens = Lens::at_own_wavelength(lens);
    let ray = Ray { origin: [0.0, height, 40.0], direction: [0.0, 0.0, -1.0] };
    let walked = Path::<f64>::scene_to_film(&lens).trace(ray).expect("passes");
    let double = by_kernel::<f64>(&lens, Direction::SceneToFilm, &[ray])[0].expect("passes");
    let single = by_kernel::<f32>(&lens, Direction::SceneToFilm, &[ray])[0].expect("passes");
    let rear = lens.rear().vertex;
    [walked, double, single].map(|ray| {
        let t = -ray.origin[1] / ray.direction[1];
        rear - (ray.origin[2] + t * ray.direction[2])
    })
}

#[track_caller]
fn cross_at(lens: &Prescription, height: f64, right: f64) {
    let [walked, double, single] = crossings(lens, height);
    near(walked, right, 1e-8);
    near(double, right, 1e-8);
    near(single, right, 2e-3);
}

/// Traces a meridional ray that is parallel to the axis at `height` through the singlet with the front figure z(r). It
/// shares no code with the library: it uses bisection for the intersection, a difference for the slope, and Snell's law
/// by angles.
fn by_hand(front: impl Fn(f64) -> f64, height: f64) -> f64 {
    let z = front(height);
    let h = 1e-5;
    let normal = ((front(height + h) - front(height - h)) / (2.0 * h)).atan();
    // Angles of the ray are measured below the direction of the axis.
    let bend = normal - (normal.sin() / 1.5).asin();
    let rear = |r: f64| 4.0 - (50.0 - (2500.0 - r * r).sqrt());
    let (mut low, mut high) = (0.0, 20.0);
    for _ in 0..200 {
        let t = f64::midpoint(low, high);
        let r = height - t * bend.tan();
        if z + t < rear(r) { low = t } else { high = t }
    }
    let r = height - low * bend.tan();
    let normal = -(r / 50.0).asin();
    let out = normal + (1.5 * (bend - normal).sin()).asin();
    rear(r) - 4.0 + r / out.tan()
}

fn sphere(r: f64) -> f64 {
    50.0 - (2500.0 - r * r).sqrt()
}

#[test]
fn terms_of_an_extended_asphere_may_be_parameters() {
    let text = with(&[
        ("ENPD 10", "ENPD 16"),
        ("TYPE STANDARD\n  CURV 0.02", "TYPE XASPHERE\n  CURV 0.02\n  PARM 1 0\n  PARM 2 1e-5"),
    ]);
    cross_at(&lens(&text), 7.0, 45.399792082);
    near(by_hand(|r| sphere(r) + 1e-5 * r.powi(4), 7.0), 45.399792082, 1e-5);
    cross_at(&lens(&text.replace("XASPHERE", "EVENASPH")), 7.0, 45.399792082);
    let odd = text.replace("XASPHERE", "XOSPHERE").replace("PARM 2", "PARM 4");
    cross_at(&lens(&odd), 7.0, 45.399792082);
    cross_at(&lens(&with(&[("ENPD 10", "ENPD 16")])), 7.0, 47.730694806);
}

#[test]
fn terms_to_the_thirtieth_power_are_read_as_the_file_counts() {
    let extended = |count: u32, term: &str| {
        let data = format!("TYPE XASPHERE\n  CURV 0.02\n  XDAT 1 {count} 0 0\n  XDAT 2 1 0 0\n  XDAT {term}");
        with(&[("ENPD 10", "ENPD 16"), ("TYPE STANDARD\n  CURV 0.02", &data)])
    };
    // The terms r^22 and r^30 amount to 0.5 and 0.02 mm at 7 mm.
    for (term, power, size) in [("13 1e-19", 22, 1e-19), ("17 1e-27", 30, 1e-27)] {
        let right = by_hand(|r| sphere(r) + size * r.powi(power), 7.0);
        let [walked, double, single] = crossings(&lens(&extended(15, term)), 7.0);
        near(walked, right, 1e-4 * right);
        near(double, walked, 1e-9);
        near(single, walked, 2e-2);
        assert!((right - 47.730694806).abs() > 0.5, "{right}");
    }
    let sharp = with(&[
        (
            "TYPE STANDARD\n  CURV 0.02",
            "TYPE XASPHERE\n  CURV 0.02\n  XDAT 1 11 0 0\n  XDAT 2 1 0 0\n  XDAT 4 1e-6\n  XDAT 13 1e-30",
        ),
        ("1 0 1.5 0 0", "1 0 1.6 60"),
        ("DIAM 8 1", "DIAM 10 1"),
    ]);
    near(optics(&lens(&sharp)).focal_length, 42.3012, 1e-4);
    // Only one term is declared, and this is the second.
    let stale = lens(&extended(1, "4 1e-4"));
    assert_eq!(stale.interfaces[0].shape, Shape::Sphere { radius: 50.0 });
    assert!(
        stale
            .findings
            .iter()
            .any(|own| own.fate == Fate::LeftOut && own.statement == "XDAT" && own.lines() == [19])
    );
    refused(&extended(20, "18 1e-40"), &["surface 1 has a term of r^32", "r^1 to r^30 are traced"]);
    let cone = "TYPE ODDASPHE\n  CURV 0.02\n  PARM 1 -3.142e-3\n  PARM 2 3.867e-3\n  PARM 3 -1.602e-4";
    let cone = with(&[("TYPE STANDARD\n  CURV 0.02", cone)]);
    let Shape::Asphere(figure) = lens(&cone).interfaces[0].shape else { panic!("an asphere") };
    assert_eq!([1, 2, 3].map(|power| figure.term(power)), [-3.142e-3, 3.867e-3, -1.602e-4]);
}

#[test]
fn the_stop_has_a_size_for_each_configuration() {
    let text = with(&[("ENPD 10", "FLOA"), ("DIAM 8 1", "DIAM 5 1")])
        + "MNUM 2 1\nSDIA 1 1 5 0 0\nSDIA 1 2 2.5 0 0\nTHIC 2 1 48 0 0\nTHIC 2 2 50 0 0\n";
    let read = lens(&text);
    let columns = &read.positions.as_ref().expect("two").columns;
    assert_eq!(
        columns.iter().map(|column| column.stop_diameter).collect::<Vec<_>>(),
        [Some(10.0), Some(5.0)]
    );
    let groups = MovingGroups::of(&read).expect("positions");
    for (position, fnumber) in [5.067568, 10.135135].into_iter().enumerate() {
        let travel = groups.position(position);
        let placed = travel.at(travel.start());
        near(optics(&placed).focal_length / stop_diameter(&placed), fnumber, 1e-6);
    }
    assert!(read.remarks.is_empty(), "{:?}", read.remarks);
    // Another aperture in the file determines the stop.
    let by_pupil = lens(&text.replace("FLOA", "ENPD 8"));
    near(stop_diameter(&by_pupil), 8.0, 1e-12);
    assert!(by_pupil.remarks[0].contains("operand SDIA changes the lens in a way that is not followed"));
}

#[test]
fn an_aperture_of_the_stop_narrows_the_beam() {
    let read = lens(&with(&[("DIAM 8 1\n", "DIAM 8 1\n  CLAP 0 4 0\n")]));
    near(stop_diameter(&read), 8.0, 1e-12);
    near(optics(&read).focal_length / stop_diameter(&read), 6.334459, 1e-6);
    let wide = lens(&with(&[("DIAM 8 1\n", "DIAM 8 1\n  CLAP 0 7 0\n")]));
    near(stop_diameter(&wide), 10.0, 1e-12);
}

#[test]
fn apertures_that_are_not_read_are_refused_by_name() {
    let rear = |line: &str| with(&[("DIAM 8 1\nSURF 3", &format!("DIAM 8 1\n  {line}\nSURF 3"))]);
    for (line, what) in [
        ("OBSC 1 2 0", "an obscuration that is a ring (OBSC 1 2 0)"),
        ("ELAP 3 9 0", "an elliptical aperture"),
        ("SPID 0.5 3", "the vanes of a spider"),
        ("SQOB 1 1 0", "a rectangular obscuration"),
        ("ELOB 1 1 0", "an elliptical obscuration"),
        ("UDAP 0", "an aperture of the user's own"),
        ("USAP 0", "an aperture whose outline is in another file (USAP 0)"),
        ("OBDC 0 2", "a decentring without an aperture (OBDC 0 2)"),
    ] {
        refused(&rear(line), &["surface 2 has", what, "which is not traced"]);
    }
    refused(
        &rear("SCBD 0 0 0 0 0 5 0 0"),
        &[
            "surface 2 has a tilt or decentring (SCBD 0 0 0 0 0 5 0 0) on a side that is neither 1, before it, nor 2",
        ],
    );
    let moved = lens(&rear("SCBD 1 0 0 1 0 0 0 0")).interfaces[1].coordinate_break;
    assert_eq!(moved.map(|change| change.shift), Some([1.0, 0.0, 0.0]));
    // Statements without an effect are accepted.
    for line in ["OBSC 0 0 0", "CLAP 0 6 0\n  OBDC 0 0", "SCBD 1 0 0 0 0 0 0 0"] {
        assert!(lens(&rear(line)).remarks.is_empty(), "{line}");
    }
    let around = lens(&rear("SQAP 9 9 0"));
    assert_eq!(around.interfaces[1].semi_diameter, 8.0);
    assert_eq!(fate(&around, "SQAP").0, Fate::Replaced);
}

#[test]
fn shaped_apertures_are_read() {
    let rear = |line: &str| lens(&with(&[("DIAM 8 1\nSURF 3", &format!("DIAM 8 1\n  {line}\nSURF 3"))]));
    let shapes = |line: &str| {
        let read = rear(line);
        assert!(read.remarks.is_empty(), "{line}: {:?}", read.remarks);
        (read.interfaces[1].semi_diameter, read.interfaces[1].apertures.to_vec())
    };
    let circle = |radius: f64, center: [f64; 2], is_obstruction: bool| Aperture {
        outline: Outline::Ellipse([radius; 2]),
        center,
        rotation: 0.0,
        is_obstruction,
    };
    assert_eq!(shapes("CLAP 2 6 0"), (6.0, vec![circle(2.0, [0.0; 2], true)]));
    assert_eq!(shapes("OBSC 0 2 0"), (8.0, vec![circle(2.0, [0.0; 2], true)]));
    assert_eq!(shapes("OBSC 5 9 0"), (5.0, vec![]));
    assert_eq!(shapes("CLAP 0 3 0\n  OBDC 0 2"), (5.0, vec![circle(3.0, [0.0, 2.0], false)]));
    let rectangle = Aperture::centered(Outline::Rectangle([3.0, 1.5]));
    assert_eq!(shapes("SQAP 3 1.5 0"), (3.0_f64.hypot(1.5), vec![rectangle]));
    let triangle: &[[f64; 2]] = &[[1.0, 0.0], [0.0, 3.0], [-1.0, 0.0]];
    let polygon = Aperture::centered(Outline::Polygon(triangle.into()));
    let lines =
        "USAP 0\n  UDAD 0 \"own.uda\" 1\n  UDAD 1 1 0 0\n  UDAD 1 0 3 0\n  UDAD 1 -1 0 0\n  UDAD 1 0 0 0";
    assert_eq!(shapes(lines), (3.0, vec![polygon]));
    for (line, why) in [
        ("UDAD 1 1 0 0\n  UDAD 1 0 3 0", "of fewer than three vertices"),
        ("UDAD 1 1 0 2", "with an edge that is not straight"),
        ("UDAD 1 0 0 0\n  UDAD 1 1 0 0", "with more than one outline"),
    ] {
        refused(&with(&[("DIAM 8 1\nSURF 3", &format!("DIAM 8 1\n  {line}\nSURF 3"))]), &[why]);
    }
}

#[test]
fn object_and_image_may_be_in_media() {
    let in_front = |glass: &str| with(&[("DISZ INFINITY", &format!("DISZ INFINITY\n  GLAS {glass}"))]);
    let water = lens(&in_front("___BLANK 1 0 1.33 0 0"));
    assert!(water.remarks.is_empty(), "{:?}", water.remarks);
    assert_eq!(fate(&water, "GLAS").0, Fate::Used);
    near(optics(&water).rear_focal_length(), 75.135243438, 1e-9);
    near(optics(&water).back_focal_distance(), 74.454017231, 1e-9);
    near(stop_diameter(&water), 10.0, 1e-12);
    near(optics(&lens(&in_front("___BLANK 1 0 1 0 0"))).focal_length, 50.675676, 1e-6);
    refused(&in_front("UNKNOWN 0 0 1.33 0 0"), &["lens.zmx:13:8", "glass \"UNKNOWN\" is not known"]);
    // The f-numbers are those of 1/φ over the entrance pupil, and the numerical aperture has the index of the medium.
    let aperture = |aperture: &str| in_front("___BLANK 1 0 1.33 0 0").replace("ENPD 10", aperture);
    near(stop_diameter(&lens(&aperture("FNUM 5 0"))), 75.135243438 / 5.0, 1e-9);
    let close = aperture("OBNA 0.03 0").replace("DISZ INFINITY", "DISZ 100");
    near(stop_diameter(&lens(&close)), 200.0 * (0.03_f64 / 1.33).asin().tan(), 1e-9);
    // Behind the last surface the film's medium begins: glass on the last row but one.
    let behind = lens(&with(&[("DISZ 48", "DISZ 48\n  GLAS ___BLANK 1 0 1.336 0 0")]));
    let [first, second] = [0.5 * 0.02, (1.336 - 1.5) * -0.02];
    let power = first + second - first * second * 4.0 / 1.5;
    near(optics(&behind).focal_length, 1.0 / power, 1e-9);
    near(optics(&behind).back_focal_distance(), 1.336 / power * (1.0 - first * 4.0 / 1.5), 1e-9);
}

#[test]
fn apertures_of_the_object_and_of_the_image_give_the_stop() {
    let close = |aperture: &str| lens(&with(&[("ENPD 10", aperture), ("DISZ INFINITY", "DISZ 100")]));
    near(stop_diameter(&close("OBNA 0.5 1")), 1.745374, 1e-6);
    near(stop_diameter(&close("OBNA 0.03 0")), 200.0 * 0.03 / (1.0_f64 - 0.0009).sqrt(), 1e-9);
    near(stop_diameter(&close("FNUM 4 1")), 25.0, 1e-6);
    near(stop_diameter(&close("FNUM 4 0")), 50.675676 / 4.0, 1e-6);
    let distant = lens(&with(&[("ENPD 10", "FNUM 10 1")]));
    near(stop_diameter(&distant), 5.0675676, 1e-6);
    refused(&with(&[("ENPD 10", "OBNA 95 1")]), &["OBNA 95 is not an aperture"]);
}

#[test]
fn a_file_numbered_from_1_has_no_object() {
    let surfaces = "SURF 1\n  STOP\n  CURV 0.02\n  DISZ 4\n  GLAS ___BLANK 1 0 1.5 0 0\n  DIAM 8 1\nSURF 2\n  CURV -0.02\n  DISZ 5\n  \
                DIAM 8 1\nSURF 3\n  CURV 0.01\n  DISZ 4\n  GLAS ___BLANK 1 0 1.6 0 0\n  DIAM 8 1\nSURF 4\n  CURV -0.01\n  DISZ 30\n  \
                DIAM 8 1\n";
    let text = format!("UNIT MM\nENPD 10\nWAVM 1 0.58756 1\n{surfaces}SURF 5\n  CURV 0\n  DISZ 0\n");
    let read = lens(&text);
    near(optics(&read).focal_length, 33.495661, 1e-6);
    assert_eq!((read.interfaces.len(), read.nominal_film_distance), (4, Some(30.0)));
    assert!(read.remarks[0].contains("no surface 0, the object's"), "{:?}", read.remarks);
    // There is no image surface; operands keep the file's numbers.
    let bare =
        lens(&format!("UNIT MM\nENPD 10\nWAVM 1 0.58756 1\n{surfaces}MNUM 2 1\nTHIC 2 1 5\nTHIC 2 2 6\n"));
    assert_eq!(bare.interfaces, read.interfaces);
    assert_eq!(bare.positions.expect("two").gaps, [1]);
}

#[test]
fn every_operand_is_followed_or_named() {
    let zoom = |operands: &str| {
        let text = with(&[("TYPE STANDARD\n  CURV 0.02", "TYPE EVENASPH\n  CURV 0.02\n  PARM 2 1e-5")]);
        lens(&format!("{text}MNUM 2 1\nTHIC 2 1 48 0 0\nTHIC 2 2 50 0 0\n{operands}"))
    };
    for key in [
        "PAR1", "PAR2", "PAR8", "PRAM", "CRVT", "CONN", "GLSS", "APMX", "APMN", "APTP", "APDX", "CADX",
        "CATX", "CBDX", "CBTX", "TEMP", "PRES", "CPCN", "SDIA", "IGNR", "STPS", "XYZW",
    ] {
        let lens = zoom(&format!("{key} 2 1 1e-5 0 0\n{key} 2 2 5e-5 0 0\n"));
        let [remark] = lens.remarks.as_slice() else { panic!("{key}: {:?}", lens.remarks) };
        let named = format!("operand {key} changes the lens in a way that is not followed");
        assert!(
            remark.contains(&named) && remark.ends_with("(and one more such warning, on line 33)"),
            "{remark}"
        );
        assert_eq!(fate(&lens, key).0, Fate::LeftOut);
    }
    // In a file with a single configuration, the operand's value differs from that in the surface's own line.
    let one = zoom("PAR2 1 2 5e-5 0 0\n");
    assert!(one.remarks[0].contains("operand PAR2 changes the lens"), "{:?}", one.remarks);
    let same = zoom("GLSS 1 1 X\nGLSS 1 2 X\nYFIE 1 1 10\nYFIE 1 2 5\nMOFF 0 1 \"\" 0\n");
    assert!(same.remarks.is_empty(), "{:?}", same.remarks);
    assert_eq!([fate(&same, "GLSS").0, fate(&same, "YFIE").0], [Fate::Used, Fate::Informative]);
}

#[test]
fn messages_say_what_a_surface_or_a_glass_is() {
    for kind in ["QED_TYPE", "SUPERCON", "BINARY_2", "FRESNEL", "ABCD"] {
        let text = with(&[("TYPE STANDARD\n  CURV 0.02", &format!("TYPE {kind}\n  CURV 0.02"))]);
        refused(
            &text,
            &[kind, "which is not read; read are STANDARD, EVENASPH, ODDASPHE, XASPHERE, XOSPHERE"],
        );
    }
    refused(&with(&[("1 0 1.5 0 0", "1 0 -1 0 0")]), &["surface 1 is a mirror"]);
    refused(
        &with(&[("1 0 1.5 0 0", "1 0 1,5168 0 0")]),
        &["18:21", "\"1,5168\" is not a number: its decimal point is a comma; write 1.5168"],
    );
}

#[test]
fn spacing_is_free() {
    let unindented = SINGLET.replace("\n  ", "\n");
    near(optics(&lens(&unindented)).focal_length, 50.675676, 1e-6);
    let zoom = "MNUM 2 1\nTHIC 2 1 48 0 0\nTHIC 2 2 50 0 0\n";
    assert_eq!(lens(&(unindented + zoom)).positions.expect("two").columns.len(), 2);
    // The format of another program has a blank before each line, and several blanks after SURF.
    let spaced = SINGLET
        .replace("1 0 1.5 0 0", "1 0 1.6 60")
        .replace("DISZ 48", "DISZ 40")
        .replace("SURF ", "SURF   ");
    let spaced: String = spaced.lines().map(|line| format!(" {line}\n")).collect();
    let read = lens(&spaced);
    near(optics(&read).focal_length, 42.3012, 1e-4);
    near(optics(&read).back_focal_distance(), 41.0322, 1e-4);
    assert_eq!(read.nominal_film_distance, Some(40.0));
}

#[test]
fn an_environment_that_changes_the_indices_is_reported() {
    let environment = |line: &str| lens(&with(&[("ENPD 10\n", &format!("ENPD 10\n{line}\n"))])).remarks;
    let [vacuum] = environment("ENVD 20 0 1").try_into().expect("one");
    assert!(vacuum.contains("lens.zmx:4:1") && vacuum.contains("20 °C and 0 atmospheres (ENVD)"), "{vacuum}");
    assert_eq!(environment("ENVD 35 1 1").len(), 1);
    assert!(environment("ENVD 20 1 0").is_empty() && environment("ENVD 20 0 0").is_empty());
}

#[test]
fn a_thickness_of_rounding_is_0() {
    let cemented = "DISZ 4\n  GLAS ___BLANK 1 0 1.6 60\n  DIAM 5 1\nSURF 2\n  CURV 0\n  DISZ -0.000025\n  GLAS ___BLANK 1 0 1.7 30\n  \
                    DIAM 5 1\nSURF 3\n  CURV -0.02\n  DISZ 40\n  DIAM 5 1\nSURF 4\n  CURV 0\n  DISZ 0\n";
    let (head, _) = SINGLET.split_once("DISZ 4\n").expect("the first thickness");
    let text = format!("{head}{cemented}");
    let read = lens(&text);
    near(optics(&read).focal_length, 39.0930, 1e-4);
    near(optics(&read).back_focal_distance(), 37.9203, 1e-4);
    assert_eq!(read.interfaces[1].thickness, 0.0);
    assert!(
        read.remarks[0].contains("surface 2: a thickness of less than 100 nm below 0"),
        "{:?}",
        read.remarks
    );
    refused(&text.replace("-0.000025", "-0.025"), &["thickness -0.025 mm"]);
}

#[test]
fn zoom_positions_at_infinity_stay_if_near_ones_do_not_pair() {
    let operands: String = [(1, 1e10, 6), (2, 1e10, 4), (3, 1e10, 2), (4, 500.0, 6)]
        .map(|(number, object, gap)| format!("THIC 0 {number} {object} 0\nTHIC 2 {number} {gap} 0\n"))
        .concat();
    let text = with(&[
        ("ENPD 10", "FNUM 8 0"),
        ("1 0 1.5 0 0", "1 0 1.6 60"),
        (
            "DISZ 48\n  DIAM 8 1\nSURF 3\n  CURV 0\n",
            "DISZ 6\n  DIAM 8 1\nSURF 3\n  CURV 0.01\n  GLAS ___BLANK 1 0 1.5 60\n  DIAM 9 1\n",
        ),
    ])
    .replace("  DISZ 0\n", "  DISZ 3\nSURF 4\n  CURV 0\n  DISZ 30\n  DIAM 9 1\nSURF 5\n  CURV 0\n  DISZ 0\n");
    let read = lens(&format!("{text}MNUM 4 1\n{operands}"));
    let groups = MovingGroups::of(&read).expect("positions");
    assert!(groups.is_zoom());
    for (position, right) in [35.9961, 35.6924, 35.3937].into_iter().enumerate() {
        let travel = groups.position(position);
        near(optics(&travel.at(travel.start())).focal_length, right, 1e-4);
    }
    assert_eq!(read.positions.as_ref().expect("three").columns.len(), 3);
    assert!(
        read.remarks.iter().any(|remark| remark.contains("position 4 without its like")),
        "{:?}",
        read.remarks
    );
}

#[test]
fn a_plane_that_polarises_does_nothing() {
    let sharp = with(&[("1 0 1.5 0 0", "1 0 1.6 60"), ("DISZ 48", "DISZ 40")]);
    let with_plane =
        sharp.replace("SURF 3\n", "SURF 3\n  TYPE JONESMAT\n  CURV 0\n  DISZ 10\n  DIAM 10 1\nSURF 4\n");
    let read = lens(&with_plane);
    near(optics(&read).focal_length, 42.3012, 1e-4);
    assert!(
        read.remarks[0].contains("surface 3: an element that polarises (JONESMAT)"),
        "{:?}",
        read.remarks
    );
    refused(&with_plane.replace("JONESMAT\n  CURV 0", "JONESMAT\n  CURV 0.01"), &["of type JONESMAT"]);
}

#[test]
fn a_stop_without_a_size_is_as_large_as_the_others_let_it_be() {
    let stop = "DISZ 5\n  DIAM 10 1\nSURF 3\n  STOP\n  CURV 0\n  DISZ 35\nSURF 4\n";
    let text = with(&[
        ("ENPD 10", "FLOA"),
        ("  STOP\n", ""),
        ("1 0 1.5 0 0\n  DIAM 8", "1 0 1.6 60\n  DIAM 10"),
        ("DISZ 48\n  DIAM 8 1\nSURF 3\n", stop),
    ]);
    let read = lens(&text);
    assert_eq!(read.stop_index(), Some(2));
    // The paraxial height at the stop of the ray that enters at 10 mm.
    let focal_length = optics(&read).focal_length;
    near(focal_length, 42.3012, 1e-4);
    near(focal_length / 20.0, 2.115, 1e-3);
    // Computed by hand: slopes -0.075 in the glass and -0.2364 behind it, heights 9.7 and 8.518.
    near(stop_diameter(&read), 2.0 * 8.518, 1e-12);
    assert!(read.remarks[0].contains("surface 3: the stop has no size (DIAM)"), "{:?}", read.remarks);
}

#[test]
fn a_plane_behind_the_film_is_left_out() {
    let text = with(&[
        ("ENPD 10", "FLOA"),
        ("DISZ 48", "DISZ 45"),
        ("SURF 3\n", "SURF 3\n  CURV 0\n  DISZ -3\n  DIAM 15 1\nSURF 4\n"),
    ]);
    let read = lens(&text);
    assert_eq!((read.interfaces.len(), read.nominal_film_distance), (2, Some(42.0)));
    assert!(
        read.findings.iter().any(|own| own.fate == Fate::LeftOut && own.surfaces() == ["3"]),
        "{:?}",
        read.findings
    );
}

#[test]
fn no_line_of_a_file_is_missing_in_the_list_of_fates() {
    let text =
        with(&[("PWAV 1\n", "PWAV 1\nNOTE 0 a lens\nWHAT 1 2\n"), ("DIAM 8 1\n", "DIAM 8 1\n  WHY 3\n")]);
    let read = lens(&text);
    let mut lines: Vec<usize> = read.findings.iter().flat_map(|own| own.lines()).collect();
    lines.sort_unstable();
    lines.dedup();
    assert_eq!(lines, (1..=text.lines().count()).collect::<Vec<_>>());
    assert_eq!(fate(&read, "WHAT"), (Fate::LeftOut, vec![10], "a keyword that this reader does not know"));
    assert_eq!(fate(&read, "WHY").1, [22]);
    assert_eq!([fate(&read, "NOTE").0, fate(&read, "GLAS").0], [Fate::Informative, Fate::Used]);
}
