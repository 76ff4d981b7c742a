//! The coating file of a lens (COATING.DAT): materials, `MATE NAME` and lines of wavelength (µm), index and extinction;
//! and coatings, `COAT NAME` and a line for each layer. `!` begins a comment.
//!
//! A layer has the name of a material, a thickness, and perhaps three more values: whether the thickness is in µm, the
//! number of a loop, and the name of a taper. A thickness that is not in µm is in wavelengths of the lens's primary
//! wavelength within the layer. The layers are listed from the air inward, whichever side of the surface is glass.
//!
//! Other definitions (tables, ideal and encrypted coatings) have no layers. Coatings with loops, tapers or absorbing
//! materials are not supported. The reason is reported when a surface has such a coating.

use std::{cell::Cell, collections::HashMap};

use crate::prescription::coating::{DENSEST, Layer, MOST_LAYERS, THICKEST};
use realistic_base::message::cut;

/// The coatings of a file, by their names in capitals.
#[derive(Debug)]
pub(in crate::prescription::reader) struct CoatingFile {
    /// The name of the file in messages.
    pub file: String,
    materials: HashMap<String, Vec<Line>>,
    coatings: HashMap<String, Definition>,
    is_used: Cell<bool>,
}

/// The words of a line.
type Line = Vec<String>;

/// The definition of a coating.
#[derive(Clone, Debug)]
enum Definition {
    /// The layers, from the air inward.
    Layers(Vec<Line>),
    /// A definition without layers, with the reason why it is not supported.
    Unsupported(&'static str),
}

/// The layers of a coating.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layers {
    /// The layers from the air inward.
    pub layers: Vec<Layer>,
    /// Whether the index of a layer differs between wavelengths.
    pub is_dispersive: bool,
}

/// The block to which a line belongs.
enum Block {
    Material(String),
    Coating(String),
    Other,
}

impl CoatingFile {
    /// Reads the definitions of a text. Their numbers are checked when a surface has the coating.
    pub(in crate::prescription::reader) fn of(file: &str, text: &str) -> Self {
        let mut all = Self {
            file: file.to_owned(),
            materials: HashMap::new(),
            coatings: HashMap::new(),
            is_used: Cell::new(false),
        };
        let mut block = Block::Other;
        for line in text.split(['\n', '\r']) {
            let words: Line =
                line.split('!').next().unwrap_or("").split_whitespace().map(str::to_owned).collect();
            let Some(first) = words.first() else { continue };
            let name = words.get(1).map_or_else(String::new, |name| name.to_ascii_uppercase());
            block = match first.to_ascii_uppercase().as_str() {
                "MATE" => {
                    all.materials.insert(name.clone(), Vec::new());
                    Block::Material(name)
                }
                "COAT" => {
                    all.define(&name, Definition::Layers(Vec::new()));
                    Block::Coating(name)
                }
                "IDEAL" | "IDEAL2" => all.other(&name, "it is an ideal coating, which has no layers"),
                "TABLE" => all.other(&name, "it is a table of transmissions, which has no layers"),
                "ENCRYPTED" => all.other(&name, "only the file's program can decrypt it"),
                "TAPR" => Block::Other,
                _ => {
                    let lines = match &block {
                        Block::Material(name) => all.materials.get_mut(name),
                        Block::Coating(name) => match all.coatings.get_mut(name) {
                            Some(Definition::Layers(layers)) => Some(layers),
                            _ => None,
                        },
                        Block::Other => None,
                    };
                    if let Some(lines) = lines {
                        lines.push(words);
                    }
                    continue;
                }
            };
        }
        all
    }

    /// Adds a definition without layers.
    fn other(&mut self, name: &str, reason: &'static str) -> Block {
        self.define(name, Definition::Unsupported(reason));
        Block::Other
    }

    fn define(&mut self, name: &str, definition: Definition) {
        let is_known = self.coatings.insert(name.to_owned(), definition).is_some();
        if is_known {
            self.coatings.insert(name.to_owned(), Definition::Unsupported("it is defined twice"));
        }
    }

    /// Returns whether a surface has a coating of the file.
    pub(in crate::prescription::reader) fn is_used(&self) -> bool {
        self.is_used.get()
    }

