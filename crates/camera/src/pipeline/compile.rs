//! Compiles the chosen [`Tracing`], together with the camera's body, to a tracer.

use std::sync::Arc;

use super::{body::CameraBody, lanes::Pipeline, tracer::LensTracer, walk::WalkTracer};
use crate::plan::{Kernels, Precision, Tracing};
use realistic_light::Transmission;
use realistic_optics::{
    lens::Lens,
    trace::{Direction, Path},
};
use realistic_trace::{
    kernel::{Kernel, KernelScalar},
    polynomial::{Polynomial, PolynomialLens},
};

/// Returns the tracer of a lens for the chosen tracing. `path` and `kernels` are the lens from film to scene.
pub fn compile(
    tracing: &Tracing<Polynomial>,
    lens: &Lens,
    path: &Path,
    kernels: &Kernels<'_>,
    body: &CameraBody,
) -> Arc<dyn LensTracer> {
    match tracing {
        Tracing::Exact(precision) => exact(*precision, lens, kernels, body),
        Tracing::Polynomials { fit, precision, .. } => {
            let whole = exact(*precision, lens, kernels, body);
            match precision {
                Precision::F64 => polynomials::<f64>(fit, body, whole),
                Precision::F32 => polynomials::<f32>(fit, body, whole),
            }
        }
        Tracing::Refracted(_, Precision::F64) => Arc::new(WalkTracer::new(path.clone(), lens, body)),
        Tracing::Refracted(refraction, Precision::F32) => {
            let single = Path::<f32>::new(lens, Direction::FilmToScene, *refraction);
            Arc::new(WalkTracer::new(single.with_apertures(lens), lens, body))
        }
    }
}

/// Returns the tracer that intersects every surface.
fn exact(precision: Precision, lens: &Lens, kernels: &Kernels<'_>, body: &CameraBody) -> Arc<dyn LensTracer> {
    match precision {
        Precision::F64 => through(lens, kernels.double(), body),
        Precision::F32 => through(lens, kernels.single(), body),
    }
}

fn through<S: KernelScalar + Send + Sync>(
    lens: &Lens,
    kernel: &Kernel<S>,
    body: &CameraBody,
) -> Arc<dyn LensTracer> {
    let (steps, simd) = (kernel.steps(), kernel.available());
    match &body.coatings {
        None => Arc::new(Pipeline::new(body.lane_body(), steps.clone(), simd)),
        Some(coatings) => {
            let lit = Transmission::steps(steps, lens, Direction::FilmToScene, coatings);
            Arc::new(Pipeline::new(body.lane_body(), lit, simd))
        }
    }
}

/// Returns the tracer that uses polynomials for rays from the film; points outside the range of the fit are
/// traced by `whole`, the tracer of the whole lens.
fn polynomials<S: KernelScalar + Send + Sync>(
    fit: &Polynomial,
    body: &CameraBody,
    whole: Arc<dyn LensTracer>,
) -> Arc<dyn LensTracer> {
    let lens = PolynomialLens::<S>::new(fit);
    let simd = lens.available();
    Arc::new(Pipeline::new(body.lane_body(), lens, simd).within(body.film_side.film.reach(), whole))
}
