//! Which aperture tests no ray can fail: proven with bounds over film and pupil.
//!
//! A test is redundant when every ray that the other tests let through passes it, too. The film's radii and the
//! slopes sampled there are cut into boxes, and a box is taken through the lens as a whole, in affine arithmetic:
//! all its rays miss an aperture that stays, and the box is done with; or they stay inside the
//! apertures in question by a margin far above rounding; or the box is halved. What is not proven within a
//! small number of boxes stays. Through an asphere a box goes by the bounds of its figure ([`crate::lens::Figure`]).

use super::affine::Affine;
use crate::{
    lens::{Lens, refraction::Refraction},
    sampling::Band,
    trace::{Direction, Intersection, Path, Real},
};

/// What was found out about the apertures of a lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Apertures {
    /// For each surface, from the scene: the largest height over clear semi-diameter at which rays can arrive, where
    /// that proves the test redundant.
    pub redundant: Vec<Option<f64>>,
    /// Boxes that it took.
    pub boxes: u32,
}

/// A test goes where the square of height over semi-diameter stays below 1 - this; single precision rounds it
/// by less than a hundredth of that in any lens that it is used for.
const MARGIN: f64 = 2e-3;
/// Boxes times surfaces at most: a proof must not cost what it saves.
const WORK: usize = 440;
/// Halvings of a box at most.
const DEPTH: u32 = 7;

/// A part of a band: film radius, and the disk's coordinates along and across the film point's direction.
#[derive(Clone, Copy)]
struct Part {
    band: Band,
    radii: [f64; 2],
    u: [f64; 2],
    v: [f64; 2],
    depth: u32,
}

impl Part {
    fn misses_the_disk(&self) -> bool {
        let nearest = |[from, to]: [f64; 2]| if from > 0.0 { from } else { (-to).max(0.0) };
        let (u, v) = (nearest(self.u), nearest(self.v));
        u * u + v * v > 1.0 + 1e-6
    }

    fn halves(&self, axis: usize) -> [Self; 2] {
        let cut = |[from, to]: [f64; 2]| {
            let middle = f64::midpoint(from, to);
            [[from, middle], [middle, to]]
        };
        let depth = self.depth + 1;
        match axis {
            0 => cut(self.radii).map(|radii| Self { radii, depth, ..*self }),
            1 => cut(self.u).map(|u| Self { u, depth, ..*self }),
            _ => cut(self.v).map(|v| Self { v, depth, ..*self }),
        }
    }

    /// The axis along which it is longest against its band.
    fn longest(&self) -> usize {
        let length = |[from, to]: [f64; 2]| to - from;
        let [h, u, v] = [length(self.radii) / length(self.band.radii), length(self.u) / 2.0, length(self.v)];
        if h >= u && h >= v {
            0
        } else if u >= v {
            1
        } else {
            2
        }
    }
}

/// What became of a part.
enum Verdict {
    /// Every ray is blocked by a test that stays, or passes all tests in question.
    Settled(Vec<f64>),
    /// The tests of these surfaces remain open; best halved along the axis.
    Open { surfaces: Vec<usize>, axis: usize },
}

