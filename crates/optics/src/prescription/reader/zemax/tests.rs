//! Tests that read a whole lens, and tests of every refusal with the message that the user reads.

use crate::prescription::{
    Aperture, Coating, CoordinateBreak, GlassLibrary, Medium, NO_TERMS, Outline, Shape, SurfaceCoating,
    glass::{D_LINE, refractive_index},
    read_with,
    reader::checks::{FILE, ok, refused, replaced},
    unsymmetric::{Meridian, Unsymmetric},
};

/// A made-up lens with a named glass, a model glass, an asphere, surfaces without effect, and a stop in air whose size
/// follows from the diameter of the entrance pupil.
const LENS: &str = "VERS 120928 0\nMODE SEQ\nNAME A made-up lens\nUNIT MM X W X CM MR CPMM\nENPD 8.0\nFTYP 0 0 2 3 0 0 0\n\
    XFLN 0 0 0\nYFLN 0 10 0\nGCAT SCHOTT\n\
    SURF 0\n  TYPE STANDARD\n  CURV 0.0 0 0\n  DISZ INFINITY\n  DIAM 0 0 0 0 1 \"\"\n\
    SURF 1\n  COMM idle\n  TYPE STANDARD\n  CURV 0.0\n  DISZ 5\n  DIAM 4 0 0\n\
    SURF 2\n  TYPE STANDARD\n  CURV 0.05 0 0\n  CONI -0.5\n  DISZ 4.0E+0\n  GLAS N-BK7 0 0 1.5 40 0 0\n  DIAM 5 1 0\n\
    SURF 3\n  TYPE EVENASPH\n  CURV -0.05\n  PARM 1 0\n  PARM 2 1e-5\n  PARM 8 2e-30\n  DISZ 1.5\n  DIAM 5 1 0\n\
    SURF 4\n  CURV 0\n  DISZ -0.5\n  DIAM 5 0 0\n\
    SURF 5\n  STOP\n  CURV 0\n  DISZ 2\n  DIAM 7 0 0\n\
    SURF 6\n  CURV -0.04\n  DISZ 2\n  GLAS ___BLANK 1 0 1.6 40 0\n  DIAM 4 1\n\
    SURF 7\n  CURV 0\n  DISZ 30\n  DIAM 4 1\n\
    SURF 8\n  CURV 0\n  DISZ 0\n  DIAM 3\nTOL TOFF 0 0\nMNUM 1 1\nMOFF 0 1 \"\" 0 0\n";

fn with(from: &str, to: &str) -> String {
    replaced(LENS, from, to)
}

#[test]
fn surfaces_between_object_and_image_are_read() {
    let lens = ok(LENS);
    assert_eq!(lens.title.as_deref(), Some("A made-up lens"));
    assert_eq!(lens.remarks, [""; 0]);
    let [first, second, stop, third, last] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
    let Shape::Asphere(conic) = first.shape else { panic!("{first:?}") };
    assert_eq!((conic.radius, conic.conic, conic.terms), (20.0, -0.5, NO_TERMS));
    let Shape::Asphere(even) = second.shape else { panic!("{second:?}") };
    assert_eq!((even.radius, even.term(4), even.term(16)), (-20.0, 1e-5, 2e-30));
    assert_eq!((stop.shape, last.shape), (Shape::Plane, Shape::Plane));
    assert_eq!(lens.stop_in_air(), Some(2));
    // The number is a semi-diameter. The thickness behind a surface without effect is added to the thickness behind its
    // neighbour.
    assert_eq!((first.semi_diameter, second.thickness, last.thickness), (5.0, 1.0, 0.0));
    assert!(matches!(first.medium, Medium::Sellmeier { .. }));
    assert_eq!(third.medium, Medium::Glass { n_d: 1.6, abbe: Some(40.0) });
    assert_eq!((lens.nominal_film_distance, lens.positions), (Some(30.0), None));
    assert_eq!(lens.stated.fields, [Some(20.0)]);
    // The entrance pupil has a diameter of 8 mm. The ray at height 4 mm through the first lens is computed by hand.
    let n = refractive_index(first.medium, D_LINE);
    let in_glass = -(n - 1.0) * 0.05 * 4.0 / n;
    let behind = 4.0 + 4.0 * in_glass;
    let at_stop = behind + (n * in_glass - (1.0 - n) * -0.05 * behind) * 1.0;
    assert!((stop.semi_diameter - at_stop).abs() < 1e-12, "{} {at_stop}", stop.semi_diameter);
}

