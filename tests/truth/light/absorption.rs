//! Absorption in glass: the law of Beer and Lambert along the paths of rays, compared with closed forms and with the
//! walk's own points.

use std::collections::BTreeMap;

use super::{super::support::Random, exact_surfaces};
use crate::support::columns::RayAt as _;
use realistic::{Camera, Precision, Sample, Transmission};
use realistic_light::LitPath;
use realistic_optics::{
    lens::{Lens, Ray, refraction::Refraction},
    prescription::{
        Coating, GlassLibrary, Interface, Prescription, Shape, catalogue, glass::refractive_index, read_with,
    },
    trace::{Direction, Path},
};

/// Two glasses that transmit 0.95 and 0.8 at 550 nm over 10 mm, and less of blue light.
const GLASSES: &str = "CC made up\n\
    NM CLEAR 2 0 1.5168 64.17 0\nCD 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\nLD 0.3 2.5\n\
    IT 0.38 0.90 10\nIT 0.42 0.93 10\nIT 0.55 0.95 10\nIT 0.78 0.96 10\n\
    NM DARK 2 0 1.785 25.7 0\nCD 1.73759695 0.013188707 0.313747346 0.0623068142 1.89878101 155.23629\nLD 0.36 2.5\n\
    IT 0.38 0.30 10\nIT 0.42 0.65 10\nIT 0.48 0.77 10\nIT 0.55 0.80 10\nIT 0.55 0.01 100\nIT 0.65 0.81 10\nIT 0.78 0.82 10\n";

/// A cemented pair and a stop.
const DOUBLET: &str = "40 6 CLEAR 20\n-30 2.5 DARK 20\n-110 4 1 20\n0 70 0 14\n";

fn lens_of(text: &str) -> Prescription {
    let mut library = GlassLibrary::default();
    library.add("own.agf", GLASSES.as_bytes()).expect("a catalogue");
    read_with("own.dat", text.as_bytes(), &library).expect("a lens")
}

/// Returns the lens with glasses that do not absorb.
fn clear(lens: &Lens) -> Lens {
    let mut clear = lens.clone();
    clear.surfaces.iter_mut().for_each(|surface| surface.absorption = 0.0);
    clear
}

#[test]
fn a_plate_absorbs_by_the_path_and_not_by_its_thickness() {
    // The path is 5 mm of the dark glass at 550 nm, at many angles.
    let lens = Lens::new(&lens_of("0 5 DARK 200\n0 0 1 200\n"), 550.0);
    let n = lens.surfaces[0].n_film;
    for direction in [Direction::SceneToFilm, Direction::FilmToScene] {
        let [dark, bright] = [lens.clone(), clear(&lens)].map(|lens| {
            LitPath::new(
                Path::new(&lens, direction, Refraction::Fused),
                &exact_surfaces(&lens, Coating::Bare),
            )
        });
        for degrees in [0.0_f64, 10.0, 45.0, 80.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let z = if direction == Direction::SceneToFilm { -1.0 } else { 1.0 };
            let origin = [0.0, 0.0, if z < 0.0 { 1.0 } else { -6.0 }];
            let ray = Ray { origin, direction: [sine, 0.0, z * cosine] };
            let [dark, bright] = [&dark, &bright].map(|path| path.trace(ray).expect("passes").1);
            let within = (1.0 - (sine / n).powi(2)).sqrt();
            let law = 0.8_f64.powf(5.0 / within / 10.0);
            assert!((dark / bright / law - 1.0).abs() < 1e-12, "{degrees}: {dark} {bright} {law}");
        }
    }
}