impl Apertures {
    /// Looks for redundant tests in a lens with film at `film` (z in lens space), for rays sampled in the bands. `path` is
    /// the lens from film to scene.
    pub fn of(lens: &Lens, path: &Path, film: f64, bands: &[Band]) -> Self {
        let count = lens.surfaces.len();
        let mut stays = limiting(path, film, bands);
        if let Some((bladed, _)) = path.blades() {
            // The bounds are of heights, and the figure of blades is none.
            stays[bladed] = true;
        }
        let mut search =
            Search { path: Path::new(lens, Direction::FilmToScene, Refraction::Fused), film, stays };
        let mut largest = vec![0.0_f64; count];
        let mut boxes = 0;
        let most = (WORK / count).max(1) as u32;
        let mut parts: Vec<Part> = bands
            .iter()
            .flat_map(|&band| {
                let halves = [[-1.0, 0.0], [0.0, 1.0]];
                halves.map(|u| Part { band, radii: band.radii, u, v: [0.0, 1.0], depth: 0 })
            })
            .collect();
        while let Some(part) = parts.pop() {
            if search.stays.iter().all(|stays| *stays) {
                break;
            }
            if part.misses_the_disk() {
                continue;
            }
            boxes += 1;
            match search.look(&part) {
                Verdict::Settled(ratios) => {
                    largest.iter_mut().zip(ratios).for_each(|(most, ratio)| *most = most.max(ratio));
                }
                Verdict::Open { surfaces, .. } if part.depth == DEPTH || boxes >= most => {
                    surfaces.into_iter().for_each(|surface| search.stays[surface] = true);
                    parts.push(part);
                }
                Verdict::Open { axis, .. } => parts.extend(part.halves(axis)),
            }
        }
        let redundant = search.stays.iter().zip(&largest).map(|(stays, most)| (!stays).then(|| most.sqrt()));
        Self { redundant: redundant.rev().collect(), boxes }
    }

    /// Whether the aperture of a surface, counted from the scene, has to be tested.
    pub fn is_needed(&self, surface: usize) -> bool {
        self.redundant[surface].is_none()
    }
}

struct Search {
    path: Path<Affine>,
    film: f64,
    /// Along the travel.
    stays: Vec<bool>,
}

impl Search {
    fn look(&self, part: &Part) -> Verdict {
        let Part { band, radii, u, v, .. } = *part;
        let height = Affine::coordinate(0, radii);
        let [u, v] = [Affine::coordinate(1, u), Affine::coordinate(2, v)];
        let radius = Affine::from_f64(band.radius);
        let slopes = [Affine::between(band.center) * height + radius * u, radius * v];
        let mut blocked = false;
        let mut next = 0;
        let mut open = Vec::new();
        let mut axis = part.longest();
        let mut ratios = vec![0.0; self.stays.len()];
        let met_all = self.path.intersections(
            self.film,
            [height, Affine::ZERO],
            slopes,
            |Intersection { surface, ratio, normal, .. }| {
                next = surface + 1;
                let [least, most] = ratio.range();
                if self.stays[surface] {
                    blocked = least > 1.0 + MARGIN;
                    return !blocked;
                }
                ratios[surface] = most;
                // Negated so that NaN is open, too.
                if !(most < 1.0 - MARGIN && normal > Affine::ZERO) {
                    if open.is_empty() && ratio.rest.is_finite() {
                        axis = steepest(&ratio);
                    }
                    open.push(surface);
                }
                true
            },
        );
        if blocked {
            return Verdict::Settled(Vec::new());
        }
        if !met_all {
            open.extend((next.saturating_sub(1)..self.stays.len()).filter(|&i| !self.stays[i]));
        }
        if open.is_empty() { Verdict::Settled(ratios) } else { Verdict::Open { surfaces: open, axis } }
    }
}

fn steepest(ratio: &Affine) -> usize {
    let slope = |axis: usize| ratio.slopes[axis].abs();
    (1..3).fold(0, |best, axis| if slope(axis) > slope(best) { axis } else { best })
}

