//! The builder of cameras for Rust callers, with a typed method for each setting and methods for the host's
//! data.

use super::{
    any_camera::Camera,
    film::Raster,
    host::Host,
    model::Model,
    parameters::{
        CameraError, FocusBy, LensPlane, Parameters, Pupil, RequestedPrecision, Transmission, Weighting, Zoom,
    },
    placement::{motion::CameraMotion, shutter::Shutter},
};
use crate::sampling::DiskMapping;
use realistic_base::message::Log;
use realistic_optics::{lens::refraction::Refraction, prescription::SearchPath};

/// A builder of cameras; create it with [`Camera::builder`](super::Camera::builder). A setting that is not
/// given keeps the default of [`PARAMETERS`](super::PARAMETERS); only [`resolution`](Self::resolution) has no
/// default.
///
/// ```
/// # extern crate realistic_camera as realistic;
/// use realistic::{Camera, Pupil, Weighting};
///
/// let camera = Camera::builder()
///     .lens_file("telephoto.250mm")
///     .focus_distance(10_000.0)
///     .pupil(Pupil::Warped)
///     .weighting(Weighting::Relative)
///     .resolution(300, 200)
///     .build()?;
/// assert_eq!(camera.facts().expect("a lens").focus_distance_mm, Some(10_000.0));
/// # Ok::<(), realistic::CameraError>(())
/// ```
#[derive(Clone, Debug)]
pub struct CameraBuilder {
    parameters: Parameters,
    host: Host,
}

/// Generates a method for each parameter.
macro_rules! setters {
    ({} $($field:ident $(or $($alias:literal)+)?: $type:tt $(in $range:ident)?, $unit:tt, $how:tt $default:tt, $models:ident, $help:literal;)*) => {
        impl CameraBuilder {
            $(
                #[doc = concat!("The parameter `", stringify!($field), "`: ", $help, setters!(@unit $unit), setters!(@default $default), ".")]
                #[must_use]
                pub fn $field(mut self, value: impl Into<$type>) -> Self {
                    self.parameters.$field = Some(value.into());
                    self
                }
            )*
        }
    };
    (@unit "") => { "" };
    (@unit $unit:tt) => { concat!("; unit: ", $unit) };
    (@default "") => { "" };
    (@default $default:tt) => { concat!("; default: ", $default) };
}

crate::for_each_parameter! { setters {} }

impl Camera {
    /// Returns a builder with default settings.
    pub fn builder() -> CameraBuilder {
        let host = Host::new(Raster { xres: 0, yres: 0 }, None);
        CameraBuilder { parameters: Parameters::default(), host }
    }
}

impl CameraBuilder {
    /// Sets the transform from camera space to world space: a [`CameraToWorld`](super::CameraToWorld) or a motion.
    #[must_use]
    pub fn to_world(mut self, to_world: impl Into<CameraMotion>) -> Self {
        self.host.to_world = to_world.into();
        self
    }

    /// Sets the directories that are searched for lens files after the working directory. The default is the
    /// directories of `PBRT_SEARCHPATH` and the collections of `REALISTIC_LENSES`.
    #[must_use]
    pub fn search_path(mut self, search: SearchPath) -> Self {
        self.host.search = search;
        self
    }

    /// Sets whether the caller draws a new lens sample when a camera with [`DiskMapping::Rejection`] requests
    /// one. The default is `true`.
    #[must_use]
    pub fn can_redraw(mut self, can: bool) -> Self {
        self.host.can_redraw = can;
        self
    }

    /// Sets the text of a lens, which replaces the file of [`lens_file`](Self::lens_file), and the name that
    /// messages use for it.
    #[must_use]
    pub fn lens_text(mut self, name: &str, text: &[u8]) -> Self {
        self.host.lens_text = Some((name.to_owned(), text.to_vec()));
        self
    }

    /// Sets the width and height of the image in pixels, each 1 or more.
    #[must_use]
    pub fn resolution(mut self, xres: u32, yres: u32) -> Self {
        self.host.raster = Raster { xres, yres };
        self
    }

    /// Builds the camera; warnings are dropped.
    ///
    /// # Errors
    /// The error states the cause and what to give instead.
    pub fn build(&self) -> Result<Camera, CameraError> {
        self.build_with_log(&mut |_, _| ())
    }

