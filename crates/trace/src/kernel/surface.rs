//! A surface as input of the kernel's table: its data in a frame along the direction of travel, and the tests that a
//! ray still needs. The surfaces of a path are converted to [`CompiledSurface`]s, for which `table` chooses steps.
//!
//! **Tests.** A ray is turned back if its next surface lies behind it (t < 0) or it no longer travels forward (Vz <=
//! 0). A ray leaves a surface, and crosses the next surface, toward the side ahead. A condition that the shapes of the
//! two surfaces and their distance prove for every ray between them is not tested ([`tests_between`]).
//!
//! **Mirrors.** Behind a mirror, the z axis is reversed, so that it again points along the direction of travel, as in
//! the path. The curvature of the mirror then changes sign, and N_z = 1 - c z and e = N·V stay the same. A ray leaves
//! the mirror toward the side ahead, as it leaves any other surface. The proofs for the next surface and the
//! intersection with it are thus the same as without a mirror, also for aspheres.

use realistic_optics::trace::{ApertureTest, Aspheric, FrameChange, PathSurface, UnsymmetricSheet};

/// Largest |R|/n, in clear semi-diameters, of a strongly curved surface. Without the division, t has an error of the
/// rounding unit times |R|/n, however near the surface is. This limit is the smallest at which the lenses of the
/// catalogue need no division; the ratio of their weakest surface is 25.5, traced from the film.
const STRONG: f64 = 26.0;
/// Least (a/R)² at which the aperture is tested by N_z; below it, N_z is too imprecise.
const STEEP: f64 = 0.02;

/// Transfer from the frame of one vertex to the frame of the next: -z' in the new frame is `factor` times the height
/// that a ray carries (z above the last vertex, or N_z at the last surface), plus `offset`.
#[derive(Clone, Copy, Debug)]
pub struct Transfer<S> {
    pub factor: S,
    pub offset: S,
}

/// One surface as input of the compiler.
pub struct CompiledSurface<'a> {
    pub c: f64,
    /// The asphere, if the surface is neither a sphere nor a plane.
    pub aspheric: Option<&'a Aspheric<f64>>,
    /// The surface, if it is not symmetric about its axis.
    pub unsymmetric: Option<&'a UnsymmetricSheet<f64>>,
    /// The change to the frame of this surface, if it does not share the axis of the last one.
    pub change: Option<&'a FrameChange<f64>>,
    /// Refractive index before the surface, relative to that before the first surface.
    pub n: f64,
    /// n'² - n² of these relative indices.
    pub index_step: f64,
    pub aperture: f64,
    pub semi: f64,
    pub slack: f64,
    /// Distance from the last surface that moved the ray; to the vertex where the frame changes, if it does.
    pub distance: f64,
    pub tests: Tests,
    /// Whether the surface reflects rays; then `index_step` is 0.
    pub is_mirror: bool,
    /// The apertures and obstructions inside the clear aperture.
    pub apertures: &'a [ApertureTest<f64>],
    /// Whether this is a plane that only limits rays: a test, which does not move the ray.
    pub is_still: bool,
    /// Whether this is a plane that only limits rays and is the first surface, or in a new frame: the ray is moved to it,
    /// and the distance that it has come is passed on.
    pub leads: bool,
    /// Whether this is the next surface that moves the ray behind a plane that leads; the slack of such a surface is
    /// measured from the ray's origin.
    pub is_led: bool,
}

impl CompiledSurface<'_> {
    /// Returns the curvature in the frame of the rays that leave the surface.
    pub fn c_behind(&self) -> f64 {
        if self.is_mirror { -self.c } else { self.c }
    }

    pub fn is_strong(&self) -> bool {
        self.c.abs() * STRONG * self.n * self.semi >= 1.0
    }

    pub fn is_steep(&self) -> bool {
        (self.c * self.semi).powi(2) > STEEP
    }
}

