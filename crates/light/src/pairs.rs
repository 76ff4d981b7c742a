//! Pairs of reflecting surfaces, and first-order estimates of their light on the film. k surfaces have k (k - 1)/2
//! pairs; if not all pairs can be traced, the estimates decide which are.

use super::coated::{Pair, Surfaces};
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    trace::{Direction, Path},
};

/// All pairs of a lens.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    /// The surfaces that reflect, counted from the scene.
    reflecting: Vec<u16>,
}

/// A pair with an estimate of the light that it sends to the middle of the film.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    pub light: f32,
    pair: [u16; 2],
}

impl Estimate {
    /// Returns the two surfaces.
    pub fn pair(&self) -> Pair {
        self.pair.map(usize::from)
    }
}

/// Cosines of incidence over which reflectances are averaged, because a coating may reflect nothing at a single angle.
const COSINES: [f64; 2] = [1.0, 0.85];

impl Pairs {
    /// Returns the pairs of a lens with these surfaces.
    pub fn of(surfaces: &Surfaces) -> Self {
        Self { reflecting: surfaces.reflecting().into_iter().map(|surface| surface as u16).collect() }
    }

    /// Returns the number of pairs.
    pub fn count(&self) -> usize {
        self.reflecting.len() * self.reflecting.len().saturating_sub(1) / 2
    }

    /// Returns the pair at an index below the count. The first pair consists of the first two surfaces; the next pairs
    /// consist of the third surface and each surface before it, and so on.
    pub fn nth(&self, number: usize) -> Pair {
        let before = |far: usize| far * (far - 1) / 2;
        let mut far = (f64::midpoint(1.0, (1.0 + 8.0 * number as f64).sqrt()) as usize).max(1);
        while before(far) > number {
            far -= 1;
        }
        while before(far + 1) <= number {
            far += 1;
        }
        [number - before(far), far].map(|at| self.reflecting[at].into())
    }

