//! A picture as the stop: its light at every azimuth, by brute force with a formula of this file, the agreement of all
//! tracers, and files of every kind.

use super::support;

use ::realistic_camera::{Camera, Importance, WorldRay};
use realistic_light::{LitPath, Surfaces};
use realistic_optics::{
    lens::Lens,
    prescription::{MAX_PICTURE_SIDE, StopPicture, read},
    trace::{Path, Ray},
};
use std::{f64::consts::TAU, fs, path::Path as FilePath};
use support::{Random, build, host_with, light, ray, sample};

/// A singlet with its stop behind it, and a plane of glass.
const TABLE: &str = "50 6 1.5 60 22\n-50 4 1 - 22\nstop 2 1 - 8\ninf 2 1.5 50 24\ninf 45 1 - 24\n";

/// Linear values of a picture without any symmetry, row by row from the top; the second row is partly black.
const SIZE: [usize; 2] = [5, 4];
const VALUES: [f32; 20] = [
    0.9, 0.1, 0.3, 0.8, 0.2, //
    0.5, 0.0, 0.0, 0.0, 1.0, //
    0.4, 0.7, 0.6, 0.0, 0.9, //
    0.2, 0.3, 1.0, 0.1, 0.5,
];

/// Returns the transmission at a point in clear semi-diameters: a sum of tents over the pixels, for the nearest point
/// between their outermost centres.
fn transmission([x, y]: [f64; 2]) -> f64 {
    let [width, height] = SIZE.map(|side| side as f64);
    let (column, row) = (0.5 * width * (1.0 + x), 0.5 * height - 0.5 * width * y);
    if !((0.0..=width).contains(&column) && (0.0..=height).contains(&row)) {
        return 0.0;
    }
    let tent = |at: f64, side: f64, pixel: usize| {
        (1.0 - (at.clamp(0.5, side - 0.5) - pixel as f64 - 0.5).abs()).max(0.0)
    };
    let of_pixel =
        |i: usize| f64::from(VALUES[i]) * tent(column, width, i % SIZE[0]) * tent(row, height, i / SIZE[0]);
    (0..VALUES.len()).map(of_pixel).sum()
}

/// Writes 16-bit grey values, which are linear.
fn png(path: &FilePath, [width, height]: [usize; 2], values: &[f32]) {
    let bytes: Vec<u8> =
        values.iter().flat_map(|value| ((value * 65535.0).round() as u16).to_be_bytes()).collect();
    encoded(path, [width, height], (png::ColorType::Grayscale, png::BitDepth::Sixteen), &bytes);
}

fn encoded(
    path: &FilePath,
    [width, height]: [usize; 2],
    (kind, depth): (png::ColorType, png::BitDepth),
    bytes: &[u8],
) {
    let mut encoder = png::Encoder::new(fs::File::create(path).expect("made"), width as u32, height as u32);
    encoder.set_color(kind);
    encoder.set_depth(depth);
    encoder.write_header().expect("a header").write_image_data(bytes).expect("pixels");
}

/// A folder with the picture above.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        png(&folder.path().join("stop.png"), SIZE, &VALUES);
        Self(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("UTF-8").to_owned()
    }

    fn built(&self, name: &str, more: &[(&str, &str)]) -> Result<(Camera, Vec<String>), String> {
        let path = self.path(name);
        let common = [("film_diagonal", "22"), ("film_distance", "48"), ("stop_picture", &path)];
        build(&host_with(TABLE), &[&common[..], more].concat()).map_err(|error| error.to_string())
    }

    fn camera(&self, more: &[(&str, &str)]) -> Camera {
        self.built("stop.png", more).expect("a camera").0
    }
}

fn round(more: &[(&str, &str)]) -> Camera {
    let common = [("film_diagonal", "22"), ("film_distance", "48")];
    build(&host_with(TABLE), &[&common[..], more].concat()).expect("a camera").0
}

