//! How finely a lens is looked at, by what a ray through it costs: in full up to 224 spheres, among which an asphere counts
//! as nine, and then by coarser tables with wider margins. Counted, not timed: the same lens gets the same table.

use std::cell::Cell;

use super::super::fan::SECTORS;
use crate::lens::Lens;

/// The largest field angle, radians.
pub(super) const WIDEST: f64 = 2.9;
/// What an asphere counts more than a sphere, in spheres: rays that pass beside one take longest.
const ASPHERE: u64 = 8;
/// What a table may take, in rays through one sphere each: half a second or so. The coarsest table is made in any case, and
/// takes at most some twice that, behind 1,000 aspheres.
const MOST_WORK: u64 = 600_000_000;

/// Of a table: its size, what rays find an outline, and what rays from the film look for the rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Detail {
    /// Intervals of nearness, and of each row.
    pub rows: usize,
    pub nodes: usize,
    /// Half-lines of an outline that is tabulated, of one halfway between two of those, and of one that is only looked for.
    pub around: usize,
    pub between: usize,
    pub rough: usize,
    /// Places along a half-line where rays are tried first if nothing is known of its end, and halvings that narrow that
    /// down from there.
    pub places: usize,
    pub halvings: usize,
    /// Field angle from one look to the next in the search for chief rays, radians.
    pub stride: f64,
    /// Looks along a row for its end, at most, and halvings of the step that end them.
    pub looks: usize,
    pub closer: i32,
    /// How much larger outlines are made in any case, relative.
    pub margin: f64,
    /// Rounds of rays from the film, at most; rays of each, and how many spots each ray stands for.
    pub rounds: usize,
    pub rays: usize,
    pub spots: usize,
}

/// From the finest on.
const DETAILS: [Detail; 4] = [
    Detail {
        rows: 24,
        nodes: 16,
        around: 2 * SECTORS,
        between: SECTORS,
        rough: SECTORS / 4,
        places: 16,
        halvings: 9,
        stride: 0.03,
        looks: 64,
        closer: 12,
        margin: 1.005,
        rounds: 16,
        rays: 12_000,
        spots: 1,
    },
    Detail {
        rows: 16,
        nodes: 12,
        around: SECTORS,
        between: SECTORS,
        rough: SECTORS / 4,
        places: 16,
        halvings: 9,
        stride: 0.03,
        looks: 48,
        closer: 11,
        margin: 1.02,
        rounds: 12,
        rays: 4_000,
        spots: 3,
    },
    Detail {
        rows: 8,
        nodes: 8,
        around: SECTORS,
        between: SECTORS / 2,
        rough: SECTORS / 4,
        places: 12,
        halvings: 7,
        stride: 0.06,
        looks: 32,
        closer: 9,
        margin: 1.03,
        rounds: 8,
        rays: 2_000,
        spots: 6,
    },
    Detail {
        rows: 4,
        nodes: 6,
        around: SECTORS / 2,
        between: SECTORS / 2,
        rough: SECTORS / 4,
        places: 8,
        halvings: 6,
        stride: 0.12,
        looks: 20,
        closer: 6,
        margin: 1.05,
        rounds: 4,
        rays: 1_500,
        spots: 8,
    },
];

/// Rays traced so far through a lens.
#[derive(Debug)]
pub(in crate::camera::importance) struct Work {
    per_ray: u64,
    done: Cell<u64>,
}

impl Work {
    /// None yet through a lens.
    pub fn through(lens: &Lens) -> Self {
        let aspheres = lens.surfaces.iter().filter(|surface| surface.figure.is_some()).count();
        let per_ray = lens.surfaces.len() as u64 + ASPHERE * aspheres as u64;
        Self { per_ray, done: Cell::new(0) }
    }

    /// Counts rays that are traced.
    pub fn count(&self, rays: usize) {
        self.done.set(self.done.get() + rays as u64 * self.per_ray);
    }

    /// Whether all the rays were traced that a table may take.
    pub fn is_spent(&self) -> bool {
        self.done.get() >= MOST_WORK
    }

    /// The finest table that such a lens can have, or the coarsest.
    pub(super) fn detail(&self) -> Detail {
        let [.., coarsest] = DETAILS;
        let fits = |detail: &Detail| detail.rays_at_most() * self.per_ray <= MOST_WORK;
        DETAILS.into_iter().find(fits).unwrap_or(coarsest)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::super::lens::LensBackward, *};
    use crate::{
        camera::{Host, Parameters, Raster, RealisticCamera},
        prescription::MAX_INTERFACES,
    };

    /// A lens in front, and as many interfaces as make so many: nearly plane ones, of spheres or every one an asphere.
    fn long_lens(interfaces: usize, is_aspheric: bool) -> LensBackward {
        let plates = (2..interfaces).map(|i| {
            let radius = [2e4, -3e4, 9e4, -5e4][i % 4];
            format!("{radius} 0.03 {} 14\n", [1.5, 1.0][i % 2])
        });
        let figure = |i: usize| format!("asphere {i} conic=0.3 A4=1e-9 A6=-1e-11\n");
        let figures = (1..=interfaces).filter(|_| is_aspheric).map(figure);
        let text: String =
            ["60 6 1.6 14\n-400 2 1 14\n".to_owned()].into_iter().chain(plates).chain(figures).collect();
        let host = Host {
            lens_text: Some(("long.dat".to_owned(), text.into_bytes())),
            ..Host::new(Raster { xres: 30, yres: 20 }, None)
        };
        let camera = RealisticCamera::build(&Parameters::default(), &host, &mut |_, _| ());
        camera.unwrap_or_else(|error| panic!("{interfaces} {is_aspheric}: {error}")).lens_backward()
    }

    #[test]
    fn a_table_takes_no_more_rays_than_the_lens_may() {
        for (interfaces, is_aspheric) in [
            (2, false),
            (60, true),
            (150, false),
            (400, false),
            (MAX_INTERFACES, false),
            (MAX_INTERFACES, true),
        ] {
            let lens = long_lens(interfaces, is_aspheric);
            let work = lens.work();
            lens.tabulate(&work);
            let most = work.detail().rays_at_most() * work.per_ray;
            let done = work.done.get();
            assert!(done > 0 && done <= most, "{interfaces} {is_aspheric}: {done} of {most}");
            let allowed = if is_aspheric { 2.2 } else { 1.0 } * MOST_WORK as f64;
            assert!(most as f64 <= allowed, "{interfaces} {is_aspheric}: {most}");
        }
    }

    #[test]
    fn tables_get_coarser_with_the_cost_of_a_ray_and_those_of_short_lenses_not_at_all() {
        let rays = |per_ray: u64| Work { per_ray, done: Cell::new(0) }.detail().rays_at_most();
        let all = 1..=(1 + ASPHERE) * MAX_INTERFACES as u64;
        assert!(all.clone().zip(all.skip(1)).all(|(cost, dearer)| rays(cost) >= rays(dearer)));
        assert_eq!(rays(224), rays(1));
        assert!(rays(225) < rays(1));
    }
}
