//! The realistic camera, which traces a sample's ray through every surface of the lens (Kolb, Mitchell and
//! Hanrahan 1995).

use std::sync::Arc;

use super::lens_parts::{
    Tracers, ghost_rays, plan_and_compile, pupil_sampler, rear_disk, weight_factor, weighted_coatings,
};
use crate::{
    host::{Host, Log},
    importance::{AdjointCamera, AdjointLens},
    parameters::{CameraError, Parameters},
    pipeline::{
        body::CameraBody,
        ghosts::GhostRays,
        ray_maker::RayMaker,
        spectral::{LensOfMedia, Spectral},
    },
    plan::{FilmSide, Plan},
    rays::{Outcome, WorldRay},
    samples::Sample,
    sampling::{PupilDisk, film_rays::FilmRays},
    setup::{Facts, Focusing, Setup, SharedLens},
};
use realistic_optics::{
    lens::film_ray,
    trace::{Direction, Path, Ray},
};
use realistic_trace::field::Field;

/// A camera with a real lens. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct RealisticCamera {
    facts: Facts,
    body: CameraBody,
    /// The disk that contains the pupils of all film points.
    rear: PupilDisk,
    /// The path through the lens from film to scene, used to find the reason why a sample has no ray.
    path: Path,
    ghosts: Option<Arc<GhostRays>>,
    tracers: Tracers,
    rays: RayMaker,
    plan: Plan,
    shared: SharedLens,
}

impl RealisticCamera {
    /// Builds a camera of the model "lens". `log` receives warnings.
    ///
    /// # Errors
    /// The error states the cause and what to give instead.
    pub fn build(parameters: &Parameters, host: &Host, log: Log<'_>) -> Result<Self, CameraError> {
        Self::build_from(None, parameters, host, log)
    }

    /// Builds the same camera as [`RealisticCamera::build`], identical to the last bit; reuses the parts of
    /// the donor that depend only on settings that have not changed.
    ///
    /// # Errors
    /// The errors of [`RealisticCamera::build`].
    pub fn build_from(
        donor: Option<&Self>,
        parameters: &Parameters,
        host: &Host,
        log: Log<'_>,
    ) -> Result<Self, CameraError> {
        parameters.require_lens()?;
        let donor = donor.map(|camera| &camera.shared);
        let setup = Setup::of(parameters, host, Focusing::Exact, donor, log)?;
        Self::from_setup(setup, log)
    }

    /// Builds the camera of a checked set-up, each part once, in the order in which the parts depend on one
    /// another.
    fn from_setup(setup: Setup, log: Log<'_>) -> Result<Self, CameraError> {
        let Facts { lens, film, .. } = &setup.facts;
        let path = Path::new(lens, Direction::FilmToScene, setup.refraction).with_apertures(lens);
        let film_z = setup.facts.film_z();
        let rear = rear_disk(&setup, film_z)?;
        let exit = PupilDisk::exit(lens, film_z);
        let sampler = pupil_sampler(&setup, &path, film_z, [rear, exit], log);
        let weight = weight_factor(&setup, &path, film_z, &sampler, [rear, exit])?;
        let body = CameraBody {
            film_side: FilmSide { film: *film, z: film_z, mapping: setup.mapping, sampler },
            weight,
            coatings: weighted_coatings(&setup, log),
            placement: setup.placement.clone(),
            units_per_mm: setup.mm_per_unit.recip(),
        };
        let (mut tracers, plan) = plan_and_compile(&setup, &path, &body, log);
        let ghosts = ghost_rays(&setup, rear, &body, log);
        if let Some(ghosts) = &ghosts {
            tracers = tracers.with_ghosts(ghosts);
        }
        let mut rays = RayMaker::new(tracers.one.clone(), tracers.many.clone(), body.placement.clone());
        // With a tolerance, the camera's own tracer may be approximate; rays at wavelengths need the exact
        // tracer.
        if setup.is_dispersive() || setup.tolerance > 0.0 {
            let Setup { media, transmittances, .. } = setup;
            let optics = LensOfMedia { lens: lens.clone(), media, transmittances };
            rays.set_spectral(Spectral::new(optics, body.clone(), tracers.exact, ghosts.clone()));
        }
        // The film distance that corresponds to the rounded z of the film.
        let film_distance = setup.facts.lens.rear().vertex - film_z;
        let facts = Facts { film_distance, ..setup.facts };
        Ok(Self { facts, body, rear, path, ghosts, tracers, rays, plan, shared: setup.shared })
    }

