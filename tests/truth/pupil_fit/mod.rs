//! Measures of a warped pupil's fit that are independent of the pupil's construction; the tests and the bench share
//! them.
#![allow(dead_code, reason = "each of the two uses a part")]

pub mod lenses;
pub mod survey;

use std::f64::consts::{PI, TAU};

use ::realistic_camera::sampling::{DiskMapping, PupilDisk, WarpedPupil};
use realistic_optics::{
    imaging::focus::Focus,
    lens::{
        Lens, cos4, film_ray,
        first_order::FirstOrder,
        pupil::{self, SlopeDisk},
    },
    prescription::catalogue,
    trace::Path,
};

/// The lenses of the tables.
pub const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
/// Full aperture and two stops.
pub const STOPS: [Option<f64>; 3] = [None, Some(8.0), Some(22.0)];
/// Film radius that tables extend to, mm: a film of 35 mm diagonal and its margin.
pub const REACH: f64 = 17.6;

/// A lens with its film and pupil.
pub struct Case {
    pub path: Path,
    pub film: f64,
    pub reach: f64,
    pub cover: PupilDisk,
    pub exit: PupilDisk,
    pub pupil: WarpedPupil,
}

/// Returns a catalogue lens at an f-number.
pub fn lens_at(name: &str, fnumber: Option<f64>) -> Lens {
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    assert!(fnumber.is_none() || lens.stop_index().is_some(), "{name} has a stop");
    stopped(&lens, fnumber)
}

/// Returns a lens at an f-number, if the lens has a stop and is faster than that.
pub fn stopped(lens: &Lens, fnumber: Option<f64>) -> Lens {
    let mut lens = lens.clone();
    if let (Some(fnumber), Some(stop)) = (fnumber, lens.stop_index()) {
        let focal_length = FirstOrder::of(&lens).expect("focal").focal_length;
        let imaged = pupil::EntrancePupil::of_surface(&lens, stop).diameter();
        lens.surfaces[stop].semi_diameter *= (focal_length / fnumber / imaged).min(1.0);
    }
    lens
}

impl Case {
    /// Returns the case of a lens focused at infinity.
    pub fn of(name: &str, fnumber: Option<f64>) -> Self {
        let lens = lens_at(name, fnumber);
        let distance = Focus::new(&lens).expect("focal").film_distance(f64::INFINITY).expect("reachable");
        Self::with_film(&lens, distance)
    }

    /// Returns the case with the film `distance` mm behind the last vertex.
    pub fn with_film(lens: &Lens, distance: f64) -> Self {
        Self::with_reach(lens, distance, REACH)
    }

    /// Returns the case of [`Case::with_film`] with a table that extends to another film radius, mm.
    pub fn with_reach(lens: &Lens, distance: f64, reach: f64) -> Self {
        Self::try_reach(lens, distance, reach).expect("film behind the lens")
    }

    /// Returns the case of [`Case::with_reach`]; `None` if the film is not behind the lens.
    pub fn try_reach(lens: &Lens, distance: f64, reach: f64) -> Option<Self> {
        let film = lens.rear().vertex - distance;
        let path = Path::film_to_scene(lens);
        let cover = PupilDisk::rear(lens, film, reach)?;
        let exit = PupilDisk::exit(lens, film);
        let pupil = WarpedPupil::new(&path, film, reach, [cover, exit]);
        Some(Self { path, film, reach, cover, exit, pupil })
    }

    /// Builds the pupil again.
    pub fn again(&self) -> WarpedPupil {
        WarpedPupil::new(&self.path, self.film, self.reach, [self.cover, self.exit])
    }

    /// Returns the share of a film point's samples that pass, on `n` by `n` lens samples; `None` where the film is
    /// dark.
    pub fn acceptance(&self, point: [f64; 2], n: u32) -> Option<f64> {
        let mut passed = 0;
        for (u, v) in grid(n) {
            let disk = DiskMapping::Concentric.map(u, v).expect("never rejects");
            passed += u32::from(self.passes(point, self.pupil.sample(point, disk)?.slopes));
        }
        Some(f64::from(passed) / f64::from(n * n))
    }

    /// Whether a ray passes.
    pub fn passes(&self, point: [f64; 2], slopes: [f64; 2]) -> bool {
        self.path.trace(film_ray(point, self.film, slopes)).is_ok()
    }

    /// Returns the film radius up to which there is light, at most `corner`.
    pub fn lit_radius(&self, corner: f64) -> f64 {
        self.pupil.image_radius().map_or(corner, |end| 0.999 * end.min(corner))
    }

