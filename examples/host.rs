//! A picture of a lens's vignetting: the mean weight of each pixel's rays, against the axis.
//!
//! `cargo run --release --example host -- vignetting.pgm`

use std::error::Error;

use realistic::camera::{Host, Outcome, Parameters, Raster, RealisticCamera, Sample};

const RASTER: Raster = Raster { xres: 64, yres: 48 };
const LENS: u32 = 8;

/// The picture as a PGM file.
pub fn picture() -> Result<Vec<u8>, Box<dyn Error>> {
    let mut parameters = Parameters::default();
    parameters.set_from_text("specfile", "dgauss.50mm")?;
    parameters.set_from_text("weighting", "relative")?;
    let host = Host::new(RASTER, None);
    let camera = RealisticCamera::build(&parameters, &host, &mut |_, text| eprintln!("{text}"))?;

    let mut file = format!("P5\n{} {}\n255\n", RASTER.xres, RASTER.yres).into_bytes();
    for (y, x) in (0..RASTER.yres).flat_map(|y| (0..RASTER.xres).map(move |x| (y, x))) {
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
