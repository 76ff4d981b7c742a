//! A picture of a lens's vignetting: the mean weight of each pixel's rays, relative to that on the axis; and the width
//! in the scene that the middle pixel covers, by a ray with differentials.
//!
//! `cargo run --release --example host -- vignetting.pgm`

use std::error::Error;

use realistic::{Camera, Outcome, RayDifferential, Sample, Weighting, WorldRay};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;
const LENS: u32 = 8;

fn camera() -> Result<Camera, Box<dyn Error>> {
    let camera = Camera::builder()
        .lens_file("dgauss.50mm")
        .weighting(Weighting::Relative)
        .resolution(WIDTH, HEIGHT)
        .build_with_log(&mut |_, text| eprintln!("{text}"))?;
    Ok(camera)
}

/// Returns the picture as a PGM file.
pub fn picture() -> Result<Vec<u8>, Box<dyn Error>> {
    let camera = camera()?;
    let mut file = format!("P5\n{WIDTH} {HEIGHT}\n255\n").into_bytes();
    for (y, x) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (y, x))) {
        let middle = |i: u32| i as f32 + 0.5;
        let mut sum = 0.0;
        for i in 0..LENS * LENS {
            let sample = Sample {
                image_x: middle(x),
                image_y: middle(y),
                lens_u: middle(i % LENS) / LENS as f32,
                lens_v: middle(i / LENS) / LENS as f32,
                time: 0.0,
            };
            if let Outcome::Ray(_, weight) = camera.generate(&sample, None) {
                sum += f64::from(weight);
            }
        }
        file.push((255.0 * sum / f64::from(LENS * LENS)) as u8);
    }
    Ok(file)
}

/// Returns the width in the scene, mm, of the middle pixel at 10 m.
pub fn pixel_width() -> Result<f32, Box<dyn Error>> {
    let [image_x, image_y] = [WIDTH, HEIGHT].map(|side| side as f32 / 2.0);
    let middle = Sample { image_x, image_y, lens_u: 0.5, lens_v: 0.5, time: 0.0 };
    let (RayDifferential { ray, rx, .. }, _) = camera()?.ray_differential(&middle).ok_or("no ray")?;
    let at_10_m = |ray: WorldRay| ray.origin[0] + 1e4 * ray.direction[0];
    Ok((at_10_m(rx.ok_or("no neighbour")?) - at_10_m(ray)).abs())
}

#[allow(dead_code)] // the test of the examples takes only the picture
fn main() -> Result<(), Box<dyn Error>> {
    println!("a pixel is {:.3} mm wide at 10 m", pixel_width()?);
    let path = std::env::args().nth(1).unwrap_or_else(|| "vignetting.pgm".to_owned());
    Ok(std::fs::write(path, picture()?)?)
}
