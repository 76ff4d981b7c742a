//! Writes a prescription as the project's own table (`docs/lens-format.md`). The table reads back to the same bits:
//! every number has enough digits to distinguish it from the neighbouring doubles.

use super::numbers::{micrometres, number};
use realistic_optics::prescription::{
    Aperture, Asphere, Biconic, Blades, Coating, CoordinateBreak, FIRST_POWER, Interface, Medium, Meridian,
    Outline, Positions, Prescription, STACK, Shape, SurfaceCoating, Unsymmetric,
    glass::{Formula, HIGHEST_POWER, LOWEST_POWER},
};
use std::fmt::Write as _;

/// Prefix of a remark, a line about a statement of the source that was interpreted differently.
pub const REMARK: &str = "# as it was read: ";

/// Returns the text of the table.
pub fn write(lens: &Prescription) -> String {
    let mut text = String::new();
    // The first comment of a table is its title, so a lens without a title has no comments.
    if let Some(title) = &lens.title {
        let _ = writeln!(text, "# {title}");
        for remark in &lens.remarks {
            let _ = writeln!(text, "{REMARK}{}", remark.replace(['\n', '\r'], " "));
        }
    }
    let columns = lens.positions.as_ref().map_or(&[][..], |positions| &positions.columns);
    // With positions, the lens has the focal length of the first position unless it states another.
    match (lens.stated_focal_length, columns.first()) {
        (Some(length), Some(first)) if first.focal_length != Some(length) => {
            let _ = writeln!(text, "{}", number(length));
        }
        (Some(length), None) => line(&mut text, "focal", &[number(length)]),
        _ => {}
    }
    if let Some(wavelength) = lens.wavelength {
        line(&mut text, "wavelength", &[number(wavelength)]);
    }
    if let Some(year) = lens.stated.year {
        line(&mut text, "year", &[year.to_string()]);
    }
    if let Some(fnumber) = lens.stated.fnumber {
        line(&mut text, "fnumber", &[number(fnumber)]);
    }
    if !lens.stated.fields.is_empty() {
        line(&mut text, "field", &lens.stated.fields.iter().copied().map(or_dash).collect::<Vec<_>>());
    }
    if let Some(positions) = &lens.positions {
        write_positions(&mut text, positions, lens.interfaces.len());
    }
    if let Some(Blades { count, rotation, curvature }) = lens.blades() {
        let [rotation, curvature] = [rotation, curvature].map(number);
        let blades = [count.to_string(), format!("rotation={rotation} curvature={curvature}")];
        line(&mut text, "blades", &blades);
    }
    for (row, interface) in (1..).zip(&lens.interfaces) {
        interface.apertures.iter().for_each(|aperture| write_aperture(&mut text, row, aperture));
    }
    let names = glass_names(lens);
    for (name, (medium, glass)) in &names {
        let named = glass.and_then(|glass| lens.glasses.get(glass)).map(|(_, glass)| glass);
        let range = named.and_then(|glass| glass.range).map_or_else(String::new, range);
        line(&mut text, "glass", &[name.clone(), definition(*medium) + &range]);
        if let Some(absorption) = named.and_then(|glass| glass.transmittance.as_ref()) {
            let knots = absorption.knots().iter().flat_map(|[nm, per_mm, _]| [*nm, *per_mm].map(number));
            line(&mut text, "absorption", &[vec![name.clone()], knots.collect()].concat());
        }
    }
    let object = (lens.object_medium, lens.object_glass);
    if lens.object_medium != Medium::Air {
        line(&mut text, "medium", &medium_cells(object, &names));
    }
    for (row, interface) in lens.interfaces.iter().enumerate() {
        if let Shape::Asphere(asphere) = &interface.shape {
            line(&mut text, "asphere", &[(row + 1).to_string(), constants(asphere)]);
        }
        write_general(&mut text, &(row + 1).to_string(), interface);
    }
    if let Some(change) = &lens.film_break {
        write_break(&mut text, "film", change);
    }
    if let Some(coatings) = &lens.coatings {
        let coated = || coatings.iter().enumerate().filter(|(_, own)| !own.is_bare());
        for (row, own) in coated() {
            let mut values = vec![(row + 1).to_string()];
            match own {
                SurfaceCoating::Named { coating, wavelength } => {
                    values.extend([coating.name().to_owned(), format!("at={}", number(*wavelength))]);
                }
                SurfaceCoating::Stack(layers) => {
                    values.push(STACK.to_owned());
                    values.extend(layers.iter().flat_map(|layer| [layer.index, layer.thickness].map(number)));
                }
            }
            line(&mut text, "coating", &values);
        }
        // A list of coatings is written even if all of them are bare.
        if coated().next().is_none() {
            line(&mut text, "coating", &["all".to_owned(), Coating::Bare.name().to_owned()]);
        }
    }
    if let (Some(row), None) = (lens.stop_index(), lens.stop_in_air()) {
        line(&mut text, "stop", &[(row + 1).to_string()]);
    }
    if lens.title.is_some() {
        text += "# radius, thickness, n_d or glass, V-number, clear diameter\n";
    }
    let last = lens.interfaces.len() - 1;
    let mut in_front = lens.object_medium;
    // The sign of the light's travel, which thicknesses have.
    let mut sign = 1.0;
    for (row, interface) in lens.interfaces.iter().enumerate() {
        sign = if interface.is_mirror { -sign } else { sign };
        let film = sign * lens.nominal_film_distance.unwrap_or(0.0);
        let thickness = if row < last { interface.thickness } else { film };
        let [n_d, abbe] = medium_cells((interface.medium, interface.glass), &names);
        let cells = [
            radius(interface, in_front),
            number(thickness),
            n_d,
            abbe,
            number(2.0 * interface.semi_diameter),
        ];
        let _ = writeln!(text, "{}{}", cells.join("  "), name_of_numbers(lens, interface));
        in_front = interface.medium;
    }
    text
}