#[test]
fn encodings_and_units_make_no_difference() {
    let plain = ok(LENS);
    assert_eq!(ok(&LENS.replace('\n', "\r\n")), plain);
    let utf16 = [0xFF, 0xFE].into_iter().chain(LENS.bytes().flat_map(|byte| [byte, 0])).collect::<Vec<u8>>();
    assert_eq!(ok(&utf16), plain);
    let latin: Vec<u8> =
        with("made-up", "50? lens").bytes().map(|b| if b == b'?' { 0xB0 } else { b }).collect();
    assert_eq!(ok(&latin).title.as_deref(), Some("A 50° lens lens"));
    let inches = ok(&with("UNIT MM", "UNIT IN"));
    assert_eq!(inches.interfaces, plain.scaled(25.4).interfaces);
    assert_eq!(inches.nominal_film_distance, Some(762.0));
}

#[test]
fn the_aperture_can_be_stated_in_four_ways() {
    let stop = |text: &str| ok(text).interfaces[2].semi_diameter;
    assert_eq!(stop(&with("ENPD 8.0", "FLOA")), 7.0);
    let by_pupil = stop(LENS);
    // The f-number is inversely proportional to the pupil's diameter: half the f-number gives twice the size.
    let sizes = ["FNUM 4 0", "FNUM 2 0"].map(|fnumber| stop(&with("ENPD 8.0", fnumber)));
    assert!((sizes[1] / sizes[0] - 2.0).abs() < 1e-12);
    assert_eq!(ok(&with("ENPD 8.0", "FNUM 4 0")).stated.fnumber, Some(4.0));
    // As seen from an object 100 mm in front of the lens, the edge of the pupil is 4 mm off the axis, at the pupil's
    // distance.
    let near = with("DISZ INFINITY", "DISZ 95");
    let by_na = |na: f64| stop(&near.replace("ENPD 8.0", &format!("OBNA {na} 0")));
    let pupil = by_na(0.03).mul_add(4.0 / by_pupil, 0.0) / (0.03 / (1.0_f64 - 0.0009).sqrt());
    assert!((101.0..110.0).contains(&pupil), "{pupil} mm to the pupil, which stands behind the first vertex");
    let positions = ok(&near).positions.expect("one, for its object");
    assert_eq!((positions.columns.len(), positions.columns[0].object_distance), (1, Some(100.0)));
    // A stop on glass limits that surface.
    let on_glass = ok(&with("SURF 2\n", "SURF 2\n  STOP\n").replace("SURF 5\n  STOP", "SURF 5"));
    assert_eq!((on_glass.interfaces[0].semi_diameter, on_glass.interfaces.len()), (4.0, 4));
}

#[test]
fn other_figures_are_the_same_terms() {
    let even = ok(LENS).interfaces[1].clone();
    let figure = |from: &str, to: &str| ok(&LENS.replace(from, to)).interfaces[1].clone();
    assert_eq!(
        figure(
            "TYPE EVENASPH\n  CURV -0.05\n  PARM 1 0\n  PARM 2 1e-5\n  PARM 8 2e-30",
            "TYPE ODDASPHE\n  CURV -0.05\n  PARM 4 1e-5\n  PARM 16 2e-30"
        )
        .shape,
        even.shape
    );
    let extended = figure(
        "TYPE EVENASPH\n  CURV -0.05\n  PARM 1 0\n  PARM 2 1e-5\n  PARM 8 2e-30",
        "TYPE XASPHERE\n  CURV -0.05\n  XDAT 1 2 0 0\n  XDAT 2 2 0\n  XDAT 4 1.6e-4",
    );
    let Shape::Asphere(figure) = extended.shape else { panic!("{extended:?}") };
    assert!((figure.term(4) - 1e-5).abs() < 1e-20);
}

#[test]
fn surfaces_without_a_size_get_one_from_rays_or_are_refused() {
    let derived = ok(&with("DIAM 4 1\nSURF 7", "DIAM 0 0\nSURF 7"));
    assert!(
        derived.remarks[0].contains("surface 6: no semi-diameter (DIAM) is stated"),
        "{:?}",
        derived.remarks
    );
    // The size covers the stop's edge and 10 degrees of field, and is therefore slightly larger than that of the stop.
    let ratio = derived.interfaces[3].semi_diameter / derived.interfaces[2].semi_diameter;
    assert!((1.0..1.3).contains(&ratio), "{ratio}");
    let without = with("  DIAM 4 1\nSURF 7", "SURF 7").replace("  STOP\n", "");
    refused(&without, "44:1", &["surface 6 has no semi-diameter", "a stop to derive it from"]);
}

