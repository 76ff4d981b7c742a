//! A lens made ready for tracing in one direction. Traces rays surface by surface and reports why a ray is blocked.
//! This code, in numbers of any type, is the reference for the fast kernel.
//!
//! **Spaces.** Rays on the scene's side are given in lens space. Rays on the film's side are given in *image space*, which
//! is lens space for a lens with an axis and an even number of mirrors. In general it is the frame of the film: z points
//! from the film along the light's way back, and the last vertex, or the point to which the coordinate break in front of
//! the film leads, lies at the z of the last vertex. What lies between, such as the point where a ray is blocked, is
//! given in lens space.

use std::{
    borrow::{Borrow, Cow},
    sync::Arc,
};

use super::{
    Blocked, State,
    aperture::ApertureTest,
    frame_change::{self, FrameChange},
    surface::PathSurface,
};
use crate::lens::{Lens, Ray, refraction::Refraction};
use realistic_base::numeric::{Real, cross, difference_of_products, dot, in_range, unit};

/// Direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Travel from the film, toward +z.
    FilmToScene,
    /// Travel from the scene, toward -z.
    SceneToFilm,
}

/// Result of tracing a ray as far as it gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// The point on the last surface met, and the unit direction behind that surface. If the ray meets no surface, this
    /// is the input ray with its direction normalised.
    pub ray: Ray,
    /// Number of surfaces met.
    pub surfaces_met: usize,
    /// Optical path from the ray's origin to the last surface met, mm: the sum of lengths times indices. Lengths are
    /// negative where the ray is extended backward.
    pub optical_path: f64,
    /// The reason why the ray is blocked at the last surface, if it is.
    pub blocked: Option<Blocked>,
}

/// The intersection of a ray with a surface, as reported by [`Path::intersections`].
#[derive(Clone, Copy, Debug)]
pub struct Intersection<R> {
    /// Index of the surface, counted along the direction of travel.
    pub surface: usize,
    /// The point on the surface, x and y, mm.
    pub point: [R; 2],
    /// The square of the ratio of the point's distance from the axis to the clear semi-diameter.
    pub ratio: R,
}

/// One encounter of a path with a surface.
#[derive(Clone, Copy)]
struct Station {
    /// Index of the surface, counted along the path's direction.
    along: usize,
    /// Whether rays meet the surface against the path's direction.
    is_backward: bool,
    /// Whether the surface reflects the rays.
    is_mirror: bool,
}

/// Returns the stations of a path over `surfaces` surfaces, where consecutive stations are neighbouring surfaces.
/// Without `turns` the path meets all surfaces in turn. With `turns` it is reflected first at `turns[1]` and then at
/// `turns[0]`, which lies before `turns[1]`.
fn stations(surfaces: usize, turns: Option<[usize; 2]>) -> impl Iterator<Item = Station> + Clone {
    let [near, far] = turns.unwrap_or([surfaces; 2]);
    let is_mirror = move |along: usize, mirror: usize| turns.is_some() && along == mirror;
    let onward = move |along| Station { along, is_backward: false, is_mirror: is_mirror(along, far) };
    let back = move |along| Station { along, is_backward: true, is_mirror: is_mirror(along, near) };
    let passed = |along| Station { along, is_backward: false, is_mirror: false };
    let first = (0..surfaces.min(far + 1)).map(onward);
    first.chain((near..far).rev().map(back)).chain((near + 1..surfaces).map(passed))
}

/// A ray at a surface, as [`Path::meetings`] reports it. Coordinates are in the frame of the surface's vertex, with z
/// along the direction of travel.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// Index of the surface, counted along the path's direction.
    pub along: usize,
    /// Refractive index before the surface.
    pub n: f64,
    /// Refractive index behind the surface.
    pub n_behind: f64,
    /// Whether the ray is reflected.
    pub is_mirror: bool,
    /// The rotation, by rows, of the frame since the previous meeting; `None` if the surfaces share an axis.
    pub turned: Option<[[f64; 3]; 3]>,
    /// The point on the surface, x and y, mm.
    pub point: [f64; 2],
    /// V = n D before the surface.
    pub v: [f64; 3],
    /// Unit normal at the point, pointing to the side ahead.
    pub normal: [f64; 3],
    /// Distance from the previous meeting, mm; 0 at the first.
    pub distance: f64,
    /// The transmission of a picture in the surface at the point; 1 without a picture.
    pub transmission: f64,
}

