//! The origin of a tile: data on its whole picture, which `merge` compares.

use crate::arguments::CameraChoice;
use crate::failure::Failure;
use crate::host::plugin::Camera;
use crate::host::studio::{Shot, ShotOptions, Studio};
use crate::image::{Format, tile::Origin};
use realistic::ffi::{realistic_ray, realistic_sample};
use realistic_lab::render::Rays;

/// Returns the origin of a tile that `crop` cuts from a picture, for a file of this format. `scene` is the
/// description of the scene.
///
/// # Errors
/// The plugin's error.
pub fn origin(
    camera: &CameraChoice,
    scene: &str,
    format: Format,
    studio: &Studio,
    options: &ShotOptions,
    shot: &Shot,
) -> Result<Origin, Failure> {
    // Each tile has its own crop. The rays show which lens it is, wherever the lens file lies.
    let own = camera.given().filter(|(name, _)| *name != "crop");
    let parameters: Vec<String> = own.map(|(name, value)| format!("{name}={value}")).collect();
    let (whole, info) = (studio.size, shot.camera.info()?);
    let mut settings = vec![
        ("plugin", studio.plugin.version()),
        ("lens", shot.camera.lens_name()?),
        ("parameters", parameters.join(" ")),
        ("focal length and film distance", format!("{} {}", info.focal_length_mm, info.film_distance)),
        ("samples per pixel", options.spp.to_string()),
        ("filter", format!("{:?}", options.filter)),
        ("seed", studio.seed().to_string()),
        ("scene and effects", scene.to_owned()),
        ("wavelengths", options.wavelengths.map_or_else(|| "the lens's own".to_owned(), |n| n.to_string())),
        ("rays", format!("{:016x}", fingerprint(&shot.camera, whole)?)),
    ];
    if format == Format::Png {
        settings.push(("brightness", shot.tone.scale.to_string()));
    }
    let settings = settings.into_iter().map(|(name, value)| (name.to_owned(), on_one_line(&value))).collect();
    Ok(Origin { whole, crop: info.crop, settings })
}

/// Replaces line breaks, because a value may be any text from the user.
fn on_one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

/// Returns a hash of rays from all over the picture. It differs between cameras that generate different rays, whether
/// the cause is another lens, another parameter, or a model that a tolerance chose on another processor.
fn fingerprint(camera: &Camera, whole: [u32; 2]) -> Result<u64, Failure> {
    const RAYS: u16 = 1024;
    // Multiples of the golden ratio and its relatives, modulo 1, spread the samples evenly.
    let part = |i: u16, step: f32| (f32::from(i) * step).fract();
    let [width, height] = whole.map(|side| side as f32);
    let samples: Vec<_> = (0..RAYS)
        .map(|i| realistic_sample {
            image_x: width * part(i, 0.856_675),
            image_y: height * part(i, 0.733_892),
            lens_u: part(i, 0.628_71),
            lens_v: part(i, 0.538_597),
            time: part(i, 0.461_403),
        })
        .collect();
    let mut rays = vec![realistic_ray::default(); samples.len()];
    let mut weights = vec![0.0; samples.len()];
    camera.rays(Rays { samples: &samples, rays: &mut rays, weights: &mut weights })?;
    let mut hash = Fnv::default();
    for (ray, weight) in rays.iter().zip(weights) {
        hash.take(weight);
        if weight > 0.0 {
            ray.o.into_iter().chain(ray.d).chain([ray.mint, ray.maxt, ray.time]).for_each(|x| hash.take(x));
        }
    }
    Ok(hash.0)
}

/// The 64-bit FNV-1a hash (G. Fowler, L. C. Noll and K.-P. Vo), which is the same with every compiler.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn take(&mut self, number: f32) {
        for byte in number.to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
