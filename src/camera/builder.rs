//! The way that Rust callers describe a camera: typed settings, one method each, and what a host brings.

use super::{
    any_camera::Camera,
    film::Raster,
    host::Host,
    model::Model,
    parameters::{CameraError, FocusBy, LensPlane, Parameters, Pupil, Weighting, Zoom},
    placement::{motion::CameraMotion, shutter::Shutter},
};
use crate::{
    lens::refraction::Refraction, message::Log, plan::Precision, prescription::SearchPath,
    sampling::DiskMapping,
};

/// A camera to be built: [`Camera::builder`](super::Camera::builder). What is not called keeps the default of [`PARAMETERS`](super::PARAMETERS);
/// only [`resolution`](Self::resolution) has none.
///
/// ```
/// use realistic::camera::{Camera, Pupil, Weighting};
///
/// let camera = Camera::builder()
///     .lens("telephoto.250mm")
///     .focus_distance(10_000.0)
///     .pupil(Pupil::Warped)
///     .weighting(Weighting::Relative)
///     .resolution(300, 200)
///     .build()?;
/// assert_eq!(camera.facts().expect("a lens").focus_distance, Some(10_000.0));
/// # Ok::<(), realistic::camera::CameraError>(())
/// ```
#[derive(Clone, Debug)]
pub struct CameraBuilder {
    parameters: Parameters,
    host: Host,
}

