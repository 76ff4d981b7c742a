//! The light that comes back along a ray: sun with soft shadows, sky by formula, and
//! reflections and refractions followed for a few bounces. Nothing but the sun's disk is
//! sampled, so that what noise there is comes from the lens.

use super::scene::{Finish, Material, Scene};
use super::shapes::{Hit, Ray};
use super::sky;
use glam::Vec3;

/// A branch that adds less than this is not followed.
const FAINT: f32 = 0.02;
const BOUNCES: u32 = 6;
/// Distance, mm, at which the air hides all but 1/e of what is behind it.
const CLEAR_AIR: f32 = 70_000.0;
const GLASS: f32 = 1.5;

impl Scene {
    /// Radiance along a ray. `light` are two sample numbers that choose a point of the sun.
    pub fn radiance(&self, ray: &Ray, light: [f32; 2]) -> Vec3 {
        self.follow(ray, light, 1.0, 0)
    }

    /// `share` is how much of what comes back will count in the picture.
    fn follow(&self, ray: &Ray, light: [f32; 2], share: f32, bounces: u32) -> Vec3 {
        let start = if bounces == 0 { 0.0 } else { 0.05 };
        let Some((hit, material)) = self.nearest(ray, start) else {
            let sun = if bounces == 0 { Vec3::ZERO } else { sky::sun(ray.direction) };
            return sky::radiance(ray.direction) + sun;
        };
        let colour = self.surface(ray, &hit, &material, light, share, bounces);
        if material.finish == Finish::Lamp {
            return colour;
        }
        sky::MIST.lerp(colour, (-hit.distance / CLEAR_AIR).exp())
    }

    fn surface(
        &self,
        ray: &Ray,
        hit: &Hit,
        material: &Material,
        light: [f32; 2],
        share: f32,
        bounces: u32,
    ) -> Vec3 {
        let point = ray.at(hit.distance);
        let cosine = -hit.normal.dot(ray.direction);
        let send = |direction: Vec3, part: f32| {
            if share * part < FAINT || bounces == BOUNCES {
                return part * sky::radiance(direction);
            }
            let ray = Ray { origin: point, direction };
            part * self.follow(&ray, light, share * part, bounces + 1)
        };
        let mirrored = ray.direction.reflect(hit.normal).normalize();
        match material.finish {
            Finish::Lamp => material.colour,
            Finish::Matte => self.scattered(point, hit.normal, material.colour, light),
            Finish::Coated => {
                let part = fresnel(cosine, 0.04);
                let under = self.scattered(point, hit.normal, material.colour, light);
                (1.0 - part) * under + send(mirrored, part)
            }
            Finish::Metal => {
                let edge = fresnel(cosine, 0.0);
                material.colour.lerp(Vec3::ONE, edge) * send(mirrored, 1.0)
            }
            Finish::Glass => {
                let (normal, ratio) =
                    if cosine > 0.0 { (hit.normal, 1.0 / GLASS) } else { (-hit.normal, GLASS) };
                let bent = ray.direction.refract(normal, ratio);
                if bent == Vec3::ZERO {
                    return send(ray.direction.reflect(normal).normalize(), 1.0);
                }
                let part = fresnel(cosine.abs().min(-bent.dot(normal)), 0.04);
                let through = material.colour * send(bent.normalize(), 1.0 - part);
                // Light that goes on bouncing inside a ball costs much and shows little.
                if cosine > 0.0 { through + send(mirrored, part) } else { through }
            }
        }
    }

    fn scattered(&self, point: Vec3, normal: Vec3, reflectance: Vec3, light: [f32; 2]) -> Vec3 {
        let direction = sky::towards_sun(light);
        let cosine = normal.dot(direction);
        let mut irradiance = sky::ambient(normal) * self.open_sky(point, normal);
        if cosine > 0.0 {
            let shadow = Ray { origin: point, direction };
            irradiance += sky::SUNLIGHT * cosine * self.light_through(&shadow, 0.1);
        }
        reflectance * irradiance / std::f32::consts::PI
    }
}

/// Schlick's approximation of Fresnel's formula.
fn fresnel(cosine: f32, facing: f32) -> f32 {
    facing + (1.0 - facing) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_gives_light_and_none_gives_nonsense() {
        let scene = Scene::new();
        for step in 0..4000_u16 {
            let turn = f32::from(step);
            let y = (turn * 0.618_034).fract() * 2.0 - 1.0;
            let (sine, cosine) = (turn * 2.4).sin_cos();
            let level = (1.0 - y * y).sqrt();
            let ray = Ray { origin: Vec3::ZERO, direction: Vec3::new(level * sine, y, level * cosine) };
            let light = scene.radiance(&ray, [0.5, 0.25]);
            assert!(light.is_finite() && light.min_element() > 0.0, "{ray:?}: {light}");
        }
    }
}
