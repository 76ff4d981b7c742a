//! Rays in double precision and from any origin through the kernel, as programs supply them.
//!
//! A camera passes rays from its film to the kernel, in the kernel's own precision. The rays here may start far away.
//! They are first moved near the lens, so that the kernel's precision is spent on the lens and not on the distance.

use realistic_base::numeric::unit;
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    trace::{Blocked, Direction, Path, Ray, Real},
};
use realistic_simd::Simd;
use realistic_trace::kernel::{Kernel, KernelScalar, PlaneRays, RayBuffer, Traced};

/// Squared cosine of a ray's angle to the axis. If the square is smaller, the ray meets the first vertex plane too far
/// from the axis to start there.
const STEEP: f64 = 0.01;

/// A compiled lens that traces single [`Ray`]s.
#[derive(Clone, Debug)]
pub struct KernelRays<S> {
    kernel: Kernel<S>,
    path: Path<f64>,
    /// z of the first vertex, lens space, mm.
    entry: f64,
    /// 1 for travel toward +z, -1 for travel toward -z.
    travel_sign: f64,
    /// Distance before the first vertex plane at which distant rays start, mm.
    near: f64,
}

/// A ray from a plane perpendicular to the axis.
#[derive(Clone, Copy, Debug)]
struct FromPlane {
    plane: f64,
    point: [f64; 2],
    slopes: [f64; 2],
}

impl<S: KernelScalar + Real> KernelRays<S> {
    /// Compiles a lens for the given instructions; `None` if the processor lacks them.
    pub fn new(lens: &Lens, direction: Direction, simd: Simd) -> Option<Self> {
        let kernel = Kernel::with_simd(lens, direction, simd)?;
        let (first, travel_sign) = match direction {
            Direction::FilmToScene => (lens.rear(), 1.0),
            Direction::SceneToFilm => (lens.front(), -1.0),
        };
        let path = Path::new(lens, direction, Refraction::Fused);
        // The start lies in front of the whole surface: an asphere that is concave toward the light may be deeper than
        // wide.
        let [low, high] = first.sagitta_range();
        let depth = if travel_sign > 0.0 { -low } else { high };
        let near = first.semi_diameter.max(1.001 * depth);
        Some(Self { kernel, path, entry: first.vertex, travel_sign, near })
    }

    /// Traces one ray as a camera does, and returns it with a unit direction in double precision; `None` if it
    /// is blocked.
    pub fn one(&self, ray: Ray) -> Option<Ray> {
        match self.on_plane(&ray) {
            Some(FromPlane { plane, point, slopes }) => {
                self.kernel.trace_one(plane, narrow(point), narrow(slopes)).map(widen)
            }
            None => self.in_place(&[ray])[0],
        }
    }

    /// Traces many rays in batches, one per starting plane.
    pub fn batch(&self, rays: &[Ray]) -> Vec<Option<Ray>> {
        let mut out = vec![None; rays.len()];
        let mut anywhere = Vec::new();
        let mut planes: Vec<(f64, Vec<(usize, FromPlane)>)> = Vec::new();
        for (number, ray) in rays.iter().enumerate() {
            match self.on_plane(ray) {
                None => anywhere.push(number),
                Some(start) => match planes.iter_mut().find(|(plane, _)| *plane == start.plane) {
                    Some((_, starts)) => starts.push((number, start)),
                    None => planes.push((start.plane, vec![(number, start)])),
                },
            }
        }
        for (plane, starts) in planes {
            let column = |of: &dyn Fn(&FromPlane) -> f64| -> Vec<S> {
                starts.iter().map(|(_, start)| S::from_f64(of(start))).collect()
            };
            let [x, y] = [0, 1].map(|i| column(&|start| start.point[i]));
            let [slope_x, slope_y] = [0, 1].map(|i| column(&|start| start.slopes[i]));
            let from = PlaneRays { plane, x: &x, y: &y, slope_x: &slope_x, slope_y: &slope_y };
            let mut columns = RayBuffer::new(starts.len());
            self.kernel.trace_batch(&from, &mut columns.rays());
            for (i, (number, _)) in starts.iter().enumerate() {
                out[*number] = columns.get(i).map(widen);
            }
        }
        let rest: Vec<Ray> = anywhere.iter().map(|&number| rays[number]).collect();
        for (number, ray) in anywhere.into_iter().zip(self.in_place(&rest)) {
            out[number] = ray;
        }
        out
    }

    /// Traces many rays in one batch, each from its own origin.
    pub fn in_place(&self, rays: &[Ray]) -> Vec<Option<Ray>> {
        let mut columns = RayBuffer::new(rays.len());
        for (i, ray) in rays.iter().enumerate() {
            let Ray { origin, direction } = self.near(ray);
            columns.put(i, origin, direction);
        }
        self.kernel.trace_in_place(&mut columns.rays());
        (0..rays.len()).map(|i| columns.get(i).map(widen)).collect()
    }

