//! A surface as the kernel's table is made of it: its numbers in the frame of the travel, and which tests its neighbours'
//! shapes leave open. A path's surfaces in; [`CompiledSurface`]s out, of which `table` chooses steps.

use super::crossing::{self, ClearPart, Tests};
use crate::trace::{aspheric::Aspheric, blades::StopFigure, surface::PathSurface};

/// |R|/n up to this many times the clear semi-diameter counts as strongly curved: without the division t has an error of
/// rounding times |R|/n, however near the surface is. As few as leave the catalogue's lenses, whose weakest surface comes
/// to 25.5 from the film, without a division.
const STRONG: f64 = 26.0;
/// From this (a/R)² the aperture is tested by N_z, which has too few digits below.
const STEEP: f64 = 0.02;

/// From one vertex's frame to the next's: -z' there is `factor` times the height that a ray carries (z above the vertex
/// it was last at, or N_z), plus `offset`.
#[derive(Clone, Copy, Debug)]
pub struct Transfer<S> {
    pub factor: S,
    pub offset: S,
}

/// One surface as the compiler sees it.
pub struct CompiledSurface<'a> {
    pub c: f64,
    /// The whole of a surface that is neither a sphere nor a plane.
    pub aspheric: Option<&'a Aspheric<f64>>,
    pub n: f64,
    pub index_step: f64,
    pub aperture: f64,
    pub semi: f64,
    pub slack: f64,
    /// From the last surface that moved the ray.
    pub distance: f64,
    pub tests: Tests,
    /// The figure that blades leave open in it.
    pub blades: Option<&'a StopFigure<f64>>,
    /// A plane that only limits: a test, which does not move the ray.
    pub is_still: bool,
    /// A plane that only limits and is the first surface: the ray is moved to it, and how far it has come is handed on.
    pub leads: bool,
    /// The next surface that moves the ray: it counts from where the ray began.
    pub is_led: bool,
}

impl CompiledSurface<'_> {
    pub fn is_strong(&self) -> bool {
        self.c.abs() * STRONG * self.n * self.semi >= 1.0
    }

    pub fn is_steep(&self) -> bool {
        (self.c * self.semi).powi(2) > STEEP
    }
}

/// The surfaces of a path. `travel_sign` is that of the table, `epsilon` the precision's rounding unit.
pub fn surfaces(steps: &[PathSurface<f64>], travel_sign: f64, epsilon: f64) -> Vec<CompiledSurface<'_>> {
    let mut surfaces: Vec<CompiledSurface<'_>> = Vec::with_capacity(steps.len());
    let clear_part = |step: &PathSurface<f64>| ClearPart {
        curvature: step.curvature,
        semi_diameter: step.aperture.sqrt(),
        aspheric: step.aspheric.as_ref().map(|aspheric| aspheric.extent),
    };
    let mut moved: Option<ClearPart> = None;
    let mut distance = 0.0;
    // At the first surface where the ray began decides, which is not known here. From the scene a
    // sphere may be met going backward: a fisheye sees behind itself.
    let unknown =
        |step: &PathSurface<f64>| Tests { forward: travel_sign > 0.0 || step.curvature == 0.0, onward: true };
    // Rays leave at the last surface, whatever it is.
    let last = steps.iter().rposition(|step| !step.only_limits()).unwrap_or(0);
    let mut is_led = false;
    for (i, step) in steps.iter().enumerate() {
        distance += step.distance;
        let here = clear_part(step);
        let is_still = moved.is_some() && i < last && step.only_limits();
        let mut tests = moved.map_or(unknown(step), |moved| crossing::tests(moved, here, distance));
        // Whether a plane that only limits lies ahead of the surfaces around it is no question; behind one that stands first,
        // where the ray began decides.
        tests.onward = (tests.onward || is_led) && !step.only_limits();
        let leads = moved.is_none() && step.only_limits();
        surfaces.push(CompiledSurface {
            c: step.curvature,
            aspheric: step.aspheric.as_deref(),
            n: step.n,
            index_step: step.index_step,
            aperture: step.aperture,
            semi: here.semi_diameter,
            slack: step.slack * (epsilon / f64::EPSILON),
            distance,
            tests,
            blades: step.blades.as_deref(),
            is_still,
            leads,
            is_led: is_led && !is_still,
        });
        if !is_still {
            (moved, distance, is_led) = (Some(here), 0.0, leads);
        }
    }
    surfaces
}
