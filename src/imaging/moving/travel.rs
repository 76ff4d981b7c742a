//! The motion of the groups as the lens focuses, at one focal length: a place on the way in, the prescription with its groups
//! there out.

use std::ops::Range;

use crate::{numeric::Monotone, prescription::Prescription};

/// The gaps of the groups, with the film, the stop and the object that belong to them.
#[derive(Clone, Debug)]
pub(super) struct Stand {
    /// The gaps in mm, of the rows that [`crate::prescription::Positions`] lists.
    pub gaps: Vec<f64>,
    /// From the last vertex, mm; `None` where the table has none, or 0.
    pub film_distance: Option<f64>,
    /// Clear diameter, mm; `None` for a lens without a stop.
    pub stop_diameter: Option<f64>,
    /// 1 over the object's distance from the first vertex.
    pub vergence: f64,
}

/// The prescription with its groups where a position has them.
pub(super) fn placed(base: &Prescription, rows: &[usize], stand: &Stand) -> Prescription {
    let mut prescription = base.with_gaps(rows, &stand.gaps);
    prescription.nominal_film_distance = stand.film_distance;
    if let (Some(row), Some(diameter)) = (prescription.stop_index(), stand.stop_diameter) {
        prescription.interfaces[row].semi_diameter = diameter / 2.0;
    }
    prescription
}

/// The gaps at a place, no less than [`floor`].
pub(super) fn values(curves: &[Monotone], x: f64) -> Vec<f64> {
    curves.iter().map(|curve| curve.at(x).max(floor(curve))).collect()
}

/// The least that a gap may be: 0, or without a bound beside a stop that stands inside its neighbour's bulge in the table, too.
fn floor(curve: &Monotone) -> f64 {
    if curve.least() < 0.0 { f64::NEG_INFINITY } else { 0.0 }
}

/// The motion of the groups of a lens as it focuses, zoomed to one focal length. A place on the way is named by the vergence, 1/mm
/// in front of the first vertex, of the object that the table states for it.
#[derive(Clone, Debug)]
pub struct FocusTravel {
    base: Prescription,
    rows: Vec<usize>,
    gaps: Vec<Monotone>,
    film_distance: Option<Monotone>,
    stop_diameter: Option<Monotone>,
    ends: [f64; 2],
}

/// The overrun of the groups beyond the first and the last position, as a share of the way between them: a table's film
/// distance is rounded and first-order optics', and exact rays are in focus a little before or behind it.
const OVERRUN: f64 = 0.1;

impl FocusTravel {
    pub(super) fn new(base: Prescription, rows: Vec<usize>, stands: &[Stand]) -> Self {
        let x: Vec<f64> = stands.iter().map(|stand| stand.vergence).collect();
        let curve =
            |value: &dyn Fn(&Stand) -> f64| Monotone::new(x.clone(), stands.iter().map(value).collect());
        let known = |value: fn(&Stand) -> Option<f64>| {
            let known: Option<Vec<f64>> = stands.iter().map(value).collect();
            known.map(|values| Monotone::new(x.clone(), values))
        };
        Self {
            gaps: (0..rows.len()).map(|gap| curve(&|stand| stand.gaps[gap])).collect(),
            film_distance: known(|stand| stand.film_distance),
            stop_diameter: known(|stand| stand.stop_diameter),
            ends: [x[0], x[x.len() - 1]],
            base,
            rows,
        }
    }

    /// The place for the farthest object that the table has, 0 for infinity.
    pub fn start(&self) -> f64 {
        self.ends[0]
    }

    /// Whether the table says how the groups move to focus.
    pub fn is_known(&self) -> bool {
        self.ends[0] < self.ends[1]
    }

    /// The places from the farthest to the nearest, both a little beyond the table's as far as no gap closes and no two
    /// surfaces that bend rays touch.
    pub fn range(&self) -> [f64; 2] {
        let beyond = OVERRUN * (self.ends[1] - self.ends[0]);
        [(self.ends[0], -beyond), (self.ends[1], beyond)].map(|(end, beyond)| {
            // Beyond its ends a curve is a line: the share of the way after which it is at its least.
            let share = |at_end: f64, reached: f64, least: f64| {
                if reached < least { (at_end - least) / (at_end - reached) } else { 1.0 }
            };
            let gaps =
                self.gaps.iter().map(|curve| share(curve.at(end), curve.at(end + beyond), floor(curve)));
            let film =
                self.film_distance.iter().map(|curve| share(curve.at(end), curve.at(end + beyond), 0.0));
            let apart = self.base.spans().map(|span| {
                let [at_end, reached] = [end, end + beyond].map(|place| self.length(span.clone(), place));
                share(at_end, reached, 0.0)
            });
            end + beyond * gaps.chain(film).chain(apart).fold(1.0, f64::min)
        })
    }

    /// The sum of the thicknesses behind some rows at a place.
    fn length(&self, rows: Range<usize>, place: f64) -> f64 {
        let thickness = |row: usize| {
            let moving = self.rows.iter().position(|moving| *moving == row);
            moving.map_or(self.base.interfaces[row].thickness, |gap| self.gaps[gap].at(place))
        };
        rows.map(thickness).sum()
    }

    /// The lens with its groups at a place of [`FocusTravel::range`].
    pub fn at(&self, place: f64) -> Prescription {
        let stand = Stand {
            gaps: values(&self.gaps, place),
            film_distance: self
                .film_distance
                .as_ref()
                .map(|curve| curve.at(place))
                .filter(|film| *film > 0.0),
            // The iris is what it is at the ends.
            stop_diameter: self
                .stop_diameter
                .as_ref()
                .map(|curve| curve.at(place.clamp(self.ends[0], self.ends[1]))),
            vergence: place,
        };
        placed(&self.base, &self.rows, &stand)
    }
}