/// Two glasses with the same formula, one of which is a special melt, stay separate, whichever file names them.
#[test]
fn glasses_of_one_formula_absorb_each_by_itself_in_every_format() {
    let constants =
        "CD 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\nLD 0.3 2.5\n";
    let catalogue = format!(
        "CC made up\nNM OWN 2 0 1.5168 64.17 0\n{constants}IT 0.55 0.9 10\nNM OWN-HT 2 0 1.5168 64.17 0\n{constants}\
         IT 0.55 0.99 10\n"
    );
    let table = "20 5 OWN-HT 10\n-20 2 OWN 10\n-50 1 1 10\n30 2 OWN-HT 10\n60 30 1 10\n";
    let lines = "absorption N-BK7 550 0.010536051565782628\nabsorption N-BK7HT 550 0.0010050335853501441\n";
    let built_in = table.replace("OWN", "N-BK7").replace("N-BK7-HT", "N-BK7HT");
    let surface = |number: u32, radius: f64, gap: f64, glass: &str| {
        let glass = if glass.is_empty() { String::new() } else { format!("  GLAS {glass} 0 0\n") };
        format!("SURF {number}\n  CURV {}\n  DISZ {gap}\n{glass}  DIAM 5\n", radius.recip())
    };
    let zemax = "SURF 0\n  DISZ INFINITY\n".to_owned()
        + &surface(1, 20.0, 5.0, "OWN-HT")
        + &surface(2, -20.0, 2.0, "OWN")
        + &surface(3, -50.0, 1.0, "")
        + &surface(4, 30.0, 2.0, "OWN-HT")
        + &surface(5, 60.0, 30.0, "")
        + "SURF 6\n";
    for (file, text) in
        [("own.dat", table.to_owned()), ("own.dat", lines.to_owned() + &built_in), ("own.zmx", zemax)]
    {
        let mut library = GlassLibrary::default();
        library.add("own.agf", catalogue.as_bytes()).expect("a catalogue");
        let lens = read_with(file, text.as_bytes(), &library).expect("a lens");
        let lens = Lens::new(&lens, 550.0);
        for (surface, left) in lens.surfaces.iter().zip([0.99_f64, 0.9, 1.0, 0.99, 1.0]) {
            let expected = -left.ln() / 10.0;
            assert!(
                (surface.absorption - expected).abs() < 1e-15,
                "{file}: {} {expected}",
                surface.absorption
            );
        }
    }
}

/// Returns exp(-Σ α l) along the points of a walk.
fn by_points(lens: &Lens, path: &Path, ray: Ray) -> f64 {
    let mut met: Vec<(usize, [f64; 3])> = Vec::new();
    let kinds: Vec<usize> = path.step_kinds().map(|kind| kind.surface).collect();
    let _ = path.walk_by(ray, |number, point| met.push((kinds[number], point)));
    let depth: f64 = met
        .windows(2)
        .map(|pair| {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            let distance = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
            lens.surfaces[from.min(to)].absorption * distance
        })
        .sum();
    (-depth).exp()
}

#[test]
fn direct_light_and_ghosts_are_absorbed_along_the_walk() {
    let lens = Lens::new(&lens_of(DOUBLET), 550.0);
    let bright = clear(&lens);
    let mut random = Random::new(3);
    let mut compared = [0, 0];
    for direction in [Direction::SceneToFilm, Direction::FilmToScene] {
        let ghosts = [[0, 1], [0, 2], [1, 2]].map(|turns| {
            Path::reflected(
                &lens,
                direction,
                Refraction::Fused,
                if direction == Direction::SceneToFilm { turns } else { turns.map(|turn| turn + 1) },
            )
        });
        let paths = [Path::new(&lens, direction, Refraction::Fused)].into_iter().chain(ghosts);
        for (kind, path) in paths.enumerate() {
            let [dark, clear] = [&lens, &bright]
                .map(|lens| LitPath::new(path.clone(), &exact_surfaces(lens, Coating::QuarterWave)));
            for _ in 0..400 {
                let mut next = || 2.0 * random.next() - 1.0;
                let side = if direction == Direction::SceneToFilm { 1.0 } else { -1.0 };
                let z = if side > 0.0 { 8.0 } else { lens.rear().vertex - 1.0 };
                let ray = Ray {
                    origin: [8.0 * next(), 8.0 * next(), z],
                    direction: [0.2 * next(), 0.2 * next(), -side],
                };
                let (Ok((_, left)), Ok((_, whole))) = (dark.trace(ray), clear.trace(ray)) else {
                    continue;
                };
                let expected = by_points(&lens, &path, ray);
                assert!((left / whole / expected - 1.0).abs() < 1e-12, "{kind}: {left} {whole} {expected}");
                assert!(expected < 0.97);
                compared[usize::from(kind > 0)] += 1;
            }
        }
    }
    assert!(compared[0] > 300 && compared[1] > 300, "{compared:?}");
}

