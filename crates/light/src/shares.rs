//! Remaining light of many rays along a path. A ray is given by its point in a beam; the result is the remaining share
//! of its power.
//!
//! A share is a smooth function of a ray's point in a beam. The light of some rays, spread over the beam, is traced
//! from surface to surface ([`LitPath::trace`]). A polynomial in the two coordinates of the point is fitted to their
//! shares, and gives the shares of the other rays. Further traced rays measure the error of the polynomial. If the
//! error is too large, the beam is split into halves, each with its own fit. If a beam has at most twice as many rays
//! as a fit needs, the light of every ray is traced.

use super::{coated::LitPath, sums::mix};
use realistic_optics::lens::Ray;
use realistic_trace::polynomial::LeastSquares;

/// Error, relative to the largest share in a beam, at which the degree of the polynomial suffices. It is less than a
/// step of a picture's colours. With a tenth of this error, the computation takes a third more time, and the power of a
/// spray is the same to four digits.
const GOAL: f64 = 1e-3;
/// Number of rays to which a polynomial is fitted, and number of rays that measure the error of the polynomial.
const PROBES: [usize; 2] = [80, 20];
/// The golden section: the fractional parts of its multiples are spread evenly, but without a pattern.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// The highest total degree of a polynomial.
const HIGHEST: usize = 7;
/// Number of monomials up to the highest total degree.
const TERMS: usize = (HIGHEST + 1) * (HIGHEST + 2) / 2;

/// Returns the remaining shares of the power of rays, which get through, along each of several similar paths: a list
/// per path, with a share per point. `ray` builds the ray at a point in the beam.
pub fn shares(paths: &[LitPath], points: &[[f64; 2]], ray: impl Fn([f64; 2]) -> Ray) -> Vec<Vec<f64>> {
    // The light is traced path by path, so that the tables of one path stay in the cache. A ray that is blocked
    // contrary to expectation has no light.
    let carried = |rays: &[usize]| -> Vec<Vec<f64>> {
        let along = |path: &LitPath| {
            let share = |i: &usize| path.trace(ray(points[*i])).map_or(0.0, |(_, share)| share);
            rays.iter().map(share).collect()
        };
        paths.iter().map(along).collect()
    };
    let mut shares = vec![vec![0.0; points.len()]; paths.len()];
    let mut beams: Vec<Vec<usize>> = vec![(0..points.len()).collect()];
    while let Some(mut beam) = beams.pop() {
        let [_, checked] = PROBES;
        let count = PROBES.iter().sum::<usize>();
        if beam.len() <= 2 * count {
            for (shares, carried) in shares.iter_mut().zip(carried(&beam)) {
                beam.iter().zip(carried).for_each(|(i, share)| shares[*i] = share);
            }
            continue;
        }
        let bounds = [0, 1].map(|axis| {
            let along = beam.iter().map(|i| points[*i][axis]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], at| [from.min(at), to.max(at)])
        });
        // Maps the bounds of the beam to [-1, 1].
        let scaled = |i: usize| -> [f64; 2] {
            std::array::from_fn(|axis| {
                let [from, to] = bounds[axis];
                if to > from { (2.0 * points[i][axis] - from - to) / (to - from) } else { 0.0 }
            })
        };
        // The probes are taken in golden-section steps: equal steps would hit the same columns in every row of cells.
        // One probe in five measures the error.
        let probes: Vec<usize> =
            (0..count).map(|k| beam[((k as f64 * GOLDEN).fract() * beam.len() as f64) as usize]).collect();
        let carried = carried(&probes);
        let probe = |(k, i): (usize, &usize)| ShareProbe {
            point: scaled(*i),
            shares: carried.iter().map(|along| along[k]).collect(),
        };
        let probes = probes
            .iter()
            .enumerate()
            .map(probe)
            .filter(|probe| probe.shares.iter().all(|share| *share > 0.0));
        let (checks, samples): (Vec<_>, Vec<_>) =
            probes.enumerate().partition(|(k, _)| k % (count / checked) == 2);
        let [checks, samples] =
            [checks, samples].map(|all| all.into_iter().map(|(_, probe)| probe).collect::<Vec<_>>());
        let most =
            samples.iter().flat_map(|probe| &probe.shares).fold(0.0_f64, |most, share| most.max(*share));
        if let Some(terms) = fit(&samples, &checks, GOAL * most) {
            let points: Vec<[f64; 2]> = beam.iter().map(|i| scaled(*i)).collect();
            let powers = monomials(&points, terms[0].len());
            for (shares, terms) in shares.iter_mut().zip(&terms) {
                let mut sums = Vec::new();
                mix(&mut sums, terms, powers.iter().map(Vec::as_slice));
                beam.iter().zip(sums).for_each(|(i, sum)| shares[*i] = sum.max(0.0));
            }
            continue;
        }
        let [width, height] = bounds.map(|[from, to]| to - from);
        let axis = usize::from(height > width);
        let middle = beam.len() / 2;
        beam.select_nth_unstable_by(middle, |a, b| points[*a][axis].total_cmp(&points[*b][axis]));
        beams.push(beam.split_off(middle));
        beams.push(beam);
    }
    shares
}

