//! Writes a lens as JSON of Optiland: its Python objects, with the surfaces at their places along the axis.

use super::{
    glasses::Material,
    numbers::micrometres,
    sequence::{Sequence, SequenceRow},
};
use realistic_optics::prescription::{Aperture, Outline};
use serde_json::{Value, json};

/// Strings that stand for infinity until the text is written, and the words for them. No string of a lens has a control
/// character.
const INFINITY: [(&str, &str); 2] =
    [("\"\\u0001-Infinity\"", "-Infinity"), ("\"\\u0001Infinity\"", "Infinity")];

/// Returns the text. `notes` receives what the format cannot state.
pub fn write(sequence: &Sequence<'_>, notes: &mut Vec<String>) -> String {
    sequence.note_one_configuration(notes);
    sequence.note_no_coatings(notes);
    let primary = sequence.primary_wavelength();
    let object = geometry("Plane", -sequence.configurations[0].object_distance, f64::INFINITY);
    let mut surfaces = vec![json!({
        "type": "ObjectSurface",
        "geometry": object,
        "material_post": material(&sequence.object, primary, notes),
        "comment": "",
    })];
    let mut z = 0.0;
    for row in &sequence.rows {
        let mut own = surface(figure(row, z), material(&row.behind, primary, notes));
        own["thickness"] = json!(row.thickness);
        own["is_stop"] = json!(row.is_stop);
        own["comment"] = json!(row.behind.name().unwrap_or(""));
        let circle = json!({ "type": "RadialAperture", "r_max": row.semi_diameter, "r_min": 0.0 });
        own["aperture"] = row.shape(|shape| aperture(shape, row.semi_diameter), notes).unwrap_or(circle);
        surfaces.push(own);
        z += row.thickness;
    }
    surfaces.push(surface(geometry("Plane", z, f64::INFINITY), material(&Material::Air, primary, notes)));
    let fields = sequence.angles().into_iter();
    let fields = fields.map(|y| json!({ "x": 0.0, "y": y, "vx": 0.0, "vy": 0.0, "weight": 1.0 }));
    let wavelengths = sequence.wavelengths.iter().enumerate().map(|(i, wavelength)| {
        let is_primary = i == sequence.primary;
        json!({ "value": micrometres(*wavelength), "is_primary": is_primary, "unit": "um", "weight": 1.0 })
    });
    let lens = json!({
        "version": 1.0,
        "name": sequence.title,
        "aperture": { "type": "float_by_stop_size", "value": 2.0 * sequence.stop().semi_diameter },
        "fields": {
            "fields": fields.collect::<Value>(),
            "telecentric": false,
            "field_definition": { "field_type": "AngleField" },
        },
        "wavelengths": { "wavelengths": wavelengths.collect::<Value>(), "polarization": "ignore" },
        "apodization": null,
        "pickups": [],
        "solves": { "solves": [] },
        "surface_group": { "surfaces": surfaces },
    });
    let text = format!("{lens:#}\n");
    INFINITY.iter().fold(text, |text, (string, word)| text.replace(string, word))
}

/// Returns a number, which may be infinite.
fn number(value: f64) -> Value {
    match value {
        f64::INFINITY => json!("\u{1}Infinity"),
        f64::NEG_INFINITY => json!("\u{1}-Infinity"),
        _ => json!(value),
    }
}

fn geometry(kind: &str, z: f64, radius: f64) -> Value {
    json!({
        "type": kind,
        "cs": { "x": 0.0, "y": 0.0, "z": number(z), "rx": 0.0, "ry": 0.0, "rz": 0.0, "reference_cs": null },
        "radius": number(radius),
    })
}

fn surface(geometry: Value, material: Value) -> Value {
    json!({
        "type": "Surface",
        "thickness": 0.0,
        "geometry": geometry,
        "material_post": material,
        "is_stop": false,
        "aperture": null,
        "comment": "",
        "interaction_model": {
            "type": "RefractiveReflectiveModel", "is_reflective": false, "coating": null, "bsdf": null,
        },
    })
}

/// Returns the geometry of a row with its vertex at z.
fn figure(row: &SequenceRow<'_>, z: f64) -> Value {
    let (step, count) = row.powers();
    let kind = match (count, step) {
        (0, _) if row.radius.is_infinite() => return geometry("Plane", z, row.radius),
        (0, _) => "StandardGeometry",
        (_, 2) => "EvenAsphere",
        _ => "OddAsphere",
    };
    let mut own = geometry(kind, z, row.radius);
    own["conic"] = json!(row.conic);
    if count > 0 {
        let mut coefficients = vec![0.0; count];
        for (power, term) in &row.terms {
            coefficients[power / step - 1] = *term;
        }
        own["coefficients"] = json!(coefficients);
        own["tol"] = json!(1e-10);
        own["max_iter"] = json!(100);
    }
    own
}

/// Returns an aperture of a surface with this semi-diameter; `None` for an aperture without words.
fn aperture(shape: &Aperture, semi_diameter: f64) -> Option<Value> {
    let [x, y] = shape.center;
    let is_centered = shape.center == [0.0; 2];
    match (&shape.outline, shape.is_obstruction) {
        (Outline::Ellipse([radius, other]), true) if radius == other && is_centered => {
            Some(json!({ "type": "RadialAperture", "r_max": semi_diameter, "r_min": radius }))
        }
        (Outline::Ellipse([radius, other]), false) if radius == other => Some(json!({
            "type": "OffsetRadialAperture", "r_max": radius, "r_min": 0.0, "offset_x": x, "offset_y": y,
        })),
        (Outline::Ellipse([a, b]), false) if shape.rotation == 0.0 => {
            Some(json!({ "type": "EllipticalAperture", "a": a, "b": b, "offset_x": x, "offset_y": y }))
        }
        (Outline::Rectangle([a, b]), false) if shape.rotation == 0.0 => Some(json!({
            "type": "RectangularAperture", "x_min": x - a, "x_max": x + a, "y_min": y - b, "y_max": y + b,
        })),
        _ => None,
    }
}

fn material(material: &Material, wavelength: f64, notes: &mut Vec<String>) -> Value {
    const MODEL: &str = "HomogeneousPropagation";
    let ideal = |index: f64| json!({ "type": "IdealMaterial", "propagation_model": { "class": MODEL }, "index": index, "absorp": 0.0 });
    match material {
        Material::Air => ideal(1.0),
        Material::Named { name, catalogue, .. } => {
            let catalogue = catalogue.to_ascii_lowercase();
            json!({
                "type": "Material", "propagation_model": { "class": MODEL }, "name": name,
                "reference": catalogue, "catalog": catalogue,
            })
        }
        Material::Numbers { .. } | Material::Formula { .. } => {
            let (n_d, abbe, note) = material.two_numbers(wavelength);
            notes.extend(note.filter(|note| !notes.contains(note)));
            let by_abbe = |abbe: f64| {
                json!({
                    "type": "AbbeMaterial", "propagation_model": { "class": MODEL }, "index": n_d, "abbe": abbe,
                    "model": "buchdahl",
                })
            };
            abbe.map_or_else(|| ideal(n_d), by_abbe)
        }
    }
}