#[test]
fn configurations_are_positions() {
    let zoom = with(
        "MNUM 1 1\n",
        "MNUM 2 1\nTHIC    5   1 2 0 0 0 1 1\nTHIC 5 2 3.5 0 0\nTHIC 7 1 30\nTHIC 7 2 28\nTHIC 0 1 1e10\nTHIC 0 2 495\nCRVT 3 1 0\n",
    );
    let lens = ok(&zoom);
    let positions = lens.positions.expect("two");
    assert_eq!(positions.gaps, [2, 4]);
    assert_eq!([&positions.columns[0].gaps, &positions.columns[1].gaps], [&[2.0, 30.0], &[3.5, 28.0]]);
    assert_eq!(positions.columns.iter().map(|c| c.object_distance).collect::<Vec<_>>(), [None, Some(500.0)]);
    assert_eq!(positions.columns[0].stop_diameter, Some(2.0 * lens.interfaces[2].semi_diameter));
    assert!(lens.remarks[0].contains("operand CRVT changes the lens"), "{:?}", lens.remarks);
    refused(
        &zoom.replace("THIC 5 2", "THIC 9 2"),
        "61:1",
        &["surface 9 in configuration 2", "2 configurations"],
    );
    refused(&zoom.replace("THIC 5 2", "THIC 5 3"), "61:1", &["configuration 3"]);
    refused(&zoom.replace("THIC 5 2 3.5", "THIC 5 2 -3.5"), "40:1", &["position 2: thickness -3.5 mm"]);
    refused(
        &zoom.replace("THIC 5 2 3.5", "THIC 5 2 x"),
        "61:10",
        &["\"x\" is not a number", "value 3 of THIC"],
    );
    refused(&zoom.replace("MNUM 2", "MNUM 101"), "59:1", &["at most 100 positions"]);
}

#[test]
fn numbers_of_a_glass_count_for_model_glasses_alone() {
    // The numbers belong to a previous glass, not to N-BK77.
    let stale = with("N-BK7 0 0 1.5 40", "N-BK77 3 0 1.6 40");
    refused(&stale, "26:8", &["\"N-BK77\" is not known", "nearest that is known is N-BK7", "glass_catalog"]);
    refused(&stale, "26:8", &["that n_d is 1.6 counts only with 1, a model glass, for the solve code 3"]);
    for code in ["0", "2"] {
        refused(&stale.replace("N-BK77 3", &format!("N-BK77 {code}")), "26:8", &["\"N-BK77\" is not known"]);
    }
    // With code 1 the numbers define the glass, and the name is kept.
    let lens = ok(&stale.replace("N-BK77 3", "N-BK77 1"));
    assert_eq!(lens.interfaces[0].medium, Medium::Glass { n_d: 1.6, abbe: Some(40.0) });
    assert_eq!((lens.glasses[0].0.as_str(), lens.glasses[0].1.medium), ("N-BK77", lens.interfaces[0].medium));
    assert_eq!(lens.remarks, [""; 0]);
    // A known substitute glass is the glass of its name, without a warning about the numbers.
    let substitute = ok(&with("N-BK7 0 0 1.5 40", "N-BK7 3 0 1.6 40"));
    assert_eq!((substitute.interfaces, substitute.remarks), (ok(LENS).interfaces, vec![]));
    let other = ok(&with("N-BK7 0 0 1.5 40", "N-BK7 0 0 1.6 40"));
    assert_eq!(other.interfaces[0].medium, ok(LENS).interfaces[0].medium);
    assert!(other.remarks[0].contains("N-BK7: the file gives another n_d or V"), "{:?}", other.remarks);
    // The numbers 1.5 and 40 are written by programs that do not store the numbers of a glass.
    let nothing = with("N-BK7 0 0", "N-BK77 0 0");
    refused(&nothing, "26:8", &["\"N-BK77\" is not known", "give it as \"glass_catalog\""]);
    let catalogue = "CC made up\nNM N-BK77 2 517642 1.5168 64.17 0\nCD 1.03961212 6.00069867E-3 0.231792344 2.00179144E-2 \
        1.01046945 103.560653\nNM odd 77 0 1.5 60\nCD 1 2\n";
    let mut library = GlassLibrary::default();
    library.add("own.agf", catalogue.as_bytes()).expect("a catalogue");
    let found = read_with(FILE, nothing.as_bytes(), &library).expect("known");
    assert_eq!(found.interfaces[0].medium, ok(LENS).interfaces[0].medium);
    let odd = read_with(FILE, with("N-BK7 0 0", "odd 0 0").as_bytes(), &library).expect_err("refused");
    assert!(odd.message.contains("own.agf:5: formula 77 is not known"), "{odd}");
}