/// Returns the largest relative errors of a camera's weights, and the number of rays compared. The weights are compared
/// with the exact product over the camera's surfaces and the law along the points of the walk, at the camera's own
/// wavelength and at 380, 382, … 780 nm. Rays with less than a thousandth of the light left are skipped.
fn worst_weights(
    table: &str,
    catalogue: &str,
    film_diagonal: f64,
    precision: Precision,
) -> ([f64; 2], usize) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("own.agf"), catalogue).expect("written");
    let file = folder.path().join("own.dat");
    std::fs::write(&file, table).expect("written");
    let mut library = GlassLibrary::default();
    library.add("own.agf", catalogue.as_bytes()).expect("a catalogue");
    let prescription = read_with("own.dat", table.as_bytes(), &library).expect("a lens");
    let builder = Camera::builder().lens_file(file.to_str().expect("text")).film_diagonal(film_diagonal);
    let builder = builder.resolution(60, 40).precision(precision);
    let plain = builder.clone().build().expect("a camera");
    let camera = builder.transmission(Transmission::QuarterWave).build().expect("a camera");
    let mut walks = BTreeMap::new();
    let mut random = Random::new(29);
    let (mut most, mut count) = ([0.0_f64; 2], 0);
    for i in 0..1200 {
        let mut next = |most: f64| (most * random.next()) as f32;
        let sample = Sample {
            image_x: next(60.0),
            image_y: next(40.0),
            lens_u: next(1.0),
            lens_v: next(1.0),
            time: 0.5,
        };
        // The spectrum is steep below 430 nm.
        let wavelength = 380.0 + if i % 2 == 0 { (i % 50) as f32 } else { (i % 201) as f32 * 2.0 };
        for (kind, nm) in [(0, None), (1, Some(wavelength))] {
            let ray =
                |camera: &Camera| nm.map_or_else(|| camera.ray(&sample), |nm| camera.ray_at(&sample, nm));
            let (Some((ray, whole)), Some((_, left))) = (ray(&plain), ray(&camera)) else { continue };
            let (lens, path, lit) = walks.entry(nm.map(f32::to_bits)).or_insert_with(|| {
                let lens = Lens::new(&prescription, nm.map_or(587.56, f64::from));
                let path = Path::scene_to_film(&lens);
                let surfaces = exact_surfaces(&clear(&lens), Coating::QuarterWave);
                let lit = LitPath::new(path.clone(), &surfaces);
                (lens, path, lit)
            });
            let (o, d) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
            let back = Ray { origin: std::array::from_fn(|k| o[k] + d[k]), direction: d.map(|x| -x) };
            let Ok((_, surfaces)) = lit.trace(back) else { continue };
            let exact = surfaces * by_points(lens, path, back);
            if exact > 1e-3 {
                most[kind] = most[kind].max((f64::from(left / whole) / exact - 1.0).abs());
                count += 1;
            }
        }
    }
    (most, count)
}

#[test]
fn weights_have_absorption_at_every_wavelength() {
    let (most, count) = worst_weights(DOUBLET, GLASSES, 24.0, Precision::F64);
    println!("{most:?} of {count}");
    assert!(count > 1500 && most.iter().all(|most| *most < 1e-4), "{most:?} of {count}");
}

