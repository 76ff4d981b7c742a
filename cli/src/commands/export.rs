//! `realistic export`: a lens in the formats of other programs.

use crate::arguments::{LensChoice, OpenedLens, STOP_SHAPE, TRANSMISSION, size};
use crate::console;
use crate::export::{
    ChiefField, Errors, FieldError, Film, Fitted, Focus, Illumination, LensData, LensExposure, Map, Model,
    PlaneField, Quantity, Report, Spot, ftheta_usda, opencv_yaml, opentrackio_json, rays, spots, st_maps,
    usda,
};
use crate::failure::Failure;
use crate::files;
use crate::image::check_memory;
use realistic_base::message::short;
use realistic_camera::{Exposure, Parameters, sampling::PupilDisk};
use realistic_light::{Surfaces, TStop};
use realistic_optics::{
    imaging::{axial_beam::AxialBeam, irradiance::on_axis},
    lens::{Lens, first_order::FirstOrder},
    trace::Path as LightPath,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The options of `export`.
#[derive(clap::Args, Debug)]
#[command(after_help = WORDS)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Format of the export
    #[arg(long = "as", value_name = "MODEL", value_enum)]
    format: ExportFormat,
    /// Size of the film, in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1280", value_parser = size)]
    size: [u32; 2],
    /// File to write [default: standard output; maps need a file, .exr or .npy]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the report as JSON, with the model's numbers
    #[arg(long)]
    json: bool,
}

const WORDS: &str = "Every export is of the lens as it is focused, stopped and zoomed here. The report beside it has the worst and \
                     the RMS error in pixels against exact chief rays, where the model's inverse is monotonic, how the image \
                     changes with focus, and how far the entrance pupil walks. st-map writes two files: NAME.undistort.exr and \
                     NAME.distort.exr. docs/export.md has formulas and conventions.";

/// The formats of exports.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum ExportFormat {
    /// `OpenCV`'s pinhole with k1, k2, p1, p2, k3, a file for cv2.FileStorage
    #[value(name = "opencv")]
    OpenCv,
    /// The same with k1 to k6, a rational function
    OpencvRational,
    /// Kannala and Brandt's polynomial, which is `OpenCV`'s fisheye, a file for cv2.FileStorage
    #[value(alias = "opencv-fisheye")]
    KannalaBrandt,
    /// NVIDIA's f-theta polynomial, as USD text
    #[value(name = "ftheta", alias = "f-theta")]
    FTheta,
    /// `OpenTrackIO`'s JSON: Brown-Conrady in both directions, pupil offset, falloff
    #[value(name = "opentrackio")]
    OpenTrackIo,
    /// `UsdGeomCamera` as USD text, without distortion; the lens's data as attributes
    Usd,
    /// ST maps for Nuke, from the lens's picture to a pinhole's and back: two files
    StMap,
    /// The chief ray of every pixel: origin in mm and direction
    Rays,
    /// Relative illumination: a map, and a polynomial in the report
    Illumination,
    /// The spots of points in focus, by rays, as CSV
    Spot,
}

impl ExportFormat {
    fn model(self) -> Option<Model> {
        match self {
            Self::OpenCv => Some(Model::OpenCv),
            Self::OpencvRational => Some(Model::OpenCvRational),
            Self::KannalaBrandt => Some(Model::KannalaBrandt),
            Self::FTheta => Some(Model::FTheta),
            Self::OpenTrackIo => Some(Model::OpenTrackIo),
            Self::Usd => Some(Model::Pinhole),
            Self::StMap | Self::Rays | Self::Illumination | Self::Spot => None,
        }
    }

    fn is_map(self) -> bool {
        matches!(self, Self::StMap | Self::Rays | Self::Illumination)
    }

    fn name(self) -> &'static str {
        match self {
            Self::StMap => "st-map",
            Self::Rays => "rays",
            Self::Illumination => "illumination",
            Self::Spot => "spot",
            _ => self.model().expect("the others are models").name(),
        }
    }
}

/// Returns the exposure, if one of its parameters is given.
///
/// # Errors
/// A number is out of range, or the middle of the film is dark.
fn exposure(given: &Parameters, lens: &Lens, film: Film) -> Result<Option<LensExposure>, Failure> {
    let Some(exposure) = Exposure::of(given)? else {
        return Ok(None);
    };
    let rear = PupilDisk::rear(lens, film.z, 0.0);
    let path = LightPath::<f64>::film_to_scene(lens).with_apertures(lens);
    let light = lens.radiance_factor() * rear.map_or(0.0, |rear| on_axis(&path, film.z, rear.slope_radius()));
    if !(light > 0.0) {
        return Err(FieldError::Dark(lens.name.clone()).into());
    }
    Ok(Some(LensExposure { exposure, fstop: (std::f64::consts::PI / (4.0 * light)).sqrt() }))
}