    /// Returns the layers of a coating for a lens with a primary wavelength, nm; `None` if the file has no coating of
    /// this name.
    ///
    /// # Errors
    /// The coating is not supported; the text gives the reason.
    pub(super) fn layers(&self, name: &str, wavelength: f64) -> Option<Result<Layers, String>> {
        let definition = self.coatings.get(&name.to_ascii_uppercase())?;
        let layers = match definition {
            Definition::Unsupported(reason) => Err((*reason).to_owned()),
            // `COAT I.95` and the like are ideal coatings of that transmission.
            Definition::Layers(lines) if lines.is_empty() => Err("it has no layers".to_owned()),
            Definition::Layers(lines) => self.of_lines(lines, wavelength),
        };
        self.is_used.set(self.is_used.get() || layers.is_ok());
        Some(layers)
    }

    fn of_lines(&self, lines: &[Line], wavelength: f64) -> Result<Layers, String> {
        let mut all = Layers { layers: Vec::new(), is_dispersive: false };
        for line in lines {
            let (layer, is_dispersive) = self.layer(line, wavelength)?;
            if layer.thickness > 0.0 {
                all.layers.push(layer);
                all.is_dispersive |= is_dispersive;
            }
        }
        let whole: f64 = all.layers.iter().map(|layer| layer.thickness).sum();
        if all.layers.len() > MOST_LAYERS || whole > THICKEST {
            return Err(format!("a coating has at most {MOST_LAYERS} layers and {THICKEST} nm"));
        }
        Ok(all)
    }

    /// Returns a layer, and whether its index differs between wavelengths.
    fn layer(&self, line: &Line, wavelength: f64) -> Result<(Layer, bool), String> {
        let shown = || format!("the layer \"{}\"", cut(&line.join(" ")));
        let (material, thickness, flags) = match line.as_slice() {
            [material, thickness, flags @ ..] => (material, thickness, flags),
            _ => return Err(format!("{} has no thickness", shown())),
        };
        let number = |word: &String| word.parse().ok().filter(|number: &f64| number.is_finite());
        let is_absolute = match flags.first().map_or(Some(0.0), number) {
            Some(0.0) => false,
            Some(1.0) => true,
            _ => return Err(format!("{} does not say whether its thickness is in µm", shown())),
        };
        if flags.get(1).is_some_and(|word| number(word) != Some(0.0)) || flags.len() > 2 {
            return Err(format!("{} is repeated or tapered", shown()));
        }
        let thickness = number(thickness).filter(|thickness| *thickness >= 0.0);
        let thickness = thickness.ok_or_else(|| format!("{} has no thickness of 0 or more", shown()))?;
        let (index, is_dispersive) = self.index(material, wavelength)?;
        let layer = match is_absolute {
            true => Layer { index, thickness: thickness * 1e3 },
            false => Layer::of_waves(index, thickness, wavelength),
        };
        Ok((layer, is_dispersive))
    }

