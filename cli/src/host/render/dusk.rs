//! A scene in the light of its lamps and of a dusk sky, by path tracing from the camera.
//!
//! Points of lamps light every surface of a path except the last. A lamp is chosen in proportion to the light that it
//! would contribute to the camera without occlusion, so only shadows and the lamps' extent are left to chance. The
//! light of a lamp is counted in this way only: rays that leave a surface pass through lamps. Windows and sky count
//! when a ray meets them. Coats and metals have facets whose slopes follow the GGX distribution with Smith's
//! shadowing (B. Walter, S. R. Marschner, H. Li and K. E. Torrance, "Microfacet Models for Refraction through Rough
//! Surfaces", EGSR 2007). A path continues by reflection from a facet that is visible from the path's direction (E.
//! Heitz, "Sampling the GGX Distribution of Visible Normals", *JCGT* 7(4), 2018).
//!
//! With a table ([`super::irradiance_cache`]), the matte part of a surface reflects all other incident light as read
//! from the table, and paths continue only by facets. If a matte surface is seen in a facet, the light from the table
//! has met one surface more than the light of a path could.

use super::irradiance_cache::IrradianceCache;
use super::lamplight::{START, scattered};
use super::shade::{ShadingSample, fresnel};
use crate::host::scene::shapes::Ray;
use crate::host::scene::solids::{Appearance, Form, Solids};
use crate::host::scene::{Finish, Material, Pane, Scene, Sphere, sky};
use glam::Vec3;
use multiversion::multiversion;
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// Number of surfaces of a path; the last one is visible only if it is itself a light source.
const SURFACES: u32 = 3;
/// Largest number of lamps in a scene, which is the size of the array of their contributions.
const MOST: usize = 256;
/// Number of lamp points that light the first surface of a path from the camera, and of a path that gathers for the
/// table. Computing the shares of all lamps costs as much as several shadow rays, so a pixel's surface uses more than
/// one point.
const LAMPS: [u16; 2] = [3, 1];
/// Number of lamp points for a later surface that is seen in a white mirror. The number is proportional to the path's
/// throughput, so a surface seen in metal has several points and one seen in a coat has one point. Without a table,
/// matte surfaces continue paths, too, and later surfaces have one point.
const MIRRORED: f32 = 6.0;
/// Number of lamps per block: shares are summed by block before one lamp of the block is chosen.
const BLOCK: usize = 16;
/// A path continues with certainty if its throughput exceeds the reciprocal of this number.
const CERTAIN: f32 = 5.0;
/// Smallest probability with which any other path continues.
const RARE: f32 = 0.3;
/// Reflectance of a coat at normal incidence.
const COAT: f32 = 0.04;
/// Smallest roughness: reflections of lamps come only from choosing lamps, and would never appear in a mirror.
const POLISHED: f32 = 0.03;

/// The lamps of a scene, prepared for sampling.
pub struct Dusk<'a> {
    scene: &'a Scene,
    lamps: Vec<(Sphere, Vec3)>,
    /// The lamps as columns: x, y, z, radius, and brightness times squared radius.
    columns: [Vec<f32>; 5],
    /// The lamps as solids.
    bulbs: Solids,
    /// Panes that rays from the camera see as dark, grouped by plane.
    dark: Vec<Vec<Pane>>,
    cache: Option<IrradianceCache>,
}

/// A light source that [`super::emitters`] can connect to the lens.
#[derive(Clone, Copy, Debug)]
pub enum Emitter<'a> {
    /// A lamp and its radiance.
    Lamp(&'a Sphere, Vec3),
    /// A window.
    Pane(&'a Pane),
}

/// A point of an emitter.
#[derive(Clone, Copy, Debug)]
pub struct EmitterPoint {
    /// Position of the point.
    pub point: Vec3,
    /// Normal of the surface at the point.
    pub normal: Vec3,
    /// Emitted radiance.
    pub radiance: Vec3,
    /// Probability density per area, 1/mm².
    pub density: f32,
}

impl Emitter<'_> {
    /// Samples a point that is visible from the point `from`: on a lamp in proportion to projected area, on a window
    /// evenly.
    pub fn point(&self, from: Vec3, [u, v]: [f32; 2]) -> EmitterPoint {
        match self {
            Self::Lamp(sphere, radiance) => {
                let towards = (from - sphere.centre).normalize();
                let (point, normal, density) = facing_point(sphere, towards, [u, v]);
                EmitterPoint { point, normal, radiance: *radiance, density }
            }
            Self::Pane(pane) => {
                let point = pane.point([u, v]);
                let radiance = pane.radiance(point);
                EmitterPoint { point, normal: pane.normal, radiance, density: pane.area().recip() }
            }
        }
    }
}

