use crate::prescription::{
    CoordinateBreak, Fate, Outline,
    glass::{D_LINE, refractive_index},
    interfaces::{Medium, Shape},
    reader::checks::{ok, refused, replaced},
};

const LENS: &str = "RDM;LEN       \"VERSION: 11.2\"\n\
    TITLE 'A made-up lens'\n\
    EPD   8.0\nDIM   M\nWL    656.3 587.6 &\n  486.1\nREF   2\nWTW   1 1 1\nXAN   0.0 3.0\nYAN   0.0 4.0\nCCC   1\n\
    ! a comment; S 1 2 3\n\
    SO    0.0 0.1e14\n\
    S     20.0 4.0 NBK7_SCHOTT ; CIR 5.0\n  CIR EDG 6.0\n  CON\n  K -0.5; CCY 0\n\
    S     -20.0 1.5\n  CIR 5.0\n  ASP\n  K 0.0\n  CUF 0.0\n  A 0; B 1e-6; C 0.0; D 0.0\n  J 2e-20\n  XDE 0.0; YDE 0.0\n\
    S     0.0 2.0\n  STO\n\
    s     -25.0 2.0 620.6030\n  cir 4.0\n\
    S     0.0 30.5 ! behind\n  CIRCLE 4\n  PIM\n  THI HMY 0.0\n\
    SI    0.0 -0.5\n\
    CIR S4 4.5\nPIK THI S3 Z1 THI S1 Z1\nGO\n";

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
    assert_eq!((even.radius, even.term(6), even.term(20)), (-20.0, 1e-6, 2e-20));
    assert_eq!((stop.shape, stop.is_stop), (Shape::Plane, true));
    // A later statement with a qualifier replaces an earlier one.
    assert_eq!((third.semi_diameter, last.semi_diameter), (4.5, 4.0));
    assert!((refractive_index(first.medium, D_LINE) - 1.5168).abs() < 1e-5);
    assert_eq!(third.medium, Medium::Glass { n_d: 1.62, abbe: Some(60.3) });
    // The thickness of the image is added to the last one.
    assert_eq!(
        (lens.nominal_film_distance, lens.positions, lens.wavelength),
        (Some(30.0), None, Some(587.6))
    );
    assert_eq!(lens.stated.fields, [Some(10.0)]);
    assert!(lens.remarks.is_empty(), "{:?}", lens.remarks);
}

#[test]
fn every_statement_has_a_fate() {
    let lens = ok(LENS);
    let of = |fate: Fate| {
        let own = lens.findings.iter().filter(move |finding| finding.fate == fate);
        own.map(|finding| (finding.statement.as_str(), finding.lines())).collect::<Vec<_>>()
    };
    assert_eq!(of(Fate::LeftOut), [("CCC", vec![11])]);
    // Its effect is not known.
    assert!(lens.findings.iter().all(|finding| finding.may_differ == (finding.statement == "CCC")));
    assert_eq!(of(Fate::Replaced), []);
    let used = of(Fate::Used);
    for statement in ["RDM", "TIT", "EPD", "DIM", "WL", "REF", "SO", "S", "CIR", "K", "A", "XDE", "STO", "SI"]
    {
        assert!(used.iter().any(|(known, _)| *known == statement), "{statement}: {used:?}");
    }
    let informative = of(Fate::Informative);
    for statement in ["LEN", "WTW", "comment", "CIR", "CCY", "PIM", "THI", "PIK", "GO"] {
        assert!(informative.iter().any(|(known, _)| *known == statement), "{statement}: {informative:?}");
    }
    let all: usize = lens.findings.iter().map(|finding| finding.lines().len()).sum();
    assert!(all >= LENS.lines().count() - 1, "{all}");
}

