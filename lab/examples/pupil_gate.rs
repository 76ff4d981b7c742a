//! What the true pupils of film points pass and miss, by samples and by rays beside the map: the catalogue, lenses by name or
//! file, or so many random cameras, at 70 film radii each up to the last millionth of the image's: `pupil_gate [--time] [--fields]
//! [--small] [LENS]... [NUMBER]`. Of each the least share that passes up to .9999 of the image, beyond, and the mean; the most
//! that is missed, and the same weighted by irradiance.

#[path = "../../tests/truth/pupil_fit/mod.rs"]
mod pupil_fit;

use std::f64::consts::TAU;

use pupil_fit::{Case, lenses, stopped};
use realistic::unstable::{
    imaging::focus::Focus,
    lens::{Lens, cos4},
    prescription::{catalogue, read},
    sampling::DiskMapping,
};
use realistic_lab::timing::repeated;

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
    // Beside the map, where it goes on.
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
    /// least passing up to .9999, beyond, worst missed, weighted by irradiance, over passing mean
    inner: (f64, f64),
    outer: f64,
    mean: f64,
    missed: (f64, f64),
    weighted: (f64, f64),
}

fn look(case: &Case, verbose: bool) -> Found {
    let (reach, end) = (case.reach, case.pupil.image_radius());
    let lit = end.unwrap_or(reach).min(reach);
    let mut parts: Vec<f64> = (0..60).map(|k| (f64::from(k) + 0.37) / 60.0).collect();
    if end.is_some_and(|end| end <= reach) {
        parts.extend([0.99, 0.995, 0.998, 0.999, 0.9995, 0.9998, 0.99985, 0.99995, 0.99999, 0.999999]);
    }
    let fields: Vec<(f64, Field)> =
        parts.iter().filter_map(|part| Some((*part, field(case, part * lit)?))).collect();
    let axis = fields[0].1.light;
    let mut found =
        Found { inner: (1.0, 0.0), outer: 1.0, mean: 0.0, missed: (0.0, 0.0), weighted: (0.0, 0.0) };
    for (part, field) in &fields {
        if verbose {
            println!(
                "    {part:.6} {:.4} mm passing {:.4} missed {:.1e} light {:.2e}",
                field.height,
                field.passing,
                field.missed,
                field.light / axis
            );
        }
        let is_dark = field.passing == 0.0 && field.missed == 1.0;
        if end.is_none() && is_dark {
            continue;
        }
        if *part < 0.9999 {
            if field.passing < found.inner.0 {
                found.inner = (field.passing, *part);
            }
        } else {
            found.outer = found.outer.min(field.passing);
        }
        found.mean += field.passing / fields.len() as f64;
        if field.missed > found.missed.0 {
            found.missed = (field.missed, *part);
        }
        let weighted = field.missed * field.light / axis;
        if weighted > found.weighted.0 {
            found.weighted = (weighted, *part);
        }
    }
    found
}

fn row(found: &Found) -> String {
    let Found { inner, outer, mean, missed, weighted } = found;
    format!(
        "{:.4} at {:.4} | {outer:.3} | {mean:.4} | {:.1e} at {:.4} | {:.1e} at {:.4}",
        inner.0, inner.1, missed.0, missed.1, weighted.0, weighted.1
    )
}

fn compare(name: &str, lens: &Lens, distance: f64, reach: f64, options: &[String]) -> bool {
    let is_given = |option: &str| options.iter().any(|given| given == option);
    let Some(case) = Case::try_reach(lens, distance, reach) else { return true };
    let runs = if is_given("--time") { 15 } else { 1 };
    let least = |times: Vec<f64>| times.into_iter().fold(f64::INFINITY, f64::min) * 1e3;
    let (_, times) = repeated(runs, || case.again());
    let own = look(&case, is_given("--fields"));
    let report = case.pupil.build_report();
    let ok = own.inner.0 >= 0.99 && own.outer >= 0.95 && own.weighted.0 <= 1e-4;
    println!(
        "{} | {name} | {} | {} slices {} rays {:.2} ms | end {:?} | {:?}",
        if ok { "ok" } else { "NO" },
        row(&own),
        report.slices,
        report.rays,
        least(times),
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
        names = catalogue::names().map(str::to_owned).collect();
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