/// Number of points along the film's radius: [`RINGS`] for the export itself, [`COARSE`] for the lens at another
/// focus.
const RINGS: u32 = 2049;
const COARSE: u32 = 65;
/// Object distances at which breathing is measured, in focal lengths.
const DISTANCES: [f64; 4] = [f64::INFINITY, 100.0, 30.0, 10.0];

impl From<FieldError> for Failure {
    fn from(error: FieldError) -> Self {
        Self::Other(error.to_string())
    }
}

/// The groups of parameters that some format uses.
pub const GROUPS: &[&[&str]] = &[STOP_SHAPE, TRANSMISSION, &Exposure::PARAMETERS];

/// Writes the export and reports on it.
///
/// # Errors
/// There is no such lens, the model cannot fit the lens, or a file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let format = args.format;
    let out = out(args)?;
    let opened = match format {
        ExportFormat::OpenTrackIo => args.lens.open_with(&[TRANSMISSION])?,
        ExportFormat::Usd => args.lens.open_with(&[STOP_SHAPE, &Exposure::PARAMETERS])?,
        _ => args.lens.open()?,
    };
    if format.is_map() && out.is_some() {
        // Up to six floats per pixel exist in four copies: rows, the whole map, channels and the file.
        check_memory(args.size, 4 * 6 * 4)?;
    }
    let lens = &opened.lens;
    let film_distance = opened.film_distance()?;
    let diagonal = opened.film_diagonal();
    let film = |lens: &Lens, film_distance: f64| Film {
        size: args.size,
        diagonal,
        z: lens.rear().vertex - film_distance,
    };
    let here = film(lens, film_distance);
    if !lens.is_round() {
        return run_in_plane(args, lens, here, film_distance, out);
    }
    let field = ChiefField::new(lens, here, RINGS)?;
    let fitted = format.model().map(|model| model.fitted(&field));
    let errors = match (format, &fitted) {
        (_, Some(fitted)) => Some(Errors::of_model(fitted, &field)),
        (ExportFormat::StMap, _) => Some(Errors::of_map(Quantity::Tangent, &field)),
        (ExportFormat::Rays, _) => Some(Errors::of_map(Quantity::Angle, &field)),
        _ => None,
    };
    let numbers =
        fitted.iter().flat_map(|model| model.law.numbers()).chain(errors.iter().flat_map(Errors::numbers));
    let unrepresentable = || {
        Failure::Other(format!(
            "the rays of lens \"{}\" to a film of {} mm have no {} in double precision; give a --film-diagonal of the lens's size",
            lens.name,
            short(diagonal),
            format.name()
        ))
    };
    if !numbers.into_iter().all(f64::is_finite) {
        return Err(unrepresentable());
    }
    let save = |out: &Path, text: &str| match has_numbers_alone(text) {
        true => files::save(out, text.as_bytes()).map_err(|error| Failure::cannot_write(out, &error)),
        false => Err(unrepresentable()),
    };
    let save_map = |out: &Path, map: &Map| match map.values.iter().all(|value| value.is_finite()) {
        true => map.write(out),
        false => Err(unrepresentable()),
    };
    let first_order = FirstOrder::of(lens).map_err(|error| Failure::Other(error.to_string()))?;
    let beam = AxialBeam::of(lens);
    let coatings = opened.coatings()?;
    let stop = coatings
        .and_then(|own| TStop::of(lens, &Surfaces::of_each(lens, &own), &beam, first_order.focal_length));
    let data = LensData {
        name: &lens.name,
        focal_length: first_order.focal_length,
        fnumber: beam.fnumber(first_order.focal_length),
        tnumber: stop.map(|stop| stop.number),
        exposure: exposure(opened.parameters(), lens, here)?,
        wavelength: lens.wavelength,
        film_distance,
        mm_per_unit: opened.parameters().mm_per_unit.unwrap_or(1.0),
    };
    let (mut more, mut lines) = (vec![], vec![]);
    match format {
        ExportFormat::StMap => {
            if let Some(out) = out {
                let names = ["undistort", "distort"].map(|direction| beside(out, direction));
                for (map, path) in st_maps(&field).iter().zip(&names) {
                    save_map(path, map)?;
                }
                more.push(("files", json!(names.map(|name| name.display().to_string()))));
            }
            more.push(("pinhole_focal_length_px", json!(field.central_scale())));
        }
        ExportFormat::Rays => {
            if let Some(out) = out {
                save_map(out, &rays(&field))?;
            }
        }
        ExportFormat::Illumination => {
            let light = illumination(lens, here, &field)?;
            if let Some(out) = out {
                save_map(out, &light.map())?;
            }
            let [a1, a2, a3] = [0, 1, 2].map(|i| light.polynomial[i]);
            let [worst, rms] = light.errors.map(|error| 100.0 * error);
            lines.push((
                "illumination",
                format!("1 {a1:+.5} q^2 {a2:+.5} q^4 {a3:+.5} q^6 with q = 1 in the corner; worst {worst:.2} %, RMS {rms:.2} %"),
            ));
            more.push(("illumination", light.json()));
        }
        ExportFormat::Spot => {
            let spots = spots(lens, &field);
            if let Some(out) = out {
                let lines: String = spots.iter().map(Spot::line).collect();
                save(out, &(Spot::HEADER.to_owned() + &lines))?;
            }
            let spots: Vec<Value> = spots.iter().map(|spot| spot.json(here.pixel())).collect();
            more.push(("spots", json!(spots)));
        }
        _ => {
            let fitted = fitted.as_ref().expect("a model");
            let errors = errors.expect("of a model");
            if format == ExportFormat::OpenTrackIo {
                let other = Model::OpenCvRational.fitted(&field);
                let reverse = Errors::of_model(&other, &field);
                more.push(("radial_from_undistorted_per_mm", json!(other.radial_from_undistorted())));
                more.push(("errors_from_undistorted", reverse.json()));
            }
            if let Some(out) = out {
                save(out, &text(format, &data, fitted, &errors, lens, &field)?)?;
            }
        }
    }
    let breathing = breathing(&opened, first_order.focal_length.abs(), &film, fitted.as_ref());
    let report = Report {
        format: format.name(),
        name: &lens.name,
        wavelength: lens.wavelength,
        film_distance,
        rays: &field,
        model: fitted.as_ref(),
        errors,
        breathing: &breathing,
        more: &more,
        lines: &lines,
    };
    if args.json {
        return Ok(console::answer(&format!("{:#}\n", report.json()), out)?);
    }
    match out.filter(|out| !files::is_stdout(out)) {
        Some(out) => console::report(&report.text(), out)?,
        // The export goes to standard output, so the report goes to standard error.
        None => report.text().lines().for_each(console::note),
    }
    Ok(())
}

