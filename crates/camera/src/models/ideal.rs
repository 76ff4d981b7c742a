//! The thick lens and the thin lens: ideal imaging with the first-order properties of a real lens.
//!
//! **Thick.** A ray travels from the film point to a point of the exit pupil and continues from principal
//! plane to principal plane at equal height (Kolb, Mitchell and Hanrahan 1995, §3.2): all rays of a film
//! point meet in one point of the plane in focus. The exit pupil has the position of the real lens's exit
//! pupil, and subtends the same angle at the film's centre as the pupil that exact rays find: the weight A
//! cos⁴θ'/Z² therefore gives the real lens's irradiance on the axis. By Abbe's sine condition, a real lens
//! has sin U' = D/2f for a beam of diameter D, while the thick lens has tan U' = D/2f: the beam of the thick
//! lens in the scene is wider than that of the real lens by the factor 1/cos U'. The thick lens has no
//! aberrations and no vignetting. Because it intersects no surface, it is the faster way to calculate the
//! ray.
//!
//! **Thin.** The thin lens is the same lens with both principal planes moved to the one on the scene's side,
//! and with the film at the same distance behind that plane, so that the picture and the plane in focus stay
//! the same. The pupil is the lens itself; its diameter keeps the cone of light at the film, and thus the
//! exposure.

use std::f64::consts::PI;

use super::lens_parts::representable;
use crate::{
    host::Host,
    importance::{AdjointCamera, Linear, PlaneMap},
    model::Model,
    parameters::{CameraError, ParameterError, Parameters, Weighting},
    pipeline::{body::CameraBody, ideal::ideal_tracer, ray_maker::RayMaker},
    plan::FilmSide,
    sampling::{DiskMapping, PupilDisk, PupilSampler},
    setup::{Facts, Focusing, Setup},
};
use realistic_base::message::{Log, short, short_above};
use realistic_optics::lens::first_order::FirstOrder;

/// A camera with an ideal lens. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct IdealCamera {
    facts: Facts,
    mapping: DiskMapping,
    rays: RayMaker,
    linear: Linear,
    units_per_mm: f64,
}

impl IdealCamera {
    /// Builds the thick lens that corresponds to the parameters' lens or, for [`Model::Thin`], the thin lens.
    /// `log` receives warnings.
    ///
    /// # Errors
    /// The error states the cause and what to give instead.
    pub fn build(
        parameters: &Parameters,
        host: &Host,
        model: Model,
        log: Log<'_>,
    ) -> Result<Self, CameraError> {
        let setup = Setup::of(parameters, host, Focusing::Paraxial, None, log)?;
        let facts = setup.facts;
        let (first_order, film_z) = (facts.first_order.clone()?, facts.film_z());
        let pupil = PupilDisk::exit(&facts.lens, film_z);
        let (imaging, film_z, pupil) = if model == Model::Thin {
            let image_distance = first_order.rear_principal_plane - film_z;
            if !(image_distance > 0.0) {
                let least = first_order.back_focal_distance() - first_order.rear_focal_length();
                return Err(ParameterError::Range {
                    name: "film_distance",
                    value: short(facts.film_distance),
                    range: format!("more than {} mm, where the thin lens lies", short_above(least)),
                }
                .into());
            }
            let imaging = first_order.thin_at(first_order.front_principal_plane);
            let film_z = imaging.rear_principal_plane - image_distance;
            (imaging, film_z, PupilDisk::about_axis(image_distance, pupil.slope_radius()))
        } else {
            (first_order, film_z, pupil)
        };
        let radiance_factor = facts.lens.radiance_factor();
        let weight = match setup.weighting {
            Weighting::Radiometric => Some(setup.exposure * radiance_factor),
            Weighting::Assignment => {
                Some(radiance_factor / pupil.area().ok_or(CameraError::PupilAtInfinity)?)
            }
            // ∫ cos⁴ d(slope)² over a disk of radius s is π s²/(1 + s²).
            Weighting::Relative => Some(pupil.slope_area().recip() + PI.recip()),
            Weighting::None => None,
        };
        let area = pupil.slope_area();
        representable(area)?;
        representable(weight.map_or(1.0, |weight| weight * area.max(PI)))?;
        let body = CameraBody {
            coatings: None,
            film_side: FilmSide {
                film: facts.film,
                z: film_z,
                mapping: setup.mapping,
                sampler: PupilSampler::Disk(pupil),
            },
            weight,
            placement: setup.placement,
            units_per_mm: setup.mm_per_unit.recip(),
        };
        let tracer = ideal_tracer(&imaging, &body);
        Ok(Self {
            linear: linear(&imaging, &pupil, &body),
            units_per_mm: body.units_per_mm,
            facts,
            mapping: setup.mapping,
            rays: RayMaker::new(tracer.clone(), tracer, body.placement),
        })
    }

