//! Methods for rays of any origin. A method prepares a lens and a direction of travel as a tracer. For each ray in lens
//! space, the tracer returns the ray that leaves the lens; or, if the ray is blocked, the ray at the point where it is
//! blocked, and the reason.

use realistic_base::numeric::unit;
use realistic_optics::{
    lens::{Lens, LensError, first_order::FirstOrder, refraction::Refraction},
    trace::{Blocked, Direction, Path, Ray, Real},
};
use realistic_simd::Simd;
use realistic_trace::kernel::KernelScalar;

use super::list::{Algorithm, Method, Number};
use crate::{reference::DoubleDouble, subject::kernel_rays::KernelRays};

/// A lens prepared for one method.
pub trait Tracer: Send + Sync {
    /// Traces a ray as far as it gets, and returns the reason if it is blocked.
    fn one(&self, ray: Ray) -> (Ray, Option<Blocked>);

    /// Traces rays; `None` for blocked ones.
    fn all(&self, rays: &[Ray]) -> Vec<Option<Ray>> {
        let passed = |(ray, blocked): (Ray, Option<Blocked>)| blocked.is_none().then_some(ray);
        rays.iter().map(|&ray| passed(self.one(ray))).collect()
    }
}

/// Prepares a lens for a method; `None` if the processor lacks the instructions, or if the method traces only rays from
/// a film.
///
/// # Errors
/// The method is first-order optics and the lens has no focal length.
pub fn tracer(
    method: &Method,
    lens: &Lens,
    direction: Direction,
) -> Result<Option<Box<dyn Tracer>>, LensError> {
    match (method.number, method.algorithm) {
        (Number::F32, algorithm) => tracer_in::<f32>(algorithm, lens, direction),
        (Number::DoubleDouble, Algorithm::Walk(refraction)) => {
            Ok(Some(walk::<DoubleDouble>(lens, direction, refraction)))
        }
        (_, algorithm) => tracer_in::<f64>(algorithm, lens, direction),
    }
}

fn tracer_in<S: KernelScalar + Real + Send + Sync + 'static>(
    algorithm: Algorithm,
    lens: &Lens,
    direction: Direction,
) -> Result<Option<Box<dyn Tracer>>, LensError> {
    let compiled = |simd, trace| {
        Compiled::<S>::new(lens, direction, simd, trace).map(|compiled| Box::new(compiled) as Box<dyn Tracer>)
    };
    Ok(match algorithm {
        Algorithm::Walk(refraction) => Some(walk::<S>(lens, direction, refraction)),
        Algorithm::ThickLens => Some(Box::new(Thick { optics: FirstOrder::of(lens)?, direction })),
        Algorithm::ThinLens => {
            let optics = FirstOrder::of(lens)?;
            Some(Box::new(Thick { optics: optics.thin_at(optics.rear_principal_plane), direction }))
        }
        Algorithm::One => {
            compiled(Simd::best(), |kernel, rays| rays.iter().map(|&ray| kernel.one(ray)).collect())
        }
        Algorithm::Batch(simd) => compiled(simd, KernelRays::batch),
        Algorithm::Widest => compiled(Simd::best(), KernelRays::batch),
        Algorithm::Anywhere => compiled(Simd::best(), KernelRays::in_place),
        Algorithm::Three | Algorithm::Polynomial(_) | Algorithm::PolynomialBatch(_) => None,
    })
}

fn walk<R: Real + Send + Sync + 'static>(
    lens: &Lens,
    direction: Direction,
    refraction: Refraction,
) -> Box<dyn Tracer> {
    Box::new(Path::<R>::new(lens, direction, refraction))
}

impl<R: Real + Send + Sync> Tracer for Path<R> {
    fn one(&self, ray: Ray) -> (Ray, Option<Blocked>) {
        let walk = self.walk(ray);
        (walk.ray, walk.blocked)
    }
}

/// The compiled kernel; for a blocked ray, the walk finds the point where it is blocked.
struct Compiled<S> {
    kernel: KernelRays<S>,
    path: Path<f64>,
    trace: fn(&KernelRays<S>, &[Ray]) -> Vec<Option<Ray>>,
}

