//! Tests that read a whole lens, and tests of every refusal with the message that the user reads.

use crate::prescription::{
    Medium, Shape,
    reader::checks::{FILE, ok, refused},
};

/// A made-up zoom with a thickness that varies with the position, a flare stop, a cover glass, an asphere, and parts to
/// be skipped.
const ZOOM: &str = "[descriptive data]\ntitle\tA made-up zoom\n[constants]\nScaled\t50\t100\n[variable distances]\n\
    Focal Length\t28.0\t50.0\tundefined\nF-Number\t2.8\t4\tundefined\nAngle of View\t75.2\t46.4\t\nd0\tInfinity\tInfinity\t700\n\
    d3\t3.0\t9.0\t4\nBf\t40.0\t35.0\t\nAperture Diameter\t6.2\t6.8\t6.8\n\
    [lens data]\n1\t20.0\t5.0\t1.51680\t10.0\t64.17\tN-BK7\tSCHOTT\n2\t-20\t1\t\t10\n3\tFS\td3\t\t9\t\n\
    # a remark\n4AS\tAS\t1\t\t6.5\n5\t30\t2\t1.6\t8\t40\tXQ7?\n6\t-30\t1\t\t8\n7\tCG\t1.5\t1.52\t30\t64.1\n8\tInfinity\tBf\t\t30\n\
    [aspherical data]\n2\t-20\t-0.5\t1e-5\t\t2e-9\t\n[!aspherical data]\n1\t20\t9\t1\n[figure]\n1\t20\t9\t1\n";

#[test]
fn every_section_that_describes_the_lens_is_read() {
    let lens = ok(ZOOM);
    assert_eq!((lens.name.as_str(), lens.title.as_deref()), (FILE, Some("A made-up zoom")));
    let shapes: Vec<Shape> = lens.interfaces.iter().map(|interface| interface.shape).collect();
    assert_eq!(shapes[0], Shape::Sphere { radius: 20.0 });
    let Shape::Asphere(asphere) = shapes[1] else { panic!("{shapes:?}") };
    assert_eq!((asphere.radius, asphere.conic, asphere.term(4), asphere.term(8)), (-20.0, -0.5, 1e-5, 2e-9));
    assert_eq!(asphere.terms.iter().filter(|term| **term != 0.0).count(), 2);
    assert_eq!(shapes[2..4], [Shape::Plane, Shape::Plane]);
    assert_eq!(lens.stop_in_air(), Some(3));
    assert_eq!(shapes[6..], [Shape::Plane, Shape::Plane]);
    // The column has clear diameters; the stop has the diameter of the first position.
    assert_eq!((lens.interfaces[0].semi_diameter, lens.interfaces[3].semi_diameter), (5.0, 3.1));
    assert!(matches!(lens.interfaces[0].medium, Medium::Sellmeier { .. }));
    assert_eq!(lens.interfaces[4].medium, Medium::Glass { n_d: 1.6, abbe: Some(40.0) });
    let names: Vec<&str> = lens.glasses.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["N-BK7", "XQ7"]);
    assert_eq!((lens.interfaces[2].thickness, lens.nominal_film_distance), (3.0, Some(40.0)));
    assert_eq!((lens.stated_focal_length, lens.stated.fields), (Some(28.0), vec![Some(75.2), Some(46.4)]));
    let positions = lens.positions.expect("two");
    assert_eq!(positions.gaps, [2, 7]);
    assert_eq!(positions.columns[1].gaps, [9.0, 35.0]);
    assert_eq!((positions.columns[1].fnumber, positions.columns[1].stop_diameter), (Some(4.0), Some(6.8)));
    assert_eq!(positions.columns.len(), 2, "the third has no distance to the film");
    assert_eq!(lens.remarks.len(), 2, "{:?}", lens.remarks);
    assert!(lens.remarks[0].starts_with("lens.dat:10:12: position 3 is left out"), "{:?}", lens.remarks);
    assert!(lens.remarks[1].contains("glasses XQ7: not known; n_d and V"), "{:?}", lens.remarks);
}

