//! The light along a ray: sun with soft shadows, a sky given by a formula, and reflections and refractions for a few
//! bounces. This is distributed ray tracing: each ray samples one point of the sun and one facet of a rough surface,
//! so that the many rays of a pixel cover them all.

use crate::host::scene::shapes::{Hit, Ray};
use crate::host::scene::{Finish, Material, Scene, sky};
use glam::{Vec2, Vec3};

/// Samples of the light and of the surfaces that a camera ray meets; coordinates in [0, 1).
#[derive(Clone, Copy, Debug, Default)]
pub struct ShadingSample {
    /// Selects a point of the sun.
    pub light: [f32; 2],
    /// Selects the facet of a rough surface.
    pub facet: [f32; 2],
    /// Decides whether a path continues.
    pub fate: f32,
    /// Selects a position beside a point; the point uses the light gathered at that position.
    pub aside: [f32; 2],
}

/// Smallest contribution for which a branch is followed.
const FAINT: f32 = 0.02;
const BOUNCES: u32 = 6;
/// Distance, mm, at which the air transmits 1/e of the light.
const CLEAR_AIR: f32 = 70_000.0;
const GLASS: f32 = 1.5;

/// Returns the radiance along a ray.
pub fn radiance(scene: &Scene, ray: &Ray, sample: ShadingSample) -> Vec3 {
    Shader { scene }.follow(ray, sample, 1.0, 0)
}

struct Shader<'a> {
    scene: &'a Scene,
}

impl Shader<'_> {
    /// Follows a ray; `share` is the weight of its light in the picture.
    fn follow(&self, ray: &Ray, sample: ShadingSample, share: f32, bounces: u32) -> Vec3 {
        let start = if bounces == 0 { 0.0 } else { 0.05 };
        let Some((hit, material)) = self.scene.nearest(ray, start) else {
            let sun = if bounces == 0 { Vec3::ZERO } else { self.scene.sun.mirrored(ray.direction) };
            return sky::radiance(ray.direction) + sun;
        };
        let colour = self.surface(ray, &hit, &material, sample, share, bounces);
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
        sample: ShadingSample,
        share: f32,
        bounces: u32,
    ) -> Vec3 {
        let point = ray.at(hit.distance);
        let cosine = -hit.normal.dot(ray.direction);
        let scattered = || self.scattered(point, ray.time, hit.normal, material.colour, sample.light);
        let send = |direction: Vec3, part: f32| {
            if share * part < FAINT || bounces == BOUNCES {
                return part * sky::radiance(direction);
            }
            let ray = Ray { origin: point, direction, time: ray.time };
            part * self.follow(&ray, sample.next(), share * part, bounces + 1)
        };
        let facet = facet(hit.normal, material.roughness, sample.facet);
        let mirrored = off(ray.direction, facet, hit.normal);
        match material.finish {
            Finish::Lamp => material.colour,
            Finish::Matte => scattered(),
            Finish::Coated => {
                let part = fresnel(cosine, 0.04);
                (1.0 - part) * scattered() + send(mirrored, part)
            }
            Finish::Metal => {
                let edge = fresnel(cosine, 0.0);
                material.colour.lerp(Vec3::ONE, edge) * send(mirrored, 1.0)
            }
            Finish::Glass => {
                let (normal, ratio) = if cosine > 0.0 { (facet, 1.0 / GLASS) } else { (-facet, GLASS) };
                let bent = ray.direction.refract(normal, ratio);
                if bent == Vec3::ZERO {
                    return send(off(ray.direction, normal, -hit.normal), 1.0);
                }
                let part = fresnel(cosine.abs().min(-bent.dot(normal)), 0.04);
                let through = material.colour * send(bent.normalize(), 1.0 - part);
                // Further bounces of light inside a ball cost much and are hardly visible.
                if cosine > 0.0 { through + send(mirrored, part) } else { through }
            }
            Finish::Sheet => {
                let (out, facet) = if cosine > 0.0 { (hit.normal, facet) } else { (-hit.normal, -facet) };
                let part = fresnel(cosine.abs(), 0.04);
                // The ray enters by the rough side and leaves by the polished one.
                let inside = ray.direction.refract(facet, 1.0 / GLASS);
                let bent = inside.refract(out, GLASS);
                let bent = if material.roughness == 0.0 { ray.direction } else { bent };
                let reflected = send(off(ray.direction, facet, out), part);
                if bent == Vec3::ZERO {
                    return reflected;
                }
                material.colour * send(bent.normalize(), 1.0 - part) + reflected
            }
        }
    }

    fn scattered(&self, point: Vec3, time: f32, normal: Vec3, reflectance: Vec3, light: [f32; 2]) -> Vec3 {
        let direction = self.scene.sun.direction(light);
        let cosine = normal.dot(direction);
        let mut irradiance = sky::ambient(normal) * self.scene.open_sky(point, normal, time);
        if cosine > 0.0 {
            let shadow = Ray { origin: point, direction, time };
            irradiance += sky::SUNLIGHT * cosine * self.scene.light_through(&shadow, 0.1);
        }
        reflectance * irradiance / std::f32::consts::PI
    }
}

