//! Tests of every format with one lens whose numbers are computed by hand, and of every refusal.
//!
//! The lens: n 1.5, V 60, radii 50 and -50, 5 mm thick, and a stop 1 mm behind. The ray parallel to the axis at height 5
//! has the height 29/6 at the second surface and the slope -59/600 behind it; at the stop its height is 4.735.

use crate::prescription::{
    Coating, CoordinateBreak, Fate, Medium, Outline, Prescription, Shape, read,
    reader::checks::{FILE, ok, refused, replaced as with},
};

const LHLT: &str = r#"{"FormatVersion": 1,
 "Title": "Made up",
 "Aperture": {"Type": "EPD", "Value": 10},
 "FieldType": "ObjectAngle",
 "Surfaces": [
  {"Thickness": "Infinity"},
  {"Index": 1, "Comment": "idle", "Thickness": 2},
  {"Radius": 50, "Thickness": 5, "Material": "500.6000", "SemiDiameter": 12.7, "SemiDiameterMode": "Fixed",
   "ClearAperturePercent": 125, "CurvatureVariable": true},
  {"Radius": -50, "Thickness": 1, "SemiDiameter": 9, "SemiDiameterMode": "Fixed"},
  {"Radius": "Infinity", "Thickness": 40, "IsStop": true},
  {}
 ],
 "Wavelengths": [{"Value": 0.48}, {"Value": 0.5875618, "IsPrimary": true}],
 "Fields": [{"Y": 0}, {"Y": 10}], "Unheard": 3
}
"#;

const RAY_OPTICS: &str = r#"{"optical_model": {"__instance_type__": ["o", "OpticalModel"], "attributes": {
 "specsheet": {"imager": [-Infinity, NaN, Infinity]},
 "system_spec": {"attributes": {"title": "Made up", "_dimensions": "mm"}},
 "seq_model": {"attributes": {"stop_surface": 3, "ifcs": [
  {"__instance_type__": ["s", "Surface"], "attributes": {"interact_mode": "dummy", "profile_id": "0"}},
  {"__instance_type__": ["s", "Surface"], "attributes": {"profile_id": "1", "max_aperture": 8.0, "clear_apertures": []}},
  {"__instance_type__": ["s", "Surface"], "attributes": {"interact_mode": "transmit", "profile_id": "2", "max_aperture": 8.0,
   "clear_apertures": [{"__instance_type__": ["s", "Circular"], "attributes": {"radius": 9.0, "x_offset": 0.0}}]}},
  {"__instance_type__": ["s", "Surface"], "attributes": {"profile_id": "0", "max_aperture": 3.0}},
  {"__instance_type__": ["s", "Surface"], "attributes": {"profile_id": "0"}}],
  "gaps": [
  {"attributes": {"thi": 1e10, "medium": {"__instance_type__": ["m", "Air"]}}},
  {"attributes": {"thi": 5.0, "medium": {"__instance_type__": ["m", "ModelGlass"], "attributes": {"n": 1.5, "v": 60}}}},
  {"attributes": {"thi": 1.0, "medium": {"__instance_type__": ["m", "Air"]}}},
  {"attributes": {"thi": 40.0, "medium": {"__instance_type__": ["m", "Air"]}}}]}},
 "optical_spec": {"attributes": {
  "pupil": {"attributes": {"_key": ["aperture", "object", "epd"], "value": 10.0}},
  "field_of_view": {"attributes": {"key": ["field", "object", "angle"], "value": 10, "is_relative": true,
   "fields": [{"attributes": {"y": 1.0}}]}},
  "spectral_region": {"attributes": {"wavelengths": [486.1327, 587.5618], "reference_wvl": 1}}}},
 "profile_dict": {
  "0": {"__instance_type__": ["p", "Spherical"], "attributes": {"cv": 0.0}},
  "1": {"__instance_type__": ["p", "Spherical"], "attributes": {"cv": 0.02}},
  "2": {"__instance_type__": ["p", "Spherical"], "attributes": {"cv": -0.02}}}
}}}
"#;

const OPTILAND: &str = r#"{"version": 1.0, "aperture": {"type": "EPD", "value": 10},
 "fields": {"fields": [{"x": 0.0, "y": 10}], "field_type": "angle"},
 "wavelengths": {"wavelengths": [{"value": 0.5875618, "is_primary": true, "unit": "um"}]},
 "surface_group": {"surfaces": [
  {"type": "ObjectSurface", "geometry": {"type": "Plane", "cs": {"z": -Infinity}, "radius": Infinity},
   "material_post": {"type": "IdealMaterial", "index": 1.0, "absorp": 0.0}},
  {"type": "Surface", "geometry": {"type": "StandardGeometry", "cs": {"x": 0.0, "z": 0.0}, "radius": 50, "conic": 0.0},
   "material_post": {"type": "AbbeMaterial", "index": [1.5], "abbe": [60]},
   "aperture": {"type": "RadialAperture", "r_max": 8, "r_min": 0}, "coating": null},
  {"type": "Surface", "geometry": {"type": "StandardGeometry", "cs": {"z": 5.0}, "radius": -50, "conic": 0.0},
   "material_post": {"type": "IdealMaterial", "index": 1.0}, "aperture": null},
  {"type": "Surface", "geometry": {"type": "Plane", "cs": {"z": 6.0}, "radius": Infinity}, "is_stop": true,
   "material_post": {"type": "IdealMaterial", "index": 1.0}},
  {"type": "Surface", "geometry": {"type": "Plane", "cs": {"z": 46.0}, "radius": Infinity}}]}}