    /// Returns the ray of a sample and its weight, which is positive; `None` for a blocked sample.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        self.rays.ray(sample)
    }

    /// Returns the reason why a sample has no ray.
    pub fn why_none(&self, sample: &Sample) -> Outcome {
        let ghost = |ghosts: &Arc<GhostRays>| ghosts.why_none(sample, |pair, ray| ghosts.trace(pair, ray));
        if let Some(outcome) = self.ghosts.as_ref().and_then(ghost) {
            return outcome;
        }
        self.body.why_none(self.tracers.one.film_ray(sample, None), |ray| self.path.trace(ray))
    }

    /// Returns a substitute for a blocked ray, for hosts that need a complete ray: the ray that the thick
    /// lens has for the same film point and lens sample or, if the lens is afocal, the undeflected ray.
    pub fn substitute(&self, sample: &Sample) -> WorldRay {
        let axial = Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] };
        let FilmRays { point, disk, slopes, area_per_pi } = self.tracers.one.film_ray(sample, None);
        let (point, slopes) = if self.body.requests_redraw(disk) {
            Default::default()
        } else if area_per_pi.is_nan() {
            (point, self.rear.seen_from(point).center)
        } else {
            (point, slopes)
        };
        let CameraBody { film_side, placement, units_per_mm, .. } = &self.body;
        let ray = film_ray(point, film_side.z, slopes);
        let ray = self.facts.first_order.as_ref().map_or_else(|_| straight(ray), |lens| lens.transfer(ray));
        let finite = ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite());
        placement.world_ray(if finite { ray } else { axial }, *units_per_mm, sample.time)
    }

    /// Returns the plan: the features that the camera keeps and omits.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the lens and the film.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// Returns the largest distance from the axis at which light reaches the film, mm, at most that of the
    /// film's corner; `None` if the film's centre is dark.
    pub fn lit_radius(&self) -> Option<f64> {
        let Facts { lens, film, .. } = &self.facts;
        let corner = film.corner();
        match self.body.film_side.sampler.image_radius() {
            Some(end) => Some(end.min(corner)),
            None => Field::new(lens, self.facts.film_z()).lit_radius(corner),
        }
    }

    pub fn ray_maker(&self) -> &RayMaker {
        &self.rays
    }

    /// Returns the adjoint camera.
    pub fn adjoint(&self) -> AdjointCamera {
        AdjointCamera::of_lens(self.adjoint_lens(), &self.body.placement, self.body.units_per_mm)
    }

    /// Returns the adjoint lens.
    pub fn adjoint_lens(&self) -> AdjointLens {
        AdjointLens::new(&self.facts.lens, &self.body)
    }
}

