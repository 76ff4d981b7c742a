//! Builds the cameras without a prescription from parameters, like pbrt-v1's stock cameras: perspective, orthographic,
//! environment.

use std::{f64::consts::PI, sync::Arc};

use super::{
    environment::Environment,
    projective::{Projecting, Projective, ThinLens},
    spaces::ScreenWindow,
};
use crate::{
    film::Raster,
    host::Host,
    importance::{AdjointCamera, ImportanceError, Linear, PlaneMap},
    model::Model,
    parameters::{CameraError, LensPlane, ParameterError, Parameters},
    pipeline::{
        ray_maker::RayMaker,
        stock::{StockTracer, View},
    },
    placement::Placement,
    sampling::DiskMapping,
    setup::{disk_mapping, placement, raster},
};
use realistic_base::message::{Level, Log, as_given};

/// Least `hither` of pbrt's stock cameras, world units.
const LEAST_HITHER: f64 = 1e-4;
/// Largest `yon` of pbrt's stock cameras, world units.
const LARGEST_YON: f64 = 1e30;
/// Distance to the plane of focus that stands for infinity, world units.
const FOCUSED_AT_INFINITY: f64 = 1e30;

/// A camera without a lens prescription. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct StockCamera {
    pub rays: RayMaker,
    /// Mapping of lens samples to the disk; `None` without a lens.
    pub mapping: Option<DiskMapping>,
    /// The linear rays of the adjoint camera and the area of its lens, or the reason why the camera has no
    /// importance.
    adjoint: Result<(Linear, f64), ImportanceError>,
}

impl StockCamera {
    fn new(
        view: impl View + 'static,
        mapping: Option<DiskMapping>,
        placement: Placement,
        adjoint: Result<(Linear, f64), ImportanceError>,
    ) -> Self {
        let tracer = Arc::new(StockTracer::new(view, &placement));
        Self { rays: RayMaker::new(tracer.clone(), tracer, placement), mapping, adjoint }
    }

    /// Returns the adjoint camera.
    ///
    /// # Errors
    /// The camera has no importance.
    pub fn adjoint(&self) -> Result<AdjointCamera, ImportanceError> {
        let (linear, area) = self.adjoint.as_ref().map_err(Clone::clone)?;
        // The camera limits only the depth of the points that it sees, not their distance.
        Ok(AdjointCamera::of_linear(linear, self.rays.placement(), 1.0, *area, [0.0, f64::INFINITY]))
    }
}

/// Builds the camera of model "perspective".
pub fn perspective(given: &Parameters, host: &Host, log: Log<'_>) -> Result<StockCamera, CameraError> {
    projective(Projecting::Perspective { fov: given.fov()? as f32 }, given, host, log)
}

/// Builds the camera of model "orthographic".
pub fn orthographic(given: &Parameters, host: &Host, log: Log<'_>) -> Result<StockCamera, CameraError> {
    projective(Projecting::Orthographic, given, host, log)
}

/// Builds the camera of model "environment".
pub fn environment(given: &Parameters, host: &Host, log: Log<'_>) -> Result<StockCamera, CameraError> {
    let (raster, placement) = (raster(host)?, stock_placement(given, host, log)?);
    let model = Model::Environment;
    let advice = "ask a camera with a lens";
    let adjoint = Err(ImportanceError::NoArea { model, parallel: false, advice });
    Ok(StockCamera::new(Environment::new(raster, placement.clip), None, placement, adjoint))
}

fn projective(
    projecting: Projecting,
    given: &Parameters,
    host: &Host,
    log: Log<'_>,
) -> Result<StockCamera, CameraError> {
    let raster = raster(host)?;
    let placement = stock_placement(given, host, log)?;
    let [hither, yon] = placement.clip;
    if !(hither < yon) {
        let range = format!("more than \"hither\", which is {hither}");
        return Err(ParameterError::out_of_range("yon", yon.into(), &range).into());
    }
    let window = window(given, raster)?;
    let lens = thin_lens(given, host, hither)?;
    let view = Projective::new(projecting, window, raster, lens, placement.clip);
    let adjoint = linear(projecting, window, raster, lens, placement.clip);
    Ok(StockCamera::new(view, lens.map(|lens| lens.mapping), placement, adjoint))
}