/// A surface that a ray has met, facing the ray.
struct Surface {
    point: Vec3,
    normal: Vec3,
    /// Direction toward the ray's origin.
    back: Vec3,
    /// Reflectance of the matte part.
    matte: Vec3,
    /// Reflectance of the facets at normal incidence.
    gloss: Vec3,
    /// Roughness of the facets.
    alpha: f32,
}

impl<'a> Dusk<'a> {
    /// Prepares the lamps of a scene. Rays from the camera see the emitters with these indices as dark, because
    /// [`super::emitters`] connects them to the camera.
    pub fn of(scene: &'a Scene, joined: &[usize]) -> Self {
        let all = scene.lamps.iter().flat_map(|group| &group.lamps);
        let lamps: Vec<(Sphere, Vec3)> = all.map(|lamp| (lamp.shape, lamp.material.colour)).collect();
        assert!(lamps.len() <= MOST, "a scene has room for {MOST} lamps");
        let column = |of: fn(&(Sphere, Vec3)) -> f32| lamps.iter().map(of).collect();
        let columns = [
            column(|(sphere, _)| sphere.centre.x),
            column(|(sphere, _)| sphere.centre.y),
            column(|(sphere, _)| sphere.centre.z),
            column(|(sphere, _)| sphere.radius),
            column(|(sphere, colour)| brightness(*colour) * sphere.radius * sphere.radius),
        ];
        let bulb = |(number, (sphere, colour)): (usize, &(Sphere, Vec3))| {
            let colour = if joined.contains(&number) { Vec3::ZERO } else { *colour };
            (Form::Ball(*sphere), Appearance::Plain(Material::new(colour, Finish::Lamp)))
        };
        let bulbs = lamps.iter().enumerate().map(bulb).collect();
        let panes = (lamps.len()..).zip(&scene.panes).filter(|(number, _)| joined.contains(number));
        let dark: Vec<Pane> = panes.map(|(_, pane)| *pane).collect();
        let is_coplanar =
            |one: &Pane, next: &Pane| one.normal == next.normal && one.is_level_with(next.corner);
        let dark = dark.chunk_by(is_coplanar).map(<[Pane]>::to_vec).collect();
        Self { scene, lamps, columns, bulbs, dark, cache: None }
    }

    /// Adds a table of the light that matte surfaces reflect, for a picture with this number of samples.
    pub fn with_cache(self, samples: u64, seed: u64) -> Self {
        let eye = [3, 7, 11].map(|at| self.scene.pose[at]).into();
        Self { cache: Some(IrradianceCache::new(eye, samples, seed)), ..self }
    }

