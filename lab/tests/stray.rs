//! Direct light and ghosts of the library against photons of all orders of reflection, and the energy balance of a
//! lens.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use realistic::{Camera, Sample, Transmission};
use realistic_lab::stray::{Balance, balance};
use realistic_light::{Ghosts, Lamp, Spray, Surfaces};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    prescription::{Coating, catalogue},
};

/// The quarter-wave film of MgF2.
const FILM: (f64, f64) = (1.38, 550.0 / 4.0 / 1.38);

/// Cells along a side of the library's grids: of the grid for the direct light, and of the grid for each pair.
type Cells = [usize; 2];

/// Returns the library's direct light and ghosts on the film's disk, per 1 W that enters.
fn product(lens: &Lens, coating: Coating, toward: [f64; 3], plane: f64, spot: f64, cells: Cells) -> [f64; 2] {
    let ghosts = Ghosts::new(lens, &Surfaces::new(lens, coating), plane);
    let lamp = Lamp::Distant(toward);
    let inside = |spray: &Spray| -> f64 {
        let lands = |landing: &&realistic_light::Landing| landing.point[0].hypot(landing.point[1]) <= spot;
        spray.landings().filter(lands).map(|landing| landing.watts).sum()
    };
    let direct = inside(&ghosts.spray(ghosts.direct(), lamp, cells[0]));
    let pairs: f64 = ghosts.pairs().map(|(_, path)| inside(&ghosts.spray(&path, lamp, cells[1]))).sum();
    // The power at 1 W/m² that meets the front surface: the irradiance times the area of the clear aperture's disk
    // projected along the light.
    let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
    let entering = entered(lens, toward.map(|x| x / length));
    [direct / entering, pairs / entering]
}

/// Returns the projected area of the front surface inside its clear aperture, m², as seen along the light.
fn entered(lens: &Lens, toward: [f64; 3]) -> f64 {
    // The power is the flux through the aperture's disk: all light that crosses the disk meets the surface, as long as
    // no ray enters over the edge.
    let area = std::f64::consts::PI * lens.front().semi_diameter.powi(2) * 1e-6;
    area * toward[2]
}

/// Radius of the film's disk, mm.
const SPOT: f64 = 20.0;

/// Compares the library's direct light and ghosts with the photons', and checks the energy balance: the library's
/// direct light and ghosts, plus the photons with further reflections, beside the film, on mounts and stop, and back to
/// the scene, add up to all light that enters. Every difference must be below `bound` standard errors; returns the
/// largest.
fn check(name: &str, field: f64, photons: u32, cells: Cells, bound: f64) -> f64 {
    let lens = Lens::at_d_line(&catalogue::find(name).expect("in the catalogue"));
    let plane = FirstOrder::of(&lens).expect("a focal length").rear_focal_point;
    let toward = [field.to_radians().tan(), 0.0, 1.0];
    let mut most: f64 = 0.0;
    for (coating, film) in [(Coating::Bare, None), (Coating::QuarterWave, Some(FILM))] {
        let truth @ Balance { direct, two, more, beside, blocked, back, .. } =
            balance(&lens, film, toward, plane, SPOT, photons, 9);
        let all = direct + two + more + beside + blocked + back;
        assert!((all - 1.0).abs() < 1e-12, "{name}: every photon ends somewhere, {all}");
        let [by_rays, by_pairs] = product(&lens, coating, toward, plane, SPOT, cells);
        let error = |share: f64| truth.error(share);
        // The error at the edges of a grid amounts to a few cells in ten thousand.
        let near = |a: f64, b: f64, what: &str| {
            let off = (a - b).abs() / (error(b).hypot(2e-3 * b).max(1.0 / f64::from(photons)));
            assert!(off < bound, "{name} at {field} degrees, {coating:?}: {what} {a}, by photons {b}");
            off
        };
        most = most.max(near(by_rays, direct, "direct")).max(near(by_pairs, two, "ghosts"));
        // Each term is measured separately.
        let whole = by_rays + by_pairs + more + beside + blocked + back;
        assert!((whole - 1.0).abs() < bound * error(direct).hypot(2e-3 * direct), "{name}: {whole}");
        println!(
            "| `{name}`, {field:.1}° | {coating:?} | {by_rays:.4}, {direct:.4} | {by_pairs:.2e}, {two:.2e} | {more:.1e} | \
             {beside:.2e} | {blocked:.4} | {back:.4} | {whole:.4} |"
        );
    }
    most
}

#[test]
fn every_watt_is_accounted_for() {
    let lenses =
        [("dgauss.50mm", 0.0), ("dgauss.50mm", 12.0), ("telephoto.250mm", 2.0), ("tessar.50mm", 10.0)];
    let most = lenses.into_iter().map(|(name, field)| check(name, field, 400_000, [400, 96], 4.0));
    println!("largest {:.2} standard errors", most.fold(0.0, f64::max));
}

