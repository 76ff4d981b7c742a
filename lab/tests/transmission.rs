//! The effect of `transmission` on rays, against the exact product over their surfaces. The lenses are the catalogue's
//! at three stops, and random lenses of spheres and of aspheres; they are bare or coated, at the camera's own
//! wavelength and at others.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus as Random;
use realistic_camera::{Camera, CameraBuilder, Precision, Pupil, Sample, Transmission, coatings};
use realistic_lab::columns::RayAt as _;
use realistic_lab::stability::random::{aspheric_lens_text, lens_text};
use realistic_light::{LitPath, Surfaces};
use realistic_optics::{
    lens::{Lens, Ray},
    prescription::{Prescription, SurfaceCoating, catalogue, glass::refractive_index, read},
    trace::Path,
};

/// Documented relative accuracy.
const PROMISED: f64 = 1e-4;
const COATINGS: [Transmission; 4] =
    [Transmission::Bare, Transmission::QuarterWave, Transmission::VCoat, Transmission::ThreeLayer];

/// The largest relative difference from the exact product, and the number of rays compared.
#[derive(Default)]
struct Worst {
    most: f64,
    rays: u32,
}

impl Worst {
    /// Compares a ray whose weights with and without transmission have this ratio.
    fn compare(&mut self, lens: &Lens, coatings: &[SurfaceCoating], ray: [[f32; 3]; 2], ratio: f64) {
        let lit = LitPath::new(Path::scene_to_film(lens), &Surfaces::untabulated(lens, coatings));
        let [o, d] = ray.map(|vector| vector.map(f64::from));
        let exact = |o: [f64; 3], d: [f64; 3]| {
            let back = Ray { origin: std::array::from_fn(|k| o[k] + d[k]), direction: d.map(|x| -x) };
            lit.trace(back).ok().map(|(_, left)| left)
        };
        let Some(own) = exact(o, d) else { return };
        let mut off = (ratio / own - 1.0).abs();
        if off > PROMISED {
            // The ray's components are rounded to single precision, which changes the result more near grazing
            // incidence.
            for (vector, k) in (0..6).map(|number| (number / 3, number % 3)) {
                let moved = |by: f64| {
                    let mut all = [o, d];
                    all[vector][k] += by * f64::from(f32::EPSILON) * all[vector][k].abs();
                    exact(all[0], all[1]).map_or(0.0, |left| (left / own - 1.0).abs())
                };
                off -= moved(0.5).max(moved(-0.5));
            }
        }
        self.most = self.most.max(off);
        self.rays += 1;
    }

    fn add(&mut self, name: &str, found: Self) {
        if found.most > PROMISED {
            println!("{name}: {:e} of {}", found.most, found.rays);
        }
        self.most = self.most.max(found.most);
        self.rays += found.rays;
    }
}

/// Returns the lens of a camera at another wavelength, nm.
fn at(prescription: &Prescription, own: &Lens, nm: f64) -> Lens {
    let mut lens = Lens { wavelength: nm, ..own.clone() };
    let mut n = 1.0;
    for (surface, interface) in lens.surfaces.iter_mut().zip(&prescription.interfaces) {
        surface.n_scene = n;
        n = refractive_index(interface.medium, nm);
        surface.n_film = n;
    }
    lens
}

/// Compares some samples of a camera, at its own wavelength and at others. Returns `None` if the camera cannot be
/// built.
fn worst(
    prescription: &Prescription,
    builder: &CameraBuilder,
    transmission: Transmission,
    samples: u32,
) -> Option<Worst> {
    let coatings = coatings(transmission, prescription).expect("coatings").expect("light is lost");
    // At other wavelengths, a coated camera of a lens without dispersion has the plain camera's pupil only if that
    // pupil is a disk.
    let builder = builder.clone().pupil(Pupil::Rear);
    let plain = builder.clone().build().ok()?;
    let camera = builder.transmission(transmission).build().ok()?;
    let own = &camera.facts().expect("a lens").lens;
    let (mut random, mut found) = (Random::seed_from_u64(41), Worst::default());
    for _ in 0..samples {
        let [x, y, lens_u, lens_v] = [60.0, 40.0, 1.0, 1.0].map(|most: f32| most * random.random::<f32>());
        let sample = Sample { image_x: x, image_y: y, lens_u, lens_v, time: 0.5 };
        let nm = random.random_range(400.0_f32..700.0);
        for nm in [None, Some(nm)] {
            let ray =
                |camera: &Camera| nm.map_or_else(|| camera.ray(&sample), |nm| camera.ray_at(&sample, nm));
            let (Some((ray, whole)), Some((_, left))) = (ray(&plain), ray(&camera)) else { continue };
            let lens = at(prescription, own, nm.map_or(own.wavelength, f64::from));
            found.compare(&lens, &coatings, [ray.origin, ray.direction], f64::from(left / whole));
        }
    }
    Some(found)
}

