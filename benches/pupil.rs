//! How well the warped pupil fits, what it costs to build and to draw from: a table of the catalogue's
//! lenses and stops. `cargo bench --bench pupil`.

use std::{hint::black_box, time::Instant};

use realistic::{
    camera::{
        DiskMapping, PupilDisk, WarpedPupil,
        irradiance::{cos4, film_ray},
    },
    optics::{Lens, first_order::FirstOrder, focus::Focus, pupil},
    prescription::catalogue,
    trace::Path,
};

const REACH: f64 = 17.6;

fn lens_at(name: &str, fnumber: Option<f64>) -> Lens {
    let mut lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    if let Some(fnumber) = fnumber {
        let stop = lens.stop_index().expect("has a stop");
        let focal_length = FirstOrder::of(&lens).expect("focal").focal_length;
        let imaged = pupil::EntrancePupil::of_surface(&lens, stop).diameter();
        lens.surfaces[stop].semi_diameter *= (focal_length / fnumber / imaged).min(1.0);
    }
    lens
}

/// Acceptance, missed share, both from the map's rim and a bisection along each of its half-lines.
fn fit(pupil: &WarpedPupil, path: &Path, film: f64, point: [f64; 2]) -> Option<(f64, f64)> {
    let center = pupil.draw(point, [0.0, 0.0])?.slopes;
    let n = 1500;
    let (mut inside, mut mapped, mut truth) = (0.0, 0.0, 0.0);
    let mut before: Option<f64> = None;
    let mut first = 0.0;
    let mut rows = Vec::new();
    for i in 0..=n {
        let phi = std::f64::consts::TAU * (f64::from(i) + 0.31) / f64::from(n);
        let [x, y] = pupil.draw(point, [phi.cos(), phi.sin()])?.slopes;
        let (dx, dy) = (x - center[0], y - center[1]);
        let radius = dx.hypot(dy);
        let passes = |r: f64| {
            let slopes = [center[0] + r / radius * dx, center[1] + r / radius * dy];
            path.trace(film_ray(point, film, slopes)).is_ok()
        };
        let (mut low, mut high) = (0.0, 2.0 * radius);
        if passes(0.9 * radius) { low = 0.9 * radius }
        if !passes(1.05 * radius) { high = 1.05 * radius }
        while high - low > 1e-7 * radius {
            let middle = f64::midpoint(low, high);
            if passes(middle) { low = middle } else { high = middle }
        }
        rows.push((dy.atan2(dx), radius, low));
    }
    for &(angle, radius, edge) in &rows {
        if let Some(old) = before {
            let width = (angle - old + 9.0 * std::f64::consts::PI) % std::f64::consts::TAU - std::f64::consts::PI;
            inside += radius.min(edge).powi(2) * width;
            mapped += radius * radius * width;
            truth += edge * edge * width;
        } else {
            first = angle;
        }
        before = Some(angle);
    }
    black_box(first);
    Some((inside / mapped, 1.0 - inside / truth))
}

/// Relative variance of one sample's weight and its mean.
fn variance(pupil: &WarpedPupil, path: &Path, film: f64, point: [f64; 2]) -> Option<(f64, f64)> {
    let n = 150;
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..n {
        for j in 0..n {
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
            let disk = DiskMapping::Concentric.map(at(i), at(j))?;
            let drawn = pupil.draw(point, disk)?;
            if path.trace(film_ray(point, film, drawn.slopes)).is_ok() {
                let weight = drawn.area * cos4(drawn.slopes);
                sum += weight;
                squares += weight * weight;
            }
        }
    }
    let count = f64::from(n * n);
    let mean = sum / count;
    Some((squares / count / (mean * mean) - 1.0, mean))
}

fn main() {
    let quick = std::env::args().any(|a| a == "quick");
    println!("lens stop: build ms (rays, rows, KB, covered) | ns a draw | worst acceptance (at), worst missed (at), variance axis/half/corner");
    for name in ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"] {
        if std::env::args().nth(1).is_some_and(|a| a != "quick" && a != name && a != "--bench") { continue }
        for fnumber in [None, Some(8.0), Some(22.0)] {
            let lens = lens_at(name, fnumber);
            let film = lens.rear().vertex
                - Focus::new(&lens).expect("focal").film_distance(f64::INFINITY).expect("reachable");
            let path = Path::<f64>::film_to_scene(&lens);
            let cover = PupilDisk::rear(&lens, film, REACH).expect("behind");
            let drift = PupilDisk::exit(&lens, film).seen_from([1.0, 0.0]).center[0];
            let mut times: Vec<f64> = (0..9)
                .map(|_| {
                    let start = Instant::now();
                    black_box(WarpedPupil::new(&path, film, REACH, cover, drift));
                    start.elapsed().as_secs_f64() * 1e3
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let pupil = WarpedPupil::new(&path, film, REACH, cover, drift);
            let report = pupil.build_report();
            let n = 200_000_u32;
            let mut ns: Vec<f64> = (0..5)
                .map(|_| {
                    let start = Instant::now();
                    let mut sum = 0.0;
                    for i in 0..n {
                        let x = f64::from(i.wrapping_mul(2_654_435_769) >> 8) / f64::from(1 << 24);
                        let y = f64::from(i.wrapping_mul(0x9E37_79B1 ^ 0x5555) >> 8) / f64::from(1 << 24);
                        if let Some(drawn) = pupil.draw([24.0 * (x - 0.5), 24.0 * (y - 0.5)], [0.7 * y, 0.7 * x]) {
                            sum += drawn.area + drawn.slopes[0];
                        }
                    }
                    black_box(sum);
                    start.elapsed().as_secs_f64() * 1e9 / f64::from(n)
                })
                .collect();
            ns.sort_by(f64::total_cmp);
            let limit = pupil.image_radius().map_or(17.5, |r| 0.999 * r);
            let steps = if quick { 13 } else { 41 };
            let (mut least, mut least_at, mut most, mut most_at) = (1.0, 0.0, 0.0, 0.0);
            let mut sums = (0.0, 0.0);
            for i in 0..steps {
                let height = limit * (f64::from(i) + 0.5) / f64::from(steps);
                let point = [0.6 * height, -0.8 * height];
                let Some((acceptance, missed)) = fit(&pupil, &path, film, point) else { continue };
                if std::env::var_os("EACH").is_some() {
                    println!("    {height:.3} {acceptance:.5} {missed:.2e}");
                }
                sums.0 += acceptance / f64::from(steps);
                sums.1 += missed / f64::from(steps);
                if acceptance < least {
                    (least, least_at) = (acceptance, height);
                }
                if missed > most {
                    (most, most_at) = (missed, height);
                }
            }
            let fields = [0.0, 8.75, 17.5].map(|h| {
                variance(&pupil, &path, film, [h, 0.0]).map_or("dark".into(), |v| format!("{:.5}", v.0))
            });
            println!(
                "{name} {}: {:.2} ms ({} rays, {} rows, {} KB, covered {:.3}) | {:.1} ns | acceptance {least:.4} ({least_at:.2}; mean {:.4}), missed {most:.1e} ({most_at:.2}; mean {:.1e}), variance {} | dark from {:?}",
                fnumber.map_or("full".into(), |n| format!("f/{n}")),
                times[4],
                report.rays,
                report.rows,
                report.rows * 262 * 4 / 1024,
                report.covered,
                ns[2],
                sums.0,
                sums.1,
                fields.join("/"),
                pupil.image_radius(),
            );
        }
    }
}
