//! The set-up cost of a lens: the time to build a camera from the lens's text, and the time to find the first direction
//! toward the camera.

use realistic_camera::{Aimed, Camera, Host, Parameters, Raster, ScenePoint};

use super::clock;

/// The cost of a lens, in seconds of CPU time.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Time to build a camera.
    pub build: f64,
    /// Time to find the camera's first direction toward the lens.
    pub first: f64,
}

/// Returns the CPU time of some work, seconds, and its result.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = clock::now();
    let result = work();
    ((clock::now() - start).as_secs_f64(), result)
}

impl Cost {
    /// Measures the cost of a lens's text; `None` if no camera can be built from it.
    pub fn of(text: &str) -> Option<Self> {
        let mut host = Host::new(Raster { xres: 300, yres: 200 }, None);
        host.lens_text = Some(("lens".to_owned(), text.as_bytes().to_vec()));
        let (build, camera) = timed(|| Camera::build(&Parameters::default(), &host, &mut |_, _| ()));
        let camera = camera.ok()?;
        let adjoint = camera.adjoint().ok()?;
        let points = [ScenePoint { point: [10.0, 20.0, 3000.0], sample: [0.3, 0.6], time: 0.0 }];
        let (first, ()) = timed(|| adjoint.aim(&points, &mut [Aimed::default()]));
        Some(Self { build, first })
    }
}