#[test]
fn units_and_modes_make_no_difference() {
    let plain = ok(LENS);
    assert_eq!(ok(&LENS.replace('\n', "\r\n")).interfaces, plain.interfaces);
    let inches = ok(&with("DIM   M", "DIM   I"));
    assert_eq!(inches.interfaces, plain.scaled(25.4).interfaces);
    let curvatures = with("RDM;LEN", "RDM N;LEN")
        .replace("20.0 4.0 N", "0.05 4.0 N")
        .replace("-20.0 1.5", "-0.05 1.5")
        .replace("-25.0 2.0", "-0.04 2.0");
    assert_eq!(ok(&curvatures).interfaces, plain.interfaces);
    let set = with("20.0 4.0 N", "99 1.0 N").replace("  CON\n", "  CON; RDY 20; THI 4.0\n");
    assert_eq!(ok(&set).interfaces, plain.interfaces);
}

#[test]
fn the_aperture_can_be_stated_in_four_ways() {
    let stop = |text: &str| ok(text).interfaces[2].semi_diameter;
    let sizes = ["FNO 4", "FNO 2"].map(|fnumber| stop(&with("EPD   8.0", fnumber)));
    assert!((sizes[1] / sizes[0] - 2.0).abs() < 1e-12);
    assert_eq!(ok(&with("EPD   8.0", "FNO 4")).stated.fnumber, Some(4.0));
    // The sine of the half angle in the image is half of the reciprocal of the f-number, less a cosine.
    let by_na = stop(&with("EPD   8.0", "NA 0.125"));
    assert!((by_na / sizes[0] - 1.0 / (1.0_f64 - 0.125 * 0.125).sqrt()).abs() < 1e-9, "{by_na} {sizes:?}");
    let near = with("0.1e14", "95");
    let sizes = ["NAO 0.03", "NAO 0.02"].map(|na| stop(&near.replace("EPD   8.0", na)));
    assert!((sizes[0] / sizes[1] - 1.5).abs() < 1e-3, "{sizes:?}");
    assert_eq!(ok(&near).positions.expect("one").columns[0].object_distance, Some(95.0));
    let two = ok(&with("EPD   8.0", "FNO 4; EPD 8"));
    assert_eq!(two.interfaces, ok(LENS).interfaces);
    assert!(two.remarks[0].contains("a later statement replaces this aperture"), "{:?}", two.remarks);
}

/// A singlet without `RDM`, of radii ±50 or curvatures ±0.02.
fn singlet(of: impl Fn(f64) -> f64, others: &str, cir: &str, back: f64) -> String {
    let [first, second] = [50.0, -50.0].map(of);
    format!("TIT 'x'\n{others}\nSO 0 1e11\nS {first} 5 NBK7\nSTO\n{cir}\nS {second} {back}\nSI 0 0\n")
}

#[test]
fn the_file_decides_between_radii_and_curvatures() {
    let of = |text: &str| {
        let lens = ok(text);
        let Shape::Sphere { radius } = lens.interfaces[0].shape else { panic!("{lens:?}") };
        let reason =
            lens.findings.iter().find(|finding| finding.statement == "S" && finding.fate == Fate::Replaced);
        (radius, reason.expect("a reason").reason.clone())
    };
    for (others, cir, why) in [
        ("EPD 10", "", "wider than its sphere"),
        ("FNO 5", "CIR 8", "wider than its sphere"),
        ("FNO 5", "", "out of focus"),
    ] {
        for (numbers, name) in [(f64::recip as fn(f64) -> f64, "curvatures"), (|radius| radius, "radii")] {
            let (radius, reason) = of(&singlet(numbers, others, cir, 47.5));
            assert!((radius - 50.0).abs() < 1e-9, "{others} {name}: {radius}");
            assert!(reason.contains(name) && reason.contains(why), "{reason}");
        }
    }
    // In no reading is the image in focus, and no size decides.
    let open = singlet(|radius| radius, "FNO 5", "", 20.0);
    refused(&open, "4:1", &["a radius or a curvature", "as radii the focal length is 49.", "RDM Y", "RDM N"]);
    assert!(ok(&open.replace("TIT", "RDM N;TIT")).interfaces.len() == 2);
    // An ellipsoid may be wider than its radius.
    let conic = singlet(|radius| radius, "EPD 101", "K -0.5", 47.5);
    assert_eq!(ok(&conic).interfaces.len(), 2);
}

