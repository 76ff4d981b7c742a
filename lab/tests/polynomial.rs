//! Polynomials against the rays that they are fitted to, and against the thick lens.

use realistic_camera::sampling::PupilDisk;
use realistic_lab::subject::{FilmRays, passing_rays};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    prescription::catalogue,
    trace::{Path, Ray, Real},
};
use realistic_trace::{
    kernel::KernelScalar,
    polynomial::{FitError, Polynomial, PolynomialLens},
};

struct Subject {
    lens: Lens,
    film: f64,
    reach: f64,
}

/// Returns the catalogue except the telephone's lens, most of whose rays miss an aperture under polynomials of low
/// order.
fn names() -> impl Iterator<Item = &'static str> {
    catalogue::round().filter(|name| *name != "phone.4mm")
}

impl Subject {
    fn new(name: &str) -> Self {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let film = FirstOrder::of(&lens).expect("focal").rear_focal_point;
        // The height up to which these two lenses illuminate the film is given.
        let reach = match name {
            "phone.4mm" => 2.5,
            "fisheye.6mm" => 10.0,
            _ => 17.5,
        };
        Self { lens, film, reach }
    }

    fn rays(&self, count: usize, seed: u32) -> Vec<Ray> {
        let cover = PupilDisk::rear(&self.lens, self.film, self.reach).expect("film behind the lens");
        passing_rays(&Path::<f64>::film_to_scene(&self.lens), self.film, self.reach, cover, count, seed)
    }

