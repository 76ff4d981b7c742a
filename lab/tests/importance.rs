//! The adjoint camera against the extended-precision reference: rays of the camera are traced back to the film in
//! numbers of 106 bits, and the areas and solid angles about them follow from differences of such rays.

use realistic_camera::{
    Camera, Facts, Host, Importance, Parameters, Raster, Sample, WorldRay, sampling::PupilDisk,
};
use realistic_lab::reference::DoubleDouble as Exact;
use realistic_optics::{
    lens::{Lens, cos4, refraction::Refraction},
    prescription::catalogue,
    trace::{Direction, Path, Real},
};

const RASTER: Raster = Raster { xres: 400, yres: 300 };

fn camera(given: &[(&str, &str)]) -> Camera {
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).expect("a parameter");
    }
    let host = Host::new(RASTER, None);
    Camera::build(&parameters, &host, &mut |_, _| ()).unwrap_or_else(|error| panic!("{given:?}: {error}"))
}

fn exact(number: f64) -> Exact {
    Exact::from_f64(number)
}

/// A ray given by its point in a plane perpendicular to the axis, mm, and its slopes.
type Crossing = [Exact; 4];

/// A lens in both directions, and the film behind it.
struct BothWays {
    to_film: Path<Exact>,
    to_scene: Path<Exact>,
    rear: f64,
    film: f64,
}

impl BothWays {
    fn new(lens: &Lens, film: f64) -> Self {
        let path = |direction| Path::new(lens, direction, Refraction::Fused);
        Self {
            to_film: path(Direction::SceneToFilm),
            to_scene: path(Direction::FilmToScene),
            rear: lens.rear().vertex,
            film,
        }
    }

    /// Returns the crossing with the film of a ray that crosses the plane z = 0 and travels toward -z.
    fn back(&self, [x, y, sx, sy]: Crossing) -> Option<Crossing> {
        // The trace starts well in front of that plane, since the front surface may protrude from it.
        let before = exact(self.rear.abs());
        let origin = [x + before * sx, y + before * sy, before];
        let (point, direction, _) = self.to_film.trace_in_full(origin, [-sx, -sy, exact(-1.0)]).ok()?;
        Some(crossing((point, direction), exact(self.film) - exact(self.rear)))
    }

    /// Returns the crossing with the plane z = 0 of a ray from the film.
    fn out(&self, [x, y, sx, sy]: Crossing) -> Option<Crossing> {
        let from = [x, y, exact(self.film)];
        let (point, direction, _) = self.to_scene.trace_in_full(from, [sx, sy, exact(1.0)]).ok()?;
        Some(crossing((point, direction), Exact::ZERO))
    }
}

/// Returns the crossing of a ray with the plane at this z.
fn crossing(([x, y, z], [dx, dy, dz]): ([Exact; 3], [Exact; 3]), plane: Exact) -> Crossing {
    let (sx, sy) = (dx / dz, dy / dz);
    [x + (plane - z) * sx, y + (plane - z) * sy, sx, sy]
}

/// Returns the crossing of a single-precision ray, whose components are taken as exact.
fn crossing_of(ray: &WorldRay) -> Crossing {
    let [origin, direction] = [ray.origin, ray.direction].map(|v| v.map(|x| exact(x.into())));
    crossing((origin, direction), Exact::ZERO)
}

fn slopes([_, _, sx, sy]: Crossing) -> [f64; 2] {
    [sx.to_f64(), sy.to_f64()]
}

/// Returns the factor by which dx dy dslope² grows on the way to the film: the determinant of the Jacobian, by central
/// differences. `None` if a neighbour is blocked.
fn growth(both: &BothWays, at: Crossing) -> Option<f64> {
    // The relative error of central differences is about the square of the step.
    const STEP: f64 = 1e-8;
    let mut rows = [[0.0; 4]; 4];
    for (axis, row) in rows.iter_mut().enumerate() {
        let moved = |by: f64| {
            let mut moved = at;
            moved[axis] = moved[axis] + exact(by);
            both.back(moved)
        };
        let (ahead, behind) = (moved(STEP)?, moved(-STEP)?);
        *row = std::array::from_fn(|i| (ahead[i] - behind[i]).to_f64() / (2.0 * STEP));
    }
    Some(determinant(rows).abs())
}

