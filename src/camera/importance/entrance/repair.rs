//! What rays from the film find outside the table's outlines, and outlines that hold it.

use rand_xoshiro::{
    SplitMix64,
    rand_core::{Rng, SeedableRng},
};

use super::{
    spot::on_ray,
    table::{Entrance, Node},
};
use crate::lens::Ray;

/// Rays of a round.
pub(in crate::camera::importance) const RAYS: usize = 12_000;
/// Rounds.
const ROUNDS: u64 = 8;
/// How much more than needed an outline is made to hold, relative.
const MORE: f64 = 1.001;

/// A ray of the camera out into the scene, in lens space, and where on the film it began.
pub(in crate::camera::importance) type FilmRay = (Ray, [f64; 2]);

impl Entrance {
    /// Makes the outlines hold rays that `rays` makes of a round's number, [`RAYS`] or fewer.
    pub fn repair(&mut self, rays: impl Fn(u64) -> Vec<FilmRay>) {
        for round in 0..ROUNDS {
            let mut random = SplitMix64::seed_from_u64(round + 77);
            for (ray, film) in rays(round) {
                // Every other one near the far end, where focus lies.
                let number = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
                let number = if random.next_u64() & 1 == 0 { number * number } else { number.powi(5) };
                self.hold(&ray, film, number * self.nearest);
            }
        }
    }

    /// Makes the region of the spot on a ray with that vergence hold the ray, where there is one.
    fn hold(&mut self, ray: &Ray, film: [f64; 2], vergence: f64) {
        let Some(spot) = on_ray(ray, self.reference, vergence) else { return };
        let Some((cell, part)) = self.cell(&spot) else { return };
        let Node { fan, image } = self.at(&cell);
        let point = spot.crossing(ray);
        let (ratio, sector) = fan.ratio(point);
        let [cos, sin] = spot.azimuth;
        let at = [film[0] * cos + film[1] * sin, film[1] * cos - film[0] * sin];
        let off = image.off(&fan, point, at);
        if part <= 1.0 && ratio <= 1.0 && off <= image.spread {
            return;
        }
        for row in &mut self.rows[cell.row..=cell.row + 1] {
            row.end *= part.max(1.0);
            for node in &mut row.nodes[cell.node..=cell.node + 1] {
                if ratio > 1.0 {
                    for reach in &mut node.fan.reach[sector..=sector + 1] {
                        *reach *= MORE * ratio;
                    }
                }
                node.image.spread = node.image.spread.max(MORE * off);
            }
        }
    }
}
