//! First-order report of a lens: a list of facts, each in words for a reader and as JSON for a program. The terms are
//! those of M. Born and E. Wolf, *Principles of Optics*, chapter 4.

use realistic_base::message::{as_given, fixed};
use realistic_light::{Surfaces, TStop};
use realistic_optics::prescription::{Coating, Prescription};
use realistic_optics::{
    imaging::axial_beam::AxialBeam,
    lens::{Lens, first_order::FirstOrder},
};
use realistic_trace::field::{self, Field};
use serde_json::{Map, Value, json};

/// A fact about a lens.
#[derive(Debug)]
struct Fact {
    name: &'static str,
    /// The fact in words; `None` if there is nothing to report.
    text: Option<String>,
    /// An object with the parts of the fact; a part is null if it does not exist or lies at infinity.
    json: Value,
}

fn fact(name: &'static str, text: impl Into<Option<String>>, json: Value) -> Fact {
    Fact { name, text: text.into(), json }
}

/// The facts of a lens.
#[derive(Debug)]
pub struct Facts(Vec<Fact>);

/// Number of focal lengths beyond which a pupil counts as at infinity, because its distance is only rounding error.
const AT_INFINITY: f64 = 1e9;

impl Facts {
    /// Collects the facts of a lens. `film_distance` is the distance from the last vertex to the film in mm, if the
    /// film has a position, and `diagonal` is the film's diagonal in mm.
    pub fn of(prescription: &Prescription, lens: &Lens, film_distance: Option<f64>, diagonal: f64) -> Self {
        let Prescription { name, title, stated_focal_length: stated, .. } = prescription;
        let mut facts = vec![
            fact("lens", name.clone(), json!({ "name": name })),
            fact("title", title.clone(), json!({ "title": title })),
            fact(
                "wavelength",
                format!("{} nm", as_given(lens.wavelength)),
                json!({ "wavelength": lens.wavelength }),
            ),
            shape(lens),
            media(lens),
        ];
        // The section of the turned lens in y is that of the lens in x.
        let turned = (!lens.is_centred()).then(|| lens.turned());
        let in_y = Section::of(lens);
        let in_x = turned.as_ref().map(Section::of);
        let in_both = |facts_of: &dyn Fn(&Section<'_>) -> Vec<Fact>| {
            in_both_meridians(facts_of(&in_y), in_x.as_ref().map(facts_of))
        };
        facts.extend(in_both(&|Section { lens, optics, beam }| {
            first_order(*optics, *stated).into_iter().chain(pupils(lens, *optics, beam)).collect()
        }));
        facts.extend(transmission(prescription, lens, in_y.optics, &in_y.beam));
        facts.extend(in_both(&|Section { lens, optics, .. }| {
            film(lens, *optics, film_distance, diagonal).into()
        }));
        Self(facts)
    }

    /// Formats the facts as JSON, without the table.
    pub fn json(&self) -> Value {
        let parts = self.0.iter().filter_map(|fact| fact.json.as_object());
        Value::Object(parts.flatten().map(|(key, value)| (key.clone(), value.clone())).collect::<Map<_, _>>())
    }

    /// Formats the facts as text, without the table.
    pub fn text(&self) -> String {
        let lines = self.0.iter().filter_map(|fact| Some((fact.name, fact.text.as_ref()?)));
        lines.map(|(name, text)| format!("{name:<17} {text}\n")).collect()
    }
}

/// Returns in which ways the lens is not round; there is no text for a round lens.
fn shape(lens: &Lens) -> Fact {
    let mirrors = lens.surfaces.iter().filter(|surface| surface.is_mirror).count();
    let tilted = (!lens.is_centred()).then(|| "tilted, decentred or cylindrical surfaces".to_owned());
    let reflecting =
        (mirrors > 0).then(|| format!("{mirrors} mirror{}", if mirrors == 1 { "" } else { "s" }));
    let parts: Vec<_> = tilted.into_iter().chain(reflecting).collect();
    fact(
        "not round",
        (!parts.is_empty()).then(|| parts.join(", ")),
        json!({ "is_round": lens.is_round(), "mirrors": mirrors }),
    )
}

/// Returns the refractive indices in front of the lens and behind it; there is no text for a lens in air.
fn media(lens: &Lens) -> Fact {
    let indices = lens.outer_indices();
    let [scene, film] = indices.map(|index| fixed(index, 6));
    fact(
        "media",
        (indices != [1.0; 2]).then(|| format!("n = {scene} at the scene, {film} at the film")),
        json!({ "index_scene": indices[0], "index_film": indices[1] }),
    )
}