    /// Returns all light sources: the lamps, then the panes.
    pub fn emitters(&self) -> Vec<Emitter<'_>> {
        let lamps = self.lamps.iter().map(|(sphere, radiance)| Emitter::Lamp(sphere, *radiance));
        lamps.chain(self.scene.panes.iter().map(Emitter::Pane)).collect()
    }

    /// Whether anything blocks a ray up to the distance `to`.
    pub fn hides(&self, ray: &Ray, to: f32) -> bool {
        self.scene.hides(ray, START, to) || self.bulbs.hides(ray, START, to)
    }

    /// Returns the radiance along a ray from the camera, and the ray's length.
    pub fn radiance(&self, ray: &Ray, sample: ShadingSample) -> (Vec3, f32) {
        self.along(ray, sample, 1, self.cache.as_ref())
    }

    /// Returns the radiance along a ray, and the ray's length if the ray comes from the camera. `first` is the number
    /// of the surface that the ray meets, counted along the path.
    fn along(
        &self,
        ray: &Ray,
        sample: ShadingSample,
        first: u32,
        cache: Option<&IrradianceCache>,
    ) -> (Vec3, f32) {
        let mut sample = sample;
        let (mut ray, mut through, mut sum, mut distance) = (*ray, Vec3::ONE, Vec3::ZERO, f32::INFINITY);
        for number in first..=SURFACES {
            let start = if number == 1 { 0.0 } else { START };
            let found = self.scene.nearest_surface(&ray, start);
            if number == 1 {
                distance = found.map_or(distance, |(hit, _)| hit.distance);
                if let Some((hit, lamp)) = self.bulbs.nearest(&ray, start, distance) {
                    return (lamp.colour, hit.distance);
                }
            }
            let Some((hit, material)) = found else {
                sum += through * sky::dusk(ray.direction);
                break;
            };
            if material.finish == Finish::Lamp {
                let is_dark = number == 1 && self.is_dark(ray.at(hit.distance));
                sum += if is_dark { Vec3::ZERO } else { through * material.colour };
                break;
            }
            if number == SURFACES {
                break;
            }
            let facing = if hit.normal.dot(ray.direction) < 0.0 { hit.normal } else { -hit.normal };
            let surface = Surface::new(&material, ray.at(hit.distance), facing, -ray.direction);
            let count = if number == first {
                LAMPS[usize::from(first > 1)]
            } else if cache.is_some() {
                (MIRRORED * brightness(through)).clamp(1.0, MIRRORED) as u16
            } else {
                LAMPS[1]
            };
            sum += through * self.lit(&surface, ray.time, sample.light, count);
            let found = cache.and_then(|cache| self.irradiance(cache, &surface, sample.aside));
            let (direction, part) = match found {
                Some(irradiance) => {
                    sum += through * surface.matte * FRAC_1_PI * irradiance;
                    surface.reflect(sample.facet)
                }
                None => surface.scatter(sample.facet),
            };
            // Russian roulette ends paths with little throughput; higher weights of the surviving paths compensate.
            let chance = (CERTAIN * brightness(through * part)).clamp(RARE, 1.0);
            if part == Vec3::ZERO || sample.fate >= chance {
                break;
            }
            sample.fate /= chance;
            through *= part / chance;
            ray = Ray { origin: surface.point, direction, time: ray.time };
            sample = sample.next();
            // The next surface samples another lamp point.
            sample.light = [(sample.light[0] + 0.618_034).fract(), (sample.light[1] + 0.381_966).fract()];
        }
        (sum, distance)
    }

    /// Whether a point is on a pane that rays from the camera see as dark.
    fn is_dark(&self, point: Vec3) -> bool {
        let mut planes = self.dark.iter().filter(|panes| panes[0].is_level_with(point));
        planes.any(|panes| panes.iter().any(|pane| pane.contains(point)))
    }

    /// Returns the irradiance of a surface from everything except lamps.
    fn irradiance(&self, cache: &IrradianceCache, surface: &Surface, aside: [f32; 2]) -> Option<Vec3> {
        let nearest = |ray: &Ray| self.scene.nearest_surface(ray, 0.0).map(|(hit, _)| hit);
        let radiance = |ray: &Ray, sample: ShadingSample| self.along(ray, sample, 2, None).0;
        cache.irradiance(surface.point, surface.normal, aside, nearest, radiance)
    }

    /// Returns the light that a surface reflects from the lamps: the mean over `count` points of lamps, each divided
    /// by its density.
    fn lit(&self, surface: &Surface, time: f32, [u, v]: [f32; 2], count: u16) -> Vec3 {
        let mut shares = [0.0; MOST];
        let shares = &mut shares[..self.lamps.len()];
        let columns = self.columns.each_ref().map(|column| &column[..shares.len()]);
        expected(columns, surface, shares);
        let mut blocks = [0.0; MOST.div_ceil(BLOCK)];
        for (sum, block) in blocks.iter_mut().zip(shares.chunks(BLOCK)) {
            *sum = block.iter().sum();
        }
        let total: f32 = blocks.iter().sum();
        if total <= 0.0 {
            return Vec3::ZERO;
        }
        let mut sum = Vec3::ZERO;
        for number in (0..count).map(f32::from) {
            // Each stratum of the sum of shares contains one sample.
            let at = (number + u) / f32::from(count) * total;
            let (block, rest) = chosen(&blocks[..shares.len().div_ceil(BLOCK)], at);
            let first = block * BLOCK;
            let (index, rest) = chosen(&shares[first..shares.len().min(first + BLOCK)], rest);
            let share = shares[first + index];
            if share > 0.0 {
                let within = [(rest / share).clamp(0.0, 1.0), (v + 0.618_034 * number).fract()];
                sum += self.lit_by(first + index, surface, time, within) * (total / share);
            }
        }
        sum / f32::from(count)
    }

    /// Returns the light that a surface reflects from one lamp, estimated from one direction within the cone that the
    /// lamp fills.
    fn lit_by(&self, index: usize, surface: &Surface, time: f32, [u, v]: [f32; 2]) -> Vec3 {
        let (sphere, radiance) = self.lamps[index];
        let towards = sphere.centre - surface.point;
        let square = towards.length_squared();
        let sine_squared = sphere.radius * sphere.radius / square;
        if sine_squared >= 1.0 {
            return Vec3::ZERO;
        }
        // 1 - cos of the cone's half-angle, and of the direction's angle from the axis.
        let cone = sine_squared / (1.0 + (1.0 - sine_squared).sqrt());
        let down = u * cone;
        let level = (down * (2.0 - down)).sqrt();
        let axis = towards / square.sqrt();
        let (side, up) = axis.any_orthonormal_pair();
        let (sin, cos) = (TAU * v).sin_cos();
        let direction = (1.0 - down) * axis + level * (cos * side + sin * up);
        let sent = surface.sends(direction);
        if sent == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let shadow = Ray { origin: surface.point, direction, time };
        if self.scene.hides(&shadow, START, square.sqrt() - sphere.radius) {
            return Vec3::ZERO;
        }
        sent * radiance * (TAU * cone)
    }
}