/// Compiles the surfaces of a path. `travel_sign` is that of the table; `epsilon` is the rounding unit of the
/// precision. Indices become relative to the medium before the first surface, so that V is a unit vector there: rays
/// depend on ratios of indices alone.
pub fn surfaces(steps: &[PathSurface<f64>], travel_sign: f64, epsilon: f64) -> Vec<CompiledSurface<'_>> {
    let mut surfaces: Vec<CompiledSurface<'_>> = Vec::with_capacity(steps.len());
    let clear_part = |step: &PathSurface<f64>| ClearPart {
        curvature: step.curvature,
        semi_diameter: step.aperture.sqrt(),
        extent: step
            .aspheric
            .as_ref()
            .map(|aspheric| aspheric.extent)
            .or(step.unsymmetric.as_ref().map(|sheet| sheet.inside.extent)),
    };
    let mut moved: Option<ClearPart> = None;
    let mut distance = 0.0;
    // At the first surface the tests depend on the ray's origin, which is not known here. From the scene a ray may
    // meet a sphere while it travels backward: a fisheye's field exceeds 180 degrees.
    let unknown =
        |step: &PathSurface<f64>| Tests { forward: travel_sign > 0.0 || step.curvature == 0.0, onward: true };
    // Rays leave the lens at the last surface, whatever its form.
    let last = steps.iter().rposition(|step| !step.only_limits()).unwrap_or(0);
    // Rays that do not enter at the first step keep their distance from the origin, as behind a plane that leads.
    let mut is_led = steps.first().is_some_and(|first| first.change.is_some() || first.unsymmetric.is_some());
    let first_index = steps.first().map_or(1.0, |step| step.n);
    for (i, step) in steps.iter().enumerate() {
        distance += step.distance;
        let here = clear_part(step);
        let change = step.change.as_deref();
        let is_still = moved.is_some() && i < last && step.only_limits() && change.is_none();
        let mut tests = match (moved, change) {
            (_, Some(_)) => Tests { forward: true, onward: true },
            (None, None) => unknown(step),
            (Some(moved), None) => tests_between(moved, here, distance),
        };
        // A plane that only limits rays need not lie ahead of its neighbours. If the first surface is such a plane, the
        // test behind it depends on the ray's origin.
        tests.onward = (tests.onward || is_led) && !step.only_limits();
        let leads = (moved.is_none() || change.is_some()) && step.only_limits();
        surfaces.push(CompiledSurface {
            c: step.curvature,
            aspheric: step.aspheric.as_deref(),
            unsymmetric: step.unsymmetric.as_deref(),
            change,
            n: step.n / first_index,
            index_step: step.index_step / (first_index * first_index),
            aperture: step.aperture,
            semi: here.semi_diameter,
            slack: step.slack * (epsilon / f64::EPSILON),
            distance,
            tests,
            is_mirror: step.is_mirror,
            apertures: &step.apertures,
            is_still,
            leads,
            is_led: is_led && !is_still,
        });
        if !is_still {
            let behind = if step.is_mirror { here.seen_from_ahead() } else { here };
            (moved, distance, is_led) = (Some(behind), 0.0, leads);
        }
    }
    surfaces
}

/// The part of a surface inside its clear aperture, in a frame at the vertex whose z axis points in the direction of
/// travel.
#[derive(Clone, Copy, Debug)]
struct ClearPart {
    /// 1/radius, positive when the centre lies ahead.
    curvature: f64,
    /// Clear semi-diameter.
    semi_diameter: f64,
    /// The least and the greatest z of a part that is neither a sphere nor a plane.
    extent: Option<[f64; 2]>,
}

/// The tests that a ray between two surfaces still needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tests {
    /// Whether to test that the ray travels forward, Vz > 0.
    pub forward: bool,
    /// Whether to test that the next surface lies ahead, t >= 0.
    pub onward: bool,
}

/// Smallest gap that counts as a gap, relative to the lengths involved. It is far above the rounding error of single
/// precision.
const MARGIN: f64 = 1e-5;

impl ClearPart {
    /// Returns the part with z reversed.
    fn seen_from_ahead(self) -> Self {
        let extent = self.extent.map(|[least, greatest]| [-greatest, -least]);
        Self { curvature: -self.curvature, extent, ..self }
    }

    fn sagitta(self, height: f64) -> f64 {
        let c = self.curvature;
        c * height * height / (1.0 + (1.0 - (c * height).powi(2)).max(0.0).sqrt())
    }

