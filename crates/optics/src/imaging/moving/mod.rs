//! Lenses with moving groups. Interpolates between the positions that a prescription lists, to any focal length between
//! them and to any focus distance within the groups' travel.
//!
//! Between the columns of the table, gaps follow monotone cubic curves ([`Monotone`]). Their argument is the logarithm
//! of the focal length for zooming, and the object's vergence (1/distance from the first vertex) for focusing. At a
//! column the gaps equal the table to the last bit. First-order optics at the d line determines the zoom position of a
//! focal length, because the groups' positions do not depend on the wavelength of the light.

mod error;
#[cfg(test)]
mod tests;
mod travel;

pub use error::MovingError;
pub use travel::FocusTravel;

use super::axial_beam::semi_diameter_for_beam;
use crate::{
    lens::{Lens, first_order::FirstOrder},
    prescription::{Layout, Positions, Prescription},
};
use realistic_base::numeric::{Monotone, root};
use travel::{Pose, at_pose, values};

/// A lens with moving groups, at the positions that its table lists.
#[derive(Clone, Debug)]
pub struct MovingGroups<'a> {
    prescription: &'a Prescription,
    positions: &'a Positions,
    layout: Layout,
    /// Poses of the groups, one for each column.
    poses: Vec<Pose>,
    /// First-order optics of each zoom position, focused on the farthest object; `None` if the lens is afocal there.
    optics: Vec<Option<FirstOrder>>,
}

/// Largest relative difference between a stated focal length and the computed focal length at which the stated one is
/// accepted.
const ROUNDED: f64 = 0.01;

impl<'a> MovingGroups<'a> {
    /// Returns the moving groups of a prescription; `None` if nothing moves.
    pub fn of(prescription: &'a Prescription) -> Option<Self> {
        let positions = prescription.positions.as_ref()?;
        let layout = positions.layout();
        let poses = positions.columns.iter().map(|column| {
            let last = prescription.interfaces.len() - 1;
            let moved = positions.gaps.iter().position(|&row| row == last).map(|i| column.gaps[i]);
            Pose {
                gaps: column.gaps.clone(),
                film_distance: moved
                    .or(prescription.nominal_film_distance)
                    .filter(|distance| *distance > 0.0),
                stop_diameter: prescription.stop_index().map(|row| {
                    column.stop_diameter.unwrap_or(2.0 * prescription.interfaces[row].semi_diameter)
                }),
                vergence: column.vergence(),
            }
        });
        let mut groups = Self { prescription, positions, layout, poses: poses.collect(), optics: Vec::new() };
        for zoom in 0..layout.zooms {
            let lens = Lens::at_d_line(&groups.at_pose(&groups.poses[zoom]));
            let optics = FirstOrder::of(&lens).ok();
            if layout.zooms > 1
                && let Some(optics) = optics
            {
                groups.widen_to_fnumber(zoom, &lens, optics.focal_length.abs());
            }
            groups.optics.push(optics);
        }
        Some(groups)
    }

    /// Sets the stop diameter of a zoom position to the diameter that gives the stated f-number, at all object
    /// distances for which the table states no diameter.
    fn widen_to_fnumber(&mut self, zoom: usize, lens: &Lens, focal_length: f64) {
        let column = &self.positions.columns[zoom];
        if let (None, Some(fnumber), Some(stop)) = (column.stop_diameter, column.fnumber, lens.stop_index()) {
            let diameter = 2.0 * semi_diameter_for_beam(lens, stop, focal_length / fnumber);
            for step in 0..self.layout.steps {
                let column = self.layout.column(zoom, step);
                if self.positions.columns[column].stop_diameter.is_none() {
                    self.poses[column].stop_diameter = Some(diameter);
                }
            }
        }
    }

    /// Returns whether the lens zooms.
    pub fn is_zoom(&self) -> bool {
        self.layout.zooms > 1
    }