"#;

const DEEP_LENS: &str = r#"{"info": "Made up", "foclen": 50.8, "fnum": 5, "(note)": 1, "r_sensor": 21.6,
 "surfaces": [
  {"type": "Spheric", "r": 8.0, "c": 0.02, "roc": 50, "d": 0, "mat1": "air", "mat2": "1.5/60", "d_next": 5},
  {"type": "Spheric", "r": 9.0, "(c)": -0.03, "roc": -50.0, "mat2": "air", "d_next": 1.0},
  {"type": "Aperture", "r": 4.735, "d_next": 40.0}]}
"#;

const GHOSTLIGHT: &str = r#"{"format": "ghostlight-optical", "version": {"major": 1, "minor": 0},
 "metadata": {"name": "Made up", "focal_length_mm": 50.8},
 "glass_catalogue": {"crown": {"name": "Crown", "dispersion": {"model": "abbe", "nd": 1.5, "Vd": 60}}},
 "optical_system": [
  {"type": "element", "id": "a", "transform": {"position": {"mode": "absolute", "x": 0, "y": 0, "z": -46}},
   "surfaces": [
    {"id": "b", "semi_aperture": 8, "form": {"type": "sphere", "radius": 50}, "thickness": 5,
     "modifiers": [{"type": "coating", "model": "simple", "ar_layers": 1}]},
    {"id": "c", "semi_aperture": 9, "form": {"type": "sphere", "radius": -50}, "thickness": 77}],
   "materials": [{"glass": "crown"}]},
  {"type": "element", "transform": {"position": {"mode": "relative_to_preceding", "z": 6}},
   "surfaces": [{"semi_aperture": 4.735, "is_stop": true, "form": {"type": "sphere", "radius": 0}}], "materials": []}],
 "pivots": [{"id": "p", "elements": ["a"], "offset": {"position": {"x": 0, "z": 0}}}]}
"#;

const ALL: [&str; 5] = [LHLT, RAY_OPTICS, OPTILAND, DEEP_LENS, GHOSTLIGHT];

/// Returns a file with its first `from` replaced.
/// Returns `line:column` of the first `word` of a text.
fn at(text: &str, word: &str) -> String {
    let start = text.find(word).expect("a word of the text");
    let line = text[..start].matches('\n').count() + 1;
    format!("{line}:{}", start - text[..start].rfind('\n').map_or(0, |end| end + 1) + 1)
}

/// Checks that `from`, replaced by `to`, is refused at the first `place` of the text.
#[track_caller]
fn refuses(text: &str, from: &str, to: &str, place: &str, message: &str) {
    let changed = with(text, from, to);
    refused(&changed, &at(&changed, place), &[message]);
}

fn findings(lens: &Prescription, fate: Fate) -> Vec<&str> {
    let own = lens.findings.iter().filter(|finding| finding.fate == fate);
    own.map(|finding| finding.statement.as_str()).collect()
}

#[test]
fn all_formats_state_the_same_lens() {
    for text in ALL {
        let lens = ok(text);
        let [first, second, stop] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
        assert_eq!(
            (&first.shape, &second.shape),
            (&Shape::Sphere { radius: 50.0 }, &Shape::Sphere { radius: -50.0 })
        );
        assert_eq!((first.thickness, second.thickness, lens.nominal_film_distance), (5.0, 1.0, Some(40.0)));
        assert_eq!(
            (first.medium, second.medium),
            (Medium::Glass { n_d: 1.5, abbe: Some(60.0) }, Medium::Air)
        );
        assert!((stop.semi_diameter - 4.735).abs() < 1e-12, "{}", stop.semi_diameter);
        assert_eq!((lens.stop_in_air(), lens.positions.is_none()), (Some(2), true));
        if text != OPTILAND {
            assert_eq!((second.semi_diameter, lens.title.as_deref()), (9.0, Some("Made up")));
        }
        if [LHLT, RAY_OPTICS, OPTILAND].contains(&text) {
            assert_eq!((lens.wavelength, lens.stated.fields.as_slice()), (Some(587.5618), &[Some(20.0)][..]));
        } else {
            assert_eq!(lens.stated_focal_length, Some(50.8));
        }
    }
    let coatings = ok(GHOSTLIGHT).coatings.expect("one is coated");
    assert_eq!(coatings, [Coating::QuarterWave, Coating::Bare, Coating::Bare].map(Into::into));
}

