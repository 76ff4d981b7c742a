//! Autofocus for a C caller, whose callback returns distances or contrasts.

use std::ffi::c_void;

use super::boundary::{self, Failure, realistic_status};
use super::camera;
use super::object::{self, Handle};
use super::options;
use super::options::realistic_options;
use super::types::{realistic_camera, realistic_ray};
use ::realistic_camera::autofocus::{Rule, Search, Zone, by_distance};
use ::realistic_camera::{Host, Parameters};

/// A rectangle of the picture in pixels; (0, 0) is the picture's top left corner.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_camel_case_types)]
pub struct realistic_zone {
    /// Left edge, 0 or more.
    pub left: f32,
    /// Top edge, 0 or more.
    pub top: f32,
    /// Right edge, beyond `left` and at most `xres`.
    pub right: f32,
    /// Bottom edge, below `top` and at most `yres`.
    pub bottom: f32,
}

/// Rule that combines several zones into one film distance. The numbers are part of the ABI and never change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
pub enum realistic_autofocus_rule {
    /// Chooses the zone with the nearest object.
    Nearest = 0,
    /// Chooses the zone nearest to the centre of the picture, among the zones for which a film distance is
    /// found.
    Centre = 1,
    /// Takes the mean of the zones' film distances.
    Average = 2,
}

/// Returns the distance along a ray from the ray's origin to the first surface, world units: infinity if
/// there is no surface; NaN, 0 or a negative number if the distance is not known.
#[allow(non_camel_case_types)]
pub type realistic_distance =
    Option<unsafe extern "C" fn(user: *mut c_void, ray: *const realistic_ray) -> f64>;

/// Returns the contrast of a trial camera's picture in a zone; NaN if it is not known. Any measure will do
/// that is at least 0 and highest for the sharpest picture, such as the mean square difference of
/// neighbouring pixels. Use the same random numbers for every camera. A camera lives until the callback
/// returns.
#[allow(non_camel_case_types)]
pub type realistic_contrast = Option<
    unsafe extern "C" fn(
        user: *mut c_void,
        camera: *const realistic_camera,
        zone: *const realistic_zone,
    ) -> f64,
>;

/// Finds the film distance, mm, that focuses the camera of `options` on the objects in `n` zones of the
/// picture; set the option `film_distance` to it afterwards. `rule` is a `realistic_autofocus_rule`. Pass one
/// callback and NULL for the other: `distance` is called for several rays per zone, `contrast` for tens to
/// hundreds of trial cameras. The callback is called on this thread. In `options`, `film_distance` and
/// `focus_distance` must be unset, and `focus_by` must be "film". Returns
/// `REALISTIC_STATUS_UNREACHABLE_FOCUS` if autofocus finds no film distance in any zone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_autofocus(
    options: *const realistic_options,
    zones: *const realistic_zone,
    n: usize,
    rule: i32,
    distance: realistic_distance,
    contrast: realistic_contrast,
    user: *mut c_void,
    film_distance: *mut f64,
) -> realistic_status {
    boundary::status(|| {
        if zones.is_null() {
            return Err(boundary::null("zones"));
        }
        if film_distance.is_null() {
            return Err(boundary::null("film_distance"));
        }
        let rule = rule_of(rule)?;
        boundary::memory_to_build()?;
        // SAFETY: the caller's promise.
        let (options, parameters, host) = unsafe {
            let options = options::read(options)?;
            (options, options.parameters()?, options.host()?)
        };
        // SAFETY: not NULL, and the caller's promise.
        let zones = unsafe { copied(zones, n) }?;
        let mut log = |level, text: &str| camera::log(options.log, options.log_user, level, text);
        let found = match (distance, contrast) {
            (Some(distance), None) => {
                let measure = |ray: &::realistic_camera::WorldRay| {
                    let ray = realistic_ray::from(*ray);
                    // SAFETY: the caller's function is called with the arguments that its type declares.
                    unsafe { distance(user, &ray) }
                };
                by_distance(&parameters, &host, &zones, rule, measure, &mut log)?
            }
            (None, Some(contrast)) => {
                let search = Search::new(&parameters, &host, &zones, &mut log)?;
                let mut last = None;
                search.run(rule, |film, zone| {
                    let trial = SharpnessTrial::new(last.take(), &parameters, &host, film)?;
                    let zone = realistic_zone::from(*zone);
                    // SAFETY: the caller's function is called with the arguments that its type declares.
                    let found = unsafe { contrast(user, trial.0, &zone) };
                    last = Some(trial);
                    Ok::<_, Failure>(found)
                })?
            }
            (None, None) => {
                return Err(Failure::new(
                    realistic_status::NullPointer,
                    "autofocus needs a distance or a contrast callback, and both are NULL; give one",
                ));
            }
            (Some(_), Some(_)) => {
                return Err(Failure::invalid(
                    "autofocus takes a distance or a contrast callback, not both; give NULL for one",
                ));
            }
        };
        // SAFETY: not NULL, and the caller's promise.
        unsafe { film_distance.write(found) };
        Ok(())
    })
}

/// Copies a caller's zones.
///
/// # Safety
/// `zones` has `n` elements, whatever their alignment.
unsafe fn copied(zones: *const realistic_zone, n: usize) -> Result<Vec<Zone>, Failure> {
    boundary::fits_memory(n, size_of::<realistic_zone>())?;
    let mut copies = Vec::new();
    copies.try_reserve_exact(n).map_err(|_| boundary::out_of_memory())?;
    // SAFETY: the caller's promise.
    copies.extend((0..n).map(|i| Zone::from(unsafe { zones.add(i).read_unaligned() })));
    Ok(copies)
}

fn rule_of(number: i32) -> Result<Rule, Failure> {
    let named = usize::try_from(number).ok().and_then(|number| Rule::NAMES.get(number));
    named.map(|(_, rule)| *rule).ok_or_else(|| {
        Failure::invalid(format!(
            "autofocus rule {number} is unknown; give 0 (nearest), 1 (centre) or 2 (average)"
        ))
    })
}

/// A trial camera of the contrast search. It logs nothing, because its warnings have already been logged.
struct SharpnessTrial(*mut realistic_camera);

impl SharpnessTrial {
    /// Builds a trial camera with the previous one as its donor.
    fn new(
        before: Option<Self>,
        parameters: &Parameters,
        host: &Host,
        film_distance: f64,
    ) -> Result<Self, Failure> {
        let parameters = Parameters { film_distance: Some(film_distance), ..parameters.clone() };
        // SAFETY: made by `camera::make`, and alive until `before` is dropped.
        let donor = before.as_ref().and_then(|trial| unsafe { object::handle_of(trial.0) });
        camera::make(donor.map(Handle::camera), &parameters, host, &mut |_, _| ()).map(Self)
    }
}

impl Drop for SharpnessTrial {
    fn drop(&mut self) {
        // SAFETY: made by `camera::make`, and the callback is over.
        unsafe { object::delete(self.0) };
    }
}

impl From<realistic_zone> for Zone {
    fn from(zone: realistic_zone) -> Self {
        let realistic_zone { left, top, right, bottom } = zone;
        Self { left, top, right, bottom }
    }
}

impl From<Zone> for realistic_zone {
    fn from(zone: Zone) -> Self {
        let Zone { left, top, right, bottom } = zone;
        Self { left, top, right, bottom }
    }
}
