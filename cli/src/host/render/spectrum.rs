//! Colour by wavelength: a picture for each of several wavelengths, and the sum of these pictures.
//!
//! The scene has colours of red, green and blue; the light at a wavelength is red R(λ) + green G(λ) + blue B(λ) with
//! three smooth spectra that add up to 1. The film's three responses are the CIE colour matching functions in the
//! primaries of sRGB, multiplied by a matrix for which a picture without colour errors has exactly the colours of the
//! scene. Any difference in colour is therefore due to the lens.

use crate::image::Picture;
use glam::{Mat3, Vec3};
use std::ops::RangeInclusive;

/// The range of wavelengths rendered, nm.
pub const VISIBLE: RangeInclusive<f64> = 420.0..=680.0;

/// Matrix from CIE XYZ to linear sRGB (IEC 61966-2-1), by columns.
const TO_SRGB: Mat3 = Mat3::from_cols_array(&[
    3.240_625, -0.968_931, 0.055_710, -1.537_208, 1.875_756, -0.204_021, -0.498_629, 0.041_518, 1.056_996,
]);

/// Returns wavelengths, nm, and for each the weight of its picture in the whole, as a matrix. The matrices add up to
/// the identity. `count` is 3 or more, because fewer wavelengths cannot produce every colour.
pub fn bands(count: u32) -> Vec<(f64, Mat3)> {
    let width = (VISIBLE.end() - VISIBLE.start()) / f64::from(count);
    let middle = |index: u32| VISIBLE.start() + (f64::from(index) + 0.5) * width;
    let raw: Vec<(f64, Mat3)> = (0..count)
        .map(middle)
        .map(|wavelength| {
            let nm = wavelength as f32;
            let [response, light] = [TO_SRGB * matching(nm), emission(nm)];
            (wavelength, Mat3::from_cols(response * light.x, response * light.y, response * light.z))
        })
        .collect();
    let whole = raw.iter().fold(Mat3::ZERO, |sum, (_, band)| sum + *band);
    let correction = whole.inverse();
    raw.into_iter().map(|(wavelength, band)| (wavelength, correction * band)).collect()
}

/// Adds the picture of a band to the whole.
pub fn add(whole: &mut Picture, band: Mat3, picture: &Picture) {
    for (sum, colour) in whole.pixels.iter_mut().zip(&picture.pixels) {
        *sum = (Vec3::from_array(*sum) + band * Vec3::from_array(*colour)).to_array();
    }
}

/// Returns the CIE 1931 colour matching functions (C. Wyman, P.-P. Sloan and P. Shirley, "Simple
/// Analytic Approximations to the CIE XYZ Color Matching Functions", *Journal of Computer Graphics
/// Techniques* 2(2), 2013: the multi-lobe fit).
fn matching(nm: f32) -> Vec3 {
    let lobe = |height: f32, centre: f32, below: f32, above: f32| {
        let width = if nm < centre { below } else { above };
        height * (-0.5 * ((nm - centre) / width).powi(2)).exp()
    };
    Vec3::new(
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    )
}

/// Returns the weights of the scene's red, green and blue at a wavelength.
fn emission(nm: f32) -> Vec3 {
    let rise = |from: f32, to: f32| {
        let t = ((nm - from) / (to - from)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let (green, red) = (rise(470.0, 520.0), rise(565.0, 610.0));
    Vec3::new(red, green - red, 1.0 - green)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_has_the_published_integrals() {
        // The tabulated functions of 1931 have integrals of 106.857, 106.857 and 106.892, from 360 to 830 nm at 1 nm
        // steps.
        let integral = (360..=830).map(|nm| matching(nm as f32)).sum::<Vec3>();
        assert!((integral - Vec3::splat(106.86)).abs().max_element() < 1.0, "{integral}");
        assert!((0..100).all(|step| (emission(400.0 + 3.0 * step as f32).element_sum() - 1.0).abs() < 1e-6));
    }

    #[test]
    fn a_lens_without_colour_errors_changes_no_colour() {
        let scene =
            Picture { size: [3, 1], pixels: vec![[1.0, 1.0, 1.0], [0.9, 0.2, 0.05], [0.0, 0.1, 3.0]] };
        for count in [3, 4, 7, 16, 61] {
            let mut whole = Picture::plain(scene.size, [0.0; 3]);
            for (wavelength, band) in bands(count) {
                assert!(VISIBLE.contains(&wavelength));
                add(&mut whole, band, &scene);
            }
            for (is, was) in whole.pixels.as_flattened().iter().zip(scene.pixels.as_flattened()) {
                assert!((is - was).abs() < 1e-4, "{count} wavelengths: {whole:?}");
            }
        }
    }

    #[test]
    fn light_of_one_wavelength_has_its_colour() {
        let bands = bands(27);
        let colour = |nm: f64| {
            let near = |a: &f64| (a - nm).abs();
            let (_, band) = bands.iter().min_by(|a, b| near(&a.0).total_cmp(&near(&b.0))).unwrap();
            *band * Vec3::ONE
        };
        assert_eq!(colour(460.0).max_position(), 2);
        assert_eq!(colour(535.0).max_position(), 1);
        assert_eq!(colour(630.0).max_position(), 0);
    }
}