/// Returns the focal length and the cardinal points.
fn first_order(optics: Option<FirstOrder>, stated: Option<f64>) -> [Fact; 5] {
    let formatted = |format: &dyn Fn(FirstOrder) -> String| optics.map(format);
    let both =
        |front: f64, rear: f64| format!("z = {} mm (scene), {} mm (film)", fixed(front, 4), fixed(rear, 4));
    let planes = |o: FirstOrder| both(o.front_principal_plane, o.rear_principal_plane);
    let nodal_points = |o: FirstOrder| {
        let [front, rear] = o.nodal_points();
        let is_one =
            if o.n_scene == o.n_film { ", the principal points, as one medium is on both sides" } else { "" };
        both(front, rear) + is_one
    };
    let in_file = stated.map_or_else(String::new, |f| format!(" (the file states {} mm)", as_given(f)));
    let focal_length = formatted(&|o| format!("{} mm{in_file}", fixed(o.focal_length, 4)));
    let afocal = || "none: the lens is afocal, parallel rays leave it parallel".to_owned();
    [
        fact(
            "focal length",
            focal_length.unwrap_or_else(afocal),
            json!({
                "focal_length_mm": optics.map(|o| o.focal_length),
                "stated_focal_length_mm": stated,
            }),
        ),
        fact(
            "back focal dist.",
            formatted(&|o| format!("{} mm", fixed(o.back_focal_distance(), 4))),
            json!({ "back_focal_distance_mm": optics.map(|o| o.back_focal_distance()) }),
        ),
        fact(
            "focal points",
            formatted(&|o| both(o.front_focal_point, o.rear_focal_point)),
            json!({
                "front_focal_point_z_mm": optics.map(|o| o.front_focal_point),
                "rear_focal_point_z_mm": optics.map(|o| o.rear_focal_point),
            }),
        ),
        fact(
            "principal planes",
            formatted(&planes),
            json!({
                "front_principal_plane_z_mm": optics.map(|o| o.front_principal_plane),
                "rear_principal_plane_z_mm": optics.map(|o| o.rear_principal_plane),
            }),
        ),
        fact(
            "nodal points",
            formatted(&nodal_points),
            json!({
                "front_nodal_point_z_mm": optics.map(|o| o.nodal_points()[0]),
                "rear_nodal_point_z_mm": optics.map(|o| o.nodal_points()[1]),
            }),
        ),
    ]
}

/// A lens in the meridian y, with its first-order optics, unless it is afocal, and its axial beam.
struct Section<'a> {
    lens: &'a Lens,
    optics: Option<FirstOrder>,
    beam: AxialBeam,
}

impl<'a> Section<'a> {
    fn of(lens: &'a Lens) -> Self {
        Self { lens, optics: FirstOrder::of(lens).ok(), beam: AxialBeam::of(lens) }
    }
}

/// Returns facts of the meridian y, each with that of x behind it where the lens has another one there.
fn in_both_meridians(in_y: Vec<Fact>, in_x: Option<Vec<Fact>>) -> Vec<Fact> {
    let Some(in_x) = in_x else { return in_y };
    let pairs = in_y.into_iter().zip(in_x);
    let with_x = pairs.map(|(y, x)| {
        let text = x.text.filter(|text| y.text.as_ref() != Some(text));
        let x = (y.json != x.json).then(|| fact("  in x", text, key_in_x(&x.json)));
        [Some(y), x]
    });
    with_x.flatten().flatten().collect()
}

/// Returns the JSON of a fact with `_x` in its keys, before their units.
fn key_in_x(json: &Value) -> Value {
    let of =
        |key: &String| match ["_mm", "_deg"].iter().find_map(|unit| Some((key.strip_suffix(unit)?, unit))) {
            Some((stem, unit)) => format!("{stem}_x{unit}"),
            None => format!("{key}_x"),
        };
    Value::Object(
        json.as_object().into_iter().flatten().map(|(key, value)| (of(key), value.clone())).collect(),
    )
}