fn line(text: &mut String, keyword: &str, values: &[String]) {
    let _ = writeln!(text, "{keyword} {}", values.join(" "));
}

fn or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), number)
}

fn write_positions(text: &mut String, positions: &Positions, rows: usize) {
    let columns = &positions.columns;
    let each = |cell: &dyn Fn(&realistic_optics::prescription::Position) -> String| {
        columns.iter().map(cell).collect::<Vec<_>>()
    };
    line(text, "positions", &each(&|column| column.name.clone().unwrap_or_else(|| "-".to_owned())));
    for (i, &row) in positions.gaps.iter().enumerate() {
        let keyword = if row + 1 == rows { "film".to_owned() } else { format!("gap {}", row + 1) };
        line(text, &keyword, &each(&|column| number(column.gaps[i])));
    }
    if columns.iter().any(|column| column.stop_diameter.is_some()) {
        line(text, "stopdiameter", &each(&|column| or_dash(column.stop_diameter)));
    }
    if columns.iter().any(|column| column.focal_length.is_some()) {
        line(text, "focal", &each(&|column| or_dash(column.focal_length)));
    }
    if columns.iter().any(|column| column.fnumber.is_some()) {
        line(text, "fnumber", &each(&|column| or_dash(column.fnumber)));
    }
    if columns.iter().any(|column| column.object_distance.is_some()) {
        let object = |distance: Option<f64>| distance.map_or_else(|| "inf".to_owned(), number);
        line(text, "object", &each(&|column| object(column.object_distance)));
    }
}

/// Returns the name that the file gives to a glass of n_d and V, as a comment; empty for a lens without a title,
/// because then there are no comments.
fn name_of_numbers(lens: &Prescription, interface: &Interface) -> String {
    let is_numbers = matches!(interface.medium, Medium::Glass { .. }) && lens.title.is_some();
    lens.glass_behind(interface)
        .filter(|_| is_numbers)
        .map_or_else(String::new, |(name, _)| format!("  # {}", name.replace(['\n', '\r'], " ")))
}

/// Writes the wavelength range in which a formula is valid, µm.
fn range(range: [f64; 2]) -> String {
    let [from, to] = range.map(|end| number(micrometres(end)));
    format!(" from={from} to={to}")
}

/// A medium, with the position of its glass in [`Prescription::glasses`]. Glasses of one formula may absorb
/// differently.
type OwnMedium = (Medium, Option<usize>);