/// A description of one step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepKind {
    /// Index of the lens surface, counted from the scene.
    pub surface: usize,
    /// Refractive index before the surface.
    pub n: f64,
    /// Refractive index behind the surface. This also holds for a mirror, behind which the ray does not go.
    pub n_behind: f64,
    /// Whether the ray is reflected.
    pub is_mirror: bool,
}

/// Squared cosine of a ray's angle to the axis. Below this value, the ray meets the first vertex plane too far out to
/// start from there.
const STEEP: f64 = 0.01;

/// [`PathSurface::slack`] of surfaces that touch: larger than the distance of any hit behind a ray. An infinite value
/// would become NaN in double-double numbers.
const TOUCHING: f64 = 1e30;

/// A lens made ready for tracing in one direction with numbers of type `R`.
#[derive(Clone, Debug)]
pub struct Path<R = f64> {
    pub(super) steps: Vec<PathSurface<R>>,
    pub(super) direction: Direction,
    pub(super) refraction: Refraction,
    /// The z coordinate, in lens space, of the first vertex met.
    pub(super) entry: f64,
    /// The z coordinate, in lens space, of the last vertex met.
    pub(super) exit: f64,
    /// The change of frame behind the last surface; `None` on the axis.
    pub(super) leaving: Option<Arc<FrameChange<R>>>,
    /// The changes from the frames of the steps to lens space, if the surfaces do not share an axis or one is a mirror
    /// of the lens.
    pub(super) places: Option<Arc<[FrameChange<f64>]>>,
}

impl<R: Real> Path<R> {
    /// Prepares `lens` for rays in `direction`, refracted by the method `refraction`.
    pub fn new(lens: &Lens, direction: Direction, refraction: Refraction) -> Self {
        Self::over(lens, direction, refraction, stations(lens.surfaces.len(), None))
    }

    /// Builds a path that is reflected twice: at the surface `turns[1]`, counted along the direction of travel, and
    /// then, on the way back, at the surface `turns[0]`, which lies before `turns[1]`. The path meets all surfaces
    /// between the two mirrors three times.
    ///
    /// A reflection is a refraction with n' = -n. Because z is measured along the direction of travel, the frame turns
    /// round at a mirror, and the path meets the surfaces between the mirrors as rays of the opposite direction do.
    /// Every test of a ray is then the same as on a path without mirrors. A ray that turns by more than 90 degrees is
    /// [`Blocked::TurnedBack`].
    ///
    /// # Panics
    /// Panics if `turns[0] < turns[1]` does not hold, or `turns[1]` is not a surface of the lens.
    pub fn reflected(lens: &Lens, direction: Direction, refraction: Refraction, turns: [usize; 2]) -> Self {
        let [near, far] = turns;
        assert!(
            near < far && far < lens.surfaces.len(),
            "a ghost turns back at a surface, and again before it"
        );
        assert!(lens.is_round(), "ghosts need a lens with an axis and without mirrors");
        Self::over(lens, direction, refraction, stations(lens.surfaces.len(), Some(turns)))
    }

