//! How well the warped pupil fits, and what it costs to build and to draw from, for the catalogue's lenses
//! and stops: `cargo bench --bench pupil`. Times are medians and minima of several runs.

#[path = "../tests/truth/pupil_fit/mod.rs"]
mod pupil_fit;

use std::{hint::black_box, time::Instant};

use pupil_fit::{Case, LENSES, REACH, STOPS};
use realistic::sampling::WarpedPupil;

const CORNER: f64 = 17.5;

fn main() {
    println!(
        "| lens | stop | acceptance worst / mean | missed worst / mean | variance axis / half / corner | \
         build ms median / least | rays | rows | ns a draw |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut ends = Vec::new();
    for name in LENSES {
        for stop in STOPS {
            let case = Case::of(name, stop);
            let build = times(15, || {
                black_box(WarpedPupil::new(&case.path, case.film, REACH, case.cover, case.drift));
            });
            let draws = times(9, || {
                black_box(draw_all(&case.pupil));
            });
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
                build[build.len() / 2] * 1e3,
                build[0] * 1e3,
                report.rays,
                report.slices,
                draws[0] * 1e9 / f64::from(DRAWS),
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

/// Distances from the end of the image over its radius.
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

/// Seconds of every run, sorted.
fn times(runs: u32, mut work: impl FnMut()) -> Vec<f64> {
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times
}

const DRAWS: u32 = 100_000;

/// Draws all over the film.
fn draw_all(pupil: &WarpedPupil) -> f64 {
    let fraction = |i: u32, factor: u32| f64::from(i.wrapping_mul(factor) >> 8) / f64::from(1 << 24);
    (0..DRAWS)
        .filter_map(|i| {
            let (x, y) = (fraction(i, 0x9E37_79B1), fraction(i, 0x85EB_CA6B));
            pupil.sample([24.0 * (x - 0.5), 24.0 * (y - 0.5)], [1.4 * y - 0.7, 1.4 * x - 0.7])
        })
        .map(|drawn| drawn.area + drawn.slopes[0])
        .sum()
}