/// Exports a lens that is not round: maps, which need no model.
fn run_in_plane(
    args: &Args,
    lens: &Lens,
    film: Film,
    film_distance: f64,
    out: Option<&Path>,
) -> Result<(), Failure> {
    let format = args.format;
    if !matches!(format, ExportFormat::StMap | ExportFormat::Rays) {
        let what = format!("--as {}, which depends on the distance from the axis alone,", format.name());
        Failure::unless_round(lens, &what)?;
    }
    let field = PlaneField::new(lens, film);
    let dark = || Failure::from(FieldError::Dark(lens.name.clone()));
    let scales = field.central_scales().ok_or_else(dark)?;
    let mut files = Vec::new();
    if let Some(out) = out {
        match format {
            ExportFormat::Rays => {
                field.rays().write(out)?;
                files.push(out.to_owned());
            }
            _ => {
                for (map, direction) in field.st_maps(scales).iter().zip(["undistort", "distort"]) {
                    let path = beside(out, direction);
                    map.write(&path)?;
                    files.push(path);
                }
            }
        }
    }
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let text = if args.json {
        let report = json!({
            "as": format.name(),
            "ray": "chief",
            "name": lens.name,
            "wavelength": lens.wavelength,
            "film_distance": film_distance,
            "film_diagonal": film.diagonal,
            "size_px": film.size,
            "pixel_mm": film.pixel(),
            "pinhole_focal_length_x_px": scales[0],
            "pinhole_focal_length_y_px": scales[1],
            "lit_share_of_film": field.share(),
            "files": names,
        });
        format!("{report:#}\n")
    } else {
        format!(
            "lens              {}\n\
             pinhole           focal lengths {:.3} pixels along x and {:.3} along y, in the middle of the film\n\
             film              {:.1} % has chief rays\n\
             written           {}\n",
            lens.name,
            scales[0],
            scales[1],
            100.0 * field.share(),
            names.join(", ")
        )
    };
    Ok(console::answer(&text, out)?)
}

