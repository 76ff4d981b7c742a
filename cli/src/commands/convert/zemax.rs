//! Writes a lens as sequential Zemax text (.zmx). `docs/lens-format.md` describes the statements; sizes are
//! *semi*-diameters and curvatures stand in place of radii.

use super::{
    glasses::Material,
    numbers::{curvature, micrometres, number, numbers},
    sequence::{Sequence, SequenceRow},
};
use realistic_optics::prescription::{Aperture, Coating, GlassLibrary, Outline, SurfaceCoating};
use std::fmt::Write as _;

/// The beginnings of lines that hold notes.
pub const NOTES: [&str; 2] = ["NOTE ", "  COMM "];

/// Number of terms that `PARM` lines hold; surfaces with more terms have `XDAT` lines.
const MOST_PARAMETERS: usize = 8;

/// Returns the text. `notes` has the notes about the sequence, and receives what the format cannot state.
pub fn write(sequence: &Sequence<'_>, notes: &mut Vec<String>) -> String {
    let catalogues = catalogues(sequence);
    let primary = sequence.primary_wavelength();
    let mut surfaces = String::new();
    begin_surface(&mut surfaces, 0);
    surfaces += "  TYPE STANDARD\n  CURV 0\n";
    let object = sequence.configurations[0].object_distance;
    let object = if object.is_finite() { number(object) } else { "INFINITY".to_owned() };
    let _ = writeln!(surfaces, "  DISZ {object}");
    write_glass(&mut surfaces, &sequence.object, &catalogues, primary, notes);
    for row in &sequence.rows {
        write_row(&mut surfaces, row, &catalogues, primary, notes);
    }
    begin_surface(&mut surfaces, sequence.rows.len() + 1);
    surfaces += "  TYPE STANDARD\n  CURV 0\n  DISZ 0\n";
    write_configurations(&mut surfaces, sequence);

    let mut text = "VERS 140124 0 0\nMODE SEQ\n".to_owned();
    if let Some(title) = sequence.title {
        let _ = writeln!(text, "NAME {title}");
    }
    for note in notes.iter() {
        let _ = writeln!(text, "NOTE 0 {}", note.replace(['\n', '\r'], " "));
    }
    text += "UNIT MM X W X CM MR CPMM\nFLOA\n";
    if !catalogues.is_empty() {
        let _ = writeln!(text, "GCAT {}", catalogues.join(" "));
    }
    let angles = sequence.angles();
    let (fields, colours) = (angles.len(), sequence.wavelengths.len());
    let _ = writeln!(text, "FTYP 0 0 {fields} {colours} 0 0 0");
    let _ = writeln!(text, "XFLN {}", numbers(angles.iter().map(|_| 0.0)));
    let _ = writeln!(text, "YFLN {}", numbers(angles.iter().copied()));
    let _ = writeln!(text, "FWGN {}", numbers(angles.iter().map(|_| 1.0)));
    for (i, wavelength) in (1..).zip(&sequence.wavelengths) {
        let _ = writeln!(text, "WAVM {i} {} 1", number(micrometres(*wavelength)));
    }
    let _ = writeln!(text, "PWAV {}", sequence.primary + 1);
    text + &surfaces
}

fn begin_surface(text: &mut String, surface: usize) {
    let _ = writeln!(text, "SURF {surface}");
}

/// Returns the catalogues of the named glasses, in the order of the lens.
fn catalogues(sequence: &Sequence<'_>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    let behind = sequence.rows.iter().map(|row| &row.behind);
    for material in std::iter::once(&sequence.object).chain(behind) {
        if let Material::Named { catalogue, .. } = material
            && !all.contains(catalogue)
        {
            all.push(catalogue.clone());
        }
    }
    all
}

/// Writes a glass by its name or, if another of the file's catalogues has one of that name first, by its numbers.
fn write_glass(
    text: &mut String,
    material: &Material,
    catalogues: &[String],
    wavelength: f64,
    notes: &mut Vec<String>,
) {
    let is_first = |name: &str| {
        let library = GlassLibrary::default();
        let first = library.candidates(name, catalogues).next().and_then(|found| found.glass.ok());
        first.is_some_and(|glass| glass.medium == material.medium())
    };
    match material {
        Material::Air => {}
        Material::Named { name, .. } if is_first(name) => {
            let _ = writeln!(text, "  GLAS {name} 0 0");
        }
        _ => {
            let (n_d, abbe, note) = material.two_numbers(wavelength);
            if let Some(name) = material.name() {
                let _ = writeln!(text, "  COMM {name}");
            }
            let _ = writeln!(
                text,
                "  GLAS ___BLANK 1 0 {} {} 0 0 0 0 0 0",
                number(n_d),
                number(abbe.unwrap_or(0.0))
            );
            notes.extend(note.filter(|note| !notes.contains(note)));
        }
    }
}

fn write_row(
    text: &mut String,
    row: &SequenceRow<'_>,
    catalogues: &[String],
    wavelength: f64,
    notes: &mut Vec<String>,
) {
    begin_surface(text, row.number);
    if row.is_stop {
        *text += "  STOP\n";
    }
    write_figure(text, row);
    write_coating(text, row, wavelength, notes);
    let _ = writeln!(text, "  DISZ {}", number(row.thickness));
    write_glass(text, &row.behind, catalogues, wavelength, notes);
    let _ = writeln!(text, "  DIAM {} 1 0 0 1", number(row.semi_diameter));
    match row.shape(|shape| aperture(shape, row.semi_diameter), notes) {
        Some(lines) => *text += &lines,
        // The size of the stop is an aperture in itself.
        None if row.is_stop => {}
        None => {
            let _ = writeln!(text, "  FLAP 0 {} 0", number(row.semi_diameter));
        }
    }
}

