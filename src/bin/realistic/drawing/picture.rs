//! Writing a drawing: SVG as it is, PNG by rasterising it.

use crate::failure::Failure;
use resvg::{tiny_skia, usvg};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use svg::Document;

/// The file of a flag.
pub fn path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if is(&path, "svg") || is(&path, "png") { Ok(path) } else { Err("must end in .svg or .png".to_owned()) }
}

fn is(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Writes the drawing as its file's ending says.
///
/// # Errors
/// The file cannot be written; the message names it.
pub fn write(document: &Document, path: &Path) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| {
        Failure::Other(format!("cannot write {}: {error}; give --out another path", path.display()))
    };
    if is(path, "svg") {
        return svg::save(path, document).map_err(|error| failed(&error));
    }
    let image = rasterise(&document.to_string(), 1.5).map_err(|error| failed(&error))?;
    let file = File::create(path).map_err(|error| failed(&error))?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), image.width(), image.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder
        .write_header()
        .and_then(|mut writer| {
            // The page is opaque, so that colours are the same with and without their alpha.
            writer.write_image_data(image.data())?;
            writer.finish()
        })
        .map_err(|error| failed(&error))
}

/// The pixels of an SVG at `zoom` pixels a unit, with the program's own font: it looks the same everywhere.
///
/// # Errors
/// It is no SVG, or has no size.
pub fn rasterise(svg: &str, zoom: f32) -> Result<tiny_skia::Pixmap, String> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_source(usvg::fontdb::Source::Binary(Arc::new(epaint_default_fonts::UBUNTU_LIGHT)));
    let family = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
    fonts.set_sans_serif_family(family.unwrap_or_default());
    let options = usvg::Options { fontdb: Arc::new(fonts), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size().scale_by(zoom).ok_or("the drawing has no size")?;
    let mut image = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("the drawing has no size")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(zoom, zoom), &mut image.as_mut());
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::shapes::{Anchor, Page, SMALL, text_width};

    /// Columns of the first and last dark pixel.
    fn ink(text: &str) -> Option<(u32, u32)> {
        let mut page = Page::new(900.0, 40.0);
        page.text(text, [10.0, 25.0], SMALL, Anchor::Start, "#000000");
        let image = rasterise(&page.finish().to_string(), 1.0).unwrap();
        let dark = |&column: &u32| (0..40).any(|row| image.pixel(column, row).unwrap().red() < 128);
        Some(((0..900).find(dark)?, (0..900).rfind(dark)?))
    }

    #[test]
    fn texts_show_and_need_no_more_room_than_is_kept_for_them() {
        for text in ["entrance pupil", "F' 123.4 mm, outside", "WMWMWM", "exit pupil & <film>"] {
            let (first, last) = ink(text).expect("the font is found");
            assert!(first >= 9);
            if text != "WMWMWM" {
                assert!(f64::from(last - 10) <= text_width(text, SMALL), "{text}: {last}");
            }
        }
    }

    #[test]
    fn files_are_of_two_kinds() {
        assert!(path("a.SVG").is_ok() && path("b.png").is_ok());
        assert!(path("a.jpg").unwrap_err().contains(".png"));
    }
}
