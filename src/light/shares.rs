//! What is left of the light of many rays along one path: rays in, each by its place in a beam; shares of their power out.
//!
//! A share is a smooth function of where in a beam a ray starts: a few of the rays, spread over all, have their light carried
//! from surface to surface ([`LitPath::trace`]), and the others the polynomial in the two numbers of their places that fits
//! best. Others again, which it was not fitted to, tell its error. Where that is not small, each half of the beam is a beam of
//! its own, and where rays are few, each has its own light carried.

use super::coated::LitPath;
use crate::{lens::Ray, trace::polynomial::LeastSquares};

/// The error, of the greatest share in a beam, at which no higher degree is looked for: less than a step of a picture's colours.
/// A tenth of it takes a third more time; watts of a spray are the same to four digits.
const GOAL: f64 = 1e-3;
/// Rays that a polynomial is fitted to, and those beside them at which it is looked at.
const PROBES: [usize; 2] = [80, 20];
/// The golden section, whose multiples' fractions lie evenly and in no pattern.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// The highest total degree: 36 terms.
const HIGHEST: usize = 7;

/// The shares of rays that get through, each at its place in a beam, from which `ray` makes it.
pub fn shares(path: &LitPath, places: &[[f64; 2]], ray: impl Fn([f64; 2]) -> Ray) -> Vec<f64> {
    // Rays within rounding of an edge may be blocked here: those have no light.
    let carried = |i: usize| path.trace(ray(places[i])).map_or(0.0, |(_, share)| share);
    let mut shares = vec![0.0; places.len()];
    let mut beams: Vec<Vec<usize>> = vec![(0..places.len()).collect()];
    let mut powers = Vec::new();
    while let Some(mut beam) = beams.pop() {
        let [_, looked_at] = PROBES;
        let every = PROBES.iter().sum::<usize>();
        if beam.len() <= 2 * every {
            beam.into_iter().for_each(|i| shares[i] = carried(i));
            continue;
        }
        let bounds = [0, 1].map(|axis| {
            let along = beam.iter().map(|i| places[*i][axis]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], at| [from.min(at), to.max(at)])
        });
        // -1 … 1 over the beam.
        let scaled = |i: usize| -> [f64; 2] {
            std::array::from_fn(|axis| {
                let [from, to] = bounds[axis];
                if to > from { (2.0 * places[i][axis] - from - to) / (to - from) } else { 0.0 }
            })
        };
        // Steps of the golden section: even ones meet rows of cells at the same columns again and again. One in five of the
        // probes is looked at.
        let probes = (0..every).map(|k| {
            let i = beam[((k as f64 * GOLDEN).fract() * beam.len() as f64) as usize];
            (scaled(i), carried(i))
        });
        let (seen, from): (Vec<_>, Vec<_>) =
            probes.enumerate().partition(|(k, _)| k % (every / looked_at) == 2);
        let [seen, from] =
            [seen, from].map(|all| all.into_iter().map(|(_, probe)| probe).collect::<Vec<_>>());
        if let Some((degree, terms)) = fit(&from, &seen) {
            for i in beam {
                monomials(scaled(i), degree, &mut powers);
                shares[i] = powers.iter().zip(&terms).map(|(power, term)| power * term).sum::<f64>().max(0.0);
            }
            continue;
        }
        let [width, height] = bounds.map(|[from, to]| to - from);
        let axis = usize::from(height > width);
        let middle = beam.len() / 2;
        beam.select_nth_unstable_by(middle, |a, b| places[*a][axis].total_cmp(&places[*b][axis]));
        beams.push(beam.split_off(middle));
        beams.push(beam);
    }
    shares
}

/// A place and the share there.
type Probe = ([f64; 2], f64);