/// Returns the media that have a formula, each with a name that is valid in a table. The name is the lens's own name for
/// the glass if that is a word that begins with a letter.
fn glass_names(lens: &Prescription) -> Vec<(String, OwnMedium)> {
    let mut names: Vec<(String, OwnMedium)> = Vec::new();
    for medium in lens.media() {
        let has_formula = matches!(medium.0, Medium::Sellmeier { .. } | Medium::Formula(_));
        if !has_formula || names.iter().any(|(_, known)| *known == medium) {
            continue;
        }
        let own = medium.1.and_then(|glass| lens.glasses.get(glass)).map(|(name, _)| name.as_str());
        let is_taken =
            |name: &str, names: &[(String, OwnMedium)]| names.iter().any(|(known, _)| known == name);
        let own = own.filter(|name| is_word(name) && !is_taken(name, &names));
        let name = own.map_or_else(
            || (1..).map(|i| format!("glass-{i}")).find(|name| !is_taken(name, &names)).expect("one is free"),
            str::to_owned,
        );
        names.push((name, medium));
    }
    names
}

/// Writes an aperture or an obstruction of a row. Blades have a line of their own, and a lens file has no pictures.
fn write_aperture(text: &mut String, row: usize, aperture: &Aperture) {
    let (shape, sizes) = match &aperture.outline {
        Outline::Ellipse([x, y]) if x == y => ("circle", vec![*x]),
        Outline::Ellipse(semi_axes) => ("ellipse", semi_axes.to_vec()),
        Outline::Rectangle(half_widths) => ("rectangle", half_widths.to_vec()),
        Outline::Polygon(vertices) => ("polygon", vertices.concat()),
        Outline::Blades(_) | Outline::Picture(_) => return,
    };
    let Aperture { center: [x, y], rotation, is_obstruction, .. } = *aperture;
    let mut words = vec![row.to_string(), shape.to_owned()];
    words.extend(sizes.into_iter().map(number));
    let constants = [("x", x), ("y", y), ("rotation", rotation)].into_iter();
    words.extend(
        constants.filter(|(_, value)| *value != 0.0).map(|(name, value)| format!("{name}={}", number(value))),
    );
    line(text, if is_obstruction { "obstruction" } else { "aperture" }, &words);
}

/// Whether a table accepts the word as the name of a glass.
fn is_word(name: &str) -> bool {
    let is_plain = |c: char| !c.is_whitespace() && !c.is_control() && !matches!(c, ',' | '#');
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(is_plain)
        && name.parse::<f64>().is_err()
        && !name.eq_ignore_ascii_case("stop")
}

/// Writes the formula of a glass, with the formula's constants.
fn definition(medium: Medium) -> String {
    let named = |name: &str, value: f64| format!("{name}={}", number(value));
    let numbered = |letter: char, values: &[f64]| {
        (1..).zip(values).map(|(i, value)| named(&format!("{letter}{i}"), *value)).collect()
    };
    let (formula, constants): (&str, Vec<String>) = match medium {
        Medium::Sellmeier { b, c } => ("sellmeier", [numbered('B', &b), numbered('C', &c)].concat()),
        Medium::Formula(Formula::Sellmeier { rest: [a, d], b, c }) => {
            let rest = vec![named("A", a), named("D", d)];
            ("sellmeier", [rest, numbered('B', &b), numbered('C', &c)].concat())
        }
        Medium::Formula(Formula::Polynomial(by_power)) => {
            let powers = (LOWEST_POWER..=HIGHEST_POWER).step_by(2);
            (
                "polynomial",
                powers.zip(by_power).map(|(power, value)| named(&format!("A{power}"), value)).collect(),
            )
        }
        Medium::Formula(Formula::Conrady(constants)) => (
            "conrady",
            ["A", "B", "C"].iter().zip(constants).map(|(name, value)| named(name, value)).collect(),
        ),
        Medium::Formula(Formula::Herzberger(constants)) => {
            let names = ["A", "B", "C", "D", "E", "F"];
            ("herzberger", names.iter().zip(constants).map(|(name, value)| named(name, value)).collect())
        }
        Medium::Air | Medium::Glass { .. } => unreachable!("only glasses with formulas are defined"),
    };
    format!("{formula} {}", constants.join(" "))
}

