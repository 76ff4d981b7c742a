//! Tests of every accepted spelling, and of every refusal with the message that the user reads.

use crate::prescription::{
    MAX_FILE_BYTES, MAX_INTERFACES, MAX_NAME_BYTES, Medium, Shape, catalogue,
    glass::{D_LINE, refractive_index},
    read,
    reader::checks::{FILE, ok, refused},
};

const SINGLET: &str = "20 5 1.5 10\n-20 30 1 10\n";

#[test]
fn the_last_thickness_is_the_nominal_film_distance() {
    let lens = ok(SINGLET.as_bytes());
    assert_eq!(lens.nominal_film_distance, Some(30.0));
    assert_eq!(lens.interfaces[1].thickness, 0.0);
    assert_eq!(lens.interfaces[0].semi_diameter, 5.0);
    assert_eq!(lens.name, "lens.dat");
}

#[test]
fn spellings_of_one_table_agree() {
    let plain = ok(SINGLET.as_bytes()).interfaces;
    for text in [
        b"20\t5\t1.5\t10\r\n-20\t30\t1\t10\r\n".as_slice(),
        b"20,5,1.5,10\n-20, 30 ,1,10",
        b"\xEF\xBB\xBF20 5 1.5 10 # 1\n-20 30 0 10",
        b"# Gau\xDF, \xFF\xFE\n2E1 5 +1.5 10.\n\n  -20 3e1 1.0 10\n",
        b"50.0\n20 5 1.5 10\n-20 30 1 10\n",
        b"20 5 1.5 - 10\n-20 30 10",
        b"20 5 1.5 - 10\n-20 30 - - 10",
        b"20 5 1.5 10\r-20 30 1 10\r",
        b"# two lines\r20 5 1.5 10\r-20 30 1 10",
    ] {
        assert_eq!(ok(text).interfaces, plain, "{}", String::from_utf8_lossy(text));
    }
    let utf16: Vec<u8> = [0xFF, 0xFE].into_iter().chain(SINGLET.bytes().flat_map(|byte| [byte, 0])).collect();
    assert_eq!(ok(&utf16).interfaces, plain);
}

#[test]
fn a_list_of_numbers_is_rows_of_four() {
    // As pbrt reads them: comments, and numbers without regard to lines.
    let rows = "29 3.5 1.67 25\n84 0.1 1 25\n0 4.5 0 17\n-14 1.2 1.6 17\n-20 0 1 20\n";
    let lens = ok(&format!("# radius\taxpos\tN\taperture\n{rows}"));
    assert_eq!((lens.stop_index(), lens.nominal_film_distance), (Some(2), None));
    assert_eq!(lens.interfaces[0].semi_diameter, 12.5);
    for separator in [" ", "\n", "\r\n", "\n# next\n", ", "] {
        let numbers: Vec<&str> = rows.split_whitespace().collect();
        let list = ok(&format!("# a lens\n{} # end\n", numbers.join(separator)));
        assert_eq!(list.interfaces, lens.interfaces, "{separator:?}");
        assert!(list.findings.iter().all(|finding| finding.fate >= crate::prescription::Fate::Informative));
    }
    // Other lines stay what they are.
    assert_eq!(ok(&format!("{}\nstop 1\n", SINGLET.replace('\n', " "))).stop_index(), Some(0));
    refused("20 5 1.5 10 -20 30 1", "1:1", &["7 value(s); a row has four values"]);
    refused("20 5 1.5 10 -20 30 1 10 9", "1:1", &["9 value(s)"]);
    refused("20 5 1.5 10 -20 30 N-BK7 10", "1:1", &["8 value(s)"]);
    refused("20 5 1.6 60 10 -20 1 1.7 30 10 5 5", "1:1", &["12 value(s)"]);
    refused("20 5 1.5 10 -20 30 1 10\n1 2 3 4", "1:1", &["8 value(s)"]);
    refused("20,0 5,0 1,5 10,0", "1:1", &["8 value(s)", "a decimal comma on line 1?"]);
    refused("50\n20\n5\n1.5\n10\n", "2:1", &["1 value(s)"]);
    refused("20 5 1.5 10 -20 -30 1 10", "1:13", &["thickness -30 mm"]);
}