/// Returns the pupils, the f-number (the absolute focal length over the diameter of the axial beam) and the surface
/// that limits the axial beam.
fn pupils(lens: &Lens, optics: Option<FirstOrder>, beam: &AxialBeam) -> [Fact; 4] {
    let AxialBeam { limiting, entrance, exit, .. } = *beam;
    let size = optics.map_or(lens.front().semi_diameter, |optics| optics.focal_length.abs());
    // Position and diameter. Adding 0 turns the -0 of a pupil in the front vertex into 0.
    let pupil = |z: Option<f64>, diameter: f64| {
        z.filter(|z| z.abs() < AT_INFINITY * size).map(|z| (z + 0.0, diameter))
    };
    let formatted = |pupil: Option<(f64, f64)>| {
        pupil.map_or("at infinity".to_owned(), |(z, d)| {
            format!("z = {} mm, diameter {} mm", fixed(z, 4), fixed(d, 4))
        })
    };
    let entrance = pupil(entrance.position(), entrance.diameter());
    let exit = pupil(exit.position(), exit.diameter());
    let of_optics = |number: fn(&AxialBeam, f64) -> f64| {
        optics.map(|optics| number(beam, optics.focal_length)).filter(|number| number.is_finite())
    };
    let (f_number, by_paraxial_rays) =
        (of_optics(AxialBeam::fnumber), of_optics(AxialBeam::paraxial_fnumber));
    let f_number_text = f_number.map_or_else(
        || if beam.is_dark() { "none: no ray parallel to the axis gets through" } else { "none" }.to_owned(),
        |number| {
            let printed = fixed(number, 4);
            match by_paraxial_rays.map(|number| fixed(number, 4)).filter(|other| *other != printed) {
                Some(other) => format!("{printed} (paraxial: {other})"),
                None => printed,
            }
        },
    );
    let (limiting, stop) = (limiting + 1, lens.stop_index().map(|index| index + 1));
    let stop_text = match stop {
        None => format!("no stop row; row {limiting} limits the axial beam"),
        Some(stop) if stop == limiting => format!("row {stop}"),
        Some(stop) => {
            format!("row {stop}, but row {limiting} limits the axial beam: the pupils are its images")
        }
    };
    [
        fact(
            "entrance pupil",
            formatted(entrance),
            json!({
                "entrance_pupil_z_mm": entrance.map(|p| p.0),
                "entrance_pupil_diameter_mm": entrance.map(|p| p.1),
            }),
        ),
        fact(
            "exit pupil",
            formatted(exit),
            json!({
                "exit_pupil_z_mm": exit.map(|p| p.0),
                "exit_pupil_diameter_mm": exit.map(|p| p.1),
            }),
        ),
        fact("f-number", f_number_text, json!({ "fnumber": f_number, "fnumber_paraxial": by_paraxial_rays })),
        fact("stop", stop_text, json!({ "stop_row": stop, "limiting_row": limiting })),
    ]
}

/// Returns the T-numbers for the named coatings, and for the coatings of the lens file if it names any.
fn transmission(
    prescription: &Prescription,
    lens: &Lens,
    optics: Option<FirstOrder>,
    beam: &AxialBeam,
) -> Option<Fact> {
    let focal_length = optics?.focal_length;
    let of_all = |coating: Coating| Surfaces::new(lens, coating);
    let mut stops = vec![
        ("bare", "bare", of_all(Coating::Bare)),
        ("with a quarter wave of MgF2", "quarter_wave", of_all(Coating::QuarterWave)),
    ];
    if let Some(own) = &prescription.coatings {
        stops.push(("with the coatings of its file", "file", Surfaces::of_each(lens, own)));
    }
    let (mut texts, mut json) = (Vec::new(), Map::new());
    for (words, key, surfaces) in stops {
        let stop = TStop::of(lens, &surfaces, beam, focal_length)?;
        let left = fixed(100.0 * stop.transmission, 1);
        texts.push(format!("{} {words} (transmits {left} %)", fixed(stop.number, 4)));
        json.insert(format!("tnumber_{key}"), json!(stop.number.is_finite().then_some(stop.number)));
        json.insert(format!("transmission_{key}"), json!(stop.transmission));
    }
    Some(fact("T-number", texts.join(", "), Value::Object(json)))
}

