//! Shaders of lenses whose scene and film lie in other media than air: rays, brightness, focus and light are those of
//! the library.

use super::{Comparison, Sample, Shader, cameras, is_bright_and_in_focus, samples, worst_loss};
use realistic_light::Surfaces;
use realistic_optics::lens::Lens;
use realistic_optics::prescription::{Coating, Prescription, read};

/// A lens in water with its film in a glass; every medium but air disperses.
const IMMERSED: &str = "medium 1.33306 55.8\n60 8 1.88 40.8 40\n-300 6 - - 38\nstop 6 - - 20\n200 6 1.65 33.8 30\n\
    -60 64.7 1.45 68 30\n";
/// A lens in air with its film in a glass of high dispersion.
const IN_GLASS: &str =
    "60 8 1.88 40.8 40\n-300 6 - - 38\nstop 6 - - 20\n200 6 1.65 33.8 30\n-60 70 1.45 30 30\n";
/// A single lens in air.
const IN_AIR: &str = "50 6 1.5 60 22\n-50 4 - - 22\nstop 45 - - 8\n";

/// Writes a lens to a file of a new folder. Returns the folder, the file and the lens.
pub fn written(text: &str) -> (tempfile::TempDir, String, Prescription) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("own.dat");
    std::fs::write(&file, text).expect("written");
    let name = file.to_str().expect("a name").to_owned();
    (folder, name, read("own.dat", text.as_bytes()).expect("a lens"))
}

#[test]
fn rays_and_brightness_between_media_are_the_librarys() {
    let (_folder, file, prescription) = written(IMMERSED);
    let lens = Lens::at_d_line(&prescription);
    let shader = Shader::new(&file, &[]);
    for camera in cameras() {
        let found = Comparison::of(&lens, &shader.answers(&samples(shader.reach, 10_000, camera)));
        let [median, most] = Comparison::median_and_most(&found.directions);
        let figures = format!("{camera:?}: {median:e} {most:e} rad, {} fates differ", found.fates_differ);
        assert!(found.passed > 8000 && found.fates_differ <= 4, "{figures}");
        assert!(most < 1.2e-5 && median < 2e-6, "{figures}");
    }
    let cases = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.5), (1.0 / 11.2, 2.0, 0.6)];
    is_bright_and_in_focus("own.dat", &lens, &shader, &cases);
}

#[test]
fn wavelengths_between_media_have_the_radiance_of_their_indices() {
    let (_folder, file, prescription) = written(IN_GLASS);
    let (_other, plain, _) = written(IN_AIR);
    let [own, plain] = [&file, &plain].map(|file| Shader::new(file, &["--dispersion"]));
    // A ray along the axis in the light of a wavelength, over that of a lens in air.
    let light = |number: f32| -> f64 {
        let sample: Sample = [0.5, 0.5, 0.5, 0.5, 0.02, 0.0, 36.0, 24.0, number];
        let [own, plain] = [&own, &plain].map(|shader| shader.answers(&[sample])[0].throughput[1]);
        f64::from(own) / f64::from(plain)
    };
    let factor = |number: f32| Lens::new(&prescription, nm(number)).radiance_factor();
    for number in [0.25, 0.4, 0.6_f32] {
        let (found, expected) = (light(number) / light(0.5), factor(number) / factor(0.5));
        assert!((found / expected - 1.0).abs() < 1e-5, "{} nm: {found} {expected}", nm(number));
    }
    assert!((factor(0.25) / factor(0.6) - 1.0).abs() > 1e-3);
}

/// Returns the wavelength of a number, nm.
fn nm(number: f32) -> f64 {
    420.0 + 260.0 * f64::from(number)
}

#[test]
fn transmission_between_media_is_the_librarys() {
    let (_folder, file, prescription) = written(IMMERSED);
    for (arguments, number) in
        [(&["--transmission", "bare"][..], 0.5), (&["--transmission", "bare", "--dispersion"], 0.2)]
    {
        let lens = match arguments.contains(&"--dispersion") {
            true => Lens::new(&prescription, nm(number)),
            false => Lens::at_d_line(&prescription),
        };
        let surfaces = Surfaces::new(&lens, Coating::Bare);
        let [most, least] = worst_loss(&file, &lens, arguments, &surfaces, number);
        assert!(most < 5e-6 && least < 0.98, "{arguments:?}: {most:e}, {least}");
    }
}