    /// Returns all pairs, the brightest first, by the light that a uniform sky sends along them to the middle of a film
    /// at z = `film`.
    ///
    /// The estimate is the product of the two reflectances and the square of the slope, at the film, of the widest
    /// paraxial ray. After the second mirror only the apertures of the stop and of the front surface are tested, so
    /// that a pair takes no more time in a lens with more surfaces.
    pub fn brightest(&self, lens: &Lens, surfaces: &Surfaces, film: f64) -> Vec<Estimate> {
        let path = Path::new(lens, Direction::FilmToScene, Refraction::Fused);
        let steps = path.steps();
        let last = steps.len() - 1;
        let reflectance = |along: usize| {
            let boundary = surfaces.boundary(last - along);
            let sum: f64 =
                COSINES.map(|cosine| boundary.share(steps[along].n, cosine, true).mean()).iter().sum();
            if boundary.is_none() { 0.0 } else { sum / COSINES.len() as f64 }
        };
        let reflectances: Vec<f64> = (0..=last).map(reflectance).collect();
        let power = |along: usize| (steps[along].n_after - steps[along].n) * steps[along].curvature;
        let semi = |along: usize| steps[along].aperture.sqrt();
        // The height of a ray at an aperture is a y + b ν, where y is its height and ν is n times its slope, just
        // behind an earlier surface. Each row is [a, b] for one of the surfaces before the aperture.
        let rows_to = |aperture: usize| {
            let (mut rows, mut row) = (vec![[0.0_f64; 2]; aperture], [1.0_f64, 0.0]);
            for along in (0..aperture).rev() {
                let [a, b] = row;
                let reduced = steps[along + 1].distance / steps[along + 1].n;
                rows[along] = [a, a.mul_add(reduced, b)];
                let [a, b] = rows[along];
                row = [(-b).mul_add(power(along), a), b];
            }
            rows
        };
        let apertures: Vec<(usize, Vec<[f64; 2]>)> = lens
            .stop_index()
            .map(|stop| last - stop)
            .filter(|stop| *stop < last)
            .into_iter()
            .chain([last])
            .map(|along| (along, rows_to(along)))
            .collect();
        let narrowed = |widest: f64, along: usize, y: f64| widest.min(semi(along) / y.abs());
        let mut found = Vec::with_capacity(self.count());
        // The ray from the middle of the film with slope 1 is traced to the first mirror.
        let (mut onward, mut widest) = ([lens.rear().vertex - film, steps[0].n], f64::INFINITY);
        for first in 0..=last {
            let [y, v] = onward;
            widest = narrowed(widest, first, y);
            if reflectances[first] > 0.0 {
                let ([mut y, mut v], mut widest) =
                    ([y, (2.0 * steps[first].n * steps[first].curvature).mul_add(y, v)], widest);
                for second in (0..first).rev() {
                    let n = steps[second + 1].n;
                    y = (steps[second + 1].distance / n).mul_add(v, y);
                    widest = narrowed(widest, second, y);
                    if reflectances[second] > 0.0 {
                        let v = (-2.0 * n * steps[second].curvature).mul_add(y, v);
                        let after = apertures.iter().filter(|(along, _)| *along > second);
                        let most = after.fold(widest, |widest, (along, rows)| {
                            let [a, b] = rows[second];
                            narrowed(widest, *along, a.mul_add(y, b * v))
                        });
                        let light = reflectances[first] * reflectances[second] * most.min(1.0).powi(2);
                        let light = if light.is_finite() { light as f32 } else { 0.0 };
                        found.push(Estimate {
                            light,
                            pair: [last - first, last - second].map(|at| at as u16),
                        });
                    }
                    v = (-y).mul_add(power(second), v);
                }
            }
            let v = (-y).mul_add(power(first), v);
            if first < last {
                let next = &steps[first + 1];
                onward = [(next.distance / next.n).mul_add(v, y), v];
            }
        }
        found.sort_by(|a, b| b.light.total_cmp(&a.light));
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::{
        lens::film_ray,
        prescription::{Coating, catalogue},
        trace::FoldedPaths,
    };

    #[test]
    fn every_number_is_a_pair_of_its_own() {
        let lens = Lens::at_d_line(&catalogue::find("zoom.24-70mm").expect("listed"));
        let surfaces = Surfaces::new(&lens, Coating::Bare);
        let pairs = Pairs::of(&surfaces);
        let mut all: Vec<Pair> = (0..pairs.count()).map(|number| pairs.nth(number)).collect();
        assert!(all.iter().all(|[near, far]| near < far));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), pairs.count());
        let mut estimated: Vec<Pair> =
            pairs.brightest(&lens, &surfaces, -40.0).iter().map(Estimate::pair).collect();
        estimated.sort_unstable();
        assert_eq!(all, estimated);
    }

    #[test]
    fn an_estimate_is_the_slope_of_the_widest_ray_near_the_axis() {
        // Apertures that are reduced to a thousandth keep rays where first-order optics holds.
        let mut lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("listed"));
        lens.surfaces.iter_mut().for_each(|surface| surface.semi_diameter *= 1e-3);
        let surfaces = Surfaces::new(&lens, Coating::Bare);
        let film = lens.rear().vertex - 36.0;
        let paths = FoldedPaths::new(&lens, Direction::FilmToScene, Refraction::Fused);
        let last = lens.surfaces.len() - 1;
        let mut equal = 0;
        let all = Pairs::of(&surfaces).brightest(&lens, &surfaces, film);
        for estimate in &all {
            let [near, far] = estimate.pair();
            let path = paths.path(Some([last - far, last - near]));
            let passes = |slope: f64| path.trace(film_ray([0.0; 2], film, [slope, 0.0])).is_ok();
            let power: f64 = [near, far]
                .map(|at| {
                    let own = surfaces.boundary(at);
                    let n = lens.surfaces[at].n_film;
                    COSINES.map(|cosine| own.share(n, cosine, true).mean()).iter().sum::<f64>() / 2.0
                })
                .iter()
                .product();
            let slope = (f64::from(estimate.light) / power).sqrt();
            // No wider ray gets through. For most pairs, the apertures that are not tested block no narrower ray.
            assert!(!passes(1.001 * slope), "{near} {far}: {slope}");
            equal += usize::from(passes(0.999 * slope));
        }
        assert!(2 * equal > all.len(), "{equal} of {}", all.len());
    }
}
