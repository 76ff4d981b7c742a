//! The built-in glasses against their makers' catalogues, evaluated independently (`golden/glasses.py`), and the
//! wavelength of a lens file.

use ::realistic_camera::{Host, Level, Parameters, Raster, open_lens};
use realistic_optics::{
    lens::first_order::FirstOrder,
    prescription::{GlassLibrary, Prescription, glass::refractive_index},
};

use super::tables::table;

/// Spectral lines i, g, F, e, d, C and t, nm, as in the golden table.
const LINES: [f64; 7] = [365.0146, 435.8343, 486.1327, 546.074, 587.5618, 656.2725, 1013.98];

#[test]
fn every_glass_of_the_makers_has_the_indices_of_its_catalogue() {
    let library = GlassLibrary::default();
    let rows = table("glasses.csv");
    assert_eq!(rows.len(), 1634);
    let (mut worst, mut compared) = (0.0_f64, 0);
    for row in &rows {
        let name = format!("{}:{}", row[0], row[1]);
        let glass = library.find(&name).unwrap_or_else(|| panic!("{name} is not known")).expect("right");
        let index = |nm: f64| refractive_index(glass.medium, nm);
        for (line, stated) in LINES.into_iter().zip(&row[4..]) {
            if let Ok(stated) = stated.parse::<f64>() {
                worst = worst.max((index(line) - stated).abs());
                compared += 1;
            }
        }
        // The values that the catalogue states are rounded; those of BOROFLOAT 33 have three decimals, and its formula
        // is a fit to them.
        let rough = if row[1] == "BOROFLOAT33" { 40.0 } else { 1.0 };
        if let (Ok(n_d), Ok(abbe)) = (row[2].parse::<f64>(), row[3].parse::<f64>()) {
            let [f, d, c] = [2, 4, 5].map(|line| index(LINES[line]));
            assert!((d - n_d).abs() < rough * 4e-5, "{name}: {d} for {n_d}");
            let own = (d - 1.0) / (f - c);
            assert!((own - abbe).abs() < rough * 0.0035 * abbe, "{name}: {own} for {abbe}");
        }
        let [from, to] = glass.range.expect("every page states one");
        assert!(from < to && to > 380.0, "{name}: {from} to {to}");
    }
    println!("{compared} indices within {worst:.1e}");
    // Nine decimals are stated.
    assert!(worst < 1e-9 && compared > 11_400, "{worst:e} of {compared}");
}

#[test]
fn glasses_missing_in_the_database_follow_their_sheets() {
    let library = GlassLibrary::default();
    let text = include_str!("../../crates/optics/lenses/glasses.csv");
    let mut count = 0;
    for line in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let catalogue = match cells[1] {
            "S" | "S18" | "T" => "SCHOTT",
            "O" => "OHARA",
            "H" | "H19" => "HOYA",
            "U20" => "SUMITA",
            "Z20" => "LZOS",
            "L" => "LIGHTPATH",
            "M" | "M20" => "MISC",
            "P" => "PLASTIC",
            "E20" => "ZEON",
            "A20" => "APEL",
            "G20" => "OSAKAGASCHEMICAL",
            other => panic!("{other}"),
        };
        let is_alias = cells[7] == "alias";
        let name = if is_alias { cells[0].to_owned() } else { format!("{catalogue}:{}", cells[0]) };
        let glass = library.find(&name).unwrap_or_else(|| panic!("{line}")).expect("right");
        let index = |nm: f64| refractive_index(glass.medium, nm);
        if let (Ok(n_d), Ok(abbe)) = (cells[2].parse::<f64>(), cells[3].parse::<f64>()) {
            let [d, f, c] = [587.5618, 486.1327, 656.2725].map(index);
            let own = (d - 1.0) / (f - c);
            // SUMITA rounds V to a tenth.
            let abbe_apart = 0.025_f64.max(0.003 * abbe);
            assert!((d - n_d).abs() < 1.2e-5 && (own - abbe).abs() < abbe_apart, "{line}: {d}, {own}");
            count += 1;
        }
    }
    assert!(count >= 720, "{count}");
    // The index of TOPAS at 400 nm is computed by hand from the constants of its sheet.
    let coc = library.find("COC").expect("listed").expect("right");
    assert!((refractive_index(coc.medium, 400.0) - 1.550_545_4).abs() < 1e-7);
    // A name from before the makers' whole catalogues were built in means SCHOTT's glass.
    for (name, n_d) in
        [("F2", 1.620_04), ("BAF4", 1.605_62), ("K5", 1.522_49), ("LAK9", 1.691_00), ("SF8", 1.688_93)]
    {
        let glass = library.find(name).expect("listed").expect("right");
        assert!((refractive_index(glass.medium, 587.5618) - n_d).abs() < 1e-5, "{name}");
    }
}

