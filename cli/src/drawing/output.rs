//! Writes a drawing: SVG directly, PNG by rasterising it.

use super::shapes::Page;
use crate::failure::Failure;
use crate::files;
use crate::image::Colours;
use std::path::{Path, PathBuf};

/// Parses the path of a drawing.
pub fn path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_known = is(&path, "svg") || is(&path, "png") || files::is_stdout(&path);
    if is_known { Ok(path) } else { Err("must end in .svg or .png, or be - for standard output".to_owned()) }
}

fn is(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Writes the drawing in the format of the file's ending; standard output gets an SVG.
///
/// # Errors
/// The file cannot be written; the message names it.
pub fn write(page: &Page, path: &Path) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::cannot_write(path, error);
    if is(path, "svg") || files::is_stdout(path) {
        return files::save(path, page.to_string().as_bytes()).map_err(|error| failed(&error));
    }
    let image = page.pixels(1.5).ok_or_else(|| failed(&"the drawing has no size"))?;
    files::save(path, &image.png(Colours::Frequent)).map_err(|error| failed(&error))
}

#[cfg(test)]
mod tests {
    use crate::drawing::shapes::{Anchor, Page, SMALL, text_width};

    /// Returns the columns of the first and last dark pixel.
    fn ink(text: &str) -> Option<(usize, usize)> {
        let mut page = Page::new(900.0, 40.0);
        page.text(text, [10.0, 25.0], SMALL, Anchor::Start, "#000000");
        let image = page.pixels(1.0).unwrap();
        let dark = |&column: &usize| (0..40).any(|row| image.pixels[900 * row + column][0] < 128);
        Some(((0..900).find(dark)?, (0..900).rfind(dark)?))
    }

    #[test]
    fn texts_show_and_need_no_more_room_than_is_kept_for_them() {
        for text in ["entrance pupil", "F' 123.4 mm, outside", "WMWMWM", "exit pupil & <film>"] {
            let (first, last) = ink(text).expect("the font is found");
            assert!(first >= 9);
            if text != "WMWMWM" {
                assert!((last as f64 - 10.0) <= text_width(text, SMALL), "{text}: {last}");
            }
        }
    }
}