    fn fit(&self, order: usize) -> Polynomial {
        Polynomial::fit(&self.lens, self.film, &self.rays(1500, 0), order).expect("enough rays")
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Returns the ray through a lens of polynomials.
fn through(polynomial: &Polynomial, ray: Ray) -> Option<Ray> {
    let ([x, y, _], [dx, dy, dz]) = (ray.origin, ray.direction);
    let traced = PolynomialLens::<f64>::new(polynomial).trace_one([x, y], [dx / dz, dy / dz])?;
    Some(Ray { origin: traced.origin, direction: traced.direction })
}

/// Returns the median and largest direction errors, rad, and the median position error, mm.
fn errors(subject: &Subject, polynomial: &Polynomial) -> (f64, f64, f64) {
    let path = Path::<f64>::film_to_scene(&subject.lens);
    let pairs: Vec<_> = subject
        .rays(600, 1)
        .into_iter()
        .filter_map(|ray| Some((through(polynomial, ray)?, path.trace(ray).expect("passes"))))
        .collect();
    // Order 1 sends 29 of a fisheye's rays past the edge of its front surface.
    assert!(pairs.len() > 560, "{} of 600", pairs.len());
    let sorted = |measure: &dyn Fn(&(Ray, Ray)) -> f64| {
        let mut all: Vec<f64> = pairs.iter().map(measure).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let direction = sorted(&|(a, b)| distance(a.direction, b.direction));
    let position = sorted(&|(a, b)| distance(a.origin, b.origin));
    (direction[300], direction[direction.len() - 1], position[300])
}

#[test]
fn fresh_rays_are_met_better_with_every_order() {
    for name in names() {
        let subject = Subject::new(name);
        // An asphere's own terms exceed these orders.
        let least =
            if subject.lens.surfaces.iter().all(|surface| surface.figure.is_none()) { 1.5 } else { 1.0 };
        let mut before = (f64::INFINITY, f64::INFINITY);
        for order in [1, 3, 5, 7, 9, 11] {
            let polynomial = subject.fit(order);
            let (median, most, position) = errors(&subject, &polynomial);
            println!("{name} order {order}: {median:.1e} median, {most:.1e} max rad, {position:.1e} mm");
            assert!(median < before.0 / least && position < before.1 / least, "{name} order {order}");
            before = (median, position);
        }
    }
}

#[test]
fn near_the_axis_they_are_the_thick_lens() {
    for name in names() {
        let subject = Subject::new(name);
        let thick = FirstOrder::of(&subject.lens).expect("focal");
        let polynomial = subject.fit(11);
        // Only half a thousandth of the film and of a slope of 1 remain: the residual is the fit's error, at most half
        // of the error on the whole film.
        let (median, _, position) = errors(&subject, &polynomial);
        let most = [(0.5 * median).max(1e-7), (0.5 * position).max(1e-6)];
        for (x, slope) in [(5e-3, 0.0), (0.0, 5e-4), (-3e-3, 4e-4)] {
            let ray = Ray { origin: [x, -x, subject.film], direction: [slope, 2.0 * slope, 1.0] };
            let (mut a, b) = (through(&polynomial, ray).expect("near the axis"), thick.transfer(ray));
            let back = a.origin[2] / a.direction[2];
            (0..3).for_each(|i| a.origin[i] -= back * a.direction[i]);
            let (p, d) = (distance(a.origin, b.origin), distance(a.direction, b.direction));
            assert!(d < most[0] && p < most[1], "{name}: {d:e} rad, {p:e} mm");
        }
    }
}

/// Traces rays through the polynomials in a batch.
fn batch<S: KernelScalar + Real>(film: f64, polynomial: &Polynomial, rays: &[Ray]) -> FilmRays<S> {
    let lens = PolynomialLens::<S>::new(polynomial);
    let mut rays = FilmRays::new(film, rays);
    rays.trace(rays.count(), |from, to| lens.trace_batch(from, to));
    rays
}

#[test]
fn polynomial_batches_are_single_rays_to_the_precision() {
    let subject = Subject::new("wide.22mm");
    let polynomial = subject.fit(7);
    // 37 is not a multiple of any number of lanes.
    let rays = subject.rays(37, 3);
    let doubles = batch::<f64>(subject.film, &polynomial, &rays);
    let singles = batch::<f32>(subject.film, &polynomial, &rays);
    for (i, ray) in rays.iter().enumerate() {
        let own = through(&polynomial, *ray).expect("passes");
        assert_eq!(doubles.traced(i), Some(own));
        let narrow = singles.traced(i).expect("passes").direction;
        assert!(distance(own.direction, narrow) < 2e-6, "{own:?} {narrow:?}");
        assert!((distance(own.direction, [0.0; 3]) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn polynomials_block_where_the_apertures_do() {
    let subject = Subject::new("dgauss.50mm");
    let path = Path::<f64>::film_to_scene(&subject.lens);
    let last = subject.lens.surfaces.len() - 1;
    let fit = |apertures: &[usize]| {
        Polynomial::with_apertures(&subject.lens, subject.film, &subject.rays(1500, 0), 9, apertures)
            .map(|polynomial| PolynomialLens::<f64>::new(&polynomial))
            .expect("enough rays")
    };
    let stop = subject.lens.stop_index().expect("a stop");
    let blind = fit(&[]);
    let lens = fit(&[last, stop, 2]);
    let (mut blocked, mut missed, mut wrong) = (0, 0, 0);
    for i in 0..60 {
        for j in 0..60 {
            let at = |k: i32| 0.9 * (f64::from(k) / 59.0 - 0.5);
            let (point, slopes) = ([0.0, 6.0], [at(i), at(j) - 0.1]);
            let ray = Ray { origin: [0.0, 6.0, subject.film], direction: [slopes[0], slopes[1], 1.0] };
            let passes = path.trace(ray).is_ok();
            let traced = lens.trace_one(point, slopes);
            if let (Some(traced), Some(free)) = (traced, blind.trace_one(point, slopes)) {
                assert_eq!(traced.direction, free.direction);
                assert_eq!(traced.origin, free.origin);
            }
            blocked += i32::from(!passes);
            missed += i32::from(!passes && blind.trace_one(point, slopes).is_some());
            wrong += i32::from(passes != traced.is_some());
        }
    }
    assert!(blocked > 500 && missed > 100, "{blocked} blocked, {missed} unknown without apertures");
    assert!(wrong <= 12, "{wrong} of 3600");
}

#[test]
fn fits_without_enough_rays_are_refused() {
    let subject = Subject::new("dgauss.50mm");
    let rays = subject.rays(50, 0);
    assert_eq!(Polynomial::fit(&subject.lens, subject.film, &rays, 4), Err(FitError::Order(4)));
    let fit = Polynomial::fit(&subject.lens, subject.film, &rays, 11);
    assert_eq!(fit, Err(FitError::Undetermined { order: 11, passing: 50, needed: 224 }));
    let axial = vec![Ray { origin: [0.0, 0.0, subject.film], direction: [0.0, 0.0, 1.0] }; 500];
    assert!(matches!(
        Polynomial::fit(&subject.lens, subject.film, &axial, 3),
        Err(FitError::Undetermined { .. })
    ));
}
