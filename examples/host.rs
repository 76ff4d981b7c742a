//! A picture of a lens's vignetting: the mean weight of each pixel's rays, against the axis.
//!
//! `cargo run --release --example host -- vignetting.pgm`

use std::error::Error;

use realistic::camera::{Camera, Outcome, Sample, Weighting};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;
const LENS: u32 = 8;

/// The picture as a PGM file.
pub fn picture() -> Result<Vec<u8>, Box<dyn Error>> {
    let camera = Camera::builder()
        .lens("dgauss.50mm")
        .weighting(Weighting::Relative)
        .resolution(WIDTH, HEIGHT)
        .build_with_log(&mut |_, text| eprintln!("{text}"))?;

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
            if let Outcome::Ray(_, weight) = camera.generate(&sample) {
                sum += f64::from(weight);
            }
        }
        file.push((255.0 * sum / f64::from(LENS * LENS)) as u8);
    }
    Ok(file)
}

#[allow(dead_code)] // the test of the examples takes only the picture
fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "vignetting.pgm".to_owned());
    Ok(std::fs::write(path, picture()?)?)
}
