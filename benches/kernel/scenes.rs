//! Lenses, and film rays that mostly get through them.

use realistic::{
    lens::{Lens, Surface, pupil::ExitPupil},
    prescription::catalogue,
    trace::{Ray, Real},
};

/// A lens and where its film is.
pub struct Scene {
    pub name: &'static str,
    pub lens: Lens,
    /// z of the film, mm.
    film: f64,
}

/// The four lenses of the assignment, and one of 26 surfaces.
pub fn all() -> Vec<Scene> {
    let film = |name, distance: f64| {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("a catalogue lens"));
        let film = lens.rear().vertex - distance;
        Scene { name, lens, film }
    };
    let many = many_surfaces(26);
    let behind = many.rear().vertex - 60.0;
    vec![
        film("dgauss.50mm", 36.1),
        film("wide.22mm", 14.3),
        film("telephoto.250mm", 105.0),
        film("fisheye.10mm", 23.2),
        Scene { name: "26 surfaces", lens: many, film: behind },
    ]
}

/// Thin menisci and biconvex elements in turn, with air between, as weak as it takes to let light through.
fn many_surfaces(n: u16) -> Lens {
    let surfaces = (0..n).map(|i| {
        let glass = if i % 2 == 0 { (1.0, 1.6) } else { (1.6, 1.0) };
        let radius: f64 = [120.0, -150.0, 90.0, 100.0][usize::from(i % 4)];
        Surface {
            vertex: -2.5 * f64::from(i),
            radius,
            curvature: radius.recip(),
            thickness: if i + 1 < n { 2.5 } else { 0.0 },
            n_scene: glass.0,
            n_film: glass.1,
            semi_diameter: 12.0,
            is_stop: false,
        }
    });
    Lens {
        name: format!("{n} surfaces"),
        surfaces: surfaces.collect(),
        wavelength: 587.56,
        nominal_film_distance: None,
    }
}

/// Film rays as structure of arrays.
#[derive(Clone)]
pub struct Film<S> {
    pub plane: f64,
    pub x: Vec<S>,
    pub y: Vec<S>,
    pub slope_x: Vec<S>,
    pub slope_y: Vec<S>,
}

impl<S: Real> Film<S> {
    /// `n` rays from near the film's centre through two thirds of the exit pupil's radius, all but
    /// evenly spread (R2 sequence, M. Roberts 2018).
    pub fn new(scene: &Scene, n: usize) -> Self {
        let pupil = ExitPupil::of_lens(&scene.lens, scene.film);
        let mut film = Self { plane: scene.film, x: vec![], y: vec![], slope_x: vec![], slope_y: vec![] };
        for i in 0..n {
            let number = |step: f64| (0.5 + step * i as f64).fract();
            let [u, v] = [number(0.754_877_666_246_692_8), number(0.569_840_290_998_053_2)];
            let [x, y] =
                [number(0.819_172_513_396_164_4), number(0.671_043_606_703_789_3)].map(|t| 6.0 * t - 3.0);
            let disk = pupil.slopes(x, y, scene.film);
            let (radius, angle) = (disk.radius * 0.66 * u.sqrt(), std::f64::consts::TAU * v);
            film.x.push(S::from_f64(x));
            film.y.push(S::from_f64(y));
            film.slope_x.push(S::from_f64(disk.center[0] + radius * angle.cos()));
            film.slope_y.push(S::from_f64(disk.center[1] + radius * angle.sin()));
        }
        film
    }

    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Point and slopes of a ray.
    pub fn at(&self, i: usize) -> ([S; 2], [S; 2]) {
        ([self.x[i], self.y[i]], [self.slope_x[i], self.slope_y[i]])
    }

    pub fn rays(&self) -> Vec<Ray> {
        let ray = |i| {
            let ([x, y], [sx, sy]) = self.at(i);
            Ray { origin: [x.to_f64(), y.to_f64(), self.plane], direction: [sx.to_f64(), sy.to_f64(), 1.0] }
        };
        (0..self.len()).map(ray).collect()
    }
}