fn write_figure(text: &mut String, row: &SequenceRow<'_>) {
    let (step, count) = row.powers();
    let is_extended = count > MOST_PARAMETERS;
    let kind = match (count, step, is_extended) {
        (0, ..) => "STANDARD",
        (_, 2, false) => "EVENASPH",
        (_, 2, true) => "XASPHERE",
        (.., false) => "ODDASPHE",
        (.., true) => "XOSPHERE",
    };
    let _ = writeln!(text, "  TYPE {kind}");
    let _ = writeln!(text, "  CURV {} 0 0 0 0", number(curvature(row.radius)));
    if row.conic != 0.0 {
        let _ = writeln!(text, "  CONI {}", number(row.conic));
    }
    if is_extended {
        // The number of terms and the radius by which r is divided.
        let _ = writeln!(text, "  XDAT 1 {count} 0 0\n  XDAT 2 1 0 0");
    }
    for (power, term) in &row.terms {
        let index = power / step;
        let _ = match is_extended {
            true => writeln!(text, "  XDAT {} {} 0 0", index + 2, number(*term)),
            false => writeln!(text, "  PARM {index} {}", number(*term)),
        };
    }
}

/// Returns the lines of an aperture of a surface with this semi-diameter; `None` for an aperture without words.
fn aperture(shape: &Aperture, semi_diameter: f64) -> Option<String> {
    let [x, y] = shape.center;
    let is_centered = shape.center == [0.0; 2];
    let vertices = |vertices: &[[f64; 2]]| {
        let vertices: Vec<[f64; 2]> = shape.placed(vertices).collect();
        // A vertex on the axis would end the polygon.
        let is_open = vertices.iter().all(|vertex| *vertex != [0.0; 2]);
        is_open.then(|| {
            let lines = (1..).zip(vertices.into_iter().chain([[0.0; 2]]));
            let line = |(i, vertex): (usize, [f64; 2])| format!("  UDAD {i} {} 0\n", numbers(vertex));
            "  USAP 0 0 0\n".to_owned() + &lines.map(line).collect::<String>()
        })
    };
    let own = match (&shape.outline, shape.is_obstruction) {
        (Outline::Ellipse([radius, other]), true) if radius == other && is_centered => {
            format!("  CLAP {} 0\n", numbers([*radius, semi_diameter]))
        }
        (Outline::Ellipse([radius, other]), true) if radius == other => {
            format!("  OBSC 0 {} 0\n", number(*radius))
        }
        (Outline::Ellipse([radius, other]), false) if radius == other => {
            format!("  CLAP 0 {} 0\n", number(*radius))
        }
        (Outline::Rectangle(half), false) if shape.rotation == 0.0 => {
            format!("  SQAP {} 0\n", numbers(*half))
        }
        (Outline::Rectangle([x, y]), false) => {
            return vertices(&[[*x, *y], [-x, *y], [-x, -y], [*x, -y]]);
        }
        (Outline::Polygon(own), false) => return vertices(own),
        _ => return None,
    };
    Some(if is_centered { own } else { own + &format!("  OBDC {}\n", numbers([x, y])) })
}

/// Writes a coating that a file of the format can name: one of its program's sample file, in waves of the primary
/// wavelength.
fn write_coating(text: &mut String, row: &SequenceRow<'_>, primary: f64, notes: &mut Vec<String>) {
    let Some(coating) = row.coating.filter(|coating| !coating.is_bare()) else { return };
    let name = match coating {
        SurfaceCoating::Named { coating: Coating::QuarterWave, wavelength } if *wavelength == primary => "AR",
        SurfaceCoating::Named { coating: Coating::ThreeLayer, wavelength } if *wavelength == primary => {
            "HEAR1"
        }
        _ => {
            notes.push(format!("the coating of surface {} is left out", row.number));
            return;
        }
    };
    let _ = writeln!(text, "  COAT {name}");
}

/// Writes the operands that differ between the configurations.
fn write_configurations(text: &mut String, sequence: &Sequence<'_>) {
    let all = &sequence.configurations;
    if all.len() < 2 {
        return;
    }
    let _ = writeln!(text, "MNUM {} 1", all.len());
    let mut operand = |key: &str, surface: usize, value: &dyn Fn(usize) -> f64| {
        if (1..all.len()).all(|i| value(i) == value(0)) {
            return;
        }
        for i in 0..all.len() {
            // The object at infinity is farther than any other object.
            let value = if value(i).is_finite() { number(value(i)) } else { "1e10".to_owned() };
            let _ = writeln!(text, "{key} {surface} {} {value}", i + 1);
        }
    };
    operand("THIC", 0, &|i| all[i].object_distance);
    for (gap, (surface, _)) in all[0].gaps.iter().enumerate() {
        operand("THIC", *surface, &|i| all[i].gaps[gap].1);
    }
    operand("SDIA", sequence.stop().number, &|i| all[i].stop);
}
