//! The measurement equation: the reading of a pixel's sensor.
//!
//! ```text
//! R = ∫∫∫∫ L(T(x, ω, λ); λ) S(x, t) P(x, λ) cos θ dx dω dt dλ
//! ```
//!
//! over the pixel's area, the directions from its points through the lens, the shutter's time and the
//! wavelengths (Kolb, Mitchell and Hanrahan 1995, eq. 1). Its parts and their places in the code:
//!
//! | part | meaning | here |
//! |---|---|---|
//! | L(r; λ) | spectral radiance of the scene along a ray, W/(m² sr nm) | the caller's function |
//! | T(x, ω, λ) | the lens: film-side ray to scene-side ray | [`Camera::generate`], one camera per wavelength |
//! | S(x, t) | the shutter, 0 to 1 | [`Shutter`](realistic_camera::Shutter), in the weight |
//! | P(x, λ) | the sensor's response to energy | [`SensorResponse`] |
//! | cos θ dω | projected solid angle: cos⁴θ'/Z² dA'' over the pupil | the `radiometric` weight A cos⁴θ'/Z² |
//! | dx | the pixel's area, m² | the film's pixel |
//! | dt | the shutter's interval, s | `shutter_open` to `shutter_close` |
//!
//! [`irradiance`](realistic_optics::imaging::irradiance) computes the inner integral over ω, for
//! unit radiance, by brute force. With L in W/(m² sr nm) and world time in seconds, the film's spectral irradiance is in
//! W/(m² nm), and R with a response of 1 is the energy on the pixel in joules.

use thiserror::Error;

use realistic_camera::{
    Camera, CameraError, Host, Level, Log, Outcome, Parameters, Sample, Weighting, WorldRay,
};

use realistic_lab::subject::quasirandom::spread;

/// P(x, λ): the sensor's reading per joule of light at a film point and wavelength.
pub trait SensorResponse {
    /// Returns the response at `point` (mm on film, lens space) to `wavelength` (nm).
    fn response(&self, point: [f64; 2], wavelength: f64) -> f64;
}

/// A sensor with a response of 1 at every point and wavelength, so that R is in joules.
#[derive(Clone, Copy, Debug, Default)]
pub struct Energy;

impl SensorResponse for Energy {
    fn response(&self, _: [f64; 2], _: f64) -> f64 {
        1.0
    }
}

/// A response that is uniform over the film, given by a table over wavelength: linear between the rows and 0 outside
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseTable {
    rows: Vec<(f64, f64)>,
}

/// An error in setting up a measurement.
#[derive(Debug, Error)]
pub enum MeasurementError {
    /// A camera cannot be built.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The wavelengths of a table do not increase.
    #[error("a response table needs two or more rows of finite numbers, their wavelengths (nm) growing")]
    Table,
    /// There are no bands.
    #[error("a measurement needs one band of wavelengths or more, from {from} to {to} nm")]
    Bands {
        /// Shortest wavelength, nm.
        from: f64,
        /// Longest wavelength, nm.
        to: f64,
    },
    /// The weights are not irradiance.
    #[error(
        "absolute units need a camera with a film and an aperture, and its irradiance as weight: give \"model\" \
         \"lens\", \"thick\" or \"thin\", and \"weighting\" \"radiometric\""
    )]
    NotRadiometric,
}

impl ResponseTable {
    /// Builds a table of (wavelength in nm, response).
    ///
    /// # Errors
    /// [`MeasurementError::Table`].
    pub fn new(rows: impl Into<Vec<(f64, f64)>>) -> Result<Self, MeasurementError> {
        let rows = rows.into();
        let finite = rows.iter().all(|(wavelength, response)| wavelength.is_finite() && response.is_finite());
        let growing = rows.windows(2).all(|pair| pair[0].0 < pair[1].0);
        if rows.len() < 2 || !finite || !growing {
            return Err(MeasurementError::Table);
        }
        Ok(Self { rows })
    }
}

impl SensorResponse for ResponseTable {
    fn response(&self, _: [f64; 2], wavelength: f64) -> f64 {
        let above = self.rows.partition_point(|row| row.0 < wavelength);
        match (above.checked_sub(1).map(|below| self.rows[below]), self.rows.get(above)) {
            (_, Some(&(at, response))) if at == wavelength => response,
            (Some((from, low)), Some(&(to, high))) => low + (high - low) * (wavelength - from) / (to - from),
            _ => 0.0,
        }
    }
}

/// A band of wavelengths and its camera.
#[derive(Debug)]
struct Band {
    wavelength: f64,
    /// Width, nm.
    width: f64,
    camera: Camera,
}

/// Cameras for a measurement, one for each band of wavelengths.
#[derive(Debug)]
pub struct Measurement {
    bands: Vec<Band>,
}

