//! Pictures for a screen and a PNG file: 8 bits per channel by the transfer function of IEC 61966-2-1.

use std::collections::BTreeMap;

/// A picture in 8-bit sRGB: rows from the top, each row from the left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SrgbImage {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// One colour per pixel.
    pub pixels: Vec<[u8; 3]>,
}

/// The colours of a PNG file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colours {
    /// All colours, for pictures.
    All,
    /// The 256 most frequent colours, for drawings: the drawing's own colours stay, and some of the blends at
    /// their edges change.
    Frequent,
}

impl SrgbImage {
    /// Encodes the picture as a PNG file.
    pub fn png(&self, colours: Colours) -> Vec<u8> {
        self.png_with(colours, None, None)
    }

    /// Encodes the picture as a PNG file with a text chunk, given by keyword and text, and a chunk of another type.
    pub fn png_with(
        &self,
        colours: Colours,
        text: Option<(&str, String)>,
        chunk: Option<([u8; 4], Vec<u8>)>,
    ) -> Vec<u8> {
        let mut file = Vec::new();
        self.encode(&mut file, colours, text, chunk).expect("memory takes every picture that there is");
        file
    }

    fn encode(
        &self,
        file: &mut Vec<u8>,
        colours: Colours,
        text: Option<(&str, String)>,
        chunk: Option<([u8; 4], Vec<u8>)>,
    ) -> Result<(), png::EncodingError> {
        let [width, height] = self.size;
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let bytes = match colours {
            Colours::All => {
                encoder.set_color(png::ColorType::Rgb);
                encoder.set_compression(png::Compression::High);
                encoder.set_filter(png::Filter::Adaptive);
                self.pixels.as_flattened().to_vec()
            }
            Colours::Frequent => {
                let (palette, indices) = self.indexed();
                encoder.set_color(png::ColorType::Indexed);
                encoder.set_compression(png::Compression::High);
                encoder.set_filter(png::Filter::NoFilter);
                encoder.set_palette(palette);
                indices
            }
        };
        if let Some((keyword, text)) = text {
            encoder.add_itxt_chunk(keyword.to_owned(), text)?;
        }
        let mut writer = encoder.write_header()?;
        if let Some((kind, data)) = chunk {
            writer.write_chunk(png::chunk::ChunkType(kind), &data)?;
        }
        writer.write_image_data(&bytes)?;
        writer.finish()
    }

    /// Returns the most frequent colours, as red, green and blue, and for each pixel the index of the nearest of
    /// these colours.
    fn indexed(&self) -> (Vec<u8>, Vec<u8>) {
        let mut counts: BTreeMap<[u8; 3], u32> = BTreeMap::new();
        self.pixels.iter().for_each(|colour| *counts.entry(*colour).or_default() += 1);
        let mut frequent: Vec<_> = counts.iter().map(|(colour, count)| (*count, *colour)).collect();
        frequent.sort_unstable_by(|a, b| b.cmp(a));
        frequent.truncate(256);
        let distance = |a: [u8; 3], b: [u8; 3]| -> u32 {
            a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
        };
        let nearest = |colour: [u8; 3]| {
            let all = (0..=255).zip(&frequent);
            all.min_by_key(|(_, (_, own))| distance(*own, colour)).map_or(0, |(number, _)| number)
        };
        let numbers: BTreeMap<[u8; 3], u8> = counts.keys().map(|&colour| (colour, nearest(colour))).collect();
        let palette = frequent.iter().flat_map(|(_, colour)| *colour).collect();
        (palette, self.pixels.iter().map(|colour| numbers[colour]).collect())
    }
}

/// Encodes a linear value as 8 bits; values out of range are clipped.
pub fn encode(linear: f32) -> u8 {
    let value = linear.clamp(0.0, 1.0);
    let encoded = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

/// Formats a linear colour as `#rrggbb`.
pub fn hex(linear: [f32; 3]) -> String {
    let [red, green, blue] = linear.map(encode);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Decodes 8 bits to a linear value.
pub fn decode(byte: u8) -> f32 {
    let encoded = f32::from(byte) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back() {
        assert!((0..=255).all(|byte| encode(decode(byte)) == byte));
        assert_eq!([encode(-1.0), encode(0.214), encode(3.0)], [0, 127, 255]);
    }

    #[test]
    fn few_colours_are_kept_and_of_many_the_frequent_ones_stay() {
        let indexed = |pixels: Vec<[u8; 3]>| SrgbImage { size: [pixels.len() as u32, 1], pixels }.indexed();
        let (palette, indices) = indexed(vec![[255, 255, 255], [0, 114, 178], [255, 255, 255]]);
        assert_eq!((palette, indices), (vec![255, 255, 255, 0, 114, 178], vec![0, 1, 0]));
        let mut many: Vec<[u8; 3]> = (0..=255).flat_map(|i| [[i, 255 - i, i / 2], [i, i, i]]).collect();
        many.extend([[0, 114, 178]; 9]);
        let (palette, indices) = indexed(many);
        assert!(palette.len() <= 3 * 256);
        let last = usize::from(*indices.last().unwrap());
        assert_eq!(palette[3 * last..3 * last + 3], [0, 114, 178]);
    }
}