    /// Returns the share of the map that passes, and the share of the pupil that the map misses; the true edge is found
    /// by bisection along `n` half-lines.
    pub fn fit(&self, point: [f64; 2], n: u32) -> (f64, f64) {
        let center = self.pupil.sample(point, [0.0; 2]).expect("lit").slopes;
        let edges: Vec<[f64; 3]> = (0..=n)
            .map(|i| {
                let phi = TAU * (f64::from(i) + 0.31) / f64::from(n);
                let [x, y] = self.pupil.sample(point, [phi.cos(), phi.sin()]).expect("lit").slopes;
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
        for pair in edges.windows(2) {
            let width = (pair[1][0] - pair[0][0] + 9.0 * PI) % TAU - PI;
            let [_, radius, edge] = pair[1];
            inside += radius.min(edge).powi(2) * width;
            mapped += radius * radius * width;
            truth += edge * edge * width;
        }
        (inside / mapped, 1.0 - inside / truth)
    }

    /// Returns the parameter, at most 1, at which the half-line from the disk's centre in the given direction leaves
    /// the pupil.
    fn edge(&self, point: [f64; 2], direction: [f64; 2]) -> f64 {
        let at = |r: f64| {
            let slopes = self.pupil.sample(point, direction.map(|x| r * x)).expect("lit").slopes;
            self.passes(point, slopes)
        };
        if at(1.0) {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        if at(0.99) {
            low = 0.99;
        }
        while high - low > 1e-7 {
            let middle = f64::midpoint(low, high);
            if at(middle) { low = middle } else { high = middle }
        }
        low
    }

    /// Returns the expectation of a sample's weight: an integral over the disk's half-lines, with the exact point where
    /// each half-line leaves the pupil. It applies to pupils without gaps.
    pub fn expected_weight(&self, point: [f64; 2], n: u32) -> f64 {
        let mean = |phi: f64| {
            let direction = [phi.cos(), phi.sin()];
            let edge = self.edge(point, direction);
            let integrand = |r: f64| {
                let sample = self.pupil.sample(point, direction.map(|x| r * x)).expect("lit");
                sample.area * cos4(sample.slopes) * 2.0 * r
            };
            simpson(0.0, edge, integrand)
        };
        (0..n).map(|i| mean(TAU * (f64::from(i) + 0.37) / f64::from(n))).sum::<f64>() / f64::from(n)
    }

    /// Returns the true irradiance from a disk of slopes, by exact chords of the open region on `n` lines. A scan of
    /// `scan` steps finds the chords, and bisection their ends.
    pub fn irradiance(&self, point: [f64; 2], within: SlopeDisk, n: u32, scan: u32) -> f64 {
        let SlopeDisk { center, radius } = within;
        let step = 2.0 * radius / f64::from(n);
        (0..n)
            .map(|i| {
                let y = (f64::from(i) + 0.5) * step - radius;
                let half = (radius * radius - y * y).sqrt();
                let slopes = |x: f64| [center[0] + x, center[1] + y];
                let at = |k: u32| half * (2.0 * f64::from(k) / f64::from(scan) - 1.0);
                let open = |x: f64| self.passes(point, slopes(x));
                let mut begin = open(at(0)).then(|| at(0));
                let mut chords = Vec::new();
                for k in 1..=scan {
                    if open(at(k)) == begin.is_some() {
                        continue;
                    }
                    let (mut low, mut high) = (at(k - 1), at(k));
                    while high - low > 1e-8 * radius {
                        let middle = f64::midpoint(low, high);
                        if open(middle) == begin.is_some() { low = middle } else { high = middle }
                    }
                    match begin.take() {
                        Some(from) => chords.push((from, low)),
                        None => begin = Some(high),
                    }
                }
                chords.extend(begin.map(|from| (from, half)));
                let along = |(a, b): (f64, f64)| simpson(a, b, |x| cos4(slopes(x)));
                step * chords.into_iter().map(along).sum::<f64>()
            })
            .sum()
    }

    /// Returns a disk of slopes slightly larger than the map.
    pub fn surroundings(&self, point: [f64; 2]) -> SlopeDisk {
        let center = self.pupil.sample(point, [0.0; 2]).expect("lit").slopes;
        let radius = (0..64).map(|i| {
            let phi = TAU * f64::from(i) / 64.0;
            let [x, y] = self.pupil.sample(point, [phi.cos(), phi.sin()]).expect("lit").slopes;
            (x - center[0]).hypot(y - center[1])
        });
        SlopeDisk { center, radius: 1.2 * radius.fold(0.0, f64::max) }
    }

    /// Returns the mean and the relative variance of the weight of one flat-field sample, which is 0 for a blocked
    /// sample, on `n` x `n` lens samples.
    pub fn weight(&self, point: [f64; 2], n: u32) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (u, v) in grid(n) {
            let disk = DiskMapping::Concentric.map(u, v).expect("never rejects");
            let Some(sample) = self.pupil.sample(point, disk) else { continue };
            if self.passes(point, sample.slopes) {
                let weight = sample.area * cos4(sample.slopes);
                sum += weight;
                squares += weight * weight;
            }
        }
        let count = f64::from(n * n);
        let mean = sum / count;
        (mean, squares / count / (mean * mean) - 1.0)
    }
}

/// Returns the midpoints of `n` x `n` squares.
pub fn grid(n: u32) -> impl Iterator<Item = (f64, f64)> {
    let at = move |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    (0..n * n).map(move |k| (at(k % n), at(k / n)))
}

/// Integrates by Simpson's rule on 16 panels.
fn simpson(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let at = |k: u32| f(a + (b - a) * f64::from(k) / 32.0);
    let inner = (1..32).map(|k| if k % 2 == 1 { 4.0 * at(k) } else { 2.0 * at(k) });
    (b - a) / 96.0 * (at(0) + inner.sum::<f64>() + at(32))
}