/// Returns the film's position, and the field of view on a film with this `diagonal` in mm.
fn film(lens: &Lens, optics: Option<FirstOrder>, film_distance: Option<f64>, diagonal: f64) -> [Fact; 2] {
    let paraxial =
        film_distance.and(optics).map(|optics| field::paraxial(optics.front_focal_length(), diagonal));
    let field = film_distance.map(|distance| Field::new(lens, lens.rear().vertex - distance));
    let real = field.as_ref().and_then(|field| field.real(diagonal));
    let lit = field.as_ref().and_then(|field| field.lit_radius(diagonal / 2.0));
    let degrees =
        |angle: Option<f64>| angle.map_or("none".to_owned(), |a| format!("{:.3} degrees", a.to_degrees()));
    let corner = match (real, lit) {
        (Some(_), _) => format!("{} by the corner's chief ray", degrees(real)),
        (None, Some(radius)) => {
            format!("the corner is dark: film gets light up to {} mm from the axis", fixed(radius, 3))
        }
        (None, None) => "the film is dark".to_owned(),
    };
    let nowhere = || "has no place: the lens makes no real image of a distant object".to_owned();
    let position = film_distance.map(|distance| format!("{} mm behind the last vertex", fixed(distance, 4)));
    let view = || {
        let paraxial = degrees(paraxial);
        format!("on a diagonal of {} mm: {paraxial} paraxial (2 atan d/2f); {corner}", as_given(diagonal))
    };
    [
        fact(
            "film",
            position.unwrap_or_else(nowhere),
            json!({
                "film_distance": film_distance,
                "film_diagonal": film_distance.map(|_| diagonal),
            }),
        ),
        fact(
            "field of view",
            film_distance.map(|_| view()),
            json!({
                "field_of_view_paraxial_deg": paraxial.map(f64::to_degrees),
                "field_of_view_deg": real.map(f64::to_degrees),
                "lit_film_radius_mm": lit,
            }),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::read;

    fn facts(table: &str, film: Option<f64>) -> Facts {
        let prescription = read("test", table.as_bytes()).unwrap();
        Facts::of(&prescription, &Lens::at_d_line(&prescription), film, 35.0)
    }

    #[test]
    fn a_pupil_at_infinity_is_stated_in_words_and_null_in_json() {
        // A lens with a stop in its front focal plane: 1/f = 0.5 (1/20 + 1/20 - 0.5 · 3/(1.5 · 400)), and the focal
        // point lies 0.95 f in front of the vertex.
        let focal_length = 1.0 / 0.04875;
        let stop = 0.95 * focal_length;
        let facts = facts(&format!("0 {stop} 0 4\n20 3 1.5 10\n-20 0 1 10\n"), Some(20.0));
        assert!(facts.text().contains("exit pupil        at infinity"));
        let json = facts.json();
        assert_eq!(json["stop_row"], 1);
        assert_eq!((&json["exit_pupil_z_mm"], &json["exit_pupil_diameter_mm"]), (&Value::Null, &Value::Null));
        assert!((json["focal_length_mm"].as_f64().unwrap() - focal_length).abs() < 1e-12);
        assert!((json["fnumber"].as_f64().unwrap() - focal_length / 4.0).abs() < 1e-12);
        assert!(facts.text().lines().any(|line| line.starts_with("f-number") && !line.contains("paraxial")));
    }

    #[test]
    fn media_are_stated_and_nodal_points_differ_from_principal_points() {
        // An eye of one surface of radius 6: both nodal points are its centre.
        let eye = facts("6 0 1.336 8\n", None);
        assert!(eye.text().contains("media             n = 1.000000 at the scene, 1.336000 at the film\n"));
        assert!(
            eye.text().contains("nodal points      z = -6.0000 mm (scene), -6.0000 mm (film)\n"),
            "{}",
            eye.text()
        );
        let json = eye.json();
        assert_eq!([&json["index_scene"], &json["index_film"]], [1.0, 1.336]);
        assert!((json["rear_nodal_point_z_mm"].as_f64().unwrap() + 6.0).abs() < 1e-12);
        let single = facts("20 3 1.5 6\n-20 0 1 10\n", None);
        assert!(single.text().contains("(film), the principal points"));
        assert!(!single.text().contains("media"));
    }

    #[test]
    fn the_paraxial_f_number_is_printed_where_it_differs() {
        let planar = realistic_optics::prescription::catalogue::find("planar.50mm").expect("listed");
        let facts = Facts::of(&planar, &Lens::at_d_line(&planar), Some(35.5), 35.0);
        assert!(facts.text().contains("f-number          1.4000 (paraxial: 1.5096)\n"), "{}", facts.text());
        let json = facts.json();
        assert!((json["fnumber"].as_f64().unwrap() - 1.4).abs() < 1e-4);
        assert!((json["fnumber_paraxial"].as_f64().unwrap() - 1.5096).abs() < 1e-4);
    }

    #[test]
    fn the_row_that_limits_is_named_when_it_is_not_the_stop() {
        let other = facts("20 3 1.5 6\n-20 1 1 10\n0 0 0 20\n", Some(20.0));
        assert!(other.text().contains("row 3, but row 1 limits"));
        let none = facts("20 3 1.5 6\n-20 0 1 10\n", Some(20.0));
        assert!(none.text().contains("no stop row; row 1 limits"));
    }

    #[test]
    fn an_afocal_lens_is_reported_without_a_focal_length() {
        let facts = facts("0 3 1.5 10\n0 0 1 10\n", None);
        assert!(facts.text().contains("afocal"));
        assert_eq!(facts.json()["focal_length_mm"], Value::Null);
    }
}
