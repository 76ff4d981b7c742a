//! The pictures in the documentation match the output of the commands under them.

use super::realistic;
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::Path;

/// Pictures that other programs make, each with the test that compares it.
const BY_OTHERS: [(&str, &str); 5] = [
    ("python-export-grid.png", "python/tests/test_examples.py"),
    ("python-field-maps.png", "python/tests/test_examples.py"),
    ("python-picture.png", "python/tests/test_examples.py"),
    ("python-lens-sheet.png", "python/tests/test_examples.py"),
    ("blender-studio.jpg", "blender/tests/test_pictures.py"),
];

/// A picture that shows its own noise, so the test makes it in its full size and with its full number of samples.
const AS_IT_IS: &str = "slide-lamps.png";
/// A picture so bright that the share of it above white depends on the noise, so the test makes it with its full
/// number of samples.
const BRIGHT: &str = "slide-colour.jpg";
/// A picture of many lamps as small as a pixel, whose light above white is clipped in each pixel, so the test makes
/// it at the size [`FINE`].
const LAMPS: &str = "fisheye.jpg";
/// Size at which a sheet of panels still has gaps and letters in proportion.
const SMALL: &str = "300x200";
const FINE: &str = "600x400";
/// Number of cells along a side of a flare's grid.
const CELLS: &str = "24";
/// Largest number of samples per pixel.
const SAMPLES: u32 = 16;
/// Number of pixels on either side over which a small picture is averaged.
const BLUR: usize = 5;
/// Largest difference of decoded pictures, with the screen's white as 1, that one blurred value in a hundred may
/// exceed. Noise, the numbers of samples written on slides, and lamps above white cause 0.03. JPEG of quality 90 adds
/// 0.001 to that. A colour slide with a wrong dispersion causes 0.07.
const DIFFERENCE: f32 = 0.06;

/// A picture as planes of linear light.
struct Picture {
    size: [usize; 2],
    planes: [Vec<f32>; 3],
}