    /// Returns the lens whose first-order properties the camera has, and the film.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    pub fn ray_maker(&self) -> &RayMaker {
        &self.rays
    }

    pub fn mapping(&self) -> DiskMapping {
        self.mapping
    }

    /// Returns the adjoint camera.
    pub fn adjoint(&self) -> AdjointCamera {
        let (placement, front) = (self.rays.placement(), self.facts.lens.front());
        let area = PI * front.semi_diameter * front.semi_diameter;
        AdjointCamera::of_linear(
            &self.linear,
            placement,
            self.units_per_mm,
            area,
            placement.clip.map(f64::from),
        )
    }
}

/// Returns film and pupil coordinates as linear functions of a ray's height and slope in the front vertex
/// plane.
fn linear(imaging: &FirstOrder, pupil: &PupilDisk, body: &CameraBody) -> Linear {
    let FilmSide { film, z, .. } = &body.film_side;
    // The inverse of the matrix from the film.
    let determinant = imaging.n_film / imaging.n_scene;
    let [[a, b], [c, d]] = imaging.from_film(*z).map(|row| row.map(|number| number / determinant));
    let at_film = PlaneMap { from_height: d, from_slope: -b };
    let slope = PlaneMap { from_height: -c, from_slope: a };
    // A disk coordinate is the ray's slope minus the slope to the disk's centre.
    let center = pupil.seen_from([1.0, 0.0]).center[0];
    let lens = PlaneMap {
        from_height: slope.from_height - center * at_film.from_height,
        from_slope: slope.from_slope - center * at_film.from_slope,
    };
    let ([x, y], [right, up], per_mm) = (film.middle(), film.surface().shift(), film.pixel().recip());
    Linear {
        film: at_film,
        lens,
        lens_radius: pupil.slope_radius(),
        weight: body.weight.map(|weight| (slope, weight * pupil.slope_area())),
        raster: [[-per_mm, x + right * per_mm], [per_mm, y - up * per_mm]],
        size: [2.0 * x, 2.0 * y],
        depths: [0.0, f64::INFINITY],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Raster, rays::WorldRay, samples::Sample};
    use realistic_optics::imaging::irradiance::on_axis;
    use realistic_optics::{imaging::focus::DepthOfField, trace::Path};

    fn ideal(model: &str, settings: &[(&str, &str)]) -> IdealCamera {
        let mut parameters = Parameters::default();
        for (name, text) in settings {
            parameters.set_from_text(name, text).expect("valid");
        }
        let host = Host::new(Raster { xres: 300, yres: 200 }, None);
        IdealCamera::build(&parameters, &host, model.parse().expect("listed"), &mut |_, text| {
            panic!("{text}")
        })
        .expect("built")
    }

    fn sample(image: [f32; 2], lens: [f32; 2]) -> Sample {
        Sample { image_x: image[0], image_y: image[1], lens_u: lens[0], lens_v: lens[1], time: 0.0 }
    }

    fn ray(camera: &IdealCamera, image: [f32; 2], lens: [f32; 2]) -> (WorldRay, f64) {
        let (ray, weight) = camera.rays.ray(&sample(image, lens)).expect("a ray");
        (ray, weight.into())
    }

    /// Returns the ray through the middle of the pupil.
    fn central(camera: &IdealCamera, image: [f32; 2]) -> WorldRay {
        ray(camera, image, [0.5; 2]).0
    }

    /// Returns the exit pupil's radius in slopes.
    fn slope_radius(camera: &IdealCamera) -> f64 {
        PupilDisk::exit(&camera.facts.lens, camera.facts.film_z()).slope_radius()
    }

    fn at_depth(ray: &WorldRay, z: f64) -> [f64; 2] {
        let t = (z - f64::from(ray.origin[2])) / f64::from(ray.direction[2]);
        [0, 1].map(|i| f64::from(ray.origin[i]) + t * f64::from(ray.direction[i]))
    }

    const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
    const PUPIL: [[f32; 2]; 5] = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.4], [0.2, 0.9], [0.6, 0.1]];

    #[test]
    fn rays_of_a_film_point_meet_in_the_plane_of_focus() {
        for model in ["thick", "thin"] {
            for lens in LENSES {
                let camera = ideal(model, &[("lens_file", lens), ("focus_distance", "2500")]);
                let plane = camera.facts.film_z() + 2500.0;
                for image in [[150.0, 100.0], [10.0, 20.0], [250.0, 199.0]] {
                    let center = at_depth(&central(&camera, image), plane);
                    for numbers in PUPIL {
                        let point = at_depth(&ray(&camera, image, numbers).0, plane);
                        let apart = (point[0] - center[0]).hypot(point[1] - center[1]);
                        assert!(apart < 2e-3, "{model} {lens} {image:?}: {apart} mm");
                    }
                }
            }
        }
    }

    #[test]
    fn the_thin_lens_has_the_thick_ones_picture() {
        for lens in LENSES {
            let [thick, thin] = ["thick", "thin"]
                .map(|model| ideal(model, &[("lens_file", lens), ("focus_distance", "3000")]));
            let plane = thick.facts.film_z() + 3000.0;
            for image in [[10.0, 20.0], [250.0, 199.0]] {
                let [a, b] = [&thick, &thin].map(|camera| at_depth(&central(camera, image), plane));
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 2e-3, "{lens} {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn rays_through_the_exit_pupils_edge_pass_the_entrance_pupils_edge() {
        // A ray through the edge of the exit pupil on the film's side passes the edge of the entrance pupil in the
        // scene, which is wider than the lens's by 1/cos U'.
        let camera = ideal("thick", &[("fnumber", "5.6")]);
        let pupil = camera.facts.beam.entrance;
        let pupil_z = pupil.position().expect("finite");
        let slope = slope_radius(&camera);
        let radius = pupil.diameter() / 2.0 * (1.0 + slope * slope).sqrt();
        assert!((slope / (1.0 + slope * slope).sqrt() * 2.0 * 5.6 - 1.0).abs() < 2e-3, "{slope}");
        for image in [[150.0, 100.0], [20.0, 40.0]] {
            for numbers in [[1.0, 0.5], [0.5, 1.0], [0.0, 0.5]] {
                let [x, y] = at_depth(&ray(&camera, image, numbers).0, pupil_z);
                assert!((x.hypot(y) / radius - 1.0).abs() < 2e-3, "{image:?} {numbers:?}");
            }
        }
    }

    #[test]
    fn the_exposure_on_the_axis_is_the_lenss() {
        for (lens, fnumber) in
            LENSES.into_iter().chain(["planar.50mm", "biotar.100mm"]).zip(["22", "2.8", "6", "4", "1.4", "2"])
        {
            for model in ["thick", "thin"] {
                let camera = ideal(model, &[("lens_file", lens), ("fnumber", fnumber)]);
                let real = Path::<f64>::film_to_scene(&camera.facts.lens);
                let film = camera.facts.film_z();
                let exact = on_axis(&real, film, 4.0 * slope_radius(&camera));
                let n = 64_u8;
                let mut mean = 0.0;
                for i in 0..n {
                    for j in 0..n {
                        let numbers = [i, j].map(|k| (f32::from(k) + 0.5) / f32::from(n));
                        mean += ray(&camera, [150.0, 100.0], numbers).1 / f64::from(n).powi(2);
                    }
                }
                assert!((mean / exact - 1.0).abs() < 1e-3, "{model} {lens}: {mean} {exact}");
            }
        }
    }

    #[test]
    fn points_at_the_depth_limits_are_circles_of_confusion() {
        const CONFUSION: f64 = 0.03;
        let camera = ideal("thick", &[("focus_distance", "2500"), ("fnumber", "8")]);
        let film = camera.facts.film_z();
        let Facts { lens, beam, film_distance, .. } = &camera.facts;
        // The pupil of the thick lens itself.
        let slope = slope_radius(&camera);
        let entrance = beam.entrance.with_diameter(beam.diameter() * (1.0 + slope * slope).sqrt());
        let range = DepthOfField::of(lens, &entrance, *film_distance, 2500.0, CONFUSION)
            .expect("not afocal")
            .expect("a pupil at a finite distance");
        let focus = film + 2500.0;
        let height = |image: f32| at_depth(&central(&camera, [image, 100.0]), focus)[0];
        let magnification = 100.0 * camera.facts.film.pixel() / (height(200.0) - height(100.0));
        let pupil = entrance.position().expect("finite");
        for limit in [range.near, range.far] {
            let plane = film + limit;
            // Width of the cone from the film's centre to the pupil's edge and, by similar triangles, the
            // blur in the plane in focus of a point in this plane.
            let cone = 2.0 * at_depth(&ray(&camera, [150.0, 100.0], [1.0, 0.5]).0, plane)[0].abs();
            let blur = cone * (focus - pupil) / (plane - pupil) * magnification;
            assert!((blur / CONFUSION - 1.0).abs() < 2e-3, "{limit} mm: {blur} mm");
        }
    }

    #[test]
    fn the_weightings_agree_with_their_definitions() {
        let with = |weighting: &str| {
            let camera = ideal("thick", &[("fnumber", "4"), ("weighting", weighting)]);
            let (_, weight) = ray(&camera, [150.0, 100.0], [1.0, 0.5]);
            (weight, PupilDisk::exit(&camera.facts.lens, camera.facts.film_z()))
        };
        let (radiometric, pupil) = with("radiometric");
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
        close(with("assignment").0, radiometric / pupil.area().expect("finite"));
        let slope = pupil.slope_radius();
        close(with("relative").0, radiometric / (PI * slope * slope / (1.0 + slope * slope)));
        assert_eq!(with("none").0, 1.0);
    }
}
