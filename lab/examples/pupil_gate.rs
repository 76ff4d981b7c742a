//! Measures the true pupils of film points by samples, and by rays outside the map. The cameras are the catalogue's
//! lenses wide open and at f/8, lenses by name or file, or a number of random cameras, at 67 film radii each:
//! `pupil_gate [--time] [--fields] [--small] [LENS]... [NUMBER]`. For each camera it prints the share of samples that
//! pass, weighted by light, and the least share at a radius that receives a twentieth of the axis's light or more; then
//! the light missed relative to the light on the axis: the maximum up to .98 of the image's radius, the maximum beyond,
//! and the median.

#[path = "../../tests/truth/pupil_fit/mod.rs"]
mod pupil_fit;

use std::f64::consts::TAU;

use pupil_fit::{Case, lenses, stopped};
use realistic_camera::sampling::DiskMapping;
use realistic_lab::timing::repeated;
use realistic_optics::{
    imaging::focus::Focus,
    lens::{Lens, cos4},
    prescription::{catalogue, read},
};

struct Field {
    height: f64,
    passing: f64,
    missed: f64,
    light: f64,
}

fn field(case: &Case, height: f64) -> Option<Field> {
    let point = [0.6 * height, -0.8 * height];
    let (mut count, mut light, mut inside) = (0, 0.0, 0.0);
    const N: u32 = 40;
    for i in 0..N * N {
        let u = (f64::from(i) + 0.5) / f64::from(N * N);
        let v = (f64::from(i) * 0.618_033_988_749_894_9 + 0.25).fract();
        let found = case.pupil.sample(point, DiskMapping::Concentric.map(u, v)?)?;
        if case.passes(point, found.slopes) {
            count += 1;
            light += found.area * cos4(found.slopes);
            inside += found.area;
        }
    }
    let n = f64::from(N * N);
    // Rays outside the map, where the pupil may continue.
    let (angles, radii) = (360, 40);
    let mut beside = 0.0;
    for i in 0..angles {
        for j in 0..radii {
            let square = 1.0 + 0.25 * ((f64::from(j) + 0.5) / f64::from(radii)).powi(2);
            let width = 0.25 * 2.0 * (f64::from(j) + 0.5) / f64::from(radii) / f64::from(radii);
            let (sin, cos) = (TAU * (f64::from(i) + 0.31) / f64::from(angles)).sin_cos();
            let r = square.sqrt();
            let Some(found) = case.pupil.sample(point, [r * cos, r * sin]) else { continue };
            if found.area.is_finite() && case.passes(point, found.slopes) {
                beside += found.area.abs() * width / f64::from(angles);
            }
        }
    }
    let missed = if inside > 0.0 { beside / (beside + inside / n) } else { 1.0 };
    Some(Field { height, passing: f64::from(count) / n, missed, light: light / n })
}

struct Found {
    /// Share of the samples that pass, weighted by light; then the least such share at a radius that receives a
    /// twentieth of the axis's light or more, and that radius.
    passing: f64,
    least: (f64, f64),
    /// Light missed relative to the light on the axis: the maximum up to .98 of the image's radius, the maximum beyond,
    /// and the median.
    missed: [f64; 3],
}

