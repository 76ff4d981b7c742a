//! `realistic export`: compares every model with exact chief rays, by formulas written independently here.

use super::{fails, succeeds};
use realistic_optics::imaging::focus::Focus;
use realistic_optics::lens::Lens;
use realistic_optics::prescription::catalogue;
use realistic_trace::field::Field;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const MODELS: [&str; 6] = ["usd", "opencv", "opencv-rational", "opentrackio", "kannala-brandt", "ftheta"];

fn report(lens: &str, model: &str, more: &[&str]) -> Value {
    let arguments = [&["export", lens, "--as", model, "--json", "--quiet"], more].concat();
    serde_json::from_str(&succeeds(&arguments, "")).expect("JSON")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(|number| number.as_f64().expect("a number")).collect()
}

/// Returns the film radius, pixels, at which a model with these parameters sees `angle`, by the formulas of the
/// model's own programs.
fn projected(report: &Value, angle: f64) -> f64 {
    let parameters = &report["parameters"];
    let tangent = angle.tan();
    let invert = |function: &dyn Fn(f64) -> f64, target: f64| {
        let (mut low, mut high) = (0.0, 1.02 * number(report, "lit_radius_px"));
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if function(middle) < target { low = middle } else { high = middle }
        }
        low
    };
    match report["as"].as_str().expect("a name") {
        "usd" => number(parameters, "fx_px") * tangent,
        "opencv" | "opencv-rational" => {
            let mut k = numbers(&parameters["distortion"]);
            k.resize(8, 0.0);
            let r2 = tangent * tangent;
            let above = 1.0 + k[0] * r2 + k[1] * r2.powi(2) + k[4] * r2.powi(3);
            let below = 1.0 + k[5] * r2 + k[6] * r2.powi(2) + k[7] * r2.powi(3);
            number(parameters, "fx_px") * tangent * above / below
        }
        "kannala-brandt" => {
            let k = numbers(&parameters["distortion"]);
            let powers = [3, 5, 7, 9].map(|power| angle.powi(power));
            number(parameters, "fx_px") * (angle + k.iter().zip(powers).map(|(k, t)| k * t).sum::<f64>())
        }
        "ftheta" => {
            let k = numbers(&parameters["k"]);
            let angle_at = |r: f64| k[0] + k[1] * r + k[2] * r * r + k[3] * r.powi(3) + k[4] * r.powi(4);
            invert(&angle_at, angle)
        }
        "opentrackio" => {
            let (l, pixel) = (numbers(&parameters["radial_per_mm"]), number(report, "pixel_mm"));
            let undistorted = |r: f64| {
                let mm = r * pixel;
                let z = mm * mm;
                let above = 1.0 + l[0] * z + l[2] * z.powi(2) + l[4] * z.powi(3);
                mm * above / (1.0 + l[1] * z + l[3] * z.powi(2) + l[5] * z.powi(3))
            };
            invert(&undistorted, number(parameters, "pinhole_focal_length_mm") * tangent)
        }
        other => panic!("{other}"),
    }
}

/// Returns the angle from the axis at which the entrance pupil sees the point in focus on the exact chief ray of a
/// film point; the argument is the film point's distance from the centre, pixels.
fn exact(lens: &str, report: &Value) -> impl Fn(f64) -> Option<f64> {
    let lens = Lens::new(&catalogue::find(lens).expect("listed"), number(report, "wavelength"));
    let field = Field::new(&lens, lens.rear().vertex - number(report, "film_distance"));
    let (pixel, pinhole) = (number(report, "pixel_mm"), number(report, "entrance_pupil_mm"));
    let distance = report["focus_distance_mm"].as_f64();
    let plane = distance.map(|distance| lens.rear().vertex - number(report, "film_distance") + distance);
    move |radius| {
        let ray = field.chief_ray(radius * pixel)?;
        let ([_, oy, oz], [_, dy, dz]) = (ray.origin, ray.direction);
        let Some(plane) = plane else { return Some((-dy).atan2(dz)) };
        let from_pinhole = |along: f64| [oy + along * dy, oz + along * dz - pinhole];
        let [y, z] = from_pinhole((plane - oz) / dz);
        // The largest distance is ten times the distance of the plane in focus on the axis.
        let most = 10.0 * (plane - pinhole);
        if dz > 0.0 && y.hypot(z) <= most {
            return Some((-y).atan2(z));
        }
        let (mut near, mut far) = (0.0, 2.0 * most);
        for _ in 0..100 {
            let middle = 0.5 * (near + far);
            let [y, z] = from_pinhole(middle);
            if y.hypot(z) < most { near = middle } else { far = middle }
        }
        let [y, z] = from_pinhole(near);
        Some((-y).atan2(z))
    }
}

