//! Ghosts in a camera's rays: the direct rays beside them, samples that differ only in their film points, and the watts
//! on film compared with those of lamps.

use super::super::support::Random;
use crate::support::columns::RayAt as _;
use realistic::{Camera, CameraBuilder, DiskMapping, Outcome, Sample, Transmission, Weighting};
use realistic_light::{Ghosts, Lamp, LitPath, Surfaces};
use realistic_optics::prescription::Coating;

fn builder(name: &str, transmission: Transmission) -> CameraBuilder {
    Camera::builder().lens_file(name).transmission(transmission).film_diagonal(36.0).resolution(60, 40)
}

fn samples(count: usize) -> impl Iterator<Item = Sample> {
    let mut random = Random::new(31);
    let mut next = move |most: f64| (most * random.next()) as f32;
    (0..count).map(move |_| Sample {
        image_x: next(60.0),
        image_y: next(40.0),
        lens_u: next(1.0),
        lens_v: next(1.0),
        time: 0.5,
    })
}

#[test]
fn direct_rays_beside_ghosts_are_those_of_the_stretched_u() {
    let plain = builder("dgauss.50mm", Transmission::Bare).build().expect("a camera");
    let none = builder("dgauss.50mm", Transmission::Bare).ghosts(0.0).build().expect("a camera");
    let share = 0.25_f32;
    let camera = builder("dgauss.50mm", Transmission::Bare).ghosts(0.25).build().expect("a camera");
    let (mut direct, mut ghosts) = (0, 0);
    for sample in samples(3000) {
        assert_eq!(none.ray(&sample), plain.ray(&sample));
        let found = camera.ray(&sample);
        if sample.lens_u < share {
            ghosts += u32::from(found.is_some());
            continue;
        }
        let lens_u = ((f64::from(sample.lens_u) - 0.25) / 0.75) as f32;
        let own = plain.ray(&Sample { lens_u, ..sample });
        assert_eq!(found.is_some(), own.is_some());
        let (Some((ray, weight)), Some((same, whole))) = (found, own) else { continue };
        assert_eq!(ray, same);
        assert!((weight / whole * 0.75 - 1.0).abs() < 1e-6, "{weight} {whole}");
        direct += 1;
    }
    assert!(direct > 1500 && ghosts > 100, "{direct} {ghosts}");
}

#[test]
fn samples_that_differ_by_film_points_choose_alike() {
    let camera = builder("dgauss.50mm", Transmission::Bare).ghosts(1.0).build().expect("a camera");
    let (mut both, mut near) = (0, 0);
    for sample in samples(6000) {
        let beside = Sample { image_x: sample.image_x + 0.01, ..sample };
        let (Some((a, weight)), Some((b, other))) = (camera.ray(&sample), camera.ray(&beside)) else {
            continue;
        };
        both += 1;
        let turn: f32 = (0..3).map(|k| (a.direction[k] - b.direction[k]).powi(2)).sum();
        near += u32::from(turn.sqrt() < 0.05 && (weight / other - 1.0).abs() < 0.2);
    }
    // A ray reflected by another pair would go anywhere.
    assert!(both > 1000 && f64::from(near) > 0.97 * f64::from(both), "{near} of {both}");
}

#[test]
fn a_ghost_at_its_own_wavelength_is_the_cameras() {
    for (name, transmission) in
        [("dgauss.50mm", Transmission::QuarterWave), ("planar.50mm", Transmission::Bare)]
    {
        let camera = builder(name, transmission).ghosts(1.0).build().expect("a camera");
        let own = camera.facts().expect("a lens").lens.wavelength as f32;
        let (mut count, mut differ) = (0, 0);
        for sample in samples(2000) {
            let (Some((ray, weight)), Some((at, left))) = (camera.ray(&sample), camera.ray_at(&sample, own))
            else {
                continue;
            };
            for k in 0..3 {
                assert!((ray.direction[k] - at.direction[k]).abs() < 1e-4, "{name}: {ray:?} {at:?}");
            }
            assert!((left / weight - 1.0).abs() < 2e-3, "{name}: {left} {weight}");
            count += 1;
            if let Some((_, other)) = camera.ray_at(&sample, 430.0) {
                differ += u32::from((other / weight - 1.0).abs() > 0.01);
            }
        }
        assert!(count > 200 && differ > count / 2, "{name}: {count} {differ}");
    }
}