/// Returns the output, which is a file or standard output; `None` with --json alone.
fn out(args: &Args) -> Result<Option<&Path>, Failure> {
    let out = match &args.out {
        Some(out) => Some(out.as_path()),
        None if args.json => None,
        None if args.format.is_map() => {
            return Err(Failure::Usage(format!(
                "{} is a map with a value per pixel; give --out FILE.exr or FILE.npy, or --json for the report alone",
                args.format.name()
            )));
        }
        None => Some(Path::new("-")),
    };
    if let Some(out) = out {
        let ending = out.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        if args.format.is_map() && !matches!(ending.as_deref(), Some("exr" | "npy")) {
            return Err(Failure::Usage(format!(
                "\"{}\" must end in .exr (32-bit floats) or .npy (an array of NumPy's): {} is a map",
                out.display(),
                args.format.name()
            )));
        }
        if !files::is_stdout(out) {
            files::make_parent(out)?;
        }
    }
    Ok(out)
}

/// Returns the path of a map in the folder of `out`, with the direction before the ending.
fn beside(out: &Path, direction: &str) -> PathBuf {
    let ending = out.extension().unwrap_or_default().to_string_lossy();
    out.with_extension(format!("{direction}.{ending}"))
}

/// Whether all numbers of an export are valid, that is, there is no NaN, no infinity and no JSON `null` outside its
/// quoted texts.
fn has_numbers_alone(text: &str) -> bool {
    let plain = text.replace("\\\\", "").replace("\\\"", "");
    let words = plain.split('"').step_by(2).flat_map(|part| part.split(|c: char| !c.is_ascii_alphanumeric()));
    words.into_iter().all(|word| !matches!(word, "NaN" | "inf" | "null"))
}

fn illumination(lens: &Lens, film: Film, field: &ChiefField) -> Result<Illumination, Failure> {
    Illumination::of(lens, film, field.lit).ok_or_else(|| {
        Failure::Other(format!(
            "the film of lens \"{}\" lies in its glass; give a larger --film-distance",
            lens.name
        ))
    })
}

/// Returns the text of a model's file.
fn text(
    format: ExportFormat,
    data: &LensData<'_>,
    fitted: &Fitted,
    errors: &Errors,
    lens: &Lens,
    field: &ChiefField,
) -> Result<String, Failure> {
    Ok(match format {
        ExportFormat::FTheta => ftheta_usda(data, fitted),
        ExportFormat::OpenTrackIo => {
            let other = Model::OpenCvRational.fitted(field);
            let light = illumination(lens, field.film, field)?;
            format!("{:#}\n", opentrackio_json(data, fitted, &other, Some(&light)))
        }
        ExportFormat::Usd => {
            let light = illumination(lens, field.film, field)?;
            usda(data, field, Some(&light), errors.worst)
        }
        _ => opencv_yaml(fitted, errors.rms),
    })
}

/// Measures the lens focused at other distances, as far as it can focus on them.
fn breathing(
    opened: &OpenedLens,
    focal_length: f64,
    film: &dyn Fn(&Lens, f64) -> Film,
    model: Option<&Fitted>,
) -> Vec<Focus> {
    let at = |times: f64| {
        let distance = times * focal_length;
        let (lens, film_distance) = opened.focused_on(distance).ok()?;
        let rays = ChiefField::new(&lens, film(&lens, film_distance), COARSE).ok()?;
        Some(Focus::of(distance, film_distance, &rays, model))
    };
    DISTANCES.into_iter().filter_map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_found_outside_names() {
        for text in
            ["data: [ 1e0, NaN ]", "fStop = inf\n", "{\"a\": null}", "1,-inf,2", "a = \"x\\\"\" \n b = NaN"]
        {
            assert!(!has_numbers_alone(text), "{text}");
        }
        for text in ["{\"null\": 1.5e-3}", "lens = \"a \\\" inf\"", "lens = \"inf\\\\\"", "token info = 1\n"]
        {
            assert!(has_numbers_alone(text), "{text}");
        }
    }
}