#[test]
fn a_table_of_thicknesses_in_front_of_the_surfaces_is_refused() {
    let front = "50 0 1.5 20\n-50 4 1 20\n0 3 0 12\n-20 5 1.6 20\n-30 2 1 20\n";
    refused(
        front,
        "1:4",
        &["the first glass has thickness 0", "in front of the surfaces", "in the row before"],
    );
    ok(&front.replacen("50 0 1.5", "50 1e-9 1.5", 1));
    // Thin lenses.
    ok("50 0 1.5 20\n-50 48 1 20\n");
    ok("50 0 1.5 20\n-50 4 1 20\n0 3 0 12\n-20 0 1.6 20\n-30 2 1 20\n");
    ok("50 4 1.5 20\n-50 3 1 20\n0 5 0 12\n-20 2 1.6 20\n-30 0 1 20\n");
    // A surface in air may touch the next one.
    ok("50 0 1 20\n50 4 1.5 20\n-50 50 1 20\n");
}

#[test]
fn the_first_comment_is_the_title_and_focal_length_is_kept() {
    let lens = ok(b"#\n# A singlet \n50\n20 5 1.5 10\n-20 0 1 10");
    assert_eq!(lens.title.as_deref(), Some("A singlet"));
    assert_eq!(lens.stated_focal_length, Some(50.0));
    assert_eq!(lens.nominal_film_distance, None);
}

#[test]
fn a_plane_is_the_stop_between_air_and_glass_otherwise() {
    let lens = ok(b"0 5 1.5 10\n0 1 1 10\n0 2 0 8\ninf 2 1.6 9\n-20 0 1 9");
    let shapes: Vec<Shape> = lens.interfaces.iter().map(|interface| interface.shape).collect();
    assert_eq!(
        shapes,
        [Shape::Plane, Shape::Plane, Shape::Plane, Shape::Plane, Shape::Sphere { radius: -20.0 }]
    );
    assert_eq!(lens.stop_index(), Some(2));
}

#[test]
fn a_five_column_table_has_four_kinds_of_row() {
    let lens = ok(b"20 5 1.5 60.1 10\n-20 1 9\nstop 2 8\n30 3 1.6 36 9\n-30 - - - 9");
    assert_eq!(lens.interfaces[0].medium, Medium::Glass { n_d: 1.5, abbe: Some(60.1) });
    assert_eq!(lens.interfaces[1].medium, Medium::Air);
    for stop in ["2 8", "- 2 - - 8", "0 2 - - 8", "STOP 2 - - 8"] {
        let text = format!("20 5 1.5 60.1 10\n-20 1 9\n{stop}\n30 3 1.6 36 9\n-30 - - - 9");
        assert_eq!(ok(text.as_bytes()).interfaces, lens.interfaces, "{stop}");
    }
    assert!(catalogue::find("dgauss.100mm").expect("listed").is_dispersive());
}

#[test]
fn a_malformed_word_is_refused_with_its_location() {
    refused("20 5 1.5 10\n-20 x 1 10", "2:5", &["\"x\" is not a number", "thickness in mm"]);
    refused("20 5 1.5 10\n-20 0 1 nan", "2:9", &["\"nan\" is not finite", "clear diameter"]);
    refused("20 1e999 1.5 10", "1:4", &["not finite"]);
    refused("20 inf 1.5 10", "1:4", &["not finite"]);
    refused("20 5 0.9 10", "1:6", &["index is 1 or more"]);
    refused("20 5 -1.5 10", "1:6", &["index is 1 or more"]);
    refused(
        "20 5 1.5 10\n\u{2212}20 30 1 10",
        "2:1",
        &["\"\u{2212}20\" is not a number: its minus is a dash; write -20"],
    );
    refused("radius thickness n diameter\n20 5 1.5 10", "1:1", &["a line of words", "heading begins with #"]);
    let latin = read(FILE, b"20 5 1.5 10\xB5m").expect_err("refused").to_string();
    assert!(latin.starts_with("lens.dat:1:10: not text"), "{latin}");
}

