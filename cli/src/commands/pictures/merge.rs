//! `realistic merge`: joins the tiles of `render --crop` to the whole picture.

use crate::console;
use crate::failure::Failure;
use crate::files;
use crate::image::tile::{self, Tile};
use crate::image::{Colours, Format, Picture, SrgbImage, check_memory, picture_path};
use std::path::{Path, PathBuf};

/// The options of `merge`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Tiles that `render --crop` wrote, in any order: all of them .png, or all .exr
    #[arg(value_name = "TILE", required = true, value_parser = picture_path)]
    tiles: Vec<PathBuf>,
    /// Picture to write, with the tiles' extension, or - for standard output; its bytes are those of a render without --crop
    #[arg(short, long, value_name = "FILE", value_parser = picture_path)]
    out: PathBuf,
}

/// Joins the tiles and writes the picture.
///
/// # Errors
/// A file is not a tile, tiles belong to different pictures, a pixel belongs to two tiles or to none, or a file
/// cannot be written. The message names the files.
pub fn run(args: &Args) -> Result<(), Failure> {
    // Standard output gets the format of the tiles.
    let named = if files::is_stdout(&args.out) { &args.tiles[0] } else { &args.out };
    let format = Format::of(named).map_err(Failure::Usage)?;
    if let Some(other) = args.tiles.iter().find(|tile| Format::of(tile) != Ok(format)) {
        return Err(Failure::Usage(format!(
            "tile {} and picture {} are of different formats; give --out the tiles' ending",
            other.display(),
            args.out.display()
        )));
    }
    let (size, bytes) = match format {
        Format::Png => {
            let (size, pixels) = join(&args.tiles, tile::read_png)?;
            (size, SrgbImage { size, pixels }.png(Colours::All))
        }
        Format::Exr => {
            let (size, pixels) = join(&args.tiles, tile::read_exr)?;
            let file = Picture { size, pixels }.exr();
            (size, file.map_err(|error| Failure::cannot_write(&args.out, &error))?)
        }
    };
    files::save(&args.out, &bytes).map_err(|error| Failure::cannot_write(&args.out, &error))?;
    let ([width, height], count) = (size, args.tiles.len());
    let plural = if count == 1 { "tile" } else { "tiles" };
    let text = format!("picture  {width}x{height}, of {count} {plural}\n         {}\n", args.out.display());
    Ok(console::report(&text, &args.out)?)
}

/// Returns the size of the picture that these tiles form, and its pixels.
fn join<P: Copy + Default>(
    paths: &[PathBuf],
    read: impl Fn(&Path) -> Result<Tile<P>, Failure>,
) -> Result<([u32; 2], Vec<P>), Failure> {
    let tiles = paths.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
    let size = same_picture(&tiles).map_err(Failure::Other)?;
    let pixels = pasted(&tiles, size).map_err(Failure::Other)?;
    Ok((size, pixels))
}

/// Returns the size of the picture to which all tiles belong.
fn same_picture<P>(tiles: &[Tile<P>]) -> Result<[u32; 2], String> {
    let (first, others) = tiles.split_first().ok_or("no tiles")?;
    for other in others {
        let (a, b) = (first.path.display(), other.path.display());
        let size = |tile: &Tile<P>| format!("{}x{}", tile.origin.whole[0], tile.origin.whole[1]);
        if first.origin.whole != other.origin.whole {
            return Err(format!(
                "{a} is a tile of a {} picture and {b} of a {} one; render both with the same --size",
                size(first),
                size(other)
            ));
        }
        if first.origin.settings.len() != other.origin.settings.len() {
            return Err(format!("{a} and {b} were written by different versions of this program"));
        }
        let pairs = || first.origin.settings.iter().zip(&other.origin.settings);
        if let Some(((name, of_a), (_, of_b))) = pairs().find(|(of_a, of_b)| of_a != of_b) {
            let why = if name == "rays" {
                ": the lens files differ, or with a tolerance the processors, of which the variable REALISTIC_SIMD can \
                 give all the same instructions"
            } else {
                ""
            };
            return Err(format!(
                "{a} and {b} are tiles of different pictures: {name} \"{of_a}\" and \"{of_b}\"{why}"
            ));
        }
    }
    Ok(first.origin.whole)
}

