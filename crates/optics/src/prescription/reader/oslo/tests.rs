use crate::prescription::{
    Fate,
    glass::{D_LINE, refractive_index},
    interfaces::{Medium, Shape},
    reader::checks::{ok, refused, replaced},
};

const LENS: &str = "// OSLO 6.6 1 2 3\n\
    LEN NEW \"A made-up lens\" 100 5\n\
    EBR  4.0\nANG  5.0\nDES  \"Nobody\"\nUNI  1.0\n\
    // SRF 0\nAIR\nTH  1.0e+20\nAP 1e19\n\
    NXT  // SRF 1\nGLA N-BK7\nRD  20.0\nTH  4.0\nCC  -0.5\nAP CHK 5.0\n\
    NXT  // SRF 2\nAIR\nRD  -20.0\nTH  1.5\nAE  1e-6\nAP CHK 5.0\n\
    NXT  // SRF 3\nAIR\nAST\nTH  2.0\nDCX 0.0\nAP  9.0\n\
    NXT  // SRF 4\nWV 0.58756 0.48613 0.65627\nGLA MOD OWN 1.62 1.6272 1.6169\nRD  -25.0\nTH  2.0\nAP  4.0\n\
    NXT  // SRF 5\nAIR\nTH  30.0\n\
    NXT  // SRF 6\nAIR\nTH  -0.5\n\
    WV 0.58756 0.48613 0.65627\nWW 1.0 1.0 1.0\nEND  6\nXYZ 1\n";

fn with(from: &str, to: &str) -> String {
    replaced(LENS, from, to)
}

#[test]
fn surfaces_between_object_and_image_are_read() {
    let lens = ok(LENS);
    assert_eq!(lens.title.as_deref(), Some("A made-up lens"));
    let [first, second, stop, third, last] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
    let Shape::Asphere(conic) = first.shape else { panic!("{first:?}") };
    assert_eq!((conic.radius, conic.conic, first.semi_diameter), (20.0, -0.5, 5.0));
    let Shape::Asphere(even) = second.shape else { panic!("{second:?}") };
    assert_eq!((even.radius, even.term(6)), (-20.0, 1e-6));
    // The stop is as large as the beam, and not as its aperture, which limits no ray.
    assert!(stop.is_stop && (2.0..4.0).contains(&stop.semi_diameter), "{stop:?}");
    assert!((refractive_index(first.medium, D_LINE) - 1.5168).abs() < 1e-5);
    for (nm, index) in [(587.56, 1.62), (486.13, 1.6272), (656.27, 1.6169)] {
        assert!((refractive_index(third.medium, nm) - index).abs() < 1e-9, "{nm}");
    }
    assert_eq!((third.semi_diameter, last.shape), (4.0, Shape::Plane));
    assert_eq!(
        (lens.nominal_film_distance, lens.wavelength, lens.positions),
        (Some(29.5), Some(587.56), None)
    );
    assert_eq!(lens.stated.fields, [Some(10.0)]);
    assert!(lens.remarks[0].contains("surface 5: no semi-diameter is stated"), "{:?}", lens.remarks);
    assert_eq!(lens.remarks.len(), 1);
}

#[test]
fn every_statement_has_a_fate() {
    let lens = ok(LENS);
    let of = |fate: Fate| {
        let own = lens.findings.iter().filter(move |finding| finding.fate == fate);
        own.map(|finding| finding.statement.as_str()).collect::<Vec<_>>()
    };
    assert_eq!(of(Fate::LeftOut), ["XYZ"]);
    assert_eq!(of(Fate::Replaced), ["AP", "AP"]);
    for statement in
        ["LEN", "EBR", "ANG", "UNI", "NXT", "GLA", "RD", "TH", "CC", "AP", "AE", "AST", "WV", "END"]
    {
        assert!(of(Fate::Used).contains(&statement), "{statement}: {:?}", of(Fate::Used));
    }
    for statement in ["comment", "DES", "WW", "TH"] {
        assert!(of(Fate::Informative).contains(&statement), "{statement}: {:?}", of(Fate::Informative));
    }
}

