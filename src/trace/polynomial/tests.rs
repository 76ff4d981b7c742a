use super::*;
use crate::{
    camera::{PupilDisk, ray_set::passing_rays},
    optics::first_order::FirstOrder,
    prescription::catalogue,
};

struct Subject {
    lens: Lens,
    film: f64,
    reach: f64,
}

impl Subject {
    fn new(name: &str) -> Self {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let film = FirstOrder::of(&lens).expect("focal").rear_focal_point;
        Self { lens, film, reach: 17.5 }
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

/// Median and largest direction errors, rad, and the median position error, mm.
fn errors(subject: &Subject, model: impl Fn(Ray) -> Ray) -> (f64, f64, f64) {
    let path = Path::<f64>::film_to_scene(&subject.lens);
    let pairs: Vec<_> =
        subject.rays(600, 1).into_iter().map(|ray| (model(ray), path.trace(ray).expect("passes"))).collect();
    let sorted = |measure: &dyn Fn(&(Ray, Ray)) -> f64| {
        let mut all: Vec<f64> = pairs.iter().map(measure).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let direction = sorted(&|(a, b)| distance(a.direction, b.direction));
    let position = sorted(&|(a, b)| distance(a.origin, b.origin));
    (direction[300], direction[599], position[300])
}

#[test]
fn fresh_rays_are_met_better_with_every_order() {
    for name in catalogue::names() {
        let subject = Subject::new(name);
        let mut before = (f64::INFINITY, f64::INFINITY);
        for order in [1, 3, 5, 7, 9, 11] {
            let polynomial = subject.fit(order);
            let (median, most, position) = errors(&subject, |ray| polynomial.transfer(ray));
            println!("{name} order {order}: {median:.1e} median, {most:.1e} max rad, {position:.1e} mm");
            assert!(median < before.0 / 1.5 && position < before.1 / 1.5, "{name} order {order}");
            before = (median, position);
        }
    }
}

#[test]
fn near_the_axis_they_are_the_thick_lens() {
    for name in catalogue::names() {
        let subject = Subject::new(name);
        let thick = FirstOrder::of(&subject.lens).expect("focal");
        let polynomial = subject.fit(11);
        // Half a thousandth of the film and of a slope of 1: what is left is the fit.s error.
        for (x, slope) in [(5e-3, 0.0), (0.0, 5e-4), (-3e-3, 4e-4)] {
            let ray = Ray { origin: [x, -x, subject.film], direction: [slope, 2.0 * slope, 1.0] };
            let (mut a, b) = (polynomial.transfer(ray), thick.transfer(ray));
            let back = a.origin[2] / a.direction[2];
            (0..3).for_each(|i| a.origin[i] -= back * a.direction[i]);
            let (p, d) = (distance(a.origin, b.origin), distance(a.direction, b.direction));
            assert!(d < 1e-7 && p < 1e-6, "{name}: {d:e} rad, {p:e} mm");
        }
    }
}

#[test]
fn batches_are_the_single_rays_in_their_numbers() {
    let subject = Subject::new("wide.22mm");
    let polynomial = subject.fit(7);
    // 37: no whole number of lanes of any width.
    let rays = subject.rays(37, 3);
    let columns = RayColumns::at_film(&rays, subject.film);
    let mut doubles = RayColumns::default();
    PolynomialBatch::<f64>::new(&polynomial).transfer(&columns, &mut doubles);
    let mut singles = RayColumns::default();
    PolynomialBatch::<f32>::new(&polynomial)
        .transfer(&RayColumns::at_film(&rays, subject.film), &mut singles);
    for (i, ray) in rays.iter().enumerate() {
        let own = polynomial.transfer(*ray);
        let (wide, narrow) = (doubles.ray(i), singles.ray(i));
        assert!(distance(own.direction, wide.direction) < 1e-14 && distance(own.origin, wide.origin) < 1e-12);
        assert!(distance(own.direction, narrow.direction) < 2e-6, "{own:?} {narrow:?}");
        assert!((distance(own.direction, [0.0; 3]) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let subject = Subject::new("dgauss.50mm");
    let rays = subject.rays(50, 0);
    assert_eq!(Polynomial::fit(&subject.lens, subject.film, &rays, 4), Err(FitError::Order(4)));
    let few = Polynomial::fit(&subject.lens, subject.film, &rays, 11);
    assert_eq!(few, Err(FitError::Undetermined { order: 11, passing: 50, needed: 224 }));
    let axial = vec![Ray { origin: [0.0, 0.0, subject.film], direction: [0.0, 0.0, 1.0] }; 500];
    assert!(matches!(
        Polynomial::fit(&subject.lens, subject.film, &axial, 3),
        Err(FitError::Undetermined { .. })
    ));
}
