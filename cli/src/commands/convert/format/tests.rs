use super::*;
use realistic_optics::imaging::moving::MovingGroups;
use realistic_optics::lens::{Lens, Ray};
use realistic_optics::prescription::{Fate, Medium, catalogue, glass::refractive_index};
use realistic_optics::trace::Path as RayPath;

/// The formats that are read back, each with the largest difference of a ray, mm. Indices of a private glass are fitted.
const READ_BACK: [(Format, f64); 4] =
    [(Format::Dat, 0.0), (Format::Zmx, 1e-11), (Format::Json, 1e-11), (Format::Seq, 1e-7)];

fn back(format: Format, lens: &Prescription) -> (Prescription, Written) {
    let written = format.write(lens).unwrap_or_else(|why| panic!("{why}"));
    let back = read("back", written.text.as_bytes());
    let back = back.unwrap_or_else(|error| panic!("{}: {error}\n{}", lens.name, written.text));
    (back, written)
}

/// Checks that rays from the scene take the same way through both lenses.
#[track_caller]
fn same_rays(one: &Prescription, other: &Prescription, most: f64, what: &str) {
    let lenses = [one, other].map(Lens::at_own_wavelength);
    let [path, back] = lenses.each_ref().map(|lens| RayPath::<f64>::scene_to_film(lens).with_apertures(lens));
    let reach = lenses[0].front().semi_diameter;
    let mut passed = 0;
    for slope in [0.0, 0.1, -0.3] {
        for i in -10..=10 {
            // The pupil of a fisheye lens is a small part of its front.
            let height = (0.1 * f64::from(i)).powi(3) * reach;
            let ray = Ray { origin: [0.01 * reach, height, 50.0], direction: [0.0, slope, -1.0] };
            match (path.trace(ray), back.trace(ray)) {
                (Ok(one), Ok(two)) => {
                    passed += 1;
                    let apart =
                        |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
                    let apart = apart(one.origin, two.origin).max(apart(one.direction, two.direction));
                    assert!(apart <= most, "{apart}: {what}");
                }
                (one, two) => assert_eq!(one.is_err(), two.is_err(), "{ray:?}: {one:?} {two:?}: {what}"),
            }
        }
    }
    assert!(passed > 0, "no ray passes");
}

#[test]
fn every_lens_of_the_catalogue_reads_back_with_the_same_rays() {
    for name in catalogue::round() {
        let lens = catalogue::find(name).unwrap();
        for (format, most) in READ_BACK {
            let (back, written) = back(format, &lens);
            same_rays(&lens, &back, most, &written.text);
            assert_eq!(back.interfaces.len(), lens.interfaces.len());
            for (one, two) in lens.interfaces.iter().zip(&back.interfaces) {
                let size = one.semi_diameter;
                assert!((two.semi_diameter / size - 1.0).abs() <= most * 1e-3, "{name} {format:?}");
                let [n, own] = [one, two].map(|interface| refractive_index(interface.medium, 587.56));
                assert!((n - own).abs() <= most * 1e-3, "{name} {format:?}: {n} {own}");
            }
            assert!(format.is_written_by_us(written.text.as_bytes()), "{name} {format:?}\n{}", written.text);
            let unused = back.findings.iter().filter(|own| own.may_differ || own.fate == Fate::LeftOut);
            assert_eq!(unused.count(), 0, "{name} {format:?}: {:?}\n{}", back.findings, written.text);
        }
    }
}

#[test]
fn positions_are_configurations() {
    for name in ["zoom.24-70mm", "zoom.70-200mm", "macro.105mm"] {
        let lens = catalogue::find(name).unwrap();
        let (back, _) = back(Format::Zmx, &lens);
        let [one, two] = [&lens, &back].map(|lens| MovingGroups::of(lens).unwrap());
        let [columns, others] = [&lens, &back].map(|lens| &lens.positions.as_ref().unwrap().columns);
        assert_eq!(columns.len(), others.len());
        let zooms = lens.positions.as_ref().unwrap().layout().zooms;
        for (i, (own, other)) in columns.iter().zip(others).enumerate() {
            assert_eq!((&own.gaps, own.object_distance), (&other.gaps, other.object_distance), "{name}");
            let [own, other] = [&one, &two].map(|groups| groups.position(i % zooms).at(own.vergence()));
            assert_eq!(own.interfaces.len(), other.interfaces.len());
            same_rays(&own, &other, 1e-11, name);
        }
        let notes = Format::Json.write(&lens).unwrap().notes;
        assert!(notes.iter().any(|note| note.contains("of which the first is written")), "{notes:?}");
    }
}