#[test]
fn units_and_forms_make_no_difference() {
    let plain = ok(LENS);
    assert_eq!(ok(&with("UNI  1.0", "UNI  10")).interfaces, plain.scaled(10.0).interfaces);
    assert_eq!(ok(&with("RD  20.0\nTH  4.0", "CV 0.05; TH 4")).interfaces, plain.interfaces);
    let first = |glass: &str| ok(&with("GLA N-BK7", glass)).interfaces[0].medium;
    assert_eq!(first("GLA 517642"), Medium::Glass { n_d: 1.517, abbe: Some(64.2) });
    assert_eq!(first("GLA 1.5"), Medium::Glass { n_d: 1.5, abbe: None });
    assert!((refractive_index(first("GLA 1.5168 1.52238 1.51432"), 486.13) - 1.52238).abs() < 1e-9);
}

#[test]
fn the_aperture_can_be_stated_in_three_ways() {
    let stop = |text: &str| ok(text).interfaces[2].semi_diameter;
    let sizes = ["FNO 4", "FNO 2"].map(|fnumber| stop(&with("EBR  4.0", fnumber)));
    assert!((sizes[1] / sizes[0] - 2.0).abs() < 1e-12);
    // A beam of radius 4 mm at the first surface, from an object point 100 mm in front of it.
    let near = with("TH  1.0e+20", "TH 100.0");
    let by_na = near.replace("EBR  4.0", &format!("NAO {}", 4.0 / 100.0_f64.hypot(4.0)));
    assert!((stop(&near) - stop(&by_na)).abs() < 1e-12);
    assert_eq!(ok(&near).positions.expect("one").columns[0].object_distance, Some(100.0));
}

#[test]
fn what_is_not_traced_is_refused_by_name() {
    let stop = |to: &str| with("DCX 0.0", to);
    refused(&stop("TLA 10"), "27:1", &["surface 3 has a tilt or decentring, which is not traced (TLA 10)"]);
    refused(&stop("RFL"), "27:1", &["is a mirror"]);
    refused(&stop("PFL 100"), "27:1", &["is an ideal lens"]);
    refused(&stop("AY1 A -1"), "27:1", &["has an aperture of another form"]);
    refused(&stop("PK TH -2 0.0"), "27:1", &["a pickup or a solve"]);
    refused(&stop("AH 1e-9"), "27:1", &["has a figure of another kind"]);
    refused(&with("WW 1.0", "CFG 2\nWW 1.0"), "42:1", &["configurations, which are not read"]);
}

#[test]
fn a_malformed_file_is_refused_with_the_location() {
    refused("LEN NEW \"x\" 50 3\n", "1:1", &["fewer than two surfaces"]);
    refused("LEN NEW \"x\" 50 3\nNXT\n", "2:1", &["no lens before the image"]);
    refused("LEN NEW \"x\" 50 3\nLEN NEW\n", "2:1", &["a second lens"]);
    refused(&with("RD  20.0", "RD  2O.0"), "13:5", &["\"2O.0\" is not a number", "value 1 of RD"]);
    refused(&with("RD  20.0", "RD"), "13:1", &["RD lacks its value 1"]);
    refused(&with("TH  1.5", "TH  1e20"), "20:1", &["surface 2 has a thickness without end"]);
    refused(&with("GLA N-BK7", "GLA XQ7"), "12:5", &["glass \"XQ7\" is not known"]);
    refused(&with("GLA N-BK7", "GLA"), "12:1", &["GLA without a glass"]);
    refused(&with("GLA N-BK7", "GLA 1.5 1.6"), "12:1", &["2 indices of a glass at 3 wavelengths"]);
    refused(&with("AP CHK 5.0", "AP CHK"), "16:1", &["AP lacks its value 2"]);
    refused(&with("AP CHK 5.0", "AP -5.0"), "16:1", &["a negative semi-diameter"]);
    refused(&with("EBR  4.0", "EBR  0"), "3:1", &["EBR 0 is not an aperture"]);
    refused(&with("UNI  1.0", "UNI  0"), "6:1", &["a unit that is not positive"]);
    refused(&with("AP CHK 5.0\nNXT", "AST\nNXT"), "23:1", &["surface 3 is a second stop"]);
    let many = format!("LEN NEW \"x\" 1 1\n{}", "NXT\n".repeat(2000));
    refused(&many, "1003:1", &["more surfaces"]);
}
