//! Lenses and bundles of rays for the cases.

use std::f64::consts::TAU;

use realistic_optics::{
    lens::Lens,
    prescription::{Interface, Medium, Prescription, Shape},
    trace::{Direction, Ray},
};

/// The origin of the light, with its name.
pub const SIDES: [(&str, Direction); 2] =
    [("scene", Direction::SceneToFilm), ("film", Direction::FilmToScene)];

/// A row of a lens: radius (infinite for a plane), thickness, index behind the surface, and clear semi-diameter;
/// lengths in mm.
pub type Row = (f64, f64, f64, f64);

/// Builds the lens of these rows, scene side first. A last medium other than air is kept.
pub fn lens(name: &str, rows: &[Row]) -> Lens {
    let figured: Vec<Figured> = rows
        .iter()
        .map(|&(radius, thickness, n, semi_diameter)| {
            let shape = if radius.is_finite() { Shape::Sphere { radius } } else { Shape::Plane };
            (shape, thickness, n, semi_diameter)
        })
        .collect();
    lens_of(name, &figured)
}

/// A row with a general figure instead of a radius.
pub type Figured = (Shape, f64, f64, f64);

/// Builds the lens of rows with figures; a plane in air is the stop.
pub fn lens_of(name: &str, rows: &[Figured]) -> Lens {
    let mut in_front = 1.0;
    let interface = |&(shape, thickness, n, semi_diameter): &Figured| {
        let medium = if n == 1.0 { Medium::Air } else { Medium::Glass { n_d: n, abbe: None } };
        let is_stop = shape == Shape::Plane && in_front == 1.0 && n == 1.0;
        in_front = n;
        Interface { is_stop, ..Interface::new(shape, thickness, medium, semi_diameter) }
    };
    let interfaces = rows.iter().map(interface).collect();
    Lens::at_d_line(&Prescription { name: name.to_owned(), ..Prescription::new(interfaces) })
}

/// Returns a lens of the catalogue with every length multiplied by `factor`.
pub fn catalogue(name: &str, factor: f64) -> Lens {
    let prescription =
        realistic_optics::prescription::catalogue::find(name).expect("a lens of the catalogue");
    Lens::at_d_line(&prescription.scaled(factor))
}

/// Returns rays from points at the given heights in the plane `distance` mm before the first surface. They are aimed at
/// points of that surface's vertex plane: its centre, and rings out to `aim` mm at azimuths that share no symmetry with
/// the starting points.
pub fn bundle(lens: &Lens, direction: Direction, distance: f64, heights: &[f64], aim: f64) -> Vec<Ray> {
    let (entry, sign) = match direction {
        Direction::FilmToScene => (lens.rear().vertex, 1.0),
        Direction::SceneToFilm => (lens.front().vertex, -1.0),
    };
    let start = entry - sign * distance;
    let mut rays = Vec::new();
    for &height in heights {
        let origin = [0.6 * height, -0.8 * height, start];
        for ring in 0..=6_u32 {
            for spoke in 0..if ring == 0 { 1 } else { 7_u32 } {
                let radius = aim * f64::from(ring) / 6.0;
                let (sine, cosine) = (TAU * (f64::from(spoke) + 0.1 * f64::from(ring)) / 7.0).sin_cos();
                let direction = [radius * cosine - origin[0], radius * sine - origin[1], sign * distance];
                rays.push(Ray { origin, direction });
            }
        }
    }
    rays
}

/// Returns rays from the scene parallel to the axis at these heights.
pub fn parallel(heights: impl IntoIterator<Item = f64>) -> Vec<Ray> {
    heights
        .into_iter()
        .map(|height| Ray { origin: [0.6 * height, -0.8 * height, 30.0], direction: [0.0, 0.0, -1.0] })
        .collect()
}