/// Returns a number from 0 to 1 and advances the state (G. Marsaglia, "Xorshift RNGs", 2003).
fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns the table of a lens of some elements, with aspheres, media, apertures and a stop in air or on glass.
fn random_table(state: &mut u64) -> String {
    let mut between = |from: f64, to: f64| from + (to - from) * random(state);
    let mut text = String::new();
    let elements = 1 + between(0.0, 3.0) as usize;
    let has_stop_in_air = between(0.0, 1.0) < 0.5;
    if between(0.0, 1.0) < 0.3 {
        text += &format!("medium {} 55.8\n", between(1.3, 1.35));
    }
    let glasses = ["N-BK7 -", "N-SF11 -", "1.6 -", "1.5168 64.17", "CDGM:H-ZF3 -", "own -"];
    text += "glass own sellmeier B1=1.1 B2=0.2 B3=1 C1=0.006 C2=0.02 C3=103\n";
    let mut rows = Vec::new();
    for element in 0..elements {
        for face in 0..2 {
            let radius = between(30.0, 90.0) * if between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
            let glass = if face == 0 { glasses[between(0.0, 5.999) as usize] } else { "- -" };
            rows.push(format!("{radius} {} {glass} {}", between(2.0, 6.0), between(12.0, 16.0)));
            let row = rows.len();
            match between(0.0, 8.0) as usize {
                0 => {
                    text +=
                        &format!("asphere {row} conic={} A4={}\n", between(-2.0, 0.5), between(-1e-6, 1e-6))
                }
                1 => text += &format!("asphere {row} conic=0 A3={} A9=1e-13\n", between(-1e-5, 1e-5)),
                2 => text += &format!("asphere {row} conic=-1 A2=1e-4 A20={}\n", between(0.0, 1e-24)),
                3 => text += &format!("obstruction {row} circle {}\n", between(0.5, 2.0)),
                4 => text += &format!("aperture {row} rectangle {} 3.3\n", between(2.0, 5.0)),
                _ => {}
            }
        }
        if element == 0 && has_stop_in_air {
            rows.push(format!("stop {} - - {}", between(1.0, 3.0), between(8.0, 12.0)));
        }
    }
    if !has_stop_in_air && between(0.0, 1.0) < 0.5 {
        text += "stop 1\n";
    }
    text + &rows.join("\n") + "\n"
}