impl Surface {
    fn new(material: &Material, point: Vec3, normal: Vec3, back: Vec3) -> Self {
        let coat = fresnel(normal.dot(back), COAT);
        let (matte, gloss) = match material.finish {
            Finish::Coated => ((1.0 - coat) * material.colour, Vec3::splat(COAT)),
            Finish::Metal => (Vec3::ZERO, material.colour),
            // A path ends at a lamp before the lamp is shaded. Glass counts as matte, because the scene has no glass.
            Finish::Matte | Finish::Lamp | Finish::Glass | Finish::Sheet => (material.colour, Vec3::ZERO),
        };
        Self { point, normal, back, matte, gloss, alpha: material.roughness.max(POLISHED) }
    }

    /// Returns the density of the facets' distribution for the cosine of the facets' tilt.
    fn facets(&self, cosine: f32) -> f32 {
        let square = self.alpha * self.alpha;
        let part = cosine * cosine * (square - 1.0) + 1.0;
        square * FRAC_1_PI / (part * part)
    }

    /// Returns Smith's shadowing and masking for both directions, divided by 4 times both cosines.
    fn visible(&self, one: f32, other: f32) -> f32 {
        let square = self.alpha * self.alpha;
        let hidden = |cosine: f32| (cosine * cosine * (1.0 - square) + square).sqrt();
        0.5 / (one * hidden(other) + other * hidden(one)).max(1e-6)
    }

    /// Returns the reflectance of facets at an angle with this cosine (C. Schlick, 1994).
    fn reflects(&self, cosine: f32) -> Vec3 {
        self.gloss + (Vec3::ONE - self.gloss) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
    }

    /// Returns the radiance that the surface reflects from a direction if the irradiance at normal incidence is 1:
    /// the BRDF times the cosine.
    fn sends(&self, direction: Vec3) -> Vec3 {
        let [one, other] = [direction, self.back].map(|v| self.normal.dot(v));
        if one <= 0.0 || other <= 0.0 {
            return Vec3::ZERO;
        }
        let mut sent = self.matte * FRAC_1_PI;
        if self.gloss != Vec3::ZERO {
            let half = (direction + self.back).normalize();
            let tilt = self.normal.dot(half);
            sent += self.reflects(half.dot(self.back)) * self.facets(tilt) * self.visible(one, other);
        }
        sent * one
    }

