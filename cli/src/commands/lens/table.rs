//! The table of the prescription, with one row per interface.

use realistic_base::message::fixed;
use realistic_optics::lens::Lens;
use realistic_optics::prescription::{Medium, Prescription, Shape, Unsymmetric};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Returns the values of each row; radius, thickness, V-number and sag may be absent.
fn rows<'a>(prescription: &'a Prescription, lens: &'a Lens) -> impl Iterator<Item = Row> + 'a {
    let last = prescription.interfaces.len() - 1;
    prescription.interfaces.iter().zip(&lens.surfaces).enumerate().map(
        move |(index, (interface, surface))| {
            let (kind, radius) = match interface.shape {
                Shape::Sphere { radius } => ("sphere", Some(radius)),
                Shape::Asphere(asphere) => ("asphere", Some(asphere.radius)),
                Shape::Unsymmetric(Unsymmetric::Toroid(toroid)) => {
                    let is_cylinder = toroid.rotation_radius.is_infinite();
                    (if is_cylinder { "cylinder" } else { "toroid" }, Some(toroid.radius))
                }
                Shape::Unsymmetric(Unsymmetric::Biconic(biconic)) => ("biconic", Some(biconic.radii[1])),
                Shape::Plane if interface.is_mirror => ("mirror", None),
                Shape::Plane if interface.is_stop => ("stop", None),
                Shape::Plane => ("plane", None),
            };
            Row {
                kind,
                radius,
                // The distance to the film counts as a thickness of the lens only if the file states it.
                thickness: if index < last { Some(interface.thickness) } else { lens.nominal_film_distance },
                n: surface.n_film,
                abbe: match interface.medium {
                    Medium::Glass { abbe, .. } => abbe,
                    Medium::Air | Medium::Sellmeier { .. } | Medium::Formula(_) => None,
                },
                diameter: 2.0 * surface.semi_diameter,
                // Adding 0 turns the -0 of a plane into 0.
                sag: surface.sagitta(surface.semi_diameter) + 0.0,
            }
        },
    )
}

struct Row {
    kind: &'static str,
    radius: Option<f64>,
    thickness: Option<f64>,
    n: f64,
    abbe: Option<f64>,
    diameter: f64,
    sag: f64,
}

/// Formats the table as JSON.
pub fn json(prescription: &Prescription, lens: &Lens) -> Value {
    rows(prescription, lens)
        .map(|row| {
            json!({
                "kind": row.kind,
                "radius_mm": row.radius,
                "thickness_mm": row.thickness,
                "index": row.n,
                "v_number": row.abbe,
                "diameter_mm": row.diameter,
                "sag_mm": row.sag,
            })
        })
        .collect()
}

/// Formats the table as text. Lengths are in mm; n is the index behind the interface, at the lens's wavelength.
pub fn text(prescription: &Prescription, lens: &Lens) -> String {
    let mut text = format!(
        "{:>3} {:>12} {:>10} {:>9} {:>6} {:>10} {:>9}\n",
        "row", "radius mm", "thickness", "n behind", "V", "diameter", "sag"
    );
    let or_dash = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |value| fixed(value, digits))
    };
    for (index, row) in rows(prescription, lens).enumerate() {
        let radius = row.radius.map_or_else(|| row.kind.to_owned(), |radius| fixed(radius, 4));
        let _ = writeln!(
            text,
            "{:>3} {radius:>12} {:>10} {:>9.6} {:>6} {:>10} {:>9}",
            index + 1,
            or_dash(row.thickness, 4),
            row.n,
            or_dash(row.abbe, 2),
            fixed(row.diameter, 4),
            fixed(row.sag, 4),
        );
    }
    text + "sag: the edge of the clear aperture lies so many mm on the scene's side of the vertex\n"
}