/// Returns film and lens coordinates as linear functions of a ray's height and slope in the plane of the eye,
/// and the area of the lens. A camera with a lens samples the plane of focus uniformly: in slopes from the
/// eye or, without perspective, in heights.
fn linear(
    projecting: Projecting,
    ScreenWindow([x0, x1, y0, y1]): ScreenWindow,
    raster: Raster,
    lens: Option<ThinLens>,
    clip: [f32; 2],
) -> Result<(Linear, f64), ImportanceError> {
    let (model, parallel, per_screen) = match projecting {
        Projecting::Perspective { fov } => {
            (Model::Perspective, false, (f64::from(fov) / 2.0).to_radians().tan())
        }
        Projecting::Orthographic => (Model::Orthographic, true, 1.0),
    };
    let advice = "give \"lens_radius\"";
    let lens = lens.ok_or(ImportanceError::NoArea { model, parallel, advice })?;
    let (radius, focus) = (f64::from(lens.radius), f64::from(lens.focal_distance));
    // Ratio of the height in the plane of the lens to the height at the eye, both measured from the central
    // ray.
    let at_eye = match lens.plane {
        LensPlane::Eye => 1.0,
        LensPlane::Hither => 1.0 - f64::from(clip[0]) / focus,
    };
    let map = |from_height, from_slope| PlaneMap { from_height, from_slope };
    let (film, lens) = if parallel {
        (map(1.0, focus), map(0.0, -focus * at_eye))
    } else {
        (map(focus.recip(), 1.0), map(at_eye, 0.0))
    };
    let area = PI * radius * radius;
    if parallel {
        // The density of the camera's rays is the square of the distance divided by the product of the areas
        // of film and lens.
        let film_area = f64::from((x1 - x0) * (y1 - y0)).abs();
        let farthest = (f64::from(f32::MAX) * film_area * area / area.max(1.0)).sqrt();
        if !(focus * at_eye.abs() <= farthest) {
            // Rounds down to a power of ten and leaves another factor of ten for a camera transform that
            // scales.
            let farthest = format!("{:.0e}", 10.0_f64.powf(farthest.log10().floor() - 1.0));
            return Err(ImportanceError::Parallel { model, farthest });
        }
    }
    // Factor and constant from film coordinates to raster coordinates.
    let axis = |from: f32, to: f32, pixels: u32| {
        let (from, to, pixels) = (f64::from(from), f64::from(to), f64::from(pixels));
        [pixels / (to - from) / per_screen, -from * pixels / (to - from)]
    };
    let linear = Linear {
        film,
        lens,
        lens_radius: radius,
        weight: None,
        raster: [axis(x0, x1, raster.xres), axis(y1, y0, raster.yres)],
        size: [raster.xres, raster.yres].map(f64::from),
        depths: clip.map(f64::from),
    };
    Ok((linear, area))
}

/// Returns the placement, with the clip range limited to that of the stock cameras.
fn stock_placement(given: &Parameters, host: &Host, log: Log<'_>) -> Result<Placement, CameraError> {
    let hither = match given.hither {
        Some(hither) if hither < LEAST_HITHER => {
            log(Level::Warning, &format!("\"hither\" {hither} is used as {LEAST_HITHER}, as pbrt does"));
            LEAST_HITHER
        }
        _ => given.hither()?,
    };
    placement([hither, given.yon()?.min(LARGEST_YON)], 1.0, given, host)
}

fn window(given: &Parameters, raster: Raster) -> Result<ScreenWindow, ParameterError> {
    let aspect = given.frame_aspect_ratio()?;
    if let Some(window @ [x0, x1, y0, y1]) = given.screen_window {
        let row = Parameters::row("screen_window");
        if x0 == x1 || y0 == y1 || window.iter().any(|side| row.check(*side).is_err()) {
            return Err(ParameterError::Range {
                name: row.name,
                value: window.map(as_given).join(" "),
                range: format!(
                    "x from, x to, y from, y to, with some width and height, each {}",
                    row.range.in_words("")
                ),
            });
        }
        return Ok(ScreenWindow(window.map(|side| side as f32)));
    }
    let image = raster.xres as f32 / raster.yres as f32;
    Ok(ScreenWindow::of_aspect(aspect.map_or(image, |aspect| aspect as f32)))
}