impl<S: KernelScalar + Real + Send + Sync + 'static> Compiled<S> {
    fn new(
        lens: &Lens,
        direction: Direction,
        simd: Simd,
        trace: fn(&KernelRays<S>, &[Ray]) -> Vec<Option<Ray>>,
    ) -> Option<Self> {
        let kernel = KernelRays::new(lens, direction, simd)?;
        Some(Self { kernel, path: Path::new(lens, direction, Refraction::Fused), trace })
    }
}

impl<S: KernelScalar + Real + Send + Sync> Tracer for Compiled<S> {
    fn one(&self, ray: Ray) -> (Ray, Option<Blocked>) {
        match self.all(&[ray])[0] {
            Some(traced) => (traced, None),
            None => (self.path.walk(ray).ray, Some(self.kernel.reason(ray))),
        }
    }

    fn all(&self, rays: &[Ray]) -> Vec<Option<Ray>> {
        (self.trace)(&self.kernel, rays)
    }
}

/// First-order optics, without apertures. The origin of the ray returned is its point on the vertex plane through which
/// it leaves the lens.
struct Thick {
    optics: FirstOrder,
    direction: Direction,
}

impl Tracer for Thick {
    fn one(&self, ray: Ray) -> (Ray, Option<Blocked>) {
        let (travel_sign, out) = match self.direction {
            Direction::FilmToScene => (1.0, self.optics.transfer(ray)),
            Direction::SceneToFilm => (-1.0, self.optics.transfer_to_film(ray)),
        };
        let input = Ray { direction: unit(ray.direction), ..ray };
        if !(travel_sign * ray.direction[2] > 0.0) {
            return (input, Some(Blocked::TurnedBack));
        }
        // Rays are not finite here only if their coordinates are too large, or their directions too oblique, for a
        // double.
        let finite = out.origin.iter().chain(&out.direction).all(|number| number.is_finite());
        if finite { (out, None) } else { (input, Some(Blocked::Missed)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn no_method_ever_gives_what_is_not_a_number() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").unwrap());
        let values = [0.0, -1.0, 1.0, 1e-320, 1e160, -1e308, f64::MAX];
        for (name, _, method) in Method::offered() {
            for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
                let tracer = tracer(method, &lens, direction).unwrap().unwrap();
                for x in values {
                    for z in values {
                        for d in values {
                            for dz in [-1.0, 1.0, 1e-320, f64::MAX, 0.0] {
                                if d == 0.0 && dz == 0.0 {
                                    continue;
                                }
                                let ray = Ray { origin: [x, 1.0, z], direction: [d, 0.0, dz] };
                                let (out, _) = tracer.one(ray);
                                let all = [out.origin, out.direction];
                                assert!(
                                    all.as_flattened().iter().all(|number| number.is_finite()),
                                    "{name} {ray:?}: {out:?}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn every_kernel_entry_agrees_with_the_walk() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").unwrap());
        let [exact, others @ ..] = ["f64", "batch-f64", "one-f64", "batch-f32", "one-f32"]
            .map(|name| tracer(Method::find(name).unwrap(), &lens, Direction::FilmToScene).unwrap().unwrap());
        let film = lens.rear().vertex - 38.0;
        let (mut passed, mut blocked) = (0, 0);
        for i in -20..=20 {
            let ray = Ray { origin: [4.0, 0.0, film], direction: [f64::from(i) / 40.0 - 0.1, 0.0, 1.0] };
            let (want, reason) = exact.one(ray);
            for (number, other) in others.iter().enumerate() {
                let (got, why) = other.one(ray);
                assert_eq!(why, reason, "{ray:?}");
                let bound = if number < 2 { 1e-13 } else { 1e-6 };
                assert!((got.direction[0] - want.direction[0]).abs() < bound, "{got:?} is not {want:?}");
            }
            if reason.is_none() { passed += 1 } else { blocked += 1 }
        }
        assert!(passed > 4 && blocked > 4, "{passed} {blocked}");
    }
}