    /// Samples the direction in which a path continues, from a facet or from the matte part, and returns it with its
    /// weight.
    fn scatter(&self, [u, v]: [f32; 2]) -> (Vec3, Vec3) {
        let other = self.normal.dot(self.back).max(1e-4);
        let weights = [self.reflects(other), self.matte].map(brightness);
        let [glossy, matte] = if self.gloss == Vec3::ZERO { [0.0, weights[1]] } else { weights };
        if glossy + matte <= 0.0 {
            return (self.normal, Vec3::ZERO);
        }
        let chance = glossy / (glossy + matte);
        if u >= chance {
            let u = (u - chance) / (1.0 - chance);
            return (scattered(self.normal, [u, v]), self.matte / (1.0 - chance));
        }
        let (direction, part) = self.reflect([u / chance, v]);
        (direction, part / chance)
    }

    /// Samples the direction in which a path continues from a facet, and returns it with its weight.
    fn reflect(&self, [u, v]: [f32; 2]) -> (Vec3, Vec3) {
        if self.gloss == Vec3::ZERO {
            return (self.normal, Vec3::ZERO);
        }
        let other = self.normal.dot(self.back).max(1e-4);
        let half = self.seen_facet([u, v]);
        let along = half.dot(self.back);
        let direction = 2.0 * along * half - self.back;
        let one = self.normal.dot(direction);
        if one <= 0.0 || along <= 0.0 {
            return (self.normal, Vec3::ZERO);
        }
        // The BRDF times the cosine, divided by the density: the fraction of the facet's reflected light that other
        // facets do not block.
        let square = self.alpha * self.alpha;
        let hidden = (other * other * (1.0 - square) + square).sqrt();
        let part = 2.0 * self.visible(one, other) * one * (other + hidden);
        (direction, self.reflects(along) * part)
    }

    /// Samples the normal of a facet in proportion to its area visible from the ray's direction: the facets are those
    /// of a stretched sphere, seen from a direction stretched in the same way.
    fn seen_facet(&self, [u, v]: [f32; 2]) -> Vec3 {
        let (side, up) = self.normal.any_orthonormal_pair();
        let [x, y, z] = [side, up, self.normal].map(|axis| axis.dot(self.back));
        let back = Vec3::new(self.alpha * x, self.alpha * y, z).normalize();
        let (across, along) = back.any_orthonormal_pair();
        // `along` must point up the sphere: the lower half of the disk is foreshortened.
        let across = if back.z < 0.999_9 { Vec3::Z.cross(back).normalize() } else { across };
        let along = if back.z < 0.999_9 { back.cross(across) } else { along };
        let (sin, cos) = (TAU * v).sin_cos();
        let radius = u.sqrt();
        let (a, b) = (radius * cos, radius * sin);
        let shift = 0.5 * (1.0 + back.z);
        let b = (1.0 - shift) * (1.0 - a * a).max(0.0).sqrt() + shift * b;
        let facet = a * across + b * along + (1.0 - a * a - b * b).max(0.0).sqrt() * back;
        let [x, y, z] = [self.alpha * facet.x, self.alpha * facet.y, facet.z.max(1e-6)];
        (x * side + y * up + z * self.normal).normalize()
    }
}

/// Computes the brightness that a surface reflects from every lamp, with each lamp as a point and without occlusion.
/// The facets are made rougher in proportion to the lamp's angular size.
#[multiversion(targets("x86_64+avx2"))]
fn expected([xs, ys, zs, radii, powers]: [&[f32]; 5], surface: &Surface, shares: &mut [f32]) {
    let Surface { point, normal, back, .. } = surface;
    let facing = normal.dot(*back).max(1e-3);
    let matte = brightness(surface.matte) * FRAC_1_PI;
    let gloss = brightness(surface.gloss);
    // A straight line approximates Smith's root well enough for choosing.
    let hidden = |cosine: f32| surface.alpha + (1.0 - surface.alpha) * cosine;
    let hidden_facing = hidden(facing);
    for index in 0..shares.len() {
        let [x, y, z] = [xs[index] - point.x, ys[index] - point.y, zs[index] - point.z];
        let near = (x * x + y * y + z * z).sqrt().recip();
        let [x, y, z] = [x * near, y * near, z * near];
        let wide = radii[index] * near;
        let cosine = (normal.x * x + normal.y * y + normal.z * z + wide).max(0.0);
        let [hx, hy, hz] = [x + back.x, y + back.y, z + back.z];
        let upright = normal.x * hx + normal.y * hy + normal.z * hz;
        let length = hx * hx + hy * hy + hz * hz;
        let alpha = surface.alpha + 0.5 * wide;
        let alpha_squared = (alpha * alpha).min(1.0);
        let part = (upright * upright * (alpha_squared - 1.0) + length).max(1e-9);
        let visible = cosine * hidden_facing + facing * hidden(cosine);
        let facets = 0.5 * FRAC_1_PI * alpha_squared * length * length / (part * part * visible);
        // The half vector of two unit vectors forms, with either of them, an angle whose cosine is half the length of
        // their sum.
        let missing = (1.0 - 0.5 * length.sqrt()).max(0.0);
        let reflected = gloss + (1.0 - gloss) * (missing * missing) * (missing * missing) * missing;
        let coat = if gloss > 0.0 { reflected * facets } else { 0.0 };
        shares[index] = powers[index] * near * near * cosine * (matte + coat);
    }
}