/// Returns the largest angle from the axis, degrees, at which a lamp at infinity illuminates the whole front surface
/// and no ray enters over its edge.
fn whole_front(lens: &Lens) -> f64 {
    let front = lens.front();
    let step = 1e-3 * front.semi_diameter;
    let slopes = (1..=1000).map(|i| {
        let height = step * f64::from(i);
        ((front.sagitta(height) - front.sagitta(height - step)) / step).abs()
    });
    90.0 - slopes.fold(0.0, f64::max).atan().to_degrees()
}

/// Runs `work` on every lens of the catalogue in parallel; a few lenses take most of the time.
fn of_every_lens<R: Send>(work: impl Fn(&str) -> R + Sync) -> Vec<R> {
    std::thread::scope(|scope| {
        let work = &work;
        let all: Vec<_> = catalogue::round().map(|name| scope.spawn(move || work(name))).collect();
        all.into_iter().map(|own| own.join().expect("told above")).collect()
    })
}

/// Returns the number of photons for which a share of them has a standard error of 0.5 %. Most photons miss the pupil
/// of a wide front; the limit is 2 million, which take a second.
fn photons_for(share: f64) -> u32 {
    ((1.0 - share) / share / 0.005_f64.powi(2)).clamp(20_000.0, 2e6).ceil() as u32
}

#[test]
#[ignore = "a sweep of a minute and more, which .ci/run makes: photons through the whole catalogue"]
fn films_have_the_watts_of_photons_in_every_catalogue_lens() {
    // The deviation for each film, in standard errors, and whether the standard error meets its target.
    let of_a_lens = |name: &str| {
        let mut films = Vec::new();
        let lens = Lens::at_d_line(&catalogue::find(name).expect("in the catalogue"));
        let first_order = FirstOrder::of(&lens).expect("a focal length");
        let plane = first_order.rear_focal_point;
        let widest = whole_front(&lens) - 1.0;
        for part in [0.0, 1.0 / 3.0, 2.0 / 3.0] {
            let field = (part * SPOT / first_order.focal_length).atan().to_degrees().min(part * widest);
            let toward = [field.to_radians().tan(), 0.0, 1.0];
            for (coating, film) in [(Coating::Bare, None), (Coating::QuarterWave, Some(FILM))] {
                let [direct, pairs] = product(&lens, coating, toward, plane, SPOT, [300, 24]);
                let photons = photons_for(direct + pairs);
                let truth = balance(&lens, film, toward, plane, SPOT, photons, 9);
                // The library leaves out higher orders of reflection. Every photon has a fate, so this deviation is
                // also that of the library's light plus the other photons from all light that enters.
                let expected = truth.direct + truth.two;
                let error = truth.error(expected);
                let off = (direct + pairs - expected) / error;
                println!(
                    "| `{name}` | {field:.1}° | {coating:?} | {:.5} | {expected:.5} ± {error:.5} | {off:.2} |",
                    direct + pairs
                );
                let by_ghosts = (pairs - truth.two) / truth.error(truth.two).max(f64::from(photons).recip());
                assert!(by_ghosts.abs() < 4.5, "{name} at {field} degrees: ghosts {pairs}, {}", truth.two);
                films.push((off, error < 0.0055 * expected));
            }
        }
        films
    };
    let by_lens = of_every_lens(of_a_lens);
    let (lenses, films) = (by_lens.len(), by_lens.concat());
    let count = films.len() as u32;
    let precise = films.iter().filter(|(_, is_precise)| *is_precise).count();
    let beyond = films.iter().filter(|(off, _)| off.abs() > 3.0).count();
    let most = films.iter().map(|(off, _)| off.abs()).fold(0.0, f64::max);
    let squares: f64 = films.iter().map(|(off, _)| off * off).sum();
    println!("{lenses} lenses, {count} films: {beyond} beyond 3 standard errors, largest {most:.2}");
    println!("{precise} of them with a standard error of 0.5 %");
    let mean = squares / f64::from(count);
    println!("mean square {mean:.2}");
    // By chance, 0.4 of 144 normal deviates exceed 3, and the mean of their squares is 1 within 0.12.
    assert!(lenses >= 24 && beyond <= 1 && most < 4.0, "{beyond} of {count}, {most}");
    assert!(mean < 1.0 + 4.0 * (2.0 / f64::from(count)).sqrt(), "{mean}");
}