#[test]
fn glasses_are_names_codes_and_the_files_own() {
    let index = |glass: &str, nm: f64| {
        let lens = ok(&with("NBK7_SCHOTT", glass));
        refractive_index(lens.interfaces[0].medium, nm)
    };
    let near =
        |index: f64, expected: f64| assert!((index - expected).abs() < 2e-5, "{index}, not {expected}");
    near(index("517642", D_LINE), 1.517);
    near(index("516800.641700", D_LINE), 1.5168);
    near(index("1.5168:64.17", D_LINE), 1.5168);
    near(index("'N-BK7'", D_LINE), 1.5168);
    // The constants and the index of NOA61, and indices of N-BK7.
    let catalogue = "PRV\n  PWL 656.27 587.56 486.13\n  'NOA61' LAU 2.36390625 0.0 0.025493134 -0.000580235&\n -0.349933e-5 0.445404e-7\n  'OWN' 1.51432 1.51680 1.52238\nEND\nSO ";
    let own = |glass: &str| with("NBK7_SCHOTT", glass).replacen("SO ", catalogue, 1);
    let of = |glass: &str, nm: f64| refractive_index(ok(&own(glass)).interfaces[0].medium, nm);
    near(of("'NOA61'", D_LINE), 1.55975);
    near(of("own", 486.13), 1.52238);
    near(of("own", 546.07), 1.51872);
    assert_eq!(ok(&own("OWN")).glasses[0].0, "OWN");
    refused(&own("OWN").replace("1.51432", "0.9"), "17:3", &["glass OWN: index 0.9 at 656.27 nm"]);
    refused(&own("OWN").replace("1.51432", ""), "17:3", &["glass OWN: 2 indices at 3 wavelengths (PWL)"]);
    refused(&own("OWN").replace("1.51432", "SEL 2"), "17:3", &["a definition by SEL", "LAU"]);
    // The definition of a glass that no surface names is not needed.
    assert!(ok(&own("NBK7").replace("1.51432", "SEL 2")).interfaces.len() == 5);
    let foreign = ok(&with("NBK7_SCHOTT", "NBK7_NOBODY"));
    assert!(foreign.remarks[0].contains("no glass NBK7 of NOBODY is known"), "{:?}", foreign.remarks);
    refused(&with("NBK7_SCHOTT", "XQ7_SCHOTT"), "14:16", &["glass \"XQ7\" is not known"]);
    refused(&with("NBK7_SCHOTT", "1.5 60"), "14:20", &["\"60\" behind the glass"]);
}

#[test]
fn apertures_have_a_form_a_place_and_a_kind() {
    let of = |cir: &str| ok(&with("CIR 5.0\n  CIR EDG", &format!("{cir}\n  CIR EDG"))).interfaces[0].clone();
    let placed = of("REX 3; REY 2; ADX 1; ADY -0.5");
    let [rectangle] = &*placed.apertures else { panic!("{placed:?}") };
    assert_eq!((rectangle.outline.clone(), rectangle.center), (Outline::Rectangle([3.0, 2.0]), [1.0, -0.5]));
    assert_eq!(placed.semi_diameter, 4.0_f64.hypot(2.5));
    let ring = of("CIR CLR 5; CIR OBS L'A' 2");
    let [obstruction] = &*ring.apertures else { panic!("{ring:?}") };
    assert!(obstruction.is_obstruction && ring.semi_diameter == 5.0, "{ring:?}");
    assert_eq!(obstruction.outline, Outline::Ellipse([2.0; 2]));
    assert_eq!(of("ELX 3; ELY 2").apertures[0].outline, Outline::Ellipse([3.0, 2.0]));
    let wrong = |cir: &str, parts: &[&str]| {
        refused(&with("CIR 5.0\n  CIR EDG", &format!("{cir}\n  CIR EDG")), "14:30", parts)
    };
    wrong("CIR HOL 2", &["surface 1 has a hole and is no mirror"]);
    wrong("REX 2", &["without two positive sizes"]);
    wrong("CIR -2", &["without two positive sizes"]);
    wrong("ADY 2", &["the place of an aperture, and no aperture"]);
    wrong("ELG 1 2 3", &["no order that is known for certain", "ELG 1 2 3"]);
    wrong("ARO 30", &["has a rotated aperture"]);
    refused(
        &with("CIR 5.0\n  CIR EDG", "CIR 5; CIR XYZ 3\n CIR EDG"),
        "14:41",
        &["\"XYZ\" is not a qualifier"],
    );
    refused(&with("CIR 5.0\n  CIR EDG", "CIR 5; REX 3\n CIR EDG"), "14:30", &["an aperture of two forms"]);
    refused(
        &with("CIR 5.0\n  CIR EDG", "CIR 5; CIR L'B' 3\n CIR EDG"),
        "14:37",
        &["a second clear aperture"],
    );
}