/// Returns a biconvex lens of radii 50 mm, 4 mm thick, in a file of the given general lines and `GLAS`.
fn biconvex(general: &str, glass: &str) -> String {
    format!(
        "MODE SEQ\nUNIT MM\nENPD 10\n{general}WAVM 1 0.5875618 1\nPWAV 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  \
         CURV 0.02\n  DISZ 4\n  GLAS {glass}\n  DIAM 10 1\nSURF 2\n  CURV -0.02\n  DISZ 40\n  DIAM 10 1\nSURF 3\n"
    )
}

/// Returns the focal length of the lens of [`biconvex`]: 1/f = (n - 1) (2/R - (n - 1) d/(n R²)).
fn focal_length(n: f64) -> f64 {
    ((n - 1.0) * (2.0 / 50.0 - (n - 1.0) * 4.0 / (n * 2500.0))).recip()
}

/// Returns the focal length of a file, and its warnings.
fn warned(text: &str, catalogue: Option<&str>) -> Result<(f64, Vec<String>), String> {
    let mut host = Host::new(Raster { xres: 1, yres: 1 }, None);
    host.lens_text = Some(("a.zmx".to_owned(), text.as_bytes().to_vec()));
    let parameters = Parameters { glass_catalog: catalogue.map(str::to_owned), ..Parameters::default() };
    let mut log = Vec::new();
    let opened = open_lens(&parameters, &host, &mut |_, text: &str| log.push(text.to_owned()));
    let (_, lens) = opened.map_err(|error| error.to_string())?;
    Ok((FirstOrder::of(&lens).expect("focal").focal_length, log))
}

#[test]
fn the_catalogue_that_a_file_names_selects_the_glass_maker() {
    // The n_d are from the makers' sheets.
    for (catalogue, name, n_d) in [
        ("SCHOTT", "F4", 1.616_59),
        ("SCHOTT", "F6", 1.636_36),
        ("SCHOTT", "F7", 1.625_36),
        ("SCHOTT", "F13", 1.622_37),
        ("HOYA", "BAF5", 1.607_29),
        ("HOYA", "BAF7", 1.608_01),
        ("HOYA", "BAFL2", 1.570_99),
        ("SUMITA", "LAFN7", 1.735),
        ("SUMITA", "LASFN9", 1.816),
        ("SUMITA", "BK7", 1.516_33),
        ("CDGM", "F4", 1.620_05),
        ("MISC SCHOTT", "LAFN7", 1.749_5),
        ("LZOS", "LZ_K8", 1.516_37),
        ("OSAKAGASCHEMICAL", "OKP4", 1.607_92),
    ] {
        let (focal, log) = warned(&biconvex(&format!("GCAT {catalogue}\n"), name), None).expect(name);
        // The bound corresponds to a hundred-thousandth of n_d.
        assert!((focal - focal_length(n_d)).abs() < 1.5e-3, "{catalogue} {name}: {focal}");
        assert_eq!(log, [""; 0], "{catalogue} {name}");
    }
    let (focal, _) = warned(&biconvex("GCAT SCHOTT\n", "F4 0 0 0 0 0"), None).expect("a lens");
    assert!((focal - 41.1736).abs() < 1e-3, "{focal}");
    // Another maker's glass is used, and this is reported.
    let (focal, log) = warned(&biconvex("GCAT OHARA\n", "F4"), None).expect("a lens");
    assert!((focal - 41.1736).abs() < 1e-3, "{focal}");
    let [warning] = &log[..] else { panic!("{log:?}") };
    assert!(
        warning.starts_with("a.zmx: glasses F4 of SCHOTT: in none of the catalogues that the file names"),
        "{warning}"
    );
}

