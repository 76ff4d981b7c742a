//! Benchmarks the warped pupil: its fit, and the times to build and to sample it, for the catalogue's lenses at several
//! stops: `cargo bench --bench pupil`. Times are medians and minima of several runs.

#[path = "../tests/truth/pupil_fit/mod.rs"]
mod pupil_fit;

use std::hint::black_box;

use pupil_fit::{Case, LENSES, REACH, STOPS};
use realistic_camera::sampling::WarpedPupil;
use realistic_lab::{results::statistics::quantile, subject::quasirandom::spread, timing::repeated};

const CORNER: f64 = 17.5;

fn main() {
    println!(
        "| lens | stop | acceptance worst / mean | missed worst / mean | variance axis / half / corner | \
         build ms median / least | rays | slices | ns per sample |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let points: Vec<[f64; 2]> = spread(0.0).take(SAMPLES).collect();
    let mut ends = Vec::new();
    for name in LENSES {
        for stop in STOPS {
            let case = Case::of(name, stop);
            let (_, build) =
                repeated(15, || WarpedPupil::new(&case.path, case.film, REACH, [case.cover, case.exit]));
            let (_, sampling) = repeated(9, || black_box(sample_all(&case.pupil, &points)));
            let limit = case.lit_radius(CORNER);
            let fields: Vec<(f64, f64)> = (0..40)
                .map(|i| {
                    let height = limit * (f64::from(i) + 0.5) / 40.0;
                    case.fit([0.6 * height, -0.8 * height], 1000)
                })
                .collect();
            let mean = |part: fn(&(f64, f64)) -> f64| fields.iter().map(part).sum::<f64>() / 40.0;
            let worst_acceptance = fields.iter().map(|f| f.0).fold(1.0, f64::min);
            let worst_missed = fields.iter().map(|f| f.1).fold(0.0, f64::max);
            let variance = [0.0, CORNER / 2.0, CORNER]
                .map(|height| case.weight([height, 0.0], 150).1)
                .map(|variance| if variance.is_nan() { "dark".to_owned() } else { format!("{variance:.5}") });
            if let Some(end) = case.pupil.image_radius() {
                ends.push((name, stop, near_end(&case, end)));
            }
            let report = case.pupil.build_report();
            println!(
                "| {name} | {} | {worst_acceptance:.4} / {:.4} | {worst_missed:.1e} / {:.1e} | {} | {:.2} / {:.2} | {} | {} \
                 | {:.1} |",
                stop_name(stop),
                mean(|f| f.0),
                mean(|f| f.1),
                variance.join(" / "),
                quantile(&build, 0.5) * 1e3,
                quantile(&build, 0.0) * 1e3,
                report.rays,
                report.nodes,
                quantile(&sampling, 0.0) * 1e9 / SAMPLES as f64,
            );
        }
    }
    println!("\nPasses / missed near the end of the image, by the distance from it over its radius:\n");
    println!("| lens | stop | {} |", PARTS.map(|part| format!("{part:.0e}")).join(" | "));
    println!("|---|---{}|", "|---".repeat(PARTS.len()));
    for (name, stop, shares) in ends {
        println!("| {name} | {} | {} |", stop_name(stop), shares.join(" | "));
    }
}

/// Distances of film points from the end of the image, relative to the image's radius.
const PARTS: [f64; 7] = [3e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4];

fn near_end(case: &Case, end: f64) -> Vec<String> {
    let shares = |part: f64| {
        let height = end * (1.0 - part);
        let (acceptance, missed) = case.fit([0.6 * height, -0.8 * height], 1000);
        format!("{acceptance:.4} / {missed:.0e}")
    };
    PARTS.map(shares).to_vec()
}

fn stop_name(stop: Option<f64>) -> String {
    stop.map_or("full".to_owned(), |number| format!("f/{number}"))
}

const SAMPLES: usize = 100_000;

/// Samples all film points.
fn sample_all(pupil: &WarpedPupil, points: &[[f64; 2]]) -> f64 {
    points
        .iter()
        .filter_map(|[x, y]| {
            pupil.sample([24.0 * (x - 0.5), 24.0 * (y - 0.5)], [1.4 * y - 0.7, 1.4 * x - 0.7])
        })
        .map(|sample| sample.area + sample.slopes[0])
        .sum()
}
