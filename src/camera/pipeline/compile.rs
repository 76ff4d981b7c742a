//! Compiles the decided way of tracing, with what stands before and behind the lens, to what traces a camera's rays.

use std::sync::Arc;

use super::{body::CameraBody, lanes::Pipeline, tracer::Tracer, walk::WalkTracer};
use crate::{
    lens::Lens,
    plan::{Decision, Plan, Precision, Tracing},
    sampling::disk::Turns,
    trace::{
        Direction, Path,
        kernel::Kernel,
        polynomial::{Polynomial, PolynomialLens},
    },
};

/// What traces the rays of a lens as decided; the surfaces that thereby go altogether are added to the plan. `path` is the
/// lens from film to scene.
pub(crate) fn compile(
    decision: &Decision,
    lens: &Lens,
    path: &Path,
    body: &CameraBody,
    plan: &mut Plan,
) -> Arc<dyn Tracer> {
    let Decision { tracing, reach, tested, .. } = decision;
    match tracing {
        Tracing::Exact(Precision::F64) => exact::<f64>(lens, tested.as_deref(), *reach, body, plan),
        Tracing::Exact(Precision::F32) => exact::<f32>(lens, tested.as_deref(), *reach, body, plan),
        Tracing::Polynomials { fit, precision: Precision::F64, .. } => {
            polynomials::<f64>(lens, fit, *reach, body)
        }
        Tracing::Polynomials { fit, precision: Precision::F32, .. } => {
            polynomials::<f32>(lens, fit, *reach, body)
        }
        Tracing::Refracted(_, Precision::F64) => Arc::new(WalkTracer::new(path.clone(), body)),
        Tracing::Refracted(refraction, Precision::F32) => {
            Arc::new(WalkTracer::new(Path::<f32>::new(lens, Direction::FilmToScene, *refraction), body))
        }
    }
}

fn exact<S: Turns + Send + Sync>(
    lens: &Lens,
    tested: Option<&[bool]>,
    reach: f64,
    body: &CameraBody,
    plan: &mut Plan,
) -> Arc<dyn Tracer> {
    let whole = Kernel::<S>::new(lens, Direction::FilmToScene);
    let fast = tested.map(|tested| {
        let kernel = Kernel::testing(lens, Direction::FilmToScene, |surface| tested[surface]);
        plan.surfaces_left_out(whole.steps() - kernel.steps(), whole.steps());
        (kernel, reach)
    });
    Arc::new(Pipeline::new(whole, fast, body))
}

fn polynomials<S: Turns + Send + Sync>(
    lens: &Lens,
    fit: &Polynomial,
    reach: f64,
    body: &CameraBody,
) -> Arc<dyn Tracer> {
    let whole = Kernel::<S>::new(lens, Direction::FilmToScene);
    Arc::new(Pipeline::new(whole, Some((PolynomialLens::<S>::new(fit), reach)), body))
}