#[test]
fn every_key_has_a_fate() {
    let lens = ok(LHLT);
    assert_eq!(findings(&lens, Fate::Replaced), ["ClearAperturePercent"]);
    assert_eq!(findings(&lens, Fate::LeftOut), ["Surfaces", "Unheard"]);
    let informative = findings(&lens, Fate::Informative);
    for key in ["Surfaces.Comment", "Surfaces.CurvatureVariable", "Surfaces.Index"] {
        assert!(informative.contains(&key), "{informative:?} lacks {key}");
    }
    let radius = lens.findings.iter().find(|own| own.statement == "Surfaces.Radius").expect("used");
    assert_eq!((radius.fate, radius.lines()), (Fate::Used, vec![8, 10, 11]));
    // The fates do not depend on line ends.
    let single = ok(&LHLT.replace('\n', " "));
    assert_eq!(single.interfaces, lens.interfaces);
    assert_eq!(findings(&single, Fate::LeftOut), findings(&lens, Fate::LeftOut));
    for text in ALL {
        let lens = ok(text);
        let left_out = findings(&lens, Fate::LeftOut);
        assert!(text == LHLT || left_out.is_empty(), "{left_out:?}");
    }
}

#[test]
fn sizes_follow_from_aperture_and_field() {
    // The clear semi-diameter is 125 % smaller than the edge.
    assert_eq!(ok(LHLT).interfaces[0].semi_diameter, 12.7 / 1.25);
    let stop = |text: &str| ok(text).interfaces[2].semi_diameter;
    // 1/f = 59/3000 by the slope of the ray at height 5.
    let by_number = stop(&with(LHLT, "\"EPD\", \"Value\": 10", "\"FNumber\", \"Value\": 4"));
    assert!((by_number - 4.735 * 3000.0 / 59.0 / 4.0 / 10.0).abs() < 1e-12, "{by_number}");
    let narrower = with(LHLT, "\"Thickness\": 40,", "\"Thickness\": 40, \"FloatingApertureRadius\": 3,");
    assert_eq!(stop(&narrower), 3.0);
    for (from, to) in
        [("\"object\", \"epd\"", "\"image\", \"f/#\""), ("\"EPD\", \"value\"", "\"imageFNO\", \"value\"")]
    {
        let text = if RAY_OPTICS.contains(from) { RAY_OPTICS } else { OPTILAND };
        let size = stop(&with(text, from, to));
        assert!((size - 4.735 * 3000.0 / 59.0 / 100.0).abs() < 1e-12, "{size}");
    }
    assert_eq!(stop(&with(OPTILAND, "\"EPD\", \"value\"", "\"float_by_stop_size\", \"value\"")), 5.0);
    // Without a field, the second surface is a tenth larger than the axial beam there; with one it is larger still.
    let without = with(OPTILAND, "\"y\": 10", "\"y\": 0");
    assert!((ok(&without).interfaces[1].semi_diameter - 1.1 * 29.0 / 6.0).abs() < 1e-12);
    assert!(ok(OPTILAND).interfaces[1].semi_diameter > 1.1 * 29.0 / 6.0);
    assert!(ok(&without).remarks[0].contains("no semi-diameter is stated"), "{:?}", ok(&without).remarks);
    let none = with(&with(OPTILAND, ", \"is_stop\": true", ""), "\"aperture\": null", "\"aperture\": null");
    refused(
        &none,
        &at(
            &none,
            "{\"type\": \"Surface\", \"geometry\": {\"type\": \"StandardGeometry\", \"cs\": {\"z\": 5.0}",
        ),
        &["surface 2 has no semi-diameter"],
    );
}

