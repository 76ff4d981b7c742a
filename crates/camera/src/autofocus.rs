//! Autofocus: finds the film distance that brings the scene in some zones of the film into focus.
//!
//! A host that can measure the distance along a ray is queried for several rays through each zone
//! ([`by_distance`]). A host that only has pictures measures the contrast of trial cameras ([`Search`]).
//! Zones for which no film distance is found do not count; a [`Rule`] combines the film distances of the
//! others into one.

use thiserror::Error;

use super::{
    film::Raster,
    host::Host,
    models::lens::RealisticCamera,
    parameters::{CameraError, FocusBy, ParameterError, Parameters},
    rays::WorldRay,
    samples::Sample,
};
use realistic_base::{message::Log, numeric::minimum};
use realistic_optics::imaging::focus::{Focus, FocusError};

/// A rectangle of the picture, in pixels; (0, 0) is the picture's top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Left edge, 0 or more.
    pub left: f32,
    /// Top edge, 0 or more.
    pub top: f32,
    /// Right edge, beyond the left one and at most the picture's width.
    pub right: f32,
    /// Bottom edge, below the top one and at most the picture's height.
    pub bottom: f32,
}

/// The rule that combines several zones into one film distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
    /// Chooses the zone that sees the nearest object.
    #[default]
    Nearest,
    /// Chooses, among the zones with a film distance, the one nearest to the centre of the picture.
    Centre,
    /// Takes the mean of the zones' film distances. This mean favours near objects, because the film distance
    /// grows fast as the object comes near.
    Average,
}

impl Rule {
    /// Every rule with its name, in the order of the rules' numbers in the C ABI.
    pub const NAMES: [(&'static str, Self); 3] =
        [("nearest", Self::Nearest), ("centre", Self::Centre), ("average", Self::Average)];
}

/// The reason why there is no film distance.
#[derive(Debug, Error)]
pub enum AutofocusError {
    /// The camera cannot be built.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// No zones are given.
    #[error("autofocus needs at least one zone; the whole picture is 0, 0 to {xres}, {yres}")]
    NoZones {
        /// Number of pixel columns of the picture.
        xres: u32,
        /// Number of pixel rows of the picture.
        yres: u32,
    },
    /// A zone is empty, not finite or not in the picture.
    #[error(
        "autofocus zone {index} spans x {} to {} and y {} to {}; it must lie in the picture, 0 to {xres} and 0 \
         to {yres} pixels, with its right edge beyond its left one and its bottom below its top",
        zone.left, zone.right, zone.top, zone.bottom
    )]
    Zone {
        /// Index of the zone, from 0.
        index: usize,
        /// The zone.
        zone: Zone,
        /// Number of pixel columns of the picture.
        xres: u32,
        /// Number of pixel rows of the picture.
        yres: u32,
    },
    /// The lens is to be focused by moving its groups, which leaves no film distance to find.
    #[error(
        "autofocus finds a film distance, and \"focus_by\" \"group\" leaves the film where the lens file has it; leave out \
         \"focus_by\", or give \"focus_distance\" instead of autofocus"
    )]
    ByGroup,
    /// Autofocus finds no film distance in any zone.
    #[error(
        "autofocus found nothing to focus on in {zones} zone(s): {missing}; put a zone on an object with \
         detail, or give \"focus_distance\" or \"film_distance\""
    )]
    Nothing {
        /// Number of zones.
        zones: usize,
        /// The information that was missing.
        missing: &'static str,
    },
}

impl From<FocusError> for AutofocusError {
    fn from(error: FocusError) -> Self {
        Self::Camera(error.into())
    }
}

impl Zone {
    fn centre(&self) -> [f32; 2] {
        [f32::midpoint(self.left, self.right), f32::midpoint(self.top, self.bottom)]
    }
}

/// Checks that at least one zone is given and that all zones lie in the picture.
fn check(zones: &[Zone], Raster { xres, yres }: Raster) -> Result<(), AutofocusError> {
    if zones.is_empty() {
        return Err(AutofocusError::NoZones { xres, yres });
    }
    let inside = |low: f32, high: f32, end: u32| 0.0 <= low && low < high && high <= end as f32;
    let bad = |zone: &Zone| !inside(zone.left, zone.right, xres) || !inside(zone.top, zone.bottom, yres);
    match zones.iter().position(bad) {
        Some(index) => Err(AutofocusError::Zone { index, zone: zones[index], xres, yres }),
        None => Ok(()),
    }
}

