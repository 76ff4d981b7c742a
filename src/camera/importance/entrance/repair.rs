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
    /// Makes the outlines hold rays that `rays` makes of a seed, [`RAYS`] or fewer, and notes what share is missed then.
    pub fn repair(&mut self, rays: impl Fn(u64) -> Vec<FilmRay>) {
        for round in 0..=ROUNDS {
            let mut random = SplitMix64::seed_from_u64(round + 77);
            let is_last = round == ROUNDS;
            let (mut missed, mut all) = (0_u32, 0_u32);
            for (ray, film) in rays(round) {
                // Every other one near the far end, where focus lies.
                let number = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
                let number = if random.next_u64() & 1 == 0 { number * number } else { number.powi(5) };
                if let Some(is_held) = self.holds(&ray, film, number * self.nearest, !is_last) {
                    all += 1;
                    missed += u32::from(!is_held);
                }
            }
            self.missed = f64::from(missed) / f64::from(all.max(1));
        }
    }

    /// Whether a ray lies in the region of the spot on it with that vergence; if asked, it is made to. `None` where the
    /// table is not asked.
    fn holds(&mut self, ray: &Ray, film: [f64; 2], vergence: f64, mend: bool) -> Option<bool> {
        let spot = on_ray(ray, self.reference, vergence)?;
        let (cell, part) = self.cell(&spot)?;
        let Node { fan, image } = self.at(&cell);
        let point = spot.crossing(ray);
        let (ratio, sector) = fan.ratio(point);
        let [cos, sin] = spot.azimuth;
        let at = [film[0] * cos + film[1] * sin, film[1] * cos - film[0] * sin];
        let off = image.off(&fan, point, at);
        let is_held = part <= 1.0 && ratio <= 1.0 && off <= image.spread;
        if is_held || !mend {
            return Some(is_held);
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
        Some(false)
    }
}
