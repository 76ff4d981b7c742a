//! Writing a drawing: SVG as it is, PNG by rasterising it.

use crate::failure::Failure;
use resvg::{tiny_skia, usvg};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
pub fn write(svg: &str, path: &Path) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| {
        Failure::Other(format!("cannot write {}: {error}; give --out another path", path.display()))
    };
    if is(path, "svg") {
        return std::fs::write(path, svg).map_err(|error| failed(&error));
    }
    let image = rasterise(svg, 1.5).map_err(|error| failed(&error))?;
    let (palette, indices) = indexed(image.data());
    let file = File::create(path).map_err(|error| failed(&error))?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), image.width(), image.height());
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_palette(palette);
    encoder
        .write_header()
        .and_then(|mut writer| {
            writer.write_image_data(&indices)?;
            writer.finish()
        })
        .map_err(|error| failed(&error))
}

/// The 256 most frequent colours of opaque pixels, as red, green and blue, and for each pixel the number
/// of the nearest among them: the colours drawn with stay, and of the blends at their edges some become others.
fn indexed(pixels: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let color = |pixel: &[u8]| [pixel[0], pixel[1], pixel[2]];
    let mut counts: BTreeMap<[u8; 3], u32> = BTreeMap::new();
    pixels.chunks_exact(4).for_each(|pixel| *counts.entry(color(pixel)).or_default() += 1);
    let mut frequent: Vec<_> = counts.iter().map(|(color, count)| (*count, *color)).collect();
    frequent.sort_unstable_by(|a, b| b.cmp(a));
    frequent.truncate(256);
    let distance = |a: [u8; 3], b: [u8; 3]| -> u32 {
        a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    let nearest = |color: [u8; 3]| {
        let all = (0..=255).zip(&frequent);
        all.min_by_key(|(_, (_, own))| distance(*own, color)).map_or(0, |(number, _)| number)
    };
    let numbers: BTreeMap<[u8; 3], u8> = counts.keys().map(|&color| (color, nearest(color))).collect();
    let palette = frequent.iter().flat_map(|(_, color)| *color).collect();
    (palette, pixels.chunks_exact(4).map(|pixel| numbers[&color(pixel)]).collect())
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
        let image = rasterise(&page.finish(), 1.0).unwrap();
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
    fn few_colours_are_kept_and_of_many_the_frequent_ones_stay() {
        let few = [[255, 255, 255, 255], [0, 114, 178, 255], [255, 255, 255, 255]];
        let (palette, indices) = indexed(few.as_flattened());
        assert_eq!(
            (palette.as_slice(), indices.as_slice()),
            (&[255, 255, 255, 0, 114, 178][..], &[0, 1, 0][..])
        );
        let mut many: Vec<[u8; 4]> =
            (0..=255).flat_map(|i| [[i, 255 - i, i / 2, 255], [i, i, i, 255]]).collect();
        many.extend([[0, 114, 178, 255]; 9]);
        let (palette, indices) = indexed(many.as_flattened());
        assert!(palette.len() <= 3 * 256);
        let last = usize::from(*indices.last().unwrap());
        assert_eq!(palette[3 * last..3 * last + 3], [0, 114, 178]);
    }

    #[test]
    fn files_are_of_two_kinds() {
        assert!(path("a.SVG").is_ok() && path("b.png").is_ok());
        assert!(path("a.jpg").unwrap_err().contains(".png"));
    }
}