    /// Builds a path that meets the surfaces in the order `order`. Consecutive surfaces in `order` are neighbours.
    fn over(
        lens: &Lens,
        direction: Direction,
        refraction: Refraction,
        order: impl Iterator<Item = Station>,
    ) -> Self {
        let forward = direction == Direction::SceneToFilm;
        let mut surfaces: Vec<_> = lens.surfaces.iter().collect();
        if !forward {
            surfaces.reverse();
        }
        // Distance between a surface and the surface before it along the direction. The distance is the thickness
        // stored in whichever of the two is on the scene's side.
        let gap = |along: usize| surfaces[if forward { along - 1 } else { along }].distance_behind();
        // The flag for contact between two neighbours is stored in the surface on the film's side.
        let touch = |a: usize, b: usize| surfaces[if forward { a.max(b) } else { a.min(b) }].is_contact;
        let (mut last, mut last_bent) = (None, None);
        let is_folded = !lens.is_round();
        let mut changes = if is_folded { frame_change::along(lens, forward) } else { Vec::new() };
        let mut change = |at: usize| changes.get_mut(at).and_then(Option::take).map(Arc::new);
        let steps: Vec<_> = order
            .map(|Station { along, is_backward, is_mirror }| {
                let distance = last.replace(along).map_or(0.0, |last: usize| gap(last.max(along)));
                let mut step = PathSurface::new(surfaces[along], forward != is_backward, distance);
                if !step.only_limits() && last_bent.replace(along).is_some_and(|last| touch(last, along)) {
                    step.slack = R::from_f64(TOUCHING);
                }
                step.change = change(along);
                if step.change.is_some() {
                    step.distance = R::ZERO;
                }
                let (along, step) = (along, PathSurface { is_backward, ..step });
                PathSurface { along, ..if is_mirror { step.mirror() } else { step } }
            })
            .collect();
        let leaving = change(steps.len());
        let places = is_folded.then(|| frame_change::places(lens, forward).into());
        let (entry, exit) = (surfaces[0].vertex, surfaces[surfaces.len() - 1].vertex);
        Self { steps, direction, refraction, entry, exit, leaving, places }
    }

    /// Returns the same path with the tests of the apertures and obstructions of `lens`, which is the lens of the
    /// path.
    #[must_use]
    pub fn with_apertures(mut self, lens: &Lens) -> Self {
        let last = lens.surfaces.len() - 1;
        for step in &mut self.steps {
            let surface = match self.direction {
                Direction::FilmToScene => &lens.surfaces[last - step.along],
                Direction::SceneToFilm => &lens.surfaces[step.along],
            };
            let test = |aperture| ApertureTest::new(aperture, surface.semi_diameter);
            step.apertures = surface.apertures.iter().map(test).collect();
        }
        self
    }

    /// Returns the same path with circles about the axis as its only apertures, each around all that the apertures of the
    /// surface pass. Searches of the edge of a pupil need a path of revolution. A circle is an overestimate, but of most
    /// shapes a good one.
    #[must_use]
    pub fn with_circles(mut self) -> Self {
        for step in &mut self.steps {
            let apertures = step.apertures.iter().filter(|test| !test.is_obstruction);
            let squares = apertures.map(|test| test.reach * test.reach);
            step.aperture =
                squares.fold(step.aperture, |least, square| if square < least { square } else { least });
            step.apertures = Arc::default();
        }
        self
    }

    /// Returns the same path without any test that could clip a ray.
    #[must_use]
    pub fn without_edges(mut self) -> Self {
        for step in &mut self.steps {
            (step.aperture, step.apertures) = (R::from_f64(f64::INFINITY), Arc::default());
        }
        self
    }

    /// Whether the path tests apertures or obstructions other than clear apertures.
    pub fn has_apertures(&self) -> bool {
        self.steps.iter().any(|step| !step.apertures.is_empty())
    }

    /// Returns the same path up to and including its first mirror; `None` if the path has no mirror.
    pub fn up_to_mirror(&self) -> Option<Self> {
        let mirror = self.steps.iter().position(|step| step.is_mirror)?;
        let steps = self.steps[..=mirror].to_vec();
        let length: f64 = steps.iter().map(|step| step.distance.to_f64()).sum();
        let exit = self.entry + self.travel_sign() * length;
        Some(Self { steps, exit, leaving: None, places: None, ..*self })
    }

    /// Estimates the time for a ray, in units of the time for a sphere or plane. An asphere usually takes ten times as
    /// long.
    pub fn work(&self) -> usize {
        self.surfaces() + 9 * self.aspheres()
    }

    /// Returns the number of surfaces that are neither spheres nor planes.
    pub fn aspheres(&self) -> usize {
        self.steps.iter().filter(|step| step.aspheric.is_some()).count()
    }

    /// Returns the number of surfaces that the path meets.
    pub fn surfaces(&self) -> usize {
        self.steps.len()
    }

    /// Returns the surfaces in the order in which the path meets them.
    pub fn steps(&self) -> &[PathSurface<R>] {
        &self.steps
    }

