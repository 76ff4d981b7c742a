//! The inverse of the warped pupil's map: film points and slopes in; whether the slopes lie within what is sampled there,
//! and the areas that such samples stand for, out.
//!
//! The map d -> C + M(direction of d) d takes half-lines to half-lines in their order, so that the two knots about a slope
//! are found by halving. Between them M is linear in the pseudo-angle, and so are the two components of the direction
//! before they are made a unit vector: the direction that goes to the slope's is the root of a quadratic equation.

use super::{LanePupil, Radius, Row, WarpedPupil, bend, product, slice::CELLS};
use crate::{
    numeric::Real,
    sampling::film_rays::FilmRays,
    trace::kernel::{Cpu, Lanes, Scalar},
};

impl WarpedPupil {
    /// Gives rays with slopes the area that such samples stand for, over π; NaN where none is sampled: outside the pupil's
    /// outline as it is tabulated, and where the film is dark. Vectors are halved side by side: each look-up waits for the one before.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn areas<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        rays: &mut [FilmRays<L>; U],
    ) {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let mut sought = [self.sought(cpu, constants, &rays[0]); U];
        for u in 1..U {
            sought[u] = self.sought(cpu, constants, &rays[u]);
        }
        // The last knot whose image lies before the slope, or on its way: images turn from the +x axis to the -x axis.
        let mut lows = [number(0.0); U];
        let mut step = (CELLS / 2) as f64;
        while step >= 1.0 {
            for u in 0..U {
                let Sought { row, slope, .. } = &sought[u];
                let middle = lows[u] + number(step);
                let [re, im, ..] = self.knots_from(row, L::add_places(middle.whole(), row.slice));
                let image = product([re, im], direction(cpu, middle));
                lows[u] = L::select(number(0.0).less_equal(cross(image, *slope)), middle, lows[u]);
            }
            step *= 0.5;
        }
        for u in 0..U {
            rays[u].area_per_pi = self.area(cpu, constants, &sought[u], lows[u], &rays[u]);
        }
    }

    /// Where in the table rays are, and their slopes in its frames.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sought<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        ray: &FilmRays<L>,
    ) -> Sought<L> {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let (zero, one) = (number(0.0), number(1.0));
        let radius = self.radius(cpu, constants, ray);
        let row = self.row(cpu, radius.place.whole(), &radius);
        // In the frame of the film point, mirrored into the upper half, and not yet narrowed. On the axis any frame will do.
        let ([px, py], [sx, sy]) = (ray.point, ray.slopes);
        let square = ray.radius_squared();
        let is_aside = L::splat(cpu, L::Scalar::NO_SQUARE).less(square);
        let height = L::select(is_aside, square.sqrt(), zero);
        let per_height = one / L::select(is_aside, height, one);
        let along = [L::select(is_aside, px * per_height, one), py * per_height];
        let narrowed = row.narrowing.neg_mul_add(square, one);
        let y = (sy * along[0] - sx * along[1]).abs();
        let aside = y * height;
        let bent = bend(row.bow, aside, square, one) * height;
        let x = (sx * along[0] + sy * along[1] - row.center * height - bent) / narrowed;
        Sought { radius, row, narrowed, slope: [x, y] }
    }

    /// The area by the knot before a slope.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn area<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        sought: &Sought<L>,
        low: L,
        ray: &FilmRays<L>,
    ) -> L {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let (zero, one) = (number(0.0), number(1.0));
        let Sought { radius, row, narrowed, slope: [x, y] } = *sought;
        let [re, im, re_next, im_next] = self.knots_from(&row, L::add_places(low.whole(), row.slice));
        let (m, dm) = ([re, im], [re_next - re, im_next - im]);
        let (d, ahead) = (direction(cpu, low), direction(cpu, low + one));
        let dd = [ahead[0] - d[0], ahead[1] - d[1]];
        // (M + o dM)(D + o dD) along (x, y), o in [0, 1].
        let (mixed, other) = (product(m, dd), product(dm, d));
        let mixed = [mixed[0] + other[0], mixed[1] + other[1]];
        let offset =
            root(cpu, [cross(product(m, d), [x, y]), cross(mixed, [x, y]), cross(product(dm, dd), [x, y])]);
        let [re, im] = [offset.mul_add(dm[0], m[0]), offset.mul_add(dm[1], m[1])];
        let [a, b] = [offset.mul_add(dd[0], d[0]), offset.mul_add(dd[1], d[1])];
        let size = re * re + im * im;
        // dq/dφ = (a² + b²)/(|a| + |b|)², and the directions have |a| + |b| = 1; a knot's step is 2/CELLS in q.
        let turn = (a * a + b * b) * number((CELLS / 2) as f64);
        let jacobian = turn.mul_add(re * dm[1] - im * dm[0], size);
        let is_inside = L::both((x * x + y * y).less_equal(size), zero.less(jacobian));
        let area = L::select(is_inside, jacobian * narrowed, number(f64::NAN));
        if L::all(radius.inside) {
            return area;
        }
        let beyond = if self.dark_beyond {
            number(f64::NAN)
        } else {
            constants.cover.areas(cpu, ray.point, ray.slopes)
        };
        L::select(radius.inside, area, beyond)
    }
}