/// The least degree whose error is small, and the terms; `None` where there is none.
fn fit(from: &[Probe], seen: &[Probe]) -> Option<(usize, Vec<f64>)> {
    let most = from.iter().fold(0.0_f64, |most, (_, share)| most.max(*share));
    let mut equations = LeastSquares::new(vec![from.iter().map(|(_, share)| *share).collect()]);
    let mut all = vec![Vec::new(); from.len()];
    for (powers, (place, _)) in all.iter_mut().zip(from) {
        monomials(*place, HIGHEST, powers);
    }
    let (mut count, mut powers) = (0, Vec::new());
    for degree in 0..=HIGHEST {
        for _ in 0..=degree {
            equations.add(all.iter().map(|powers| powers[count]).collect()).ok()?;
            count += 1;
        }
        let terms = equations.solve(count).swap_remove(0);
        let is_near = |(place, share): &Probe| {
            monomials(*place, degree, &mut powers);
            let value: f64 = powers.iter().zip(&terms).map(|(power, term)| power * term).sum();
            (value - share).abs() <= GOAL * most
        };
        if seen.iter().all(is_near) {
            return Some((degree, terms));
        }
    }
    None
}

/// All monomials up to a total degree, those of each degree behind those of the one below.
fn monomials([x, y]: [f64; 2], degree: usize, into: &mut Vec<f64>) {
    into.clear();
    into.push(1.0);
    for degree in 1..=degree {
        let below = into.len() - degree;
        for k in 0..degree {
            into.push(into[below + k] * x);
        }
        into.push(into[below + degree - 1] * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lens::{Lens, refraction::Refraction},
        light::Surfaces,
        prescription::{Coating, catalogue},
        trace::{Direction, Path},
    };

    #[test]
    fn shares_are_those_of_light_carried_along_each_ray() {
        const SIDE: usize = 40;
        let (mut beams, mut fitted) = (0, 0);
        for (name, wavelength) in [("dgauss.50mm", 430.0), ("fisheye.10mm", 550.0), ("wide.22mm", 660.0)] {
            let lens = Lens::new(&catalogue::find(name).expect("listed"), wavelength);
            let surfaces = Surfaces::new(&lens, Coating::QuarterWave);
            let all = surfaces.reflecting();
            let [half, depth] = [lens.front().semi_diameter, 2.0 * lens.front().semi_diameter];
            let ray = |[x, y]: [f64; 2]| {
                let direction = [-0.2, 0.05, -1.0];
                Ray { origin: [x * half + 0.2 * depth, y * half - 0.05 * depth, depth], direction }
            };
            let at = |i: usize| (2 * i + 1) as f64 / SIDE as f64 - 1.0;
            for pair in all.iter().flat_map(|near| all.iter().map(move |far| [*near, *far])) {
                if pair[0] >= pair[1] {
                    continue;
                }
                let path = Path::reflected(&lens, Direction::SceneToFilm, Refraction::Fused, pair);
                let path = LitPath::new(path, &surfaces);
                // As in a spray: rays over the part of the front from which they get through.
                let grid = || (0..SIDE * SIDE).map(|i| [at(i % SIDE), at(i / SIDE)]);
                let mut part = [[1.0_f64, -1.0]; 2];
                for place in grid().filter(|place| path.trace(ray(*place)).is_ok()) {
                    for (own, at) in part.iter_mut().zip(place) {
                        *own = [own[0].min(at), own[1].max(at)];
                    }
                }
                let along = |[from, to]: [f64; 2], at: f64| f64::midpoint(from + to, at * (to - from));
                let places = grid().map(|place| std::array::from_fn(|axis| along(part[axis], place[axis])));
                let (places, exact): (Vec<[f64; 2]>, Vec<f64>) =
                    places.filter_map(|place| Some((place, path.trace(ray(place)).ok()?.1))).unzip();
                let found = shares(&path, &places, ray);
                let most = exact.iter().fold(0.0_f64, |most, share| most.max(*share));
                beams += usize::from(!exact.is_empty());
                fitted += usize::from(found != exact);
                let errors = found.iter().zip(&exact).map(|(found, exact)| ((found - exact) / most).abs());
                let mean = errors.clone().map(|error| error * error).sum::<f64>() / exact.len() as f64;
                let [mean, worst] = [mean.sqrt(), errors.fold(0.0, f64::max)];
                assert!(
                    exact.is_empty() || mean < GOAL && worst < 20.0 * GOAL,
                    "{name} {pair:?}: {mean} {worst}"
                );
            }
        }
        assert!(fitted > 50 && fitted < beams, "{fitted} of {beams}");
    }
}
