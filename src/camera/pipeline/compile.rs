//! Compiles the decided way of tracing, with what stands before and behind the lens, to what traces a camera's rays.

use std::sync::Arc;

use super::{body::CameraBody, lanes::Pipeline, tracer::LensTracer, walk::WalkTracer};
use crate::{
    lens::Lens,
    plan::{Kernels, Precision, Tracing},
    trace::{Direction, Path, polynomial::Polynomial},
};

/// What traces the rays of a lens as decided. `path` and `kernels` are the lens from film to scene.
pub(crate) fn compile(
    tracing: &Tracing<Polynomial>,
    lens: &Lens,
    path: &Path,
    kernels: &Kernels<'_>,
    body: &CameraBody,
) -> Arc<dyn LensTracer> {
    match tracing {
        Tracing::Exact(Precision::F64) => Arc::new(Pipeline::exact(kernels.double(), body)),
        Tracing::Exact(Precision::F32) => Arc::new(Pipeline::exact(kernels.single(), body)),
        Tracing::Polynomials { fit, precision: Precision::F64, .. } => {
            Arc::new(Pipeline::fitted(kernels.double(), fit, body))
        }
        Tracing::Polynomials { fit, precision: Precision::F32, .. } => {
            Arc::new(Pipeline::fitted(kernels.single(), fit, body))
        }
        Tracing::Refracted(_, Precision::F64) => Arc::new(WalkTracer::new(path.clone(), body)),
        Tracing::Refracted(refraction, Precision::F32) => {
            let single = Path::<f32>::new(lens, Direction::FilmToScene, *refraction);
            let blades = path.blades().map(|(_, blades)| blades);
            Arc::new(WalkTracer::new(single.with_blades(lens, blades), body))
        }
    }
}