/// Returns the index of the share that contains a position along the sum of the shares, and the position within that
/// share.
fn chosen(shares: &[f32], mut position: f32) -> (usize, f32) {
    let mut index = 0;
    while index + 1 < shares.len() && position >= shares[index] {
        position -= shares[index];
        index += 1;
    }
    (index, position)
}

/// Returns the luminance of a colour.
fn brightness(colour: Vec3) -> f32 {
    colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Samples a point on the half of a ball that faces a direction, in proportion to projected area; returns the point's
/// normal and its density per area.
fn facing_point(sphere: &Sphere, towards: Vec3, [u, v]: [f32; 2]) -> (Vec3, Vec3, f32) {
    let normal = scattered(towards, [u, v]);
    let density = normal.dot(towards) / (PI * sphere.radius * sphere.radius);
    (sphere.centre + sphere.radius * normal, normal, density)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(index: u32, step: f32) -> f32 {
        (index as f32 * step).fract()
    }

    #[test]
    fn what_paths_go_on_with_is_what_lamps_all_around_would_send() {
        const COUNT: u32 = 40_000;
        let normal = Vec3::new(0.3, 0.9, -0.2).normalize();
        for (finish, roughness) in
            [(Finish::Matte, 0.0), (Finish::Coated, 0.3), (Finish::Metal, 0.4), (Finish::Coated, 0.7)]
        {
            for tilt in [0.1_f32, 0.7, 1.3] {
                let material = Material::new([0.7, 0.5, 0.2], finish).rough(roughness);
                let (side, up) = normal.any_orthonormal_pair();
                let back = tilt.cos() * normal + tilt.sin() * (0.8 * side + 0.6 * up);
                let surface = Surface::new(&material, Vec3::ZERO, normal, back);
                let (mut gone, mut sent) = (Vec3::ZERO, Vec3::ZERO);
                for index in 0..COUNT {
                    let [u, v] = [at(index, 0.754_877_7), at(index, 0.569_840_3)];
                    let (direction, part) = surface.scatter([u, v]);
                    assert!(part == Vec3::ZERO || normal.dot(direction) > 0.0);
                    gone += part;
                    // Directions are even over the upper half space.
                    let (sin, cos) = (TAU * v).sin_cos();
                    let level = (1.0 - u * u).sqrt();
                    sent += TAU * surface.sends(u * normal + level * (cos * side + sin * up));
                }
                let (gone, sent) = (gone / COUNT as f32, sent / COUNT as f32);
                assert!(
                    (gone - sent).abs().max_element() < 0.02,
                    "{finish:?} {roughness} {tilt}: {gone} {sent}"
                );
                assert!(gone.max_element() < 1.01, "{finish:?} {roughness} {tilt}: {gone}");
            }
        }
    }

    #[test]
    fn half_a_ball_is_seen_by_its_projected_area() {
        // The mean over points of the cosine with the direction, divided by the density, is the area of a disk.
        let sphere = Sphere::resting(Vec3::new(1.0, 2.0, 3.0), 5.0);
        let towards = Vec3::new(-0.5, 0.2, 0.7).normalize();
        let area = (0..1000).map(|index| {
            let (point, normal, density) =
                facing_point(&sphere, towards, [at(index, 0.754_877_7), at(index, 0.569_840_3)]);
            assert!((point.distance(sphere.centre) - 5.0).abs() < 1e-4 && normal.dot(towards) > 0.0);
            normal.dot(towards) / density
        });
        assert!((area.sum::<f32>() / 1000.0 / (25.0 * PI) - 1.0).abs() < 1e-4);
    }
}