#[test]
fn random_lenses_read_back_with_the_same_rays() {
    let mut state = 0x9E37_79B9_7F4A_7C15;
    for _ in 0..300 {
        let table = random_table(&mut state);
        let lens = read("random.dat", table.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{table}"));
        // A formula that no catalogue has is replaced, and noted.
        let is_exact = !table.contains(" own -");
        for (format, most) in READ_BACK {
            if format == Format::Seq && format.write(&lens).is_err() {
                // It has no words for some aspheres.
                continue;
            }
            let (back, written) = back(format, &lens);
            let is_replaced = |note: &String| note.contains("own is") || note.ends_with("is own");
            assert!(is_exact || format == Format::Dat || written.notes.iter().any(is_replaced));
            same_rays(&lens, &back, if is_exact { most } else { 1e-3 }, &(table.clone() + &written.text));
        }
    }
}

#[test]
fn what_a_format_cannot_state_is_noted() {
    let text = "# A title\nyear 1999\nblades 6\nglass own sellmeier B1=1.1 B2=0.2 B3=1 C1=0.006 C2=0.02 C3=103\nabsorption N-BK7 400 0.1\n\
        coating 1 v-coat\naperture 2 ellipse 3 2\nobstruction 2 circle 0.5 x=1\n20 5 own - 10\n-20 1 - - 10\nstop 1 - - 6\n\
        30 2 N-BK7 - 8\n-30 0 - - 8\n";
    let lens = read("a.dat", text.as_bytes()).unwrap();
    for (format, left_out) in [
        (
            Format::Zmx,
            &["the elliptical aperture of surface 2", "the coating of surface 1", "index is off by at most"]
                [..],
        ),
        (
            Format::Json,
            &[
                "the circular obstruction of surface 2",
                "the coatings of surface 1",
                "index is off by at most",
            ],
        ),
        (
            Format::Seq,
            &["the elliptical aperture of surface 2", "GLASS1: indices at 9 wavelengths", "the coatings"],
        ),
    ] {
        let Written { text, notes } = format.write(&lens).unwrap();
        let common = ["the blades", "the absorption of N-BK7", "the year", "no place of the film"];
        for part in common.iter().chain(left_out) {
            let note = notes.iter().find(|note| note.contains(part));
            let note = note.unwrap_or_else(|| panic!("{format:?} {part}: {notes:?}"));
            assert!(format == Format::Json || text.contains(note.as_str()), "{text}");
        }
    }
    let odd = read("a.dat", b"20 5 N-BK7 10\n-20 30 1 10\nasphere 2 conic=0 A5=1e-6\n").unwrap();
    let refusal = Format::Seq.write(&odd).unwrap_err();
    assert!(refusal.starts_with("surface 2 has a term of r^5, and aspheres of CODE V"), "{refusal}");
}

#[test]
fn code_v_has_its_own_words() {
    let text = "# It's a lens\nwavelength 546.07\nfield 40\nglass poly polynomial A0=2.3 A2=-0.01 A-2=0.01\n\
        20.5 5 N-BK7 - 10\n-20 1 - - 10\nstop 1 - - 6\ninf 2 poly - 8\n-30 37.5 1.5 60 8\n\
        asphere 5 conic=-1 A4=1e-5 A20=1e-24\nobstruction 4 circle 0.5\nmedium 1.33\n";
    let written = Format::Seq.write(&read("a.dat", text.as_bytes()).unwrap()).unwrap();
    let lines: Vec<&str> = written.text.lines().filter(|line| !Format::Seq.is_note(line)).collect();
    let (head, rest) = lines.split_at(9);
    assert_eq!(head[..2], ["RDM;LEN", "TITLE 'It`s a lens'"]);
    assert!(head[2].starts_with("EPD 6."), "{head:?}");
    assert_eq!(head[3..], ["DIM M", "WL 486.13 546.07 656.27", "REF 2", "XAN 0 0 0", "YAN 0 14 20", "PRV"]);
    let wavelengths = "PWL 404.66 435.84 479.99 486.13 546.07 587.56 632.8 656.27 706.52";
    assert_eq!(rest[0], wavelengths);
    assert_eq!(rest[1], format!("'GLASS1' {}", ["1.33"; 9].join(" ")));
    assert_eq!(rest[2], "'GLASS2' LAU 2.3 -0.01 0.01 0 0 0");
    assert_eq!(
        rest[3..],
        [
            "END",
            "SO 0 1e20 'GLASS1'",
            "S 20.5 5 NBK7_SCHOTT",
            "  CIR 5",
            "S -20 1",
            "  CIR 5",
            "S 0 1",
            "  STO",
            "  CIR 3",
            "S 0 2 'GLASS2'",
            "  CIR 4",
            "  CIR OBS 0.5",
            "S -30 37.5 500000.600000",
            "  ASP",
            "  K -1",
            "  A 1e-5",
            "  J 1e-24",
            "  CIR 4",
            "SI 0 0",
            "GO",
        ]
    );
    let polynomial = read("a.dat", text.as_bytes()).unwrap().interfaces[3].medium;
    assert!(matches!(polynomial, Medium::Formula(_)));
}

#[test]
fn tables_written_by_hand_are_distinguished_from_converted_ones() {
    for name in catalogue::round() {
        let mut lens = catalogue::find(name).unwrap();
        lens.remarks = vec!["something was taken in another way".to_owned()];
        let text = table::write(&lens);
        assert!(Format::Dat.is_written_by_us(text.as_bytes()), "{name}");
        assert!(!Format::Dat.is_written_by_us(format!("{text}# a note\n").as_bytes()), "{name}");
    }
    let hand: &[u8] = b"20  5   1.5  10\n-20 40 1 10\n";
    assert!(!Format::Dat.is_written_by_us(hand) && !Format::Zmx.is_written_by_us(hand));
    assert!(!Format::Dat.is_written_by_us(b"no lens"));
}