#[test]
fn a_name_of_several_makers_is_that_of_the_files_catalogues() {
    let n_d = |catalogues: &str| {
        let lens = ok(&with("GCAT SCHOTT", catalogues).replace("N-BK7", "F2"));
        (1e4 * refractive_index(lens.interfaces[0].medium, D_LINE)).round() / 1e4
    };
    assert_eq!([n_d("GCAT SCHOTT CDGM"), n_d("GCAT MISC"), n_d("NOTE 0")], [1.62; 3]);
    assert_eq!([n_d("GCAT CDGM SCHOTT"), n_d("GCAT CDGM201409")], [1.6129; 2]);
}

#[test]
fn the_primary_wavelength_is_the_lenss() {
    let of = |lines: &str| ok(&with("GCAT SCHOTT\n", lines));
    assert_eq!(ok(LENS).wavelength, None);
    let lines = "WAVM 1 0.4861 1\nWAVM 2 0.65627 1\nWAVM 3 0.55 1\n";
    let two = of(&format!("{lines}PWAV 2\n"));
    assert_eq!((two.wavelength, two.own_wavelength()), (Some(656.27), 656.27));
    assert_eq!(of(lines).wavelength, Some(486.1));
    assert_eq!(of("WAVL 0.4861 0.58756 0.6563\nPWAV 2\n").wavelength, Some(587.56));
    assert_eq!(of("WAVL 0.5 0.6\nWAVN 5.001E-001 0.6001\nPWAV 1\n").wavelength, Some(500.1));
    // The size of the pupil depends on the primary wavelength.
    let stop = |lines: &str| of(lines).interfaces[2].semi_diameter;
    assert!(stop("WAVM 1 1.0 1\nPWAV 1\n") > stop("WAVM 1 0.4 1\nPWAV 1\n"));
    let wrong = |lines: &str, at: &str, parts: &[&str]| refused(&with("GCAT SCHOTT\n", lines), at, parts);
    wrong("WAVM 1 10.6 1\nPWAV 1\n", "9:8", &["the primary wavelength is 10600 nm", "from 200 to 2000 nm"]);
    wrong("WAVM 1 0.55 1\nPWAV 2\n", "10:1", &["wavelength 2 is the primary one"]);
    wrong("WAVL 0.55 0.6\nPWAV 3\n", "10:1", &["wavelength 3 is the primary one"]);
    wrong("WAVM 1 x 1\nPWAV 1\n", "9:8", &["\"x\" is not a number", "a wavelength, µm"]);
    wrong("WAVM 1\n", "9:1", &["a wavelength without a value"]);
    wrong(
        "WAVM 1 0.22 1\n",
        "9:8",
        &["glass N-BK7 has data from 300 to 2500 nm, and the wavelength is 220 nm"],
    );
}

#[test]
fn unsupported_surfaces_are_refused_by_name_with_their_line() {
    let kind = |kind: &str| with("EVENASPH", kind);
    refused(&kind("CYLINDER"), "29:3", &["surface 3 is of type CYLINDER, which is not read", "TOROIDAL"]);
    refused(&kind("TOROIDAL\n  XDAT 1 2 0"), "30:3", &["surface 3 is a toroid with Zernike terms"]);
    refused(&kind("DGRATING"), "29:3", &["surface 3 is a grating"]);
    refused(&kind("PARAXIAL"), "29:3", &["surface 3 is an ideal thin lens", "no étendue"]);
    refused(&kind("BINARY_2"), "29:3", &["surface 3 is of type BINARY_2"]);
    refused(
        &with("N-BK7 0 0 1.5", "___BLANK 1 0 -1.5"),
        "26:3",
        &["surface 2 is a mirror, written by its index -1.5"],
    );
    refused(
        &with("N-BK7 0 0 1.5", "___BLANK 1 0 -1"),
        "21:1",
        &["surface 2 is a mirror, written by its index -1, and the thickness"],
    );
    refused(
        &with("  STOP", "  SCBD 0 0 0 0 0 5 0 0"),
        "41:3",
        &["surface 5 has a tilt", "neither 1, before it, nor 2"],
    );
    refused(&with("  DISZ INF", "  SCBD 1 0 0 0 0 5 0 0\n  DISZ INF"), "10:1", &["decentring of the object"]);
    refused(&with("MODE SEQ", "MODE NSC"), "2:1", &["not a sequential lens"]);
}

