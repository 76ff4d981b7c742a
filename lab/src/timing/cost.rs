//! What a lens costs before its first ray: its text in; how long a thread takes to build a camera and to find the first
//! direction toward it, and what the tracer counted, out.

use realistic::unstable::{
    camera::{Aimed, Camera, Host, Parameters, Raster, ScenePoint},
    trace,
};

use super::clock;

/// Of a lens.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Building a camera.
    pub build: Spent,
    /// Its first direction toward the lens.
    pub first: Spent,
}

/// Of a call.
#[derive(Clone, Copy, Debug)]
pub struct Spent {
    /// Processor time of the thread.
    pub seconds: f64,
    /// Evaluations of aspheres for rays by themselves: see [`trace::evaluations`].
    pub evaluations: u64,
}

impl Spent {
    fn on<T>(work: impl FnOnce() -> T) -> (Self, T) {
        let (start, before) = (clock::now(), trace::evaluations());
        let result = work();
        let seconds = (clock::now() - start).as_secs_f64();
        (Self { seconds, evaluations: trace::evaluations() - before }, result)
    }
}

impl Cost {
    /// Of a lens's text; `None` where it makes no camera.
    pub fn of(text: &str) -> Option<Self> {
        let mut host = Host::new(Raster { xres: 300, yres: 200 }, None);
        host.lens_text = Some(("lens".to_owned(), text.as_bytes().to_vec()));
        let (build, camera) = Spent::on(|| Camera::build(&Parameters::default(), &host, &mut |_, _| ()));
        let camera = camera.ok()?;
        let adjoint = camera.adjoint().ok()?;
        let points = [ScenePoint { point: [10.0, 20.0, 3000.0], sample: [0.3, 0.6], time: 0.0 }];
        let (first, ()) = Spent::on(|| adjoint.aim(&points, &mut [Aimed::default()]));
        Some(Self { build, first })
    }
}