/// Returns the pixels of the picture, each copied from its tile.
fn pasted<P: Copy + Default>(tiles: &[Tile<P>], size: [u32; 2]) -> Result<Vec<P>, String> {
    let [width, height] = size;
    let crops: Vec<[u32; 4]> = tiles.iter().map(|tile| tile.origin.crop).collect();
    if let Some([a, b]) = overlap(&crops) {
        return Err(format!(
            "{} ({}) and {} ({}) overlap; leave one of them out, or render it again with another --crop",
            tiles[a].path.display(),
            rectangle(crops[a]),
            tiles[b].path.display(),
            rectangle(crops[b])
        ));
    }
    // Gaps are found before memory is allocated, because a tile may claim that its picture has any size.
    if let Some(gap) = gap(&crops, size) {
        let names: Vec<String> = tiles.iter().take(3).map(|tile| tile.path.display().to_string()).collect();
        let more = if tiles.len() > 3 { ", …" } else { "" };
        return Err(format!(
            "no tile of {}{more} has the pixels {gap} of the {width}x{height} picture; render them with --crop {gap}",
            names.join(", "),
            gap = rectangle(gap)
        ));
    }
    // The memory must hold the picture and the file that is made from it.
    let is_there = check_memory(size, 3 * size_of::<P>() as u64).is_ok();
    let mut pixels = tile::allocate(size).filter(|_| is_there).ok_or_else(|| {
        format!("there is no memory for the {width}x{height} picture; merge it where there is more")
    })?;
    for Tile { origin, pixels: own, .. } in tiles {
        let ([x0, y0, ..], [across, _]) = (origin.crop, origin.size());
        for (y, row) in (y0..).zip(own.chunks_exact(across as usize)) {
            let start = y as usize * width as usize + x0 as usize;
            pixels[start..start + row.len()].copy_from_slice(row);
        }
    }
    Ok(pixels)
}

/// Returns the indices of two rectangles that overlap, if there are such.
fn overlap(crops: &[[u32; 4]]) -> Option<[usize; 2]> {
    let meet = |[x0, y0, x1, y1]: [u32; 4], other: [u32; 4]| {
        x0 < other[2] && other[0] < x1 && y0 < other[3] && other[1] < y1
    };
    (1..crops.len()).find_map(|b| (0..b).find(|&a| meet(crops[a], crops[b])).map(|a| [a, b]))
}

/// Returns the largest empty rectangle that begins at the first empty pixel and is as wide as the gap in that pixel's
/// row. The given rectangles must not overlap.
fn gap(crops: &[[u32; 4]], [width, height]: [u32; 2]) -> Option<[u32; 4]> {
    // A row has the same gaps as the row above it unless a rectangle ends between the two.
    let mut rows: Vec<u32> = crops.iter().map(|crop| crop[3]).chain([0]).filter(|y| *y < height).collect();
    rows.sort_unstable();
    rows.into_iter().find_map(|y0| {
        let beside = crops.iter().filter(|crop| (crop[1]..crop[3]).contains(&y0));
        let mut spans: Vec<[u32; 2]> = beside.map(|crop| [crop[0], crop[2]]).collect();
        spans.sort_unstable();
        let x0 = spans.iter().fold(0, |end, [from, to]| if *from == end { *to } else { end });
        let x1 = spans.iter().map(|[from, _]| *from).find(|from| *from > x0).unwrap_or(width);
        let below = crops.iter().filter(|crop| crop[1] > y0 && crop[0] < x1 && x0 < crop[2]);
        let y1 = below.map(|crop| crop[1]).min().unwrap_or(height);
        (x0 < width).then_some([x0, y0, x1, y1])
    })
}

/// Formats a rectangle of pixels for --crop.
fn rectangle([x0, y0, x1, y1]: [u32; 4]) -> String {
    format!("{x0},{y0},{x1},{y1}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_xoshiro::Xoshiro256PlusPlus;

    #[test]
    fn what_rectangles_leave_is_found_as_pixel_by_pixel() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let size @ [width, height] = [7, 5];
        let (mut whole, mut overlapping) = (0, 0);
        for _ in 0..3000 {
            // The crops are cells of a grid with some cells missing, and sometimes with a rectangle at a random
            // position on top.
            let (column, row) = (random.random_range(1..width), random.random_range(1..height));
            let cells = [[0, 0, column, row], [column, 0, width, row], [0, row, width, height]];
            let mut crops: Vec<[u32; 4]> =
                cells.into_iter().filter(|_| random.random_range(0..4) > 0).collect();
            if random.random_range(0..4) == 0 {
                let (x, y) = (random.random_range(0..width), random.random_range(0..height));
                crops.push([x, y, random.random_range(x..width) + 1, random.random_range(y..height) + 1]);
            }
            let owners = |x: u32, y: u32| {
                crops.iter().filter(|c| c[0] <= x && x < c[2] && c[1] <= y && y < c[3]).count()
            };
            let mut pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let is_overlapping = pixels.clone().any(|(x, y)| owners(x, y) > 1);
            assert_eq!(overlap(&crops).is_some(), is_overlapping, "{crops:?}");
            overlapping += u32::from(is_overlapping);
            if is_overlapping {
                continue;
            }
            let expected = pixels.find(|&(x, y)| owners(x, y) == 0).map(|(x0, y0)| {
                let x1 = (x0..width).find(|&x| owners(x, y0) > 0).unwrap_or(width);
                let y1 = (y0..height).find(|&y| (x0..x1).any(|x| owners(x, y) > 0)).unwrap_or(height);
                [x0, y0, x1, y1]
            });
            assert_eq!(gap(&crops, size), expected, "{crops:?}");
            whole += u32::from(expected.is_none());
        }
        assert!(whole > 300 && overlapping > 300, "{whole} {overlapping}");
    }
}
