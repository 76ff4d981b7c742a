//! How finely a lens is looked at, by what a ray through it costs: in full up to 224 spheres, among which an asphere counts
//! as four, and then by coarser tables with wider margins. What rays cost that have to be followed to an asphere is known
//! when some were traced: then the table is chosen once more. Counted, not timed: the same lens gets the same table.

use std::cell::Cell;

use super::super::fan::SECTORS;
use crate::{lens::Lens, trace};

/// The largest field angle, radians.
pub(super) const WIDEST: f64 = 2.9;
/// What an asphere counts more than a sphere, in spheres, and what each evaluation of one counts that a ray takes beyond
/// what all do.
const ASPHERE: u64 = 3;
const EVALUATION: u64 = 30;
/// What a table may take, in rays through one sphere each: half a second or so. The coarsest table is begun in any case;
/// at twice that no more rays are traced, and what is not found by then does not get through.
const MOST_WORK: u64 = 600_000_000;
/// A table takes less than half the rays that it may.
const SELDOM: u64 = 2;

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

/// Rays traced so far through a lens, on the thread that makes its table.
#[derive(Debug)]
pub(in crate::camera::importance) struct Work {
    per_ray: u64,
    rays: Cell<u64>,
    /// The evaluations of aspheres that were counted before.
    before: u64,
    detail: Cell<Detail>,
}

impl Work {
    /// None yet through a lens.
    pub fn through(lens: &Lens) -> Self {
        let aspheres = lens.surfaces.iter().filter(|surface| surface.figure.is_some()).count();
        Self::at(lens.surfaces.len() as u64 + ASPHERE * aspheres as u64)
    }

    fn at(per_ray: u64) -> Self {
        let detail = Cell::new(Detail::for_rays_at(per_ray, MOST_WORK));
        Self { per_ray, rays: Cell::new(0), before: trace::evaluations(), detail }
    }

    /// Counts rays that are traced.
    pub fn count(&self, rays: usize) {
        self.rays.set(self.rays.get() + rays as u64);
    }

    /// What was done so far.
    fn done(&self) -> u64 {
        self.rays.get() * self.per_ray + EVALUATION * (trace::evaluations() - self.before)
    }

    /// Whether all was done that a table may take.
    pub fn is_spent(&self) -> bool {
        self.done() >= MOST_WORK
    }

    /// Whether so much was done that a coarse table is ended where it is, too.
    pub(super) fn is_overspent(&self) -> bool {
        self.done() >= 2 * MOST_WORK
    }

    /// How finely the lens is looked at.
    pub(super) fn detail(&self) -> Detail {
        self.detail.get()
    }

    /// Chooses that again, by what the rays so far took.
    pub(super) fn choose_again(&self) {
        let per_ray = self.done() / self.rays.get().max(1);
        let [fine, coarse] = [(self.per_ray, MOST_WORK), (per_ray, SELDOM * MOST_WORK)]
            .map(|(per_ray, most)| Detail::for_rays_at(per_ray, most));
        self.detail.set(if coarse.rows < fine.rows { coarse } else { fine });
    }
}

impl Detail {
    /// The finest table whose rays take no more, each counting so much, or the coarsest.
    fn for_rays_at(per_ray: u64, most: u64) -> Self {
        let [.., coarsest] = DETAILS;
        DETAILS.into_iter().find(|detail| detail.rays_at_most() * per_ray <= most).unwrap_or(coarsest)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::super::lens::LensBackward, *};
    use crate::{
        camera::{Host, Parameters, Raster, RealisticCamera},
        lens::film_ray,
        prescription::{MAX_INTERFACES, read},
        trace::Path,
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
            let most = work.detail().rays_at_most();
            let rays = work.rays.get();
            assert!(rays > 0 && rays <= most, "{interfaces} {is_aspheric}: {rays} of {most}");
            let done = work.done() as f64 / MOST_WORK as f64;
            println!("{interfaces} {is_aspheric}: {done:.2} of what a table may take");
            assert!(done <= 1.0, "{interfaces} {is_aspheric}: {done}");
        }
    }

    #[test]
    fn a_table_gets_coarser_where_rays_have_to_be_followed_and_ends_where_that_takes_too_long() {
        // Rays from the film begin behind the equator, where Newton's iteration proves nothing.
        let text = "20 25 1.5 60\ninf 2 1 26\n0 0 1 20\nasphere 1 A10=1.953125e-13\n";
        let lens = Lens::at_d_line(&read("equator", text.as_bytes()).expect("a lens"));
        let (path, film) = (Path::<f64>::film_to_scene(&lens), lens.rear().vertex - 14.0);
        let follow = |rays: u32| {
            for i in 0..rays {
                let slope = 0.3 * f64::from(i % 100) / 100.0;
                assert!(path.trace(film_ray([2.0, 0.0], film, [slope, 0.1])).is_ok());
            }
        };
        let work = Work::through(&lens);
        work.count(10_000);
        work.choose_again();
        assert_eq!(work.detail().rows, DETAILS[0].rows);
        follow(2_000);
        let evaluations = trace::evaluations() - work.before;
        assert!((2 * 2_000..100 * 2_000).contains(&evaluations), "{evaluations}");
        // As if these had been few of the rays, and then nearly all of them.
        work.choose_again();
        assert_eq!(work.detail().rows, DETAILS[0].rows);
        let work = Work { rays: Cell::new(10), ..work };
        work.choose_again();
        assert_eq!(work.detail().rows, DETAILS[3].rows);
        assert!(!work.is_spent());
        let left = MOST_WORK / EVALUATION;
        let work = Work { per_ray: EVALUATION, rays: Cell::new(left), ..work };
        assert!(work.is_spent() && !work.is_overspent());
        work.count(left as usize);
        assert!(work.is_overspent());
    }

    #[test]
    fn tables_get_coarser_with_the_cost_of_a_ray_and_those_of_short_lenses_not_at_all() {
        let rays = |per_ray: u64| Work::at(per_ray).detail().rays_at_most();
        let all = 1..=(1 + ASPHERE) * MAX_INTERFACES as u64;
        assert!(all.clone().zip(all.skip(1)).all(|(cost, dearer)| rays(cost) >= rays(dearer)));
        assert_eq!(rays(224), rays(1));
        assert!(rays(225) < rays(1));
    }
}
