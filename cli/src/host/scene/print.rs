//! The print on an object of a scene: a drawing that serves as a texture.

use crate::drawing::shapes::Page;
use crate::image::{Picture, SrgbImage};
use glam::{Vec2, Vec3};

/// A drawing in linear colours, with [`Print::TEXELS`] texels per unit in both directions.
#[derive(Debug)]
pub struct Print {
    texture: Picture,
}

impl Print {
    const TEXELS: f32 = 8.0;

    /// Prints a page.
    pub fn of(page: &Page) -> Self {
        let empty = SrgbImage { size: [1; 2], pixels: vec![[0; 3]] };
        Self { texture: Picture::from(&page.pixels(Self::TEXELS).unwrap_or(empty)) }
    }

    /// Returns the colour at a position on the page, with x to the right and y down from the top left corner. The
    /// colour is interpolated bilinearly; beyond the page, it is that of the nearest edge.
    pub fn colour(&self, at: Vec2) -> Vec3 {
        let last = Vec2::from(self.texture.size.map(|side| (side - 1) as f32));
        let position = (at * Self::TEXELS - 0.5).clamp(Vec2::ZERO, last);
        let (low, high) = (position.floor(), (position.floor() + 1.0).min(last));
        let texel = |x: f32, y: f32| {
            let index = y as usize * self.texture.size[0] as usize + x as usize;
            Vec3::from_array(self.texture.pixels[index])
        };
        let part = position - low;
        let [above, below] = [low.y, high.y].map(|y| texel(low.x, y).lerp(texel(high.x, y), part.x));
        above.lerp(below, part.y)
    }
}
