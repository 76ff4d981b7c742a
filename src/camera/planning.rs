//! A camera's plan: what its film, pupil and place do not need, and the tracer that is left.

use super::{
    CameraMotion, Film, Level, parameters::Precision, pipeline::film_rays::Sampler, placement::Placement,
    setup::Setup,
};
use crate::{
    lens::{Lens, refraction::Refraction, single_precision::f32_is_fit},
    plan::{
        Choice, Plan,
        apertures::Apertures,
        choice::{Chosen, Task},
    },
    sampling::Band,
    trace::{
        Direction, Path,
        kernel::{self, Kernel},
        polynomial::{Polynomial, PolynomialLens},
    },
};
use crate::{
    plan::shortened::{Shortened, Way},
    sampling::DiskMapping,
};

/// Rings of the film that a disk's proof is cut into.
const RINGS: u32 = 4;

/// Where rays begin and how they are drawn.
pub(crate) struct FilmSide<'a> {
    pub film: &'a Film,
    pub film_z: f64,
    pub sampler: &'a Sampler,
}

impl FilmSide<'_> {
    fn bands(&self) -> Vec<Band> {
        match self.sampler {
            Sampler::Warped(pupil) => pupil.bands(),
            Sampler::Disk(disk) => {
                let center = disk.seen_from([1.0, 0.0]).center[0];
                let at = |ring: u32| self.film.reach() * f64::from(ring) / f64::from(RINGS);
                let band = |ring| Band {
                    radii: [at(ring), at(ring + 1)],
                    center: [center; 2],
                    radius: disk.slope_radius(),
                };
                (0..RINGS).map(band).collect()
            }
        }
    }

    fn choose(&self, setup: &Setup, lens: &Lens) -> (Choice, Chosen) {
        let [half_width, half_height] = self.film.point(0.0, 0.0);
        let sample = |[x, y, u, v]: [f64; 4]| {
            let point = [(1.0 - 2.0 * x) * half_width, (1.0 - 2.0 * y) * half_height];
            Some((point, setup.mapping.map(u, v)?))
        };
        let draw = |point, disk| self.sampler.draw(point, disk).map(|drawn| (drawn.slopes, drawn.area));
        Choice::of(&Task {
            lens,
            film: self.film_z,
            reach: self.film.reach(),
            in_focus: self.film_z + setup.focus_distance.unwrap_or(f64::INFINITY),
            pixel: self.film.pixel(),
            tolerance: setup.tolerance,
            sample: &sample,
            draw: &draw,
        })
    }
}

/// How rays are taken through the lens.
pub(crate) enum Route {
    /// In double precision.
    Double(Shortened<f64>),
    /// In single precision.
    Single(Shortened<f32>),
    /// Walked in double precision.
    Walk(Path<f64>),
    /// Walked in single precision.
    WalkSingle(Path<f32>),
}

impl Route {
    /// All of a lens. The library's own refraction is the kernel's; any other is walked.
    fn whole(lens: &Lens, refraction: Refraction, single: bool) -> Self {
        let direction = Direction::FilmToScene;
        match (refraction, single) {
            (Refraction::Fused, false) => Self::Double(Shortened::whole(Kernel::new(lens, direction))),
            (Refraction::Fused, true) => Self::Single(Shortened::whole(Kernel::new(lens, direction))),
            (_, false) => Self::Walk(Path::new(lens, direction, refraction)),
            (_, true) => Self::WalkSingle(Path::new(lens, direction, refraction)),
        }
    }
}

/// Makes the plan of a set-up, and the route through its lens.
pub(crate) fn plan(
    setup: &Setup,
    lens: &Lens,
    side: &FilmSide<'_>,
    log: &mut dyn FnMut(Level, &str),
) -> (Route, Plan) {
    let mut plan = Plan::default();
    let single = setup.precision == Precision::Single;
    let unfit = if single { f32_is_fit(lens).err() } else { None };
    if let Some(unfit) = &unfit {
        log(Level::Warning, &format!("\"precision\" \"f32\" is nothing for this lens: {unfit}"));
    }
    if setup.refraction != Refraction::Fused || !setup.leave_out {
        warn_of_tolerance(setup, log);
        plan.kept("every surface and aperture test", "the method of tracing is named", "exact");
        return (Route::whole(lens, setup.refraction, single), plan);
    }
    let chosen = match (setup.precision, setup.tolerance > 0.0) {
        (Precision::Auto, true) => {
            let (choice, chosen) = side.choose(setup, lens);
            log(Level::Info, &choice.sentence());
            plan.set_choice(choice);
            chosen
        }
        (Precision::Single, _) => Chosen::Single,
        (Precision::Auto | Precision::Double, _) => Chosen::Double,
    };
    if setup.precision != Precision::Auto {
        warn_of_tolerance(setup, log);
    }
    let reach = side.film.reach();
    let route = match chosen {
        Chosen::Double => {
            plan.kept("exact trace in f64", "every surface is met", "errors of 1e-15 rad");
            Route::Double(exact(lens, side, &mut plan))
        }
        Chosen::Single => {
            plan.kept("exact trace in f32", "every surface is met", "errors of 1e-7 rad");
            match unfit {
                Some(unfit) => {
                    plan.kept("every aperture test", unfit.to_string(), "no bound holds in f32");
                    Route::whole(lens, Refraction::Fused, true)
                }
                // Fit, if a tolerance chose it.
                None => Route::Single(exact(lens, side, &mut plan)),
            }
        }
        Chosen::Polynomials(polynomial, single) => {
            plan.left_out(
                "the surfaces, one by one",
                "polynomials take their place within the tolerance",
                format!("{} coefficients", polynomial.coefficients()),
            );
            if single {
                Route::Single(approximate(lens, reach, &polynomial))
            } else {
                Route::Double(approximate(lens, reach, &polynomial))
            }
        }
    };
    (route, plan)
}

