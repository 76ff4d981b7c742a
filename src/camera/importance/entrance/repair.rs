//! What rays from the film find outside the table's outlines, and outlines that hold it.

use rand_xoshiro::{
    SplitMix64,
    rand_core::{Rng, SeedableRng},
};

use super::{
    detail::{Detail, Work},
    spot::Spot,
    table::{Cell, Entrance, Node},
};
use crate::lens::Ray;

/// The number of the last round that there is in any case.
const LEAST: usize = 3;
/// So many rays outside, and no more of a round, need no other.
const FEW: usize = 2;
/// How much more than needed an outline is made to hold, relative,
const MORE: f64 = 1.004;
/// and over how far outside a ray was: few rays find the farthest. The same of where rows end.
const FARTHER: f64 = 1.5;

/// A ray of the camera out into the scene.
#[derive(Clone, Copy, Debug)]
pub(in crate::camera::importance) struct FilmRay {
    /// As it leaves the front, lens space, mm.
    pub ray: Ray,
    /// Where on the film it began.
    pub film: [f64; 2],
    /// Where it crossed the stop, if that matters.
    pub stop: Option<[f64; 2]>,
}

impl Entrance {
    /// Makes the outlines hold rays that `rays` makes, of so many numbers from one on, until hardly any lies outside or there
    /// were as many as `work` has room for.
    pub fn repair(&mut self, work: &Work, rays: impl Fn(usize, usize) -> Vec<FilmRay>) {
        let Detail { rounds, rays: count, spots, .. } = work.detail();
        for round in 0..rounds {
            let mut random = SplitMix64::seed_from_u64(round as u64 + 77);
            let mut outside = 0;
            for ray in rays(round * count, count) {
                for _ in 0..spots {
                    // Every other one as rows lie, and as many near the glass, some of them on it.
                    let number = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
                    let is_far = random.next_u64() & 1 == 0;
                    let nearness = if is_far { number * number } else { (1.05 * number.sqrt()).min(1.0) };
                    outside += usize::from(self.hold(&ray, nearness));
                }
            }
            if (round >= LEAST && outside <= FEW) || work.is_spent() {
                return;
            }
        }
    }

    /// Makes the region of the spot on a ray with that nearness, or nearly that, hold the ray; whether it lay outside.
    fn hold(&mut self, ray: &FilmRay, nearness: f64) -> bool {
        let spot = self.sight.on_ray(&ray.ray, nearness);
        let Some(Outside { cell, part, ratio, sector, corners, off, off_stop }) =
            spot.and_then(|spot| self.outside(&spot, ray))
        else {
            return false;
        };
        // What is missing comes from each node by its share: a large part does not spread over the table from cell to cell.
        let [far, near] =
            [1.0 - cell.down, cell.down].map(|row| [row * (1.0 - cell.along), row * cell.along]);
        let squares: f64 = [far, near].as_flattened().iter().map(|share| share * share).sum();
        let growth = if ratio > 1.0 { MORE * (1.0 + FARTHER * (ratio - 1.0)) - 1.0 } else { 0.0 };
        for (row, shares) in self.rows[cell.row..=cell.row + 1].iter_mut().zip([far, near]) {
            row.end *= 1.0 + FARTHER * (part - 1.0).max(0.0);
            for (node, share) in row.nodes[cell.node..=cell.node + 1].iter_mut().zip(shares) {
                for (reach, corner) in node.fan.reach[sector..=sector + 1].iter_mut().zip(corners) {
                    *reach += growth * corner * share / squares;
                }
                node.image.spread = node.image.spread.max(MORE * off);
                node.stop.spread = node.stop.spread.max(MORE * off_stop);
            }
        }
        true
    }

    /// How far a ray through a spot lies outside the region that the spot sees; `None` for one inside, and for spots nearer
    /// than the table goes.
    fn outside(&self, spot: &Spot, FilmRay { ray, film, stop: crossed }: &FilmRay) -> Option<Outside> {
        let (cell, part) = self.cell(spot)?;
        let Node { fan, image, stop } = self.at(&cell);
        let point = spot.crossing(ray);
        let (ratio, sector) = fan.ratio(point);
        let [cos, sin] = spot.azimuth;
        let turned = |[x, y]: [f64; 2]| [x * cos + y * sin, y * cos - x * sin];
        let off = image.off(&fan, point, turned(*film));
        let off_stop = crossed.map_or(0.0, |at| stop.off(&fan, point, turned(at)));
        let inside = part <= 1.0 && ratio <= 1.0 && off <= image.spread && off_stop <= stop.spread;
        let corners = [fan.reach[sector], fan.reach[sector + 1]];
        (!inside).then_some(Outside { cell, part, ratio, sector, corners, off, off_stop })
    }
}

/// A ray outside a region: the cell, what part of the row's end its angle is, how far from the centre it lies over the
/// edge's distance, in which sector, how far its corners lie from the centre, and how far from where it is expected it reaches
/// the film and crosses the stop, mm.
struct Outside {
    cell: Cell,
    part: f64,
    ratio: f64,
    sector: usize,
    corners: [f64; 2],
    off: f64,
    off_stop: f64,
}