    /// Returns the range of focal lengths, mm: the range computed at the positions or, if the table rounds to a wider
    /// range, the stated range.
    pub fn focal_range(&self) -> [f64; 2] {
        let all = || {
            self.optics.iter().zip(&self.positions.columns).flat_map(|(optics, column)| {
                let computed = optics.map_or(f64::INFINITY, |optics| optics.focal_length.abs());
                let near = |stated: &f64| (stated - computed).abs() <= ROUNDED * computed;
                [Some(computed), column.focal_length.filter(near)].into_iter().flatten()
            })
        };
        [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
    }

    /// Returns the names of those zoom positions that have a name.
    fn names(&self) -> Vec<String> {
        self.positions.columns[..self.layout.zooms].iter().filter_map(|column| column.name.clone()).collect()
    }

    /// Returns the lens at the zoom position with a given name.
    ///
    /// # Errors
    /// The lens does not zoom, or no zoom position has the name.
    pub fn named(&self, name: &str) -> Result<FocusTravel, MovingError> {
        self.must_zoom()?;
        let columns = &self.positions.columns[..self.layout.zooms];
        let zoom = columns.iter().position(|column| column.name.as_deref() == Some(name));
        zoom.map(|zoom| self.position(zoom)).ok_or_else(|| MovingError::Name {
            given: name.to_owned(),
            range: self.focal_range(),
            names: self.names(),
        })
    }

    fn must_zoom(&self) -> Result<(), MovingError> {
        let lens = || self.prescription.name.clone();
        if self.is_zoom() { Ok(()) } else { Err(MovingError::Prime { lens: lens() }) }
    }

    /// Returns the lens at one of its zoom positions, counted from 0 in the order of the table.
    ///
    /// # Panics
    /// Panics if `zoom` is not below the number of positions.
    pub fn position(&self, zoom: usize) -> FocusTravel {
        let poses = (0..self.layout.steps).map(|step| self.poses[self.layout.column(zoom, step)].clone());
        let stated = self.positions.columns[zoom].focal_length;
        let stated = stated.or(self.prescription.stated_focal_length.filter(|_| zoom == 0));
        self.travel(poses.collect(), stated)
    }

    fn travel(&self, poses: Vec<Pose>, stated_focal_length: Option<f64>) -> FocusTravel {
        let base = Prescription { stated_focal_length, ..self.prescription.clone() };
        FocusTravel::new(base, self.positions.gaps.clone(), &poses)
    }

    /// Returns the lens zoomed to `focal_length` mm. The focal length is positive: a magnitude, for the lens focused on
    /// the farthest object of the table. Between the columns the film follows the image of that object at an offset
    /// interpolated from the columns, so that the lens is as sharp between the columns as at them. The stop's diameter
    /// is interpolated.
    ///
    /// `image` returns the distance behind the last vertex, mm, at which a lens images an axial point. The point is
    /// given by its vergence: the reciprocal of its distance in front of the first vertex, 1/mm. `image` returns `None`
    /// if the lens forms no image.
    ///
    /// # Errors
    /// The lens does not zoom, the focal length is out of range, or the focal lengths do not rise or fall steadily.
    pub fn zoomed(
        &self,
        focal_length: f64,
        image: impl Fn(&Prescription, f64) -> Option<f64>,
    ) -> Result<FocusTravel, MovingError> {
        self.must_zoom()?;
        let range = self.focal_range();
        let optics = self.steady()?;
        if !(range[0]..=range[1]).contains(&focal_length) {
            let lens = self.prescription.name.clone();
            return Err(MovingError::OutOfRange { lens, given: focal_length, range });
        }
        // Zoom positions in ascending order of the focal length.
        let mut order: Vec<usize> = (0..self.layout.zooms).collect();
        order.sort_by(|&a, &b| optics[a].focal_length.abs().total_cmp(&optics[b].focal_length.abs()));
        let focal = |zoom: usize| optics[zoom].focal_length.abs();
        let Some(segment) =
            order.windows(2).find(|pair| (focal(pair[0])..=focal(pair[1])).contains(&focal_length))
        else {
            // The focal length lies between the computed end of the range and the rounded end stated in the table.
            let is_short = focal_length < focal(order[0]);
            return Ok(self.position(if is_short { order[0] } else { order[order.len() - 1] }));
        };
        let x: Vec<f64> = order.iter().map(|&zoom| focal(zoom).ln()).collect();
        let curve = |value: &dyn Fn(usize) -> f64| {
            Monotone::new(x.clone(), order.iter().map(|&i| value(i)).collect())
        };
        let gaps_at = |step: usize| -> Vec<Monotone> {
            let column = |zoom| &self.poses[self.layout.column(zoom, step)];
            (0..self.positions.gaps.len()).map(|gap| curve(&|zoom| column(zoom).gaps[gap])).collect()
        };
        let gaps = gaps_at(0);
        let excess = |x: f64| {
            let pose = Pose { gaps: values(&gaps, x), ..self.poses[0].clone() };
            let optics = FirstOrder::of(&Lens::at_d_line(&self.at_pose(&pose)));
            optics.map_or(f64::NAN, |optics| (optics.focal_length.abs() / focal_length).ln())
        };
        let x_of = |zoom: usize| focal(zoom).ln();
        let zoom_x = root(x_of(segment[0]), x_of(segment[1]), excess);

        let interpolated = |step: usize, value: &dyn Fn(&Pose) -> Option<f64>| {
            let of = |zoom| value(&self.poses[self.layout.column(zoom, step)]);
            (0..self.layout.zooms)
                .all(|zoom| of(zoom).is_some())
                .then(|| curve(&|zoom| of(zoom).unwrap_or(0.0)).at(zoom_x))
        };
        let mut poses: Vec<Pose> = Vec::new();
        for step in 0..self.layout.steps {
            // Interpolating the differences between successive steps keeps the steps in order.
            let vergence = match poses.last() {
                None => curve(&|zoom| self.poses[zoom].vergence).at(zoom_x),
                Some(before) => {
                    let of = |zoom, step| self.poses[self.layout.column(zoom, step)].vergence;
                    before.vergence + curve(&|zoom| of(zoom, step) - of(zoom, step - 1)).at(zoom_x)
                }
            };
            poses.push(Pose {
                gaps: values(&gaps_at(step), zoom_x),
                film_distance: interpolated(step, &|pose| pose.film_distance),
                stop_diameter: interpolated(step, &|pose| pose.stop_diameter),
                vergence,
            });
        }
        let off = |pose: &Pose| Some(pose.film_distance? - image(&self.at_pose(pose), pose.vergence)?);
        let listed: Option<Vec<f64>> = order.iter().map(|&zoom| off(&self.poses[zoom])).collect();
        if let (Some(listed), Some(own)) = (listed, off(&poses[0])) {
            let moved = Monotone::new(x, listed).at(zoom_x) - own;
            for pose in &mut poses {
                pose.film_distance = pose.film_distance.map(|film| film + moved).filter(|film| *film > 0.0);
            }
        }
        Ok(self.travel(poses, None))
    }

    /// Returns the first-order optics of the zoom positions if their focal lengths are strictly monotonic.
    fn steady(&self) -> Result<Vec<FirstOrder>, MovingError> {
        let known: Option<Vec<FirstOrder>> = self.optics.iter().copied().collect();
        known
            .filter(|optics| {
                let rises = |pair: &[FirstOrder]| {
                    let [from, to] = [pair[0].focal_length, pair[1].focal_length];
                    (from * to > 0.0).then(|| from.abs().total_cmp(&to.abs()))
                };
                let first = rises(&optics[..2]).filter(|order| order.is_ne());
                first.is_some() && optics.windows(2).all(|pair| rises(pair) == first)
            })
            .ok_or_else(|| MovingError::Unsteady {
                lens: self.prescription.name.clone(),
                focal_lengths: self
                    .optics
                    .iter()
                    .map(|optics| optics.map_or(f64::INFINITY, |optics| optics.focal_length))
                    .collect(),
                names: self.names(),
            })
    }

    fn at_pose(&self, pose: &Pose) -> Prescription {
        at_pose(self.prescription, &self.positions.gaps, pose)
    }
}