fn thin_lens(given: &Parameters, host: &Host, hither: f32) -> Result<Option<ThinLens>, ParameterError> {
    let radius = given.lens_radius()?;
    let focal_distance = given.focal_distance()?.min(FOCUSED_AT_INFINITY);
    if radius > 0.0 && !(focal_distance as f32 > hither) {
        let range = format!("more than \"hither\", which is {hither}, in units of camera space");
        return Err(ParameterError::out_of_range("focal_distance", focal_distance, &range));
    }
    let (plane, mapping) = (given.lens_plane(), disk_mapping(given, host)?);
    let (radius, focal_distance) = (radius as f32, focal_distance as f32);
    // A radius that rounds to 0 in single precision gives a pinhole.
    Ok((radius > 0.0).then_some(ThinLens { radius, focal_distance, plane, mapping }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Camera;

    fn build(settings: &[(&str, &str)]) -> (Result<Camera, String>, Vec<String>) {
        let mut warnings = Vec::new();
        let host = Host::new(Raster { xres: 40, yres: 20 }, None);
        let mut camera = || {
            let mut given = Parameters::default();
            for (name, text) in settings {
                given.set_from_text(name, text)?;
            }
            Camera::build(&given, &host, &mut |_, text| warnings.push(text.to_owned()))
        };
        let camera = camera().map_err(|error| error.to_string());
        (camera, warnings)
    }

    #[track_caller]
    fn refused(settings: &[(&str, &str)], parts: &[&str]) {
        let message = build(settings).0.expect_err("refused");
        for part in parts {
            assert!(message.contains(part), "{message} lacks {part}");
        }
    }

    #[test]
    fn values_out_of_range_are_errors_that_name_the_range() {
        refused(&[("model", "perspective"), ("fov", "180")], &["\"fov\" is 180", "less than 180"]);
        refused(
            &[("model", "perspective"), ("frame_aspect_ratio", "0")],
            &["frame_aspect_ratio", "positive"],
        );
        refused(&[("model", "perspective"), ("screen_window", "1,1,-1,1")], &["screen_window", "1 1 -1 1"]);
        refused(
            &[("model", "orthographic"), ("lens_radius", "-1")],
            &["lens_radius", "0 (a pinhole) or more"],
        );
        refused(&[("model", "orthographic"), ("hither", "5"), ("yon", "5")], &["yon", "hither"]);
        refused(
            &[("model", "perspective"), ("lens_radius", "1"), ("focal_distance", "2"), ("hither", "3")],
            &["focal_distance", "more than \"hither\""],
        );
        refused(&[("model", "orthographic"), ("lens_plane", "middle")], &["\"eye\" or \"hither\""]);
        refused(&[("model", "camera obscura")], &["\"orthographic\"", "camera obscura"]);
    }

    #[test]
    fn clip_distances_are_kept_in_the_stock_cameras_range() {
        let (camera, warnings) = build(&[("model", "environment"), ("hither", "0"), ("yon", "1e35")]);
        assert_eq!(camera.expect("built").clip(), [1e-4, 1e30]);
        assert!(warnings.len() == 1 && warnings[0].contains("0.0001"), "{warnings:?}");
        let (camera, warnings) = build(&[("model", "perspective")]);
        assert_eq!(camera.expect("built").clip(), [1e-3, 1e30]);
        assert_eq!(warnings, [""; 0]);
    }

    #[test]
    fn parameters_that_a_model_does_not_use_are_reported() {
        for (model, settings, names) in [
            (
                "perspective",
                [("film_diagonal", "35"), ("wavelength", "500")],
                "\"film_diagonal\", \"wavelength\"",
            ),
            ("orthographic", [("fov", "60"), ("lens_radius", "0")], "\"fov\""),
            ("environment", [("lens_radius", "0"), ("disk", "polar")], "\"lens_radius\", \"disk\""),
            ("thick", [("refraction", "whitted"), ("film_diagonal", "35")], "\"refraction\""),
            ("lens", [("lens_radius", "1"), ("film_diagonal", "35")], "\"lens_radius\""),
        ] {
            let (camera, mut warnings) = build(&[("model", model), settings[0], settings[1]]);
            camera.expect("built all the same");
            warnings.sort();
            let found: Vec<&str> = warnings
                .iter()
                .filter_map(|text| text.strip_prefix(&format!("model \"{model}\" does not use ")))
                .collect();
            let sorted = |text: &str| {
                let mut names: Vec<String> = text.split(", ").map(str::to_owned).collect();
                names.sort();
                names
            };
            assert_eq!(found.len(), 1, "{model}: {warnings:?}");
            assert_eq!(sorted(found[0]), sorted(names), "{model}");
        }
    }

    #[test]
    fn a_shutters_number_without_that_shutter_is_reported() {
        let (camera, warnings) = build(&[("model", "environment"), ("shutter_slit", "0.5")]);
        camera.expect("built all the same");
        assert_eq!(warnings, ["\"shutter_slit\" is used with \"shutter\" \"focal-plane\" only"]);
    }
}
