//! What first-order optics says of a lens, in words and as JSON.

use realistic::prescription::Prescription;
use realistic::{
    imaging::field::{self, Field},
    lens::{
        Lens,
        first_order::FirstOrder,
        pupil::{EntrancePupil, ExitPupil, limiting_surface},
    },
};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A pupil: place and size; a pupil at infinity has neither.
#[derive(Clone, Copy, Debug)]
pub struct Pupil {
    /// z in lens space, mm.
    pub z: f64,
    /// mm.
    pub diameter: f64,
}

/// The facts.
#[derive(Debug)]
pub struct Facts {
    /// `None` for an afocal lens.
    pub first_order: Option<FirstOrder>,
    /// Row of the stop, from 1 at the scene side.
    pub stop_row: Option<usize>,
    /// Row that limits the axial beam of a distant object.
    pub limiting_row: usize,
    /// Image of the limiting row seen from the scene; `None` at infinity.
    pub entrance: Option<Pupil>,
    /// Image of the limiting row seen from the film; `None` at infinity.
    pub exit: Option<Pupil>,
    /// Focal length, without its sign, over entrance pupil diameter.
    pub f_number: Option<f64>,
    film: Option<FilmFacts>,
    wavelength: f64,
}

#[derive(Debug)]
struct FilmFacts {
    distance: f64,
    diagonal: f64,
    paraxial_field: Option<f64>,
    real_field: Option<f64>,
    lit_radius: Option<f64>,
}

/// A pupil farther away than this many focal lengths is one at infinity with rounding errors.
const AT_INFINITY: f64 = 1e9;

impl Facts {
    /// The facts of a lens with film `film_distance` mm behind the last vertex, if it has a place.
    pub fn of(lens: &Lens, film_distance: Option<f64>, diagonal: f64) -> Self {
        let first_order = FirstOrder::of(lens).ok();
        let limiting = limiting_surface(lens);
        let entrance = EntrancePupil::of_surface(lens, limiting);
        let exit = ExitPupil::of_surface(lens, limiting);
        let size = first_order.map_or(lens.front().semi_diameter, |optics| optics.focal_length.abs());
        // 0 is added for its sign: a pupil in the front vertex is not at -0 mm.
        let pupil = |z: Option<f64>, diameter: f64| {
            z.filter(|z| z.abs() < AT_INFINITY * size).map(|z| Pupil { z: z + 0.0, diameter })
        };
        let entrance = pupil(entrance.position(), entrance.diameter());
        let film = film_distance.map(|distance| {
            let field = Field::new(lens, lens.rear().vertex - distance);
            FilmFacts {
                distance,
                diagonal,
                paraxial_field: first_order.map(|optics| field::paraxial(optics.focal_length, diagonal)),
                real_field: field.real(diagonal),
                lit_radius: field.lit_radius(diagonal / 2.0),
            }
        });
        Self {
            f_number: first_order
                .zip(entrance)
                .map(|(optics, pupil)| optics.focal_length.abs() / pupil.diameter),
            first_order,
            stop_row: lens.stop_index().map(|index| index + 1),
            limiting_row: limiting + 1,
            entrance,
            exit: pupil(exit.position(), exit.diameter()),
            film,
            wavelength: lens.wavelength,
        }
    }

    /// As JSON, without the table.
    pub fn json(&self, prescription: &Prescription) -> Value {
        let optics = self.first_order;
        let film = self.film.as_ref();
        json!({
            "name": prescription.name,
            "title": prescription.title,
            "wavelength_nm": self.wavelength,
            "stated_focal_length_mm": prescription.stated_focal_length,
            "focal_length_mm": optics.map(|o| o.focal_length),
            "back_focal_distance_mm": optics.map(|o| o.back_focal_distance()),
            "front_focal_point_z_mm": optics.map(|o| o.front_focal_point),
            "rear_focal_point_z_mm": optics.map(|o| o.rear_focal_point),
            "front_principal_plane_z_mm": optics.map(|o| o.front_principal_plane),
            "rear_principal_plane_z_mm": optics.map(|o| o.rear_principal_plane),
            "front_nodal_point_z_mm": optics.map(|o| o.front_principal_plane),
            "rear_nodal_point_z_mm": optics.map(|o| o.rear_principal_plane),
            "entrance_pupil_z_mm": self.entrance.map(|p| p.z),
            "entrance_pupil_diameter_mm": self.entrance.map(|p| p.diameter),
            "exit_pupil_z_mm": self.exit.map(|p| p.z),
            "exit_pupil_diameter_mm": self.exit.map(|p| p.diameter),
            "f_number": self.f_number,
            "stop_row": self.stop_row,
            "limiting_row": self.limiting_row,
            "film_distance_mm": film.map(|f| f.distance),
            "film_diagonal_mm": film.map(|f| f.diagonal),
            "field_of_view_paraxial_deg": film.and_then(|f| f.paraxial_field).map(f64::to_degrees),
            "field_of_view_deg": film.and_then(|f| f.real_field).map(f64::to_degrees),
            "lit_film_radius_mm": film.and_then(|f| f.lit_radius),
        })
    }