/// What is known of rays before their slopes are found in the table.
#[derive(Clone, Copy)]
struct Sought<L: Lanes> {
    radius: Radius<L>,
    row: Row<L>,
    /// τ.
    narrowed: L,
    /// From the pupil's centre, in the frame of the film point, in the upper half, neither narrowed nor bent.
    slope: [L; 2],
}

/// The direction of a knot, of length 1 by the sum of its components' sizes.
#[cfg_attr(not(debug_assertions), inline(always))]
fn direction<L: Lanes>(cpu: Cpu<L>, knot: L) -> [L; 2] {
    let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
    let q = knot * number(2.0 / CELLS as f64);
    [number(1.0) - q, q.smaller(number(2.0) - q)]
}

/// The area of the parallelogram of two vectors, counterclockwise.
#[cfg_attr(not(debug_assertions), inline(always))]
fn cross<L: Lanes>([a, b]: [L; 2], [x, y]: [L; 2]) -> L {
    a * y - b * x
}

/// The root of a + b x + c x² in [0, 1], where it goes from one sign to the other; the nearer end where rounding leaves
/// none.
#[cfg_attr(not(debug_assertions), inline(always))]
fn root<L: Lanes>(cpu: Cpu<L>, [a, b, c]: [L; 3]) -> L {
    let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
    let (zero, one) = (number(0.0), number(1.0));
    let least = number(2.0) * L::splat(cpu, L::Scalar::NO_SQUARE);
    let discriminant = (a * c).neg_mul_add(number(4.0), b * b).larger(least).sqrt();
    let q = number(-0.5) * (b + L::select(b.less(zero), zero - discriminant, discriminant));
    // `smaller` and `larger` leave no NaN.
    let (x, y) = (a / q, q / c);
    let (near_x, near_y) = (x.larger(zero).smaller(one), y.larger(zero).smaller(one));
    let far = number(f64::from(f32::MAX));
    let (off_x, off_y) = ((x - near_x).abs().smaller(far), (y - near_y).abs().smaller(far));
    L::select(off_x.less_equal(off_y), near_x, near_y)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::{
        lens::{Lens, first_order::FirstOrder},
        prescription::catalogue,
        sampling::PupilDisk,
        trace::{
            Path,
            kernel::{OneLane, Portable},
        },
    };

    /// The area that one sample with these slopes stands for.
    fn area_at(pupil: &WarpedPupil, point: [f64; 2], slopes: [f64; 2]) -> Option<f64> {
        let [point, slopes] = [point, slopes].map(|pair| pair.map(|x| Portable([x])));
        let mut rays = [FilmRays { point, slopes, disk: slopes, area_per_pi: Portable([0.0]) }];
        pupil.areas(OneLane::cpu(), &pupil.lane_pupil(), &mut rays);
        let Portable([area_per_pi]) = rays[0].area_per_pi;
        (!area_per_pi.is_nan()).then_some(PI * area_per_pi)
    }

    #[test]
    fn the_inverse_finds_samples_with_their_area_alone() {
        for name in ["dgauss.50mm", "fisheye.10mm", "telephoto.250mm", "wide.22mm"] {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let film = FirstOrder::of(&lens).expect("not afocal").rear_focal_point - 0.5;
            let reach = 22.0;
            let cover = PupilDisk::rear(&lens, film, reach).expect("behind the lens");
            let shift = PupilDisk::exit(&lens, film).shift();
            let pupil = WarpedPupil::new(&Path::film_to_scene(&lens), film, reach, cover, shift);
            let mut sampled = 0;
            for i in 0..4000_u32 {
                let at = |step: f64| (0.5 + f64::from(i) * step).fract();
                let (radius, angle) =
                    (1.05 * reach * at(0.856_674_883_854_502_9), 6.3 * at(0.733_891_856_627_126));
                let (r, turn) = (at(0.628_706_721_037_808_7).sqrt(), 6.3 * at(0.538_597_257_225_901_9));
                let point = [radius * angle.cos(), radius * angle.sin()];
                let disk = [r * turn.cos(), r * turn.sin()];
                let Some(sample) = pupil.sample(point, disk) else {
                    assert_eq!(area_at(&pupil, point, [0.1, 0.1]), None, "{name} {point:?}");
                    continue;
                };
                sampled += 1;
                let area = area_at(&pupil, point, sample.slopes);
                let area = area.unwrap_or_else(|| panic!("{name} {point:?} {disk:?}: not found"));
                assert!((area / sample.area - 1.0).abs() < 1e-6, "{name} {point:?} {disk:?}: {area}");
                let beyond = pupil.sample(point, disk.map(|x| x / r * 1.00001)).expect("sampled there");
                assert_eq!(area_at(&pupil, point, beyond.slopes), None, "{name} {point:?} {disk:?}");
            }
            assert!(sampled > 1000, "{name}: {sampled}");
            for strange in [f64::NAN, f64::INFINITY, 1e300] {
                assert_eq!(area_at(&pupil, [strange, 0.0], [0.0; 2]), None);
                assert_eq!(area_at(&pupil, [0.0; 2], [strange, 0.0]), None);
            }
        }
    }
}