#[test]
fn a_row_of_the_wrong_length_is_refused_with_the_form_of_a_row() {
    refused("20 5 1.5", "1:1", &["3 value(s)", "radius, thickness, refractive index, clear diameter"]);
    refused("20 5 1.5 10\n7\n", "2:1", &["1 value(s)"]);
    refused("58,95 7,52 1,67 50,4", "1:1", &["8 value(s)", "write 1.5, not 1,5"]);
    refused("20 5 1.5 60 10\n-20 1 9 9", "2:1", &["read in two ways", "write - for a value left out"]);
    refused("20 5 1.5 60 10\n-20 1 9 9 9 9", "2:1", &["6 value(s)", "three (air"]);
    refused("20,,5 1.5 10", "1:4", &["nothing stands before this comma"]);
    refused("20 5 1.5 10,", "1:12", &["nothing stands after this comma"]);
    refused("# nothing\n", "2:1", &["no rows", "at least one interface"]);
    refused("", "1:1", &["no rows"]);
    refused("-50\n20 5 1.5 10", "1:1", &["must be positive"]);
}

#[test]
fn impossible_interfaces_are_refused() {
    refused("20 -5 1.5 10", "1:1", &["thickness -5 mm", "0 or more"]);
    refused("20 5 1.5 0", "1:1", &["clear diameter 0 mm", "positive"]);
    refused("20 5 1.5 -3", "1:1", &["clear diameter -3 mm"]);
    refused("0 1 1 5\n20 5 1.5 10\n-20 1 1 10\n0 0 1 3", "4:1", &["second stop", "line 1"]);
    refused("20 5 1.5 60 10\nstop 2 9\n-20 0 9\nstop 1 1.5 60 9", "4:1", &["second stop", "line 2"]);
    refused("20 5 1.5 60 10\n-20 1 - 60 9", "2:9", &["V-number without a refractive index"]);
    refused("20 5 1.5 -3 10\n-20 1 9", "1:10", &["V-number is positive"]);
}

#[test]
fn a_decimal_comma_is_named_with_its_line() {
    let hint = ["(a decimal comma on line 1? write 1.5, not 1,5)"].as_slice();
    refused("58,95 7,52 1,67 50,4", "1:1", hint);
    refused("58,95;7,52;1,67;50,4", "1:9", hint);
    refused("20,5,1.5,10,3,7", "1:1", hint);
    // If the lines are read as rows of five columns, the first line is valid and the second is not.
    refused("20 5 1,5 10\n-20 30 1 10", "1:8", hint);
    refused("20\t5,5\t1.5\t10\n-20 30 1 10", "2:1", hint);
    let message = read(FILE, b"20,5,1.5,x").expect_err("refused").to_string();
    assert!(!message.contains("decimal comma"), "{message}");
}

#[test]
fn no_message_repeats_a_long_word_or_number() {
    let long = "9".repeat(900_000);
    for text in [
        format!("x{long} 5 1.5 10"),
        format!("20 5 1.5 {long}"),
        "20 -1e308 1.5 10".to_owned(),
        format!("20 5 1.5 -{}", "9".repeat(300)),
        format!("glass {long}"),
        format!("glass x {long}"),
        format!("glass x sellmeier {long}"),
        format!("glass x sellmeier B1=1 B1={long}"),
        format!("{} 5 1.5 10", "20 ".repeat(300_000)),
    ] {
        let message = read(FILE, text.as_bytes()).expect_err("refused").to_string();
        assert!(message.len() < 300, "{} bytes: {message:.300}", message.len());
    }
}

#[test]
fn a_mount_wider_than_the_sphere_is_the_whole_sphere_and_told() {
    let wide = ok(b"0.8146 0.5 1.5 1.64\n-20 30 1 1");
    assert_eq!(wide.interfaces[0].semi_diameter, 0.8146);
    assert_eq!(
        wide.remarks,
        [
            "lens.dat:1:1: clear diameter 1.64 mm on a sphere of radius 0.8146 mm; 1.6292 mm is used, the whole sphere"
        ]
    );
    assert_eq!(ok(b"0.8146 0.5 1.5 1.6292\n-20 30 1 1").remarks, [""; 0]);
}

