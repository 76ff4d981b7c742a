//! Polynomials in place of a kernel. They map film rays to rays behind the lens, and test whether apertures block a
//! ray.
//!
//! The code is written over the kernel's vectors. Every operation on these vectors is correctly rounded, so one ray and
//! many rays give the same bits.

use super::{
    fit::{AperturePolynomial, Polynomial},
    terms::{LaneScaling, sum},
};
use crate::kernel::{
    Approach, Arrays, End, Grouping, KernelScalar, LensRays, Optics, PlaneRays, Profile, Start, Traced,
    in_vectors, sides, trace_array,
};
use realistic_optics::trace::{ApertureTest, Aspheric, OutlineTest};
use realistic_simd::{Available, Cpu, Lanes};

/// A lens as polynomials. It traces rays as a [`Kernel`](crate::kernel::Kernel) does, one or many with the same bits.
///
/// A ray is blocked if it leaves the front surface outside the clear aperture, or passes one of the surfaces of
/// [`Polynomial::with_apertures`] outside that surface's aperture; other apertures are not tested. A value of this type
/// is immutable and may be shared between threads.
#[derive(Clone, Debug)]
pub struct PolynomialLens<S> {
    /// z of the film, lens space, mm.
    film: f64,
    degree: usize,
    /// A, B, C, D for each monomial.
    terms: Vec<[S; 4]>,
    apertures: Vec<FittedAperture<S>>,
    scaling: LaneScaling<S>,
    /// The front surface's curvature, and the square of its clear semi-diameter, mm².
    curvature: S,
    aperture: S,
    /// The profile of the front surface if it is an asphere, with the z axis along the direction of travel.
    profile: Option<Profile<S>>,
    simd: Available,
}

/// An aperture that rays are tested against.
#[derive(Clone, Debug)]
struct FittedAperture<S> {
    /// E and F for each monomial.
    terms: Vec<[S; 2]>,
    /// The tests of the apertures and obstructions inside the clear aperture.
    shapes: Vec<ApertureTest<S>>,
}

impl<S: KernelScalar> PolynomialLens<S> {
    /// Converts polynomials, with coefficients rounded to `S`.
    pub fn new(polynomial: &Polynomial) -> Self {
        let Polynomial { order, scaling, terms, front, apertures } = polynomial;
        let round = S::from_f64;
        Self {
            film: scaling.film,
            degree: (order - 1) / 2,
            terms: terms.iter().map(|term| term.map(round)).collect(),
            apertures: apertures
                .iter()
                .map(|AperturePolynomial { terms, shapes }| FittedAperture {
                    terms: terms.iter().map(|term| term.map(round)).collect(),
                    shapes: shapes.iter().map(|shape| ApertureTest::new(shape, 1.0)).collect(),
                })
                .collect(),
            scaling: scaling.lane_scaling(),
            curvature: round(front.curvature),
            aperture: round(front.semi_diameter.powi(2)),
            profile: front.figure.map(|figure| Profile::new(&Aspheric::new(&figure, false, front.n_film))),
            simd: Available::best(),
        }
    }

    /// Traces one ray from `point` (x, y in mm) on the film that the polynomials were fitted for, with slopes dx/dz
    /// and dy/dz; `None` if the lens blocks it.
    #[inline]
    pub fn trace_one(&self, point: [S; 2], slopes: [S; 2]) -> Option<Traced<S>> {
        let [traced] = trace_array(self.film, [point], [slopes], |from, to| {
            in_vectors(
                self.simd,
                Grouping::One,
                &mut Arrays { optics: self, from: Some(from), to, optical_path: None },
            );
        });
        traced
    }

    /// Traces many rays from the film that the polynomials were fitted for; `from.plane` is ignored. Origin and
    /// direction of a blocked ray are 0.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn trace_batch(&self, from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>) {
        let from = &PlaneRays { plane: self.film, ..*from };
        let n = from.checked_len();
        assert_eq!(n, to.checked_len(), "a batch needs as much room as it has rays");
        in_vectors(
            self.simd,
            Grouping::Wide,
            &mut Arrays { optics: self, from: Some(from), to, optical_path: None },
        );
    }

    /// Returns the proof that the processor has the instructions in use.
    pub fn available(&self) -> Available {
        self.simd
    }

    /// Returns the rays behind the lens for rays from the film, given as x, y and slopes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, point: [L; 2], slopes: [L; 2], cos2: L) -> End<L> {
        let [zero, one] = [L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE)];
        let two = one + one;
        let ([x, y], [px, py], [u, v, w]) = self.scaling.variables(cpu, point, slopes);
        let [[a, b, c, d]] = sum(cpu, &self.terms, self.degree, &[[u, v, w]]);
        let (ox, oy) = (b.mul_add(px, a * x), b.mul_add(py, a * y));
        let (qx, qy) = (d.mul_add(px, c * x), d.mul_add(py, c * y));
        let height = oy.mul_add(oy, ox * ox);
        let mut passed = height.less_equal(L::splat(cpu, self.aperture));
        let mut weight_root = cos2;
        for FittedAperture { terms, shapes } in &self.apertures {
            let [[e, f]] = sum(cpu, terms, self.degree, &[[u, v, w]]);
            let (rx, ry) = (f.mul_add(px, e * x), f.mul_add(py, e * y));
            passed = L::both(passed, ry.mul_add(ry, rx * rx).less_equal(one));
            for shape in shapes {
                let (power, limit) = sides(cpu, shape, [rx, ry], one);
                passed = L::both(passed, power.less_equal(limit));
                if let OutlineTest::Picture(_) = shape.outline {
                    weight_root = weight_root * limit.sqrt();
                }
            }
        }
        let bent = L::splat(cpu, self.curvature) * height;
        let root = (L::splat(cpu, self.curvature).neg_mul_add(bent, one)).sqrt();
        let oz = match &self.profile {
            None => zero - bent / (one + root),
            Some(profile) => profile.height(cpu, height),
        };
        let scale = two / qy.mul_add(qy, qx.mul_add(qx, one));
        // Rays with a NaN are blocked, too.
        passed = L::both(passed, oz.less_equal(oz));
        passed = L::both(passed, scale.less_equal(two));
        End {
            origin: [ox.or_zero(passed), oy.or_zero(passed), oz.or_zero(passed)],
            direction: [
                (qx * scale).or_zero(passed),
                (qy * scale).or_zero(passed),
                (scale - one).or_zero(passed),
            ],
            passed,
            weight_root,
            left: one,
        }
    }
}

impl<S: KernelScalar> Optics<S> for PolynomialLens<S> {
    /// Rays that are already behind the lens.
    type OnWay<L: Lanes<Scalar = S>> = End<L>;
    type State<L: Lanes<Scalar = S>> = ();

    #[inline(always)]
    fn approach(&self) -> Approach {
        Approach { entry: self.film, travel_sign: 1.0 }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, _: L, start: Start<L>) -> (End<L>, ()) {
        let Start::Flat { x, y, slopes, cos2, .. } = start else {
            unreachable!("polynomials take rays from the film only");
        };
        (self.lanes(cpu, [x, y], slopes, cos2), ())
    }

    #[inline(always)]
    fn leave<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, rays: End<L>, (): &()) -> End<L> {
        rays
    }
}