    /// Returns the least and the greatest z of the part.
    fn extent(self) -> [f64; 2] {
        if let Some(extent) = self.extent {
            return extent;
        }
        let edge_sagitta = self.sagitta(self.semi_diameter);
        [edge_sagitta.min(0.0), edge_sagitta.max(0.0)]
    }

    /// Whether the whole part is inside a ball of curvature `ball`. The near pole of the ball is at the origin, its
    /// centre lies ahead, and the vertex of the part lies at the distance `ahead` from the pole. If `ball` is 0, the
    /// ball is the half space ahead.
    fn is_inside(self, ball: f64, ahead: f64) -> bool {
        let (height, margin) = (self.semi_diameter, MARGIN * (self.semi_diameter + ahead));
        if !(ball * height < 1.0 && ball >= 0.0) {
            return false;
        }
        // The difference of two sagittae is monotonic in height, so that testing the edge and the vertex suffices.
        let near = ClearPart { curvature: ball, semi_diameter: height, extent: None }.sagitta(height);
        let edge = ahead + self.sagitta(height);
        let inside_near = ahead > margin && edge > near + margin;
        let far = if ball > 0.0 { 2.0 / ball } else { f64::INFINITY };
        inside_near && ahead < far - margin && edge < far - near - margin
    }
}

/// Returns the tests that rays need from the part `from` to the part `to`, whose vertex lies `distance` ahead.
fn tests_between(from: ClearPart, to: ClearPart, distance: f64) -> Tests {
    // A ray that leaves `from` into a ball does not come from inside the ball, and so can meet a part inside the ball
    // only ahead. Traced backward, the same holds for the ball that the ray leaves at `to`.
    let reversed = ClearPart { curvature: -from.curvature, ..from };
    let both_balls = from.extent.or(to.extent).is_none();
    let inside = || to.is_inside(from.curvature, distance) || reversed.is_inside(-to.curvature, distance);
    let ahead = both_balls && inside();
    // If every point of `to` lies ahead in z, t and Vz have the same sign.
    let apart = leaves_room(from, to, distance);
    Tests { forward: !(ahead && apart), onward: !(ahead || apart) }
}

/// Whether all of `to` lies farther along the axis than all of `from`.
fn leaves_room(from: ClearPart, to: ClearPart, distance: f64) -> bool {
    let margin = MARGIN * (from.semi_diameter + to.semi_diameter + distance);
    distance + to.extent()[0] > from.extent()[1] + margin
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clear_part(radius: f64, semi_diameter: f64) -> ClearPart {
        ClearPart { curvature: radius.recip(), semi_diameter, extent: None }
    }

    #[test]
    fn planes_and_thick_biconvex_elements_need_no_tests() {
        let none = Tests { forward: false, onward: false };
        let plane = ClearPart { curvature: 0.0, semi_diameter: 10.0, extent: None };
        assert_eq!(tests_between(plane, plane, 0.1), none);
        assert_eq!(tests_between(clear_part(20.0, 5.0), clear_part(-20.0, 5.0), 3.0), none);
    }

    #[test]
    fn a_meniscus_needs_the_direction_and_crossing_surfaces_both() {
        assert_eq!(
            tests_between(clear_part(20.0, 8.0), clear_part(22.0, 8.0), 1.0),
            Tests { forward: true, onward: false }
        );
        // First the edges of a biconvex element that is too thin cross, then vertices touch.
        assert_eq!(
            tests_between(clear_part(20.0, 12.0), clear_part(-20.0, 12.0), 2.0),
            Tests { forward: true, onward: true }
        );
        assert_eq!(
            tests_between(clear_part(20.0, 8.0), clear_part(20.0, 8.0), 0.0),
            Tests { forward: true, onward: true }
        );
    }

    #[test]
    fn a_small_ball_proves_nothing_about_what_lies_beyond_it() {
        let beyond = tests_between(clear_part(1.0, 0.5), clear_part(-20.0, 4.0), 5.0);
        assert!(!tests_between(clear_part(1.0, 0.5), clear_part(-1.0, 0.5), 1.9).onward);
        assert!(beyond.forward || !beyond.onward);
        assert!(!clear_part(-20.0, 0.5).is_inside(1.0, 5.0));
        assert!(!clear_part(20.0, 4.0).is_inside(1.0, 0.5));
    }
}