impl Picture {
    fn read(file: &Path) -> Self {
        let bytes = std::fs::read(file).unwrap();
        let is_jpeg = file.extension().is_some_and(|end| end == "jpg");
        let (size, samples, bytes) = if is_jpeg { decoded_jpeg(&bytes) } else { decoded_png(&bytes) };
        let pixels = bytes.chunks_exact(samples);
        let linear: [f32; 256] = std::array::from_fn(|byte| {
            let value = byte as f32 / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        let of = |channel: usize| pixels.clone().map(|pixel| linear[usize::from(pixel[channel])]).collect();
        let planes = [0, 1, 2].map(of);
        Self { size, planes }
    }

    /// Resizes to the size of another picture. A wider picture is cut to its left part, because the command did not
    /// make the rest.
    fn like(mut self, [width, height]: [usize; 2]) -> Self {
        let scale = self.size[1] as f32 / height as f32;
        let taken = ((width as f32 * scale).round() as usize).min(self.size[0]);
        for plane in &mut self.planes {
            let narrow = rows(plane, self.size[0], |row| shrink(&row[..taken], width));
            *plane = rows(&narrow, self.size[1], |column| shrink(column, height));
        }
        self.size = [width, height];
        self
    }

    /// Returns the blurred picture, in values for the screen.
    fn blurred(&self) -> Vec<f32> {
        let shown = |value: &f32| {
            if *value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
        };
        let blur = |plane: &Vec<f32>| rows(&rows(plane, self.size[0], means), self.size[1], means);
        self.planes.iter().flat_map(blur).map(|value| shown(&value)).collect()
    }
}

/// Width and height, samples per pixel, and the samples with 8 bits each.
type Decoded = ([usize; 2], usize, Vec<u8>);

fn decoded_png(file: &[u8]) -> Decoded {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    ([info.width as usize, info.height as usize], info.color_type.samples(), bytes)
}

fn decoded_jpeg(file: &[u8]) -> Decoded {
    let mut decoder = zune_jpeg::JpegDecoder::new(std::io::Cursor::new(file));
    let bytes = decoder.decode().unwrap();
    let (width, height) = decoder.dimensions().unwrap();
    ([width, height], bytes.len() / (width * height), bytes)
}

/// Changes every row of a plane and transposes the plane; two calls change rows and columns.
fn rows(plane: &[f32], width: usize, change: impl Fn(&[f32]) -> Vec<f32>) -> Vec<f32> {
    let lines: Vec<_> = plane.chunks_exact(width).map(change).collect();
    (0..lines[0].len()).flat_map(|at| lines.iter().map(move |line| line[at])).collect()
}

/// Returns the averages of `parts` equal parts of a line.
fn shrink(line: &[f32], parts: usize) -> Vec<f32> {
    let part = line.len() as f32 / parts as f32;
    let mean = |number: usize| {
        let (from, to) = (number as f32 * part, (number + 1) as f32 * part);
        let covered = (from as usize..line.len().min(to.ceil() as usize))
            .map(|at| line[at] * (to.min(at as f32 + 1.0) - from.max(at as f32)));
        covered.sum::<f32>() / part
    };
    (0..parts).map(mean).collect()
}

/// Returns each value averaged with its neighbours.
fn means(line: &[f32]) -> Vec<f32> {
    let around = |at: usize| &line[at.saturating_sub(BLUR)..line.len().min(at + BLUR + 1)];
    (0..line.len()).map(|at| around(at).iter().sum::<f32>() / around(at).len() as f32).collect()
}

/// Returns the pictures of a page, each with the program's first command in the text below the picture.
fn pictures(page: &str) -> Vec<(String, Option<Vec<String>>)> {
    let under = |rest: &str| -> Option<Vec<String>> {
        let end = [rest.find("!["), rest.find("\n#")].into_iter().flatten().min().unwrap_or(rest.len());
        let (_, command) = rest[..end].split_once("`realistic ")?;
        Some(command.split('`').next()?.split_whitespace().map(str::to_owned).collect())
    };
    page.match_indices("![")
        .filter_map(|(start, _)| {
            let (_, target) = page[start..].split_once("](")?;
            let (file, rest) = target.split_once(')')?;
            Some((file.rsplit_once("images/")?.1.to_owned(), under(rest)))
        })
        .collect()
}

/// Returns a picture's name without its folder and format.
fn stem(file: &str) -> &OsStr {
    Path::new(file).file_stem().unwrap()
}

/// Returns the command with another output path, and with a small size if it is a render that allows this.
fn with_output(command: &[String], out: &str) -> Vec<String> {
    let mut arguments = command.to_vec();
    let set = |arguments: &mut Vec<String>, name: &str, value: &str| match arguments
        .iter()
        .position(|argument| argument == name)
    {
        Some(at) => value.clone_into(&mut arguments[at + 1]),
        None => arguments.extend([name.to_owned(), value.to_owned()]),
    };
    match arguments.iter_mut().find(|argument| argument.starts_with("--list=")) {
        Some(list) => *list = format!("--list={out}"),
        None => set(&mut arguments, "--out", out),
    }
    if command[0] == "flare" {
        set(&mut arguments, "--size", SMALL);
        set(&mut arguments, "--rays", CELLS);
    }
    if command[0] == "render" && stem(out) != stem(AS_IT_IS) {
        set(&mut arguments, "--size", if stem(out) == stem(LAMPS) { FINE } else { SMALL });
        // The smooth filter has a fixed width in pixels, so in a small picture it would spread lamps over a larger
        // part of the picture.
        if !arguments.iter().any(|argument| argument == "--slide") {
            set(&mut arguments, "--filter", "box");
        }
        if stem(out) != stem(BRIGHT) {
            let samples = arguments.iter().position(|argument| argument == "--spp");
            let samples = samples.map_or(SAMPLES, |at| SAMPLES.min(arguments[at + 1].parse().unwrap()));
            set(&mut arguments, "--spp", &samples.to_string());
        }
    }
    arguments
}

#[test]
#[ignore = "a sweep of a minute and more, which .ci/run makes: every picture of the pages"]
fn every_picture_is_what_its_command_makes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut pages = vec![root.join("README.md")];
    let docs = std::fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    pages.extend(docs.filter(|file| file.extension().is_some_and(|end| end == "md")));
    let mut stale = String::new();
    let mut seen = Vec::new();
    for page in pages {
        for (name, command) in pictures(&std::fs::read_to_string(&page).unwrap()) {
            let committed = root.join("docs/images").join(&name);
            // Pages share pictures; if two commands belong to one picture, both of them are run.
            if seen.contains(&(name.clone(), command.clone())) {
                continue;
            }
            seen.push((name.clone(), command.clone()));
            if let Some((_, test)) = BY_OTHERS.iter().find(|(file, _)| *file == name) {
                let test = std::fs::read_to_string(root.join(test)).unwrap();
                assert!(test.contains(&name), "no test compares {name}");
                continue;
            }
            let command = command.unwrap_or_else(|| panic!("{}: no command under {name}", page.display()));
            // The program writes a PNG file, which a maintainer converts to JPEG.
            let made = folder.path().join(name.replace(".jpg", ".png"));
            let arguments = with_output(&command, made.to_str().unwrap());
            let output = realistic(root, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
            assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
            let difference = if name.ends_with(".svg") {
                let same = std::fs::read(&committed).unwrap() == std::fs::read(&made).unwrap();
                if same { 0.0 } else { 1.0 }
            } else {
                let made = Picture::read(&made);
                let committed = Picture::read(&committed).like(made.size);
                let pairs = committed.blurred().into_iter().zip(made.blurred());
                let mut apart: Vec<_> = pairs.map(|(old, new)| (old - new).abs()).collect();
                apart.sort_by(f32::total_cmp);
                apart[apart.len() - 1 - apart.len() / 100]
            };
            println!("{name}: {difference:.3}");
            if difference > DIFFERENCE {
                let command = command.join(" ");
                writeln!(stale, "{name} differs by {difference:.3}: realistic {command}").unwrap();
            }
        }
    }
    assert!(stale.is_empty(), "pictures in docs/images that their commands no longer make:\n{stale}");
    for entry in std::fs::read_dir(root.join("docs/images")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(seen.iter().any(|(shown, _)| *shown == name), "no page shows docs/images/{name}");
    }
}

#[test]
fn the_first_command_under_a_picture_is_its_own() {
    let page = "![a](docs/images/a.png)\nText, `realistic render x`, `realistic b`.\n![b](images/b.png)\n## c\n`realistic c`";
    let found = pictures(page);
    assert_eq!(found[0], ("a.png".to_owned(), Some(vec!["render".to_owned(), "x".to_owned()])));
    assert_eq!(found[1], ("b.png".to_owned(), None));
}