impl ShadingSample {
    /// Returns the samples for the next bounce: the facet's sample moves by a step of the plastic number's lattice,
    /// and the others stay.
    pub fn next(self) -> Self {
        let step = |[u, v]: [f32; 2]| [(u + 0.754_878).fract(), (v + 0.569_840).fract()];
        Self { facet: step(self.facet), ..self }
    }
}

/// Samples the normal of a facet of a surface with Beckmann's distribution of slopes (R. L. Cook
/// and K. E. Torrance, "A Reflectance Model for Computer Graphics", *ACM Transactions on Graphics*
/// 1(1), 1982), with RMS slope `roughness`: tan²θ = -m² ln(1 - u).
fn facet(normal: Vec3, roughness: f32, [u, v]: [f32; 2]) -> Vec3 {
    if roughness == 0.0 {
        return normal;
    }
    let (side, up) = normal.any_orthonormal_pair();
    let slope = roughness * (-(1.0 - u).ln()).sqrt() * Vec2::from_angle(std::f32::consts::TAU * v);
    (normal + slope.x * side + slope.y * up).normalize()
}

/// Returns the direction reflected by a facet of a surface whose normal is `outward`. A direction into the surface is
/// folded back, so that masked facets lose no light.
fn off(direction: Vec3, facet: Vec3, outward: Vec3) -> Vec3 {
    let mirrored = direction.reflect(facet);
    let side = -outward.dot(direction).signum();
    let depth = (mirrored.dot(outward) * side).min(0.0);
    (mirrored - 2.0 * depth * side * outward).normalize()
}

/// Returns Schlick's approximation of Fresnel's formula.
pub fn fresnel(cosine: f32, facing: f32) -> f32 {
    facing + (1.0 - facing) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::props;

    #[test]
    fn every_direction_gives_light_and_none_gives_nonsense() {
        let scene = props::scene();
        for step in 0..4000_u16 {
            let turn = f32::from(step);
            let y = (turn * 0.618_034).fract() * 2.0 - 1.0;
            let (sine, cosine) = (turn * 2.4).sin_cos();
            let level = (1.0 - y * y).sqrt();
            let direction = Vec3::new(level * sine, y, level * cosine);
            let ray = Ray { origin: Vec3::ZERO, direction, time: 0.25 };
            let light = radiance(
                &scene,
                &ray,
                ShadingSample {
                    light: [0.5, 0.25],
                    facet: [0.9, 0.4],
                    fate: 0.5,
                    ..ShadingSample::default()
                },
            );
            assert!(light.is_finite() && light.min_element() > 0.0, "{ray:?}: {light}");
        }
    }

    #[test]
    fn facets_have_the_slope_of_the_roughness() {
        let normal = Vec3::new(0.6, 0.0, -0.8);
        assert_eq!(facet(normal, 0.0, [0.7, 0.2]), normal);
        let numbers =
            (0..10_000_u16).map(|k| [(f32::from(k) + 0.5) / 1e4, (f32::from(k) * 0.618_034).fract()]);
        let squares = numbers.map(|numbers| {
            let cosine = facet(normal, 0.2, numbers).dot(normal);
            1.0 / (cosine * cosine) - 1.0
        });
        let mean = squares.sum::<f32>() / 1e4;
        assert!((mean.sqrt() - 0.2).abs() < 2e-3, "{mean}");
    }

    #[test]
    fn no_reflection_goes_into_the_surface() {
        for k in 0..1000_u16 {
            let at = |step: f32| (f32::from(k) * step).fract();
            let direction = Vec3::new(1.0, -0.001 - 0.3 * at(0.41), at(0.17)).normalize();
            let rough = facet(Vec3::Y, 0.6, [at(0.754_878), at(0.569_84)]);
            let mirrored = off(direction, rough, Vec3::Y);
            assert!(mirrored.y >= 0.0 && (mirrored.length() - 1.0).abs() < 1e-5, "{mirrored}");
        }
    }
}