#[test]
fn a_glass_is_known_by_its_code_its_group_and_as_air() {
    let focal = |general: &str, glass: &str| warned(&biconvex(general, glass), None).expect(glass);
    for (glass, n_d, stated) in [
        ("517642 0 0 1.5 40", 1.517, 49.0242),
        ("517642.251", 1.517, 49.0242),
        ("517-642", 1.517, 49.0242),
        ("SCHOTT-BK|N-BK7", 1.516_800_03, 49.043),
        ("___BLANK 1 0 1.5168 64.17", 1.5168, 49.043),
    ] {
        let (found, log) = focal("GCAT SCHOTT\n", glass);
        assert!(
            (found - focal_length(n_d)).abs() < 1e-5 && (found - stated).abs() < 2e-4,
            "{glass}: {found}"
        );
        assert_eq!(log, [""; 0], "{glass}");
    }
    // The same code is used in a table.
    let (found, _) = warned("50 4 517642 20\n-50 40 AIR 20\n", None).expect("a lens");
    assert!((found - 49.0242).abs() < 1e-4, "{found}");
    let (_, log) = warned("50 4 517642 20\n-50 40 VACUUM 20\n", None).expect("a lens");
    assert!(log[0].contains("index 0.99973, vacuum's against air; air is used"), "{log:?}");
}

#[test]
fn a_glass_of_two_numbers_has_its_index_at_the_d_line() {
    let text = biconvex("", "___BLANK 1 0 1.5168 64.17");
    let mut host = Host::new(Raster { xres: 1, yres: 1 }, None);
    for wavelength in ["0.5875618", "0.58756"] {
        let text = text.replace("0.5875618", wavelength);
        host.lens_text = Some(("a.zmx".to_owned(), text.into_bytes()));
        let (_, lens) = open_lens(&Parameters::default(), &host, &mut |_, _| ()).expect("a lens");
        assert_eq!(lens.surfaces[0].n_film, 1.5168, "{wavelength}");
    }
}

