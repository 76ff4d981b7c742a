//! Light tracing: paths from the lamps, each of whose points is joined to the camera by a direction that the camera
//! samples, and counted where on the film that leads (E. Veach, *Robust Monte Carlo Methods for Light Transport
//! Simulation*, 1997, §10.3: the paths with one vertex on the lens).

use super::lamplight::{Lights, REFLECTIONS, START, scattered};
use super::renderer::Settings;
use crate::host::plugin::{Connections, PluginError, Places};
use crate::host::scene::shapes::Ray;
use crate::host::scene::{Finish, Scene};
use crate::image::Picture;
use glam::{DVec3, Vec3};
use indicatif::ProgressBar;
use rand::{RngExt as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use realistic_lab::render::Tally;
use std::f32::consts::PI;
use std::time::Instant;

/// Parts of a picture's paths, each with its own random numbers, whatever the number of threads.
const PARTS: u64 = 16;
/// Paths that are joined to the camera at once.
const BATCH: u64 = 1024;

/// What a vertex of a path sends toward the camera, per cosine and density of the direction.
struct Vertex {
    normal: Vec3,
    /// Radiance over the density of the vertex per area, 1/mm².
    strength: Vec3,
}

/// Renders the scene with as many paths as the settings have samples.
///
/// # Errors
/// The camera's own.
pub fn trace(
    camera: impl Fn(&Places, &mut Connections) -> Result<(), PluginError> + Sync,
    scene: &Scene,
    settings: &Settings,
    [open, close]: [f32; 2],
    progress: &ProgressBar,
) -> Result<(Picture, Tally), PluginError> {
    let [width, height] = settings.size;
    let pixels = u64::from(width) * u64::from(height);
    let paths = pixels * u64::from(settings.spp);
    let lights = Lights::of(scene);
    progress.set_length(PARTS);
    let parts = (0..PARTS).into_par_iter().map(|part| {
        let seed = settings.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ part;
        let mut path = Tracer {
            scene,
            lights: &lights,
            random: Xoshiro256PlusPlus::seed_from_u64(seed),
            units_per_mm: settings.mm_per_unit.recip(),
            shutter: [open, close],
            sums: vec![DVec3::ZERO; pixels as usize],
            size: settings.size,
            tally: Tally::default(),
        };
        let [from, to] = [part, part + 1].map(|part| part * paths / PARTS);
        for first in (from..to).step_by(BATCH as usize) {
            path.batch(BATCH.min(to - first), &camera)?;
        }
        progress.inc(1);
        Ok((path.sums, path.tally))
    });
    let mut sums = vec![DVec3::ZERO; pixels as usize];
    let mut total = Tally::default();
    for (part, tally) in parts.collect::<Result<Vec<_>, PluginError>>()? {
        sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        total.add(&tally);
    }
    // The picture's film is one; a pixel's share of it gets the whole sum.
    let scale = pixels as f64 / paths as f64;
    let pixels = sums.into_iter().map(|sum| (scale * sum).as_vec3().to_array()).collect();
    Ok((Picture { size: settings.size, pixels }, total))
}

/// Paths of a part of the picture's.
struct Tracer<'a> {
    scene: &'a Scene,
    lights: &'a Lights,
    random: Xoshiro256PlusPlus,
    units_per_mm: f32,
    shutter: [f32; 2],
    sums: Vec<DVec3>,
    size: [u32; 2],
    tally: Tally,
}

impl Tracer<'_> {
    /// Traces paths, and counts what of them reaches the film.
    fn batch(
        &mut self,
        count: u64,
        camera: impl Fn(&Places, &mut Connections) -> Result<(), PluginError>,
    ) -> Result<(), PluginError> {
        let (mut places, mut vertices) = (Places::default(), Vec::new());
        for _ in 0..count {
            self.path(&mut places, &mut vertices);
        }
        let mut found = Connections::default();
        let start = Instant::now();
        camera(&places, &mut found)?;
        self.tally.in_camera += start.elapsed();
        self.tally.rays += vertices.len() as u64;
        for (i, vertex) in vertices.iter().enumerate() {
            if found.importance[i] > 0.0 {
                self.tally.passed += 1;
                self.count(&places, &found, i, vertex);
            }
        }
        Ok(())
    }

    /// Adds the points of one path, in the camera's units.
    fn path(&mut self, places: &mut Places, vertices: &mut Vec<Vertex>) {
        let [open, close] = self.shutter;
        let time = open + (close - open) * self.random.random::<f32>();
        let choice = self.random.random();
        let lamp = self.lights.point(choice, [self.random.random(), self.random.random()]);
        self.place(places, lamp.point, time);
        vertices.push(Vertex { normal: lamp.normal, strength: lamp.radiance / lamp.density });
        // Directions by the cosine, so that what goes on is π of that.
        let mut strength = PI * lamp.radiance / lamp.density;
        let direction = scattered(lamp.normal, [self.random.random(), self.random.random()]);
        let mut ray = Ray { origin: lamp.point, direction, time };
        for _ in 0..REFLECTIONS {
            let Some((hit, material)) = self.scene.nearest(&ray, START) else { return };
            if material.finish == Finish::Lamp || hit.normal.dot(ray.direction) >= 0.0 {
                return;
            }
            let point = ray.at(hit.distance);
            strength *= material.colour;
            self.place(places, point, time);
            vertices.push(Vertex { normal: hit.normal, strength: strength / PI });
            let direction = scattered(hit.normal, [self.random.random(), self.random.random()]);
            ray = Ray { origin: point, direction, time };
        }
    }

    fn place(&mut self, places: &mut Places, point: Vec3, time: f32) {
        let sample = [self.random.random(), self.random.random()];
        places.push((point * self.units_per_mm).to_array(), sample, time);
    }

    /// Counts a vertex's light, unless something hides it.
    fn count(&mut self, places: &Places, found: &Connections, i: usize, vertex: &Vertex) {
        let direction = Vec3::from_array(found.direction(i));
        let cosine = vertex.normal.dot(direction);
        if cosine <= 0.0 {
            return;
        }
        let (point, front) = (Vec3::from_array(places.point(i)), Vec3::from_array(found.origin(i)));
        let ray = Ray { origin: point / self.units_per_mm, direction, time: places.time(i) };
        let distance = (front - point).length() / self.units_per_mm;
        if self.scene.nearest(&ray, START).is_some_and(|(hit, _)| hit.distance < distance) {
            return;
        }
        // Areas are of the scene, in mm².
        let area = f64::from(self.units_per_mm).powi(2);
        let share = f64::from(found.importance[i]) * f64::from(cosine) / f64::from(found.density[i]) * area;
        let [x, y] = found.pixel(i).map(|at| at as usize);
        let [width, height] = self.size.map(|side| side as usize);
        self.sums[y.min(height - 1) * width + x.min(width - 1)] += share * vertex.strength.as_dvec3();
    }
}
