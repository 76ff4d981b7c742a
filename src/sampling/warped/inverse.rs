//! The warped pupil the other way round: a film point and slopes in; whether they lie within what is sampled there, and
//! the area that such a sample stands for, out.
//!
//! The map d -> C + M(direction of d) d takes half-lines to half-lines in their order, so that the two knots about a slope
//! are found by halving. Between them M is linear in the pseudo-angle, and so are the two components of the direction
//! before they are made a unit vector: the direction that goes to the slope's is the root of a quadratic equation.

use std::f64::consts::PI;

use super::{FINE, Row, STRIDE, WarpedPupil, slice::CELLS};
use crate::{
    sampling::film_rays::FilmRays,
    trace::kernel::{Compiled, Lanes as _, OneLane, Portable, Simd},
};

/// What the table holds for a film radius.
struct Slice {
    center: f64,
    narrowing: f64,
    bow: f64,
    /// Where the slice below begins, and how far from it to the next one the film radius lies.
    first: usize,
    part: f64,
}

impl WarpedPupil {
    /// The area, slope², that a sample with these slopes at a film point, mm, stands for; `None` where none is sampled:
    /// outside the pupil's outline as it is tabulated, and where the film is dark.
    pub(crate) fn area_at(&self, film: [f64; 2], slopes: [f64; 2]) -> Option<f64> {
        let square = film[0] * film[0] + film[1] * film[1];
        if !(square.is_finite() && slopes.iter().all(|slope| slope.is_finite())) {
            return None;
        }
        let Some(slice) = self.slice_at(film) else {
            return if self.dark_beyond { None } else { self.cover.area_at(film, slopes) };
        };
        // In the frame of the film point, mirrored into the upper half, and not yet narrowed. On the axis any frame will do.
        let height = square.sqrt();
        let along = if height > 0.0 { film.map(|x| x / height) } else { [1.0, 0.0] };
        let [sx, sy] = slopes;
        let narrowed = 1.0 - slice.narrowing * square;
        let y = (sy * along[0] - sx * along[1]).abs();
        let bent = slice.bow * (y * height).powi(2) * height;
        let x = (sx * along[0] + sy * along[1] - slice.center * height - bent) / narrowed;
        let (radius_squared, area_per_pi) = self.on_disk(&slice, [x, y])?;
        (radius_squared <= 1.0).then_some(PI * area_per_pi * narrowed)
    }

    /// The slices about a film point, with the arithmetic of sampling; `None` beyond the table.
    fn slice_at(&self, film: [f64; 2]) -> Option<Slice> {
        let mut found = None;
        Simd::best().run(OneSlice { pupil: self, film, found: &mut found });
        found
    }

    /// M at a knot.
    fn factor(&self, slice: &Slice, knot: usize) -> [f64; 2] {
        let at = |place: usize| self.table[place + knot].map(f64::from);
        let (below, above) = (at(slice.first), at(slice.first + STRIDE));
        [0, 1].map(|i| below[i] + slice.part * (above[i] - below[i]))
    }

    /// The square of the radius on the unit disk of what goes to a point of the upper half, and the map's Jacobian there.
    fn on_disk(&self, slice: &Slice, z: [f64; 2]) -> Option<(f64, f64)> {
        let cross = |[a, b]: [f64; 2], [c, d]: [f64; 2]| a * d - b * c;
        let image = |knot: usize| product(self.factor(slice, knot), direction(knot));
        // The first knot beyond the slope; their images turn from the +x axis to the -x axis.
        let (mut low, mut high) = (0, CELLS);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if cross(image(middle), z) >= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (m, next) = (self.factor(slice, low), self.factor(slice, high));
        let (d, ahead) = (direction(low), direction(high));
        let step = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
        let (dm, dd) = (step(m, next), step(d, ahead));
        // (M + o dM)(D + o dD) along z, o in [0, 1].
        let mixed = [product(m, dd), product(dm, d)];
        let mixed = [mixed[0][0] + mixed[1][0], mixed[0][1] + mixed[1][1]];
        let offset = root(cross(product(m, d), z), cross(mixed, z), cross(product(dm, dd), z));
        let at = |from: [f64; 2], by: [f64; 2]| [from[0] + offset * by[0], from[1] + offset * by[1]];
        let ([re, im], [a, b]) = (at(m, dm), at(d, dd));
        let size = re * re + im * im;
        // dq/dφ = |d|²/(|a| + |b|)², and the directions have |a| + |b| = 1; a knot's step is 2/CELLS in q.
        let turn = (a * a + b * b) * (CELLS / 2) as f64;
        let jacobian = size + turn * (re * dm[1] - im * dm[0]);
        let found = ((z[0] * z[0] + z[1] * z[1]) / size, jacobian);
        (found.0.is_finite() && found.1 > 0.0).then_some(found)
    }
}