/// Returns a lens with this number of interfaces.
fn stack(interfaces: usize) -> String {
    assert!(interfaces.is_multiple_of(2));
    "90 1 1.5 10\n-90 1 1 10\n".repeat(interfaces / 2)
}

#[test]
fn a_lens_has_at_most_a_thousand_interfaces() {
    assert_eq!(ok(stack(MAX_INTERFACES).as_bytes()).interfaces.len(), 1000);
    // Comments and the focal length do not count as interfaces.
    assert_eq!(ok(format!("# title\n50\n{}", stack(1000)).as_bytes()).interfaces.len(), 1000);
    refused(&stack(1002), "1001:1", &["row 1001 of 1002", "at most 1000 interfaces"]);
    let five = stack(1002).replace("1.5", "1.5 60").replace(" 1 10", " 10");
    refused(&format!("# title\n{five}"), "1002:1", &["at most 1000 interfaces"]);
    // Rows beyond the limit are not parsed.
    refused(&format!("{}x y z", stack(1000)), "1001:1", &["row 1001 of 1001"]);
}

#[test]
fn a_file_defines_at_most_a_thousand_glasses() {
    let glasses = |number: usize| -> String {
        let line = |i| format!("glass g{i} sellmeier B1=1 C1=0 B2=0 C2=0 B3=0 C3=0\n");
        (0..number).map(line).collect()
    };
    ok(format!("{}20 5 g999 10\n-20 0 1 10", glasses(1000)).as_bytes());
    let text = format!("{}20 5 g999 10\n-20 0 1 10", glasses(1001));
    refused(&text, "1001:1", &["row 1001 of 1001", "at most 1000 glasses"]);
}

#[test]
fn a_name_has_at_most_255_bytes() {
    let file = |glass: &str, used: &str| {
        format!("glass {glass} sellmeier B1=1 C1=0 B2=0 C2=0 B3=0 C3=0\n20 5 {used} 10\n-20 0 1 10")
    };
    let longest = "g".repeat(MAX_NAME_BYTES);
    ok(file(&longest, &longest).as_bytes());
    let longer = format!("{longest}g");
    refused(&file(&longer, "1.5"), "1:7", &["has 256 bytes", "at most 255"]);
    refused(&file("g", &longer), "2:6", &["has 256 bytes", "at most 255"]);
    let huge = "g".repeat(900_000);
    let message = read(FILE, file("g", &huge).as_bytes()).expect_err("too long").to_string();
    assert!(message.len() < 200, "{} bytes", message.len());

    assert_eq!(read(&format!("some/where/{longest}"), SINGLET.as_bytes()).expect("a lens").name, longest);
    let message = read(&huge, SINGLET.as_bytes()).expect_err("too long").to_string();
    assert!(message.contains("900000 bytes") && message.len() < 200, "{message}");
}

#[test]
fn a_text_has_at_most_a_mebibyte() {
    let mut text = SINGLET.as_bytes().to_vec();
    text.resize(MAX_FILE_BYTES as usize, b'\n');
    assert_eq!(ok(&text).interfaces.len(), 2);
    text.push(b'\n');
    let lines = MAX_FILE_BYTES as usize - SINGLET.len() + 3;
    let message = read(FILE, &text).expect_err("too large").to_string();
    assert!(message.starts_with(&format!("lens.dat:{lines}:1: ")), "{message}");
    assert!(message.contains("at most 1048576 bytes (1 MiB)"), "{message}");
}

const ASPHERE: &str = "20 5 1.5 10\n-20 30 1 10\nasphere 1 conic=-1.2 A4=1e-5 A20=-3e-30\n";