impl Measurement {
    /// Builds a camera of `parameters` for the middle of each of `bands` equal bands of wavelengths between `from` and
    /// `to` nm; a `wavelength` among the parameters is replaced. `log` receives the first camera's warnings.
    ///
    /// # Errors
    /// There are no bands, a camera cannot be built, or its weights are not irradiance.
    pub fn new(
        parameters: &Parameters,
        host: &Host,
        [from, to]: [f64; 2],
        bands: u32,
        log: Log<'_>,
    ) -> Result<Self, MeasurementError> {
        if bands == 0 || !(from < to) {
            return Err(MeasurementError::Bands { from, to });
        }
        let radiometric = parameters.weighting() == Ok(Weighting::Radiometric);
        let width = (to - from) / f64::from(bands);
        let band = |i: u32| {
            let wavelength = from + (f64::from(i) + 0.5) * width;
            let mut parameters = parameters.clone();
            parameters.wavelength = Some(wavelength);
            let mut silent = |_: Level, _: &str| {};
            let log: Log<'_> = if i == 0 { &mut *log } else { &mut silent };
            let camera = Camera::build(&parameters, host, log)?;
            if !radiometric || camera.facts().is_none() {
                return Err(MeasurementError::NotRadiometric);
            }
            Ok(Band { wavelength, width, camera })
        };
        Ok(Self { bands: (0..bands).map(band).collect::<Result<_, _>>()? })
    }

    /// Returns R of a pixel (column, row) from `samples` samples per band, in joules times the sensor's response.
    /// `radiance`, in W/(m² sr nm), is a function of a ray, with its time in seconds, and a wavelength in nm.
    pub fn response(
        &self,
        pixel: [u32; 2],
        samples: u32,
        sensor: &impl SensorResponse,
        radiance: impl Fn(&WorldRay, f64) -> f64,
    ) -> f64 {
        let exposure = |band: &Band| {
            let [open, close] = band.camera.shutter_interval();
            let area = band.camera.facts().map_or(0.0, |facts| (facts.film.pixel() * 1e-3).powi(2));
            // A shutter that closes before it opens is open for the same time.
            area * f64::from(close - open).abs()
        };
        self.bands
            .iter()
            .map(|band| exposure(band) * band.width * band.mean(pixel, samples, sensor, &radiance))
            .sum()
    }

    /// Returns the irradiance of a pixel (column, row), W/m², averaged over the shutter's interval and summed over all
    /// bands.
    pub fn irradiance(&self, pixel: [u32; 2], samples: u32, radiance: impl Fn(&WorldRay, f64) -> f64) -> f64 {
        self.bands.iter().map(|band| band.width * band.mean(pixel, samples, &Energy, &radiance)).sum()
    }
}