    /// Builds a path from film to scene with the default refraction.
    pub fn film_to_scene(lens: &Lens) -> Self {
        Self::new(lens, Direction::FilmToScene, Refraction::default())
    }

    /// Builds a path from scene to film with the default refraction.
    pub fn scene_to_film(lens: &Lens) -> Self {
        Self::new(lens, Direction::SceneToFilm, Refraction::default())
    }

    /// Traces a ray through the lens. The origin of the ray may lie anywhere before the first surface. A ray with NaN
    /// or infinite components, or with a direction of length 0, is [`Blocked::Missed`].
    pub fn walk(&self, ray: Ray) -> Walk {
        self.walk_by(ray, |_, _| ())
    }

    /// Traces a ray as [`Path::walk`] does, and also reports every surface met. `met` receives the index of the
    /// surface, counted along the direction of travel, and the point on the surface in lens space. The last surface
    /// reported may be the one that blocks the ray.
    pub fn walk_by(&self, ray: Ray, mut met: impl FnMut(usize, [f64; 3])) -> Walk {
        let travel_sign = self.travel_sign();
        let start = Ray { origin: ray.origin, direction: unit(ray.direction) };
        let finite = start.origin.iter().chain(&start.direction).all(|x| x.is_finite());
        if !finite {
            return Walk { ray: start, surfaces_met: 0, optical_path: 0.0, blocked: Some(Blocked::Missed) };
        }
        let mut state = self.enter(ray, start.direction, self.steps[0].n);
        let (mut point, mut passed) = (start.origin, 0.0);
        let (surfaces_met, blocked) = self.trace_surfaces(&self.steps, &mut state, |number, step, state| {
            let sign = if step.is_backward { -1.0 } else { 1.0 };
            passed += sign * step.distance.to_f64();
            let is_last = number + 1 == self.steps.len();
            let vertex = if is_last { self.exit } else { self.entry + travel_sign * passed };
            let [x, y, z] = state.p.map(R::to_f64);
            point = match &self.places {
                None => [x, y, vertex + travel_sign * (sign * z)],
                Some(places) => places[number].point([x, y, z]),
            };
            met(number, point);
        });
        if surfaces_met == 0 {
            return Walk { ray: start, surfaces_met, optical_path: 0.0, blocked };
        }
        let optical_path = state.path.to_f64();
        if let Some(places) = &self.places {
            let ray = match blocked {
                None => self.left(state),
                Some(reason) => {
                    let (last, place) = (&self.steps[surfaces_met - 1], &places[surfaces_met - 1]);
                    let [vx, vy, vz] = state.v.map(R::to_f64);
                    let is_turned = last.is_mirror && reason != Blocked::Clipped;
                    let v = place.turned([vx, vy, if is_turned { -vz } else { vz }]);
                    Ray { origin: point, direction: unit(v) }
                }
            };
            return Walk { ray, surfaces_met, optical_path, blocked };
        }
        let [vx, vy, vz] = state.v.map(R::to_f64);
        let last = &self.steps[surfaces_met - 1];
        // A ray clipped at a mirror still has the direction before the reflection.
        let is_turned = last.is_backward != (last.is_mirror && blocked != Some(Blocked::Clipped));
        let travel_sign = if is_turned { -travel_sign } else { travel_sign };
        let ray = Ray { origin: point, direction: unit([vx, vy, travel_sign * vz]) };
        Walk { ray, surfaces_met, optical_path, blocked }
    }

