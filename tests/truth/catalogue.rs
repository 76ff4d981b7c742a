//! The lenses of the catalogue against the statements of their patents, and the lenses with moving groups at every
//! position: focal length, back focus, f-number by real rays, and field of view by real chief rays.

use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    prescription::{Prescription, catalogue},
    trace::{Path, Ray},
};
use realistic_trace::field::Field;

/// A lens at one of its positions, or without positions.
struct LensPosition {
    name: String,
    lens: Lens,
    focal_length: Option<f64>,
    fnumber: Option<f64>,
    /// Full field, degrees.
    field: Option<f64>,
    /// Distance from the last vertex to the film, mm.
    film: Option<f64>,
    /// Distance from the object to the first vertex, mm.
    object: Option<f64>,
}

fn cases(name: &str) -> Vec<LensPosition> {
    let lens = catalogue::find(name).expect("listed");
    let field = |i: usize| lens.stated.fields.get(i).copied().flatten();
    let Some(positions) = &lens.positions else {
        return vec![LensPosition {
            name: name.to_owned(),
            focal_length: lens.stated_focal_length,
            fnumber: lens.stated.fnumber,
            field: field(0),
            film: lens.nominal_film_distance,
            object: None,
            lens: Lens::at_d_line(&lens),
        }];
    };
    let case = |(i, column): (usize, &realistic_optics::prescription::Position)| {
        let mut at: Prescription = lens.clone();
        for (&row, &gap) in positions.gaps.iter().zip(&column.gaps) {
            match row + 1 == at.interfaces.len() {
                true => at.nominal_film_distance = Some(gap),
                false => at.interfaces[row].thickness = gap,
            }
        }
        let stop = at.interfaces.iter_mut().find(|interface| interface.is_stop);
        if let (Some(stop), Some(diameter)) = (stop, column.stop_diameter) {
            stop.semi_diameter = diameter / 2.0;
        }
        LensPosition {
            name: format!("{name} {}", column.name.as_deref().unwrap_or("-")),
            focal_length: column.focal_length,
            fnumber: column.fnumber,
            field: field(i),
            film: at.nominal_film_distance,
            object: column.object_distance,
            lens: Lens::at_d_line(&at),
        }
    };
    positions.columns.iter().enumerate().map(case).collect()
}

fn every_case() -> Vec<LensPosition> {
    catalogue::round().flat_map(cases).collect()
}

#[test]
fn focal_lengths_are_those_that_the_patents_state() {
    let mut checked = 0;
    for case in every_case() {
        let Some(stated) = case.focal_length else { continue };
        let own = FirstOrder::of(&case.lens).expect("focal").focal_length;
        // US 4,310,222 prints 14.2 mm for 14.28, and the phone's patent prints 4.1 mm; the others are within a
        // thousandth.
        let tolerance = match case.name.as_str() {
            "ultrawide.14mm" => 6e-3,
            "phone.4mm" => 1.2e-3,
            _ => 1e-3,
        };
        assert!((own / stated - 1.0).abs() < tolerance, "{}: {own} for {stated}", case.name);
        checked += 1;
    }
    assert!(checked >= 22, "{checked}");
}

#[test]
fn the_film_is_where_the_patents_put_it() {
    let mut checked = 0;
    for case in every_case() {
        let Some(film) = case.film else { continue };
        let optics = FirstOrder::of(&case.lens).expect("focal");
        // Newton's equation is used; the first vertex is at z = 0, and the scene at greater z.
        let beyond = case
            .object
            .map_or(0.0, |object| optics.focal_length.powi(2) / (object - optics.front_focal_point));
        let paraxial = optics.back_focal_distance() + beyond;
        // A patent's table has two decimals, and long lenses magnify their rounding error.
        assert!((paraxial - film).abs() < 0.06, "{}: {paraxial} for {film}", case.name);
        checked += 1;
    }
    assert!(checked >= 18, "{checked}");
}

#[test]
fn the_stop_lets_through_the_f_number_that_the_patents_state() {
    let mut checked = 0;
    for case in every_case() {
        let (Some(stated), Some(focal_length)) = (case.fnumber, case.focal_length) else { continue };
        let path = Path::<f64>::scene_to_film(&case.lens);
        let passes = |part: f64| {
            let height = part * focal_length / (2.0 * stated);
            let start = 1.0 + case.lens.front().sagitta_range()[1];
            path.trace(Ray { origin: [0.0, height, start], direction: [0.0, 0.0, -1.0] }).is_ok()
        };
        assert!(passes(0.99), "{}: narrower than f/{stated}", case.name);
        assert!(!passes(1.02), "{}: wider than f/{stated}", case.name);
        checked += 1;
    }
    assert!(checked >= 22, "{checked}");
}

#[test]
fn film_gets_light_from_the_whole_field_that_the_patents_state() {
    let mut checked = 0;
    for case in every_case() {
        let (Some(stated), Some(focal_length)) = (case.field, case.focal_length) else { continue };
        let back = FirstOrder::of(&case.lens).expect("focal").back_focal_distance();
        let field = Field::new(&case.lens, case.lens.rear().vertex - case.film.unwrap_or(back));
        let half = (stated / 2.0).to_radians();
        // Rectilinear lenses image by f tan, fisheyes by f times the angle or less.
        let farthest = 1.1 * focal_length * if stated < 130.0 { half.tan() } else { half };
        let lit = field.lit_radius(farthest).expect("light on the axis");
        let widest = field.real(2.0 * 0.999 * lit).expect("lit").to_degrees();
        // Clear diameters are derived: the lens of 220 degrees sees only 214.
        assert!(widest > 0.97 * stated, "{}: {widest} of {stated} degrees", case.name);
        checked += 1;
    }
    assert!(checked >= 22, "{checked}");
}

#[test]
fn every_lens_of_a_patent_states_what_a_list_shows() {
    for name in catalogue::round().skip(5) {
        let lens = catalogue::find(name).expect("listed");
        assert!(lens.stated.year.is_some() && lens.stated_focal_length.is_some(), "{name}");
        assert!(lens.stated.fields.iter().any(Option::is_some) && lens.remarks.is_empty(), "{name}");
    }
}
