//! Film irradiance in absolute units, against f-number and image height.
//!
//! ```text
//! cargo run --release --example radiometry [LENS]
//! ```
//!
//! The scene is a white wall: uniform radiance, 100 W/(m² sr) spread evenly over 400 to 700 nm, from all directions. On
//! the axis the irradiance is then π L sin²u', u' being half the angle of the cone of light, and a lens that obeys the
//! sine condition has sin u' = 1/(2N) when focused at infinity: E = π L/(4 N²). Off the axis, the irradiance falls with
//! the fourth power of the cosine and by vignetting. A grid of rays through the lens gives the vignetting, independent
//! of the camera's own sampling.

mod measurement;

use std::f64::consts::PI;

use measurement::{Energy, Measurement, MeasurementError, ResponseTable};
use realistic_camera::{Camera, CameraError, Film, Host, Parameters, Raster, Value, WorldRay};
use realistic_optics::imaging::irradiance::survey;
use realistic_optics::lens::pupil::SlopeDisk;
use realistic_optics::trace::Path;

/// Radiance of the wall, W/(m² sr).
pub const RADIANCE: f64 = 100.0;
/// Wavelengths of the wall's light, nm.
pub const BAND: [f64; 2] = [400.0, 700.0];
/// Exposure time, s.
pub const EXPOSURE: f64 = 0.01;

const RASTER: Raster = Raster { xres: 301, yres: 201 };
/// Film diagonal, mm.
const FILM_DIAGONAL: f64 = 35.0;
const CENTER: [u32; 2] = [150, 100];
/// Samples per pixel and band.
const SAMPLES: u32 = 1 << 14;
/// Rays along a side of the square grid that measures vignetting.
const GRID: u32 = 400;

/// A measurement at one f-number.
#[derive(Debug)]
pub struct Stop {
    /// The f-number requested.
    pub fnumber: f64,
    /// Irradiance in the centre of the picture, W/m².
    pub irradiance: f64,
    /// Energy on the central pixel, J.
    pub energy: f64,
    /// Luminous exposure of the central pixel, lx s.
    pub luminous: f64,
}

impl Stop {
    /// Returns the irradiance divided by π L/(4 N²): 1 for a lens that obeys the sine condition.
    pub fn against_rule(&self) -> f64 {
        self.irradiance * 4.0 * self.fnumber.powi(2) / (PI * RADIANCE)
    }
}

/// A measurement at one point of the picture.
#[derive(Debug)]
pub struct FieldPoint {
    /// Distance of the pixel's centre from the axis, mm on film.
    pub height: f64,
    /// Measured irradiance relative to that on the axis.
    pub measured: f64,
    /// Relative irradiance from a grid of rays: the integral of the fourth power of the cosine over the vignetted
    /// pupil.
    pub computed: f64,
}

fn parameters(lens: &str, fnumber: f64) -> Result<Parameters, CameraError> {
    let mut parameters = Parameters::default();
    parameters.set("lens_file", Value::Text(lens))?;
    for (name, number) in [
        ("fnumber", fnumber),
        ("film_diagonal", FILM_DIAGONAL),
        ("shutter_open", 0.0),
        ("shutter_close", EXPOSURE),
    ] {
        parameters.set(name, Value::Float(number))?;
    }
    Ok(parameters)
}

fn host() -> Host {
    Host::new(RASTER, None)
}

fn measurement(lens: &str, fnumber: f64) -> Result<Measurement, MeasurementError> {
    Measurement::new(&parameters(lens, fnumber)?, &host(), BAND, 6, &mut |_, text| eprintln!("{text}"))
}

fn wall(_: &WorldRay, _: f64) -> f64 {
    RADIANCE / (BAND[1] - BAND[0])
}

/// The photopic response of the eye, lm/W: 683 times the CIE 1924 V(λ) at every 50 nm.
fn photopic() -> Result<ResponseTable, MeasurementError> {
    let v = [(400.0, 0.0004), (450.0, 0.038), (500.0, 0.323), (550.0, 0.995), (600.0, 0.631)];
    let v = v.into_iter().chain([(650.0, 0.107), (700.0, 0.0041)]);
    ResponseTable::new(v.map(|(wavelength, v)| (wavelength, 683.0 * v)).collect::<Vec<_>>())
}