#[test]
fn figures_begin_with_the_power_of_their_format() {
    let figure = |text: &str| {
        let Shape::Asphere(figure) = ok(text).interfaces[0].shape else { panic!("no asphere") };
        (figure.radius, figure.conic, figure.term(2), figure.term(4))
    };
    let lhlt = with(
        LHLT,
        "\"Radius\": 50,",
        "\"Radius\": 50, \"Type\": \"EvenAsphere\", \"Conic\": -2, \"AsphericCoefficients\": [1e-4, 1e-5],",
    );
    assert_eq!(figure(&lhlt), (50.0, -2.0, 1e-4, 1e-5));
    let one = "[\"p\", \"Spherical\"], \"attributes\": {\"cv\": 0.02}";
    for (to, term) in [
        (
            "[\"p\", \"EvenPolynomial\"], \"attributes\": {\"cv\": 0.02, \"cc\": -2, \"coefs\": [1e-4, 1e-5], \"coef2\": 0.0}",
            1e-4,
        ),
        (
            "[\"p\", \"EvenPolynomial\"], \"attributes\": {\"cv\": 0.02, \"cc\": -2, \"coefs\": [], \"coef2\": 1e-4, \"coef4\": 1e-5}",
            1e-4,
        ),
        // The first term is that of r, and the conic constant is 1 less than ec.
        (
            "[\"p\", \"RadialPolynomial\"], \"attributes\": {\"cv\": 0.02, \"ec\": -1, \"coefs\": [0, 1e-4, 0, 1e-5]}",
            1e-4,
        ),
        (
            "[\"p\", \"RadialPolynomial\"], \"attributes\": {\"cv\": 0.02, \"ec\": -1, \"coefs\": [], \"coef4\": 1e-5}",
            0.0,
        ),
    ] {
        assert_eq!(figure(&with(RAY_OPTICS, one, to)), (50.0, -2.0, term, 1e-5));
    }
    let standard = "\"StandardGeometry\", \"cs\": {\"x\": 0.0, \"z\": 0.0}, \"radius\": 50, \"conic\": 0.0";
    let even = "\"EvenAsphere\", \"cs\": {\"z\": 0.0}, \"radius\": 50, \"conic\": -2, \"coefficients\": [1e-4, 1e-5]";
    let odd = "\"OddAsphere\", \"cs\": {\"z\": 0.0}, \"radius\": 50, \"conic\": -2, \"coefficients\": [0, 1e-4, 0, 1e-5]";
    for to in [even, odd] {
        assert_eq!(figure(&with(OPTILAND, standard, to)), (50.0, -2.0, 1e-4, 1e-5));
    }
    let deep = "\"Aspheric\", \"k\": -2, \"ai\": [1e-4, 1e-5], \"ai2\": 1e-4, \"r\": 8.0";
    assert_eq!(figure(&with(DEEP_LENS, "\"Spheric\", \"r\": 8.0", deep)), (50.0, -2.0, 1e-4, 1e-5));
    let other = ok(&with(DEEP_LENS, "\"Spheric\", \"r\": 8.0", &deep.replace("\"ai2\": 1e-4", "\"ai2\": 5")));
    assert!(other.remarks[0].contains("the list counts"), "{:?}", other.remarks);
    let ghost = "\"asphere\", \"conic_constant\": -2, \"terms\": [1e-5], \"radius\": 50";
    assert_eq!(figure(&with(GHOSTLIGHT, "\"sphere\", \"radius\": 50", ghost)), (50.0, -2.0, 0.0, 1e-5));
    let Shape::Asphere(cone) =
        ok(&with(OPTILAND, standard, &odd.replace("[0,", "[1e-3,"))).interfaces[0].shape
    else {
        panic!("an asphere")
    };
    assert_eq!(cone.term(1), 1e-3);
}

#[test]
fn media_are_names_numbers_or_formulas() {
    let medium = |text: &str| ok(text).interfaces[0].medium;
    assert!(matches!(medium(&with(LHLT, "500.6000", "N-BK7")), Medium::Sellmeier { .. }));
    let material = "{\"type\": \"AbbeMaterial\", \"index\": [1.5], \"abbe\": [60]}";
    let named = "{\"type\": \"Material\", \"name\": \"N-BK7\", \"reference\": \"schott\", \"filename\": \"C:\\\\x.yml\"}";
    let lens = ok(&with(OPTILAND, material, named));
    assert!(matches!(lens.interfaces[0].medium, Medium::Sellmeier { .. }));
    assert!(findings(&lens, Fate::Informative).contains(&"material_post.filename"));
    let schott = "[\"opticalglass.schott\", \"SchottGlass\"], \"attributes\": {\"gname\": \"N-BK7\"}";
    let model = "[\"m\", \"ModelGlass\"], \"attributes\": {\"n\": 1.5, \"v\": 60}";
    assert!(matches!(medium(&with(RAY_OPTICS, model, schott)), Medium::Sellmeier { .. }));
    assert!(matches!(medium(&with(DEEP_LENS, "1.5/60", "n-bk7")), Medium::Sellmeier { .. }));
    let constants = "\"model\": \"sellmeier\", \"B\": [1, 0.2, 1], \"C\": [0.006, 0.02, 103]";
    let formula = medium(&with(GHOSTLIGHT, "\"model\": \"abbe\", \"nd\": 1.5, \"Vd\": 60", constants));
    assert_eq!(formula, Medium::Sellmeier { b: [1.0, 0.2, 1.0], c: [0.006, 0.02, 103.0] });
    // The object's and the film's media.
    let water = ok(&with(
        LHLT,
        "{\"Thickness\": \"Infinity\"}",
        "{\"Thickness\": \"Infinity\", \"Material\": \"330.5500\"}",
    ));
    assert_eq!(water.object_medium, Medium::Glass { n_d: 1.33, abbe: Some(55.0) });
    assert_eq!(
        ok(&with(LHLT, "\"Thickness\": 40", "\"Thickness\": 40, \"Material\": \"330.5500\"")).image_medium(),
        water.object_medium
    );
    refuses(LHLT, "500.6000", "MADE-UP", "\"Material\"", "glass \"MADE-UP\" is not known");
    refuses(
        GHOSTLIGHT,
        "\"glass\": \"crown\"",
        "\"glass\": \"flint\"",
        "{\"glass\"",
        "not in \"glass_catalogue\"",
    );
    refuses(
        OPTILAND,
        "\"index\": [1.5]",
        "\"index\": [1.5, 2]",
        "\"index\": [1.5, 2]",
        "expected one number",
    );
}