/// Writes the conic constant and the nonzero terms. A term of -0 is written, too, so that it reads back to the same
/// bits.
fn constants(asphere: &Asphere) -> String {
    let terms = (FIRST_POWER..).zip(asphere.terms).filter(|(_, term)| term.to_bits() != 0);
    let terms = terms.map(|(power, term)| format!(" A{power}={}", number(term)));
    format!("conic={}{}", number(asphere.conic), terms.collect::<String>())
}

/// Returns a radius as a cell.
fn finite(radius: f64) -> String {
    if radius.is_infinite() { "inf".to_owned() } else { number(radius) }
}

/// Writes the lines of an interface that is no refracting surface of revolution on the axis.
fn write_general(text: &mut String, row: &str, interface: &Interface) {
    let named = |name: &str, value: f64| (value != 0.0).then(|| format!("{name}={}", number(value)));
    match interface.shape {
        Shape::Unsymmetric(Unsymmetric::Toroid(toroid)) => {
            let profile = if toroid.meridian == Meridian::X { "profile=x" } else { "profile=y" };
            let rotation = format!("rotation={}", finite(toroid.rotation_radius));
            let terms = (1..).zip(toroid.terms).filter_map(|(i, term)| named(&format!("A{}", 2 * i), term));
            let mut values = vec![row.to_owned(), profile.to_owned(), rotation];
            values.extend(named("conic", toroid.conic).into_iter().chain(terms));
            line(text, "toroid", &values);
        }
        Shape::Unsymmetric(Unsymmetric::Biconic(Biconic { radii, conics })) => {
            let mut values = vec![row.to_owned(), format!("x={}", finite(radii[0]))];
            values.extend(named("conic_x", conics[0]).into_iter().chain(named("conic_y", conics[1])));
            line(text, "biconic", &values);
        }
        Shape::Plane | Shape::Sphere { .. } | Shape::Asphere(_) => {}
    }
    if interface.is_mirror {
        line(text, "mirror", &[row.to_owned()]);
    }
    if let Some(change) = &interface.coordinate_break {
        write_break(text, row, change);
    }
}

/// Writes a change of frame: the shift along the old z in a line of its own, then the decentre and the tilts.
fn write_break(text: &mut String, row: &str, change: &CoordinateBreak) {
    let (z, [x, y], tilts) = change.parts();
    if z != 0.0 {
        line(text, "break", &[row.to_owned(), format!("z={}", number(z))]);
    }
    let names = ["x", "y", "tilt_x", "tilt_y", "tilt_z"];
    let values = [x, y].into_iter().chain(tilts);
    let named = names.iter().zip(values).filter(|(_, value)| *value != 0.0);
    let named: Vec<String> = named.map(|(name, value)| format!("{name}={}", number(value))).collect();
    if !named.is_empty() {
        line(text, "break", &[vec![row.to_owned()], named].concat());
    }
}

fn radius(interface: &Interface, in_front: Medium) -> String {
    match interface.shape {
        Shape::Sphere { radius } => number(radius),
        Shape::Asphere(asphere) if asphere.radius.is_infinite() => "inf".to_owned(),
        Shape::Asphere(asphere) => number(asphere.radius),
        Shape::Unsymmetric(Unsymmetric::Toroid(toroid)) => finite(toroid.radius),
        Shape::Unsymmetric(Unsymmetric::Biconic(biconic)) => finite(biconic.radii[1]),
        Shape::Plane if interface.is_mirror => "inf".to_owned(),
        Shape::Plane if interface.is_stop => "stop".to_owned(),
        Shape::Plane if in_front == Medium::Air && interface.medium == Medium::Air => "flare".to_owned(),
        Shape::Plane => "inf".to_owned(),
    }
}