impl Band {
    /// Returns the mean over a pixel, the pupil and the shutter's interval, in W/(m² nm) times the response.
    fn mean(
        &self,
        [column, row]: [u32; 2],
        samples: u32,
        sensor: &impl SensorResponse,
        radiance: &impl Fn(&WorldRay, f64) -> f64,
    ) -> f64 {
        let (mut sum, mut count) = (0.0, 0_u32);
        for [x, y, u, v, time] in spread(0.0).take(samples as usize) {
            let image = [f64::from(column) + x, f64::from(row) + y];
            let sample = Sample {
                image_x: image[0] as f32,
                image_y: image[1] as f32,
                lens_u: u as f32,
                lens_v: v as f32,
                time: time as f32,
            };
            match self.camera.generate(&sample, None) {
                Outcome::Ray(ray, weight) => {
                    let point =
                        self.camera.facts().map_or([0.0; 2], |facts| facts.film.point(image[0], image[1]));
                    let response = sensor.response(point, self.wavelength);
                    sum += f64::from(weight) * response * radiance(&ray, self.wavelength);
                    count += 1;
                }
                Outcome::Blocked(_) | Outcome::Shut | Outcome::Wavelength => count += 1,
                Outcome::Redraw => {}
            }
        }
        if count == 0 { 0.0 } else { sum / f64::from(count) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_camera::Raster;
    use realistic_optics::prescription::glass::{C_LINE, F_LINE};

    fn measurement(settings: &[(&str, &str)], bands: u32) -> Result<Measurement, MeasurementError> {
        let mut parameters = Parameters::default();
        for (name, text) in settings {
            parameters.set_from_text(name, text).expect("valid");
        }
        let host = Host::new(Raster { xres: 30, yres: 20 }, None);
        Measurement::new(&parameters, &host, [400.0, 700.0], bands, &mut |_, _| {})
    }

    #[test]
    fn constant_radiance_gives_the_product_of_all_measures() {
        let camera = [("model", "thick"), ("fnumber", "8"), ("shutter_open", "1"), ("shutter_close", "1.25")];
        let measured = measurement(&camera, 1).expect("a camera");
        let band = &measured.bands[0];
        let pixel = 35.0 / 30.0_f64.hypot(20.0) * 1e-3;
        let irradiance = measured.irradiance([15, 10], 4096, |_, _| 2.0);
        let energy = measured.response([15, 10], 4096, &Energy, |_, _| 2.0);
        assert!((energy / (irradiance * pixel * pixel * 0.25) - 1.0).abs() < 1e-6);
        let backward =
            [("model", "thick"), ("fnumber", "8"), ("shutter_open", "1.25"), ("shutter_close", "1")];
        let backward = measurement(&backward, 1).expect("a camera");
        assert_eq!(backward.response([15, 10], 4096, &Energy, |_, _| 2.0), energy);
        // On the axis of a thick lens focused at infinity, a ray from the exit pupil's edge makes an angle with the
        // axis whose sine is 1/(2 N).
        let disk = std::f64::consts::PI / 256.0;
        assert!((irradiance / (2.0 * 300.0 * disk) - 1.0).abs() < 2e-3, "{irradiance}");
        assert_eq!((band.wavelength, band.width), (550.0, 300.0));
    }

    #[test]
    fn the_shutter_takes_its_share_of_the_exposure() {
        let base = [("model", "thick"), ("fnumber", "8")];
        let of = |more: &[(&str, &str)]| {
            let camera = measurement(&[base.as_slice(), more].concat(), 1).expect("a camera");
            camera.response([3, 17], 20_000, &Energy, |_, _| 1.0)
        };
        let global = of(&[]);
        for (settings, share) in [
            ([("shutter", "leaf"), ("shutter_ramp", "0.4")], 0.6),
            ([("shutter", "focal-plane"), ("shutter_slit", "0.125")], 0.125),
        ] {
            let part = of(&settings) / global;
            assert!((part / share - 1.0).abs() < 5e-3, "{settings:?}: {part}");
        }
    }

    #[test]
    fn a_moving_slit_sees_each_row_at_its_own_time() {
        let slit = [("model", "thick"), ("shutter", "focal-plane"), ("shutter_slit", "0.1")];
        let camera = measurement(&slit, 1).expect("a camera");
        let mean_time = |row| {
            let light = |ray: &WorldRay, _: f64| f64::from(ray.time);
            camera.irradiance([15, row], 20_000, light) / camera.irradiance([15, row], 20_000, |_, _| 1.0)
        };
        for (row, expected) in [(0, 0.05 + 0.9 * 0.025), (10, 0.05 + 0.9 * 0.525), (19, 0.95 - 0.9 * 0.025)] {
            assert!((mean_time(row) - expected).abs() < 2e-3, "row {row}: {}", mean_time(row));
        }
    }

    #[test]
    fn the_sensors_response_weighs_wavelengths_and_film_points() {
        struct Right;
        impl SensorResponse for Right {
            fn response(&self, [x, _]: [f64; 2], _: f64) -> f64 {
                // +x on the film is the left of the picture.
                f64::from(u8::from(x < 0.0))
            }
        }
        let camera = measurement(&[("model", "thin")], 3).expect("cameras");
        let energy = camera.response([20, 10], 256, &Energy, |_, _| 1.0);
        assert!((camera.response([20, 10], 256, &Right, |_, _| 1.0) / energy - 1.0).abs() < 1e-12);
        assert_eq!(camera.response([5, 10], 256, &Right, |_, _| 1.0), 0.0);
        let red = ResponseTable::new([(600.0, 0.0), (650.0, 1.0), (700.0, 1.0)]).expect("a table");
        assert!((camera.response([20, 10], 256, &red, |_, _| 1.0) / energy - 1.0 / 3.0).abs() < 1e-2);
        let line = |_: &WorldRay, wavelength: f64| if wavelength < 500.0 { 1.0 } else { 0.0 };
        assert_eq!(camera.response([20, 10], 256, &red, line), 0.0);
    }

    #[test]
    fn a_table_is_linear_between_its_rows_and_0_outside() {
        let table = ResponseTable::new([(F_LINE, 1.0), (C_LINE, 3.0)]).expect("a table");
        let at = |wavelength| table.response([0.0; 2], wavelength);
        assert_eq!([at(F_LINE), at(C_LINE)], [1.0, 3.0]);
        assert!((at(f64::midpoint(F_LINE, C_LINE)) - 2.0).abs() < 1e-12);
        assert_eq!([at(F_LINE - 0.01), at(C_LINE + 0.01)], [0.0, 0.0]);
        assert!(ResponseTable::new([(500.0, 1.0)]).is_err());
        assert!(ResponseTable::new([(500.0, 1.0), (500.0, 2.0)]).is_err());
    }

    #[test]
    fn cameras_without_absolute_units_are_refused() {
        for settings in [("model", "environment"), ("weighting", "none"), ("simple_weighting", "true")] {
            let message = measurement(&[settings], 1).expect_err("refused").to_string();
            assert!(message.contains("\"radiometric\""), "{message}");
        }
        assert!(measurement(&[], 0).is_err());
    }
}
