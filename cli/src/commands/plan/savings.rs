//! The time saved by leaving parts out, measured by timing cameras with and without these parts in turns.

use super::order::CameraOrder;
use crate::failure::Failure;
use realistic_camera::plan::Plan;
use realistic_camera::{
    Aimed, Camera, CameraMotion, CameraToWorld, Host, Parameters, Sample, ScenePoint, Transmission,
};
use realistic_lab::BLOCK;
use realistic_lab::columns::{RayAt as _, RayColumns, SampleColumns};
use realistic_lab::timing::camera_calls::{in_one_call, one_by_one, samples};
use realistic_lab::timing::{Effort, Timing, interleaved_within};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Duration;

/// A request to a camera.
#[derive(Clone, Copy)]
enum RayRequest {
    Rays,
    RaysAtWavelengths,
    Differentials,
    /// Rays, after a first call that samples a direction toward the lens.
    Importance,
}

/// A camera to be timed.
struct Variant {
    name: &'static str,
    parameters: Parameters,
    host: Host,
    request: RayRequest,
}

/// The cost of a camera.
struct Cost {
    name: &'static str,
    /// Seconds per sample in blocks, seconds per sample one by one, and seconds to build the camera and make a first
    /// call.
    batch: Timing,
    single: Timing,
    build: Timing,
}

/// The costs of the requested camera and of the other variants.
pub struct Savings(Vec<Cost>);

const RAYS: Effort = Effort { rounds: 21, least: Duration::from_micros(200) };
const BUILDS: Effort = Effort { rounds: 7, least: Duration::from_micros(1) };
/// Longest time of each of the three measurements, not counting the first turn.
const MOST: Duration = Duration::from_secs(2);

/// Share of the samples that are used for ghosts when ghosts are timed.
const GHOSTS: f64 = 0.1;
/// A wavelength that no lens of the catalogue states as its own, nm.
const WAVELENGTH: f32 = 500.0;

impl Savings {
    /// Builds and times the camera and its variants, each of which keeps one more of the parts that `plan` leaves
    /// out.
    ///
    /// # Errors
    /// The camera cannot be built.
    pub fn measure(order: &CameraOrder, plan: &Plan) -> Result<Self, Failure> {
        let variants = variants(order, plan);
        let build = |variant: &Variant| Camera::build(&variant.parameters, &variant.host, &mut |_, _| ());
        let cameras: Vec<(Camera, RayRequest)> = variants
            .iter()
            .map(|variant| Ok((build(variant)?, variant.request)))
            .collect::<Result<_, Failure>>()?;
        let samples = samples(BLOCK, order.host.raster, 0.5);
        let batches = timed(&cameras, RAYS, |(camera, request)| request.in_one_call(camera, &samples));
        let singles = timed(&cameras, RAYS, |(camera, request)| request.one_by_one(camera, &samples));
        let builds = timed(&variants, BUILDS, |variant| {
            if let Ok(camera) = build(variant) {
                variant.request.first(&camera, &samples.first(BLOCK).get(0));
            }
        });
        let times = batches.into_iter().zip(singles).zip(builds);
        let costs = variants.iter().zip(times).map(|(variant, ((batch, single), build))| Cost {
            name: variant.name,
            batch: batch.per(BLOCK),
            single: single.per(BLOCK),
            build,
        });
        Ok(Self(costs.collect()))
    }

    /// Formats the costs as a table.
    pub fn text(&self) -> String {
        let mut text = format!(
            "\nmeasured here: medians of up to {} turns, and of {} for building with a first call\n{:<26}{:>18}{:>20}{:>17}\n",
            RAYS.rounds, BUILDS.rounds, "", "ns/sample, blocks", "ns, one by one", "ms to build"
        );
        let first = &self.0[0];
        for Cost { name, batch, single, build } in &self.0 {
            let share = |time: &Timing, of: &Timing| format!("{:.0} %", 100.0 * time.median / of.median);
            let _ = writeln!(
                text,
                "{name:<26}{:>10.2} {:>7}{:>12.1} {:>7}{:>17.2}",
                batch.median * 1e9,
                share(batch, &first.batch),
                single.median * 1e9,
                share(single, &first.single),
                build.median * 1e3,
            );
        }
        text
    }

    /// Formats the costs as JSON.
    pub fn json(&self) -> Value {
        let costs = self.0.iter().map(|cost| {
            json!({
                "camera": cost.name,
                "in_batches_ns_per_ray": cost.batch.median * 1e9,
                "one_by_one_ns_per_ray": cost.single.median * 1e9,
                "build_ms": cost.build.median * 1e3,
            })
        });
        costs.collect()
    }
}

