//! The thick and the thin lens in lanes: from principal plane to principal plane at equal height, the slope changed by
//! height/f (Kolb, Mitchell and Hanrahan 1995, §3.2), as [`FirstOrder::transfer`] has it for one ray.

use super::{
    arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
    body::{CameraBody, LaneBody},
    lanes::Job,
    tracer::Tracer,
};
use crate::{
    camera::ray::Sample,
    lens::first_order::FirstOrder,
    trace::kernel::{Approach, Available, Cpu, End, Grouping, Lanes, Optics, Start, run},
};

/// A camera with an ideal lens, in double precision.
pub(crate) struct IdealTracer {
    body: LaneBody<f64>,
    lens: IdealLens,
    simd: Available,
}

/// An ideal lens; what leaves it starts in the front vertex plane.
struct IdealLens {
    /// z of the principal plane on the film's side, mm.
    rear_plane: f64,
    /// z of the principal plane on the scene's side, mm.
    front_plane: f64,
    /// 1/f, 1/mm.
    power: f64,
    /// The square of the distance from the axis up to which the origin of a ray is a number to a host, mm².
    most: f64,
}

impl IdealTracer {
    pub fn new(lens: &FirstOrder, body: &CameraBody) -> Self {
        let reach = body.placement.reach() / body.units_per_mm;
        Self {
            body: body.lane_body(),
            lens: IdealLens {
                rear_plane: lens.rear_principal_plane,
                front_plane: lens.front_principal_plane,
                power: lens.focal_length.recip(),
                most: reach * reach,
            },
            simd: Available::best(),
        }
    }

    #[inline(always)]
    fn trace(&self, grouping: Grouping, samples: &impl SampleStore, rays: &mut impl RayStore) {
        run(self.simd, grouping, &self.lens, &mut Job::new(&self.body, samples, rays, None));
    }
}

impl Tracer for IdealTracer {
    fn one(&self, sample: &Sample, ray: &mut OneRay<'_>) {
        self.trace(Grouping::One, sample, ray);
    }

    fn four(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool {
        self.trace(Grouping::Quad, samples, rays);
        true
    }

    fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        self.trace(Grouping::of(samples.len()), samples, rays);
    }
}

impl IdealLens {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn one<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, start: Start<L>) -> (End<L>, L) {
        let Start::Flat { x, y, slopes: [sx, sy], cos2, .. } = start else {
            unreachable!("ideal lenses take rays from the film only");
        };
        let (power, to_vertex) = (L::splat(cpu, self.power), L::splat(cpu, -self.front_plane));
        let (sx, sy) = (x.neg_mul_add(power, sx), y.neg_mul_add(power, sy));
        let (x, y) = (to_vertex.mul_add(sx, x), to_vertex.mul_add(sy, y));
        let one = L::splat(cpu, 1.0);
        let norm = one / sy.mul_add(sy, sx.mul_add(sx, one)).sqrt();
        // What is no number is not less, either.
        let passed = y.mul_add(y, x * x).less_equal(L::splat(cpu, self.most));
        let end = End { origin: [x, y, L::splat(cpu, 0.0)], direction: [sx * norm, sy * norm, norm], passed };
        (end, cos2)
    }
}

impl Optics<f64> for IdealLens {
    #[inline(always)]
    fn approach(&self) -> Approach {
        Approach { entry: self.rear_plane, travel_sign: 1.0 }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn through<L: Lanes<Scalar = f64>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        starts: [Start<L>; U],
    ) -> [(End<L>, L); U] {
        let mut ended = [self.one(cpu, starts[0]); U];
        for u in 1..U {
            ended[u] = self.one(cpu, starts[u]);
        }
        ended
    }
}