#[test]
fn a_malformed_file_is_refused_with_the_location() {
    refused("SURF 0\n", "1:1", &["fewer than two surfaces"]);
    refused("SURF 0\nSURF 1\n", "2:1", &["no surface between object and image"]);
    refused(&with("CURV 0.05", "CURV O.05"), "23:8", &["\"O.05\" is not a number", "value 1 of CURV"]);
    refused(&with("CURV 0.05 0 0", "CURV"), "23:3", &["CURV lacks its value 1"]);
    refused(&with("PARM 2 1e-5", "PARM x 1e-5"), "32:3", &["PARM without its number"]);
    refused(&with("PARM 2 1e-5", "PARM 16 1e-5"), "32:3", &["a term of r^32", "r^1 to r^30"]);
    refused(&with("DISZ 2\n  DIAM 7", "DISZ INFINITY\n  DIAM 7"), "43:3", &["without end"]);
    refused(&with("DISZ 2\n  DIAM 7", "DISZ -2\n  DIAM 7"), "40:1", &["thickness -2 mm"]);
    refused(&with("GLAS N-BK7 0 0 1.5 40 0 0", "GLAS"), "26:3", &["without a name"]);
    refused(&with("___BLANK 1 0 1.6", "___BLANK 1 0 0"), "48:3", &["index of 1 or more"]);
    refused(&with("UNIT MM", "UNIT FT"), "4:6", &["\"FT\" is not a unit"]);
    refused(&with("ENPD 8.0", "ENPD -8"), "5:1", &["is not an aperture"]);
    refused(&with("DISZ INFINITY", "DISZ -5"), "10:1", &["expected a positive distance"]);
    refused("NM BK7 2 517642\nCD 1 2 3 4 5 6\n", "1:1", &["catalogue of glasses", "glass_catalog"]);
    refused(
        &with("UNIT MM", "UNIT METER").replace("DISZ 30", "DISZ 1e306"),
        "10:1",
        &["beyond the range of numbers"],
    );
    let lost = ok(&with("SURF 6\n", "SURF 7\n"));
    assert!(lost.remarks[0].contains(":45:1: surface 7 where surface 6 was expected"), "{:?}", lost.remarks);
    let open = ok(&with("DISZ 30", "DISZ -30"));
    assert_eq!(open.nominal_film_distance, None);
    assert!(open.remarks[0].contains("the image lies in front of the last surface"), "{:?}", open.remarks);
}

#[test]
fn coatings_are_known_by_their_names() {
    assert_eq!(ok(LENS).coatings, None);
    let text = with("  TYPE STANDARD\n  CURV 0.05", "  COAT AR\n  CURV 0.05")
        .replacen("CURV -0.04", "COAT Hear1\n  CURV -0.04", 1)
        .replacen("NAME A", "WAVM 1 0.5 1\nPWAV 1\nNAME A", 1);
    let lens = ok(&text);
    let at = |coating| SurfaceCoating::Named { coating, wavelength: 500.0 };
    let [bare, one, three] = [Coating::Bare, Coating::QuarterWave, Coating::ThreeLayer].map(at);
    assert_eq!(lens.coatings, Some(vec![one, bare.clone(), bare.clone(), three, bare]));
    assert_eq!(lens.remarks, [""; 0]);
    // An unknown coating, and a coating on a surface without glass.
    let lens = ok(&with("  TYPE STANDARD\n  CURV 0.05", "  COAT I.95\n  CURV 0.05").replacen(
        "  STOP\n",
        "  STOP\n  COAT AR\n",
        1,
    ));
    assert!(lens.coatings.is_some_and(|all| all.iter().all(SurfaceCoating::is_bare)));
    assert!(lens.remarks[0].contains("surface 2: coating I.95 is known to the file's program alone"));
    assert!(lens.remarks[1].contains("surface 5: coating AR is left out"), "{:?}", lens.remarks);
}

