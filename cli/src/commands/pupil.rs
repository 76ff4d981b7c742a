//! `realistic pupil`: the part of the lens that lights a film point.

use crate::arguments::{FilmSize, LensChoice, not_negative};
use crate::console;
use crate::drawing::{outline as drawing, output};
use crate::failure::Failure;
use realistic_base::message::{as_given, fixed};
use realistic_camera::CameraError;
use realistic_camera::sampling::{PupilDisk, WarpedPupil};
use realistic_lab::pupil::{Outline, acceptance};
use realistic_optics::imaging::irradiance;
use realistic_optics::lens::{Lens, film_ray, pupil::SlopeDisk};
use realistic_optics::trace::Path;
use realistic_trace::kernel::Kernel;
use serde_json::{Value, json};
use std::path::PathBuf;

/// The options of `pupil`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Distance in mm of the film point from the axis; the point lies at +x
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = not_negative)]
    film_radius: f64,
    #[command(flatten)]
    film: FilmSize,
    /// Write JSON
    #[arg(long)]
    json: bool,
    /// Draw the outline to this file, .svg or .png; - for an .svg on standard output
    #[arg(short, long, value_name = "FILE", value_parser = output::path)]
    out: Option<PathBuf>,
}

/// Prints the pupil of the film point.
///
/// # Errors
/// There is no such lens, the film distance lies inside the lens, or a file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let opened = args.lens.open()?;
    let lens = &opened.lens;
    let film_distance = opened.film_distance()?;
    let diagonal = opened.film_diagonal();
    let sight = Sight::of(lens, args, film_distance, diagonal)?;
    if let Some(out) = &args.out {
        let disks = [("rear", sight.rear), ("disk", sight.disk)];
        let name = lens.name.rsplit('/').next().unwrap_or(&lens.name);
        let edge: Vec<[f64; 2]> = sight.edge();
        let map = sight.map();
        let drawn = drawing::PupilDrawing {
            title: format!("{name}: the pupil of the film point at {} mm", as_given(args.film_radius)),
            edge: &edge,
            map: &map,
            disks: disks.map(|(name, disk)| (name, sight.on_plane(disk.center), disk.radius * film_distance)),
        };
        output::write(&drawing::draw(&drawn), out)?;
    }
    let text = if args.json { format!("{:#}\n", sight.json(lens)) } else { sight.text() };
    let drawn = args.out.as_ref().filter(|_| !args.json);
    let drawn = drawn.map_or_else(String::new, |out| format!("drawn             {}\n", out.display()));
    Ok(console::answer(&(text + &drawn), args.out.as_deref())?)
}

/// Number of points of the outline.
const DIRECTIONS: usize = 720;
/// Number of rays across a disk when a share is measured.
const SURVEY: u32 = 400;
/// Number of rings and spokes of the sampled disk, which are drawn after the map to the pupil, and of points on each.
const RINGS: u32 = 6;
const SPOKES: u32 = 24;
const POINTS: u32 = 96;

struct Sight {
    radius: f64,
    film_distance: f64,
    diagonal: f64,
    rear: SlopeDisk,
    disk: SlopeDisk,
    outline: Option<Outline>,
    /// The map with which cameras sample the pupil.
    warped: WarpedPupil,
    /// Shares of the samples that pass the lens, when sampled in the rear disk, in the exit pupil's disk, and by the
    /// map.
    rear_acceptance: f64,
    disk_acceptance: f64,
    warped_acceptance: f64,
    /// Share of the irradiance that comes from outside the exit pupil's disk.
    missed: f64,
}

impl Sight {
    fn of(lens: &Lens, args: &Args, film_distance: f64, diagonal: f64) -> Result<Self, Failure> {
        let radius = args.film_radius;
        let point = [radius, 0.0];
        let film = lens.rear().vertex - film_distance;
        // For a point off the film, the map is made larger, so that it includes the point and ends farther out.
        let reach = args.film.film(diagonal).reach().max(1.01 * radius);
        let rear = PupilDisk::rear(lens, film, reach)
            .ok_or_else(|| CameraError::film_in_lens(lens, film_distance))?;
        let path = Path::<f64>::film_to_scene(lens);
        let exit = PupilDisk::exit(lens, film);
        let warped = WarpedPupil::new(&path, film, reach, [rear, exit]);
        let (rear, disk) = (rear.seen_from(point), exit.seen_from(point));
        let outline = Outline::of(&Kernel::along(&path), film, point, rear, DIRECTIONS);
        let through = irradiance::survey(&path, film, point, rear, disk, SURVEY);
        let in_disk = irradiance::survey(&path, film, point, disk, disk, SURVEY);
        let area = outline.as_ref().map_or(0.0, |outline| outline.slope_area);
        let missed = if through.irradiance > 0.0 { 1.0 - through.inside / through.irradiance } else { 0.0 };
        Ok(Self {
            radius,
            film_distance,
            diagonal,
            rear,
            disk,
            rear_acceptance: acceptance(area, rear),
            // The cells of the grid approximate the area of a disk to a few parts in 10 000.
            disk_acceptance: acceptance(in_disk.slope_area, disk).min(1.0),
            warped_acceptance: share_through(&path, film, point, &warped),
            missed,
            outline,
            warped,
        })
    }