    /// Traces a ray through the lens in the number type `R` from start to end, for types wider than double. Returns the
    /// point, in the frame of the last vertex met (with z along +z of lens space), the unit direction, and the optical
    /// path from `origin` to the point, mm.
    ///
    /// # Errors
    /// The reason why the ray is blocked.
    pub fn trace_in_full(&self, origin: [R; 3], direction: [R; 3]) -> Result<([R; 3], [R; 3], R), Blocked> {
        let travel_sign = R::from_f64(self.travel_sign());
        let [dx, dy, dz] = direction;
        let length = dot(direction, direction).sqrt();
        let [x, y, z] = origin;
        let mut state = State {
            p: [x, y, travel_sign * (z - R::from_f64(self.entry))],
            v: [dx, dy, travel_sign * dz].map(|d| self.steps[0].n * d / length),
            lead: R::ZERO,
            path: R::ZERO,
        };
        if let (_, Some(reason)) = self.trace_surfaces(&self.steps, &mut state, |_, _, _| ()) {
            return Err(reason);
        }
        if let Some(leaving) = &self.leaving {
            leaving.apply(&mut state);
        }
        let [x, y, z] = state.p;
        let [vx, vy, vz] = state.v;
        let length = dot(state.v, state.v).sqrt();
        Ok(([x, y, travel_sign * z], [vx / length, vy / length, travel_sign * vz / length], state.path))
    }

    /// Traces the state, in the frame of the first vertex, through the surfaces of `steps`. Returns the number of
    /// surfaces met and the reason why the ray is blocked, if it is. Each surface updates the state completely or not
    /// at all. A blocked ray therefore keeps its last point on a surface, in the frame of that surface's vertex. For
    /// every surface met, `met` receives the number of the step, the step, and the state on the surface before
    /// refraction.
    fn trace_surfaces<S: Borrow<PathSurface<R>>>(
        &self,
        steps: impl IntoIterator<Item = S>,
        state: &mut State<R>,
        mut met: impl FnMut(usize, &PathSurface<R>, &State<R>),
    ) -> (usize, Option<Blocked>) {
        let mut passed = 0;
        for (number, step) in steps.into_iter().enumerate() {
            let step = step.borrow();
            let mut ahead = *state;
            step.enter_frame(&mut ahead);
            let from = ahead.p;
            let hit = if self.is_forward(&ahead, number) {
                step.meet(&mut ahead)
            } else {
                Err(Blocked::TurnedBack)
            };
            if let Err(reason) = hit {
                return (number, Some(reason));
            }
            // V = n D, so that the component of V along the way is n.
            let moved: [R; 3] = std::array::from_fn(|i| ahead.p[i] - from[i]);
            ahead.path = ahead.path + dot(moved, ahead.v);
            *state = ahead;
            met(number, step, state);
            if let Err(reason) = step.pass(state, self.refraction) {
                return (number + 1, Some(reason));
            }
            passed = number + 1;
        }
        (passed, None)
    }

    /// Returns the sign of the direction of travel along z.
    pub(super) fn travel_sign(&self) -> f64 {
        match self.direction {
            Direction::FilmToScene => 1.0,
            Direction::SceneToFilm => -1.0,
        }
    }

    /// Returns whether a ray may go on to surface `number`. The field of a fisheye may exceed 180 degrees, so that a
    /// ray from the scene may meet the first surface while the ray travels backward.
    pub(super) fn is_forward(&self, state: &State<R>, number: usize) -> bool {
        state.v[2] > R::ZERO || self.may_start_backward(number)
    }

    /// Returns whether a ray that travels backward may go on to surface `number`.
    pub(super) fn may_start_backward(&self, number: usize) -> bool {
        number == 0 && self.direction == Direction::SceneToFilm
    }

    /// Returns the state of a ray at its start in a medium of index `n`, in the frame of the first vertex. `direction`
    /// is the ray's direction as a unit vector.
    pub(super) fn enter(&self, ray: Ray, direction: [f64; 3], n: R) -> State<R> {
        let travel_sign = self.travel_sign();
        let (entry, lead) = self.to_entry(ray);
        let [dx, dy, dz] = direction;
        State {
            p: entry.map(R::from_f64),
            v: [dx, dy, travel_sign * dz].map(|d| n * R::from_f64(d)),
            lead: R::from_f64(lead) / n,
            path: R::from_f64(lead) * n,
        }
    }