/// A made-up lens with a folding mirror in front of its film.
const FOLD: &str = "UNIT MM\nENPD 8\nSURF 0\n  DISZ INFINITY\n\
    SURF 1\n  STOP\n  CURV 0.02\n  DISZ 4\n  GLAS ___BLANK 1 0 1.5 60\n  DIAM 10 1\n\
    SURF 2\n  CURV -0.02\n  DISZ 20\n  DIAM 10 1\n\
    SURF 3\n  TYPE COORDBRK\n  PARM 3 45\n  DISZ 0\n\
    SURF 4\n  GLAS MIRROR 0 0\n  DISZ 0\n  DIAM 15 1\n\
    SURF 5\n  TYPE COORDBRK\n  PARM 3 45\n  DISZ -28\n\
    SURF 6\n  DISZ 0\n";

fn fold(from: &str, to: &str) -> String {
    replaced(FOLD, from, to)
}

#[test]
fn a_fold_becomes_a_mirror_between_changes_of_frame() {
    let lens = ok(FOLD);
    let [first, second, mirror] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
    let turn = CoordinateBreak::tilted([45.0, 0.0, 0.0]);
    assert_eq!([first.coordinate_break, second.coordinate_break], [None; 2]);
    assert_eq!((mirror.coordinate_break, lens.film_break), (Some(turn), Some(turn)));
    assert!(mirror.is_mirror && !second.is_mirror && mirror.medium == Medium::Air);
    assert_eq!((second.thickness, lens.nominal_film_distance), (20.0, Some(28.0)));
    assert_eq!(lens.remarks, [""; 0]);
    // The same by tilts of the mirror, in a glass, and with the film tilted.
    let own = ok(&fold("  GLAS MIRROR", "  SCBD 1 0 0 0 0 45 0 0\n  SCBD 2 1 0 0 0 45 0 0\n  GLAS MIRROR")
        .replace("PARM 3 45", "PARM 3 0"));
    assert_eq!((own.interfaces, own.film_break), (lens.interfaces.clone(), lens.film_break));
    let tilted = ok(&fold("SURF 6\n", "SURF 6\n  SCBD 1 0 0 0 0 3 0 0\n"));
    // The film turns about its own place, and moves along its own normal.
    let place = |s: f64| CoordinateBreak::shifted([0.0, 0.0, s]);
    let film = turn.then(&place(-28.0)).then(&CoordinateBreak::tilted([3.0, 0.0, 0.0])).then(&place(28.0));
    let found = tilted.film_break.expect("tilted").then(&film.inverse());
    assert!(found.shift.iter().all(|shift| shift.abs() < 1e-13), "{found:?}");
    assert_eq!(tilted.nominal_film_distance, Some(28.0));
}

#[test]
fn breaks_with_thicknesses_between_them_are_one_change() {
    let both = fold(
        "  PARM 3 45\n  DISZ 0",
        "  PARM 1 1\n  PARM 4 5\n  PARM 6 1\n  DISZ 3\nSURF 3\n  TYPE COORDBRK\n  PARM 2 -2\n  DISZ 1",
    );
    let expected = CoordinateBreak::zemax([1.0, 0.0], [0.0, 5.0, 0.0], true)
        .then(&CoordinateBreak::shifted([0.0, 0.0, 3.0]))
        .then(&CoordinateBreak::shifted([0.0, -2.0, 0.0]))
        .then(&CoordinateBreak::shifted([0.0, 0.0, 1.0]));
    assert_eq!(ok(&both).interfaces[2].coordinate_break, Some(expected));
    // A break and its inverse leave the lens on its axis.
    let straight = fold("  TYPE COORDBRK\n  PARM 3 45\n", "").replace("  TYPE COORDBRK\n  PARM 3 45\n", "");
    let back = fold("PARM 3 45", "PARM 1 2\n  PARM 3 7")
        .replace("SURF 4\n", "SURF 4\n  TYPE COORDBRK\n  PARM 1 -2\n  PARM 3 -7\n  PARM 6 1\nSURF 4\n");
    let back = back.replace("  PARM 3 45\n", "");
    let [straight, back] = [straight, back].map(|text| ok(&text));
    assert_eq!((back.interfaces, back.film_break), (straight.interfaces, None));
    assert_eq!(back.nominal_film_distance, Some(28.0));
    // A break in front of the lens is relative to the camera.
    let front = ok(&fold("SURF 1\n", "SURF 1\n  DISZ 5\nSURF 1\n  TYPE COORDBRK\n  PARM 2 3\nSURF 1\n"));
    assert_eq!(front.interfaces[0].coordinate_break, Some(CoordinateBreak::shifted([0.0, 3.0, 0.0])));
}