#[test]
fn the_stated_error_of_every_model_holds_between_fitted_rays() {
    for lens in ["dgauss.50mm", "wide.22mm", "retrofocus.24mm", "fisheye.10mm", "fisheye.6mm", "phone.4mm"] {
        for model in MODELS {
            let report = report(lens, model, &[]);
            let exact = exact(lens, &report);
            let lit = number(&report, "lit_radius_px");
            let held = report["held_half_field_deg"].as_f64().expect("a model").to_radians();
            let worst = number(&report["errors"], "worst_px");
            let mut found: f64 = 0.0;
            // These steps differ from those of the fit.
            for i in 0..=147 {
                let radius = lit * ((f64::from(i) + 0.37) / 147.37).min(1.0 - 1e-9);
                let Some(angle) = exact(radius).filter(|angle| *angle <= held) else { continue };
                found = found.max((projected(&report, angle) - radius).abs());
            }
            assert!(found <= 1.02 * worst + 1e-6, "{lens} {model}: {found} is more than {worst}");
            assert!(found >= 0.5 * worst - 1e-6, "{lens} {model}: {found} is far less than {worst}");
            let rms = number(&report["errors"], "rms_px");
            assert!(rms <= worst && rms > 0.0, "{lens} {model}: {rms} {worst}");
        }
    }
}

#[test]
fn a_near_focus_model_sees_points_of_the_plane_of_focus() {
    let name = "wide.22mm";
    let report = report(name, "opencv-rational", &["--focus-distance", "400"]);
    assert!((number(&report, "focus_distance_mm") - 400.0).abs() < 1e-6, "{report}");
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    let film = lens.rear().vertex - number(&report, "film_distance");
    let (field, pixel) = (Field::new(&lens, film), number(&report, "pixel_mm"));
    let pinhole = number(&report, "entrance_pupil_mm");
    assert!((pinhole - film - number(&report, "entrance_pupil_from_film_mm")).abs() < 1e-9);
    let worst = number(&report["errors"], "worst_px");
    assert!(worst < 0.01, "{worst}");
    for radius in [100.0, 555.0, 999.0] {
        let ray = field.chief_ray(radius * pixel).expect("lit");
        let along = (film + 400.0 - ray.origin[2]) / ray.direction[2];
        let [y, z] = [1, 2].map(|axis| ray.origin[axis] + along * ray.direction[axis]);
        let found = projected(&report, (-y).atan2(z - pinhole));
        assert!((found - radius).abs() <= 1.02 * worst + 1e-6, "{found} {radius}");
        // The pupil shift is visible where the ray crosses the axis.
        let crossing = ray.origin[2] - ray.origin[1] * ray.direction[2] / ray.direction[1];
        assert!(
            (crossing - pinhole).abs() <= number(&report, "pupil_walk_mm") * 1.001,
            "{crossing} {pinhole}"
        );
    }
    // This lens moves as a whole; when it is refocused, the image grows as the film moves away.
    let breathing = report["breathing"].as_array().expect("an array");
    let scales: Vec<f64> = breathing.iter().map(|focus| number(focus, "image_scale_px")).collect();
    assert!(scales.len() == 4 && scales.windows(2).all(|pair| pair[0] < pair[1]), "{scales:?}");
    let errors: Vec<f64> = breathing.iter().map(|focus| number(&focus["errors"], "worst_px")).collect();
    assert!(errors.iter().all(|error| *error > 1.0), "{errors:?}");
}