#[test]
fn encodings_and_line_ends_make_no_difference() {
    let plain = ok(ZOOM);
    assert_eq!(ok(&ZOOM.replace('\n', "\r\n")), plain);
    let utf16 = [0xFF, 0xFE].into_iter().chain(ZOOM.bytes().flat_map(|byte| [byte, 0])).collect::<Vec<u8>>();
    assert_eq!(ok(&utf16), plain);
    let latin: Vec<u8> =
        ZOOM.replace("made-up", "Gau?").bytes().map(|byte| if byte == b'?' { 0xDF } else { byte }).collect();
    assert_eq!(ok(&latin).title.as_deref(), Some("A Gauß zoom"));
}

#[test]
fn an_object_at_a_finite_distance_makes_a_position() {
    let near = ok(&ZOOM
        .replace("d0\tInfinity", "d0\t500")
        .replace("\tInfinity\t700\n", "\n")
        .replace("\t9.0\t4\n", "\n"));
    let positions = near.positions.expect("one");
    assert_eq!((positions.columns.len(), positions.columns[0].object_distance), (1, Some(500.0)));
    // S is counted from the film, which is 5 + 1 + 3 + 1 + 2 + 1 + 1.5 + 40 mm behind the first vertex.
    let from_film = ok(&ZOOM.replace("d0\tInfinity", "S\t500"));
    assert_eq!(from_film.positions.expect("two").columns[0].object_distance, Some(500.0 - 54.5));
}

#[test]
fn constants_select_the_powers_of_the_terms() {
    let powers = |constant: &str| -> Vec<usize> {
        let text = ZOOM.replace("Scaled\t50\t100", constant).replace("1e-5\t\t2e-9\t", "1\t2\t3\t4\t5\t6");
        let Shape::Asphere(asphere) = ok(&text).interfaces[1].shape else { panic!("{text}") };
        let of = |coefficient: usize| (1..=30).find(|power| asphere.term(*power) == coefficient as f64);
        (1..=6).map(|coefficient| of(coefficient).expect("a term")).collect()
    };
    assert_eq!(powers("Scaled 50 100"), [4, 6, 8, 10, 12, 14]);
    assert_eq!(powers("AsphericalA2"), [2, 4, 6, 8, 10, 12]);
    // US patent 7,663,816, table 1, has A3, A4, A6 and A8: one odd term.
    assert_eq!(powers("AsphericalOddCount\t1"), [3, 4, 6, 8, 10, 12]);
    assert_eq!(powers("AsphericalOddCount\t2"), [3, 4, 5, 6, 8, 10]);
    assert_eq!(powers("AsphericalOddCount\t0"), [4, 6, 8, 10, 12, 14]);
    assert_eq!(powers("AsphericalOddCount\t2\nAsphericalA2"), [2, 3, 4, 5, 6, 8]);
    let unknown = ok(&ZOOM.replace("Scaled", "Spherical"));
    assert!(unknown.remarks[0].contains("the constant \"Spherical\" is not known"), "{:?}", unknown.remarks);
}

#[test]
fn a_plane_in_air_beside_the_stop_is_a_flare_stop() {
    let named = ok(ZOOM);
    let unnamed = ok(&ZOOM.replace("3\tFS\t", "3\tInfinity\t"));
    assert_eq!(unnamed.interfaces, named.interfaces);
}

#[test]
fn a_glass_with_other_numbers_than_its_name_keeps_the_numbers() {
    let lens = ok(&ZOOM.replace("1.51680", "1.52"));
    assert_eq!(lens.interfaces[0].medium, Medium::Glass { n_d: 1.52, abbe: Some(64.17) });
    assert!(lens.remarks.iter().any(|remark| remark.contains("glasses N-BK7: known with another n_d or V")));
}