#[test]
fn configurations_move_no_tilted_surface() {
    let of = |operands: &str| format!("{FOLD}MNUM 2 1\n{operands}");
    // Thicknesses in front of the tilt and behind it move along the axis.
    let zoom = ok(&of("THIC 2 1 20\nTHIC 2 2 21\nTHIC 5 1 -28\nTHIC 5 2 -27\n"));
    let positions = zoom.positions.expect("two");
    assert_eq!(positions.gaps, [1, 2]);
    assert_eq!([&positions.columns[0].gaps, &positions.columns[1].gaps], [&[20.0, 28.0], &[21.0, 27.0]]);
    refused(&of("THIC 3 1 0\nTHIC 3 2 1\n"), "19:1", &["configuration 2 changes a thickness between tilts"]);
    let pivot = ok(&of("PRAM 3 1 45 0 3\nPRAM 3 2 50 0 3\n"));
    assert!(pivot.remarks[0].contains("operand PRAM changes the lens"), "{:?}", pivot.remarks);
    let solved = fold("  PARM 3 45\n  DISZ -28", "  PARM 3 45\n  SCBD 3 3 2\n  DISZ -28");
    assert_eq!(ok(&solved).remarks, [""; 0]);
    let solved = ok(&format!("{solved}MNUM 2 1\nTHIC 2 2 21\n"));
    assert!(
        solved.remarks[0].contains("a return to the frame of an earlier surface"),
        "{:?}",
        solved.remarks
    );
}

#[test]
fn cylinders_toroids_and_biconics_are_read() {
    let figure = |lines: &str| ok(&fold("  CURV -0.02\n", lines)).interfaces[1].shape;
    let toroid = "  TYPE TOROIDAL\n  CURV -0.02\n  CONI -1\n  PARM 1 80\n  PARM 3 1e-5\n  PARM 8 2e-20\n";
    let Shape::Unsymmetric(Unsymmetric::Toroid(toroid)) = figure(toroid) else { panic!("toroid") };
    assert_eq!((toroid.meridian, toroid.radius, toroid.conic), (Meridian::Y, -50.0, -1.0));
    assert_eq!((toroid.rotation_radius, toroid.terms[1], toroid.terms[6]), (80.0, 1e-5, 2e-20));
    let Shape::Unsymmetric(cylinder) = figure("  TYPE TOROIDAL\n  CURV -0.02\n") else { panic!("cylinder") };
    assert_eq!(cylinder.cylinder().map(|own| (own.meridian, own.radius)), Some((Meridian::Y, -50.0)));
    assert_eq!(figure("  TYPE TOROIDAL\n  CURV 0\n"), Shape::Plane);
    let biconic = "  TYPE BICONICX\n  CURV -0.02\n  CONI -1\n  PARM 1 80\n  PARM 2 0.5\n";
    let Shape::Unsymmetric(Unsymmetric::Biconic(biconic)) = figure(biconic) else { panic!("biconic") };
    assert_eq!((biconic.radii, biconic.conics), ([80.0, -50.0], [0.5, -1.0]));
}