#[test]
fn a_model_that_falls_states_how_far_its_inverse_goes() {
    let fisheye = report("fisheye.10mm", "opencv", &[]);
    assert_eq!(fisheye["monotonic"]["over_the_fit"], false);
    let end = number(&fisheye["monotonic"], "to_deg").to_radians();
    let [before, after] = [-1e-3, 2e-2].map(|by| {
        let step = 1e-5;
        projected(&fisheye, end + by + step) - projected(&fisheye, end + by)
    });
    assert!(before > 0.0 && after < 0.0, "{end}: {before} {after}");
    assert_eq!(report("wide.22mm", "opencv", &[])["monotonic"]["over_the_fit"], true);
    let words = succeeds(&["export", "fisheye.10mm", "--as", "opencv", "-o", "/dev/null"], "");
    assert!(words.contains("monotonic only to"), "{words}");
}

#[test]
fn rays_that_a_plane_cannot_hold_are_reported() {
    let wide = report("fisheye.6mm", "opencv-rational", &[]);
    assert!(number(&wide, "half_field_deg") > 90.0);
    assert!(number(&wide, "held_half_field_deg") < 80.0 && number(&wide["errors"], "share_of_film") < 0.9);
    let words = succeeds(&["export", "fisheye.6mm", "--as", "opencv", "-o", "/dev/null"], "");
    assert!(words.contains("projects onto a plane") && words.contains("kannala-brandt"), "{words}");
    let whole = report("fisheye.6mm", "ftheta", &[]);
    assert_eq!(number(&whole, "held_half_field_deg"), number(&whole, "half_field_deg"));
    // If the film is larger than the image, only the lit part is fitted, and the report states this.
    let dark = report("dgauss.50mm", "opencv", &["--film-diagonal", "80"]);
    assert!(number(&dark, "lit_share_of_film") < 0.9 && number(&dark["errors"], "worst_px") < 1.0, "{dark}");
    let words = succeeds(
        &["export", "dgauss.50mm", "--as", "opencv", "--film-diagonal", "80", "-o", "/dev/null"],
        "",
    );
    assert!(words.contains("light ends"), "{words}");
}

#[test]
fn what_cannot_be_exported_is_refused_with_what_to_do() {
    let dir = tempfile::tempdir().unwrap();
    let png = dir.path().join("map.png").display().to_string();
    assert!(fails(&["export", "wide.22mm", "--as", "rays"], "", 2).contains("--out FILE.exr"));
    assert!(fails(&["export", "wide.22mm", "--as", "rays", "-o", &png], "", 2).contains(".npy"));
    assert!(fails(&["export", "wide.22mm", "--as", "fish"], "", 2).contains("kannala-brandt"));
    assert!(fails(&["export", "wide.22mm"], "", 2).contains("--as"));
    assert!(fails(&["export", "--as", "opencv"], "", 2).contains("which lens"));
}

/// Returns height, width, channels and values of a `NumPy` file.
pub fn npy(path: &Path) -> ([usize; 3], Vec<f32>) {
    let bytes = fs::read(path).unwrap();
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00") && start.is_multiple_of(64));
    let header = std::str::from_utf8(&bytes[10..start]).unwrap();
    let shape = header.split(['(', ')']).nth(1).unwrap();
    let shape: Vec<usize> = shape.split(", ").map(|side| side.parse().unwrap()).collect();
    let values = bytes[start..].chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap()));
    (shape.try_into().unwrap(), values.collect())
}

