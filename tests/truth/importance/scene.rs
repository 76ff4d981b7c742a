//! Quasi-random samples in batches, and rays of a camera.

use ::realistic_camera::{Camera, Sample, WorldRay};

use super::support::Random;

/// Steps of the additive recurrence in six dimensions (M. Roberts, 2018): powers of 1/g, where g⁷ = g + 1.
const STEPS: [f64; 6] = [
    0.898_665_466_953_376_8,
    0.807_599_621_487_158_4,
    0.725_761_891_130_653_2,
    0.652_217_148_769_735_1,
    0.586_125_028_555_068_1,
    0.526_730_322_473_113_2,
];

/// Returns the numbers of a sample, shifted by the same amount within a replicate.
pub fn numbers(index: usize, replicate: usize) -> [f64; 6] {
    let mut random = Random::new(replicate as u64);
    std::array::from_fn(|axis| (random.next() + index as f64 * STEPS[axis]).fract())
}

/// Returns a sample of the whole picture from these numbers.
pub fn sample([x, y, u, v, time, _]: [f64; 6], [width, height]: [u32; 2]) -> Sample {
    Sample {
        image_x: (x * f64::from(width)) as f32,
        image_y: (y * f64::from(height)) as f32,
        lens_u: u as f32,
        lens_v: v as f32,
        time: time as f32,
    }
}

/// Returns the passing rays of the camera with their samples and weights.
pub fn rays(camera: &Camera, size: [u32; 2], count: usize, replicate: usize) -> Vec<(Sample, WorldRay, f32)> {
    (0..count)
        .filter_map(|index| {
            let sample = sample(numbers(index, replicate), size);
            camera.ray(&sample).map(|(ray, weight)| (sample, ray, weight))
        })
        .collect()
}

/// Returns the ray with its direction reversed.
pub fn turned(ray: &WorldRay) -> WorldRay {
    WorldRay { direction: ray.direction.map(|part| -part), ..*ray }
}
