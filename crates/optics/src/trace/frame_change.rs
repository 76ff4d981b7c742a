//! The change of frame from one surface of a path to the next, where the surfaces do not share an axis.

use super::State;
use crate::{lens::Lens, prescription::CoordinateBreak};
use realistic_base::numeric::Real;

/// A change of frame along a path: p becomes `rotation` p + `offset`. Both frames have z along the direction of travel.
#[derive(Clone, Debug)]
pub struct FrameChange<R> {
    /// The rotation, by rows.
    pub rotation: [[R; 3]; 3],
    /// The old origin in the new frame, mm.
    pub offset: [R; 3],
}

impl<R: Real> FrameChange<R> {
    fn of(change: &CoordinateBreak) -> Self {
        Self {
            rotation: change.rotation.map(|row| row.map(R::from_f64)),
            offset: change.shift.map(R::from_f64),
        }
    }

    /// Returns a direction in the new frame.
    pub fn turned(&self, v: [R; 3]) -> [R; 3] {
        self.rotation.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// Returns a point in the new frame.
    pub fn point(&self, p: [R; 3]) -> [R; 3] {
        let turned = self.turned(p);
        std::array::from_fn(|i| turned[i] + self.offset[i])
    }

    /// Returns whether x becomes x and does not matter to y and z, and the same for y: [`Path::symmetries`](super::Path).
    pub(super) fn symmetries(&self) -> [bool; 2] {
        [0, 1].map(|axis| {
            let apart =
                |other: usize| self.rotation[axis][other] == R::ZERO && self.rotation[other][axis] == R::ZERO;
            self.offset[axis] == R::ZERO && (0..3).all(|other| other == axis || apart(other))
        })
    }

    /// Takes a ray to the new frame.
    #[inline(always)]
    pub(super) fn apply(&self, state: &mut State<R>) {
        state.p = self.point(state.p);
        state.v = self.turned(state.v);
    }
}

/// The frames of a lens along its axis, in the order of light from the scene.
struct Chain {
    /// The change in front of each surface and in front of the film, with the thickness before it; `None` on the axis.
    changes: Vec<Option<CoordinateBreak>>,
    /// The sign of the travel of light from the scene along z, in front of each surface and in front of the film.
    signs: Vec<f64>,
}

impl Chain {
    fn of(lens: &Lens) -> Self {
        let changes = lens.gaps_and_breaks().map(|(gap, own)| own.map(|own| gap.then(&own)));
        let behind =
            lens.surfaces.iter().map(|surface| if surface.is_reversed_behind() { -1.0 } else { 1.0 });
        Self { changes: changes.collect(), signs: std::iter::once(1.0).chain(behind).collect() }
    }
}

/// Returns the changes along a path through all surfaces, the last one behind the last surface. The path leads toward the
/// film if `forward`.
pub(super) fn along<R: Real>(lens: &Lens, forward: bool) -> Vec<Option<FrameChange<R>>> {
    let Chain { changes, signs } = Chain::of(lens);
    let travel = |(change, sign): (Option<CoordinateBreak>, f64)| {
        let change = change?;
        let change = if (sign > 0.0) == forward { change } else { change.mirrored() };
        Some(FrameChange::of(&if forward { change.inverse() } else { change }))
    };
    let mut all: Vec<_> = changes.into_iter().zip(signs).map(travel).collect();
    if !forward {
        all.reverse();
    }
    all
}

/// Returns, for each surface in the order of a path, the change from its frame along the direction of travel to lens
/// space.
pub(super) fn places(lens: &Lens, forward: bool) -> Vec<FrameChange<f64>> {
    let Chain { signs, .. } = Chain::of(lens);
    let frames = lens.frames();
    let mut all = Vec::with_capacity(lens.surfaces.len());
    for (i, frame) in frames.iter().enumerate().take(lens.surfaces.len()) {
        // Rays meet the surface in the medium in front of it, or behind it; a mirror is met in one medium from one side.
        let arrives_along_z = if forward { signs[i] > 0.0 } else { signs[i + 1] < 0.0 };
        let sign = if arrives_along_z { 1.0 } else { -1.0 };
        let mut place = FrameChange::<f64>::of(frame);
        for (j, row) in place.rotation.iter_mut().enumerate() {
            // z of lens space points toward the scene.
            let outer = if j == 2 { -1.0 } else { 1.0 };
            *row = [outer * row[0], outer * row[1], outer * sign * row[2]];
        }
        place.offset[2] = -place.offset[2];
        all.push(place);
    }
    if !forward {
        all.reverse();
    }
    all
}