/// Returns the camera as requested, and a variant for each part that the plan leaves out unless the part is
/// requested.
fn variants(order: &CameraOrder, plan: &Plan) -> Vec<Variant> {
    let (own, host) = (&order.parameters, &order.host);
    let plain = |name, request| Variant { name, parameters: own.clone(), host: host.clone(), request };
    let with = |name, parameters| Variant { parameters, ..plain(name, RayRequest::Rays) };
    let mut variants = vec![plain("this camera", RayRequest::Rays)];
    if order.tolerance() > 0.0 {
        variants.push(with("without the tolerance", Parameters { tolerance: None, ..own.clone() }));
    }
    let leaves_out = |what: &str| plan.items().iter().any(|item| !item.kept && item.what == what);
    for (what, name, request) in [
        ("dispersion", "with a wavelength each", RayRequest::RaysAtWavelengths),
        ("differentials", "with differentials", RayRequest::Differentials),
        ("importance", "with importance", RayRequest::Importance),
    ] {
        if leaves_out(what) {
            variants.push(plain(name, request));
        }
    }
    let is_uncoated = leaves_out("transmission");
    let coated = match is_uncoated {
        true => Parameters { transmission: Some(Transmission::QuarterWave), ..own.clone() },
        false => own.clone(),
    };
    if is_uncoated {
        variants.push(with("with transmission", coated.clone()));
    }
    if leaves_out("ghosts") {
        let name = if is_uncoated { "with transmission, ghosts" } else { "with ghosts" };
        variants.push(with(name, Parameters { ghosts: Some(GHOSTS), ..coated }));
    }
    let moving = CameraMotion::between((CameraToWorld::IDENTITY, 0.0), (moved(), 1.0)).expect("a motion");
    for (name, to_world) in [("turned and moved", moved().into()), ("moving", moving)] {
        variants.push(Variant { host: Host { to_world, ..host.clone() }, ..plain(name, RayRequest::Rays) });
    }
    variants
}

/// Returns a quarter turn about the vertical, with a translation.
fn moved() -> CameraToWorld {
    let rows = [0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 2.0, -1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0];
    CameraToWorld::from_rows(&rows).expect("a rotation and a move")
}

impl RayRequest {
    /// Requests a block of samples in one call.
    fn in_one_call(self, camera: &Camera, samples: &SampleColumns) {
        in_one_call(samples, |samples, rays| match self {
            Self::Rays | Self::Importance => camera.trace(samples, rays),
            Self::RaysAtWavelengths => camera.trace(&samples.at(&[WAVELENGTH; BLOCK]), rays),
            Self::Differentials => {
                let [mut right, mut below] = [(); 2].map(|()| RayColumns::new(BLOCK));
                let mut found = RayColumns::new(BLOCK);
                let neighbours = [right.neighbours(), below.neighbours()];
                camera.trace(samples, &mut found.all().with_neighbours(neighbours));
                black_box(rays);
                black_box((&right, &below));
            }
        });
    }

    /// Requests samples one by one; each call waits for the result of the previous call.
    fn one_by_one(self, camera: &Camera, samples: &SampleColumns) {
        one_by_one(samples, |sample| match self {
            Self::Rays | Self::Importance => camera.ray(sample).map(|(_, weight)| weight),
            Self::RaysAtWavelengths => camera.ray_at(sample, WAVELENGTH).map(|(_, weight)| weight),
            Self::Differentials => camera.ray_differential(sample).map(|(_, weight)| weight),
        });
    }

    /// Makes the first call, which builds the parts that are built lazily.
    fn first(self, camera: &Camera, sample: &Sample) {
        match self {
            Self::Rays | Self::Differentials => {}
            Self::RaysAtWavelengths => _ = black_box(camera.ray_at(sample, WAVELENGTH)),
            Self::Importance => {
                let Some((ray, _)) = camera.ray(sample) else { return };
                let point = [0, 1, 2].map(|axis| ray.origin[axis] + 1e3 * ray.direction[axis]);
                if let Ok(adjoint) = camera.adjoint() {
                    let mut found = [Aimed::default()];
                    adjoint.aim(&[ScenePoint { point, sample: [0.5; 2], time: ray.time }], &mut found);
                    black_box(&found);
                }
            }
        }
    }
}

fn timed<T>(variants: &[T], effort: Effort, work: impl Fn(&T)) -> Vec<Timing> {
    let work = &work;
    interleaved_within(
        variants.iter().map(|variant| Box::new(move || work(variant)) as Box<dyn FnMut()>),
        effort,
        MOST,
    )
}
