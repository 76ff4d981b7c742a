//! Motion of the groups as the lens focuses, at one focal length: maps a focus position to the prescription with its
//! groups at that position.

use std::ops::Range;

use crate::prescription::Prescription;
use realistic_base::numeric::Monotone;

/// A pose of the groups: their gaps, and the film distance, stop diameter and object vergence that belong to them.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    /// Gaps behind the rows that [`crate::prescription::Positions`] lists, mm.
    pub gaps: Vec<f64>,
    /// Distance of the film from the last vertex, mm; `None` if the table states none, or states 0.
    pub film_distance: Option<f64>,
    /// Clear diameter of the stop, mm; `None` for a lens without a stop.
    pub stop_diameter: Option<f64>,
    /// The reciprocal of the object's distance from the first vertex, 1/mm.
    pub vergence: f64,
}

/// Returns the prescription with its groups in a pose.
pub(super) fn at_pose(base: &Prescription, rows: &[usize], pose: &Pose) -> Prescription {
    let mut prescription = base.with_gaps(rows, &pose.gaps);
    prescription.nominal_film_distance = pose.film_distance;
    if let (Some(row), Some(diameter)) = (prescription.stop_index(), pose.stop_diameter) {
        prescription.interfaces[row].semi_diameter = diameter / 2.0;
    }
    prescription
}

/// Returns the gaps at a position, each at least its [`floor`].
pub(super) fn values(curves: &[Monotone], x: f64) -> Vec<f64> {
    curves.iter().map(|curve| curve.at(x).max(floor(curve))).collect()
}

/// Returns the minimum of a gap: 0, or -∞ if the table has negative values of it. A gap is negative beside a stop that
/// lies within the sagitta of a neighbouring surface.
fn floor(curve: &Monotone) -> f64 {
    if curve.least() < 0.0 { f64::NEG_INFINITY } else { 0.0 }
}

/// Motion of the groups of a lens as it focuses, zoomed to one focal length. The focus position is a vergence, 1/mm:
/// the reciprocal of the distance, in front of the first vertex, of the object that is in focus according to the table.
#[derive(Clone, Debug)]
pub struct FocusTravel {
    base: Prescription,
    rows: Vec<usize>,
    gaps: Vec<Monotone>,
    film_distance: Option<Monotone>,
    stop_diameter: Option<Monotone>,
    ends: [f64; 2],
}

/// Overrun of the groups beyond the first and the last position, as a fraction of the travel between them. A table's
/// film distance is rounded and comes from first-order optics; exact rays focus a little before or behind it.
const OVERRUN: f64 = 0.1;

impl FocusTravel {
    pub(super) fn new(base: Prescription, rows: Vec<usize>, poses: &[Pose]) -> Self {
        let x: Vec<f64> = poses.iter().map(|pose| pose.vergence).collect();
        let curve =
            |value: &dyn Fn(&Pose) -> f64| Monotone::new(x.clone(), poses.iter().map(value).collect());
        let known = |value: fn(&Pose) -> Option<f64>| {
            let known: Option<Vec<f64>> = poses.iter().map(value).collect();
            known.map(|values| Monotone::new(x.clone(), values))
        };
        Self {
            gaps: (0..rows.len()).map(|gap| curve(&|pose| pose.gaps[gap])).collect(),
            film_distance: known(|pose| pose.film_distance),
            stop_diameter: known(|pose| pose.stop_diameter),
            ends: [x[0], x[x.len() - 1]],
            base,
            rows,
        }
    }

    /// Returns the focus position for the farthest object of the table; 0 for infinity.
    pub fn start(&self) -> f64 {
        self.ends[0]
    }

    /// Returns whether the table states how the groups move to focus.
    pub fn is_known(&self) -> bool {
        self.ends[0] < self.ends[1]
    }

    /// Returns the focus positions for the farthest and the nearest object. Both lie a little beyond those of the
    /// table, unless a gap closes or two refracting surfaces touch first.
    pub fn range(&self) -> [f64; 2] {
        let beyond = OVERRUN * (self.ends[1] - self.ends[0]);
        [(self.ends[0], -beyond), (self.ends[1], beyond)].map(|(end, beyond)| {
            // A curve continues beyond its ends as a straight line. `share` returns the fraction of the overrun at
            // which that line reaches its minimum.
            let share = |at_end: f64, reached: f64, least: f64| {
                if reached < least { (at_end - least) / (at_end - reached) } else { 1.0 }
            };
            let gaps =
                self.gaps.iter().map(|curve| share(curve.at(end), curve.at(end + beyond), floor(curve)));
            let film =
                self.film_distance.iter().map(|curve| share(curve.at(end), curve.at(end + beyond), 0.0));
            let apart = self.base.spans().map(|span| {
                let [at_end, reached] =
                    [end, end + beyond].map(|vergence| self.length(span.clone(), vergence));
                share(at_end, reached, 0.0)
            });
            end + beyond * gaps.chain(film).chain(apart).fold(1.0, f64::min)
        })
    }

    /// Returns the sum of the thicknesses behind the rows `rows` at a focus position.
    fn length(&self, rows: Range<usize>, vergence: f64) -> f64 {
        let thickness = |row: usize| {
            let moving = self.rows.iter().position(|moving| *moving == row);
            moving.map_or(self.base.interfaces[row].thickness, |gap| self.gaps[gap].at(vergence))
        };
        rows.map(thickness).sum()
    }

    /// Returns the lens with its groups at a position of [`FocusTravel::range`].
    pub fn at(&self, vergence: f64) -> Prescription {
        let pose = Pose {
            gaps: values(&self.gaps, vergence),
            film_distance: self
                .film_distance
                .as_ref()
                .map(|curve| curve.at(vergence))
                .filter(|film| *film > 0.0),
            // Beyond the ends the iris keeps its diameter.
            stop_diameter: self
                .stop_diameter
                .as_ref()
                .map(|curve| curve.at(vergence.clamp(self.ends[0], self.ends[1]))),
            vergence,
        };
        at_pose(&self.base, &self.rows, &pose)
    }
}