#[test]
fn places_of_object_and_image_are_those_of_the_file() {
    // The object lies 100 mm in front of the idle surface, which lies 2 mm in front of the lens.
    let near = ok(&with(LHLT, "{\"Thickness\": \"Infinity\"}", "{\"Thickness\": 100}"));
    let positions = near.positions.expect("one, for its object");
    assert_eq!((positions.columns.len(), positions.columns[0].object_distance), (1, Some(102.0)));
    refuses(
        LHLT,
        "{\"Thickness\": \"Infinity\"}",
        "{\"Thickness\": -5}",
        "{\"Thickness\": -5}",
        "the object lies",
    );
    let behind = ok(&with(LHLT, "\"Thickness\": 40", "\"Thickness\": -40"));
    assert_eq!(behind.nominal_film_distance, None);
    assert!(behind.remarks[0].contains("where no film can be"), "{:?}", behind.remarks);
    let rounded = ok(&with(LHLT, "\"Thickness\": 1,", "\"Thickness\": -1e-6,"));
    assert_eq!(rounded.interfaces[1].thickness, 0.0);
    refuses(
        LHLT,
        "\"Radius\": -50, \"Thickness\": 1,",
        "\"Radius\": -50, \"Thickness\": \"Infinity\",",
        "\"Thickness\": \"Infinity\", \"SemiDiameter\": 9",
        "surface 3 has a thickness without end",
    );
    let curved = ok(&with(LHLT, "  {}\n", "  {\"Radius\": -70}\n"));
    assert!(curved.remarks[0].contains("the image is curved"), "{:?}", curved.remarks);
    let inches = ok(&with(RAY_OPTICS, "\"_dimensions\": \"mm\"", "\"_dimensions\": \"in\""));
    assert_eq!(inches.nominal_film_distance, Some(1016.0));
    // The last thickness states the film; without it the film lies at z = 0.
    let stated = with(GHOSTLIGHT, "\"is_stop\": true,", "\"is_stop\": true, \"thickness\": 39,");
    assert_eq!(ok(&stated).nominal_film_distance, Some(39.0));
    for title in
        ["Plano-Convex Cylindrical Lens", "Mounted Plano-Convex Cyl Lens", "NEGATIVE CYLINDER; 7.00MM DIA"]
    {
        refuses(LHLT, "Made up", title, "\"Title\"", "the title calls the lens cylindrical");
    }
}

#[test]
fn apertures_are_outlines() {
    let apertures = |text: &str, i: usize| ok(text).interfaces[i].apertures.to_vec();
    let blocked =
        apertures(&with(LHLT, "\"SemiDiameter\": 9,", "\"SemiDiameter\": 9, \"ObscurationRadius\": 2,"), 1);
    assert_eq!((blocked[0].is_obstruction, &blocked[0].outline), (true, &Outline::Ellipse([2.0; 2])));
    let round = "{\"type\": \"RadialAperture\", \"r_max\": 8, \"r_min\": 0}";
    let ring = apertures(&with(OPTILAND, round, &round.replace("\"r_min\": 0", "\"r_min\": 2")), 0);
    assert_eq!(ring, blocked);
    let box_ =
        "{\"type\": \"RectangularAperture\", \"x_min\": -1, \"x_max\": 5, \"y_min\": -4, \"y_max\": 4}";
    let rectangle = ok(&with(OPTILAND, round, box_)).interfaces[0].clone();
    assert_eq!(
        (rectangle.apertures[0].center, &rectangle.apertures[0].outline),
        ([2.0, 0.0], &Outline::Rectangle([3.0, 4.0]))
    );
    assert_eq!(rectangle.semi_diameter, 5.0_f64.hypot(4.0));
    let stop = "\"is_stop\": true,";
    let blades = "\"is_stop\": true, \"modifiers\": [{\"type\": \"aperture\", \"shape\": \"polygon\", \"blades\": 4}],";
    let Outline::Polygon(vertices) = apertures(&with(GHOSTLIGHT, stop, blades), 2)[0].outline.clone() else {
        panic!()
    };
    assert!(vertices.len() == 4 && vertices[0] == [4.735, 0.0] && (vertices[1][1] - 4.735).abs() < 1e-12);
    let curved = blades.replace("4}", "4, \"curvature\": 0.5}");
    refuses(GHOSTLIGHT, stop, &curved, "\"curvature\"", "blades that are not straight");
}