#[test]
fn numbers_that_cannot_be_read_are_shown() {
    for (glass, expected) in [
        (
            "___BLANK 1 0 1,5168 64.17",
            "\"1,5168\" is not a number: its decimal point is a comma; write 1.5168",
        ),
        ("___BLANK 1 0 1.5168 64,17", "\"64,17\" is not a number: its decimal point is a comma; write 64.17"),
        ("K10 1 0 x", "\"x\" is not a number; expected the index of a model glass"),
    ] {
        let error = warned(&biconvex("", glass), None).expect_err(glass);
        assert!(error.contains(expected), "{error}");
    }
    let error = warned("50 5 NIKON:J-SK16 - 20\n-50 40 1 - 20\n", None).expect_err("unknown");
    for part in
        ["no catalogue is called NIKON", "HIKARI has J-SK16: write HIKARI:J-SK16", "\"glass_catalog\""]
    {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn a_wrong_line_of_a_catalogue_takes_away_no_index() {
    let here = tempfile::tempdir().expect("a temporary directory");
    let catalogue = |name: &str, text: &str| {
        let path = here.path().join(name);
        std::fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    let row = "NM PLAS 2 0 1.5168 64.17 0 1\nCD 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653 0 0 0 0\n\
               LD 0.3 2.5\nIT 0.40 0.99 10\nIT 0.70 12.0 10\n";
    let line = catalogue("line.agf", row);
    let (focal, log) = warned(&biconvex("", "PLAS"), Some(&line)).expect("a glass");
    assert!((focal - focal_length(1.516_800_03)).abs() < 1e-5 && (focal - 49.043).abs() < 2e-4, "{focal}");
    let [warning] = &log[..] else { panic!("{log:?}") };
    assert!(
        warning.contains("line.agf:5: IT 0.70 12.0 10: expected") && warning.ends_with("left out"),
        "{warning}"
    );
    let range = "NM PLAS 1 0 1.4366 57.0 0 1\nCD 2.30 -0.80 0.014 0 0 0 0 0 0 0\nLD 0.4 1.6\n";
    let (focal, log) = warned(&biconvex("", "PLAS"), Some(&catalogue("range.agf", range))).expect("a glass");
    // n² = 2.30 - 0.80 λ² + 0.014/λ².
    let square = 0.587_561_8_f64.powi(2);
    let n = (2.30 - 0.80 * square + 0.014 / square).sqrt();
    assert!((n - 1.436_79).abs() < 5e-6 && (focal - focal_length(n)).abs() < 1e-9, "{focal}");
    assert_eq!(log, [""; 0]);
}

/// Returns a plano-convex lens of fused silica, whose focal length is 100 mm divided by n - 1, independent of its
/// thickness.
fn silica(more: &str) -> String {
    format!(
        "MODE SEQ\nUNIT MM\nENPD 10\n{more}SURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.01\n  DISZ 3\n  \
         GLAS F_SILICA 0 0 1.5 40\n  DIAM 6\nSURF 2\n  CURV 0\n  DISZ 100\n  DIAM 6\nSURF 3\n"
    )
}

/// Focal lengths of the lens of [`silica`] at 248 nm and at the d line, by I. H. Malitson's formula (J. Opt. Soc. Am.
/// 55, 1205, 1965) in 30 digits.
const FOCAL_LENGTHS: [f64; 2] = [100.0 / 0.508_550_711, 100.0 / 0.458_463_750];

/// A lens, its focal length, and the messages about it.
type Opened = (Prescription, f64, Vec<(Level, String)>);

fn opened(file: &str, text: &str, wavelength: Option<f64>) -> Result<Opened, String> {
    let mut host = Host::new(Raster { xres: 1, yres: 1 }, None);
    host.lens_text = Some((file.to_owned(), text.as_bytes().to_vec()));
    let mut log = Vec::new();
    let parameters = Parameters { wavelength, ..Parameters::default() };
    let opened = open_lens(&parameters, &host, &mut |level, text: &str| log.push((level, text.to_owned())));
    let (prescription, lens) = opened.map_err(|error| error.to_string())?;
    Ok((prescription, FirstOrder::of(&lens).expect("focal").focal_length, log))
}

#[test]
fn a_lens_is_traced_at_the_wavelength_that_its_file_is_for() {
    let file = silica("WAVM 1 0.248 1\nWAVM 2 0.58756 1\nPWAV 1\n");
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-7;
    let (lens, focal_length, log) = opened("duv.zmx", &file, None).expect("a lens");
    assert!(near(focal_length, FOCAL_LENGTHS[0]), "{focal_length}");
    assert_eq!(lens.wavelength, Some(248.0));
    assert!(
        log.contains(&(
            Level::Info,
            "lens \"duv.zmx\" is for 248 nm by its file, and is traced at that".to_owned()
        )),
        "{log:?}"
    );
    // The user's own wavelength takes precedence, without a message.
    let (_, focal_length, log) = opened("duv.zmx", &file, Some(587.56)).expect("a lens");
    assert!(near(focal_length, FOCAL_LENGTHS[1]) && log.is_empty(), "{focal_length}, {log:?}");
    let visible = silica("WAVM 1 0.248 1\nWAVM 2 0.58756 1\nPWAV 2\n");
    let (_, focal_length, log) = opened("visible.zmx", &visible, None).expect("a lens");
    assert!(near(focal_length, FOCAL_LENGTHS[1]) && log.is_empty(), "{focal_length}, {log:?}");
    // The project's own table format states the same wavelength in a separate line.
    let table = "wavelength 248\n100 3 F_SILICA 12\ninf 100 1 12\n";
    let (_, focal_length, _) = opened("duv.dat", table, None).expect("a lens");
    assert!(near(focal_length, FOCAL_LENGTHS[0]), "{focal_length}");
    // A scaled lens has the requested focal length at that wavelength.
    let here = tempfile::tempdir().expect("a temporary directory");
    let path = here.path().join("duv.dat");
    std::fs::write(&path, table).expect("written");
    let parameters =
        Parameters { lens_file: Some(format!("{}@50mm", path.display())), ..Parameters::default() };
    let host = Host::new(Raster { xres: 1, yres: 1 }, None);
    let (_, lens) = open_lens(&parameters, &host, &mut |_, _| ()).expect("a lens");
    assert!(near(FirstOrder::of(&lens).expect("focal").focal_length, 50.0));
}

#[test]
fn a_wavelength_counts_where_the_glasses_have_data() {
    let table = |glass: &str| format!("100 3 {glass} 12\ninf 100 1 12\n");
    let outcome = |glass: &str, nm: f64| match opened("lens.dat", &table(glass), Some(nm)) {
        Ok((.., log)) => log.into_iter().map(|(_, text)| text).collect::<String>(),
        Err(why) => format!("refused: {why}"),
    };
    assert_eq!([outcome("F_SILICA", 210.0), outcome("NIFS-S", 200.0), outcome("N-BK7", 300.0)], [""; 3]);
    let refused = outcome("N-BK7", 280.0);
    assert!(refused.contains("refused: lens \"lens.dat\": glass N-BK7 has data from 300 to 2500 nm, and the wavelength is 280 nm"), "{refused}");
    assert!(
        outcome("SCHOTT:IRG22", 587.56).contains("beyond the data of glass SCHOTT:IRG22 (1000 to 12000 nm)")
    );
    assert_eq!(outcome("SCHOTT:IRG22", 1550.0), "");
    assert!(outcome("F_SILICA", 199.0).contains("it must be from 200 to 2000 nm"));
    let continued = outcome("LASF010", 380.0);
    assert!(continued.contains("380 nm is beyond the data of glass LASF010 (400 to 700 nm)"), "{continued}");
    // The constants are from the file itself, and valid in the range that the file states.
    let own = |range: &str| {
        format!("glass X sellmeier B1=1.1 B2=0.1 B3=1 C1=0.006 C2=0.01 C3=100 {range}\n{}", table("X"))
    };
    let own = |range: &str, nm: f64| opened("lens.dat", &own(range), Some(nm)).map(|_| ());
    assert_eq!([own("from=0.24 to=1", 250.0), own("", 300.0)], [Ok(()), Ok(())]);
    assert!(own("", 250.0).expect_err("refused").contains("is defined without a range (from=, to=)"));
    // n_d and V are inaccurate beyond the visible range, and a message states the error.
    let two = |nm: f64| match opened("lens.dat", "100 3 1.5168 64.17 12\ninf 100 - - 12\n", Some(nm)) {
        Ok((.., log)) => log.into_iter().map(|(_, text)| text).collect::<String>(),
        Err(why) => format!("refused: {why}"),
    };
    assert_eq!([two(400.0), two(700.0)], [""; 2]);
    assert!(
        two(1000.0).contains(
            "half of the catalogues' glasses are met within 0.00033 there, the worst within 0.0029"
        ),
        "{}",
        two(1000.0)
    );
    assert!(
        two(250.0).contains(
            "refused: lens \"lens.dat\": a glass is known by n_d and V and counts from 300 to 2000 nm"
        ),
        "{}",
        two(250.0)
    );
}