/// Computes the determinant by elimination with pivoting.
fn determinant(mut rows: [[f64; 4]; 4]) -> f64 {
    let mut product = 1.0;
    for column in 0..4 {
        let size = |row: usize| rows[row][column].abs();
        let pivot = (column..4).max_by(|a, b| size(*a).total_cmp(&size(*b))).expect("rows");
        if pivot != column {
            rows.swap(pivot, column);
            product = -product;
        }
        product *= rows[column][column];
        let first = rows[column];
        for row in &mut rows[column + 1..] {
            let factor = row[column] / first[column];
            for (number, own) in row.iter_mut().zip(first) {
                *number -= factor * own;
            }
        }
    }
    product
}

/// Returns a film diagonal, mm; the lens illuminates most of that film.
fn film(lens: &str) -> &'static str {
    if lens.starts_with("phone") { "6" } else { "35" }
}

/// Returns samples all over picture and pupil.
fn sample(i: u32) -> Sample {
    let at = |step: f64| (0.5 + f64::from(i) * step).fract() as f32;
    Sample {
        image_x: RASTER.xres as f32 * at(0.856_674_883_854_502_9),
        image_y: RASTER.yres as f32 * at(0.733_891_856_627_126),
        lens_u: at(0.628_706_721_037_808_7),
        lens_v: at(0.538_597_257_225_901_9),
        time: 0.5,
    }
}

/// Returns a camera's rays with their samples, weights and importance.
fn rays(camera: &Camera, count: u32) -> Vec<(Sample, WorldRay, f32, Importance)> {
    let made: Vec<(Sample, WorldRay, f32)> = (0..count)
        .filter_map(|i| camera.ray(&sample(i)).map(|(ray, weight)| (sample(i), ray, weight)))
        .collect();
    let turned: Vec<WorldRay> = made
        .iter()
        .map(|(_, ray, _)| WorldRay { direction: ray.direction.map(|part| -part), ..*ray })
        .collect();
    let mut found = vec![Importance::default(); made.len()];
    camera.adjoint().expect("a lens has importance").arrive(&turned, &mut found);
    made.into_iter().zip(found).map(|((sample, ray, weight), found)| (sample, ray, weight, found)).collect()
}

fn facts(camera: &Camera) -> &Facts {
    camera.facts().expect("a camera with a lens")
}

fn raster_of(facts: &Facts, [x, y, ..]: Crossing) -> [f64; 2] {
    let [left, top] = facts.film.point(0.0, 0.0);
    let pixel = facts.film.pixel();
    [(left - x.to_f64()) / pixel, (y.to_f64() - top) / pixel]
}

#[test]
fn exact_rays_come_back_to_their_film_point() {
    for name in catalogue::round() {
        let camera = camera(&[("lens_file", name), ("film_diagonal", film(name))]);
        let facts = facts(&camera);
        let both = BothWays::new(&facts.lens, facts.film_z());
        let (mut there_and_back, mut off, mut rounded, mut all) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
        for (sample, ray, _, found) in rays(&camera, 120) {
            let Some(landed) = both.back(crossing_of(&ray)).filter(|_| found.importance > 0.0) else {
                continue;
            };
            all += 1;
            let again = both.out(landed).and_then(|out| both.back(out)).expect("the way that it came");
            for i in 0..4 {
                there_and_back = there_and_back.max((again[i] - landed[i]).to_f64().abs());
            }
            let raster = raster_of(facts, landed);
            let apart = |[x, y]: [f64; 2]| (x - raster[0]).hypot(y - raster[1]);
            off = off.max(apart(found.raster));
            rounded = rounded.max(apart([sample.image_x.into(), sample.image_y.into()]));
        }
        eprintln!("{name}: {all} rays, {there_and_back:.1e} mm, {off:.1e} and {rounded:.1e} pixels");
        assert!(all > 40, "{name}: {all}");
        assert!(there_and_back < 1e-22, "{name}: {there_and_back:e} mm");
        assert!(off < 1e-8, "{name}: {off:e} pixels");
        // Rays of the camera are rounded to single precision.
        assert!(rounded < 0.01, "{name}: {rounded:e} pixels");
    }
}