#[test]
fn what_is_not_traced_is_refused_by_name() {
    for (text, from, to, place, message) in [
        (LHLT, "\"500.6000\"", "\"MIRROR\"", "\"Material\"", "surface 2 is a mirror"),
        (
            LHLT,
            "\"Radius\": 50,",
            "\"Radius\": 50, \"Type\": \"Toroid\",",
            "\"Type\": \"Toroid\"",
            "of type Toroid",
        ),
        (LHLT, "\"SemiDiameter\": 9,", "\"InnerRadius\": 2,", "\"InnerRadius\"", "a hole or a ring"),
        (LHLT, "\"EPD\"", "\"NA\"", "\"Aperture\"", "an aperture of type NA"),
        (LHLT, "\"FormatVersion\": 1", "\"FormatVersion\": 2", "\"FormatVersion\"", "version 2"),
        (LHLT, "0.5875618", "10.6", "\"Value\": 10.6", "10600 nm"),
        (
            LHLT,
            "\"Unheard\": 3",
            "\"ConfigurationEditor\": {\"Operands\": [1], \"Configurations\": [1, 2]}",
            "\"ConfigurationEditor\"",
            "2 configurations",
        ),
        (
            LHLT,
            "\"Thickness\": 1,",
            "\"Thickness\": 1, \"IsStop\": true,",
            "{\"Radius\": \"Infinity\"",
            "a second stop",
        ),
        (
            RAY_OPTICS,
            "\"transmit\"",
            "\"transmit\", \"decenter\": {\"_dtype\": \"reverse\"}",
            "\"decenter\"",
            "a decenter of the type \"reverse\"",
        ),
        (
            RAY_OPTICS,
            "\"transmit\"",
            "\"transmit\", \"phase_element\": {}",
            "\"phase_element\"",
            "a grating or hologram",
        ),
        (
            RAY_OPTICS,
            "[\"p\", \"Spherical\"], \"attributes\": {\"cv\": 0.02",
            "[\"p\", \"YToroid\"], \"attributes\": {\"coefs\": [0, 0, 0, 0, 0, 0, 0, 1], \"cv\": 0.02",
            "\"1\": {",
            "a toroid with terms beyond the 14th power",
        ),
        (
            RAY_OPTICS,
            "\"profile_id\": \"1\"",
            "\"profile_id\": \"7\"",
            "\"attributes\": {\"profile_id\": \"7\"",
            "no profile \"7\"",
        ),
        (RAY_OPTICS, "\"mm\"", "\"furlong\"", "\"_dimensions\"", "is not a unit"),
        (
            OPTILAND,
            "\"z\": 5.0",
            "\"z\": 5.0, \"rx\": 3.1",
            "{\"type\": \"Surface\", \"geometry\": {\"type\": \"StandardGeometry\", \"cs\": {\"z\": 5.0",
            "its z axis the wrong way",
        ),
        (
            OPTILAND,
            "\"z\": 5.0",
            "\"z\": 5.0, \"reference_cs\": {}",
            "\"reference_cs\"",
            "another coordinate system",
        ),
        (OPTILAND, "\"coating\": null", "\"bsdf\": {}", "\"bsdf\"", "scatters"),
        (
            OPTILAND,
            "\"coating\": null",
            "\"interaction_model\": {\"type\": \"ThinLensInteractionModel\"}",
            "\"interaction_model\"",
            "an ideal thin lens",
        ),
        (
            OPTILAND,
            "\"StandardGeometry\"",
            "\"BiconicGeometry\"",
            "\"geometry\": {\"type\": \"Bi",
            "the sum of two profiles",
        ),
        (
            OPTILAND,
            "\"AbbeMaterial\"",
            "\"MaterialFile\"",
            "\"material_post\": {\"type\": \"MaterialFile\"",
            "a material MaterialFile",
        ),
        (DEEP_LENS, "\"Spheric\"", "\"Fresnel\"", "{\"type\": \"Fresnel\"", "of type Fresnel"),
        (DEEP_LENS, "\"r\": 8.0", "\"is_square\": true, \"r\": 8.0", "\"is_square\"", "is square"),
        (
            DEEP_LENS,
            "\"r\": 8.0",
            "\"vec_local\": [0, 0.1, 1], \"r\": 8.0",
            "{\"type\"",
            "a tilt or decentring",
        ),
        (DEEP_LENS, "\"fnum\": 5", "\"DOE\": {}", "\"DOE\"", "a diffractive element"),
        (GHOSTLIGHT, "\"sphere\"", "\"cylindrical\"", "\"form\"", "surface 1.1 is a cylinder along \"\""),
        (GHOSTLIGHT, "\"mode\": \"absolute\", \"x\": 0", "\"x\": 1", "\"x\"", "off the axis"),
        (
            GHOSTLIGHT,
            "\"transform\": {",
            "\"transform\": {\"rotation\": {\"tilt_x\": 3}, ",
            "\"tilt_x\"",
            "a tilt or roll",
        ),
        (
            GHOSTLIGHT,
            "\"position\": {\"x\": 0, \"z\": 0}",
            "\"position\": {\"y\": 2}",
            "\"y\": 2",
            "a pivot that moves",
        ),
        (GHOSTLIGHT, "\"simple\"", "\"attenuator_gaussian\"", "{\"type\": \"coating\"", "an apodiser"),
        (
            GHOSTLIGHT,
            "\"semi_aperture\": 9,",
            "\"semi_aperture\": 9, \"is_active\": false,",
            "\"is_active\"",
            "is muted",
        ),
        (
            GHOSTLIGHT,
            "\"materials\": []",
            "\"materials\": [{}]",
            "{\"type\": \"element\", \"transform\": {\"position\": {\"mode\": \"rel",
            "1 surfaces and 1 materials",
        ),
    ] {
        refuses(text, from, to, place, message);
    }
    refused("{\"surfaces\": []}", "1:1", &["without the keys of a known lens format", "FlareSim"]);
}