    /// Returns a point of the ray near the lens, in the frame of the first vertex with z along the direction of travel,
    /// and the distance of that point from the ray's origin, both in mm. `ray` is in lens space, with a direction of
    /// any nonzero length. If the vertex plane lies ahead and the ray is not too steep (`STEEP`), the point is on that
    /// plane. Otherwise it is the point nearest the vertex if that point lies ahead, and else the ray's origin.
    ///
    /// Uses differences of products instead of P + t D. For a distant object, P + t D is only as precise as the
    /// distance allows; the differences are as precise as the lens.
    pub fn to_entry(&self, ray: Ray) -> ([f64; 3], f64) {
        let travel_sign = self.travel_sign();
        let [x, y, z] = ray.origin;
        // The difference and its rounding error (D. E. Knuth, *The Art of Computer Programming* 2, section 4.2.2). The
        // error matters for a small lens far from its front vertex.
        let (far, near) = (travel_sign * z, travel_sign * self.entry);
        let z = far - near;
        let taken = z - far;
        let lost = (far - (z - taken)) - (near + taken);
        let start = [x, y, z];
        let [dx, dy, dz] = in_range(ray.direction);
        let d = [dx, dy, travel_sign * dz];
        let squared = dot(d, d);
        let entry = if z < 0.0 && d[2] > 0.0 && d[2] * d[2] > STEEP * squared {
            let at = |p: f64, along: f64| (difference_of_products(p, d[2], z, along) - lost * along) / d[2];
            [at(x, d[0]), at(y, d[1]), 0.0]
        } else if dot(start, d) < 0.0 {
            let moment = cross(start, d);
            let moment = [moment[0] - lost * d[1], moment[1] + lost * d[0], moment[2]];
            cross(d, moment).map(|product| product / squared)
        } else {
            return (start, 0.0);
        };
        let moved: [f64; 3] = std::array::from_fn(|i| entry[i] - start[i]);
        (entry, dot(moved, moved).sqrt())
    }

    /// Returns the z coordinate of the first vertex met, in lens space, mm.
    pub fn entry(&self) -> f64 {
        self.entry
    }

    /// Returns the z coordinate of the last vertex met, in lens space, mm.
    pub fn exit(&self) -> f64 {
        self.exit
    }

    /// Returns the change of frame behind the last surface; `None` on the axis.
    pub fn leaving(&self) -> Option<&FrameChange<R>> {
        self.leaving.as_deref()
    }

    /// Returns whether the lens is symmetric in x, and in y, but for shaped apertures: whether the reflection of a ray in
    /// the plane x = 0, or y = 0, passes where the ray does.
    pub fn symmetries(&self) -> [bool; 2] {
        let changes = self.steps.iter().filter_map(|step| step.change.as_deref()).chain(self.leaving());
        changes
            .map(FrameChange::symmetries)
            .fold([true; 2], |[x, y], [own_x, own_y]| [x && own_x, y && own_y])
    }

    /// Returns the direction of travel.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Returns the steps of the path, in order.
    pub fn step_kinds(&self) -> impl Iterator<Item = StepKind> {
        let surfaces = self.steps.iter().map(|step| step.along).max().map_or(0, |last| last + 1);
        self.steps.iter().map(move |step| StepKind {
            surface: match self.direction {
                Direction::FilmToScene => surfaces - 1 - step.along,
                Direction::SceneToFilm => step.along,
            },
            n: step.n.to_f64(),
            n_behind: step.n_behind,
            is_mirror: step.is_mirror,
        })
    }

    /// Returns x and y, in the frame of its own vertex, of the point where a ray meets surface `number` of the path, mm;
    /// `None` if the ray is blocked before.
    pub fn meeting_point(&self, ray: Ray, number: usize) -> Option<[f64; 2]> {
        let direction = unit(ray.direction);
        let mut state = self.enter(ray, direction, self.steps[0].n);
        let mut point = None;
        self.trace_surfaces(&self.steps[..=number], &mut state, |met, _, state| {
            let [x, y, _] = state.p.map(R::to_f64);
            point = (met == number).then_some([x, y]);
        });
        point.filter(|point| point.iter().all(|part| part.is_finite()))
    }