#[test]
fn a_tilted_plane_is_tilted_by_its_tangents() {
    let text = fold("  CURV -0.02\n", "  TYPE TILTSURF\n  PARM 1 0.3\n  PARM 2 -0.4\n");
    let lens = ok(&text);
    let [_, plane, mirror] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
    let change = plane.coordinate_break.expect("tilted");
    let normal = change.turned([0.0, 0.0, 1.0]);
    let length = 1.25_f64.sqrt();
    let expected = [-0.3 / length, 0.4 / length, 1.0 / length];
    assert!(normal.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{normal:?}");
    // The aperture is a circle as seen along the axis.
    let Aperture { outline: Outline::Ellipse(axes), rotation, .. } = &plane.apertures[0] else {
        panic!("{plane:?}")
    };
    assert!((axes[0] - 10.0 * length).abs() < 1e-13 && axes[1] == 10.0, "{axes:?}");
    let (sin, cos) = rotation.to_radians().sin_cos();
    let [x, y, z] = change.point([axes[0] * cos, axes[0] * sin, 0.0]);
    assert!((x - 6.0).abs() < 1e-13 && (y + 8.0).abs() < 1e-13 && (z - 5.0).abs() < 1e-13, "{x} {y} {z}");
    // Behind it the frame is that in front of it.
    let turn = CoordinateBreak::tilted([45.0, 0.0, 0.0]);
    let behind = change
        .then(&CoordinateBreak::shifted([0.0, 0.0, plane.thickness]))
        .then(&mirror.coordinate_break.expect("tilted"));
    let found = behind.then(&CoordinateBreak::shifted([0.0, 0.0, 20.0]).then(&turn).inverse());
    assert!(found.shift.iter().all(|shift| shift.abs() < 1e-13), "{found:?}");
}

#[test]
fn paraxial_rays_follow_mirrors() {
    // A concave mirror of radius 200, with a stop in its focal plane; the pupil's edge is seen 4 mm high at f/12.5.
    let text = "ENPD 8\nFTYP 0 0 1 1\nYFLN 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  DISZ 100\nSURF 2\n  CURV -5e-3\n  DISZ -50\n\
        GLAS MIRROR\nSURF 3\n  CURV 1e-2\n  DISZ 90\n  GLAS MIRROR\nSURF 4\n  DISZ 0\n";
    let lens = ok(text);
    let sizes: Vec<f64> = lens.interfaces.iter().map(|own| own.semi_diameter).collect();
    let chief = 1.0_f64.to_radians().tan();
    let expected = [4.0, 1.1 * (4.0 + 100.0 * chief), 1.1 * (2.0 + 100.0 * chief)];
    assert!(
        sizes.iter().zip(expected).all(|(own, expected)| (own - expected).abs() < 1e-12),
        "{sizes:?} {expected:?}"
    );
    assert_eq!(lens.nominal_film_distance, Some(90.0));
}

#[test]
fn a_mirror_behind_glass_in_three_surfaces_is_one() {
    // A plate, a plane as large as the secondary, a Mangin mirror, and a secondary mirror behind glass.
    let glass = "  GLAS ___BLANK 1 0 1.5 60\n";
    let mirror = "  GLAS ___BLANK 1 0 -1 0\n";
    let surface = |(i, (curvature, thickness, glass, size)): (usize, (f64, f64, &str, f64))| {
        format!("SURF {}\n  CURV {curvature}\n  DISZ {thickness}\n{glass}  DIAM {size} 1\n", i + 1)
    };
    let rows = [
        (0.0, 5.0, glass, 44.5),
        (0.0, 60.0, "", 44.5),
        (0.0, 35.0, "", 15.49),
        (-0.004, 8.0, glass, 43.0),
        (-0.003, 0.0, "", 43.0),
        (-0.003, 0.0, mirror, 43.0),
        (-0.003, -8.0, glass, 43.0),
        (-0.004, -32.0, "", 43.0),
        (-0.002, -3.0, glass, 15.5),
        (-0.003, 0.0, "", 15.49),
        (-0.003, 0.0, mirror, 15.49),
        (-0.003, 3.0, glass, 15.49),
        (-0.002, 90.0, "", 15.5),
    ];
    let rows: String = rows.into_iter().enumerate().map(surface).collect();
    let lens = ok(&format!("SURF 0\n  DISZ INFINITY\n{rows}SURF 14\n"));
    let [_, _, plane, front, primary, .., secondary, last] = lens.interfaces.as_slice() else {
        panic!("{lens:?}")
    };
    assert_eq!(lens.interfaces.len(), 9);
    assert!(primary.is_mirror && secondary.is_mirror && !front.is_mirror);
    assert_eq!((primary.medium, primary.thickness), (front.medium, -8.0));
    assert_eq!(
        (secondary.thickness, last.medium, lens.nominal_film_distance),
        (3.0, Medium::Air, Some(90.0))
    );
    // The plane lets light pass outside of it.
    assert_eq!(plane.semi_diameter, 44.5);
    assert!(plane.apertures[0].is_obstruction && plane.apertures[0].reach() == 15.49, "{plane:?}");
    assert!(lens.remarks[0].contains("surface 3: a plane in air of diameter 30.98 mm"), "{:?}", lens.remarks);
}
