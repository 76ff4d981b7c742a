//! Generated lenses of many interfaces, to measure build times. A kind, a number of interfaces and a seed determine a
//! lens file's text and the camera's parameters.

use std::fmt::Write;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus as Random;
use realistic_optics::{lens::Lens, prescription::catalogue};

/// The method by which a test lens is constructed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Radii, thicknesses and indices of any size.
    Any,
    /// Weak surfaces close together, of which neighbouring ones cross within their apertures.
    Relay,
    /// A lens of the catalogue with weak menisci between its elements.
    Designed,
    /// A [`Kind::Relay`] with terms on a third of the surfaces, or on all.
    SomeAspheres,
    AllAspheres,
    /// A [`Kind::Designed`] with terms on every second surface of a meniscus.
    DesignedAspheres,
}

impl Kind {
    pub const ALL: [Self; 6] = [
        Self::Any,
        Self::Relay,
        Self::Designed,
        Self::SomeAspheres,
        Self::AllAspheres,
        Self::DesignedAspheres,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Any => "of anything",
            Self::Relay => "relays of weak surfaces",
            Self::Designed => "designs among weak menisci",
            Self::SomeAspheres => "relays, a third aspheres",
            Self::AllAspheres => "relays, all aspheres",
            Self::DesignedAspheres => "designs among aspheric menisci",
        }
    }
}

/// A lens file, and its camera's parameters.
pub struct LongLens {
    pub text: String,
    pub parameters: Vec<(&'static str, String)>,
}

/// A row of a lens file; lengths in mm.
struct Row {
    radius: f64,
    thickness: f64,
    index: f64,
    diameter: f64,
    /// Coefficients of r^4, r^6, …, r^12, and the conic constant.
    asphere: Option<([f64; 5], f64)>,
}

impl LongLens {
    /// Generates the lens of a kind, a number of interfaces and a number of its own; the same arguments give the same
    /// lens.
    pub fn new(kind: Kind, interfaces: usize, number: u64) -> Self {
        let mut random = Random::seed_from_u64(number ^ ((interfaces as u64) << 32));
        let rows = match kind {
            Kind::Any => anything(&mut random, interfaces),
            Kind::Relay => relay(&mut random, interfaces, 0.0),
            Kind::SomeAspheres => relay(&mut random, interfaces, 0.33),
            Kind::AllAspheres => relay(&mut random, interfaces, 1.0),
            Kind::Designed => designed(&mut random, interfaces, false),
            Kind::DesignedAspheres => designed(&mut random, interfaces, true),
        };
        let mut text = String::new();
        for (number, Row { asphere, .. }) in rows.iter().enumerate() {
            if let Some((terms, conic)) = asphere {
                let terms: String =
                    terms.iter().enumerate().map(|(i, term)| format!(" A{}={term:e}", 4 + 2 * i)).collect();
                // Writing to a string cannot fail.
                let _ = writeln!(text, "asphere {} conic={conic}{terms}", number + 1);
            }
        }
        for Row { radius, thickness, index, diameter, .. } in &rows {
            let _ = writeln!(text, "{radius:e} {thickness:e} {index} {diameter:e}");
        }
        let mut parameters = vec![("film_diagonal", format!("{:e}", scaled(&mut random, 5.0, 50.0)))];
        if random.random_bool(0.7) {
            parameters.push(("film_distance", format!("{:e}", scaled(&mut random, 1.0, 300.0))));
        }
        Self { text, parameters }
    }
}

/// Returns a number with a uniform logarithm in [from, to).
fn scaled(random: &mut Random, from: f64, to: f64) -> f64 {
    random.random_range(from.ln()..to.ln()).exp()
}

fn sign(random: &mut Random) -> f64 {
    if random.random_bool(0.5) { 1.0 } else { -1.0 }
}

fn anything(random: &mut Random, interfaces: usize) -> Vec<Row> {
    let widest = scaled(random, 2.0, 30.0);
    let strength = scaled(random, 1.5, 1000.0);
    (0..interfaces)
        .map(|i| {
            let semi = widest * random.random_range(0.5..1.0);
            let is_plane = random.random_bool(0.1);
            let radius = semi * scaled(random, strength, 30.0 * strength) * sign(random);
            Row {
                radius: if is_plane { 0.0 } else { radius },
                thickness: widest * scaled(random, 0.003, 0.2),
                index: if i % 2 == 0 { random.random_range(1.4..2.0) } else { 1.0 },
                diameter: 2.0 * semi,
                asphere: None,
            }
        })
        .collect()
}

fn relay(random: &mut Random, interfaces: usize, aspheres: f64) -> Vec<Row> {
    let strength = scaled(random, 0.5, 30.0);
    let longest = scaled(random, 0.02, 1.0);
    (0..interfaces)
        .map(|i| {
            let diameter = random.random_range(16.0..24.0);
            let radius = strength * scaled(random, 80.0, 2000.0) * sign(random);
            Row {
                radius,
                thickness: random.random_range(0.01..longest),
                index: if i % 2 == 0 { random.random_range(1.4..1.8) } else { 1.0 },
                diameter,
                asphere: random.random_bool(aspheres).then(|| terms(random, diameter / 2.0, 1e-3 / strength)),
            }
        })
        .collect()
}

/// Returns terms whose size at the edge of the aperture is up to `size` of the semi-diameter.
fn terms(random: &mut Random, semi: f64, size: f64) -> ([f64; 5], f64) {
    let term = |i: i32| sign(random) * size * scaled(random, 0.05, 1.0) * semi.powi(1 - (4 + 2 * i));
    let terms = [0, 1, 2, 3, 4].map(term);
    (terms, random.random_range(-2.0..1.0))
}

fn designed(random: &mut Random, interfaces: usize, aspheres: bool) -> Vec<Row> {
    let names: Vec<&str> = catalogue::round().collect();
    let name = names[random.random_range(0..names.len())];
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    let mut rows: Vec<Row> = lens
        .surfaces
        .iter()
        .map(|surface| Row {
            radius: if surface.radius.is_finite() { surface.radius } else { 0.0 },
            thickness: surface.thickness,
            index: surface.n_film,
            diameter: 2.0 * surface.semi_diameter,
            asphere: None,
        })
        .collect();
    // Insert pairs of weak surfaces into air spaces, of which they occupy a small part.
    let gaps: Vec<usize> = (0..rows.len() - 1).filter(|&i| rows[i].index == 1.0).collect();
    let pairs = interfaces.saturating_sub(rows.len()) / 2;
    let bend = scaled(random, 20.0, 2000.0);
    for number in (0..pairs).rev() {
        let gap = gaps[number % gaps.len()];
        let room = 0.4 * rows[gap].thickness / (pairs / gaps.len() + 1) as f64;
        rows[gap].thickness -= room;
        let diameter = 1.3 * rows[gap].diameter.max(rows[gap + 1].diameter);
        let radius = bend * diameter * sign(random);
        for index in [random.random_range(1.45..1.8), 1.0] {
            let asphere = (aspheres && index > 1.0).then(|| terms(random, diameter / 2.0, 0.1 / bend));
            rows.insert(gap + 1, Row { radius, thickness: room / 2.0, index, diameter, asphere });
        }
        // The rows of a pair were inserted in reverse order.
        rows.swap(gap + 1, gap + 2);
    }
    rows
}
