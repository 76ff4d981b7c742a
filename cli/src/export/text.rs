//! Writes models in the file formats of other programs.

use super::field::ChiefField;
use super::illumination::Illumination;
use super::model::{Fitted, Model};
use realistic_camera::Exposure;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Data of the lens besides its model.
#[derive(Clone, Copy, Debug)]
pub struct LensData<'a> {
    /// Name of the lens.
    pub name: &'a str,
    /// Focal length, mm.
    pub focal_length: f64,
    /// f-number: focal length over the diameter of the axial beam.
    pub fnumber: f64,
    /// f-number over the square root of the transmission on the axis, if a coating is given.
    pub tnumber: Option<f64>,
    /// The exposure, if one is given.
    pub exposure: Option<LensExposure>,
    /// Wavelength, nm.
    pub wavelength: f64,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// mm per world unit.
    pub mm_per_unit: f64,
}

/// Exposure of a camera with this lens, as `UsdGeomCamera` defines it: its linear scale is responsivity · time · iso /
/// 100 · 2^exposure / f-stop².
#[derive(Clone, Copy, Debug)]
pub struct LensExposure {
    /// The exposure as requested.
    pub exposure: Exposure,
    /// f-number of a lossless lens that lights the middle of the film as much as this lens does at this focus.
    pub fstop: f64,
}

/// Writes `OpenCV`'s calibration file, for `cv2.FileStorage`.
pub fn opencv_yaml(fitted: &Fitted, rms: f64) -> String {
    let [width, height] = fitted.held.film.size;
    let (scale, distortion) = (fitted.law.scale, fitted.distortion());
    let [cx, cy] = fitted.held.film.principal_point();
    let model = if fitted.model == Model::KannalaBrandt { "fisheye" } else { "pinhole" };
    let numbers = |all: &[f64]| all.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(", ");
    format!(
        "%YAML:1.0\n---\nimage_width: {width}\nimage_height: {height}\ncamera_model: \"{model}\"\n\
         camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {} ]\n\
         distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: {}\n   dt: d\n   data: [ {} ]\n\
         avg_reprojection_error: {rms:e}\n",
        numbers(&[scale, 0.0, cx, 0.0, scale, cy, 0.0, 0.0, 1.0]),
        distortion.len(),
        numbers(&distortion)
    )
}

/// Writes a sample of `OpenTrackIO` with the distortion in both directions, D-U first, for radii in mm.
///
/// `undistorted` is the model of the other direction, [`Model::OpenCvRational`], fitted to the same rays.
pub fn opentrackio_json(
    lens: &LensData<'_>,
    fitted: &Fitted,
    undistorted: &Fitted,
    illumination: Option<&Illumination>,
) -> Value {
    let film = fitted.held.film;
    let [width, height] = film.sides();
    let scale = fitted.focal_length();
    // Ratios of the undistorted picture to the film; their reciprocals are those of the lens's picture to its part on
    // the film.
    let ratios = fitted.held.rings[1..].iter().map(|ring| scale * ring.angle.tan() / ring.radius);
    let overscan = ratios.clone().fold(1.0, f64::max);
    let other = ratios.map(f64::recip).fold(1.0, f64::max);
    let rays = &fitted.held;
    let mut value = json!({
        "protocol": { "name": "OpenTrackIO", "version": [1, 0, 1] },
        "static": {
            "camera": {
                "activeSensorPhysicalDimensions": { "width": width, "height": height },
                "activeSensorResolution": { "width": film.size[0], "height": film.size[1] },
            },
            "lens": { "model": lens.name, "nominalFocalLength": lens.focal_length },
        },
        "lens": {
            "distortion": [
                { "model": "Brown-Conrady D-U", "radial": fitted.distortion(), "overscan": overscan },
                { "model": "Brown-Conrady U-D", "radial": undistorted.radial_from_undistorted(), "overscan": other },
            ],
            "entrancePupilOffset": (rays.pinhole - film.z) / 1000.0,
            "fStop": lens.fnumber,
            "pinholeFocalLength": scale * film.pixel(),
            "projectionOffset": { "x": 0.0, "y": 0.0 },
        },
    });
    if let Some(tnumber) = lens.tnumber {
        value["lens"]["tStop"] = json!(tnumber);
    }
    let distance = rays.in_focus - film.z;
    // The schema has no infinity, so a lens focused at infinity has no such entry.
    if distance.is_finite() {
        value["lens"]["focusDistance"] = json!(distance / 1000.0);
    }
    if let Some([a1, a2, a3]) = illumination.map(|light| light.falloff_per_mm()).as_deref() {
        value["lens"]["exposureFalloff"] = json!({ "a1": a1, "a2": a2, "a3": a3 });
    }
    value
}

/// Distance that represents infinity in files without infinity, mm.
const INFINITY: f64 = 1e9;