fn written(directory: &Path, lens: &str, format: &str, file: &str) -> PathBuf {
    let path = directory.join(file);
    let out = path.display().to_string();
    succeeds(&["export", lens, "--as", format, "--size", "96x64", "-o", &out], "");
    path
}

#[test]
fn the_rays_of_every_pixel_are_the_exact_ones() {
    let dir = tempfile::tempdir().unwrap();
    let (shape, values) = npy(&written(dir.path(), "wide.22mm", "rays", "rays.npy"));
    assert_eq!(shape, [64, 96, 6]);
    let report = report("wide.22mm", "rays", &["--size", "96x64"]);
    let lens = Lens::at_d_line(&catalogue::find("wide.22mm").expect("listed"));
    let field = Field::new(&lens, lens.rear().vertex - number(&report, "film_distance"));
    for (column, row) in [(0, 0), (95, 63), (50, 10), (3, 40)] {
        let (x, y) = (column as f64 + 0.5 - 48.0, row as f64 + 0.5 - 32.0);
        let radius = x.hypot(y);
        let ray = field.chief_ray(radius * number(&report, "pixel_mm")).expect("lit");
        // A pixel at the right sees the right side, and a pixel below the centre sees below, where lens space has y
        // up.
        let turned = |[_, h, z]: [f64; 3]| [-h * x / radius, h * y / radius, z];
        let expected = [turned(ray.origin), turned(ray.direction)].concat();
        let found = &values[6 * (96 * row + column)..][..6];
        for (a, b) in found.iter().zip(&expected) {
            assert!((f64::from(*a) - b).abs() < 1e-6 * (1.0 + b.abs()), "{found:?} {expected:?}");
        }
        assert!(x * f64::from(found[3]) > 0.0 && y * f64::from(found[4]) < 0.0);
    }
    // An EXR file has the same values, with the channels in alphabetical order.
    let path = written(dir.path(), "wide.22mm", "rays", "rays.exr");
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    let channels = &image.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["direction.X", "direction.Y", "direction.Z", "origin.X", "origin.Y", "origin.Z"]);
    let exr::prelude::FlatSamples::F32(first) = &channels[0].sample_data else { panic!("32-bit floats") };
    assert!(first.iter().zip(values.iter().skip(3).step_by(6)).all(|(a, b)| a == b));
}

#[test]
fn st_maps_lead_there_and_back_and_hold_the_exact_distortion() {
    let dir = tempfile::tempdir().unwrap();
    written(dir.path(), "retrofocus.24mm", "st-map", "st.npy");
    let maps = ["undistort", "distort"].map(|direction| npy(&dir.path().join(format!("st.{direction}.npy"))));
    let report = report("retrofocus.24mm", "st-map", &["--size", "96x64"]);
    let exact = exact("retrofocus.24mm", &report);
    let scale = number(&report, "pinhole_focal_length_px");
    for ([height, width, channels], values) in &maps {
        assert_eq!([*height, *width, *channels], [64, 96, 3]);
        for value in values.chunks_exact(3) {
            assert!(value[2] == 1.0 || value == [-1.0, -1.0, 0.0], "{value:?}");
        }
    }
    // The pixel's centre and the map's value at that pixel are both measured from the middle of the picture, down and
    // to the right.
    let read = |(_, values): &(_, Vec<f32>), column: usize, row: usize| {
        let at = &values[3 * (96 * row + column)..][..2];
        [96.0 * (f64::from(at[0]) - 0.5), 64.0 * (0.5 - f64::from(at[1]))]
    };
    for (column, row) in [(0, 0), (90, 60), (47, 31), (10, 50)] {
        let [x, y] = [column as f64 + 0.5 - 48.0, row as f64 + 0.5 - 32.0];
        // A pixel of the lens's picture maps to the point of the pinhole's picture that sees the same object.
        let [u, v] = read(&maps[1], column, row);
        let expected = scale * exact(x.hypot(y)).expect("lit").tan();
        assert!((u.hypot(v) - expected).abs() < 1e-4 && (u * y - v * x).abs() < 1e-2, "{u} {v} {expected}");
        // A pixel of the pinhole's picture maps to the point of the lens's picture with the same ray.
        let [u, v] = read(&maps[0], column, row);
        let angle = (x.hypot(y) / scale).atan();
        let back = exact(u.hypot(v)).expect("lit");
        assert!((back - angle).abs() < 1e-5 && u * x > 0.0 && v * y > 0.0, "{back} {angle}");
    }
}