fn measure(case: &Case, verbose: bool) -> Found {
    let (reach, end) = (case.reach, case.pupil.image_radius());
    let lit = end.unwrap_or(reach).min(reach);
    let mut parts: Vec<f64> = (0..60).map(|k| (f64::from(k) + 0.37) / 60.0).collect();
    if end.is_some_and(|end| end <= reach) {
        parts.extend([0.985, 0.99, 0.995, 0.998, 0.999, 0.9995, 0.9999]);
    }
    let fields: Vec<(f64, Field)> =
        parts.iter().filter_map(|part| Some((*part, field(case, part * lit)?))).collect();
    let axis = fields[0].1.light;
    let (mut light, mut passing, mut least) = (0.0, 0.0, (1.0, 0.0));
    let (mut inner, mut outer, mut all) = (0.0_f64, 0.0_f64, Vec::new());
    for (part, field) in &fields {
        // `missed` is a share of the whole pupil; dividing it by the remaining share makes it relative to the light
        // found.
        let missed = field.missed / (1.0 - field.missed).max(f64::MIN_POSITIVE) * field.light / axis;
        let missed = if field.light > 0.0 { missed } else { 0.0 };
        if verbose {
            println!(
                "    {part:.6} {:.4} mm passing {:.4} missed {missed:.1e} light {:.2e}",
                field.height,
                field.passing,
                field.light / axis
            );
        }
        light += field.light;
        passing += field.light * field.passing;
        if field.light >= 0.05 * axis && field.passing < least.0 {
            least = (field.passing, *part);
        }
        if *part <= 0.98 {
            inner = inner.max(missed);
        } else {
            outer = outer.max(missed);
        }
        all.push(missed);
    }
    all.sort_by(f64::total_cmp);
    Found { passing: passing / light, least, missed: [inner, outer, all[all.len() / 2]] }
}

fn row(Found { passing, least, missed: [inner, outer, median] }: &Found) -> String {
    format!("{passing:.4} | {:.4} at {:.4} | {inner:.1e} | {outer:.1e} | {median:.1e}", least.0, least.1)
}

fn compare(name: &str, lens: &Lens, distance: f64, reach: f64, options: &[String]) -> bool {
    let is_given = |option: &str| options.iter().any(|given| given == option);
    let Some(case) = Case::try_reach(lens, distance, reach) else { return true };
    let runs = if is_given("--time") { 15 } else { 1 };
    let shortest = |times: Vec<f64>| times.into_iter().fold(f64::INFINITY, f64::min) * 1e3;
    let (_, times) = repeated(runs, || case.again());
    let own = measure(&case, is_given("--fields"));
    let report = case.pupil.build_report();
    let least = if name.starts_with("fisheye") { 0.98 } else { 0.99 };
    let [inner, outer, median] = own.missed;
    let ok = own.passing >= least && own.least.0 >= 0.96 && inner <= 3e-4 && outer <= 2e-3 && median <= 1e-4;
    println!(
        "{} | {name} | {} | {} nodes {} rays {:.2} ms | end {:?} | {:?}",
        if ok { "ok" } else { "NO" },
        row(&own),
        report.nodes,
        report.rays,
        shortest(times),
        case.pupil.image_radius(),
        case.pupil.given_up(),
    );
    ok
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut names: Vec<String> = arguments.iter().filter(|name| !name.starts_with("--")).cloned().collect();
    let random = names.iter().position(|name| name.parse::<u64>().is_ok()).map(|i| names.remove(i));
    if names.is_empty() && random.is_none() {
        names = catalogue::round().map(str::to_owned).collect();
    }
    let (mut good, mut all) = (0, 0);
    for name in names {
        let lens = if let Ok(text) = std::fs::read(&name) {
            read(&name, &text).expect("a lens")
        } else {
            catalogue::find(&name).expect("listed")
        };
        let lens = Lens::at_d_line(&lens);
        for stop in [None, Some(8.0)] {
            let lens = stopped(&lens, stop);
            let distance = Focus::new(&lens).expect("focal").film_distance(f64::INFINITY).expect("reachable");
            let reach = if arguments.iter().any(|a| a == "--small") { 3.05 } else { 21.7 };
            let label = format!("{name} {stop:?}");
            all += 1;
            good += u32::from(compare(&label, &lens, distance, reach, &arguments));
        }
    }
    if let Some(count) = random {
        for number in 0..count.parse::<u64>().expect("a number") {
            let random = lenses::camera(number);
            all += 1;
            good += u32::from(compare(
                &format!("camera {number}"),
                &random.lens,
                random.distance,
                random.corner,
                &arguments,
            ));
        }
    }
    println!("{good} of {all}");
}