#[test]
fn ghosts_without_effect_are_refused_or_reported() {
    let error = builder("dgauss.50mm", Transmission::None).ghosts(0.5).build().expect_err("nothing reflects");
    assert!(error.to_string().contains("\"ghosts\" is 0.5, and without \"transmission\""), "{error}");
    let error = builder("dgauss.50mm", Transmission::Bare).ghosts(1.5).build().expect_err("out of range");
    assert!(error.to_string().contains("\"ghosts\" is 1.5; it must be"), "{error}");
    let mut warnings = String::new();
    let unweighted = builder("dgauss.50mm", Transmission::Bare).ghosts(0.5).weighting(Weighting::None);
    unweighted.build_with_log(&mut |_, text| warnings += text).expect("a camera");
    assert!(warnings.contains("\"ghosts\" changes nothing"), "{warnings}");
    // A host that can redraw gets `Redraw` for a rejected sample; a blocked ghost has a reason.
    let camera =
        builder("dgauss.50mm", Transmission::Bare).ghosts(1.0).disk(DiskMapping::Rejection).can_redraw(true);
    let camera = camera.build().expect("a camera");
    let (mut redrawn, mut blocked) = (0, 0);
    for sample in samples(500) {
        match camera.generate(&sample, None) {
            Outcome::Redraw => redrawn += 1,
            Outcome::Blocked(_) => blocked += 1,
            _ => {}
        }
    }
    assert!(redrawn > 50 && blocked > 20, "{redrawn} {blocked}");
}

/// Returns a direction in a cone of the sky, uniform in solid angle.
fn toward(axis: [f64; 3], cosine: f64, [u, v]: [f64; 2]) -> [f64; 3] {
    let z = 1.0 - u * (1.0 - cosine);
    let (sine, angle) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * v);
    // The axis lies in the plane of x and z.
    let across = [axis[2], 0.0, -axis[0]];
    std::array::from_fn(|k| {
        let up = if k == 1 { 1.0 } else { 0.0 };
        z * axis[k] + sine * (angle.cos() * across[k] + angle.sin() * up)
    })
}

#[test]
fn the_film_gets_the_watts_of_the_lamps() {
    let [bare, coated] =
        [(Transmission::Bare, Coating::Bare), (Transmission::ThreeLayer, Coating::ThreeLayer)];
    for (name, field, coatings) in [
        ("dgauss.50mm", 10.0_f64, &[bare, coated][..]),
        ("tessar.50mm", 5.0, &[bare]),
        ("retrofocus.24mm", 20.0, &[coated]),
    ] {
        for &(transmission, coating) in coatings {
            let camera = builder(name, transmission).ghosts(1.0).build().expect("a camera");
            let facts = camera.facts().expect("a lens");
            let (lens, film) = (&facts.lens, facts.lens.rear().vertex - facts.film_distance);
            let axis = [field.to_radians().sin(), 0.0, field.to_radians().cos()];
            let cosine = 6.0_f64.to_radians().cos();
            // A sky of radiance 1 fills a cone, as seen from the film.
            let half = [facts.film.pixel() * 30.0, facts.film.pixel() * 20.0];
            let count = 300_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for sample in samples(count) {
                if let Some((ray, weight)) = camera.ray(&sample) {
                    let along: f64 = (0..3).map(|k| axis[k] * f64::from(ray.direction[k])).sum();
                    if along > cosine {
                        sum += f64::from(weight);
                        squares += f64::from(weight).powi(2);
                    }
                }
            }
            let n = count as f64;
            let area = 4.0 * half[0] * half[1] * 1e-6;
            let (mean, spread) = (sum / n, (squares / n - (sum / n).powi(2)).sqrt() / n.sqrt());
            let [seen, error] = [area * mean, area * spread];
            // The same sky is represented by lamps.
            let ghosts = Ghosts::new(lens, &Surfaces::new(lens, coating), film);
            let solid_angle = std::f64::consts::TAU * (1.0 - cosine);
            let lamps = 24;
            let each: Vec<f64> = (0..lamps)
                .map(|i| {
                    // The points of the golden ratio's sequence are spread evenly over the cone.
                    let at =
                        [(f64::from(i) + 0.5) / f64::from(lamps), (f64::from(i) * 0.618_033_988_75).fract()];
                    let lamp = Lamp::Distant(toward(axis, cosine, at));
                    let on_film = |path: LitPath| {
                        let spray = ghosts.spray(&path, lamp, 24);
                        let inside = spray
                            .landings()
                            .filter(|landing| (0..2).all(|axis| landing.point[axis].abs() <= half[axis]));
                        inside.map(|landing| landing.watts).sum::<f64>()
                    };
                    ghosts.pairs().map(|(_, path)| on_film(path)).sum::<f64>()
                })
                .collect();
            let lit = solid_angle * each.iter().sum::<f64>() / f64::from(lamps);
            println!("{name} {coating:?}: from the film {seen:.4e} +- {error:.1e} W, from lamps {lit:.4e} W");
            assert!(error < 0.02 * seen, "{name} {coating:?}: {seen} {error}");
            // A few lamps and cells approximate the cone, to about a hundredth.
            assert!(
                (seen - lit).abs() < 4.0 * error.hypot(0.01 * lit),
                "{name} {coating:?}: {seen} {error} {lit}"
            );
        }
    }
}