#[test]
fn relative_illumination_is_that_of_the_pupils_area() {
    let report = report("wide.22mm", "illumination", &[]);
    let light = &report["illumination"];
    let (radii, values) = (numbers(&light["film_radius_px"]), numbers(&light["relative_illumination"]));
    let polynomial = numbers(&light["polynomial"]);
    let irradiance = |radius: f64| {
        let mm = (radius * number(&report, "pixel_mm")).to_string();
        let text = succeeds(&["pupil", "wide.22mm", "--film-radius", &mm, "--json"], "");
        number(&serde_json::from_str(&text).expect("JSON"), "irradiance_for_unit_radiance")
    };
    let corner = 0.5 * number(&report, "film_diagonal") / number(&report, "pixel_mm");
    let middle = irradiance(0.0);
    for i in [0, 9, 20, 31] {
        let expected = irradiance(radii[i]) / middle;
        assert!((values[i] - expected).abs() < 1e-3, "{} {expected}", values[i]);
        let square = (radii[i] / corner).powi(2);
        let fitted = 1.0 + (1..).zip(&polynomial).map(|(power, a)| a * square.powi(power)).sum::<f64>();
        assert!((fitted - values[i]).abs() <= number(light, "worst_error") * (1.0 + 1e-9), "{fitted}");
    }
    assert!(values.windows(2).all(|pair| pair[1] < pair[0]) && number(light, "worst_error") < 0.05);
}

#[test]
fn spots_match_focus_on_the_axis_and_grow_toward_the_corner() {
    let at = |more: &[&str]| {
        let report = report("dgauss.50mm", "spot", more);
        report["spots"].as_array().expect("an array").clone()
    };
    let open = at(&[]);
    assert_eq!(open.len(), 7);
    let axis = &open[0];
    assert!(number(axis, "offset_mm").abs() < 1e-6);
    assert!((number(axis, "rms_radial_mm") / number(axis, "rms_tangential_mm") - 1.0).abs() < 1e-3);
    assert!(number(axis, "encircled_50_mm") < number(axis, "encircled_80_mm"));
    // Focusing uses rays that are uniform over the pupil; the expected value is the RMS distance from the axis of the
    // rays of an axial point.
    let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("listed"));
    let [rms, _] = Focus::new(&lens).expect("it focuses").axial_spot();
    let found = number(axis, "rms_radial_mm").hypot(number(axis, "rms_tangential_mm"));
    assert!((found / rms - 1.0).abs() < 0.01, "{found} {rms}");
    let stopped = at(&["--fnumber", "22"]);
    assert!(number(&stopped[6], "rms_radial_mm") < number(&open[6], "rms_radial_mm"));
    // The Airy disk of the axial cone, whose f-number `psf` reports; toward the corner the cone is narrower.
    let cone =
        succeeds(&["psf", "dgauss.50mm", "--json", "--rays", "64", "--pixels", "8", "--fnumber", "22"], "");
    let cone = number(&serde_json::from_str(&cone).expect("JSON"), "fnumber_of_cone");
    let airy = number(&stopped[0], "airy_radius_mm");
    assert!((airy / (1.22 * 587.56e-6 * cone) - 1.0).abs() < 0.01, "{airy} {cone}");
    assert!(airy > number(&stopped[0], "rms_radial_mm") && airy < number(&stopped[6], "airy_radius_mm"));
    assert!(number(axis, "airy_radius_mm") < 0.1 * airy);
    let csv = succeeds(&["export", "dgauss.50mm", "--as", "spot"], "");
    let last =
        csv.lines().last().unwrap().split(',').map(|cell| cell.parse::<f64>().unwrap()).collect::<Vec<_>>();
    assert!((last[4] - number(&open[6], "rms_radial_mm")).abs() < 1e-6, "{csv}");
    assert_eq!(csv.lines().next().unwrap().split(',').count(), last.len());
}

