//! The library's stock cameras against rays of pbrt 1.05's stock plugins (`golden/stock_cameras.txt`), for camera
//! transforms that only rotate, translate and mirror: some kinds of camera have the same bits as pbrt, and the
//! differences of the others are bounded. Transforms that scale or shear change the direction's length in pbrt's rays,
//! while this library's directions are unit vectors.

use std::{collections::BTreeMap, path::Path};

use ::realistic_camera::{Camera, CameraToWorld, Host, Outcome, Parameters, Raster, Sample};

/// The property that determines whether a camera has pbrt's bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Perspective or orthographic, without a lens, and placed by a transform whose exact inverse pbrt has: the bits
    /// are the same.
    Linear,
    /// Environment, or with a lens: the rays depend on sines and cosines, which differ between C libraries.
    Trigonometric,
    /// Placed by a matrix that pbrt inverts with rounding in the last row.
    Inverted,
}

/// A camera of the file with its rays.
struct Stock {
    name: String,
    camera: Camera,
    kind: Kind,
    rays: Vec<[f32; 14]>,
}

fn stock() -> Vec<Stock> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/stock_cameras.txt");
    let text = std::fs::read_to_string(path).expect("the golden file");
    let mut cameras: Vec<Stock> = Vec::new();
    let (mut name, mut matrix) = (String::new(), [0.0; 16]);
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let (what, rest) = line.split_once(' ').expect("a word and what follows");
        match what {
            "camera" => name = rest.to_owned(),
            "matrix" => matrix = numbers(rest),
            "inverse" => cameras.push(build(&name, &matrix, &numbers(rest))),
            "ray" => cameras.last_mut().expect("a camera first").rays.push(numbers(rest)),
            other => panic!("{other}"),
        }
    }
    cameras
}

fn numbers<const N: usize>(text: &str) -> [f32; N] {
    let numbers: Vec<f32> = text.split(' ').map(|word| word.parse().expect("a number")).collect();
    numbers.try_into().expect("as many as there should be")
}

fn build(line: &str, matrix: &[f32; 16], inverse: &[f32; 16]) -> Stock {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [model, xres, yres, settings @ ..] = words.as_slice() else { panic!("{line}") };
    let mut parameters = Parameters::default();
    parameters.set_from_text("model", model).expect("a model");
    for setting in settings {
        let (name, text) = setting.split_once('=').expect("name=value");
        parameters.set_from_text(name, text).expect("a parameter");
    }
    let side = |text: &str| text.parse().expect("a resolution");
    let mut host = Host::new(Raster { xres: side(xres), yres: side(yres) }, None);
    let is_exact = matrix[12..] == [0.0, 0.0, 0.0, 1.0];
    // For a rounded matrix, the pbrt interface inverts the inverse in double precision.
    let inverted = CameraToWorld::from_rows(inverse).expect("affine").inverse_rows();
    let to_world = CameraToWorld::from_rows(if is_exact { matrix } else { &inverted });
    host.to_world = to_world.expect("affine").into();
    let camera = Camera::build(&parameters, &host, &mut |_, text| panic!("{text}")).expect("built");
    let kind = match parameters.lens_radius {
        _ if !is_exact => Kind::Inverted,
        None if *model != "environment" => Kind::Linear,
        _ => Kind::Trigonometric,
    };
    Stock { name: line.to_owned(), camera, kind, rays: Vec::new() }
}

#[test]
fn the_stock_cameras_have_the_rays_of_pbrts_own() {
    let cameras = stock();
    assert_eq!(cameras.len(), 77);
    // For each kind: the numbers of cameras, of rays and of rays with other bits, and the largest difference.
    let mut kinds: BTreeMap<Kind, (usize, usize, usize, f32)> = BTreeMap::new();
    for Stock { name, camera, kind, rays } in cameras {
        assert!(!rays.is_empty());
        let (of_kind, all, other, largest) = kinds.entry(kind).or_default();
        *of_kind += 1;
        for expected in rays {
            let [image_x, image_y, lens_u, lens_v, time, ray @ ..] = expected;
            let sample = Sample { image_x, image_y, lens_u, lens_v, time };
            let Outcome::Ray(got, weight) = camera.generate(&sample, None) else { panic!("{name}: no ray") };
            let got = [got.origin.as_slice(), &got.direction, &[got.mint, got.maxt, got.time]].concat();
            assert_eq!(weight, 1.0);
            *all += 1;
            *other += usize::from(got != ray);
            for (got, expected) in got.iter().zip(ray) {
                let off = (got - expected).abs() / (1.0 + expected.abs());
                *largest = largest.max(off);
                assert!(off <= if kind == Kind::Linear { 0.0 } else { 4e-7 }, "{name}: {got} {expected}");
            }
        }
    }
    for (kind, (cameras, rays, other, largest)) in &kinds {
        println!("{kind:?}: {cameras} cameras, {rays} rays, {other} with other bits, {largest:.1e} at most");
    }
    assert_eq!(kinds.len(), 3);
}