/// Writes the camera of a USD file: the attributes of `UsdGeomCamera`, with lengths of the film in tenths of a world
/// unit.
fn camera(lens: &LensData<'_>, rays: &ChiefField) -> String {
    let tenth = 0.1 * lens.mm_per_unit;
    let film = rays.film;
    let [width, height] = film.sides().map(|side| side / tenth);
    let focal_length = rays.central_scale() * film.pixel() / tenth;
    let distance = (rays.in_focus - rays.pinhole).min(INFINITY) / lens.mm_per_unit;
    let (near, far) = (rays.central_scale() * film.pixel() / lens.mm_per_unit, INFINITY / lens.mm_per_unit);
    format!(
        "    token projection = \"perspective\"\n    float focalLength = {focal_length}\n    float horizontalAperture = {width}\n    \
         float verticalAperture = {height}\n    float horizontalApertureOffset = 0\n    float verticalApertureOffset = 0\n    \
         float focusDistance = {distance}\n    float fStop = {}\n    float2 clippingRange = ({near}, {far})\n",
        lens.fnumber
    )
}

/// Writes a USD file with a camera that other files can reference or copy. The camera's origin is the projection
/// centre, and it looks along -z.
fn stage(lens: &LensData<'_>, schema: &str, attributes: &str) -> String {
    format!(
        "#usda 1.0\n(\n    defaultPrim = \"Camera\"\n    metersPerUnit = {}\n    upAxis = \"Y\"\n)\n\ndef Camera \
         \"Camera\"{schema}\n{{\n{attributes}}}\n",
        lens.mm_per_unit / 1000.0
    )
}

/// Writes `UsdGeomCamera` as text, without distortion, with the lens's other data as custom attributes.
pub fn usda(
    lens: &LensData<'_>,
    rays: &ChiefField,
    illumination: Option<&Illumination>,
    worst: f64,
) -> String {
    let mut text = camera(lens, rays);
    if let Some(LensExposure { exposure, fstop }) = lens.exposure {
        let Exposure { iso, time, stops, responsivity } = exposure;
        let _ = writeln!(
            text,
            "    float exposure = {stops}\n    float exposure:iso = {iso}\n    float exposure:time = {time}\n    \
             float exposure:fStop = {fstop}\n    float exposure:responsivity = {responsivity}"
        );
    }
    let quoted = lens.name.replace('\\', "\\\\").replace('"', "\\\"");
    let _ = writeln!(text, "    custom string realistic:lens = \"{quoted}\"");
    let mut number = |name: &str, value: f64| {
        if value.is_finite() {
            let _ = writeln!(text, "    custom double realistic:{name} = {value}");
        }
    };
    number("wavelengthNm", lens.wavelength);
    number("effectiveFocalLengthMm", lens.focal_length);
    number("filmDistanceMm", lens.film_distance);
    number("entrancePupilFromFilmMm", rays.pinhole - rays.film.z);
    number("pupilWalkMm", rays.extent().1);
    number("worstErrorPixels", worst);
    let [width, height] = rays.film.size;
    let _ = writeln!(text, "    custom int2 realistic:filmPixels = ({width}, {height})");
    let mut numbers = |name: &str, values: &[f64]| {
        let values = values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "    custom double[] realistic:{name} = [{values}]");
    };
    // The focal length in pixels comes first, then the coefficients.
    for (name, model) in [("opencv", Model::OpenCv), ("kannalaBrandt", Model::KannalaBrandt)] {
        let fitted = model.fitted(rays);
        numbers(name, &[&[fitted.focal_length()], &fitted.distortion()[..]].concat());
    }
    if let Some(light) = illumination {
        numbers("relativeIllumination", &light.polynomial);
    }
    stage(lens, "", &text)
}

/// Writes NVIDIA's f-theta camera: `UsdGeomCamera` with `OmniLensDistortionFthetaAPI`, which gives angles as a
/// function of radii in pixels.
pub fn ftheta_usda(lens: &LensData<'_>, fitted: &Fitted) -> String {
    let mut text = camera(lens, &fitted.held);
    let [width, height] = fitted.held.film.size.map(f64::from);
    let _ = writeln!(text, "    token omni:lensdistortion:model = \"ftheta\"");
    let prefix = "omni:lensdistortion:ftheta";
    let _ = writeln!(
        text,
        "    float {prefix}:nominalWidth = {width}\n    float {prefix}:nominalHeight = {height}"
    );
    let _ = writeln!(text, "    float2 {prefix}:opticalCenter = ({}, {})", 0.5 * width, 0.5 * height);
    let _ = writeln!(text, "    float {prefix}:maxFov = {}", fitted.full_field());
    for (i, k) in fitted.distortion().iter().enumerate() {
        let _ = writeln!(text, "    float {prefix}:k{i} = {k:e}");
    }
    stage(lens, " (\n    prepend apiSchemas = [\"OmniLensDistortionFthetaAPI\"]\n)", &text)
}