#[test]
fn a_malformed_text_is_refused_with_the_location() {
    let with = |from: &str, to: &str| {
        assert!(ZOOM.contains(from), "{from}");
        ZOOM.replacen(from, to, 1)
    };
    refused("[lens data]\n", "2:1", &["no rows"]);
    refused(&with("1\t20.0", "1\t2O.0"), "14:3", &["\"2O.0\" is not a number", "AS (stop)"]);
    refused(&with("5.0\t1.51680", "d9\t1.51680"), "14:8", &["\"d9\" is neither", "[variable distances]"]);
    refused(&with("5.0\t1.51680", "Infinity\t1.51680"), "14:8", &["without end"]);
    refused(&with("5.0\t1.51680", "\t1.51680"), "14:8", &["\"\" is neither"]);
    refused(&with("1.51680", "0.9"), "14:12", &["1 or more"]);
    refused(&with("64.17", "-64.17"), "14:25", &["V-number is positive"]);
    refused(
        &with("1\t20.0\t5.0\t1.51680\t10.0\t64.17\tN-BK7\tSCHOTT", "1 20.0 5.0"),
        "14:1",
        &["no tabs", "separated by tabs"],
    );
    refused(&with("\t10.0\t", "\t\t"), "14:20", &["nothing stands here", "clear diameter"]);
    refused(&with("\t10.0\t", "\t0\t"), "14:1", &["clear diameter 0 mm"]);
    refused(&with("3.0\t9.0", "-3.0\t9.0"), "16:1", &["thickness -3 mm", "0 or more"]);
    refused(&with("d3\t3.0\t9.0\t4", "d3\tundefined"), "10:4", &["at no position"]);
    refused(&with("2\t-20\t-0.5", "22\t-20\t-0.5"), "24:1", &["no surface", "\"22\""]);
    refused(&with("-0.5\t1e-5", "-0.5\tx"), "24:12", &["\"x\" is not a number"]);
    refused(&with("\t\t2e-9", "\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t2e-9"), "24:43", &["beyond A30"]);
    refused(&with("[!aspherical data]", "[aspherical data]"), "25:1", &["second section [aspherical data]"]);
    refused(&with("[!aspherical data]\n1\t20\t9", "2\t20\t9"), "25:1", &["given twice"]);
    refused(&with("Scaled", "ObjectGlass"), "4:1", &["object in glass"]);
    refused(&with("Scaled\t50", "AsphericalOddCount\tx"), "4:20", &["not a number of odd terms"]);
    refused(&with("6\t-30", "6AS\tAS"), "20:1", &["second stop"]);
    let many = format!("[lens data]\n{}", "1\t20\t0\t1.5\t10\n".repeat(1001));
    refused(&many, "1002:1", &["more than 1000 lines", "at most 1000 interfaces"]);
    let positions = with("d3\t3.0", &format!("d3{}", "\t3".repeat(101)));
    refused(&positions, "10:204", &["more than 100 positions"]);
}

#[test]
fn an_index_of_minus_one_is_a_mirror() {
    let rows = [
        "1\tInfinity\t5\t1.5\t89\t60",
        "2\tInfinity\td2\t\t89",
        "3\tInfinity\t35\t\t30.98",
        "4\t-250\t8\t1.54\t86\t47",
        "5\t-330\t0\t\t86",
        "6\t-330\t0\t-1\t86",
        "7\t-330\t-8\t1.54\t86\t47",
        "8\t-250\t-32\t\t86",
        "9\t-500\t0\t-1.0\t30.98",
        "10\t-500\tBf\t\t31",
    ];
    let text = |rows: &str| {
        format!("[variable distances]\nd2\t60\t61\nBf\t90\t89\nd0\tInfinity\t9000\n[lens data]\n{rows}\n")
    };
    // The last row is a plane in air, where the film distance begins.
    let lens = ok(&text(&rows.join("\n").replace("10\t-500", "10\tFS")));
    let mirrors: Vec<bool> = lens.interfaces.iter().map(|own| own.is_mirror).collect();
    assert_eq!(mirrors, [false, false, false, false, true, false, true, false]);
    assert_eq!((lens.interfaces[4].thickness, lens.interfaces[4].medium), (-8.0, lens.interfaces[3].medium));
    assert!(lens.interfaces[2].apertures[0].is_obstruction && !lens.interfaces[2].is_stop);
    assert!(lens.remarks[0].contains("is taken for an obstruction"), "{:?}", lens.remarks);
    let positions = lens.positions.expect("two");
    assert_eq!((positions.gaps, &positions.columns[1].gaps), (vec![1, 7], &vec![61.0, 89.0]));
    refused(
        &text(&rows.join("\n").replace("-8\t1.54", "8\t1.54")),
        "11:1",
        &["behind an odd number of mirrors"],
    );
}
