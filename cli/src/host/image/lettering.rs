//! Letters of eight by eight pixels: on the scene's cards and balls, and under pictures.

use super::picture::Picture;
use font8x8::legacy::BASIC_LEGACY;

/// Pixels of a letter, each way.
pub const LETTER: usize = 8;

/// Whether a text in one line has ink at a pixel, counted from its top left corner.
pub fn inked(text: &str, column: usize, row: usize) -> bool {
    let letter = text.as_bytes().get(column / LETTER).map(|byte| usize::from(*byte));
    let rows = letter.and_then(|letter| BASIC_LEGACY.get(letter));
    // The font's lowest bit is the leftmost pixel.
    rows.and_then(|rows| rows.get(row)).is_some_and(|row| row >> (column % LETTER) & 1 == 1)
}

/// Writes a text in one line, magnified, with its top left corner at `corner`. What does not fit
/// into the picture is left out.
pub fn write(picture: &mut Picture, text: &str, corner: [u32; 2], magnification: u32, colour: [f32; 3]) {
    let [width, height] = picture.size;
    let [left, top] = corner;
    for y in top..height.min(top + LETTER as u32 * magnification) {
        for x in left..width.min(left + self::width(text, magnification)) {
            let [column, row] = [x - left, y - top].map(|at| (at / magnification) as usize);
            if inked(text, column, row) {
                picture.pixels[(y * width + x) as usize] = colour;
            }
        }
    }
}

/// The width of a text in pixels.
pub fn width(text: &str, magnification: u32) -> u32 {
    (text.len() * LETTER) as u32 * magnification
}
