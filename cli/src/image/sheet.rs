//! Several pictures on one sheet, each with a line of text under it.

use super::lettering;
use super::picture::Picture;

const GROUND: [f32; 3] = [0.012, 0.013, 0.016];
const TEXT: [f32; 3] = [0.80, 0.79, 0.75];

/// A sheet of equal panels, filled row by row.
pub struct Sheet {
    picture: Picture,
    panel: [u32; 2],
    columns: u32,
    filled: u32,
}

impl Sheet {
    /// Makes an empty sheet for `count` pictures of this size, with `columns` (at least 1) in a
    /// row.
    pub fn new(panel: [u32; 2], count: u32, columns: u32) -> Self {
        let columns = columns.min(count).max(1);
        let mut sheet = Self { picture: Picture::plain([0, 0], GROUND), panel, columns, filled: count };
        let [_, bottom] = sheet.corner(count.div_ceil(columns) * columns);
        let [right, _] = sheet.corner(columns - 1);
        sheet.picture = Picture::plain([right + panel[0] + sheet.gap(), bottom], GROUND);
        sheet.filled = 0;
        sheet
    }

    /// Puts a picture into the next panel; `scale` converts its values to the screen's.
    pub fn add(&mut self, label: &str, picture: &Picture, scale: f32) {
        let [left, top] = self.corner(self.filled);
        self.filled += 1;
        let shown = Picture {
            size: picture.size,
            pixels: picture.pixels.iter().map(|colour| colour.map(|value| value * scale)).collect(),
        };
        self.picture.paste(&shown, [left, top]);
        let size = self.letters() as f32;
        let line = [left, left + self.panel[0], top + self.panel[1]].map(|at| at as f32);
        lettering::write(&mut self.picture, label, [line[0], line[1], line[2] + 1.3 * size], size, TEXT);
    }

    /// Returns the sheet, in values for the screen.
    pub fn into_picture(self) -> Picture {
        self.picture
    }

    /// Returns the size of the letters.
    fn letters(&self) -> u32 {
        (self.panel[0] / 25).clamp(11, 24)
    }

    fn gap(&self) -> u32 {
        (self.panel[0] / 60).max(2)
    }

    fn corner(&self, index: u32) -> [u32; 2] {
        let (column, row) = (index % self.columns, index / self.columns);
        let line = 2 * self.letters();
        [
            self.gap() + column * (self.panel[0] + self.gap()),
            self.gap() + row * (self.panel[1] + line + self.gap() / 2),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_has_a_place_of_its_own_with_its_words_below() {
        let colours = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut sheet = Sheet::new([40, 20], 3, 2);
        for colour in colours {
            sheet.add("abc", &Picture::plain([40, 20], colour), 1.0);
        }
        let picture = sheet.into_picture();
        for colour in colours {
            assert_eq!(picture.pixels.iter().filter(|pixel| **pixel == colour).count(), 800);
        }
        let ink = picture.pixels.iter().filter(|pixel| **pixel != GROUND && !colours.contains(pixel)).count();
        assert!(ink > 0 && ink.is_multiple_of(3), "{ink}");
        let last = picture.pixels.len() - 1;
        assert_eq!(picture.pixels[last], GROUND);
    }
}