#[test]
fn what_is_not_traced_is_refused_by_name() {
    let stop = |to: &str| with("  STO\n", &format!("  STO\n  {to}\n"));
    refused(&stop("REV; YDE 2"), "28:3", &["surface 3 has a reversed tilt or decentring", "(REV)"]);
    refused(&stop("BEN; YDE 2"), "28:3", &["surface 3 has a bend that is not one tilt", "(BEN)"]);
    refused(&stop("XOD 1"), "28:3", &["an offset of the axis of its tilts, which is not traced (XOD 1)"]);
    refused(
        &with(
            "S     20.0",
            "ADE 3
S     20.0",
        ),
        "14:1",
        &["a tilted or decentred object"],
    );
    refused(&stop("CYL"), "28:3", &["is a cylinder or toroid"]);
    refused(&stop("DIF DOE"), "28:3", &["is a grating or a hologram"]);
    refused(&stop("CUF 0.1"), "28:3", &["is a Fresnel surface"]);
    refused(&stop("SPS XYP"), "28:3", &["is a surface of a special type"]);
    refused(&stop("GLA BK7"), "28:3", &["has its glass in a statement of its own"]);
    refused(&stop("ZOO 3"), "28:3", &["ZOO 3: zoom positions, which are not read"]);
    refused(&stop("IN CV_LENS:dbgauss"), "28:3", &["the lens goes on in another file"]);
    assert_eq!(ok(&stop("ADE 0; BDE 0.0; DAR; ZOO 1")).interfaces, ok(LENS).interfaces);
}

#[test]
fn a_malformed_file_is_refused_with_the_location() {
    refused("RDM\n", "1:1", &["no surface", "SO, the object"]);
    refused("RDM\nSO 0 1e20\n", "2:1", &["no image behind this surface"]);
    refused("RDM\nSO 0 1e20\nSI 0 0\n", "3:1", &["no lens before the image"]);
    refused("RDM\nCIR 4\n", "2:1", &["CIR 4 belongs to a surface"]);
    refused("RDM\nS 0 4\n", "2:1", &["in front of the object (SO)"]);
    refused("RDM\nSO 0 4\nSO 0 4\n", "3:1", &["a second object"]);
    refused(&format!("{LENS}S 20 4\n"), "38:1", &["a surface behind the image"]);
    refused(&with("S     -20.0", "S4    -20.0"), "18:1", &["surface 4 where surface 2 is expected"]);
    assert_eq!(ok(&with("S     -20.0", "S2    -20.0")).interfaces, ok(LENS).interfaces);
    refused(&with("CIR S4", "CIR S9"), "35:5", &["\"S9\" is not one surface"]);
    refused(&with("CIR S4", "CIR S1..4"), "35:5", &["\"S1..4\" is not one surface"]);
    refused(&with("20.0 4.0 N", "2O.0 4.0 N"), "14:7", &["\"2O.0\" is not a number", "value 1 of S"]);
    refused(&with("S     -20.0 1.5", "S     -20.0"), "18:1", &["S lacks its value 2"]);
    refused(&with("S     -20.0 1.5", "S     -20.0 inf"), "18:1", &["without end"]);
    refused(&with("S     -20.0 1.5", "S     -20.0 -9"), "18:1", &["surface 2: thickness -9 mm"]);
    refused(&with("EPD   8.0", "EPD   -8.0"), "3:1", &["EPD -8.0 is not an aperture"]);
    refused(&with("EPD   8.0", "NAO   1.5"), "3:1", &["NAO 1.5 is not an aperture"]);
    refused(&with("DIM   M", "DIM   F"), "4:7", &["\"F\" is not a unit: M, C or I"]);
    refused(&with("RDM;LEN", "RDM Q;LEN"), "1:5", &["\"Q\" is not Y (radii) or N (curvatures)"]);
    refused(&with("REF   2", "REF   4"), "7:1", &["the reference is wavelength 4, and the file has 3"]);
    refused(&with("587.6", "10600"), "5:13", &["the primary wavelength is 10600 nm"]);
    refused(&with("J 2e-20", "J x"), "24:5", &["\"x\" is not a number"]);
    refused(&with("0.1e14", "-5"), "13:1", &["expected a positive distance"]);
    refused(&with("  PIM", "  STO"), "30:1", &["a second stop"]);
    let open = with("SI    0.0 -0.5", "SI    0.01 -60");
    assert!(ok(&open).remarks.iter().any(|remark| remark.contains("the image is curved")));
    assert_eq!(ok(&open).nominal_film_distance, None);
    let many = format!("RDM\nSO 0 1e20\n{}SI 0 0\n", "S 0 1\n".repeat(2000));
    refused(&many, "1004:1", &["more surfaces"]);
}

