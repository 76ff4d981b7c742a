//! The units of the lengths in a scene: the unit of camera space in millimetres, and its length in the world.

use std::fmt;

use realistic_base::message::{as_given, short};

/// The units of camera space and of the world. They differ if the camera transform scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Millimetres per unit of camera space: the parameter `mm_per_unit`.
    pub mm: f64,
    /// Units of camera space per world unit, along the optical axis.
    pub per_world_unit: f64,
}

impl Units {
    /// Largest relative change of lengths that can be explained by rounding a rigid transform to single
    /// precision.
    const ROUNDING: f64 = 1e-4;

    /// Returns the units for a camera space whose unit is `mm` millimetres, under a camera transform that
    /// makes this unit `axial_scale` world units long along the axis. A scale that differs from 1 only by
    /// rounding counts as 1.
    pub fn new(mm: f64, axial_scale: f64) -> Self {
        let scales = (axial_scale - 1.0).abs() > Self::ROUNDING;
        Self { mm, per_world_unit: if scales { axial_scale.recip() } else { 1.0 } }
    }

    /// Whether the camera transform changes lengths along the optical axis.
    pub fn differ(&self) -> bool {
        self.per_world_unit != 1.0
    }

    /// Describes the unit of a `focus_distance` that is too near for the lens, and the value to give if
    /// another unit was meant.
    pub(super) fn of_focus(&self, distance: f64) -> String {
        let given = as_given(distance);
        let unit = format!("\"focus_distance\" {given} is in units of camera space");
        if self.differ() {
            let meant = short(distance * self.per_world_unit);
            return format!("{unit}, and {self}: for {given} world units give \"focus_distance\" {meant}");
        }
        let mm = short(self.mm);
        format!(
            "{unit}, each of {mm} mm here: if the scene's are others, give \"mm_per_unit\", 1000 for metres"
        )
    }

    /// Returns millimetres per world unit.
    pub fn mm_per_world_unit(&self) -> f64 {
        self.mm * self.per_world_unit
    }
}

impl fmt::Display for Units {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [per_world_unit, mm, both] = [self.per_world_unit, self.mm, self.mm_per_world_unit()].map(short);
        write!(
            f,
            "the camera transform scales: a world unit is {per_world_unit} units of camera space of {mm} mm each, {both} mm"
        )
    }
}