/// A point, and the share at that point along each path.
struct ShareProbe {
    point: [f64; 2],
    shares: Vec<f64>,
}

/// Fits polynomials to `samples` and returns their coefficients for each path. The degree is the lowest at which the
/// errors at `checks` are at most `error`; `None` if no degree suffices.
fn fit(samples: &[ShareProbe], checks: &[ShareProbe], error: f64) -> Option<Vec<Vec<f64>>> {
    let paths = samples.first()?.shares.len();
    let sides = (0..paths).map(|path| samples.iter().map(|probe| probe.shares[path]).collect());
    let mut equations = LeastSquares::new(sides.collect());
    let [powers, check_powers] = [samples, checks]
        .map(|probes| monomials(&probes.iter().map(|probe| probe.point).collect::<Vec<_>>(), TERMS));
    let (mut columns, mut count, mut sums) = (powers.into_iter(), 0, Vec::new());
    for degree in 0..=HIGHEST {
        for column in columns.by_ref().take(degree + 1) {
            equations.add(column).ok()?;
            count += 1;
        }
        let terms = equations.solve(count);
        let is_near = |(path, terms): (usize, &Vec<f64>)| {
            mix(&mut sums, terms, check_powers.iter().map(Vec::as_slice));
            sums.iter().zip(checks).all(|(sum, probe)| (sum - probe.shares[path]).abs() <= error)
        };
        if terms.iter().enumerate().all(is_near) {
            return Some(terms);
        }
    }
    None
}

/// Returns the first `count` monomials at all points, in ascending degree.
fn monomials(points: &[[f64; 2]], count: usize) -> Vec<Vec<f64>> {
    let mut all = vec![vec![1.0; points.len()]];
    let times = |column: &[f64], axis: usize| -> Vec<f64> {
        column.iter().zip(points).map(|(power, point)| power * point[axis]).collect()
    };
    for degree in 1.. {
        let below = all.len() - degree;
        for k in 0..=degree {
            if all.len() >= count {
                return all;
            }
            let column =
                if k < degree { times(&all[below + k], 0) } else { times(&all[below + degree - 1], 1) };
            all.push(column);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Surfaces;
    use realistic_optics::{
        lens::{Lens, refraction::Refraction},
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
                // The rays are those of a spray, over the part of the front surface from which rays get through.
                let grid = || (0..SIDE * SIDE).map(|i| [at(i % SIDE), at(i / SIDE)]);
                let mut part = [[1.0_f64, -1.0]; 2];
                for point in grid().filter(|point| path.trace(ray(*point)).is_ok()) {
                    for (own, at) in part.iter_mut().zip(point) {
                        *own = [own[0].min(at), own[1].max(at)];
                    }
                }
                let along = |[from, to]: [f64; 2], at: f64| f64::midpoint(from + to, at * (to - from));
                let points = grid().map(|point| std::array::from_fn(|axis| along(part[axis], point[axis])));
                let (points, exact): (Vec<[f64; 2]>, Vec<f64>) =
                    points.filter_map(|point| Some((point, path.trace(ray(point)).ok()?.1))).unzip();
                let [found] = &shares(std::slice::from_ref(&path), &points, ray)[..] else {
                    panic!("one path")
                };
                let most = exact.iter().fold(0.0_f64, |most, share| most.max(*share));
                beams += usize::from(!exact.is_empty());
                fitted += usize::from(*found != exact);
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
