//! The effect of a tracing method on vignetting. Film irradiance is computed from samples of the rear element's disk,
//! whose rays the method passes or blocks, and compared with the irradiance from the exact rays.

use realistic_optics::{
    lens::cos4,
    trace::{Path, Ray},
};
use realistic_simd::Simd;

use crate::{
    accuracy::{
        irradiance::{FIELDS, raster},
        ray_map::RayCounts,
    },
    methods::{Algorithm, METHODS, Method, Number, block},
    results::table::{Table, row},
    subject::{CameraSamples, Subject},
    timing::{Timing, interleaved},
};

/// The errors and time of one method on one lens.
#[derive(Clone, Debug)]
pub struct Vignetting {
    /// The lens.
    pub lens: String,
    /// The method.
    pub method: Method,
    /// Whether the method tests the apertures that block rays: both for polynomials, always true for exact methods, and
    /// always false for first-order optics.
    pub apertures: bool,
    /// Time per sample, passed or blocked, seconds.
    pub time: Timing,
    /// The signed error of irradiance at each of [`FIELDS`], relative to the irradiance on the axis.
    pub errors: [f64; FIELDS.len()],
}

impl Vignetting {
    /// Returns the largest absolute error.
    pub fn worst(&self) -> f64 {
        self.errors.iter().fold(0.0, |worst, error| worst.max(error.abs()))
    }
}

/// Returns the kernels in batches, the polynomials in batches and the thick lens.
fn compared() -> impl Iterator<Item = &'static Method> {
    METHODS.iter().filter(|method| match method.algorithm {
        Algorithm::Batch(simd) => simd == Simd::best(),
        Algorithm::PolynomialBatch(_) => method.number == Number::F32,
        Algorithm::ThickLens => true,
        _ => false,
    })
}

/// Measures errors and times of all compared methods on one lens.
pub fn measure(subject: &Subject, counts: RayCounts) -> Vec<Vignetting> {
    let samples = CameraSamples::of_rear(subject);
    let blocks = FIELDS.map(|field| {
        let [x, y] = raster(field);
        samples.rays_from(subject.film.point(x.into(), y.into()), counts.rays)
    });
    let exact = blocks.each_ref().map(|rays| light(rays, |i| passes(&subject.path, &rays[i])));
    let timed = samples.rays(counts.block, 1);
    let variants: Vec<(&Method, bool)> = compared()
        .flat_map(|method| match method.algorithm {
            Algorithm::PolynomialBatch(_) => vec![(method, true), (method, false)],
            Algorithm::ThickLens => vec![(method, false)],
            _ => vec![(method, true)],
        })
        .collect();
    let ready = |(method, apertures): (&Method, bool), rays: &[Ray]| {
        block::prepare(method, subject, if apertures { &samples.apertures } else { &[] }, rays)
    };
    let (variants, runners): (Vec<_>, Vec<_>) =
        variants.into_iter().filter_map(|variant| Some((variant, ready(variant, &timed)?))).unzip();
    let tasks = runners.into_iter().map(|mut runner| Box::new(move || runner.run()) as Box<dyn FnMut()>);
    let timings = interleaved(tasks, counts.effort);
    let result = |((method, apertures), timing): ((&Method, bool), Timing)| {
        let errors = std::array::from_fn(|field| {
            let rays = &blocks[field];
            let mut runner = ready((method, apertures), rays).expect("prepared before");
            runner.run();
            (light(rays, |i| runner.ray(i).is_some()) - exact[field]) / exact[0]
        });
        let lens = subject.lens.name.clone();
        Vignetting { lens, method: *method, apertures, time: timing.per(timed.len()), errors }
    };
    variants.into_iter().zip(timings).map(result).collect()
}

fn passes(path: &Path<f64>, ray: &Ray) -> bool {
    path.trace(*ray).is_ok()
}

/// Returns the mean light over the rays of a film point; blocked rays count as 0.
fn light(rays: &[Ray], passes: impl Fn(usize) -> bool) -> f64 {
    let shares = rays.iter().enumerate().filter(|(i, _)| passes(*i)).map(|(_, ray)| {
        let [dx, dy, dz] = ray.direction;
        cos4([dx / dz, dy / dz])
    });
    shares.sum::<f64>() / rays.len() as f64
}

/// Returns the results as a table.
pub fn table(results: &[Vignetting]) -> Table {
    let columns = "lens method apertures time_ns error_at_0 error_at_0.3 error_at_0.55 error_at_0.75 error_at_0.95 worst";
    let rows = results.iter().map(|m| {
        let names = row![m.lens.as_str(), m.method.name, m.apertures, m.time.median * 1e9];
        [names, m.errors.map(Into::into).into(), row![m.worst()]].concat()
    });
    Table::of("vignetting", columns, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timing::Effort;
    use realistic_optics::prescription::catalogue;
    use std::time::Duration;

    #[test]
    fn the_kernel_keeps_vignetting_and_approximations_lose_it() {
        let subject = Subject::new(&catalogue::find("wide.22mm").expect("listed")).expect("focuses");
        let effort = Effort { rounds: 1, least: Duration::from_micros(10) };
        let all = measure(&subject, RayCounts { rays: 1500, block: 64, effort });
        let worst = |name: &str, apertures: bool| {
            let own = all.iter().find(|m| m.method.name == name && m.apertures == apertures);
            own.unwrap_or_else(|| panic!("{name}: {all:?}")).worst()
        };
        let kernels = all.iter().filter(|m| matches!(m.method.algorithm, Algorithm::Batch(_)));
        assert!(kernels.clone().count() == 2 && kernels.map(Vignetting::worst).all(|worst| worst < 1e-3));
        let [with, without] = [true, false].map(|apertures| worst("order 11, f32", apertures));
        assert!(with < 0.01 && without > 10.0 * with, "{with} {without}");
        assert!(worst("thick lens", false) > 0.1);
        assert!(all.iter().all(|m| m.time.median > 0.0));
    }
}