/// Which apertures block a few rays at the bands' ends, or nearly so: nothing is to be proven about those. Along the
/// travel.
fn limiting(path: &Path, film: f64, bands: &[Band]) -> Vec<bool> {
    const DIRECTIONS: u32 = 5;
    const RINGS: [f64; 2] = [1.0, 0.85];
    let count = path.surfaces();
    let mut stays = vec![false; count];
    let mut rays: Vec<Vec<f64>> = Vec::new();
    let ends = bands.iter().map(|band| (band, band.radii[1]));
    for (band, height) in bands.first().map(|band| (band, band.radii[0])).into_iter().chain(ends) {
        for ring in RINGS {
            for direction in 0..=DIRECTIONS {
                let (sin, cos) =
                    (std::f64::consts::PI * f64::from(direction) / f64::from(DIRECTIONS)).sin_cos();
                let radius = band.radius * ring;
                let slopes = [band.center[1] * height + radius * cos, radius * sin];
                let mut ratios = vec![f64::INFINITY; count];
                path.intersections(film, [height, 0.0], slopes, |intersection| {
                    ratios[intersection.surface] = intersection.ratio;
                    intersection.ratio < 4.0
                });
                rays.push(ratios);
            }
        }
    }
    let beyond = |ratios: &[f64]| (0..count).filter(|&i| !(ratios[i] < 1.0)).collect::<Vec<_>>();
    // Those that are alone in blocking a ray first: what they block needs no other.
    for ratios in &rays {
        if let [only] = beyond(ratios)[..] {
            stays[only] = true;
        }
    }
    for ratios in &rays {
        let blocking = beyond(ratios);
        if let Some(&first) = blocking.first()
            && !blocking.iter().any(|&surface| stays[surface])
        {
            stays[first] = true;
        }
    }
    for ratios in &rays {
        if !beyond(ratios).iter().any(|&surface| stays[surface]) {
            (0..count).filter(|&i| !(ratios[i] < 1.0 - MARGIN)).for_each(|i| stays[i] = true);
        }
    }
    stays
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        imaging::focus::Focus,
        prescription::{Asphere, FIRST_POWER, Prescription, Shape, catalogue, read},
        sampling::{PupilDisk, WarpedPupil},
    };

    const REACH: f64 = 15.0;
    /// The double Gauss with strong aspheres in its first and last place.
    const ASPHERIC: &str = "dgauss.50mm with aspheres";

    fn prescription(name: &str) -> Prescription {
        if name != ASPHERIC {
            return catalogue::find(name).expect("listed");
        }
        let mut prescription = catalogue::find("dgauss.50mm").expect("listed");
        let last = prescription.interfaces.len() - 1;
        for (number, term) in [(0, 1e-6), (last, -4e-6)] {
            let interface = &mut prescription.interfaces[number];
            let Shape::Sphere { radius } = interface.shape else { panic!("a sphere") };
            let mut terms = [0.0; 19];
            (terms[4 - FIRST_POWER], terms[6 - FIRST_POWER]) = (term, -1e-3 * term);
            interface.shape = Shape::Asphere(Asphere { radius, conic: -0.5, terms });
        }
        prescription
    }

    fn names() -> impl Iterator<Item = &'static str> {
        catalogue::names().chain(std::iter::once(ASPHERIC))
    }

    /// A lens at a part of its stop, focused at infinity, with the bands of the warped pupil and of a disk.
    fn subject(name: &str, stop: f64) -> (Lens, f64, [Vec<Band>; 2]) {
        let mut lens = Lens::at_d_line(&prescription(name));
        let row = lens.stop_index().expect("a stop");
        lens.surfaces[row].semi_diameter *= stop;
        let distance = Focus::new(&lens).and_then(|focus| focus.film_distance(f64::INFINITY)).expect("focal");
        let film = lens.rear().vertex - distance;
        let rear = PupilDisk::rear(&lens, film, REACH).expect("behind the lens");
        let exit = PupilDisk::exit(&lens, film);
        let center = |disk: PupilDisk| disk.seen_from([1.0, 0.0]).center[0];
        let warped = WarpedPupil::new(&Path::film_to_scene(&lens), film, REACH, rear, center(exit));
        let disk = Band { radii: [0.0, REACH], center: [center(exit); 2], radius: exit.slope_radius() };
        (lens, film, [warped.bands(), vec![disk]])
    }

    /// The largest square of height over clear semi-diameter at a surface (from the scene) of rays that every other
    /// aperture lets through, searched for from many places by steps that shrink.
    fn highest(lens: &Lens, film: f64, bands: &[Band], surface: usize) -> f64 {
        let path = Path::<f64>::film_to_scene(lens);
        let last = lens.surfaces.len() - 1;
        let ratio = |[place, u, v]: [f64; 3]| {
            let reach = bands.last().expect("bands").radii[1];
            let height = reach * place.clamp(0.0, 1.0);
            let band = bands.iter().find(|band| height <= band.radii[1]).expect("inside");
            let length = (u * u + v * v).sqrt().max(1.0);
            let center = band.center[0] + place * (band.center[1] - band.center[0]);
            let slopes = [center * height + band.radius * u / length, band.radius * v / length];
            let mut found = f64::NEG_INFINITY;
            let mut passes = true;
            let met_all = path.intersections(film, [height, 0.0], slopes, |intersection| {
                if intersection.surface == last - surface {
                    found = intersection.ratio;
                } else {
                    passes &= intersection.ratio <= 1.0;
                }
                passes
            });
            if met_all && passes { found } else { f64::NEG_INFINITY }
        };
        let mut most = f64::NEG_INFINITY;
        for start in 0..12_u32 {
            let part = |step: f64| (0.5 + f64::from(start) * step).fract();
            let mut at = [part(0.754_877), 2.0 * part(0.569_84) - 1.0, 2.0 * part(0.819_172) - 1.0];
            let mut best = ratio(at);
            let mut step = 0.3;
            while step > 1e-3 {
                let tries = (0..6).map(|k| {
                    let mut other = at;
                    other[k / 2] += if k % 2 == 0 { step } else { -step };
                    (ratio(other), other)
                });
                let (value, place) = tries.max_by(|a, b| a.0.total_cmp(&b.0)).expect("six");
                if value > best { (best, at) = (value, place) } else { step /= 2.0 }
            }
            most = most.max(best);
        }
        most
    }

    #[test]
    fn no_search_finds_a_ray_beyond_a_proven_bound() {
        let (mut proven, mut behind_asphere) = (0, 0);
        for name in names() {
            for stop in [1.0, 0.2] {
                let (lens, film, both) = subject(name, stop);
                for bands in &both {
                    let apertures = Apertures::of(&lens, &Path::film_to_scene(&lens), film, bands);
                    for (surface, bound) in apertures.redundant.iter().enumerate() {
                        let Some(bound) = bound else { continue };
                        proven += 1;
                        // The last is met first.
                        behind_asphere += u32::from(name == ASPHERIC && surface + 1 < lens.surfaces.len());
                        let found = highest(&lens, film, bands, surface).max(0.0).sqrt();
                        assert!(
                            found <= *bound,
                            "{name} x {stop}, surface {surface}: a ray at {found}, the bound is {bound}"
                        );
                    }
                }
            }
        }
        assert!(proven > 20, "{proven}: hardly anything is proven");
        assert!(behind_asphere > 2, "{behind_asphere}: hardly anything is proven behind an asphere");
    }

    #[test]
    fn the_aperture_that_limits_is_never_proven_redundant() {
        for name in names() {
            let (lens, film, both) = subject(name, 0.2);
            let stop = lens.stop_index().expect("a stop");
            for bands in &both {
                assert!(
                    Apertures::of(&lens, &Path::film_to_scene(&lens), film, bands).is_needed(stop),
                    "{name}"
                );
            }
        }
    }

    #[test]
    fn an_edge_far_out_is_redundant_and_one_that_cuts_is_not() {
        let lens = |diameter: &str| {
            let text = format!("30 4 1.6 16\n-60 2 1 16\n0 3 1 6\n80 4 1.5 {diameter}\n-50 0 1 40\n");
            Lens::at_d_line(&read("lens", text.as_bytes()).expect("a lens"))
        };
        let bands = [Band { radii: [0.0, 6.0], center: [-0.02; 2], radius: 0.15 }];
        let of = |diameter: &str| {
            let lens = lens(diameter);
            Apertures::of(&lens, &Path::film_to_scene(&lens), lens.rear().vertex - 40.0, &bands)
        };
        assert!(!of("36").is_needed(3), "{:?}", of("36"));
        assert!(of("8").is_needed(3));
    }
}