fn warn_of_tolerance(setup: &Setup, log: &mut dyn FnMut(Level, &str)) {
    if setup.tolerance > 0.0 && setup.leave_out {
        log(
            Level::Warning,
            "\"tolerance\" is not used: \"precision\" or \"refraction\" names how rays are traced; leave it at \
             its default",
        );
    }
}

/// Polynomials for film points up to `reach` mm from the axis.
fn approximate<S: kernel::Precision>(lens: &Lens, reach: f64, polynomial: &Polynomial) -> Shortened<S> {
    Shortened::whole(Kernel::new(lens, Direction::FilmToScene))
        .with(reach, Way::Polynomials(PolynomialLens::new(polynomial).into()))
}

/// The exact kernel, without the tests that no ray from within the film fails.
fn exact<S: kernel::Precision>(lens: &Lens, side: &FilmSide<'_>, plan: &mut Plan) -> Shortened<S> {
    let whole = Kernel::<S>::new(lens, Direction::FilmToScene);
    let bands = side.bands();
    let apertures = Apertures::of(lens, side.film_z, &bands);
    let count = lens.surfaces.len();
    let needed: Vec<usize> = (0..count).filter(|&surface| apertures.is_needed(surface)).collect();
    if needed.len() == count {
        plan.kept(
            "aperture tests of all surfaces",
            "rays come to each rim, or no bound keeps them from it",
            "exact",
        );
        return Shortened::whole(whole);
    }
    let lean = Kernel::<S>::testing(lens, Direction::FilmToScene, |surface| apertures.is_needed(surface));
    if !needed.is_empty() {
        let numbers: Vec<String> = needed.iter().map(|surface| (surface + 1).to_string()).collect();
        let surfaces = if numbers.len() == 1 { "test of surface" } else { "tests of surfaces" };
        plan.kept(
            &format!("aperture {surfaces} {}", numbers.join(", ")),
            "rays come to the rim, or no bound keeps them from it",
            "exact",
        );
    }
    for (number, bound) in apertures.redundant.iter().enumerate() {
        let Some(bound) = bound else { continue };
        plan.left_out(
            &format!("aperture test of surface {}", number + 1),
            format!(
                "proven: no ray of this film and pupil comes beyond {:.1} % of the clear radius",
                100.0 * bound
            ),
            "no bit changes",
        );
    }
    let fewer = whole.steps() - lean.steps();
    if fewer > 0 {
        plan.left_out(
            &format!("{fewer} of {} surfaces altogether", whole.steps()),
            "planes with one index on both sides and no test left",
            "no bit changes",
        );
    }
    let reach = bands.last().map_or(0.0, |band| band.radii[1]);
    Shortened::whole(whole).with(reach, Way::Kernel(lean))
}

/// Decisions about how lens samples are drawn and what is made only when asked for.
pub(crate) fn describe_drawing(plan: &mut Plan, side: &FilmSide<'_>, mapping: DiskMapping, wavelength: f64) {
    let reach = side.film.reach();
    match side.sampler {
        Sampler::Warped(pupil) => {
            let report = pupil.build_report();
            let (end, why) = match pupil.image_radius() {
                Some(end) => (end, "the end of the image circle"),
                None => (reach, "the raster's corner and its filter"),
            };
            plan.kept(
                &format!("pupil table up to {end:.3} mm from the axis"),
                why,
                format!("{} film radii, {} rays", report.slices, report.rays),
            );
            if pupil.image_radius().is_some_and(|end| end < reach) {
                plan.left_out(
                    &format!("pupil of film beyond {end:.3} mm"),
                    "no light reaches it",
                    "weight 0 for the price of a comparison",
                );
            }
        }
        Sampler::Disk(_) => {
            plan.left_out("pupil table", "samples are drawn from a disk", "no time to build it")
        }
    }
    if mapping == DiskMapping::Rejection {
        plan.kept("asking again", "disk \"rejection\"", "some samples are drawn twice");
    }
    plan.left_out(
        "dispersion",
        format!("one wavelength, {wavelength} nm, is asked for"),
        "each surface has one index",
    );
    plan.left_out("differentials", "traced only for a host that asks three times a sample", "no time");
    plan.left_out(
        "reasons of blocked rays",
        "found by a second trace of those that a caller asks about",
        "no time",
    );
    plan.left_out("statistics", "nothing counts rays", "no time");
}

impl Placement {
    /// Decisions about time and the place in the world.
    pub(crate) fn describe(&self, plan: &mut Plan) {
        let [open, close] = self.shutter;
        if open == close {
            plan.left_out(
                "interpolation of time",
                "the shutter opens and closes at once",
                "one time for all rays",
            );
        } else {
            plan.kept(
                "interpolation of time",
                format!("the shutter is open from {open} to {close}"),
                "a ray has its own time",
            );
        }
        match &self.to_world {
            CameraMotion::Moving(_) => {
                plan.kept(
                    "interpolation of the motion",
                    "the camera moves while the shutter is open",
                    "a transform a ray",
                );
            }
            CameraMotion::Still(to_world) => {
                plan.left_out(
                    "interpolation of the motion",
                    "the camera stands still",
                    "one transform for all rays",
                );
                if to_world.is_identity() {
                    plan.left_out("camera to world", "it is the identity", "rays stay as they are");
                } else {
                    plan.kept(
                        "camera to world",
                        "it is not the identity",
                        "a 3 x 3 matrix and a move; nothing is divided by w",
                    );
                    plan.kept(
                        "making directions unit vectors",
                        "entries are floats: even a rotation is one to 1e-7 only",
                        "unit directions",
                    );
                }
            }
        }
    }
}