    /// Returns the point at which the ray with these slopes meets the rear vertex plane, mm.
    fn on_plane(&self, slopes: [f64; 2]) -> [f64; 2] {
        [self.radius + slopes[0] * self.film_distance, slopes[1] * self.film_distance]
    }

    /// Returns rings that divide the disk into equal areas, and spokes, after the map to the pupil.
    fn map(&self) -> Vec<Vec<[f64; 2]>> {
        let at = |part: f64, turn: f64| {
            let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
            let sample = self.warped.sample([self.radius, 0.0], [part * cos, part * sin])?;
            Some(self.on_plane(sample.slopes))
        };
        let parts = |count: u32| (0..=count).map(move |k| f64::from(k) / f64::from(count));
        let ring = |part: f64| parts(POINTS).filter_map(|turn| at(part.sqrt(), turn)).collect();
        let spoke = |turn: f64| parts(POINTS).filter_map(|part| at(part, turn)).collect();
        parts(RINGS).skip(1).map(ring).chain(parts(SPOKES).skip(1).map(spoke)).collect()
    }

    fn edge(&self) -> Vec<[f64; 2]> {
        let points = self.outline.as_ref().map_or(&[][..], |outline| &outline.points);
        points.iter().map(|&slopes| self.on_plane(slopes)).collect()
    }

    fn area(&self) -> f64 {
        self.outline.as_ref().map_or(0.0, |outline| outline.slope_area) * self.film_distance.powi(2)
    }

    fn json(&self, lens: &Lens) -> Value {
        let outline = self.outline.as_ref();
        json!({
            "film_radius_mm": self.radius,
            "name": lens.name,
            "wavelength": lens.wavelength,
            "film_distance": self.film_distance,
            "film_diagonal": self.diagonal,
            "area_mm2": self.area(),
            "slope_area": outline.map_or(0.0, |outline| outline.slope_area),
            "irradiance_for_unit_radiance": outline.map_or(0.0, |outline| outline.irradiance),
            "center_mm": outline.map(|outline| self.on_plane(outline.center)),
            "outline_mm": self.edge(),
            "pieces": outline.map_or(0, |outline| outline.pieces),
            "star_shaped": outline.is_some_and(|outline| outline.star_shaped),
            "acceptance": {
                "rear": self.rear_acceptance,
                "disk": self.disk_acceptance,
                "warped": self.warped_acceptance,
            },
            "missed_by_disk": self.missed,
        })
    }

    fn text(&self) -> String {
        let head = format!(
            "film point        {} mm from the axis, film {} mm behind the last vertex\n",
            as_given(self.radius),
            fixed(self.film_distance, 4)
        );
        let Some(outline) = &self.outline else {
            return head + "pupil             empty: no light reaches this film point\n";
        };
        let edge = self.edge();
        let range = |axis: usize| {
            let values = || edge.iter().map(|point| point[axis]);
            let (low, high) = (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
            format!("{} to {}", fixed(low, 4), fixed(high, 4))
        };
        // By symmetry, the y of the centre is 0, whatever the rounding error of the sum.
        let [x, _] = self.on_plane(outline.center);
        let shape = match (outline.pieces, outline.star_shaped) {
            (1, true) => "one piece, star-shaped about its centre".to_owned(),
            (1, false) => "one piece, not star-shaped: the outline is its outer edge only".to_owned(),
            (pieces, _) => format!("{pieces} pieces: the outline is their outer edge only"),
        };
        head + &format!(
            "outline           x from {} mm, y from {} mm in the rear vertex plane\n\
             \x20                 {shape}; centre at x = {} mm; all points by --json\n\
             area              {} mm2 in the rear vertex plane; {:.6e} in slope\n\
             irradiance        {:.6e} for unit radiance\n\
             acceptance        rear {:.3} %, disk {:.3} %, warped {:.3} % of the samples get through\n\
             missed by disk    {:.3} % of the irradiance\n",
            range(0),
            range(1),
            fixed(x, 4),
            if self.area() < 1e-6 { format!("{:.6e}", self.area()) } else { fixed(self.area(), 6) },
            outline.slope_area,
            outline.irradiance,
            100.0 * self.rear_acceptance,
            100.0 * self.disk_acceptance,
            100.0 * self.warped_acceptance,
            100.0 * self.missed,
        )
    }
}

/// Returns the share of the map's samples that pass the lens; equal areas of the disk have equal numbers of samples.
fn share_through(path: &Path, film: f64, point: [f64; 2], warped: &WarpedPupil) -> f64 {
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(SURVEY);
    let gets_through = |(ring, turn): (u32, u32)| {
        let (sin, cos) = (std::f64::consts::TAU * middle(turn)).sin_cos();
        let radius = middle(ring).sqrt();
        warped
            .sample(point, [radius * cos, radius * sin])
            .is_some_and(|sample| path.trace(film_ray(point, film, sample.slopes)).is_ok())
    };
    let passed =
        (0..SURVEY).flat_map(|ring| (0..SURVEY).map(move |turn| (ring, turn))).filter(|&at| gets_through(at));
    passed.count() as f64 / f64::from(SURVEY * SURVEY)
}
