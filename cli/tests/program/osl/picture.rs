//! A picture in the stop of the shader: the light of its rays is that of the exact walk.

use super::{Shader, samples};
use rayon::prelude::*;
use realistic_camera::{Host, Parameters, Raster, Zoom, blades, open_lens, stop_picture};
use realistic_light::{LitPath, Surfaces};
use realistic_optics::imaging::axial_beam::stop_or_limiting;
use realistic_optics::lens::{Lens, Ray};
use realistic_optics::prescription::Coating;
use realistic_optics::trace::Path;
use std::fs::File;

/// Linear values without any symmetry, row by row from the top; a corner and a part inside are black.
const SIZE: [u32; 2] = [5, 4];
const VALUES: [u16; 20] = [
    60000, 9000, 20000, 50000, 0, //
    30000, 0, 0, 10000, 65535, //
    25000, 45000, 40000, 5000, 61000, //
    12000, 20000, 65535, 7000, 32000,
];

/// Writes the picture to a new folder. Returns the folder and the file.
fn written() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("stop.png");
    let mut encoder = png::Encoder::new(File::create(&file).expect("made"), SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let bytes: Vec<u8> = VALUES.iter().flat_map(|value| value.to_be_bytes()).collect();
    encoder.write_header().expect("a header").write_image_data(&bytes).expect("pixels");
    (folder, file.to_str().expect("a name").to_owned())
}

#[test]
fn the_light_through_a_picture_is_the_librarys() {
    let (_folder, picture) = written();
    let host = Host::new(Raster { xres: 1, yres: 1 }, None);
    let cases: [(&str, &[&str], f64); 5] = [
        ("dgauss.50mm", &[], 1.0),
        ("dgauss.50mm", &["--transmission", "bare"], 1.0),
        ("fisheye.10mm", &["--blades", "6"], 1.0),
        ("dgauss.50mm", &["--stop-picture-gain=true"], 1.0),
        // The shader's own zoom, between the positions of the file.
        ("zoom.24-70mm", &[], 43.2),
    ];
    cases.par_iter().for_each(|&(name, more, zoom)| {
        let mut parameters = Parameters {
            lens_file: Some(name.to_owned()),
            zoom: (zoom > 1.0).then_some(Zoom::FocalLength(zoom)),
            stop_picture: Some(picture.clone()),
            stop_picture_gain: more.contains(&"--stop-picture-gain=true").then_some(true),
            ..Parameters::default()
        };
        let (prescription, mut lens) = open_lens(&parameters, &host, &mut |_, _| ()).expect("a lens");
        if more.contains(&"--blades") {
            parameters.blades = Some(6.0);
            lens.set_blades(blades(&parameters, &prescription).expect("blades"));
        }
        let own = stop_picture(&parameters, &prescription, &host, &mut |_, _| ()).expect("a picture");
        lens.add_picture(own.expect("given"));
        let surfaces = match more.contains(&"--transmission") {
            true => Surfaces::new(&lens, Coating::Bare),
            false => Surfaces::lossless(&lens),
        };
        let [mut plain, mut shaped] =
            [&[][..], &[&["--stop-picture", &picture], more].concat()].map(|more| Shader::new(name, more));
        for shader in [&mut plain, &mut shaped] {
            shader.zoom = (zoom > 1.0).then_some(zoom);
        }
        for camera in [[0.0, 0.0], [1.0 / 16.0, 2.0]] {
            let found = Found::of(&lens, &surfaces, [&plain, &shaped], camera);
            let limit = if zoom > 1.0 { 1e-4 } else { 2e-5 };
            println!("{name} {more:?} {camera:?}: {found:?}");
            assert!(found.most < limit && found.fates_differ <= 4, "{name} {more:?} {camera:?}: {found:?}");
            assert!(found.passed > 3000 && found.blocked > 100, "{name} {more:?} {camera:?}: {found:?}");
        }
    });
}

/// The light of rays behind the picture, as a share of that of the same rays without it.
#[derive(Debug, Default)]
struct Found {
    /// The largest error of the share.
    most: f64,
    passed: usize,
    blocked: usize,
    /// Rays that only one of shader and walk blocks, although more than a thousandth of their light is left.
    fates_differ: usize,
}

impl Found {
    fn of(lens: &Lens, surfaces: &Surfaces, [plain, shaped]: [&Shader; 2], camera: [f32; 2]) -> Self {
        let at = samples(plain.reach, 8000, camera);
        let stop = stop_or_limiting(lens);
        let mut path: Option<(f64, LitPath)> = None;
        let mut result = Self::default();
        for (plain, shaped) in plain.answers(&at).iter().zip(shaped.answers(&at)) {
            let [of_plain, of_shaped] = [plain, &shaped].map(|answer| f64::from(answer.throughput[1]));
            if of_plain == 0.0 {
                assert_eq!(of_shaped, 0.0);
                continue;
            }
            if path.as_ref().is_none_or(|(s, _)| *s != plain.stop) {
                let mut lens = lens.clone();
                lens.surfaces[stop].semi_diameter *= plain.stop;
                let traced = Path::film_to_scene(&lens).with_apertures(&lens);
                path = Some((plain.stop, LitPath::new(traced, surfaces)));
            }
            let (_, path) = path.as_ref().expect("made");
            let ([x, y], direction) = (plain.start, plain.heading);
            let back = 2.0 * lens.rear().semi_diameter / direction[2];
            let [dx, dy, dz] = direction.map(|d| d * back);
            let origin = [x - dx, y - dy, lens.rear().vertex - dz];
            let expected = path.trace(Ray { origin, direction }).map_or(0.0, |(_, left)| left);
            let found = of_shaped / of_plain;
            *if found > 0.0 { &mut result.passed } else { &mut result.blocked } += 1;
            if (found > 0.0) == (expected > 0.0) {
                result.most = result.most.max((found - expected).abs());
            } else {
                result.fates_differ += usize::from(found.max(expected) > 1e-3);
            }
        }
        result
    }
}
