//! Letters: outlines of the one font of all pictures.

use super::picture::Picture;
use tiny_skia::{FillRule, Mask, Path, PathBuilder, Transform};
use ttf_parser::{Face, OutlineBuilder};

/// Some characters of DejaVu Sans Condensed (`assets/README.md`).
static FONT: &[u8] = include_bytes!("../../assets/letters.ttf");

/// Returns the outlines of a text on one line and its width. The baseline begins at the origin and y grows downward;
/// `size` is the height of a line in pixels, without leading. A box replaces a character that the font lacks.
pub fn outline(text: &str, size: f32) -> (Option<Path>, f32) {
    let face = Face::parse(FONT, 0).expect("the font is whole");
    let scale = size / f32::from(face.units_per_em());
    let mut pen = Pen { path: PathBuilder::new(), scale, left: 0.0 };
    for letter in text.chars() {
        let glyph = face.glyph_index(letter).unwrap_or_default();
        face.outline_glyph(glyph, &mut pen);
        pen.left += scale * f32::from(face.glyph_hor_advance(glyph).unwrap_or_default());
    }
    (pen.path.finish(), pen.left)
}

/// Writes a text into a picture, centred between `left` and `right`, with its baseline at `y`. Parts outside the
/// picture are cut off.
pub fn write(picture: &mut Picture, text: &str, [left, right, y]: [f32; 3], size: f32, colour: [f32; 3]) {
    let [width, height] = picture.size;
    let (Some(path), length) = outline(text, size) else { return };
    let Some(mut mask) = Mask::new(width, height) else { return };
    // Starting on a whole pixel makes the same text look the same everywhere.
    let start = ((left + right - length) / 2.0).round();
    mask.fill_path(&path, FillRule::Winding, true, Transform::from_translate(start, y.round()));
    for (pixel, cover) in picture.pixels.iter_mut().zip(mask.data()) {
        let cover = f32::from(*cover) / 255.0;
        for (value, ink) in pixel.iter_mut().zip(colour) {
            *value = *value * (1.0 - cover) + ink * cover;
        }
    }
}

/// A pen that puts glyphs side by side.
struct Pen {
    path: PathBuilder,
    scale: f32,
    left: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> [f32; 2] {
        [self.left + self.scale * x, -self.scale * y]
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ([x1, y1], [x, y]) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ([x1, y1], [x2, y2], [x, y]) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_reads_upright_and_from_left_to_right() {
        let mut picture = Picture::plain([40, 30], [0.0; 3]);
        write(&mut picture, "L", [0.0, 40.0, 25.0], 24.0, [1.0; 3]);
        let ink = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| -> f32 {
            rows.flat_map(|y| columns.clone().map(move |x| 40 * y + x)).map(|at| picture.pixels[at][0]).sum()
        };
        // The letter has its stem at the left and its foot at the bottom.
        assert!(ink(10..20, 0..20) > 20.0 && ink(20..30, 0..20) == 0.0 && ink(20..30, 20..25) > 5.0);
        assert_eq!(ink(0..40, 25..30), 0.0);
    }

    #[test]
    fn a_character_that_the_font_lacks_is_a_box() {
        let (missing, width) = outline("\u{4e00}", 10.0);
        assert!(missing.is_some() && width > 0.0);
    }
}
