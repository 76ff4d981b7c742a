//! `realistic merge`: the tiles of `render --crop` to the whole picture.

use crate::failure::Failure;
use crate::files;
use crate::image::tile::{self, Tile};
use crate::image::{Colours, Format, Picture, SrgbImage, picture_path, writable};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The options of `merge`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Tiles that `render --crop` wrote, in any order: all of them .png, or all .exr
    #[arg(value_name = "TILE", required = true, value_parser = picture_path)]
    tiles: Vec<PathBuf>,
    /// Picture to write, with the tiles' ending: the bytes of the picture that is rendered without --crop
    #[arg(long, value_name = "FILE", value_parser = picture_path)]
    out: PathBuf,
}

/// Joins the tiles and writes the picture.
///
/// # Errors
/// A file that is no tile, tiles of different pictures, pixels that two tiles have or none, or a file that cannot be
/// written. The message names the files.
pub fn run(args: &Args) -> Result<(), Failure> {
    writable(&args.out)?;
    let format = Format::of(&args.out).map_err(Failure::Usage)?;
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
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

/// Width and height of the picture of these tiles, and its pixels.
fn join<P: Copy + Default>(
    paths: &[PathBuf],
    read: impl Fn(&Path) -> Result<Tile<P>, Failure>,
) -> Result<([u32; 2], Vec<P>), Failure> {
    let tiles = paths.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
    let size = same_picture(&tiles).map_err(Failure::Other)?;
    let pixels = pasted(&tiles, size).map_err(Failure::Other)?;
    Ok((size, pixels))
}

/// Width and height of the picture that all tiles are a part of.
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

/// The picture's pixels, each from the tile that has it.
fn pasted<P: Copy + Default>(tiles: &[Tile<P>], [width, height]: [u32; 2]) -> Result<Vec<P>, String> {
    let room = width as usize * height as usize;
    let mut pixels = vec![P::default(); room];
    // The number of the tile that a pixel came from.
    let mut owners: Vec<Option<usize>> = vec![None; room];
    let place = |x: u32, y: u32| y as usize * width as usize + x as usize;
    for (number, Tile { path, origin, pixels: own }) in tiles.iter().enumerate() {
        let ([x0, y0, ..], [across, _]) = (origin.crop, origin.size());
        for (y, row) in (y0..).zip(own.chunks_exact(across as usize)) {
            let range = place(x0, y)..place(x0, y) + row.len();
            if let Some(before) = owners[range.clone()].iter().flatten().next() {
                let other = &tiles[*before];
                return Err(format!(
                    "{} ({}) and {} ({}) overlap; leave one of them out, or render it again with another --crop",
                    other.path.display(),
                    rectangle(other.origin.crop),
                    path.display(),
                    rectangle(origin.crop)
                ));
            }
            owners[range.clone()].fill(Some(number));
            pixels[range].copy_from_slice(row);
        }
    }
    let Some(first) = owners.iter().position(Option::is_none) else {
        return Ok(pixels);
    };
    // The largest empty rectangle that begins there, as far to the right as the first row is empty.
    let [x0, y0] = [first as u32 % width, first as u32 / width];
    let is_free = |x: u32, y: u32| owners[place(x, y)].is_none();
    let x1 = (x0..width).find(|&x| !is_free(x, y0)).unwrap_or(width);
    let y1 = (y0..height).find(|&y| !(x0..x1).all(|x| is_free(x, y))).unwrap_or(height);
    let names: Vec<String> = tiles.iter().take(3).map(|tile| tile.path.display().to_string()).collect();
    let more = if tiles.len() > 3 { ", …" } else { "" };
    Err(format!(
        "no tile of {}{more} has the pixels {gap} of the {width}x{height} picture; render them with --crop {gap}",
        names.join(", "),
        gap = rectangle([x0, y0, x1, y1])
    ))
}

/// A rectangle of pixels as --crop takes it.
fn rectangle([x0, y0, x1, y1]: [u32; 4]) -> String {
    format!("{x0},{y0},{x1},{y1}")
}
