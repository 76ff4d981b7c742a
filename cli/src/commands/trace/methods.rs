//! The methods of `trace` by name: a lens and a direction of travel in, a function that takes a ray as far as it
//! gets out.

use realistic::lens::{Lens, LensError, first_order::FirstOrder, refraction::Refraction};
use realistic::trace::kernel::{KernelScalar, Simd};
use realistic::trace::{Blocked, Direction, Path, Ray, Real};
use realistic_lab::subject::kernel_rays::{KernelRays, unit};

/// Takes a ray as far as it gets: the ray there and why it stopped, if it did.
pub type Tracer = dyn Fn(Ray) -> (Ray, Option<Blocked>);

/// Makes a lens ready for rays in one direction.
type Make = fn(&Lens, Direction) -> Result<Box<Tracer>, LensError>;

/// A way of tracing.
#[derive(Debug)]
pub struct Method {
    /// What `--method` calls it.
    pub name: &'static str,
    /// One line about it.
    pub help: &'static str,
    /// Makes a lens ready.
    pub make: Make,
}

const fn method(name: &'static str, help: &'static str, make: Make) -> Method {
    Method { name, help, make }
}

const BATCH_F64: &str = "the kernel's batches in double precision, on the widest registers (REALISTIC_SIMD)";
const ONE_F64: &str = "the kernel's single ray in double precision, as a camera traces one";
const OTHER: &str = "as f64, refracted by the \"other method\" of the same comparison";
const THICK: &str = "the thick lens: from principal plane to principal plane, without apertures; the point is where \
                     the ray leaves the vertex plane";
const THIN: &str = "as thick, with both principal planes where the film's side has its own (P')";

/// Every method, the default first.
pub const METHODS: &[Method] = &[
    method("f64", "exact rays in double precision", |lens, to| exact::<f64>(lens, to, Refraction::Fused)),
    method("f32", "exact rays in single precision", |lens, to| exact::<f32>(lens, to, Refraction::Fused)),
    method("batch-f64", BATCH_F64, |lens, to| compiled::<f64>(lens, to, |rays, ray| rays.batch(&[ray])[0])),
    method("batch-f32", "the same in single precision", |lens, to| {
        compiled::<f32>(lens, to, |rays, ray| rays.batch(&[ray])[0])
    }),
    method("one-f64", ONE_F64, |lens, to| compiled::<f64>(lens, to, KernelRays::one)),
    method("one-f32", "the same in single precision", |lens, to| compiled::<f32>(lens, to, KernelRays::one)),
    method("heckbert", "as f64, refracted by Heckbert's method", |lens, to| {
        exact::<f64>(lens, to, Refraction::Heckbert)
    }),
    method("whitted", "as f64, refracted by Whitted's method", |lens, to| {
        exact::<f64>(lens, to, Refraction::Whitted)
    }),
    method("other", OTHER, |lens, to| exact::<f64>(lens, to, Refraction::Other)),
    method("thick", THICK, |lens, to| Ok(thick(FirstOrder::of(lens)?, to))),
    method("thin", THIN, |lens, to| {
        let lens = FirstOrder::of(lens)?;
        Ok(thick(lens.thin_at(lens.rear_principal_plane), to))
    }),
];

/// The method of that name.
///
/// # Errors
/// There is none; the message lists them.
pub fn find(name: &str) -> Result<&'static Method, String> {
    METHODS.iter().find(|method| method.name == name).ok_or_else(|| {
        let names: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
        format!("the methods are {}", names.join(", "))
    })
}

fn exact<R: Real + 'static>(
    lens: &Lens,
    direction: Direction,
    refraction: Refraction,
) -> Result<Box<Tracer>, LensError> {
    let path = Path::<R>::new(lens, direction, refraction);
    Ok(Box::new(move |ray| {
        let walk = path.walk(ray);
        (walk.ray, walk.blocked)
    }))
}

/// The compiled kernel; of a blocked ray the walk says how far it got and why.
fn compiled<S: KernelScalar + Real + 'static>(
    lens: &Lens,
    direction: Direction,
    trace: fn(&KernelRays<S>, Ray) -> Option<Ray>,
) -> Result<Box<Tracer>, LensError> {
    let rays = KernelRays::<S>::new(lens, direction, Simd::best()).expect("the best is available");
    let path = Path::<f64>::new(lens, direction, Refraction::Fused);
    Ok(Box::new(move |ray| match trace(&rays, ray) {
        Some(traced) => (traced, None),
        None => (path.walk(ray).ray, Some(rays.reason(ray))),
    }))
}

fn thick(optics: FirstOrder, direction: Direction) -> Box<Tracer> {
    Box::new(move |ray| {
        let (travel_sign, out) = match direction {
            Direction::FilmToScene => (1.0, optics.transfer(ray)),
            Direction::SceneToFilm => (-1.0, optics.transfer_to_film(ray)),
        };
        let input = Ray { direction: unit(ray.direction), ..ray };
        if !(travel_sign * ray.direction[2] > 0.0) {
            return (input, Some(Blocked::TurnedBack));
        }
        // Only what is too large or too oblique for a double gets here.
        let finite = out.origin.iter().chain(&out.direction).all(|number| number.is_finite());
        if finite { (out, None) } else { (input, Some(Blocked::Missed)) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic::prescription::catalogue;

    #[test]
    fn no_method_ever_gives_what_is_not_a_number() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").unwrap());
        let values = [0.0, -1.0, 1.0, 1e-320, 1e160, -1e308, f64::MAX];
        for method in METHODS {
            for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
                let tracer = (method.make)(&lens, direction).unwrap();
                for x in values {
                    for z in values {
                        for d in values {
                            for dz in [-1.0, 1.0, 1e-320, f64::MAX, 0.0] {
                                if d == 0.0 && dz == 0.0 {
                                    continue;
                                }
                                let ray = Ray { origin: [x, 1.0, z], direction: [d, 0.0, dz] };
                                let (out, _) = tracer(ray);
                                let all = [out.origin, out.direction];
                                assert!(
                                    all.as_flattened().iter().all(|number| number.is_finite()),
                                    "{} {ray:?}: {out:?}",
                                    method.name
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_kernel_s_ways_agree_with_the_walk() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").unwrap());
        let [exact, others @ ..] = ["f64", "batch-f64", "one-f64", "batch-f32", "one-f32"]
            .map(|name| (find(name).unwrap().make)(&lens, Direction::FilmToScene).unwrap());
        let film = lens.rear().vertex - 38.0;
        let (mut passed, mut blocked) = (0, 0);
        for i in -20..=20 {
            let ray = Ray { origin: [4.0, 0.0, film], direction: [f64::from(i) / 40.0 - 0.1, 0.0, 1.0] };
            let (want, reason) = exact(ray);
            for (number, other) in others.iter().enumerate() {
                let (got, why) = other(ray);
                assert_eq!(why, reason, "{ray:?}");
                let bound = if number < 2 { 1e-13 } else { 1e-6 };
                assert!((got.direction[0] - want.direction[0]).abs() < bound, "{got:?} is not {want:?}");
            }
            if reason.is_none() { passed += 1 } else { blocked += 1 }
        }
        assert!(passed > 4 && blocked > 4, "{passed} {blocked}");
    }

    #[test]
    fn an_unknown_method_lists_the_known_ones() {
        assert_eq!(find("f32").unwrap().name, "f32");
        assert!(find("f16").unwrap_err().contains("heckbert"));
    }
}