#[test]
fn a_pictures_light_is_neither_lost_nor_made_at_any_azimuth() {
    let (folder, round) = (Folder::new(), round(&[]));
    let planned = |camera: &Camera| camera.plan().to_string().contains("picture in the stop");
    assert!(planned(&folder.camera(&[])) && !planned(&round));
    let cameras: Vec<(&str, Camera)> =
        ["warped", "rear"].map(|pupil| (pupil, folder.camera(&[("pupil", pupil)]))).into();
    let azimuths: Vec<u8> = (0..12).collect();
    support::on_all_cores(&azimuths, |&azimuth| {
        let (sine, cosine) = (TAU * f64::from(azimuth) / 12.0).sin_cos();
        let image = [200.0 + 110.0 * cosine, 150.0 + 110.0 * sine].map(|part| part as f32);
        let [expected, error] = light::through_stop(&round, transmission, image, 7 + u64::from(azimuth));
        for (pupil, camera) in &cameras {
            let [found, own_error] = light::of_camera(camera, image, 91 + u64::from(azimuth));
            let off = (found - expected) / error.hypot(own_error);
            assert!(expected > 0.0 && off.abs() < 4.5, "{pupil} {azimuth}: {found} {expected} {off}");
        }
    });
}

#[test]
fn weights_are_those_of_a_round_stop_times_the_transmission_in_the_stop() {
    let folder = Folder::new();
    let path_to_stop = {
        let lens = Lens::at_d_line(&read("own", TABLE.as_bytes()).expect("a lens"));
        let stop = lens.surfaces[2].vertex;
        let mut behind = Lens { surfaces: lens.surfaces[2..].to_vec(), ..lens };
        behind.surfaces.iter_mut().for_each(|surface| surface.vertex -= stop);
        (Path::<f64>::scene_to_film(&behind), stop)
    };
    for (given, most) in [
        (&[("precision", "f64")][..], 1e-5),
        (&[("precision", "f32")], 2e-4),
        (&[("refraction", "heckbert")], 1e-5),
        (&[("tolerance", "0.5")], 1e-3),
        (&[("transmission", "bare")], 1e-5),
        (&[("aperture_diameter", "5"), ("blades", "6")], 1e-5),
    ] {
        let (plain, own) = (round(given), folder.camera(given));
        let size = plain.facts().expect("a lens").lens.surfaces[2].semi_diameter;
        let mut random = Random::new(5);
        let (mut compared, mut dark) = (0, 0);
        for _ in 0..4000 {
            let image = [400.0 * random.next() as f32, 300.0 * random.next() as f32];
            let at = [random.next() as f32, random.next() as f32];
            let Some((whole, weight)) = ray(&plain, image, at) else { continue };
            // The ray back from the scene through the first glass lies in the stop's frame behind it.
            let back = through_singlet(&whole);
            let (_, stop) = path_to_stop;
            let along = (stop - back.origin[2]) / back.direction[2];
            let point = [0, 1].map(|axis| (back.origin[axis] + along * back.direction[axis]) / size);
            let expected = transmission(point);
            let found = ray(&own, image, at).map_or(0.0, |(_, weight)| f64::from(weight));
            let ratio = found / f64::from(weight);
            assert!((ratio - expected).abs() < most, "{given:?}: {ratio} {expected}");
            compared += 1;
            dark += u32::from(expected < 1e-3);
        }
        assert!(compared > 1000 && dark > 3, "{given:?}: {compared} {dark}");
    }
}

/// Returns a camera's ray traced back through the singlet, in lens space.
fn through_singlet(ray: &WorldRay) -> Ray {
    let lens = Lens::at_d_line(&read("own", TABLE.as_bytes()).expect("a lens"));
    let singlet = Lens { surfaces: lens.surfaces[..2].to_vec(), ..lens };
    let direction = ray.direction.map(|part| -f64::from(part));
    let origin = std::array::from_fn(|axis| f64::from(ray.origin[axis]) - direction[axis]);
    Path::<f64>::scene_to_film(&singlet).trace(Ray { origin, direction }).expect("the camera's ray")
}