#[test]
fn malformed_files_are_refused_with_their_place() {
    for (text, from, to, place, message) in [
        (
            LHLT,
            "\"Radius\": 50",
            "\"Radius\": NaN",
            "\"Radius\": NaN",
            "\"Radius\" is NaN; expected a number",
        ),
        (
            LHLT,
            "\"Thickness\": 5,",
            "\"Thickness\": \"5 mm\",",
            "\"Thickness\": \"5 mm\"",
            "expected a number",
        ),
        (LHLT, "\"Radius\": 50", "\"Radius\": 50, \"Radius\": 60", "\"Radius\": 60", "a second \"Radius\""),
        (LHLT, "\"IsStop\": true", "\"IsStop\": \"yes\"", "\"IsStop\"", "expected true or false"),
        (
            OPTILAND,
            "\"r_max\": 8",
            "\"r_max\": -8",
            "\"aperture\": {\"type\": \"Radial",
            "expected a positive number",
        ),
        (DEEP_LENS, "\"r\": 9.0", "\"r\": 0", "\"r\": 0", "expected a positive semi-diameter"),
        (DEEP_LENS, ", \"d_next\": 40.0", "", "{\"type\": \"Aperture\"", "no \"d_next\" here"),
        (
            GHOSTLIGHT,
            "\"semi_aperture\": 9",
            "\"semi_aperture\": \"9\"",
            "\"semi_aperture\": \"9\"",
            "expected a number",
        ),
    ] {
        refuses(text, from, to, place, message);
    }
    for text in ALL {
        // Every part of a file is an error with its place, or by chance a lens; none ends the program.
        for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)).step_by(7) {
            let error = crate::prescription::read("lens", &text.as_bytes()[..end]).expect_err("a part");
            assert!(error.line >= 1 && error.column >= 1, "{error}");
        }
        for word in ["null", "[]", "{}", "-1", "1e308", "\"x\"", "Infinity", "NaN", "true"] {
            for (start, _) in text.match_indices(": ") {
                let end = text[start..].find([',', '}', ']', '\n']).map_or(text.len(), |end| start + end);
                let changed = format!("{}{word}{}", &text[..start + 2], &text[end..]);
                _ = crate::prescription::read("lens", changed.as_bytes());
            }
        }
    }
    refused("{\"FormatVersion\": 1,\n \"Surfaces\": [}", "2:15", &["not JSON from here on"]);
    refused("{\"FormatVersion\": 1e999}", "1:23", &["not JSON from here on: number out of range"]);
}

#[test]
fn a_large_or_deep_file_is_refused_at_once() {
    refused(&"[".repeat(500_000).replacen('[', "[[", 1), "1:128", &["recursion limit"]);
    refused(&format!("{{\"a\": {}0", "{\"a\": ".repeat(1000)), "1:763", &["recursion limit"]);
    let zeros = format!("{{\"FormatVersion\": 1, \"Surfaces\": [{}0]}}", "0,".repeat(500_000));
    let limit = zeros.find('[').expect("a list") + 1 + 2 * 1002 + 1;
    refused(&zeros, &format!("1:{limit}"), &["a lens has at most 1000 interfaces"]);
    let unheard = format!("\"Unheard\": [{}0]", "{\"a\": 1},".repeat(100_000));
    assert_eq!(
        findings(&ok(&with(LHLT, "\"Unheard\": 3", &unheard)), Fate::LeftOut),
        ["Surfaces", "Unheard"]
    );
    let members: String = (0..50_000).map(|i| format!("\"k{i}\": 1,")).collect();
    assert_eq!(
        findings(&ok(&with(LHLT, "\"Unheard\": 3", &format!("{members} \"k\": 0"))), Fate::LeftOut).len(),
        50_002
    );
}

