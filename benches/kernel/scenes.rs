//! Lenses, and rays from their films that pass.

use realistic_camera::sampling::PupilDisk;
use realistic_lab::{
    subject::{FilmRays, passing_rays},
    timing::LARGE_LENSES,
};
use realistic_optics::{
    lens::{Lens, Surface},
    prescription::{Prescription, catalogue, read},
    trace::{Path, Ray},
};
use realistic_trace::kernel::KernelScalar;

/// A lens and its film plane.
pub struct Scene {
    pub name: &'static str,
    pub lens: Lens,
    /// z of the film, mm.
    pub film: f64,
    /// Largest distance of rays' film points from the axis, mm.
    pub reach: f64,
}

impl Scene {
    /// Returns `count` rays through the whole pupil.
    pub fn rays(&self, count: usize) -> Vec<Ray> {
        let cover = PupilDisk::rear(&self.lens, self.film, self.reach).expect("film behind the lens");
        passing_rays(&Path::<f64>::film_to_scene(&self.lens), self.film, self.reach, cover, count, 0)
    }

    /// Returns `count` rays through the whole pupil as a batch.
    pub fn film_rays<S: KernelScalar>(&self, count: usize) -> FilmRays<S> {
        FilmRays::new(self.film, &self.rays(count))
    }
}

/// Distance from the axis within which rays pass every lens here, mm.
const REACH: f64 = 3.0;

/// Returns the four lenses of the assignment, two of realistic size, and one of 26 surfaces.
pub fn all() -> Vec<Scene> {
    let scene = |name, prescription: &Prescription, distance: f64| {
        let lens = Lens::at_d_line(prescription);
        let film = lens.rear().vertex - distance;
        Scene { name, lens, film, reach: REACH }
    };
    let film = |name, distance| scene(name, &catalogue::find(name).expect("a catalogue lens"), distance);
    let large = |(name, path): (&'static str, &str), distance| {
        let file = std::fs::read(path).expect("it is in the repository");
        scene(name, &read(name, &file).expect("a lens"), distance)
    };
    let many = many_surfaces(26);
    let behind = many.rear().vertex - 60.0;
    vec![
        film("dgauss.50mm", 36.1),
        film("wide.22mm", 14.3),
        film("telephoto.250mm", 105.0),
        film("fisheye.10mm", 23.2),
        large(LARGE_LENSES[0], 35.9),
        large(LARGE_LENSES[1], 35.3),
        Scene { name: "26 surfaces", lens: many, film: behind, reach: REACH },
    ]
}

/// Builds a lens of alternating thin menisci and biconvex elements, separated by air, weak enough to
/// transmit light.
fn many_surfaces(n: u16) -> Lens {
    let surfaces = (0..n).map(|i| {
        let glass = if i % 2 == 0 { (1.0, 1.6) } else { (1.6, 1.0) };
        let radius: f64 = [120.0, -150.0, 90.0, 100.0][usize::from(i % 4)];
        Surface {
            vertex: -2.5 * f64::from(i),
            radius,
            curvature: radius.recip(),
            figure: None,
            unsymmetric: None,
            thickness: if i + 1 < n { 2.5 } else { 0.0 },
            n_scene: glass.0,
            n_film: glass.1,
            absorption: 0.0,
            semi_diameter: 12.0,
            is_stop: false,
            is_mirror: false,
            is_reversed: false,
            coordinate_break: None,
            apertures: std::sync::Arc::default(),
            is_contact: false,
        }
    });
    Lens {
        name: format!("{n} surfaces"),
        surfaces: surfaces.collect(),
        wavelength: 587.56,
        nominal_film_distance: None,
        film_break: None,
    }
}