    /// In words, without the table.
    pub fn text(&self, prescription: &Prescription) -> String {
        let mut text = format!("lens              {}\n", prescription.name);
        let mut line = |name: &str, value: &str| {
            let _ = writeln!(text, "{name:<17} {value}");
        };
        if let Some(title) = &prescription.title {
            line("title", title);
        }
        line("wavelength", &format!("{} nm", self.wavelength));
        match self.first_order {
            None => line("focal length", "none: the lens is afocal, parallel rays leave it parallel"),
            Some(optics) => {
                let stated = prescription.stated_focal_length;
                let stated = stated.map_or_else(String::new, |f| format!(" (the file states {f} mm)"));
                line("focal length", &format!("{:.4} mm{stated}", optics.focal_length));
                line("back focal dist.", &format!("{:.4} mm", optics.back_focal_distance()));
                let both = |front: f64, rear: f64| format!("z = {front:.4} mm (scene), {rear:.4} mm (film)");
                line("focal points", &both(optics.front_focal_point, optics.rear_focal_point));
                let planes = both(optics.front_principal_plane, optics.rear_principal_plane);
                line("principal planes", &planes);
                line("nodal points", &format!("{planes}, air being on both sides"));
            }
        }
        let pupil = |pupil: Option<Pupil>| {
            pupil.map_or_else(
                || "at infinity".to_owned(),
                |p| format!("z = {:.4} mm, diameter {:.4} mm", p.z, p.diameter),
            )
        };
        line("entrance pupil", &pupil(self.entrance));
        line("exit pupil", &pupil(self.exit));
        let fnumber = self.f_number.map_or_else(|| "none".to_owned(), |number| format!("{number:.4}"));
        line("f-number", &fnumber);
        line("stop", &self.stop());
        match &self.film {
            Some(film) => {
                line("film", &format!("{:.4} mm behind the last vertex", film.distance));
                line("field of view", &film.field());
            }
            None => line("film", "has no place: the lens makes no real image of a distant object"),
        }
        text
    }

    fn stop(&self) -> String {
        let limiting = self.limiting_row;
        match self.stop_row {
            None => format!("no stop row; row {limiting} limits the axial beam"),
            Some(stop) if stop == limiting => format!("row {stop}"),
            Some(stop) => {
                format!("row {stop}, but row {limiting} limits the axial beam: pupils and f-number are its")
            }
        }
    }
}

impl FilmFacts {
    fn field(&self) -> String {
        let degrees = |angle: Option<f64>| {
            angle.map_or_else(|| "none".to_owned(), |angle| format!("{:.3} degrees", angle.to_degrees()))
        };
        let corner = match (self.real_field, self.lit_radius) {
            (Some(_), _) => format!("{} by the corner's chief ray", degrees(self.real_field)),
            (None, Some(radius)) => {
                format!("the corner is dark: film gets light up to {radius:.3} mm from the axis")
            }
            (None, None) => "the film is dark".to_owned(),
        };
        format!(
            "on a diagonal of {} mm: {} paraxial (2 atan d/2f); {corner}",
            self.diagonal,
            degrees(self.paraxial_field)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic::prescription::read;

    fn facts(table: &str, film: Option<f64>) -> (Prescription, Facts) {
        let prescription = read("test", table.as_bytes()).unwrap();
        let lens = Lens::at_d_line(&prescription);
        let facts = Facts::of(&lens, film, 35.0);
        (prescription, facts)
    }

    #[test]
    fn a_pupil_at_infinity_is_said_in_words_and_null_in_json() {
        // A thin lens with a stop in its front focal plane: f = 1/(0.5 (1/20 + 1/20)) = 20.
        let (prescription, facts) = facts("0 20 0 4\n20 0 1.5 20\n-20 0 1 20\n", Some(20.0));
        assert_eq!(facts.stop_row, Some(1));
        assert!(facts.text(&prescription).contains("exit pupil        at infinity"));
        let json = facts.json(&prescription);
        assert_eq!((&json["exit_pupil_z_mm"], &json["exit_pupil_diameter_mm"]), (&Value::Null, &Value::Null));
        assert!((json["focal_length_mm"].as_f64().unwrap() - 20.0).abs() < 1e-12);
        assert!((json["f_number"].as_f64().unwrap() - 5.0).abs() < 1e-12);
    }

    #[test]
    fn the_row_that_limits_is_named_when_it_is_not_the_stop() {
        let (prescription, other) = facts("20 3 1.5 6\n-20 1 1 10\n0 0 0 20\n", Some(20.0));
        assert!(other.text(&prescription).contains("row 3, but row 1 limits"));
        let (prescription, none) = facts("20 3 1.5 6\n-20 0 1 10\n", Some(20.0));
        assert!(none.text(&prescription).contains("no stop row; row 1 limits"));
    }

    #[test]
    fn an_afocal_lens_is_reported_without_a_focal_length() {
        let (prescription, facts) = facts("0 3 1.5 10\n0 0 1 10\n", None);
        assert!(facts.text(&prescription).contains("afocal"));
        assert_eq!(facts.json(&prescription)["focal_length_mm"], Value::Null);
    }
}