    /// Returns the point where a ray meets the first surface, in lens space, mm; `None` if the ray misses the surface.
    pub fn first_point(&self, ray: Ray) -> Option<[f64; 3]> {
        let direction = unit(ray.direction);
        let first = &self.steps[0];
        let mut state = self.enter(ray, direction, first.n);
        first.enter_frame(&mut state);
        let is_met = self.is_forward(&state, 0) && first.meet(&mut state).is_ok();
        let [x, y, z] = state.p.map(R::to_f64);
        let point = match &self.places {
            None => [x, y, self.entry + self.travel_sign() * z],
            Some(places) => places[0].point([x, y, z]),
        };
        (is_met && point.iter().all(|part| part.is_finite())).then_some(point)
    }

    /// Returns the point (x, y) of the first surface, given in the frame of its vertex, and the normal there that points
    /// against the light, with a component of length 1 along the axis of the surface; both in lens space. `None` where
    /// the surface ends, or if this path is one from the film.
    pub fn first_surface_at(&self, [x, y]: [f64; 2]) -> Option<([f64; 3], [f64; 3])> {
        let first = &self.steps[0];
        let [x, y] = [x, y].map(R::from_f64);
        let z = first.height([x, y]);
        let [nx, ny, nz] = first.normal([x, y, z]);
        let point = [x, y, z].map(R::to_f64);
        let normal = [-(nx / nz), -(ny / nz), -R::ONE].map(R::to_f64);
        let is_there = self.direction == Direction::SceneToFilm && point.iter().all(|part| part.is_finite());
        let [px, py, pz] = point;
        let (point, normal) = match &self.places {
            None => ([px, py, self.entry - pz], [normal[0], normal[1], -normal[2]]),
            Some(places) => (places[0].point(point), places[0].turned(normal)),
        };
        is_there.then_some((point, normal))
    }

    /// Traces a ray as [`Path::trace`] does, and also reports each meeting of the ray with a surface, before the
    /// surface refracts or reflects the ray. `steps` are the path's own or other steps through the same lens. The
    /// reports are complete only for a ray that gets through.
    ///
    /// # Errors
    /// The reason why the ray is blocked.
    #[inline]
    pub fn meetings<S: Borrow<PathSurface<R>>>(
        &self,
        steps: impl IntoIterator<Item = S>,
        ray: Ray,
        mut met: impl FnMut(Meeting),
    ) -> Result<Ray, Blocked> {
        let direction = unit(ray.direction);
        if !ray.origin.iter().chain(&direction).all(|x| x.is_finite()) {
            return Err(Blocked::Missed);
        }
        let mut steps = steps.into_iter().peekable();
        let Some(n) = steps.peek().map(|step| step.borrow().n) else { return Err(Blocked::Missed) };
        let mut state = self.enter(ray, direction, n);
        // The point of the previous meeting, in the frame of that surface's vertex, with z along the direction of
        // travel behind the surface.
        let mut last: Option<[R; 3]> = None;
        let (_, blocked) = self.trace_surfaces(steps, &mut state, |_, step, state| {
            let normal = step.normal(state.p).map(R::to_f64);
            let [x, y, z] = state.p.map(R::to_f64);
            let from = |last: [R; 3]| {
                let mut start = State { p: last, v: last, lead: R::ZERO, path: R::ZERO };
                step.enter_frame(&mut start);
                let [x0, y0, z0] = start.p.map(R::to_f64);
                let d = [x - x0, y - y0, z - z0];
                dot(d, d).sqrt()
            };
            let distance = last.map_or(0.0, from);
            let [px, py, pz] = state.p;
            last = Some([px, py, if step.is_mirror { -pz } else { pz }]);
            let point = [state.p[0], state.p[1]];
            let transmission = step.apertures.iter().map(|aperture| aperture.transmission(point)).product();
            let PathSurface { along, n_behind, is_mirror, .. } = *step;
            let (n, v) = (step.n.to_f64(), state.v.map(R::to_f64));
            let turned = step.change.as_ref().map(|change| change.rotation.map(|row| row.map(R::to_f64)));
            let point = [x, y];
            met(Meeting { along, n, n_behind, is_mirror, turned, point, v, normal, distance, transmission });
        });
        if let Some(reason) = blocked {
            return Err(reason);
        }
        Ok(self.left(state))
    }