/// Returns the cells for the index and the V-number.
fn medium_cells(medium: OwnMedium, names: &[(String, OwnMedium)]) -> [String; 2] {
    let dash = || "-".to_owned();
    match medium.0 {
        Medium::Air => [dash(), dash()],
        Medium::Glass { n_d, abbe } => [number(n_d), or_dash(abbe)],
        Medium::Sellmeier { .. } | Medium::Formula(_) => {
            let own = names.iter().find(|(_, known)| *known == medium);
            let name = own.map(|(name, _)| name.clone());
            [name.expect("every glass with a formula has a name"), dash()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::{GlassLibrary, catalogue, read, read_with};
    use std::sync::Arc;

    /// Formats the parts of a lens that read back to the same bits (`{:?}` distinguishes -0 from 0): all except the
    /// name, the remarks, the findings and the names of glasses.
    fn bits(lens: &Prescription) -> String {
        let absorb = lens.transmittances();
        let mut lens = Prescription { name: String::new(), glasses: Vec::new(), ..lens.clone() };
        (lens.remarks, lens.findings) = (Vec::new(), Arc::default());
        lens.interfaces.iter_mut().for_each(|interface| interface.glass = None);
        format!("{lens:?} {absorb:?}")
    }

    #[track_caller]
    fn there_and_back(lens: &Prescription) {
        let text = write(lens);
        let back = read("own.dat", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(bits(&back), bits(lens), "{text}");
        assert!(back.remarks.is_empty(), "{:?}", back.remarks);
    }

    #[test]
    fn every_lens_of_the_catalogue_reads_back_to_the_same_bits() {
        for name in catalogue::round() {
            let lens = catalogue::find(name).unwrap();
            there_and_back(&lens);
            there_and_back(&lens.scaled(1.0 / 3.0));
        }
    }

    #[test]
    fn every_statement_of_a_table_reads_back() {
        let text = "flare 1 - - 9.1\n20 5 own - 10\n-20.1 0.7 poly - 10\ninf 2e-17 1.6 - 10\n21 3 - - 10\nstop 1 - - 6\n\
            inf 1 con - 8\n30 2 her - 8\n-30 2 ext - 8\n-31 40 - - 8\n\
            glass own sellmeier B1=1.1 B2=0.2 B3=1 C1=0.006 C2=0.02 C3=103\nglass poly polynomial A0=2.3 A2=-0.01 A-2=0.01\n\
            glass con conrady A=1.5 B=0.01 C=0.001\nglass her herzberger A=1.5 B=0.01 C=0.001 D=-0.01 E=0 F=0\n\
            glass ext sellmeier A=1.1 B1=1.2 C1=0.01 D=-0.01\nasphere 7 conic=-3.3 A2=1e-3 A3=1e-5 A20=-1e-40\n\
            asphere 2 conic=-1.1 A4=-0\ncoating 2 three-layer at=512.5\ncoating 10 v-coat\n\
            aperture 6 rectangle 2 1.1 y=0.5 rotation=-20\naperture 2 polygon 0 0 3 1 -2 0.7\n\
            obstruction 1 circle 1.3 x=-0.1\ncoating 5 stack 1.38 99.6 2.05 134.15\npositions wide - tele\ngap 5 3 5.5 9\nfilm 40 38 35\nstopdiameter 6 6.5 -\nfocal - 35 50.5\n\
            fnumber 2.8 - 4\nobject inf 500 inf\nfield 75 63.4 -\nyear 1999\n";
        let lens = read("all.dat", text.as_bytes()).unwrap();
        there_and_back(&lens);
        there_and_back(&Prescription { title: Some("A title, with # and more".to_owned()), ..lens });
        for single in [
            "50\n20 5 1.5 - 10\n-20 - - - 10",
            "20 5 1.5 60 10\n-20 30 - - 10\nfocal 20\nfnumber 4\nfield 30",
            "medium 1.33306 55.8\n20 5 1.5 60 10\n-20 30 1.336 - 10",
            "medium 1.33\n20 5 N-BK7 - 10\n-20 30 N-BK7 - 10\nabsorption N-BK7 400 0.1",
            "glass sea sellmeier B1=0.75 B2=0 B3=0 C1=0.01 C2=0 C3=0\nmedium sea\nstop 1 sea - 9\n20 5 1.5 - 10\n-20 30 sea - 10",
        ] {
            there_and_back(&read("single.dat", single.as_bytes()).unwrap());
        }
    }

    #[test]
    fn glasses_of_catalogues_are_defined_in_the_table() {
        let agf = "NM 7X 1 0 1.5 60\nCD 2.3 -0.01 0.01 0.0002 0 0\nNM A,B 9 0 1.5 60\nCD 1 1.25 0.01 1 100\n";
        let mut library = GlassLibrary::default();
        library.add("x.agf", agf.as_bytes()).unwrap();
        let zmx = "SURF 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.05\n  DISZ 4\n  GLAS 7X 0 0\n  DIAM 5\nSURF 2\n  CURV -0.05\n  DISZ 1\n  \
            GLAS A,B 0 0\n  DIAM 5\nSURF 3\n  CURV 0\n  DISZ 1\n  GLAS N-BK7 0 0\n  DIAM 5\nSURF 4\n  CURV 0\n  DISZ 30\n  DIAM 5\nSURF 5\n";
        let lens = read_with("x.zmx", zmx.as_bytes(), &library).unwrap();
        let text = write(&lens);
        assert!(
            text.contains("glass glass-1 polynomial") && text.contains("glass N-BK7 sellmeier B1="),
            "{text}"
        );
        there_and_back(&lens);
    }

    #[test]
    fn absorption_of_glasses_reads_back() {
        let agf = "NM DARK 2 0 1.5 60\nCD 1.04 0.006 0.23 0.02 1.01 103\nLD 0.3 2.5\nIT 0.3 0 25\nIT 0.38 0.63 25\n\
            IT 0.4047 0.91 10\nIT 0.7 1 25\nIT 2.5 0.9 25\n";
        let mut library = GlassLibrary::default();
        library.add("x.agf", agf.as_bytes()).unwrap();
        let lens = read_with("x.dat", b"20 4 DARK 9\n-20 2 N-BK7 9\n-60 30 1 9\n", &library).unwrap();
        there_and_back(&lens);
        let text = write(&lens);
        let back = read("own.dat", text.as_bytes()).unwrap();
        assert!(text.contains("\nabsorption DARK 300 ") && text.contains(" 700 0 2500 "), "{text}");
        assert!(lens.transmittances()[0].is_some() && lens.transmittances()[1].is_none());
        assert_eq!(back.transmittances(), lens.transmittances());
        assert_eq!(write(&back), text);
    }

    #[test]
    fn glasses_of_one_formula_that_absorb_differently_stay_apart() {
        let text = "20 5 N-BK7 10\n-20 2 N-BK7HT 10\n-50 1 1 10\n30 2 N-BK7 10\n60 30 1 10\nabsorption N-BK7HT 400 0.1\n";
        let lens = read("own.dat", text.as_bytes()).unwrap();
        there_and_back(&lens);
        let absorbed = lens.transmittances().iter().map(Option::is_some).collect::<Vec<_>>();
        assert_eq!(absorbed, [false, true, false, false, false]);
        let text = write(&lens);
        assert!(text.contains("\n-20  2  N-BK7HT  ") && text.contains("\n30  2  N-BK7  "), "{text}");
    }

    #[test]
    fn the_wavelength_and_the_names_and_ranges_of_glasses_read_back() {
        let zmx = "NAME For 248 nm\nWAVM 1 0.248 1\nPWAV 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.05\n  DISZ 4\n  GLAS F_SILICA 0 0\n  \
            DIAM 5\nSURF 2\n  CURV -0.05\n  DISZ 1\n  GLAS NIFS-S 3 0 1.9 20\n  DIAM 5\nSURF 3\n  CURV 0\n  DISZ 30\n  DIAM 5\nSURF 4\n";
        let lens = read("x.zmx", zmx.as_bytes()).unwrap();
        let text = write(&lens);
        for part in ["wavelength 248\n", "glass F_SILICA sellmeier", "from=0.21 to=3.71\n", "glass NIFS-S "] {
            assert!(text.contains(part), "{text} lacks {part}");
        }
        there_and_back(&lens);
        let back = read("own.dat", text.as_bytes()).unwrap();
        assert_eq!((&back.glasses, back.wavelength), (&lens.glasses, Some(248.0)));
        // The row has a model glass as two numbers, and the glass's name as a comment.
        let model = zmx.replace("0.248", "0.6").replace("NIFS-S 3 0 1.9 20", "OWN-7 1 0 1.9 20");
        let lens = read("x.zmx", model.as_bytes()).unwrap();
        assert!(write(&lens).contains("  1.9  20  10  # OWN-7\n"), "{}", write(&lens));
        there_and_back(&lens);
    }
}