/// Area of a pixel, m².
fn pixel_area() -> f64 {
    (Film::new(RASTER, FILM_DIAGONAL).pixel() * 1e-3).powi(2)
}

/// Measures the centre of the picture at several f-numbers.
///
/// # Errors
/// The lens is unknown.
pub fn against_fnumber(lens: &str, fnumbers: &[f64]) -> Result<Vec<Stop>, MeasurementError> {
    let stop = |&fnumber: &f64| {
        let measurement = measurement(lens, fnumber)?;
        let luminous = measurement.response(CENTER, SAMPLES, &photopic()?, wall) / pixel_area();
        Ok(Stop {
            fnumber,
            irradiance: measurement.irradiance(CENTER, SAMPLES, wall),
            energy: measurement.response(CENTER, SAMPLES, &Energy, wall),
            luminous,
        })
    };
    fnumbers.iter().map(stop).collect()
}

/// Measures points from the centre of the picture to its right edge at one f-number.
///
/// # Errors
/// The lens is unknown.
pub fn against_field(lens: &str, fnumber: f64, count: u32) -> Result<Vec<FieldPoint>, MeasurementError> {
    let measurement = measurement(lens, fnumber)?;
    let camera = Camera::build(&parameters(lens, fnumber)?, &host(), &mut |_, _| {})?;
    let vignetting = vignetting(&camera);
    let on_axis = measurement.irradiance(CENTER, SAMPLES, wall);
    let field_point = |i: u32| {
        let column = CENTER[0] + i * CENTER[0] / count;
        let center = f64::from(column) + 0.5;
        let [x, y] = camera.facts().expect("a lens").film.point(center, f64::from(CENTER[1]) + 0.5);
        let height = x.hypot(y);
        let measured = measurement.irradiance([column, CENTER[1]], SAMPLES, wall) / on_axis;
        FieldPoint { height, measured, computed: vignetting(height) / vignetting(0.0) }
    };
    Ok((0..=count).map(field_point).collect())
}

/// Returns the irradiance for unit radiance as a function of film height, mm, computed from a grid of directions that
/// contains every ray through the rear element.
fn vignetting(camera: &Camera) -> impl Fn(f64) -> f64 {
    let lens = camera.facts().expect("a lens").lens.clone();
    let path: Path = Path::film_to_scene(&lens);
    let distance = camera.facts().expect("a lens").film_distance;
    let film = lens.rear().vertex - distance;
    move |height| {
        let semi_diameter = lens.rear().semi_diameter;
        // Aimed at the rear vertex, and wide enough for a clear aperture whose edge lies up to a tenth
        // nearer.
        let cover = SlopeDisk {
            center: [0.0, -height / distance],
            radius: (semi_diameter + 0.1 * height) / (0.9 * distance),
        };
        survey(&path, film, [0.0, height], cover, cover, GRID).irradiance
    }
}

fn main() -> Result<(), MeasurementError> {
    let lens = std::env::args().nth(1).unwrap_or_else(|| "dgauss.100mm@50mm".to_owned());
    println!("{lens} before a wall of {RADIANCE} W/(m² sr), {EXPOSURE} s\n");
    println!("  f/N    irradiance W/m²   energy J on a pixel   lx s      over π L/(4 N²)");
    for stop in against_fnumber(&lens, &[2.8, 4.0, 5.6, 8.0, 11.0, 16.0])? {
        let Stop { fnumber, irradiance, energy, luminous } = stop;
        println!(
            "  {fnumber:<5}  {irradiance:15.5}   {energy:19.4e}   {luminous:7.2}   {:15.4}",
            stop.against_rule()
        );
    }
    println!("\n  film height mm   measured, over the axis   from a grid of rays");
    for FieldPoint { height, measured, computed } in against_field(&lens, 2.8, 6)? {
        println!("  {height:14.2}   {measured:23.4}   {computed:19.4}");
    }
    Ok(())
}