#[test]
fn a_lens_without_a_stop_has_that_of_the_program() {
    let lens = ok(&with("  STO\n", ""));
    assert!(lens.interfaces[0].is_stop && lens.interfaces[0].semi_diameter == 4.0);
    assert!(
        lens.remarks[0].contains("no stop (STO) is stated; the first surface is the stop"),
        "{:?}",
        lens.remarks
    );
    let none = ok(&with("REF   2\n", ""));
    assert_eq!(none.wavelength, None);
    assert!(none.remarks[0].contains("several wavelengths and no reference (REF)"), "{:?}", none.remarks);
}

#[test]
fn tilts_decentres_and_mirrors_are_read() {
    // A fold by a bend, a decentred lens, and a tilted film.
    let text = "RDM\nEPD 8\nDIM M\nSO 0 1e14\nS 50 4 517642\n  STO; CIR 6\nS -50 20\n  CIR 6\nS 0 -30 REFL\n  ADE -40; BEN; CIR 9; CIR HOL 1\n\
        S -60 -3 517642\n  XDE 1; YDE 2; ZDE 0.5; ADE 1; BDE 2; CDE 3; DAR; CIR 8\nS 60 -15\n  CIR 8; BDE 4\nSI 0 0\n  ADE 5\n";
    let lens = ok(text);
    assert_eq!(lens.remarks, [""; 0]);
    let [_, second, mirror, third, last] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
    let [fold, film] = [40.0, -5.0].map(|angle| CoordinateBreak::tilted([angle, 0.0, 0.0]));
    let along = |z: f64| CoordinateBreak::shifted([0.0, 0.0, z]);
    let own = CoordinateBreak::shifted([1.0, 2.0, 0.5]).then(&CoordinateBreak::tilted([-1.0, -2.0, 3.0]));
    let is_near = |found: Option<CoordinateBreak>, expected: CoordinateBreak| {
        let apart = found.expect("a change").then(&expected.inverse());
        let off = |i: usize, j: usize| apart.rotation[i][j] - f64::from(i == j);
        let all = (0..9).map(|i| off(i / 3, i % 3)).chain(apart.shift);
        assert!(all.into_iter().all(|off| off.abs() < 1e-13), "{found:?} {expected:?}");
    };
    assert!(mirror.is_mirror && mirror.medium == Medium::Air && second.thickness == 20.0);
    assert!(mirror.apertures[0].is_obstruction && mirror.apertures[0].reach() == 1.0);
    is_near(mirror.coordinate_break, fold);
    is_near(third.coordinate_break, fold.then(&along(-30.0)).then(&own));
    is_near(
        last.coordinate_break.map(|change| along(last.thickness).then(&change)),
        own.inverse().then(&along(-3.0)).then(&CoordinateBreak::tilted([0.0, -4.0, 0.0])),
    );
    is_near(lens.film_break, along(-15.0).then(&film).then(&along(15.0)));
    assert_eq!(lens.nominal_film_distance, Some(15.0));
}
