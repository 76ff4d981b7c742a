//! The golden tables, and comparisons of rays.

use std::path::PathBuf;

use realistic_optics::{
    lens::Lens,
    prescription::{catalogue, read},
    trace::{Blocked, Ray},
};

/// The lenses that have tables of exact rays.
pub const LENSES: [&str; 7] =
    ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm", "dgauss.100mm", "planar", "crossed"];

/// Returns the fields of each row.
pub fn table(name: &str) -> Vec<Vec<String>> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// Returns a lens of the catalogue or from the tables' folder.
pub fn lens(name: &str, wavelength: f64) -> Lens {
    let prescription = catalogue::find(name).unwrap_or_else(|| {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.dat"));
        read(name, &std::fs::read(path).expect("a golden lens")).expect("a valid lens")
    });
    Lens::new(&prescription, wavelength)
}

/// Returns the six numbers of a ray.
pub fn numbers(fields: &[String]) -> [f64; 6] {
    std::array::from_fn(|i| fields[i].parse().expect("a number"))
}

/// Returns a ray from its point and direction.
pub fn ray(numbers: [f64; 6]) -> Ray {
    let [x, y, z, dx, dy, dz] = numbers;
    Ray { origin: [x, y, z], direction: [dx, dy, dz] }
}

/// Returns the distance between the points, and the angle between the directions.
pub fn difference(a: Ray, b: Ray) -> (f64, f64) {
    let distance = |p: [f64; 3], q: [f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
    (distance(a.origin, b.origin), distance(a.direction, b.direction))
}

/// Returns the outcome that a status of the tables means.
pub fn outcome(status: &str) -> Option<Blocked> {
    match status {
        "ok" => None,
        "missed" => Some(Blocked::Missed),
        "clipped" => Some(Blocked::Clipped),
        "reflected" => Some(Blocked::Reflected),
        "turned_back" => Some(Blocked::TurnedBack),
        other => panic!("unknown status {other}"),
    }
}