    /// Builds the camera; `log` receives warnings.
    ///
    /// # Errors
    /// The error states the cause and what to give instead.
    pub fn build_with_log(&self, log: Log<'_>) -> Result<Camera, CameraError> {
        Camera::build(&self.parameters, &self.host, log)
    }

    /// Builds the same camera as [`build`](Self::build), identical to the last bit, in less time. It reuses
    /// every part of an existing camera, such as that of the previous frame, that depends only on settings
    /// that have not changed. The lens file is not read again.
    ///
    /// ```
    /// # extern crate realistic_camera as realistic;
    /// use realistic::Camera;
    ///
    /// let settings = Camera::builder().lens_file("zoom.24-70mm").resolution(300, 200);
    /// let mut camera = settings.clone().focus_distance(1000.0).build()?;
    /// for frame in 1..4 {
    ///     camera = settings.clone().focus_distance(1000.0 + 20.0 * f64::from(frame)).refocused(&camera)?;
    /// }
    /// assert_eq!(camera.facts().expect("a lens").focus_distance_mm, Some(1060.0));
    /// # Ok::<(), realistic::CameraError>(())
    /// ```
    ///
    /// # Errors
    /// The error states the cause and what to give instead.
    pub fn refocused(&self, donor: &Camera) -> Result<Camera, CameraError> {
        Camera::build_from(Some(donor), &self.parameters, &self.host, &mut |_, _| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Outcome, Sample};

    const SAMPLE: Sample = Sample { image_x: 30.0, image_y: 5.0, lens_u: 0.4, lens_v: 0.8, time: 0.4 };

    #[test]
    fn the_builder_and_parameters_by_name_make_one_camera() {
        for (built, named) in [
            (
                Camera::builder()
                    .lens_file("wide.22mm")
                    .disk(DiskMapping::Polar)
                    .fnumber(8.0)
                    .weighting(Weighting::Relative),
                &[("lens_file", "wide.22mm"), ("disk", "polar"), ("fnumber", "8"), ("weighting", "relative")]
                    [..],
            ),
            (
                Camera::builder()
                    .model(Model::Thick)
                    .mm_per_unit(1000.0)
                    .focus_distance(1.5)
                    .film_diagonal(24.0),
                &[
                    ("model", "thick"),
                    ("mm_per_unit", "1000"),
                    ("focus_distance", "1.5"),
                    ("film_diagonal", "24"),
                ],
            ),
            (
                Camera::builder()
                    .model(Model::Perspective)
                    .shutter(Shutter::Leaf { ramp: 0.25 })
                    .shutter_ramp(0.5)
                    .shutter_close(3.0),
                &[
                    ("model", "perspective"),
                    ("shutter", "leaf"),
                    ("shutter_ramp", "0.5"),
                    ("shutter_close", "3"),
                ],
            ),
        ] {
            let mut parameters = Parameters::default();
            for (name, text) in named {
                parameters.set_from_text(name, text).expect("in range");
            }
            let host = Host::new(Raster { xres: 40, yres: 30 }, None);
            let named = Camera::build(&parameters, &host, &mut |_, text| panic!("{text}")).expect("built");
            let built = built.resolution(40, 30).build().expect("built");
            let [named, built] = [named, built].map(|camera| camera.generate(&SAMPLE, None));
            assert!(matches!(built, Outcome::Ray(..)), "{built:?}");
            assert_eq!(named, built);
        }
    }

    #[test]
    fn errors_are_those_of_parameters_by_name() {
        let refused = |builder: CameraBuilder| builder.build().expect_err("refused").to_string();
        assert!(refused(Camera::builder()).contains("0 x 0 pixels"));
        let small = Camera::builder().resolution(4, 3);
        let both = refused(small.clone().fnumber(8.0).aperture_diameter(3.0));
        assert!(both.contains("give one of them"), "{both}");
        assert!(
            refused(small.clone().film_diagonal(f64::NAN)).contains("is NaN; it must be positive, in mm")
        );
        assert!(refused(small.shutter(Shutter::Leaf { ramp: 0.7 })).contains("at most 0.5"));
    }
}
