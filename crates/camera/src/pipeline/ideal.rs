//! The thick and the thin lens in lanes. A ray continues from principal plane to principal plane at equal
//! height, and its slope changes by height/f (Kolb, Mitchell and Hanrahan 1995, §3.2), as in
//! [`FirstOrder::transfer`] for one ray. One matrix combines the way from the film, the refraction, and the
//! way to the front vertex plane.

use std::sync::Arc;

use super::{body::CameraBody, lanes::Pipeline, tracer::Tracer};
use realistic_optics::lens::first_order::FirstOrder;
use realistic_simd::{Available, Cpu, Lanes};
use realistic_trace::kernel::{Approach, End, Optics, Start};

/// Returns the tracer of an ideal lens, in single precision: two sums of two products per ray.
pub fn ideal_tracer(lens: &FirstOrder, body: &CameraBody) -> Arc<dyn Tracer> {
    let film_z = body.film_side.z;
    let [height, slope] = lens.from_film(film_z);
    let lens = IdealLens {
        film_z,
        height: height.map(|number| number as f32),
        slope: slope.map(|number| number as f32),
    };
    Arc::new(Pipeline::new(body.lane_body(), lens, Available::best()))
}

/// The ray-transfer matrix from the film to the front vertex plane, and the film. The coefficients are computed in
/// double precision, so that single precision adds no avoidable rounding.
struct IdealLens {
    film_z: f64,
    /// Coefficients from height and from slope (mm) to the resulting height.
    height: [f32; 2],
    /// Coefficients from height (1/mm) and from slope to the resulting slope.
    slope: [f32; 2],
}

impl Optics<f32> for IdealLens {
    /// Rays that have already passed the lens.
    type OnWay<L: Lanes<Scalar = f32>> = End<L>;
    type State<L: Lanes<Scalar = f32>> = ();

    #[inline(always)]
    fn approach(&self) -> Approach {
        Approach { entry: self.film_z, travel_sign: 1.0 }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, _: L, start: Start<L>) -> (End<L>, ()) {
        let Start::Flat { x, y, slopes: [sx, sy], cos2, .. } = start else {
            unreachable!("ideal lenses take rays from the film only");
        };
        let [a, b] = self.height;
        let (a, b) = (L::splat(cpu, a), L::splat(cpu, b));
        let [c, d] = self.slope;
        let (c, d) = (L::splat(cpu, c), L::splat(cpu, d));
        let origin = [x.mul_add(a, sx * b), y.mul_add(a, sy * b), L::splat(cpu, 0.0)];
        let (sx, sy) = (x.mul_add(c, sx * d), y.mul_add(c, sy * d));
        let one = L::splat(cpu, 1.0);
        let norm = one / sy.mul_add(sy, sx.mul_add(sx, one)).sqrt();
        let end = End {
            origin,
            direction: [sx * norm, sy * norm, norm],
            passed: one.less_equal(one),
            weight_root: cos2,
            left: one,
        };
        (end, ())
    }

    #[inline(always)]
    fn leave<L: Lanes<Scalar = f32>>(&self, _: Cpu<L>, rays: End<L>, (): &()) -> End<L> {
        rays
    }
}