#[test]
fn wavelengths_ghosts_and_importance_have_the_pictures_light() {
    let folder = Folder::new();
    // At a wavelength, the weight is that of a camera at this wavelength.
    let (own, there) =
        (folder.camera(&[("pupil", "rear")]), folder.camera(&[("pupil", "rear"), ("wavelength", "450")]));
    let mut random = Random::new(8);
    let mut draw = || {
        let [x, y, u, v] = [(); 4].map(|()| random.next() as f32);
        sample([400.0 * x, 300.0 * y], [u, v])
    };
    let mut compared = 0;
    for sample in (0..4000).map(|_| draw()) {
        let weight = |camera: &Camera, nm| match camera.generate(&sample, nm) {
            ::realistic_camera::Outcome::Ray(_, weight) => Some(f64::from(weight)),
            _ => None,
        };
        if let (Some(a), Some(b)) = (weight(&own, Some(450.0)), weight(&there, None)) {
            assert!((a / b - 1.0).abs() < 2e-3 || (a - b).abs() < 1e-6, "{a} {b}");
            compared += 1;
        }
    }
    assert!(compared > 200, "{compared}");
    // Importance over density is the weight.
    let own = folder.camera(&[]);
    let samples: Vec<(WorldRay, f32)> = (0..2000)
        .map(|_| draw())
        .filter_map(|sample| ray(&own, [sample.image_x, sample.image_y], [sample.lens_u, sample.lens_v]))
        .collect();
    let back: Vec<WorldRay> = samples
        .iter()
        .map(|(ray, _)| WorldRay { direction: ray.direction.map(|part| -part), ..*ray })
        .collect();
    let mut found = vec![Importance::default(); back.len()];
    own.adjoint().expect("defined").arrive(&back, &mut found);
    let arrived: Vec<f64> = found
        .iter()
        .zip(&samples)
        .filter(|(found, _)| found.importance > 0.0)
        .map(|(found, (_, weight))| found.importance / found.density / f64::from(*weight))
        .collect();
    assert!(arrived.len() > samples.len() * 9 / 10 && arrived.len() > 200);
    assert!(arrived.iter().all(|ratio| (ratio - 1.0).abs() < 5e-3), "{arrived:?}");
    // A ghost meets the stop one or three times, and each time the picture.
    let lens = {
        let mut lens = Lens::at_d_line(&read("own", TABLE.as_bytes()).expect("a lens"));
        lens.add_picture(StopPicture::new([1, 1], &[0.5]));
        lens
    };
    let surfaces = Surfaces::lossless(&lens);
    let axial = Ray { origin: [0.0, 0.0, lens.rear().vertex - 40.0], direction: [0.0, 0.0, 1.0] };
    for (turns, factor) in [(None, 0.5), (Some([0, 1]), 0.5), (Some([0, 3]), 0.125)] {
        let path = match turns {
            None => Path::film_to_scene(&lens),
            Some(turns) => Path::reflected(
                &lens,
                realistic_optics::trace::Direction::FilmToScene,
                Default::default(),
                turns,
            ),
        };
        let (_, left) = LitPath::new(path.with_apertures(&lens), &surfaces).trace(axial).expect("the axis");
        assert!((left - factor).abs() < 1e-12, "{turns:?}: {left}");
    }
}

#[test]
fn the_gain_and_relative_weights_give_the_axis_the_light_of_a_round_stop() {
    let folder = Folder::new();
    let axis = |camera: &Camera| light::of_camera(camera, [200.0, 150.0], 5);
    let [open, _] = axis(&round(&[]));
    let [gained, error] = axis(&folder.camera(&[("stop_picture_gain", "true")]));
    assert!((gained - open).abs() < 4.5 * error + 5e-3 * open, "{gained} {open}");
    let [relative, error] = axis(&folder.camera(&[("weighting", "relative")]));
    assert!((relative - 1.0).abs() < 4.5 * error && error < 0.02, "{relative} {error}");
}