#[test]
fn a_row_can_have_a_figure() {
    let lens = ok(ASPHERE.as_bytes());
    let Shape::Asphere(asphere) = lens.interfaces[0].shape else { panic!("{lens:?}") };
    assert_eq!((asphere.radius, asphere.conic), (20.0, -1.2));
    let terms: Vec<f64> = asphere.terms.into_iter().filter(|term| *term != 0.0).collect();
    assert_eq!((asphere.term(4), asphere.term(20), terms.len()), (1e-5, -3e-30, 2));
    assert_eq!(lens.interfaces[1].shape, Shape::Sphere { radius: -20.0 });
    // The line may be anywhere, with its words in any order and case. A polynomial on a plane has no radius.
    let other = ok(b"ASPHERE 1 a20=-3e-30 a4=1e-5 Conic=-1.2\n20 5 1.5 - 10\n-20 30 10");
    assert_eq!(other.interfaces, lens.interfaces);
    let corrector = ok(b"inf 5 1.5 10\ninf 30 1 10\nasphere 2 A2=1e-3 A3=0");
    let Shape::Asphere(asphere) = corrector.interfaces[1].shape else { panic!("{corrector:?}") };
    assert_eq!((asphere.radius, asphere.term(2)), (f64::INFINITY, 1e-3));
}

#[test]
fn a_figure_that_is_a_sphere_or_a_plane_is_one() {
    let plain = ok(b"20 5 1.5 10\ninf 30 1 10").interfaces;
    let figured = ok(b"20 5 1.5 10\ninf 30 1 10\nasphere 1 conic=0 A4=0\nasphere 2 conic=-3\n");
    assert_eq!(figured.interfaces, plain);
}

#[test]
fn a_mount_wider_than_the_conic_is_the_whole_conic_with_a_warning() {
    let wide = ok(b"10 5 1.5 30\n-20 30 1 10\nasphere 1 conic=3");
    assert_eq!(wide.interfaces[0].semi_diameter, 5.0);
    assert!(
        wide.remarks[0]
            .ends_with("on a conic of radius 10 mm and constant 3; 10 mm is used, the whole conic")
    );
    for endless in ["-1", "-2.5"] {
        let text = format!("10 5 1.5 30\n-20 30 1 10\nasphere 1 conic={endless}");
        assert_eq!(ok(text.as_bytes()).interfaces[0].semi_diameter, 15.0, "{endless}");
    }
}

#[test]
fn a_malformed_figure_is_refused_with_its_location() {
    let with = |line: &str| format!("20 5 1.5 10\n-20 30 1 10\n{line}\n");
    refused(&with("asphere"), "3:1", &["asphere ROW conic=", "A1 to A30"]);
    refused(&with("asphere 1"), "3:1", &["no constants"]);
    refused(&with("asphere 3 A4=1"), "3:9", &["\"3\" is not a row", "rows 1 to 2"]);
    refused(&with("asphere one A4=1"), "3:9", &["\"one\" is not a row"]);
    refused(&with("asphere 1 A0=1"), "3:11", &["\"A0=1\" is not a constant such as A4=1e-5"]);
    refused(&with("asphere 1 A31=1"), "3:11", &["not a constant"]);
    refused(&with("asphere 1 1e-5"), "3:11", &["not a constant"]);
    refused(&with("asphere 1 A4=x"), "3:14", &["\"x\" is not a number"]);
    refused(&with("asphere 1 conic=inf"), "3:17", &["not finite"]);
    refused(&with("asphere 1 A4=1 a4=1"), "3:16", &["given twice"]);
    refused(&with("asphere 1 A4=1\nasphere 1 A6=1"), "4:9", &["row 1 is given twice"]);
    refused(&with("apshere 1 A4=1"), "3:1", &["no line begins with \"apshere\"", "\"asphere\"?"]);
    refused("20 5 1.5 10\n-20 1 1 10\nstop 30 1 5\nasphere 3 A4=1", "3:1", &["bends no ray"]);
    refused(
        "20 5 1.5 10\n-20 1 1 10\n0 30 1 5\nasphere 3 A4=1",
        "3:1",
        &["between air and air bends no ray"],
    );
}

#[test]
fn a_flare_stop_is_a_plane_in_air_and_not_the_stop() {
    let four = ok(b"flare 1 1 9\n20 5 1.5 10\n-20 2 1 10\nstop 3 1 7\nflare 30 1 12\n");
    let shapes: Vec<Shape> = four.interfaces.iter().map(|interface| interface.shape).collect();
    let (sphere, other) = (Shape::Sphere { radius: 20.0 }, Shape::Sphere { radius: -20.0 });
    assert_eq!(shapes, [Shape::Plane, sphere, other, Shape::Plane, Shape::Plane]);
    assert_eq!((four.stop_index(), four.nominal_film_distance), (Some(3), Some(30.0)));
    let five = ok(b"Flare 1 9\n20 5 1.5 - 10\n-20 2 10\nstop 3 7\nflare 30 - - 12\n");
    assert_eq!(five.interfaces, four.interfaces);
    refused("20 5 1.5 10\nflare 2 1.6 9\n-20 0 1 9", "2:1", &["air on both sides"]);
}