#[test]
fn files_of_models_have_the_numbers_of_the_report() {
    let usd = succeeds(&["export", "wide.22mm", "--as", "usd", "--mm-per-unit", "10"], "");
    let value = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.contains(&format!(" {name} ="))).expect("an attribute");
        line.split(" = ").nth(1).unwrap().parse::<f64>().expect("a number")
    };
    let numbers_of = report("wide.22mm", "usd", &[]);
    // If the world unit is a centimetre, a tenth of a unit is a millimetre.
    let focal_length = number(&numbers_of["parameters"], "fx_px") * number(&numbers_of, "pixel_mm");
    assert!((value(&usd, "focalLength") - focal_length).abs() < 1e-9, "{usd}");
    let size = numbers(&numbers_of["film_size_mm"]);
    assert!((value(&usd, "horizontalAperture") - size[0]).abs() < 1e-9);
    assert!(usd.contains("metersPerUnit = 0.01\n"));
    let ftheta = succeeds(&["export", "wide.22mm", "--as", "ftheta"], "");
    let k = numbers(&report("wide.22mm", "ftheta", &[])["parameters"]["k"]);
    for (i, k) in k.iter().enumerate() {
        // serde_json may read the last digit of a number one unit too high or too low.
        let written = value(&ftheta, &format!("omni:lensdistortion:ftheta:k{i}"));
        assert!((written - k).abs() <= 1e-15 * k.abs(), "{written} {k}");
    }
    let track = succeeds(&["export", "wide.22mm", "--as", "opentrackio", "--focus-distance", "2000"], "");
    let track: Value = serde_json::from_str(&track).expect("JSON");
    let own = report("wide.22mm", "opentrackio", &["--focus-distance", "2000"]);
    let lens = &track["lens"];
    assert!((number(lens, "focusDistance") - 2.0).abs() < 1e-9);
    assert!(
        (number(lens, "entrancePupilOffset") * 1e3 - number(&own, "entrance_pupil_from_film_mm")).abs()
            < 1e-9
    );
    let radial = numbers(&own["parameters"]["radial_per_mm"]);
    for (written, l) in numbers(&lens["distortion"][0]["radial"]).iter().zip(&radial) {
        assert!((written - l).abs() <= 1e-15 * l.abs(), "{written} {l}");
    }
    // A T-number is present only if surfaces reflect, and then equals the one in the lens's own report.
    assert!(lens.get("tStop").is_none(), "{lens}");
    let coated = ["export", "wide.22mm", "--as", "opentrackio", "--transmission", "quarter-wave"];
    let coated: Value = serde_json::from_str(&succeeds(&coated, "")).expect("JSON");
    let facts: Value = serde_json::from_str(&succeeds(&["lens", "wide.22mm", "--json"], "")).expect("JSON");
    let (found, known) = (number(&coated["lens"], "tStop"), number(&facts, "tnumber_quarter_wave"));
    assert!(
        (found / known - 1.0).abs() < 1e-9 && found > number(&coated["lens"], "fStop"),
        "{found} {known}"
    );
    // The formula for the opposite direction leads back to the angle, within the errors of both formulas.
    let l = numbers(&lens["distortion"][1]["radial"]);
    let (focal_length, pixel) = (number(lens, "pinholeFocalLength"), number(&own, "pixel_mm"));
    for angle in [0.1_f64, 0.4, 0.65] {
        let undistorted = focal_length * angle.tan();
        let z = undistorted * undistorted;
        let above = 1.0 + l[0] * z + l[2] * z.powi(2) + l[4] * z.powi(3);
        let distorted = undistorted * above / (1.0 + l[1] * z + l[3] * z.powi(2) + l[5] * z.powi(3)) / pixel;
        let both = number(&own["errors"], "worst_px") + number(&own["errors_from_undistorted"], "worst_px");
        assert!((distorted - projected(&own, angle)).abs() < both + 1e-5, "{distorted}");
    }
}