/// Extends a ray to the front vertex plane without refraction, and normalises its direction.
fn straight(Ray { origin: [x, y, z], direction: [dx, dy, dz] }: Ray) -> Ray {
    let (sx, sy) = (dx / dz, dy / dz);
    let norm = (1.0 + sx * sx + sy * sy).sqrt();
    Ray { origin: [x - sx * z, y - sy * z, 0.0], direction: [sx / norm, sy / norm, 1.0 / norm] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{film::Raster, host::Level, plan::Entry, rays::Rays, samples::Samples};
    use realistic_light as light;

    /// Returns a lens of `interfaces` weak random surfaces, some aspheric, each coated with up to 50 layers of its own.
    fn relay(interfaces: usize, layers: usize) -> String {
        let mut state = interfaces as u64 * 7919 + layers as u64 + 1;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut text = String::new();
        for i in 0..interfaces {
            let radius = 80.0 * 25.0_f64.powf(random()) * if random() < 0.5 { 1.0 } else { -1.0 };
            let glass = if i % 2 == 0 && i + 1 < interfaces {
                format!("{} {}", 1.4 + 0.4 * random(), 30.0 + 40.0 * random())
            } else {
                "- -".into()
            };
            text += &format!("{radius} {} {glass} {}\n", 0.02 + 0.6 * random(), 16.0 + 8.0 * random());
        }
        for row in 1..=interfaces {
            if random() < 0.2 {
                text += &format!("asphere {row} conic={} A4={:e}\n", random() - 0.5, 1e-6 * (random() - 0.5));
            }
            let count = (layers as f64 * random()) as usize;
            text += &format!("coating {row} ");
            if count == 0 {
                text += "bare\n";
                continue;
            }
            text += "stack";
            for _ in 0..count {
                text += &format!(" {} {}", 1.35 + random(), 30.0 + 65.0 * random());
            }
            text += "\n";
        }
        text
    }

    /// Returns a camera, the work spent on its transmitted light, and its messages.
    fn built(text: Option<&str>, given: &[(&str, &str)]) -> Result<(RealisticCamera, u64, String), String> {
        let mut parameters = Parameters::default();
        for (name, value) in given {
            parameters.set_from_text(name, value).expect("a parameter");
        }
        let mut host = Host::new(Raster { xres: 30, yres: 20 }, None);
        host.lens_text = text.map(|text| ("relay".to_owned(), text.as_bytes().to_vec()));
        let (before, mut messages) = (light::work_spent(), String::new());
        let mut log = |_: Level, text: &str| messages += text;
        let camera =
            RealisticCamera::build(&parameters, &host, &mut log).map_err(|error| error.to_string())?;
        Ok((camera, light::work_spent() - before, messages))
    }

    fn ray_at(camera: &RealisticCamera, sample: &Sample, wavelength: f32) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        let samples = Samples::of(sample);
        camera.ray_maker().trace(
            Entry::One,
            &samples.at(&[wavelength]),
            &mut Rays::of(&mut ray, &mut weight),
        );
        (weight > 0.0).then_some((ray, weight))
    }

    #[test]
    fn the_light_of_any_lens_takes_no_more_work_than_it_may() {
        // The survey of ghosts takes 4 million units; a single ray may take the rest.
        const MOST: u64 = 5_000_000;
        let (mut cameras, mut unsurveyed, mut rays) = (0, 0, 0);
        for (interfaces, layers, transmission) in [
            (1, 3, "file"),
            (2, 3, "file"),
            (7, 50, "file"),
            (24, 2, "bare"),
            (100, 50, "file"),
            (300, 0, "bare"),
            (1000, 5, "file"),
        ] {
            let given = [
                ("film_distance", "40"),
                ("film_diagonal", "20"),
                ("transmission", transmission),
                ("ghosts", "0.3"),
                ("tolerance", "0.1"),
                ("weighting", "radiometric"),
            ];
            let what = format!("{interfaces} interfaces, {layers} layers");
            let (camera, spent, messages) = match built(Some(&relay(interfaces, layers)), &given) {
                Ok(built) => built,
                Err(error) => {
                    println!("{what}: {error}");
                    continue;
                }
            };
            println!("{what}: {spent} units; {messages}");
            assert!(spent < MOST, "{what}: {spent}");
            cameras += 1;
            unsurveyed += u32::from(messages.contains("go to all pairs alike"));
            let before = light::work_spent();
            for k in 0..200_u32 {
                let [x, y, u, v] =
                    realistic_base::numeric::STEPS.map(|step| (0.5 + f64::from(k) * step).fract() as f32);
                let sample = Sample { image_x: 30.0 * x, image_y: 20.0 * y, lens_u: u, lens_v: v, time: 0.5 };
                let wavelength = 450.0 + 0.5 * k as f32;
                for (ray, weight) in
                    camera.ray(&sample).into_iter().chain(ray_at(&camera, &sample, wavelength))
                {
                    assert!(ray.is_sound() && weight.is_finite(), "{what}: {sample:?}");
                    rays += 1;
                }
            }
            let first = light::work_spent() - before;
            println!("{what}: the first wavelength {first} units");
            assert!(first < MOST, "{what}: {first}");
        }
        assert!(cameras >= 5 && unsurveyed >= 2 && rays > 200, "{cameras} {unsurveyed} {rays}");
    }

    #[test]
    fn rays_at_wavelengths_ignore_tolerance_and_match_batches() {
        // The lens has no dispersion data; the rays ignore the tolerance nevertheless.
        let given =
            |tolerance| [("lens_file", "telephoto.250mm"), ("fnumber", "8"), ("tolerance", tolerance)];
        let [exact, near] = ["0", "0.1"].map(|tolerance| built(None, &given(tolerance)).expect("built").0);
        let columns: [Vec<f32>; 5] = std::array::from_fn(|number| {
            let number = |k: usize| match number {
                4 => 0.5,
                _ => {
                    [30.0, 20.0, 1.0, 1.0][number]
                        * (0.5 + k as f64 * realistic_base::numeric::STEPS[number]).fract() as f32
                }
            };
            (0..64).map(number).collect()
        });
        let mut found = vec![vec![0.0; 64]; 7];
        let samples = Samples::columns(columns.each_ref().map(Vec::as_slice));
        let [ox, oy, oz, dx, dy, dz, weight] = &mut found[..] else { unreachable!("seven columns") };
        let mut rays = Rays::columns([ox, oy, oz], [dx, dy, dz], weight);
        near.ray_maker().trace(Entry::Many, &samples.at(&[500.0; 64]), &mut rays);
        let mut passed = 0;
        for k in 0..64 {
            let sample = samples.get(k);
            let one = |camera: &RealisticCamera| ray_at(camera, &sample, 500.0);
            let single = one(&near);
            let numbers: Vec<f32> = found.iter().map(|column| column[k]).collect();
            let expected = single.map(|(ray, weight)| {
                ray.origin.into_iter().chain(ray.direction).chain([weight]).collect::<Vec<f32>>()
            });
            assert_eq!(expected.unwrap_or_else(|| vec![0.0; 7]), numbers);
            let (Some((ray, _)), Some((own, _))) = (single, one(&exact)) else { continue };
            for axis in 0..3 {
                assert!((ray.direction[axis] - own.direction[axis]).abs() < 2e-6, "{ray:?} {own:?}");
            }
            passed += 1;
        }
        assert!(passed > 20, "{passed}");
    }
}