const ZOOM: &str = "20 5 1.5 60 10\n-20 3 - - 10\nstop 1 - - 6\n30 2 1.6 40 8\n-30 40 - - 8\n\
    positions wide middle tele\ngap 2 3 5.5 9\nfilm 40 38 35\nstopdiameter 6 6.5 -\nfocal 28 35 50.5\n\
    fnumber 2.8 - 4\nobject 500 500 500\nfield 75 63.4 -\nyear 1999\n";

#[test]
fn moving_groups_are_read_from_columns() {
    let lens = ok(ZOOM.as_bytes());
    let positions = lens.positions.expect("three");
    assert_eq!(positions.gaps, [1, 4]);
    let [wide, middle, tele] = positions.columns.as_slice() else { panic!("{positions:?}") };
    assert_eq!((wide.name.as_deref(), wide.gaps.as_slice()), (Some("wide"), [3.0, 40.0].as_slice()));
    assert_eq!(
        (middle.focal_length, middle.fnumber, middle.object_distance),
        (Some(35.0), None, Some(500.0))
    );
    assert_eq!((middle.stop_diameter, tele.stop_diameter), (Some(6.5), None));
    assert_eq!((tele.gaps.as_slice(), tele.fnumber), ([9.0, 35.0].as_slice(), Some(4.0)));
    assert_eq!(lens.stated_focal_length, Some(28.0));
    assert_eq!(lens.stated.fields, [Some(75.0), Some(63.4), None]);
    assert_eq!((lens.stated.year, lens.stated.fnumber), (Some(1999), None));
    assert_eq!((lens.interfaces[1].thickness, lens.nominal_film_distance), (3.0, Some(40.0)));
    // A position needs no name.
    let unnamed = ok(ZOOM.replace("wide middle tele", "- - -").as_bytes()).positions.expect("three");
    assert!(unnamed.columns.iter().all(|column| column.name.is_none()));
}

#[test]
fn a_lens_without_positions_states_its_facts_once() {
    let lens = ok(b"20 5 1.5 10\n-20 30 1 10\nfocal 20.3\nfnumber 2\nfield 45\nyear 1961\n");
    assert_eq!(lens.stated_focal_length, Some(20.3));
    assert_eq!((lens.stated.fnumber, lens.stated.year), (Some(2.0), Some(1961)));
    assert_eq!((lens.stated.fields, lens.positions), (vec![Some(45.0)], None));
    let with = |line: &str| format!("20 5 1.5 10\n-20 30 1 10\n{line}\n");
    refused(&with("focal"), "3:1", &["no values behind \"focal\""]);
    refused(&with("focal 1 2"), "3:9", &["2 value(s) of \"focal\"; expected one value"]);
    refused(&format!("50\n{}", with("focal 50")), "4:1", &["give it once"]);
    refused(&with("fnumber -2"), "3:9", &["is positive"]);
    refused(&with("field 361"), "3:7", &["at most 360 degrees"]);
    refused(&with("year 75"), "3:6", &["\"75\" is not a year"]);
    refused(&with("year 1975 1976"), "3:11", &["one year"]);
    refused(&with("year 1975\nyear 1976"), "4:1", &["a second line \"year\""]);
    refused(&with("object 500"), "3:1", &["no line names the positions", "positions wide tele"]);
    refused(&with("gap 1 5"), "3:1", &["no line names the positions"]);
}