#[test]
#[ignore = "a sweep of a minute and more, which .ci/run makes: photons through the whole catalogue"]
fn every_watt_is_accounted_for_in_every_lens_of_the_catalogue() {
    let found = of_every_lens(|name| {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("in the catalogue"));
        let focal_length = FirstOrder::of(&lens).expect("a focal length").focal_length;
        // The lamp's image lies a third of the film's radius off the axis, and no light enters over the front's edge.
        let field = (SPOT / (3.0 * focal_length)).atan().to_degrees().min(10.0);
        check(name, field, 20_000, [200, 24], 4.5)
    });
    let (count, most) = (found.len(), found.into_iter().fold(0.0, f64::max));
    println!("{count} lenses; largest {most:.2} standard errors");
    assert!(count >= 24, "{count}");
}

/// Returns a direction uniformly distributed in a cone of the sky about `axis`, which lies in the plane of x and z.
fn within_cone(axis: [f64; 3], cosine: f64, random: &mut Xoshiro256PlusPlus) -> [f64; 3] {
    let z = 1.0 - random.random::<f64>() * (1.0 - cosine);
    let (sine, angle) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * random.random::<f64>());
    let across = [axis[2], 0.0, -axis[0]];
    std::array::from_fn(|k| {
        z * axis[k] + sine * (angle.cos() * across[k] + if k == 1 { angle.sin() } else { 0.0 })
    })
}

#[test]
fn a_cameras_ghosts_are_the_photons_that_are_reflected_twice() {
    let lenses = [("dgauss.50mm", 8.0), ("tessar.50mm", 5.0), ("sonnar.50mm", 5.0)];
    let coatings = [(Transmission::Bare, None), (Transmission::QuarterWave, Some(FILM))];
    std::thread::scope(|scope| {
        for (name, field) in lenses {
            for (transmission, film) in coatings {
                scope.spawn(move || compare_ghosts(name, field, transmission, film));
            }
        }
    });
}

/// Compares a camera's ghosts of a cone of the sky with photons from the same cone, which is 12 degrees wide and has
/// its middle `field` degrees off the axis.
fn compare_ghosts(name: &str, field: f64, transmission: Transmission, film: Option<(f64, f64)>) {
    let cosine = 6.0_f64.to_radians().cos();
    let solid_angle = std::f64::consts::TAU * (1.0 - cosine);
    let builder = Camera::builder().lens_file(name).transmission(transmission).ghosts(1.0);
    let camera = builder.film_diagonal(60.0).resolution(100, 100).build().expect("a camera");
    let facts = camera.facts().expect("a lens");
    let plane = facts.lens.rear().vertex - facts.film_distance;
    let axis = [field.to_radians().sin(), 0.0, field.to_radians().cos()];
    let mut random = Xoshiro256PlusPlus::seed_from_u64(4);
    let count = 400_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let sample = Sample {
            image_x: 100.0 * random.random::<f32>(),
            image_y: 100.0 * random.random::<f32>(),
            lens_u: random.random(),
            lens_v: random.random(),
            time: 0.5,
        };
        let point = facts.film.point(sample.image_x.into(), sample.image_y.into());
        if point[0].hypot(point[1]) > SPOT {
            continue;
        }
        let Some((ray, weight)) = camera.ray(&sample) else { continue };
        let along: f64 = (0..3).map(|k| axis[k] * f64::from(ray.direction[k])).sum();
        if along > cosine {
            sum += f64::from(weight);
            squares += f64::from(weight).powi(2);
        }
    }
    let n = f64::from(count);
    let area = 1e-6 * (100.0 * facts.film.pixel()).powi(2);
    let [seen, error] = [area * sum / n, area * ((squares / n - (sum / n).powi(2)) / n).sqrt()];
    // Photons give the same ghosts: directions of the cone, and from each the shares of the entering light.
    let directions = 40;
    let each: Vec<f64> = (0..directions)
        .map(|seed| {
            let toward = within_cone(axis, cosine, &mut random);
            let balance = balance(&facts.lens, film, toward, plane, SPOT, 15_000, seed);
            solid_angle * entered(&facts.lens, toward) * balance.two
        })
        .collect();
    let m = f64::from(directions as u32);
    let photons = each.iter().sum::<f64>() / m;
    let spread = (each.iter().map(|own| (own - photons).powi(2)).sum::<f64>() / (m * (m - 1.0))).sqrt();
    let off = (seen - photons) / error.hypot(spread);
    println!(
        "{name} {transmission}: camera {seen:.4e} +- {error:.1e} W, photons {photons:.4e} +- {spread:.1e} W: {off:.1} standard errors"
    );
    assert!(off.abs() < 4.0, "{name} {transmission}: {seen} {error} {photons} {spread}");
    // A coated lens reflects few photons twice.
    assert!(error < 0.025 * seen && spread < 0.15 * photons, "{name}: {error} {spread}");
}