/// Compares a lens of the catalogue at its own f-number times a factor. The film is as wide as the lens's image.
fn of_catalogue(name: &str, closed: f32, number: usize, samples: u32) -> Worst {
    let film_diagonal = match name {
        "phone.4mm" => 6.0,
        "fisheye.6mm" => 20.0,
        _ => 36.0,
    };
    let prescription = catalogue::find(name).expect("listed");
    let builder = Camera::builder().lens_file(name).film_diagonal(film_diagonal).resolution(60, 40);
    let open = builder.clone().build().expect("a camera");
    let facts = open.facts().expect("a lens");
    let stop = facts.lens.stop_index().map(|stop| facts.lens.surfaces[stop].semi_diameter as f32);
    let builder = builder.aperture_diameter(2.0 * stop.expect("a stop") / closed);
    worst(&prescription, &builder, COATINGS[number % COATINGS.len()], samples).expect("a camera")
}

/// Compares a random lens on film beside its last surface; `None` if no lens can be made of the text.
fn of_text(text: &str, number: usize, samples: u32) -> Option<Worst> {
    let prescription = read("own.dat", text.as_bytes()).ok()?;
    let rear = prescription.interfaces.last()?.semi_diameter as f32;
    let builder = Camera::builder().lens_text("own.dat", text.as_bytes()).resolution(60, 40);
    let builder = builder.film_distance(2.0 * rear).film_diagonal(1.5 * rear);
    worst(&prescription, &builder, COATINGS[number % COATINGS.len()], samples)
}

#[test]
fn every_ray_has_the_product_of_its_surfaces() {
    let mut all = Worst::default();
    for (number, name) in ["phone.4mm", "fisheye.6mm", "dgauss.50mm"].into_iter().enumerate() {
        all.add(name, of_catalogue(name, 1.0, number, 300));
    }
    for seed in 0..6 {
        let spheres = lens_text(&mut Random::seed_from_u64(seed));
        for (number, text) in [spheres, aspheric_lens_text(seed)].iter().enumerate() {
            all.add(text, of_text(text, number, 200).unwrap_or_default());
        }
    }
    println!("{:e} of {}", all.most, all.rays);
    assert!(all.most < PROMISED && all.rays > 500, "{:e} of {}", all.most, all.rays);
}

/// A plano-convex lens with a dichroic mirror of 2 x 12 quarter waves and a stack of 5 layers, behind a bare plate.
const STACKS: &str = "40 4 1.62 36 20\n0 2 - - 20\n0 3 1.52 64 20\n0 30 - - 20\n";

#[test]
fn thick_stacks_are_computed_for_every_ray() {
    let quarters = |index: f64, nm: f64| format!(" {index} {}", nm / 4.0 / index);
    let mirror: String = (0..12).map(|_| quarters(2.3, 480.0) + &quarters(1.46, 480.0)).collect();
    let other = quarters(1.38, 550.0) + &quarters(2.1, 1100.0) + &quarters(1.7, 550.0) + " 1.9 40 1.45 260";
    let text =
        format!("{STACKS}coating 1 stack{mirror}\ncoating 2 stack{other}\ncoating 3 bare\ncoating 4 bare\n");
    let prescription = read("own.dat", text.as_bytes()).expect("a lens");
    for precision in [Precision::F64, Precision::F32] {
        let builder = Camera::builder().lens_text("own.dat", text.as_bytes()).resolution(60, 40);
        let builder = builder.precision(precision).film_distance(60.0).film_diagonal(20.0);
        let found = worst(&prescription, &builder, Transmission::File, 400).expect("a camera");
        println!("{precision}: {:e} of {}", found.most, found.rays);
        assert!(found.most < PROMISED && found.rays > 300, "{precision}: {:e} of {}", found.most, found.rays);
    }
}

/// Runs many comparisons in parallel, each in its own thread, and returns the worst of them with its name.
fn side_by_side<T: Send>(
    items: impl Iterator<Item = T>,
    work: impl Fn(T) -> Vec<(String, Worst)> + Sync,
) -> Worst {
    let mut all = Worst::default();
    std::thread::scope(|scope| {
        let work = &work;
        let each: Vec<_> = items.map(|item| scope.spawn(move || work(item))).collect();
        let found = each.into_iter().flat_map(|own| own.join().expect("told above"));
        found.for_each(|(name, found)| all.add(&name, found));
    });
    all
}

#[test]
#[ignore = "a sweep of minutes, which .ci/run makes: the catalogue at three stops and 60 random lenses"]
fn every_ray_of_any_lens_has_the_product_of_its_surfaces() {
    let all = side_by_side(catalogue::round(), |name| {
        let cameras = [(0, 1.0), (1, 1.0), (2, 2.0), (3, 2.0), (0, 5.0), (1, 5.0)];
        let found =
            |(number, closed)| (format!("{name} {closed} {number}"), of_catalogue(name, closed, number, 500));
        cameras.map(found).into()
    });
    println!("the catalogue: {:e} of {}", all.most, all.rays);
    assert!(all.most < PROMISED && all.rays > 20_000, "{:e} of {}", all.most, all.rays);
    let random = side_by_side(0..30, |seed| {
        let spheres = lens_text(&mut Random::seed_from_u64(seed));
        let found = |(kind, text): (usize, &String)| {
            let number = seed as usize + kind;
            (format!("{number}:\n{text}"), of_text(text, number, 400).unwrap_or_default())
        };
        [spheres, aspheric_lens_text(seed)].iter().enumerate().map(found).collect()
    });
    println!("random lenses: {:e} of {}", random.most, random.rays);
    assert!(random.most < PROMISED && random.rays > 5_000, "{:e} of {}", random.most, random.rays);
}