/// Combines the zones' film distances into one film distance by the rule.
fn choose(zones: &[Zone], answers: &[Option<f64>], rule: Rule, raster: Raster) -> Option<f64> {
    let answered = || zones.iter().zip(answers).filter_map(|(zone, answer)| Some((zone, (*answer)?)));
    match rule {
        // A nearer object needs a larger film distance.
        Rule::Nearest => answered().map(|(_, distance)| distance).reduce(f64::max),
        Rule::Centre => {
            let [x, y] = [raster.xres, raster.yres].map(|end| end as f32 / 2.0);
            let off = |zone: &Zone| (zone.centre()[0] - x).powi(2) + (zone.centre()[1] - y).powi(2);
            answered().min_by(|a, b| off(a.0).total_cmp(&off(b.0))).map(|(_, distance)| distance)
        }
        Rule::Average => {
            let count = answered().count();
            (count > 0).then(|| answered().map(|(_, distance)| distance).sum::<f64>() / count as f64)
        }
    }
}

/// Checks that the parameters have no focus setting, and returns their camera focused at infinity and its
/// [`Focus`].
fn start(
    parameters: &Parameters,
    host: &Host,
    zones: &[Zone],
    log: Log<'_>,
) -> Result<(RealisticCamera, Focus), AutofocusError> {
    check(zones, host.raster)?;
    if parameters.focus_by() == FocusBy::Group {
        return Err(AutofocusError::ByGroup);
    }
    for (name, given) in
        [("film_distance", parameters.film_distance), ("focus_distance", parameters.focus_distance)]
    {
        if given.is_some() {
            return Err(CameraError::from(ParameterError::Both { first: name, second: "autofocus" }).into());
        }
    }
    let at_infinity = Parameters { focus_distance: Some(f64::INFINITY), ..parameters.clone() };
    let camera = RealisticCamera::build(&at_infinity, host, log)?;
    let focus = camera.facts().focus()?;
    Ok((camera, focus))
}

/// Number of rays along the width and along the height of a zone.
const GRID: u16 = 5;
/// Number of lens samples to try for each ray; the first that passes the lens is used.
const TRIES: u16 = 64;

/// Returns the film distance, mm, from measured distances. For a ray in world space, `distance` returns the
/// distance along the ray to the first surface, in world units: infinity if there is no surface, and NaN or a
/// number that is not positive if the distance is unknown. The depth of a zone is the median over its rays.
///
/// # Errors
/// No camera can be built, a zone is not in the picture, no ray of any zone has a distance, or
/// the lens cannot focus so near.
pub fn by_distance(
    parameters: &Parameters,
    host: &Host,
    zones: &[Zone],
    rule: Rule,
    mut distance: impl FnMut(&WorldRay) -> f64,
    log: Log<'_>,
) -> Result<f64, AutofocusError> {
    let (camera, focus) = start(parameters, host, zones, log)?;
    let mm_per_unit = parameters.mm_per_unit().map_err(CameraError::from)?;
    let mut answers = Vec::with_capacity(zones.len());
    let mut too_near = None;
    for zone in zones {
        let mut depths = Vec::new();
        for ray in rays(&camera, zone) {
            let along = distance(&ray);
            if along > 0.0 {
                depths.push(camera_depth(host, &ray, along) * mm_per_unit);
            }
        }
        depths.retain(|depth| *depth > 0.0);
        depths.sort_by(f64::total_cmp);
        let answer = match depths.get(depths.len() / 2) {
            None => None,
            Some(&depth) => match film_distance(&focus, &camera, depth) {
                Ok(distance) => Some(distance),
                Err(error) => {
                    too_near = Some(error);
                    None
                }
            },
        };
        answers.push(answer);
    }
    choose(zones, &answers, rule, host.raster).ok_or_else(|| match too_near {
        Some(error) => error.into(),
        None => {
            AutofocusError::Nothing { zones: zones.len(), missing: "no ray of them has a distance above 0" }
        }
    })
}

/// Returns the film distance that focuses the plane at z = `depth` mm in lens space.
fn film_distance(focus: &Focus, camera: &RealisticCamera, depth: f64) -> Result<f64, FocusError> {
    const REPETITIONS: u32 = 60;
    // Film distances are measured from the last vertex, depths from the first. The object distance from the
    // film changes as the film moves, so it is found by iteration, which contracts by (f/depth)² per step.
    let length = -camera.facts().lens.rear().vertex;
    let mut film = camera.facts().film_distance;
    for _ in 0..REPETITIONS {
        let next = focus.film_distance(depth + length + film)?;
        let moved = (next - film).abs();
        film = next;
        if moved <= 1e-12 * film {
            break;
        }
    }
    Ok(film)
}

/// Returns rays from a grid of points in a zone, each through the point of the lens nearest to its middle
/// that transmits the ray.
fn rays(camera: &RealisticCamera, zone: &Zone) -> Vec<WorldRay> {
    let step =
        |index: u16, low: f32, high: f32| low + (high - low) * (f32::from(index) + 0.5) / f32::from(GRID);
    let at = |index: u16| {
        let (image_x, image_y) =
            (step(index % GRID, zone.left, zone.right), step(index / GRID, zone.top, zone.bottom));
        // Tries points from the middle of the lens outwards, in steps of the golden angle.
        (0..TRIES).find_map(|attempt| {
            let radius = 0.5 * (f32::from(attempt) / f32::from(TRIES)).sqrt();
            let (sine, cosine) = (2.399_963 * f32::from(attempt)).sin_cos();
            let sample = Sample {
                image_x,
                image_y,
                lens_u: 0.5 + radius * cosine,
                lens_v: 0.5 + radius * sine,
                time: 0.5,
            };
            camera.ray(&sample).map(|(ray, _)| ray)
        })
    };
    (0..GRID * GRID).filter_map(at).collect()
}