    /// Returns the index of a material at a wavelength, nm, and whether the index differs between wavelengths. Indices
    /// are interpolated linearly between the wavelengths of the file; beyond them, the nearest one holds.
    fn index(&self, name: &str, wavelength: f64) -> Result<(f64, bool), String> {
        let shown = cut(name);
        let lines = self.materials.get(&name.to_ascii_uppercase());
        let lines = lines.ok_or_else(|| format!("material {shown} is not defined in {}", self.file))?;
        let mut rows: Vec<[f64; 2]> = Vec::with_capacity(lines.len());
        for line in lines {
            let numbers: Vec<f64> = line.iter().filter_map(|word| word.parse().ok()).collect();
            let is_rising = |micrometres: f64| rows.last().map_or(0.0, |last| last[0]) < 1e3 * micrometres;
            match numbers[..] {
                [micrometres, index, 0.0] if is_rising(micrometres) && (1.0..=DENSEST).contains(&index) => {
                    rows.push([1e3 * micrometres, index]);
                }
                [_, _, extinction] if extinction != 0.0 => {
                    return Err(format!("material {shown} absorbs or amplifies light"));
                }
                _ => {
                    let line = cut(&line.join(" "));
                    return Err(format!(
                        "material {shown} has a line \"{line}\"; expected a rising wavelength in µm, an index from 1 to \
                         {DENSEST} and 0"
                    ));
                }
            }
        }
        let [Some(first), Some(last)] = [rows.first(), rows.last()] else {
            return Err(format!("material {shown} has no index"));
        };
        let above = rows.partition_point(|row| row[0] <= wavelength);
        let index = match (above.checked_sub(1).map(|below| rows[below]), rows.get(above)) {
            (Some([from, low]), Some([to, high])) => low + (wavelength - from) / (to - from) * (high - low),
            (Some(_), None) => last[1],
            _ => first[1],
        };
        Ok((index, rows.iter().any(|row| row[1] != first[1])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "! Materials\nMATE MGF2\n0.4 1.39 0\n0.5 1.38 0\n.7 1.37 0\nMATE N2\n.55 2.0 0\nMATE ALU\n.55 .8 -6\n\
        MATE ODD\n.6 1.5 0\n.5 1.5 0\n\
        COAT NULL\nMGF2 0.0\nCOAT AR\nMGF2 .25 ! a quarter\nCOAT Two\nMGF2 0.1 1\nN2 .5 0 0\nCOAT METAL\nALU 0.04\n\
        COAT LOOP\nN2 .25 0 4\nCOAT TAPER\nN2 .25 0 0 EDGE\nCOAT LOST\nSIO 1\nCOAT BAD\nN2\nCOAT BAD2\nN2 x\nCOAT BAD3\n\
        N2 .1 2\nCOAT ODD\nODD .25\nCOAT THICK\nN2 9 1\nCOAT I.95\nIDEAL SPLIT 0.5 0.5\nTABLE T\nANGL 0\n\
        WAVE .5 1 1 0 0\nENCRYPTED SECRET\nCOAT AIR2\nN2 .1\nCOAT AIR2\nN2 .2\n";

    #[test]
    fn layers_have_the_indices_and_thicknesses_at_the_primary_wavelength() {
        let file = CoatingFile::of("COATING.DAT", FILE);
        let layers = |name: &str, wavelength: f64| {
            file.layers(name, wavelength).expect("defined").unwrap_or_else(|why| panic!("{why}"))
        };
        assert!(!file.is_used());
        assert_eq!(layers("NULL", 550.0), Layers { layers: vec![], is_dispersive: false });
        assert!(file.is_used());
        // Between 500 and 700 nm the index falls by 0.01; beyond the ends it stays.
        for (wavelength, index) in [(500.0, 1.38), (600.0, 1.375), (300.0, 1.39), (900.0, 1.37)] {
            let Layers { layers, is_dispersive } = layers("ar", wavelength);
            assert!((layers[0].index - index).abs() < 1e-12 && is_dispersive, "{layers:?}");
            assert!((layers[0].thickness - wavelength / 4.0 / index).abs() < 1e-10, "{layers:?}");
        }
        let two = layers("TWO", 500.0).layers;
        assert_eq!(two, [Layer { index: 1.38, thickness: 100.0 }, Layer { index: 2.0, thickness: 125.0 }]);
    }

    #[test]
    fn coatings_that_are_not_supported_give_the_reason() {
        let file = CoatingFile::of("COATING.DAT", FILE);
        assert!(file.layers("NONE", 550.0).is_none());
        for (name, reason) in [
            ("METAL", "material ALU absorbs"),
            ("LOOP", "the layer \"N2 .25 0 4\" is repeated or tapered"),
            ("TAPER", "is repeated or tapered"),
            ("LOST", "material SIO is not defined in COATING.DAT"),
            ("BAD", "the layer \"N2\" has no thickness"),
            ("BAD2", "the layer \"N2 x\" has no thickness of 0 or more"),
            ("BAD3", "does not say whether its thickness is in µm"),
            ("ODD", "material ODD has a line \".5 1.5 0\"; expected a rising wavelength"),
            ("THICK", "at most 50 layers and 5000 nm"),
            ("I.95", "it has no layers"),
            ("SPLIT", "an ideal coating"),
            ("T", "a table of transmissions"),
            ("SECRET", "only the file's program can decrypt it"),
            ("AIR2", "it is defined twice"),
        ] {
            let why = file.layers(name, 550.0).expect("defined").expect_err(name);
            assert!(why.contains(reason), "{why}");
        }
        assert!(!file.is_used());
    }
}
