//! Shaders of lenses that are symmetric in x and in y without being round: rays, brightness and light are those of the
//! library.

use super::{Comparison, Shader, cameras, is_bright, lens_of, media::written, samples, worst_loss};
use realistic_light::Surfaces;
use realistic_optics::lens::Lens;
use realistic_optics::prescription::Coating;

use super::super::fails;

/// A small lens with a biconic, a toroid with terms and a cylinder with a conic section.
const SMALL: &str = "biconic 1 x=55 conic_x=-0.5 conic_y=0.4\ntoroid 2 rotation=-90 profile=x conic=-1 A4=2e-6 A6=1e-9\n\
    toroid 4 conic=0.5\n50 6 1.6 50 24\n-80 4 - - 24\nstop 4 - - 14\n-300 3 1.7 40 18\ninf 45 - - 18\n";

/// Returns the lenses of the catalogue that have such a shader.
fn listed() -> [(String, Lens); 2] {
    ["anamorphic.129mm", "anamorphic.42mm"].map(|name| (name.to_owned(), lens_of(name)))
}

#[test]
fn rays_of_lenses_that_are_not_round_are_those_of_double_precision() {
    let (_folder, file, prescription) = written(SMALL);
    for (name, lens) in listed().into_iter().chain([(file, Lens::at_d_line(&prescription))]) {
        let shader = Shader::new(&name, &[]);
        for camera in cameras() {
            let found = Comparison::of(&lens, &shader.answers(&samples(shader.reach, 20_000, camera)));
            let [median, most] = Comparison::median_and_most(&found.directions);
            let [_, offset] = Comparison::median_and_most(&found.offsets);
            let acceptance = found.passed as f64 / found.traced as f64;
            let figures = format!(
                "{name} at {camera:?}: {median:e} {most:e} rad, {offset:e} mm, {} fates, {acceptance} of {}",
                found.fates_differ, found.traced
            );
            println!("{figures}");
            assert!(found.traced > 19_000 && found.fates_differ <= 4, "{figures}");
            assert!(most < 1.2e-5 && median < 2e-6 && offset < 1e-3, "{figures}");
            assert!(acceptance > 0.84, "{figures}");
        }
    }
}

#[test]
fn film_of_lenses_that_are_not_round_is_as_bright_as_all_rays_make_it() {
    let (_folder, file, prescription) = written(SMALL);
    for (name, lens) in listed().into_iter().chain([(file, Lens::at_d_line(&prescription))]) {
        let shader = Shader::new(&name, &[]);
        for (direction, share) in [
            ([1.0, 0.0], 0.0),
            ([1.0, 0.0], 0.7),
            ([-0.8, 0.6], 0.75),
            ([0.0, -1.0], 0.7),
            ([0.28, 0.96], 0.4),
        ] {
            let cases =
                [(0.0, 0.0, share), (0.0, 2.0, share), (1.0 / 11.2, 2.0, share), (1.0 / 32.0, 0.0, share)];
            is_bright(&name, &lens, &shader, direction, &cases);
        }
    }
}

#[test]
fn light_of_lenses_that_are_not_round_is_the_librarys() {
    let [(name, lens), _] = listed();
    let surfaces = Surfaces::new(&lens, Coating::QuarterWave);
    let [most, least] = worst_loss(&name, &lens, &["--transmission", "quarter-wave"], &surfaces, 0.5);
    assert!(most < 5e-6 && least < 0.98, "{most:e}, {least}");
}

#[test]
fn poses_and_mirrors_are_refused_by_name() {
    for (text, reason) in [
        ("break 2 y=0.1\n50 4 1.5 60 20\n-50 40 - - 20\n", "tilted or decentred surfaces"),
        ("mirror 1\n-200 -100 - - 40\n", "mirrors"),
    ] {
        let stderr = fails(&["blender", "-", "--out", "-"], text, 1);
        assert!(stderr.contains(reason) && stderr.contains("a host of the library"), "{stderr}");
    }
}
