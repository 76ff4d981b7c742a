//! What leaving out saves: cameras built with and without their plan in, times measured on the spot and in turns out.

use super::order::Order;
use crate::failure::Failure;
use realistic::unstable::camera::{RealisticCamera, Sample, SampleBlock};
use realistic_lab::BLOCK;
use realistic_lab::subject::quasirandom::spread;
use realistic_lab::timing::camera_calls::{in_one_call, one_by_one};
use realistic_lab::timing::{Effort, Timing, interleaved};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Duration;

/// One way to build the camera, and what it costs.
struct Cost {
    name: &'static str,
    /// Seconds per ray in blocks, seconds per ray one by one, seconds to build.
    batch: Timing,
    single: Timing,
    build: Timing,
}

/// Every way, the one that leaves nothing out first.
pub struct Savings(Vec<Cost>);

const RAYS: Effort = Effort { rounds: 21, least: Duration::from_micros(200) };
const BUILDS: Effort = Effort { rounds: 7, least: Duration::from_micros(1) };

impl Savings {
    /// Builds and asks the camera with and without its plan.
    ///
    /// # Errors
    /// It cannot be built.
    pub fn measure(order: &Order) -> Result<Self, Failure> {
        let tolerance = order.tolerance();
        let mut ways = vec![("nothing left out", false, 0.0), ("without tolerance", true, 0.0)];
        if tolerance > 0.0 {
            ways.push(("with the tolerance", true, tolerance));
        }
        let build = |leave_out, tolerance| order.camera(leave_out, tolerance, &mut |_, _| ());
        let cameras: Vec<RealisticCamera> = ways
            .iter()
            .map(|&(_, leave_out, tolerance)| build(leave_out, tolerance))
            .collect::<Result<_, _>>()?;
        let samples = samples(order);
        let batches = timed(&cameras, RAYS, |camera| in_one_call(camera, &samples));
        let singles = timed(&cameras, RAYS, |camera| one_by_one(camera, &samples));
        let builds = timed(&ways, BUILDS, |&(_, leave_out, tolerance)| {
            black_box(build(leave_out, tolerance).is_ok());
        });
        let times = batches.into_iter().zip(singles).zip(builds);
        let costs = ways.into_iter().zip(times).map(|((name, ..), ((batch, single), build))| Cost {
            name,
            batch: batch.per(BLOCK),
            single: single.per(BLOCK),
            build,
        });
        Ok(Self(costs.collect()))
    }

    /// A table.
    pub fn text(&self) -> String {
        let mut text = format!(
            "\nmeasured here: medians of {} turns, and of {} for building\n{:<20}{:>18}{:>17}{:>15}\n",
            RAYS.rounds, BUILDS.rounds, "", "ns per ray, blocks", "ns, one by one", "ms to build"
        );
        let first = &self.0[0];
        for Cost { name, batch, single, build } in &self.0 {
            let share = |time: &Timing, of: &Timing| format!("{:.0} %", 100.0 * time.median / of.median);
            let _ = writeln!(
                text,
                "{name:<20}{:>9.2} {:>6}{:>12.1} {:>6}{:>15.2}",
                batch.median * 1e9,
                share(batch, &first.batch),
                single.median * 1e9,
                share(single, &first.single),
                build.median * 1e3,
            );
        }
        text
    }

    /// The same for programs.
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

fn timed<T>(ways: &[T], effort: Effort, work: impl Fn(&T)) -> Vec<Timing> {
    let work = &work;
    interleaved(ways.iter().map(|way| Box::new(move || work(way)) as Box<dyn FnMut()>), effort)
}

/// Samples nearly evenly spread over the image.
fn samples(order: &Order) -> SampleBlock<BLOCK> {
    let mut block = SampleBlock::<BLOCK>::new();
    let across = |share: f64, pixels: u32| (f64::from(pixels) * share) as f32;
    for (i, [x, y, u, v, time]) in spread::<5>(0.5).take(BLOCK).enumerate() {
        let sample = Sample {
            image_x: across(x, order.host.raster.xres),
            image_y: across(y, order.host.raster.yres),
            lens_u: u as f32,
            lens_v: v as f32,
            time: time as f32,
        };
        block.set(i, &sample);
    }
    block
}