    /// Returns the reason why a ray is blocked.
    pub fn reason(&self, ray: Ray) -> Blocked {
        self.kernel.reason(ray)
    }

    /// Returns the ray as one from a plane: the plane through the ray's own origin, or a plane near the lens for a
    /// distant ray. `None` if the ray travels along the first vertex plane, or away from it.
    fn on_plane(&self, ray: &Ray) -> Option<FromPlane> {
        let travel_sign = self.travel_sign;
        let direction = unit(ray.direction);
        let slopes = [direction[0] / direction[2], direction[1] / direction[2]];
        let (entry, _) = self.path.to_entry(*ray);
        let before = travel_sign * (self.entry - ray.origin[2]);
        let along = travel_sign * direction[2];
        // The ray starts on the vertex plane, or travels toward it.
        if !(along > 0.0 && along * along > STEEP && (entry[2] == 0.0 || before <= self.near)) {
            return None;
        }
        if before <= self.near {
            let [x, y, plane] = ray.origin;
            return Some(FromPlane { plane, point: [x, y], slopes });
        }
        let back = -travel_sign * self.near;
        let point = [0, 1].map(|i| entry[i] + back * slopes[i]);
        Some(FromPlane { plane: self.entry + back, point, slopes })
    }

    /// Moves the origin of a distant ray near the lens.
    fn near(&self, ray: &Ray) -> Ray {
        let travel_sign = self.travel_sign;
        let direction = unit(ray.direction);
        let (entry, moved) = self.path.to_entry(*ray);
        let size = entry.iter().map(|x| x * x).sum::<f64>().sqrt() + self.near;
        // A NaN is left as it is, and the ray is blocked.
        if !(moved > 4.0 * size) {
            return Ray { direction, ..*ray };
        }
        let [x, y, z] = entry;
        let at = [x, y, self.entry + travel_sign * z];
        Ray { origin: [0, 1, 2].map(|i| at[i] - 2.0 * size * direction[i]), direction }
    }
}

fn narrow<S: Real>(pair: [f64; 2]) -> [S; 2] {
    pair.map(S::from_f64)
}

fn widen<S: Real>(traced: Traced<S>) -> Ray {
    let Ray { origin, direction } = traced.ray();
    Ray { origin, direction: unit(direction) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    /// Returns rays from both sides, near and far, some of which are blocked.
    fn rays(lens: &Lens, direction: Direction) -> Vec<Ray> {
        let (first, travel_sign) = match direction {
            Direction::FilmToScene => (lens.rear(), 1.0),
            Direction::SceneToFilm => (lens.front(), -1.0),
        };
        let at = |i: i32, n: i32| f64::from(i * n % 101) / 50.0 - 1.0;
        (0..400)
            .map(|i| {
                let distance = [0.8, 3.0, 3.0, 1e3, 1e7][i as usize % 5] * first.semi_diameter;
                let target = [at(i, 13) * first.semi_diameter, at(i, 37) * first.semi_diameter];
                let from = [0.2 * distance * at(i, 7), 0.2 * distance * at(i, 59)];
                let origin = [from[0], from[1], first.vertex - travel_sign * distance];
                let direction = [target[0] - from[0], target[1] - from[1], travel_sign * distance];
                Ray { origin, direction }
            })
            .collect()
    }

    #[test]
    fn every_entry_agrees_with_the_walk_to_its_precision() {
        fn check<S: KernelScalar + Real>(bound: f64) {
            let mut passed = 0;
            for name in catalogue::round() {
                let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
                for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
                    let rays = rays(&lens, direction);
                    let path = Path::<f64>::new(&lens, direction, Refraction::Fused);
                    let traced =
                        KernelRays::<S>::new(&lens, direction, Simd::Portable).expect("always there");
                    let ones: Vec<_> = rays.iter().map(|&ray| traced.one(ray)).collect();
                    assert_eq!(traced.batch(&rays), ones, "{name}");
                    for outcomes in [ones, traced.in_place(&rays)] {
                        for (ray, got) in rays.iter().zip(outcomes) {
                            let exact = path.trace(*ray);
                            // None of these rays passes so near an edge that the kernel and the reference may disagree
                            // because of rounding.
                            assert_eq!(got.is_some(), exact.is_ok(), "{name} {ray:?}");
                            let (Ok(exact), Some(got)) = (exact, got) else { continue };
                            passed += 1;
                            for i in 0..3 {
                                let error = (got.direction[i] - exact.direction[i]).abs();
                                assert!(error < bound, "{name} {ray:?}: {error}");
                                let error = (got.origin[i] - exact.origin[i]).abs();
                                assert!(error < 100.0 * bound, "{name} {ray:?}: {error}");
                            }
                        }
                    }
                }
            }
            assert!(passed > 1000, "{passed}");
        }
        check::<f64>(1e-12);
        check::<f32>(1e-5);
    }
}
