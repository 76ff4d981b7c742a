//! What leaving out saves: measured on the spot, with and without, in turns.

use super::Order;
use crate::failure::Failure;
use realistic::camera::{RayBlock, RealisticCamera, Sample, SampleBlock};
use realistic_lab::BLOCK;
use realistic_lab::bench::{Effort, Timing, interleaved};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Duration;

/// One way to build the camera, and what it costs.
struct Way {
    name: &'static str,
    /// Seconds a ray in blocks, seconds a ray one by one, seconds to build.
    batch: Timing,
    single: Timing,
    build: Timing,
}

/// Every way, the one that leaves nothing out first.
pub struct Savings(Vec<Way>);

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
        let batches = timed(&cameras, RAYS, |camera| {
            let mut rays = RayBlock::<BLOCK>::new();
            camera.rays(&samples.arrays(BLOCK), &mut rays.arrays(BLOCK));
            black_box(&rays);
        });
        let singles = timed(&cameras, RAYS, |camera| {
            let mut carry = 0.0;
            for i in 0..BLOCK {
                let mut sample = samples.arrays(BLOCK).get(i);
                // Too little to change the sum: each ray waits for the one before.
                sample.image_x += carry;
                carry = camera.ray(&sample).map_or(0.0, |(_, weight)| weight * 1e-30);
            }
            black_box(carry);
        });
        let builds = timed(&ways, BUILDS, |&(_, leave_out, tolerance)| {
            black_box(build(leave_out, tolerance).is_ok());
        });
        let per_ray = |time: Timing| {
            let [median, low, high] = [time.median, time.low, time.high].map(|time| time / BLOCK as f64);
            Timing { median, low, high }
        };
        let times = batches.into_iter().zip(singles).zip(builds);
        let ways = ways.into_iter().zip(times).map(|((name, ..), ((batch, single), build))| Way {
            name,
            batch: per_ray(batch),
            single: per_ray(single),
            build,
        });
        Ok(Self(ways.collect()))
    }

    /// A table.
    pub fn text(&self) -> String {
        let mut text = format!(
            "\nmeasured here: medians of {} turns, and of {} for building\n{:<20}{:>16}{:>19}{:>15}\n",
            RAYS.rounds, BUILDS.rounds, "", "ns a ray, blocks", "ns, one by one", "ms to build"
        );
        let first = &self.0[0];
        for Way { name, batch, single, build } in &self.0 {
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
        let ways = self.0.iter().map(|way| {
            json!({
                "camera": way.name,
                "batch_ns_a_ray": way.batch.median * 1e9,
                "single_ns_a_ray": way.single.median * 1e9,
                "build_ms": way.build.median * 1e3,
            })
        });
        ways.collect()
    }
}

fn timed<T>(ways: &[T], effort: Effort, work: impl Fn(&T)) -> Vec<Timing> {
    let mut tasks: Vec<Box<dyn FnMut() + '_>> =
        ways.iter().map(|way| Box::new(|| work(way)) as Box<dyn FnMut()>).collect();
    let mut tasks: Vec<&mut dyn FnMut()> = tasks.iter_mut().map(|task| &mut **task as _).collect();
    interleaved(&mut || work(&ways[0]), &mut tasks, effort)
}

/// Samples all but evenly spread (R2 sequence, M. Roberts 2018) over the image.
fn samples(order: &Order) -> SampleBlock<BLOCK> {
    let mut block = SampleBlock::new();
    for i in 0..BLOCK {
        let number = |step: f64| (0.5 + step * i as f64).fract();
        let across = |step: f64, pixels: u32| (f64::from(pixels) * number(step)) as f32;
        let sample = Sample {
            image_x: across(0.819_172_513_396_164_4, order.host.raster.xres),
            image_y: across(0.671_043_606_703_789_3, order.host.raster.yres),
            lens_u: number(0.754_877_666_246_692_8) as f32,
            lens_v: number(0.569_840_290_998_053_2) as f32,
            time: number(0.618_033_988_749_894_9) as f32,
        };
        block.set(i, &sample);
    }
    block
}
