//! Measures of how well a warped pupil fits, apart from the way it is built: shared by the tests and the
//! bench.

use std::f64::consts::{PI, TAU};

use realistic::{
    camera::{
        DiskMapping, PupilDisk, WarpedPupil,
        irradiance::{cos4, film_ray},
    },
    optics::{Lens, first_order::FirstOrder, focus::Focus, pupil},
    prescription::catalogue,
    trace::Path,
};

/// The lenses of the tables.
pub const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
/// Full aperture and two stops.
pub const STOPS: [Option<f64>; 3] = [None, Some(8.0), Some(22.0)];
/// Film radius that tables reach to, mm: a film of 35 mm diagonal and its margin.
pub const REACH: f64 = 17.6;

/// A lens with its film and pupil.
pub struct Case {
    pub path: Path,
    pub film: f64,
    pub cover: PupilDisk,
    pub drift: f64,
    pub pupil: WarpedPupil,
}

/// A catalogue lens at an f-number.
pub fn lens_at(name: &str, fnumber: Option<f64>) -> Lens {
    let mut lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    if let Some(fnumber) = fnumber {
        let stop = lens.stop_index().expect("has a stop");
        let focal_length = FirstOrder::of(&lens).expect("focal").focal_length;
        let imaged = pupil::EntrancePupil::of_surface(&lens, stop).diameter();
        lens.surfaces[stop].semi_diameter *= (focal_length / fnumber / imaged).min(1.0);
    }
    lens
}

impl Case {
    /// Focused at infinity.
    pub fn of(name: &str, fnumber: Option<f64>) -> Self {
        let lens = lens_at(name, fnumber);
        let distance = Focus::new(&lens).expect("focal").film_distance(f64::INFINITY).expect("reachable");
        Self::with_film(&lens, distance)
    }

    /// With the film `distance` mm behind the last vertex.
    pub fn with_film(lens: &Lens, distance: f64) -> Self {
        let film = lens.rear().vertex - distance;
        let path = Path::film_to_scene(lens);
        let cover = PupilDisk::rear(lens, film, REACH).expect("film behind the lens");
        let drift = PupilDisk::exit(lens, film).seen_from([1.0, 0.0]).center[0];
        let pupil = WarpedPupil::new(&path, film, REACH, cover, drift);
        Self { path, film, cover, drift, pupil }
    }

    /// Whether a ray gets through.
    pub fn passes(&self, point: [f64; 2], slopes: [f64; 2]) -> bool {
        self.path.trace(film_ray(point, self.film, slopes)).is_ok()
    }

    /// The film radius up to which there is light, at most `corner`.
    pub fn lit_radius(&self, corner: f64) -> f64 {
        self.pupil.image_radius().map_or(corner, |end| 0.999 * end.min(corner))
    }

    /// Share of the map that passes and share of the pupil that it misses, by bisection for
    /// the true edge along `n` half-lines.
    pub fn fit(&self, point: [f64; 2], n: u32) -> (f64, f64) {
        let center = self.pupil.draw(point, [0.0; 2]).expect("lit").slopes;
        let rim: Vec<[f64; 3]> = (0..=n)
            .map(|i| {
                let phi = TAU * (f64::from(i) + 0.31) / f64::from(n);
                let [x, y] = self.pupil.draw(point, [phi.cos(), phi.sin()]).expect("lit").slopes;
                let (dx, dy) = (x - center[0], y - center[1]);
                let at = |k: f64| self.passes(point, [center[0] + k * dx, center[1] + k * dy]);
                let (mut low, mut high) = (0.0, 2.0);
                if at(0.9) {
                    low = 0.9;
                }
                if !at(1.05) {
                    high = 1.05;
                }
                while high - low > 1e-7 {
                    let middle = f64::midpoint(low, high);
                    if at(middle) { low = middle } else { high = middle }
                }
                [dy.atan2(dx), dx.hypot(dy), low * dx.hypot(dy)]
            })
            .collect();
        let (mut inside, mut mapped, mut truth) = (0.0, 0.0, 0.0);
        for pair in rim.windows(2) {
            let width = (pair[1][0] - pair[0][0] + 9.0 * PI) % TAU - PI;
            let [_, radius, edge] = pair[1];
            inside += radius.min(edge).powi(2) * width;
            mapped += radius * radius * width;
            truth += edge * edge * width;
        }
        (inside / mapped, 1.0 - inside / truth)
    }

    /// Mean and relative variance of one flat-field sample's weight, blocked ones being 0, on `n` x `n` lens
    /// numbers.
    pub fn weight(&self, point: [f64; 2], n: u32) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (u, v) in grid(n) {
            let disk = DiskMapping::Concentric.map(u, v).expect("never rejects");
            let Some(drawn) = self.pupil.draw(point, disk) else { continue };
            if self.passes(point, drawn.slopes) {
                let weight = drawn.area * cos4(drawn.slopes);
                sum += weight;
                squares += weight * weight;
            }
        }
        let count = f64::from(n * n);
        let mean = sum / count;
        (mean, squares / count / (mean * mean) - 1.0)
    }
}

/// The midpoints of `n` x `n` squares.
pub fn grid(n: u32) -> impl Iterator<Item = (f64, f64)> {
    let at = move |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    (0..n * n).map(move |k| (at(k % n), at(k / n)))
}
