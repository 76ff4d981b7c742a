//! Compiles the decided way of tracing, with what stands before and behind the lens, to what traces a camera's rays.

use std::sync::Arc;

use super::{body::CameraBody, lanes::Pipeline, tracer::LensTracer, walk::WalkTracer};
use crate::{
    lens::Lens,
    plan::{Kernels, Plan, Precision, Tracing, Way},
    sampling::disk::Turns,
    trace::{
        Direction, Path,
        kernel::Kernel,
        polynomial::{Polynomial, PolynomialLens},
    },
};

/// What traces the rays of a lens as decided; the surfaces that thereby go altogether are added to the plan. `path` and
/// `kernels` are the lens from film to scene.
pub(crate) fn compile(
    way: &Way,
    lens: &Lens,
    path: &Path,
    kernels: &Kernels<'_>,
    body: &CameraBody,
    plan: &mut Plan,
) -> Arc<dyn LensTracer> {
    let Way { tracing, reach, tested } = way;
    match tracing {
        Tracing::Exact(Precision::F64) => exact(kernels.double(), tested.as_deref(), *reach, body, plan),
        Tracing::Exact(Precision::F32) => exact(kernels.single(), tested.as_deref(), *reach, body, plan),
        Tracing::Polynomials { fit, precision: Precision::F64, .. } => {
            polynomials(kernels.double(), fit, *reach, body)
        }
        Tracing::Polynomials { fit, precision: Precision::F32, .. } => {
            polynomials(kernels.single(), fit, *reach, body)
        }
        Tracing::Refracted(_, Precision::F64) => Arc::new(WalkTracer::new(path.clone(), body)),
        Tracing::Refracted(refraction, Precision::F32) => {
            let single = Path::<f32>::new(lens, Direction::FilmToScene, *refraction);
            let blades = path.blades().map(|(_, blades)| blades);
            Arc::new(WalkTracer::new(single.with_blades(lens, blades), body))
        }
    }
}

fn exact<S: Turns + Send + Sync>(
    whole: &Kernel<S>,
    tested: Option<&[bool]>,
    reach: f64,
    body: &CameraBody,
    plan: &mut Plan,
) -> Arc<dyn LensTracer> {
    let fast = tested.map(|tested| {
        let kernel = whole.testing(|surface| tested[surface]);
        plan.surfaces_left_out(whole.steps() - kernel.steps(), whole.steps());
        (kernel, reach)
    });
    Arc::new(Pipeline::new(whole.clone(), fast, body))
}

fn polynomials<S: Turns + Send + Sync>(
    whole: &Kernel<S>,
    fit: &Polynomial,
    reach: f64,
    body: &CameraBody,
) -> Arc<dyn LensTracer> {
    Arc::new(Pipeline::new(whole.clone(), Some((PolynomialLens::<S>::new(fit), reach)), body))
}
