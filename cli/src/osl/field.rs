//! The points of the sampling plane that send light to a film point, by the outline of the library's map of its
//! pupil.
//!
//! A film point is given by its field σ = r/B, where r is its distance from the axis and B is the distance from the
//! film to the sampling plane. As a function of σ, the pupil hardly changes with the focus.

use super::optics::Optics;
use super::region::Region;
use realistic_camera::sampling::{PupilDisk, WarpedPupil};
use realistic_optics::lens::Lens;
use realistic_optics::trace::Path;

/// A lens at one focus, and the pupils of all its film points.
#[derive(Debug)]
pub struct Field {
    pupil: WarpedPupil,
    /// Distance from the film to the sampling plane, mm.
    distance: f64,
    /// Distance from the axis to the farthest requested film point, mm.
    reach: f64,
}

impl Field {
    /// Makes the field for a film `distance` mm from the sampling plane, for film points up to `reach` mm from the
    /// axis. `lens` is the lens of `optics` at a focus, or that lens at another wavelength. `None` if the film
    /// touches the lens.
    pub fn of(optics: &Optics, lens: &Lens, distance: f64, reach: f64) -> Option<Self> {
        let film = lens.rear().vertex - (distance - optics.plane);
        let cover = PupilDisk::rear(lens, film, reach)?;
        let disks = [cover, PupilDisk::exit(lens, film)];
        let pupil = WarpedPupil::new(&Path::film_to_scene(lens), film, reach, disks);
        Some(Self { pupil, distance, reach })
    }

    /// Returns the field up to which the film gets light, and whether the film is dark beyond it.
    pub fn end(&self) -> (f64, bool) {
        let dark = self.pupil.image_radius().filter(|radius| *radius <= self.reach);
        (dark.unwrap_or(self.reach) / self.distance, dark.is_some())
    }

    /// Returns the pupil of field σ; `None` if the film point gets no light.
    pub fn pupil(&self, field: f64) -> Option<Region> {
        let point = field * self.distance;
        Region::of(|on_circle| {
            let [x, y] = self.pupil.sample([point, 0.0], on_circle)?.slopes;
            Some([point + x * self.distance, y * self.distance])
        })
    }
}