#[test]
fn a_malformed_column_is_refused_with_its_location() {
    let with = |from: &str, to: &str| ZOOM.replace(from, to);
    refused(
        &with("gap 2 3 5.5 9", "gap 2 3 5.5"),
        "7:1",
        &["2 value(s) of \"gap\"", "3 values, one per position"],
    );
    refused(&with("gap 2 3 5.5 9", "gap 2 3 5.5 9 1"), "7:15", &["4 value(s)"]);
    refused(&with("gap 2 3 5.5 9", "gap 2 3 - 9"), "7:9", &["\"-\" is not a number", "thickness in mm"]);
    refused(&with("gap 2 3 5.5 9", "gap 2 3 -5.5 9"), "2:1", &["position 2: thickness -5.5 mm"]);
    refused(&with("gap 2 3 5.5 9", "gap 6 3 5.5 9"), "7:5", &["\"6\" is not a row", "rows 1 to 5"]);
    refused(
        &with("gap 2 3 5.5 9", "gap 2 3.1 5.5 9"),
        "7:7",
        &["row 2 of the table has thickness 3", "first position"],
    );
    refused(&with("film", "gap 5 40 38 35\nfilm"), "9:1", &["row 5 is given twice"]);
    refused(&with("film", "gap 2 3 5 9\nfilm"), "8:1", &["row 2 is given twice"]);
    refused(
        &with("stopdiameter 6 ", "stopdiameter 7 "),
        "9:14",
        &["row 3 of the table has clear diameter 6"],
    );
    refused(&with("stop 1 - - 6", "flare 1 - - 6"), "9:1", &["no stop"]);
    refused(&with("middle", "wide"), "6:16", &["two positions are called \"wide\""]);
    refused(&with("object 500 500", "object 0 500"), "12:8", &["is positive"]);
    refused(&with("positions", "position"), "6:1", &["\"positions\"?"]);
    let many = format!("positions{}", " -".repeat(crate::prescription::MAX_POSITIONS + 1));
    refused(&with("positions wide middle tele", &many), "6:211", &["101 positions", "at most 100"]);
}

#[test]
fn a_stop_may_be_a_surface_of_glass() {
    let lens = ok(b"20 5 1.5 10\n-20 30 1 8\nstop 2\n");
    assert_eq!((lens.stop_index(), lens.stop_in_air()), (Some(1), None));
    assert_eq!(lens.interfaces[1].shape, Shape::Sphere { radius: -20.0 });
    let plane = ok(b"20 5 1.5 10\nstop 3 1.6 8\n-20 30 1 8\n");
    assert_eq!((plane.stop_index(), plane.stop_in_air()), (Some(1), None));
    refused("20 5 1.5 10\n-20 30 1 8\nstop 3", "3:6", &["\"3\" is not a row", "stop ROW"]);
    refused("20 5 1.5 10\n-20 30 1 8\nstop 1\nstop 2", "4:1", &["a lens has one stop"]);
    refused("20 5 1.5 10\n-20 2 1 8\nstop 9 1 4\nstop 1", "3:1", &["second stop"]);
    refused("20 5 1.5 10\n-20 30 1 8\nstop 2\nblades 5", "4:1", &["a stop in air"]);
}

#[test]
fn planes_that_only_limit_may_lie_within_a_neighbours_sagitta() {
    // The planes are between the vertices, before the first vertex and behind the last vertex.
    for text in [
        "20 5 1.5 10\n-20 -0.5 1 10\nstop 3 1 9\n20 5 1.5 10\n-20 30 1 10\n",
        "20 5 1.5 10\n-20 3 1 10\nstop -0.5 1 9\n20 5 1.5 10\n-20 30 1 10\n",
        "flare 2 1 9\nstop -0.5 1 9\n20 5 1.5 10\n-20 30 1 10\n",
        "20 5 1.5 10\n-20 -0.5 1 10\nstop 30 1 9\n",
    ] {
        let lens = ok(text.as_bytes());
        assert!(lens.interfaces.iter().any(|interface| interface.thickness == -0.5), "{text}");
    }
    // Surfaces that bend rays must still be in order.
    let between = "20 5 1.5 10\n-20 -0.5 1 10\nstop 0.25 1 9\n20 5 1.5 10\n-20 30 1 10\n";
    refused(between, "2:1", &["thickness -0.5 mm", "beside a stop"]);
    refused("20 5 1.5 10\n-20 3 1 10\nstop -1 1 9\n", "3:1", &["thickness -1 mm"]);
}