/// Ten SCHOTT glasses, from a light crown to flints that transmit nothing at 380 nm.
const SCHOTT: &str = include_str!("../../golden/schott.agf");

/// Returns a lens of the catalogue as a table, with each glass replaced by the glass of [`SCHOTT`] that has the nearest
/// index.
fn of_schott(name: &str) -> String {
    let known: Vec<(&str, f64)> = SCHOTT
        .lines()
        .filter_map(|line| line.strip_prefix("NM "))
        .map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            (words[0], words[3].parse().expect("n_d"))
        })
        .collect();
    let lens = catalogue::find(name).expect("listed");
    let row = |interface: &Interface| {
        let n = refractive_index(interface.medium, 587.56);
        let nearest = known.iter().min_by(|a, b| (a.1 - n).abs().total_cmp(&(b.1 - n).abs()));
        let glass = if n == 1.0 { "1" } else { nearest.expect("glasses").0 };
        let radius = match interface.shape {
            Shape::Sphere { radius } => radius,
            _ => 0.0,
        };
        format!("{radius} {} {glass} {}\n", interface.thickness, 2.0 * interface.semi_diameter)
    };
    lens.interfaces.iter().map(row).collect()
}

#[test]
fn weights_have_the_absorption_of_catalogue_glasses() {
    let known = SCHOTT.lines().filter_map(|line| line.strip_prefix("NM ")?.split(' ').next());
    let singlets = known.map(|glass| format!("40 5 {glass} 20\n-90 5 1 20\n0 40 1 14\n"));
    let tables = singlets.map(|table| (table, 20.0)).chain(
        ["dgauss.50mm", "tessar.50mm", "biotar.100mm", "retrofocus.24mm", "telephoto.250mm"]
            .map(|name| (of_schott(name), 36.0)),
    );
    let mut rays = 0;
    for (i, (table, film_diagonal)) in tables.enumerate() {
        let precision = [Precision::F64, Precision::F32][i % 2];
        let (most, count) = worst_weights(&table, SCHOTT, film_diagonal, precision);
        println!("{most:?} of {count}: {precision:?} {}", table.lines().next().expect("rows"));
        assert!(most.iter().all(|most| *most < 1e-4), "{most:?} of {count}:\n{table}");
        rays += count;
    }
    assert!(rays > 30_000, "{rays}");
}

/// Checks a glass of which 5 mm transmit exp(-1000) of the light at the camera's own wavelength, but which is clear at
/// another wavelength: the image is dark at the one and bright at the other.
#[test]
fn a_lens_that_absorbs_all_light_is_dark() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("own.dat");
    let table = "40 5 N-BK7 20\n-90 5 1 20\n0 40 1 14\nabsorption N-BK7 500 0 560 200 650 200 700 0\n";
    std::fs::write(&file, table).expect("written");
    let builder = Camera::builder().lens_file(file.to_str().expect("text")).film_diagonal(20.0);
    for precision in [Precision::F64, Precision::F32] {
        let builder = builder.clone().resolution(60, 40).precision(precision);
        let camera = builder.transmission(Transmission::Bare).build().expect("a camera");
        let mut passed = 0;
        for i in 0..64 {
            let at = (i as f32 + 0.5) / 64.0;
            let sample =
                Sample { image_x: 30.0 + 8.0 * at, image_y: 20.0, lens_u: at, lens_v: 0.4, time: 0.5 };
            let weight = |nm: Option<f32>| {
                nm.map_or_else(|| camera.ray(&sample), |nm| camera.ray_at(&sample, nm))
                    .map_or(0.0, |ray| ray.1)
            };
            let [own, dark, clear] = [None, Some(600.0), Some(450.0)].map(weight);
            assert!(own < 1e-20 && dark < 1e-20, "{own} {dark} {clear}");
            passed += usize::from(clear > 1e-4);
        }
        assert!(passed > 30, "{passed}");
    }
}
