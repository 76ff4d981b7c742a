//! The stock cameras of the library against rays of pbrt 1.05's stock plugins (`golden/stock_cameras.txt`), for camera transforms
//! that only turn, move and mirror. Those that scale or shear make directions of other lengths of the stock cameras' rays, and
//! unit vectors of ours.

use std::path::Path;

use realistic::camera::{Camera, CameraToWorld, Host, Outcome, Parameters, Raster, Sample};

/// One camera of the file with its rays.
struct Stock {
    name: String,
    camera: Camera,
    /// Sines and cosines, which differ between C libraries, go into its rays.
    trigonometric: bool,
    rays: Vec<[f32; 14]>,
}

fn stock() -> Vec<Stock> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/stock_cameras.txt");
    let text = std::fs::read_to_string(path).expect("the golden file");
    let mut cameras: Vec<Stock> = Vec::new();
    let mut pending = String::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let (what, rest) = line.split_once(' ').expect("a word and what follows");
        match what {
            "camera" => pending = rest.to_owned(),
            "matrix" => cameras.push(build(&pending, &numbers(rest))),
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

fn build(line: &str, matrix: &[f32; 16]) -> Stock {
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
    host.to_world = CameraToWorld::from_rows(matrix).expect("affine").into();
    let camera = Camera::build(&parameters, &host, &mut |_, text| panic!("{text}")).expect("built");
    let trigonometric = *model == "environment" || parameters.lensradius.is_some();
    Stock { name: line.to_owned(), camera, trigonometric, rays: Vec::new() }
}

#[test]
fn the_stock_cameras_have_the_rays_of_pbrts_own() {
    let cameras = stock();
    assert_eq!(cameras.len(), 15);
    for Stock { name, camera, trigonometric, rays } in cameras {
        assert!(!rays.is_empty());
        for expected in rays {
            let [image_x, image_y, lens_u, lens_v, time, ray @ ..] = expected;
            let sample = Sample { image_x, image_y, lens_u, lens_v, time };
            let Outcome::Ray(got, weight) = camera.generate(&sample) else { panic!("{name}: no ray") };
            let got = [got.origin.as_slice(), &got.direction, &[got.mint, got.maxt, got.time]].concat();
            assert_eq!(weight, 1.0);
            for (got, expected) in got.iter().zip(ray) {
                if trigonometric {
                    assert!(
                        (got - expected).abs() <= 4e-7 * (1.0 + expected.abs()),
                        "{name}: {got} {expected}"
                    );
                } else {
                    assert_eq!(*got, expected, "{name}");
                }
            }
        }
    }
}