#[test]
fn a_plane_in_air_beside_a_row_named_stop_is_a_flare_stop() {
    let lens = ok(b"inf 2 1 12\n20 5 1.5 10\n-20 2 1 10\nstop 3 1 7\n");
    assert_eq!((lens.stop_index(), lens.interfaces[0].shape), (Some(3), Shape::Plane));
    refused("inf 2 1 12\n20 5 1.5 10\n-20 2 1 10\ninf 3 1 7\n", "4:1", &["second stop", "\"flare\""]);
}

#[test]
fn scene_and_film_lie_in_the_media_that_the_table_states() {
    let lens = ok(b"medium 1.33306 55.8\n20 5 1.5 60 10\n-20 30 1.336 - 10\n");
    assert_eq!(lens.object_medium, Medium::Glass { n_d: 1.33306, abbe: Some(55.8) });
    assert_eq!(lens.image_medium(), Medium::Glass { n_d: 1.336, abbe: None });
    assert_eq!((lens.nominal_film_distance, lens.is_dispersive()), (Some(30.0), true));
    for text in ["medium 1.33306\n", "medium 1.33306 -\n", "MEDIUM 1.33306\n"] {
        let medium = ok(format!("{text}{SINGLET}").as_bytes()).object_medium;
        assert_eq!(medium, Medium::Glass { n_d: 1.33306, abbe: None }, "{text}");
    }
    let water = ok(format!("medium water\n{SINGLET}").as_bytes()).object_medium;
    assert!((refractive_index(water, D_LINE) - 1.333).abs() < 1e-3 && water.is_dispersive());
    let named = ok(format!("medium N-BK7\n{SINGLET}").as_bytes());
    assert_eq!((named.object_glass, named.glasses.len()), (Some(0), 1));
    assert_eq!(ok(format!("medium air\n{SINGLET}").as_bytes()).object_medium, Medium::Air);
    // A plane in water is no stop unless the table says so; in air behind the lens it is one.
    let planes = ok(b"medium 1.33\ninf 1 1.33 9\n20 5 1.5 10\n-20 2 1 10\n0 30 1 5\n");
    assert_eq!((planes.stop_index(), planes.stop_in_air()), (Some(3), Some(3)));
    let stop = ok(b"medium 1.33\nstop 1 1.33 9\n20 5 1.5 10\n-20 2 1 10\n");
    assert_eq!((stop.stop_index(), stop.stop_in_air()), (Some(0), None));
    // Coatings are between air and glass.
    let coated =
        ok(b"medium 1.33\n20 5 1.5 10\n-20 2 1 10\ncoating all v-coat\n").coatings.expect("coatings");
    assert_eq!(coated.iter().map(|own| own.is_bare()).collect::<Vec<_>>(), [true, false]);
}

#[test]
fn a_malformed_medium_is_refused() {
    let with = |line: &str| format!("{line}\n{SINGLET}");
    refused(&with("medium"), "1:1", &["the medium in front of the lens is: medium NAME"]);
    refused(&with("medium 1.33 60 5"), "1:1", &["medium INDEX V"]);
    refused(&with("medium brine"), "1:8", &["\"brine\" is neither a refractive index nor a known glass"]);
    refused(&with("medium 0.9"), "1:8", &["1 or more"]);
    refused(&with("medium N-BK7 64"), "1:14", &["write - for the V-number"]);
    refused(&with("medium 1.33\nmedium 1.34"), "2:1", &["a second line \"medium\""]);
}

#[test]
fn unusual_indices_and_v_numbers_cause_warnings() {
    for (row, what) in [
        ("20 5 0.9997 - 10", "vacuum's against air"),
        ("20 5 1.0000000000001 - 10", "nearly air's"),
        ("20 5 1.5 1e-300 10", "V-number"),
        ("20 5 1.5 900 10", "V-number"),
    ] {
        let lens = ok(format!("{row}\n-20 30 - - 10\n").as_bytes());
        assert!(lens.remarks.iter().any(|remark| remark.contains(what)), "{row}: {:?}", lens.remarks);
    }
    assert_eq!(ok(b"20 5 1.5 60 10\n-20 30 - - 10\n").remarks, [""; 0]);
    refused("20 5 0.99 10", "1:6", &["1 or more"]);
}
