//! Marks on a lens's axis: focal points, principal planes and pupils, and the choice of those that a drawing
//! shows.

use realistic_optics::imaging::axial_beam::AxialBeam;
use realistic_optics::lens::{Lens, first_order::FirstOrder};

/// The form of a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MarkForm {
    /// A point on the axis.
    Point,
    /// A plane perpendicular to the axis.
    Plane,
    /// A pupil, with its radius in mm.
    Pupil(f64),
}

/// A named position on the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxialMark {
    /// Name of the mark.
    pub name: &'static str,
    /// z in lens space, mm.
    pub z: f64,
    /// Form of the mark.
    pub form: MarkForm,
}

/// Returns all marks of this lens that are not at infinity.
pub fn all(lens: &Lens) -> Vec<AxialMark> {
    let mut marks = Vec::new();
    if let Ok(optics) = FirstOrder::of(lens) {
        marks = vec![
            AxialMark { name: "F", z: optics.front_focal_point, form: MarkForm::Point },
            AxialMark { name: "P", z: optics.front_principal_plane, form: MarkForm::Plane },
            AxialMark { name: "P'", z: optics.rear_principal_plane, form: MarkForm::Plane },
            AxialMark { name: "F'", z: optics.rear_focal_point, form: MarkForm::Point },
        ];
    }
    let AxialBeam { entrance, exit, .. } = AxialBeam::of(lens);
    for (name, z, diameter) in [
        ("entrance pupil", entrance.position(), entrance.diameter()),
        ("exit pupil", exit.position(), exit.diameter()),
    ] {
        marks.extend(z.map(|z| AxialMark { name, z, form: MarkForm::Pupil(diameter / 2.0) }));
    }
    marks
}

/// Largest factor by which marks outside the lens and its film may lengthen a drawing.
const LONGEST: f64 = 1.7;

/// Returns the drawing's range of z: `core`, extended to outside marks, from the nearest on, up to [`LONGEST`] times
/// its length.
pub fn range(core: [f64; 2], marks: &[AxialMark]) -> [f64; 2] {
    let longest = LONGEST * (core[1] - core[0]);
    let outside = |mark: &&AxialMark| (core[0] - mark.z).max(mark.z - core[1]);
    let mut sorted: Vec<&AxialMark> = marks.iter().collect();
    sorted.sort_by(|a, b| outside(a).total_cmp(&outside(b)));
    sorted.iter().fold(core, |[low, high], mark| {
        let wider = [low.min(mark.z), high.max(mark.z)];
        if wider[1] - wider[0] <= longest { wider } else { [low, high] }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_marks_widen_the_drawing_and_far_ones_do_not() {
        let mark = |z: f64| AxialMark { name: "F", z, form: MarkForm::Point };
        assert_eq!(range([-10.0, 0.0], &[mark(-5.0), mark(4.0)]), [-10.0, 4.0]);
        assert_eq!(range([-10.0, 0.0], &[mark(400.0), mark(-12.0), mark(1.0)]), [-12.0, 1.0]);
    }
}