macro_rules! settings {
    ($($(#[$doc:meta])* $method:ident($argument:ident: $type:ty) => $($field:ident).+ = $value:expr;)*) => {$(
        $(#[$doc])*
        #[must_use]
        pub fn $method(mut self, $argument: $type) -> Self {
            self.$($field).+ = $value;
            self
        }
    )*};
}

impl Camera {
    /// A camera to be described by methods and then built.
    pub fn builder() -> CameraBuilder {
        let host = Host::new(Raster { xres: 0, yres: 0 }, None);
        CameraBuilder { parameters: Parameters::default(), host }
    }
}

impl CameraBuilder {
    settings! {
        /// What the camera is a model of.
        model(model: Model) => parameters.model = Some(model);
        /// A lens file or a catalogue name, such as `wide.22mm` or, scaled, `wide.22mm@35mm`.
        lens(name: &str) => parameters.specfile = Some(name.to_owned());
        /// A glass catalogue (AGF) in which glasses that a lens file names are looked up first.
        glass_catalogue(file: &str) => parameters.glasscatalog = Some(file.to_owned());
        /// From the last vertex to the film, mm, instead of [`focus_distance`](Self::focus_distance).
        film_distance(mm: f64) => parameters.filmdistance = Some(mm);
        /// From the film plane to the plane in focus, world units; infinity counts.
        focus_distance(units: f64) => parameters.focusdistance = Some(units);
        /// What moves to focus at [`focus_distance`](Self::focus_distance).
        focus_by(what: FocusBy) => parameters.focusby = Some(what);
        /// How far a zoom lens is zoomed: a focal length in mm, or the name of one of its positions.
        zoom(zoom: impl Into<Zoom>) => parameters.zoom = Some(zoom.into());
        /// Clear diameter of the stop, mm.
        aperture_diameter(mm: f64) => parameters.aperture_diameter = Some(mm);
        /// Focal length over entrance pupil diameter, instead of [`aperture_diameter`](Self::aperture_diameter).
        fnumber(fnumber: f64) => parameters.fnumber = Some(fnumber);
        /// Diagonal of the film, mm.
        film_diagonal(mm: f64) => parameters.filmdiag = Some(mm);
        /// Where a ray begins, world units along it.
        hither(units: f64) => parameters.hither = Some(units);
        /// Where a ray ends, world units along it.
        yon(units: f64) => parameters.yon = Some(units);
        /// Time at which the shutter opens.
        shutter_open(time: f64) => parameters.shutteropen = Some(time);
        /// Time at which the shutter closes.
        shutter_close(time: f64) => parameters.shutterclose = Some(time);
        /// How a ray's weight is measured.
        weighting(weighting: Weighting) => parameters.weighting = Some(weighting);
        /// Where lens samples lie.
        pupil(pupil: Pupil) => parameters.pupil = Some(pupil);
        /// How lens samples map to the disk.
        disk_mapping(mapping: DiskMapping) => parameters.disk = Some(mapping);
        /// Method of refraction.
        refraction(refraction: Refraction) => parameters.refraction = Some(refraction);
        /// Wavelength, nm.
        wavelength(nm: f64) => parameters.wavelength = Some(nm);
        /// Length of a world unit, mm.
        mm_per_unit(mm: f64) => parameters.mmperunit = Some(mm);
        /// What rays are traced in; by default double, or what the tolerance allows.
        precision(precision: Precision) => parameters.precision = Some(Some(precision));
        /// Pixels by which 99.9 % of the rays may be off.
        tolerance(pixels: f64) => parameters.tolerance = Some(pixels);
        /// Degrees across the shorter side of the image, of [`Model::Perspective`].
        field_of_view(degrees: f64) => parameters.fov = Some(degrees);
        /// x from, x to, y from, y to: the part of the screen that becomes the image, of the projections.
        screen_window(window: [f64; 4]) => parameters.screenwindow = Some(window);
        /// Width over height of the screen window, of the projections.
        frame_aspect_ratio(ratio: f64) => parameters.frameaspectratio = Some(ratio);
        /// Radius of the projections' thin lens, world units.
        lens_radius(units: f64) => parameters.lensradius = Some(units);
        /// From the eye to the projections' plane of focus, world units.
        focal_distance(units: f64) => parameters.focaldistance = Some(units);
        /// Where the projections' thin lens lies.
        lens_plane(plane: LensPlane) => parameters.lensplane = Some(plane);
        /// x from, y from, x to, y to in pixels: the part of the picture that is to be rendered, as
        /// [`Camera::crop`] tells it. It changes no ray.
        crop(pixels: [u32; 4]) => parameters.crop = Some(pixels.map(f64::from));
        /// Camera space to world space: a [`CameraToWorld`](super::CameraToWorld) or a motion.
        to_world(to_world: impl Into<CameraMotion>) => host.to_world = to_world.into();
        /// Where lens files are looked for after the working directory; by default along `PBRT_SEARCHPATH`.
        search_path(search: SearchPath) => host.search = search;
        /// Whether the caller draws another lens sample where a camera with [`DiskMapping::Rejection`] asks for it;
        /// by default it does.
        can_redraw(can: bool) => host.can_redraw = can;
    }

    /// The text of a lens file instead of [`lens`](Self::lens), and the name that it goes by in messages.
    #[must_use]
    pub fn lens_text(mut self, name: &str, text: &[u8]) -> Self {
        self.host.lens_text = Some((name.to_owned(), text.to_vec()));
        self
    }

    /// What the shutter lets through, by film point and time.
    #[must_use]
    pub fn shutter(mut self, shutter: Shutter) -> Self {
        (self.parameters.shutterramp, self.parameters.shutterslit) = match shutter {
            Shutter::Global => (None, None),
            Shutter::Leaf { ramp } => (Some(ramp.into()), None),
            Shutter::FocalPlane { slit } => (None, Some(slit.into())),
        };
        self.parameters.shutter = Some(shutter);
        self
    }

    /// Pixels of the image across and down, each 1 or more.
    #[must_use]
    pub fn resolution(mut self, xres: u32, yres: u32) -> Self {
        self.host.raster = Raster { xres, yres };
        self
    }

    /// The camera; warnings are dropped.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(&self) -> Result<Camera, CameraError> {
        self.build_with_log(&mut |_, _| ())
    }

    /// The camera; `log` receives warnings.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build_with_log(&self, log: Log<'_>) -> Result<Camera, CameraError> {
        Camera::build(&self.parameters, &self.host, log)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Outcome, Sample};

    const SAMPLE: Sample = Sample { image_x: 30.0, image_y: 5.0, lens_u: 0.4, lens_v: 0.8, time: 0.4 };

    #[test]
    fn the_builder_and_parameters_by_name_make_one_camera() {
        for (built, named) in [
            (
                Camera::builder()
                    .lens("wide.22mm")
                    .disk_mapping(DiskMapping::Polar)
                    .fnumber(8.0)
                    .weighting(Weighting::Relative),
                &[("specfile", "wide.22mm"), ("disk", "polar"), ("fnumber", "8"), ("weighting", "relative")]
                    [..],
            ),
            (
                Camera::builder()
                    .model(Model::Thick)
                    .mm_per_unit(1000.0)
                    .focus_distance(1.5)
                    .film_diagonal(24.0),
                &[("model", "thick"), ("mmperunit", "1000"), ("focusdistance", "1.5"), ("filmdiag", "24")],
            ),
            (
                Camera::builder()
                    .model(Model::Perspective)
                    .shutter(Shutter::Leaf { ramp: 0.5 })
                    .shutter_close(3.0),
                &[
                    ("model", "perspective"),
                    ("shutter", "leaf"),
                    ("shutterramp", "0.5"),
                    ("shutterclose", "3"),
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
            let [named, built] = [named, built].map(|camera| camera.generate(&SAMPLE));
            assert!(matches!(built, Outcome::Ray(..)), "{built:?}");
            assert_eq!(named, built);
        }
    }

    #[test]
    fn what_is_wrong_is_told_as_for_parameters_by_name() {
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