/// Returns the z coordinate in camera space, world units, of the point at distance `along` on a ray.
fn camera_depth(host: &Host, ray: &WorldRay, along: f64) -> f64 {
    let to_camera = host.to_world.at(ray.time).inverse_rows();
    let row = &to_camera[8..12];
    let along_axis = |v: [f32; 3]| (0..3).map(|i| f64::from(row[i]) * f64::from(v[i])).sum::<f64>();
    let direction = along_axis(ray.direction);
    let start = along_axis(ray.origin) + f64::from(row[3]);
    if along == f64::INFINITY && direction > 0.0 { f64::INFINITY } else { start + along * direction }
}

/// Autofocus by contrast: the search that chooses the film distances to try.
#[derive(Clone, Debug)]
pub struct Search {
    zones: Vec<Zone>,
    raster: Raster,
    nearest: f64,
    infinity: f64,
    steps: u32,
}

/// Smallest and largest number of film distances in the first pass.
const STEPS: std::ops::RangeInclusive<u32> = 12..=160;
/// Change of the blur's diameter between successive film distances of the first pass, pixels.
const BLUR_STEP: f64 = 4.0;
/// Smallest variation of a zone's contrast, relative to its highest value, with which the zone counts.
const FLAT: f64 = 0.05;

impl Search {
    /// Prepares the search for the camera of these parameters.
    ///
    /// # Errors
    /// No camera can be built, or a zone is not in the picture.
    pub fn new(
        parameters: &Parameters,
        host: &Host,
        zones: &[Zone],
        log: Log<'_>,
    ) -> Result<Self, AutofocusError> {
        let (camera, focus) = start(parameters, host, zones, log)?;
        let (infinity, nearest) = (camera.facts().film_distance, focus.nearest().film_distance);
        let step = BLUR_STEP * camera.facts().film.pixel() * camera.facts().fnumber();
        let steps = ((nearest - infinity) / step).ceil();
        let steps = (steps as u32).clamp(*STEPS.start(), *STEPS.end());
        Ok(Self { zones: zones.to_vec(), raster: host.raster, nearest, infinity, steps })
    }

    /// Returns the film distance, mm, with the highest contrast. `contrast` measures the contrast in a zone
    /// of the picture at a given film distance; it returns 0 or more, or NaN if the contrast is unknown. The
    /// first pass covers the whole range from infinity to the nearest distance; the second refines around the
    /// best film distance of each zone.
    ///
    /// # Errors
    /// No zone's contrast depends on the film distance, or `contrast` returns an error.
    pub fn run<E: From<AutofocusError>>(
        &self,
        rule: Rule,
        mut contrast: impl FnMut(f64, &Zone) -> Result<f64, E>,
    ) -> Result<f64, E> {
        const PRECISION: f64 = 1e-2;
        let film_distance = |step: u32| {
            self.infinity + (self.nearest - self.infinity) * f64::from(step) / f64::from(self.steps)
        };
        let mut answers = Vec::with_capacity(self.zones.len());
        for zone in &self.zones {
            let mut seen = Vec::new();
            for step in 0..=self.steps {
                let value = contrast(film_distance(step), zone)?;
                if value.is_finite() {
                    seen.push((step, value));
                }
            }
            let best = seen.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
            let least = seen.iter().map(|(_, value)| *value).fold(f64::INFINITY, f64::min);
            let Some((step, highest)) = best.filter(|best| best.1 > 0.0 && best.1 - least > FLAT * best.1)
            else {
                answers.push(None);
                continue;
            };
            let (low, high) =
                (film_distance(step.saturating_sub(1)), film_distance((step + 1).min(self.steps)));
            let mut failure = None;
            let refined = minimum(low, high, PRECISION, |distance| match contrast(distance, zone) {
                Ok(value) if value.is_finite() => -value,
                Ok(_) => f64::INFINITY,
                Err(error) => {
                    failure = Some(error);
                    f64::INFINITY
                }
            });
            if let Some(error) = failure {
                return Err(error);
            }
            // On a jagged peak the refined distance may have less contrast; the best distance of the first
            // pass is then kept.
            let better = contrast(refined, zone)? >= highest;
            answers.push(Some(if better { refined } else { film_distance(step) }));
        }
        choose(&self.zones, &answers, rule, self.raster).ok_or_else(|| {
            let missing = "their contrast does not depend on the film distance";
            AutofocusError::Nothing { zones: self.zones.len(), missing }.into()
        })
    }
}