#[test]
fn files_of_every_kind_are_decoded() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name);
    use png::{BitDepth, ColorType};
    // Half of the light: linear in 16 bits and in EXR, 188 of 255 in sRGB.
    png(&path("half16.png"), [2, 2], &[0.5029; 4]);
    encoded(&path("half8.png"), [2, 2], (ColorType::Grayscale, BitDepth::Eight), &[188; 4]);
    encoded(&path("rgb.png"), [2, 2], (ColorType::Rgb, BitDepth::Eight), &[188; 12]);
    encoded(&path("rgba.png"), [2, 2], (ColorType::Rgba, BitDepth::Eight), &[255, 255, 255, 128].repeat(4));
    let green = |_: usize, _: usize| (0.0_f32, 0.5029 / 0.7152, 0.0_f32);
    exr::prelude::write_rgb_file(path("rgb.exr"), 2, 2, green).expect("written");
    let mean = |name: &str| {
        let (camera, log) = folder.built(name, &[("pupil", "disk")]).expect(name);
        let [mean, _] = light::of_camera(&camera, [200.0, 150.0], 3);
        (mean, log)
    };
    let (half, log) = mean("half16.png");
    assert!(log.iter().all(|line| !line.contains("sRGB")));
    for name in ["half8.png", "rgb.png", "rgba.png", "rgb.exr"] {
        let (found, log) = mean(name);
        assert!((found / half - 1.0).abs() < 3e-3, "{name}: {found} {half}");
        assert_eq!(log.iter().any(|line| line.contains("sRGB")), name.ends_with("png"), "{log:?}");
    }
}

#[test]
fn what_is_no_stop_is_refused() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name);
    let whole = fs::read(path("stop.png")).expect("read");
    fs::write(path("cut.png"), &whole[..whole.len() / 2]).expect("written");
    fs::write(path("text.png"), "no picture").expect("written");
    png(&path("black.png"), [2, 2], &[0.0; 4]);
    png(&path("large.png"), [MAX_PICTURE_SIDE + 1, 1], &vec![1.0; MAX_PICTURE_SIDE + 1]);
    exr::prelude::write_rgb_file(path("nan.exr"), 2, 2, |x, y| {
        if (x, y) == (1, 0) { (f32::NAN, 0.0, 0.0) } else { (1.0, 1.0, 1.0) }
    })
    .expect("written");
    exr::prelude::write_rgb_file(path("negative.exr"), 2, 1, |_, _| (-1.0_f32, 0.0_f32, 0.0_f32))
        .expect("written");
    let whole = fs::read(path("nan.exr")).expect("read");
    fs::write(path("cut.exr"), &whole[..whole.len() - 9]).expect("written");
    fs::create_dir(path("folder.png")).expect("made");
    for (name, why) in [
        ("none.png", "no picture \""),
        ("folder.png", "is a directory"),
        ("text.png", "is neither a PNG nor an EXR file"),
        ("cut.png", "is no whole PNG file"),
        ("cut.exr", "is no whole EXR file"),
        ("black.png", "is black inside the stop"),
        ("large.png", "scale it to at most 1024"),
        ("nan.exr", "pixel (1, 0) is NaN"),
        ("negative.exr", "pixel (0, 0) is -0.2126"),
    ] {
        let error = folder.built(name, &[]).map(|_| ()).expect_err(name);
        assert!(error.starts_with("\"stop_picture\": ") && error.contains(why), "{name}: {error}");
    }
    let gain =
        build(&host_with(TABLE), &[("stop_picture_gain", "true")]).map(|_| ()).expect_err("no picture");
    assert!(gain.to_string().contains("none is given"), "{gain}");
    let stopless = [("stop_picture", &*folder.path("stop.png"))];
    let error = build(&host_with("50 6 1.5 22\n-50 4 1 22\n"), &stopless).map(|_| ()).expect_err("no stop");
    assert!(error.to_string().contains("no stop row for \"stop_picture\""), "{error}");
    exr::prelude::write_rgb_file(path("bright.exr"), 2, 2, |_, _| (3.0_f32, 3.0_f32, 3.0_f32))
        .expect("written");
    let (_, log) = folder.built("bright.exr", &[]).expect("allowed");
    assert!(log.iter().any(|line| line.contains("pass more light than comes")), "{log:?}");
}