#[test]
fn etendue_is_the_same_on_both_sides_of_every_lens() {
    for name in catalogue::round() {
        let camera = camera(&[("lens_file", name), ("film_diagonal", film(name))]);
        let facts = facts(&camera);
        let both = BothWays::new(&facts.lens, facts.film_z());
        let (mut worst, mut all) = (0.0_f64, 0);
        for (_, ray, ..) in rays(&camera, 30) {
            let front = crossing_of(&ray);
            let (Some(landed), Some(growth)) = (both.back(front), growth(&both, front)) else { continue };
            all += 1;
            worst = worst.max((growth * cos4(slopes(landed)) / cos4(slopes(front)) - 1.0).abs());
        }
        eprintln!("{name}: {all} rays, {worst:.1e}");
        assert!(all > 10, "{name}: {all}");
        assert!(worst < 1e-9, "{name}: {worst:e}");
    }
}

#[test]
fn density_times_weight_is_importance() {
    for name in catalogue::round() {
        for weighting in ["radiometric", "assignment", "relative", "none"] {
            let camera = camera(&[
                ("lens_file", name),
                ("film_diagonal", film(name)),
                ("pupil", "disk"),
                ("weighting", weighting),
            ]);
            let facts = facts(&camera);
            let both = BothWays::new(&facts.lens, facts.film_z());
            let pupil = PupilDisk::exit(&facts.lens, facts.film_z()).slope_area();
            let pixel = facts.film.pixel();
            let film = f64::from(RASTER.xres) * pixel * f64::from(RASTER.yres) * pixel;
            let mut all = 0;
            for (_, ray, weight, found) in rays(&camera, 60) {
                let landed = both.back(crossing_of(&ray)).filter(|_| found.importance > 0.0);
                let Some(landed) = landed else { continue };
                all += 1;
                let expected = 1.0 / (film * pupil * cos4(slopes(landed)));
                let relative = found.density / expected - 1.0;
                assert!(relative.abs() < 1e-9, "{name} {weighting}: {relative:e}");
                let relative = found.importance / (found.density * f64::from(weight)) - 1.0;
                assert!(relative.abs() < 1e-5, "{name} {weighting}: {relative:e}");
            }
            assert!(all > 8, "{name} {weighting}: {all}");
        }
    }
}

#[test]
fn the_warped_pupils_density_is_that_of_its_samples() {
    const STEP: f32 = 1.0 / 256.0;
    for name in catalogue::round() {
        let camera = camera(&[("lens_file", name), ("film_diagonal", film(name))]);
        let facts = facts(&camera);
        let both = BothWays::new(&facts.lens, facts.film_z());
        let pixel = facts.film.pixel();
        let film = f64::from(RASTER.xres) * pixel * f64::from(RASTER.yres) * pixel;
        let mut apart: Vec<f64> = rays(&camera, 150)
            .iter()
            .filter(|(.., found)| found.importance > 0.0)
            .filter_map(|(sample, ray, _, found)| {
                let landed = slopes(both.back(crossing_of(ray))?);
                let moved = |u: f32, v: f32| {
                    let moved = Sample { lens_u: sample.lens_u + u, lens_v: sample.lens_v + v, ..*sample };
                    let (ray, _) = camera.ray(&moved)?;
                    Some(slopes(both.back(crossing_of(&ray))?))
                };
                let apart = |ahead: [f64; 2], behind: [f64; 2]| {
                    [0, 1].map(|i| (ahead[i] - behind[i]) / f64::from(2.0 * STEP))
                };
                let by_u = apart(moved(STEP, 0.0)?, moved(-STEP, 0.0)?);
                let by_v = apart(moved(0.0, STEP)?, moved(0.0, -STEP)?);
                let area = (by_u[0] * by_v[1] - by_u[1] * by_v[0]).abs();
                Some((found.density * film * area * cos4(landed) - 1.0).abs())
            })
            .collect();
        apart.sort_by(f64::total_cmp);
        let at = |part: f64| apart[(part * apart.len() as f64) as usize];
        eprintln!("{name}: {} rays, {:.1e} half, {:.1e} of nine in ten", apart.len(), at(0.5), at(0.9));
        assert!(apart.len() > 40, "{name}: {}", apart.len());
        // The map is smooth between two knots of its table; a difference across a knot matches the derivative on
        // neither side.
        assert!(at(0.5) < 2e-3 && at(0.9) < 0.02, "{name}: {:e} {:e}", at(0.5), at(0.9));
    }
}