#[test]
fn cylinders_and_toroids_are_read() {
    let first = |text: &str| match ok(text).interfaces[0].shape {
        Shape::Unsymmetric(figure) => figure.radii(),
        shape => panic!("{shape:?}"),
    };
    let toroid = "[\"p\", \"YToroid\"], \"attributes\": {\"cR\": 0.01, \"cv\": 0.02";
    let of = |toroid: &str| with(RAY_OPTICS, "[\"p\", \"Spherical\"], \"attributes\": {\"cv\": 0.02", toroid);
    assert_eq!(first(&of(toroid)), [100.0, 50.0]);
    assert_eq!(first(&of(&toroid.replace("YToroid", "XToroid").replace("0.01", "0"))), [50.0, f64::INFINITY]);
    let toroid =
        "\"ToroidalGeometry\", \"radius_x\": 80.0, \"radius_y\": -40.0, \"coeffs_poly_y\": [0, 1e-6]";
    assert_eq!(first(&with(OPTILAND, "\"StandardGeometry\"", toroid)), [80.0, -40.0]);
    // Along y, a cylinder bends light in x.
    let cylinder =
        |axis: &str| with(GHOSTLIGHT, "\"sphere\"", &format!("\"cylindrical\", \"axis\": \"{axis}\""));
    assert_eq!(first(&cylinder("y")), [50.0, f64::INFINITY]);
    assert_eq!(first(&cylinder("x")), [f64::INFINITY, 50.0]);
}

#[test]
fn tilts_and_mirrors_are_read() {
    let tilt = |degrees: [f64; 3]| CoordinateBreak::tilted(degrees);
    let decenter = "\"transmit\", \"decenter\": {\"_dtype\": \"dec and return\", \"dec\": {\"__ndarray__\": [1.0, 2.0, 0.0]}, \
        \"euler\": [3.0, 0.0, 0.0]}";
    let lens = ok(&with(RAY_OPTICS, "\"transmit\"", decenter));
    let change = CoordinateBreak::shifted([1.0, 2.0, 0.0]).then(&tilt([-3.0, 0.0, 0.0]));
    assert_eq!(lens.interfaces[1].coordinate_break, Some(change));
    // Two mirrors, with a film that is tilted about x and then about y of fixed axes.
    let surface = |kind: &str, place: &str, material: &str| {
        format!(
            "{{\"geometry\": {{\"type\": \"{kind}\", \"cs\": {{{place}}}, \"radius\": -200.0}}, \"aperture\": {{\"type\": \
             \"RadialAperture\", \"r_max\": 9.0}}, \"material_post\": {{\"type\": \"{material}\", \"index\": 1.0}}}}"
        )
    };
    let surfaces = |film: &str| {
        let all = [
            "{\"geometry\": {\"cs\": {\"z\": -Infinity}}}".to_owned(),
            surface("StandardGeometry", "\"z\": 0, \"y\": 0", "Mirror"),
            surface("Plane", "\"z\": -40.0, \"rx\": 0.1", "Mirror"),
            surface("Plane", film, "IdealMaterial"),
        ];
        format!("{{\"surface_group\": {{\"surfaces\": [{}]}}}}", all.join(", "))
    };
    let lens = ok(&surfaces("\"z\": 20.0, \"y\": 3.0, \"rx\": 0.2, \"ry\": 0.3"));
    let [first, second] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
    assert!(first.is_mirror && second.is_mirror && first.medium == Medium::Air);
    let [a, b, c] = [0.1, 0.2, 0.3].map(f64::to_degrees);
    let second_frame = CoordinateBreak::shifted([0.0, 0.0, -40.0]).then(&tilt([a, 0.0, 0.0]));
    let film_frame =
        CoordinateBreak::shifted([0.0, 3.0, 20.0]).then(&tilt([0.0, c, 0.0])).then(&tilt([b, 0.0, 0.0]));
    let along = |z: f64| CoordinateBreak::shifted([0.0, 0.0, z]);
    let to_second = along(first.thickness).then(&second.coordinate_break.expect("tilted"));
    let to_film = lens.film_break.expect("tilted").then(&along(lens.nominal_film_distance.expect("a film")));
    for (found, expected) in [(to_second, second_frame), (to_second.then(&to_film), film_frame)] {
        let apart = found.then(&expected.inverse());
        assert!(apart.shift.iter().all(|shift| shift.abs() < 1e-12), "{found:?} {expected:?}");
        assert!((apart.rotation[0][0] - 1.0).abs() < 1e-12 && (apart.rotation[1][1] - 1.0).abs() < 1e-12);
    }
    let turned = surfaces("\"z\": -60.0, \"rx\": 0.2");
    let error = read(FILE, turned.as_bytes()).expect_err("refused").to_string();
    assert!(error.contains("surface 3 has its z axis the wrong way"), "{error}");
}