    /// Returns a ray behind the last surface in the space on that side.
    fn left(&self, mut state: State<R>) -> Ray {
        if let Some(leaving) = &self.leaving {
            leaving.apply(&mut state);
        }
        let ([x, y, z], [vx, vy, vz]) = (state.p.map(R::to_f64), state.v.map(R::to_f64));
        let travel_sign = self.travel_sign();
        let origin = [x, y, self.exit + travel_sign * z];
        Ray { origin, direction: unit([vx, vy, travel_sign * vz]) }
    }

    /// Returns the ray as it leaves the lens.
    ///
    /// # Errors
    /// The reason why the ray is blocked.
    pub fn trace(&self, ray: Ray) -> Result<Ray, Blocked> {
        let walk = self.walk(ray);
        walk.blocked.map_or(Ok(walk.ray), Err)
    }

    /// Traces a ray from (`x`, `y`) on a film at z = `film`, with these slopes, through all surfaces. Apertures are
    /// ignored, and tracing continues while `go_on` returns true. Returns whether the ray leaves the last surface.
    pub fn intersections(
        &self,
        film: f64,
        [x, y]: [R; 2],
        [sx, sy]: [R; 2],
        mut go_on: impl FnMut(Intersection<R>) -> bool,
    ) -> bool {
        let moved = R::from_f64(self.travel_sign() * (self.entry - film));
        let length = (R::ONE + sx * sx + sy * sy).sqrt();
        let n = self.steps[0].n;
        let vz = n / length;
        let mut state = State {
            p: [x + moved * sx, y + moved * sy, R::ZERO],
            v: [sx * vz, sy * vz, vz],
            lead: moved * length / n,
            path: moved * length * n,
        };
        self.steps.iter().enumerate().all(|(surface, step)| {
            step.enter_frame(&mut state);
            if !self.is_forward(&state, surface) || step.meet(&mut state).is_err() {
                return false;
            }
            let [x, y, _] = state.p;
            let ratio = (x * x + y * y) / step.aperture;
            go_on(Intersection { surface, point: [x, y], ratio })
                && step.refract(&mut state, self.refraction).is_ok()
        })
    }
}

/// All paths through a lens in one direction with no reflection or with two. They are built from two lists: the
/// surfaces as rays meet them along that direction, and the surfaces as rays meet them against it. A path is a sequence
/// of elements of these lists, so that all paths together take the memory of two paths.
#[derive(Clone, Debug)]
pub struct FoldedPaths {
    direct: Path,
    /// The surfaces as rays meet them against the path's direction, but in the order of that direction.
    back: Vec<PathSurface<f64>>,
}

impl FoldedPaths {
    /// Prepares `lens`, with its apertures and obstructions, for rays in `direction`.
    pub fn new(lens: &Lens, direction: Direction, refraction: Refraction) -> Self {
        let direct = Path::new(lens, direction, refraction).with_apertures(lens);
        let count = lens.surfaces.len();
        // A path with mirrors at both ends meets the surfaces from one mirror to the other backward.
        let mut back = direct.steps.clone();
        if count > 1 && lens.is_round() {
            let folded = Path::reflected(lens, direction, refraction, [0, count - 1]).with_apertures(lens);
            for step in folded.steps.into_iter().filter(|step| step.is_backward) {
                let along = step.along;
                back[along] = step;
            }
        }
        Self { direct, back }
    }

    /// Returns the path without a reflection.
    pub fn direct(&self) -> &Path {
        &self.direct
    }

    /// Returns the steps of a path with the reflections `turns`, as in [`Path::reflected`]. Without `turns`, returns
    /// the steps of the path without a reflection.
    pub fn steps(&self, turns: Option<[usize; 2]>) -> impl Iterator<Item = Cow<'_, PathSurface<f64>>> {
        stations(self.direct.steps.len(), turns).map(|Station { along, is_backward, is_mirror }| {
            let step = if is_backward { &self.back[along] } else { &self.direct.steps[along] };
            if is_mirror { Cow::Owned(step.clone().mirror()) } else { Cow::Borrowed(step) }
        })
    }

    /// Returns a separate path with the reflections `turns`.
    pub fn path(&self, turns: Option<[usize; 2]>) -> Path {
        Path { steps: self.steps(turns).map(Cow::into_owned).collect(), ..self.direct.clone() }
    }
}