/// The direction of a knot, of length 1 by the sum of its components' sizes.
fn direction(knot: usize) -> [f64; 2] {
    let q = 2.0 * knot as f64 / CELLS as f64;
    [1.0 - q, if q <= 1.0 { q } else { 2.0 - q }]
}

/// The product of complex numbers.
fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

/// The root of a + b x + c x² in [0, 1], where it goes from one sign to the other; the nearer end where rounding leaves
/// none.
fn root(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = (b * b - 4.0 * a * c).max(0.0).sqrt();
    let q = -0.5 * (b + discriminant.copysign(b));
    let off = |x: f64| if x.is_finite() { (x - x.clamp(0.0, 1.0)).abs() } else { f64::INFINITY };
    let [x, y] = [a / q, q / c];
    let nearest = if off(x) <= off(y) { x } else { y };
    if nearest.is_finite() { nearest.clamp(0.0, 1.0) } else { 0.0 }
}

/// The slices about one film point by the processor's own fused multiplications.
struct OneSlice<'a> {
    pupil: &'a WarpedPupil,
    film: [f64; 2],
    found: &'a mut Option<Slice>,
}

impl Compiled for OneSlice<'_> {
    #[inline(always)]
    fn run(self) {
        let point = self.film.map(|x| Portable([x]));
        let disk = [Portable([1.0]), Portable([0.0])];
        let ray = FilmRays { point, disk, slopes: disk, area_per_pi: Portable([0.0]) };
        let radius = self.pupil.radius(OneLane::cpu(), &self.pupil.lane_pupil(), &ray);
        let Portable([s]) = radius.s;
        if !(s < FINE as f64) {
            return;
        }
        let row = self.pupil.row(OneLane::cpu(), radius.place.whole(), &radius);
        let Row {
            part: Portable([part]),
            center: Portable([center]),
            narrowing: Portable([narrowing]),
            bow: Portable([bow]),
            ..
        } = row;
        let Portable([place]) = radius.place;
        let first = self.pupil.cells[place as usize].index as usize;
        *self.found = Some(Slice { center, narrowing, bow, first, part });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lens::{Lens, first_order::FirstOrder},
        prescription::catalogue,
        sampling::PupilDisk,
        trace::Path,
    };

    #[test]
    fn what_was_sampled_is_found_again_with_its_area_and_nothing_beyond_it_is() {
        for name in ["dgauss.50mm", "fisheye.10mm", "telephoto.250mm", "wide.22mm"] {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let film = FirstOrder::of(&lens).expect("not afocal").rear_focal_point - 0.5;
            let reach = 22.0;
            let cover = PupilDisk::rear(&lens, film, reach).expect("behind the lens");
            let shift = PupilDisk::exit(&lens, film).seen_from([1.0, 0.0]).center[0];
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
                    assert_eq!(pupil.area_at(point, [0.1, 0.1]), None, "{name} {point:?}");
                    continue;
                };
                sampled += 1;
                let area = pupil.area_at(point, sample.slopes);
                let area = area.unwrap_or_else(|| panic!("{name} {point:?} {disk:?}: not found"));
                assert!((area / sample.area - 1.0).abs() < 1e-6, "{name} {point:?} {disk:?}: {area}");
                let beyond = pupil.sample(point, disk.map(|x| x / r * 1.00001)).expect("sampled there");
                assert_eq!(pupil.area_at(point, beyond.slopes), None, "{name} {point:?} {disk:?}");
            }
            assert!(sampled > 1000, "{name}: {sampled}");
            for strange in [f64::NAN, f64::INFINITY, 1e300] {
                assert_eq!(pupil.area_at([strange, 0.0], [0.0; 2]), None);
                assert_eq!(pupil.area_at([0.0; 2], [strange, 0.0]), None);
            }
        }
    }
}
