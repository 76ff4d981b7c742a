//! Many rays at once through the polynomials, in as many lanes as the processor has.

use super::{Frame, Fused, Polynomial, terms::sum};
use crate::trace::{Ray, Real};

/// Rays as columns, each as long as the others.
#[derive(Clone, Debug, PartialEq)]
pub struct RayColumns<R> {
    /// Positions x, y, mm, and for what leaves a lens z too.
    pub position: [Vec<R>; 3],
    /// Slopes dx/dz, dy/dz for what comes from the film; unit directions for what leaves a lens.
    pub direction: [Vec<R>; 3],
}

impl<R> Default for RayColumns<R> {
    fn default() -> Self {
        Self { position: [const { Vec::new() }; 3], direction: [const { Vec::new() }; 3] }
    }
}

impl<R: Real> RayColumns<R> {
    /// Positions and slopes of rays in the film plane (z, mm).
    pub fn at_film(rays: &[Ray], film: f64) -> Self {
        let mut columns = Self::default();
        for ray in rays {
            let (point, slopes) = Frame::at_film(ray, film);
            for axis in 0..2 {
                columns.position[axis].push(R::from_f64(point[axis]));
                columns.direction[axis].push(R::from_f64(slopes[axis]));
            }
        }
        columns
    }

    /// One of the rays that leave a lens.
    pub fn ray(&self, index: usize) -> Ray {
        Ray {
            origin: [0, 1, 2].map(|axis| self.position[axis][index].to_f64()),
            direction: [0, 1, 2].map(|axis| self.direction[axis][index].to_f64()),
        }
    }
}

/// Polynomials made ready for batches in numbers of type `R`.
#[derive(Clone, Debug)]
pub struct PolynomialBatch<R> {
    degree: usize,
    terms: Vec<[R; 4]>,
    film_scale: R,
    pupil_scale: R,
    vergence: R,
    curvature: R,
}

/// An expression in every lane. A loop and no closure: closures do not take on the vector units of the function
/// that they stand in, and are then called lane by lane.
macro_rules! each {
    ($lane:ident, $value:expr) => {{
        let mut all = [R::ZERO; L];
        for $lane in 0..L {
            all[$lane] = $value;
        }
        all
    }};
}

/// One group of lanes: film x, y and slopes in, position and direction out.
type Inputs<R, const L: usize> = [[R; L]; 4];
type Outputs<R, const L: usize> = [[R; L]; 6];

impl<R: Fused> PolynomialBatch<R> {
    /// Rounds the coefficients to `R`.
    pub fn new(polynomial: &Polynomial) -> Self {
        let frame = polynomial.frame;
        Self {
            degree: (polynomial.order - 1) / 2,
            terms: polynomial.terms.iter().map(|term| term.map(R::from_f64)).collect(),
            film_scale: R::from_f64(frame.film_scale),
            pupil_scale: R::from_f64(frame.pupil_scale),
            vergence: R::from_f64(frame.vergence),
            curvature: R::from_f64(polynomial.front.curvature),
        }
    }

    #[inline(always)]
    fn lanes<const L: usize, const FUSED: bool>(&self, [x, y, sx, sy]: &Inputs<R, L>) -> Outputs<R, L> {
        let (one, two) = (R::ONE, R::from_f64(2.0));
        let px = each!(i, (sx[i] + self.vergence * x[i]) * self.pupil_scale);
        let py = each!(i, (sy[i] + self.vergence * y[i]) * self.pupil_scale);
        let x = each!(i, x[i] * self.film_scale);
        let y = each!(i, y[i] * self.film_scale);
        let u = each!(i, two * (x[i] * x[i] + y[i] * y[i]) - one);
        let v = each!(i, x[i] * px[i] + y[i] * py[i]);
        let w = each!(i, two * (px[i] * px[i] + py[i] * py[i]) - one);
        let [a, b, c, d] = sum::<R, L, FUSED>(&self.terms, self.degree, [&u, &v, &w]);
        let ox = each!(i, a[i] * x[i] + b[i] * px[i]);
        let oy = each!(i, a[i] * y[i] + b[i] * py[i]);
        let qx = each!(i, c[i] * x[i] + d[i] * px[i]);
        let qy = each!(i, c[i] * y[i] + d[i] * py[i]);
        let oz = each!(i, {
            let h = ox[i] * ox[i] + oy[i] * oy[i];
            let inside = one - self.curvature * self.curvature * h;
            let root = if inside > R::ZERO { inside.sqrt() } else { R::ZERO };
            -self.curvature * h / (one + root)
        });
        let scale = each!(i, two / (one + qx[i] * qx[i] + qy[i] * qy[i]));
        [ox, oy, oz, each!(i, qx[i] * scale[i]), each!(i, qy[i] * scale[i]), each!(i, scale[i] - one)]
    }

    #[inline(always)]
    fn groups<const L: usize, const FUSED: bool>(&self, film: &RayColumns<R>, out: &mut RayColumns<R>) {
        let count = film.position[0].len();
        let columns = [&film.position[0], &film.position[1], &film.direction[0], &film.direction[1]];
        for start in (0..count).step_by(L) {
            let take = L.min(count - start);
            let mut inputs: Inputs<R, L> = [[R::ZERO; L]; 4];
            for (lanes, column) in inputs.iter_mut().zip(columns) {
                lanes[..take].copy_from_slice(&column[start..start + take]);
            }
            let outputs = self.lanes::<L, FUSED>(&inputs);
            let targets = out.position.iter_mut().chain(&mut out.direction);
            for (target, lanes) in targets.zip(&outputs) {
                target[start..start + take].copy_from_slice(&lanes[..take]);
            }
        }
    }

    /// The scene-side rays of rays at the film plane. `out` takes the length of `film`.
    pub fn transfer(&self, film: &RayColumns<R>, out: &mut RayColumns<R>) {
        let count = film.position[0].len();
        for column in out.position.iter_mut().chain(&mut out.direction) {
            column.resize(count, R::ZERO);
        }
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f") {
                // SAFETY: the processor has just said that it has the features.
                return unsafe { self.with_avx512(film, out) };
            }
            if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                // SAFETY: as above.
                return unsafe { self.with_avx2(film, out) };
            }
        }
        self.groups::<4, false>(film, out);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,fma")]
    fn with_avx512(&self, film: &RayColumns<R>, out: &mut RayColumns<R>) {
        if size_of::<R>() == 4 {
            self.groups::<16, true>(film, out);
        } else {
            self.groups::<8, true>(film, out);
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn with_avx2(&self, film: &RayColumns<R>, out: &mut RayColumns<R>) {
        if size_of::<R>() == 4 {
            self.groups::<8, true>(film, out);
        } else {
            self.groups::<4, true>(film, out);
        }
    }
}
