//! Which points of the sampling plane a film point gets light from: the library's map of its pupil, by its outline.
//!
//! A film point is named by its field σ = r/B: its distance r from the axis over that of the film from the sampling plane, B.
//! By σ the pupil hardly changes with the focus.

use super::optics::Optics;
use super::region::Region;
use realistic::unstable::lens::Lens;
use realistic::unstable::sampling::{PupilDisk, WarpedPupil};
use realistic::unstable::trace::Path;

/// A lens, focused once, and the pupils of all its film points.
#[derive(Debug)]
pub struct Field {
    pupil: WarpedPupil,
    /// Film to sampling plane, mm.
    distance: f64,
    /// Distance from the axis of the farthest film point asked for, mm.
    reach: f64,
}

impl Field {
    /// With the film so far, mm, from the sampling plane, for film points up to `reach` mm from the axis; `lens` is that of
    /// `optics` at a focus, or the same at another wavelength. `None` where the film touches the lens.
    pub fn of(optics: &Optics, lens: &Lens, distance: f64, reach: f64) -> Option<Self> {
        let film = lens.rear().vertex - (distance - optics.plane);
        let cover = PupilDisk::rear(lens, film, reach)?;
        let disks = [cover, PupilDisk::exit(lens, film)];
        let pupil = WarpedPupil::new(&Path::film_to_scene(lens), film, reach, disks);
        Some(Self { pupil, distance, reach })
    }

    /// The field up to which film gets light, and whether it is dark from there on.
    pub fn end(&self) -> (f64, bool) {
        let dark = self.pupil.image_radius().filter(|radius| *radius <= self.reach);
        (dark.unwrap_or(self.reach) / self.distance, dark.is_some())
    }

    /// The pupil of field σ; `None` where it is dark.
    pub fn pupil(&self, field: f64) -> Option<Region> {
        let point = field * self.distance;
        Region::of(|on_circle| {
            let [x, y] = self.pupil.sample([point, 0.0], on_circle)?.slopes;
            Some([point + x * self.distance, y * self.distance])
        })
    }
}