/// Returns the table of docs/export.md, which has the worst pixel of each model for the catalogue's lenses.
fn table() -> String {
    let list: Value = serde_json::from_str(&succeeds(&["lens", "--list", "--json"], "")).expect("JSON");
    let names = list.as_array().unwrap().iter().map(|lens| lens["name"].as_str().unwrap());
    // Exports need a round lens.
    let names: Vec<&str> = names.filter(|name| catalogue::round().any(|round| round == *name)).collect();
    let row = |name: &&str| {
        let reports = MODELS.map(|model| report(name, model, &[]));
        let mut line = format!(
            "| `{name}` | {:.1} | {:.2} ",
            number(&reports[0], "half_field_deg"),
            number(&reports[0], "pupil_walk_mm")
        );
        for report in &reports {
            let worst = number(&report["errors"], "worst_px");
            let digits = match worst {
                0.0..1e-3 => "< 0.001".to_owned(),
                1e-3..10.0 => format!("{worst:.3}"),
                _ => format!("{worst:.0}"),
            };
            let marks = [
                (report["monotonic"]["over_the_fit"] == false, "†"),
                (
                    number(&report["errors"], "share_of_film") < number(report, "lit_share_of_film") - 1e-3,
                    "*",
                ),
            ];
            let marks: String = marks.iter().filter(|(holds, _)| *holds).map(|(_, mark)| *mark).collect();
            let _ = write!(line, "| {digits}{marks} ");
        }
        line + "|\n"
    };
    let mut text = format!("| lens | half field, ° | pupil's walk, mm | {} |\n", MODELS.join(" | "));
    text += &format!("|---|{}\n", "--:|".repeat(MODELS.len() + 2));
    text + &names.iter().map(row).collect::<String>()
}

#[test]
fn the_catalogues_table_is_what_the_program_prints() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/export.md");
    let page = fs::read_to_string(&path).expect("the page");
    let (before, rest) = page.split_once("<!-- table -->\n").expect("where it begins");
    let (written, after) = rest.split_once("<!-- end of table -->").expect("where it ends");
    let table = table();
    if std::env::var_os("REALISTIC_WRITE_TABLE").is_some() {
        fs::write(&path, format!("{before}<!-- table -->\n{table}<!-- end of table -->{after}")).unwrap();
        return;
    }
    assert_eq!(written, table, "REALISTIC_WRITE_TABLE=1 writes it anew");
}

#[test]
fn usd_has_an_exposure_only_if_one_is_given() {
    let usd = |more: &[&str]| {
        succeeds(&[&["export", "dgauss.50mm", "--as", "usd", "--out", "-"], more].concat(), "")
    };
    assert!(!usd(&[]).contains("exposure"));
    let exposed = usd(&["--iso", "200", "--exposure-time", "0.01", "--exposure", "-1"]);
    let attribute = |name: &str| -> f64 {
        let (_, rest) =
            exposed.split_once(&format!("    float {name} = ")).unwrap_or_else(|| panic!("{name}"));
        rest.lines().next().unwrap().parse().unwrap()
    };
    let names = ["exposure", "exposure:iso", "exposure:time", "exposure:responsivity"];
    assert_eq!(names.map(attribute), [-1.0, 200.0, 0.01, 1.0]);
    // For a corrected lens focused at infinity, the T-number without losses is nearly the f-number.
    assert!((attribute("exposure:fStop") / attribute("fStop") - 1.0).abs() < 0.05, "{exposed}");
}
