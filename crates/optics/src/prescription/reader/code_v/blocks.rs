//! The statements of a file, by what they describe: the whole lens, a surface, or a glass of the file's own catalogue.
//!
//! `SO`, `S` and `SI` enter the object, a surface and the image. A statement about a surface belongs to the surface
//! entered last, or to that of its qualifier, as in `CIR S3 12.5`.

use super::statements::is_of_surface;
use crate::prescription::{
    LensFileError, MAX_INTERFACES,
    reader::{
        commands::{Block, Command, Commands, Syntax},
        text::{Cell, Location, Text},
    },
};

/// The marks of the language. Letters of a keyword after the third do not count.
const SYNTAX: Syntax = Syntax { comment: "!", continues: Some('&'), letters: 3 };

/// All statements of a file.
#[derive(Debug)]
pub(super) struct Blocks<'t> {
    pub general: Vec<Command<'t>>,
    /// The statements between `PRV` and `END`.
    pub catalogue: Vec<Command<'t>>,
    /// The surfaces in order, with the object first and the image last.
    pub surfaces: Vec<Block<'t>>,
    pub comments: Vec<Location>,
}

impl<'t> Blocks<'t> {
    pub(super) fn of(text: &'t Text<'_>) -> Result<Self, LensFileError> {
        let Commands { all: commands, comments } = Commands::of(text, &SYNTAX);
        let mut all = Self { general: Vec::new(), catalogue: Vec::new(), surfaces: Vec::new(), comments };
        let mut in_catalogue = false;
        for command in commands {
            let is_end = in_catalogue && command.key == "END";
            in_catalogue |= command.key == "PRV";
            if in_catalogue {
                all.catalogue.push(command);
            } else if let Some(surface) = surface_of(command.record.key.text) {
                all.enter(text, command, surface)?;
            } else if is_of_surface(&command.key) {
                all.attach(text, command)?;
            } else {
                all.general.push(command);
            }
            in_catalogue &= !is_end;
        }
        Ok(all)
    }

    /// Adds a surface.
    fn enter(
        &mut self,
        text: &Text<'_>,
        entry: Command<'t>,
        surface: SurfaceName,
    ) -> Result<(), LensFileError> {
        let error = |message: String| Err(text.error(entry.location(), message));
        let number = self.surfaces.len();
        let has_image = self.surfaces.last().is_some_and(|last| is_image(&last.entry));
        match surface {
            _ if number == MAX_INTERFACES + 2 => {
                return error(format!("more surfaces; a lens has at most {MAX_INTERFACES} interfaces"));
            }
            _ if has_image => {
                return error("a surface behind the image (SI), which is the last one".to_owned());
            }
            SurfaceName::Object if number > 0 => {
                return error(format!("a second object (SO) behind surface {}", number - 1));
            }
            SurfaceName::Image | SurfaceName::Next if number == 0 => {
                return error("a surface in front of the object (SO), which is the first one".to_owned());
            }
            SurfaceName::Number(own) if own != number => {
                return error(format!("surface {own} where surface {number} is expected"));
            }
            _ => {}
        }
        self.surfaces.push(Block { number: format!("{number}"), entry, statements: Vec::new() });
        Ok(())
    }

    /// Adds a statement to its surface.
    fn attach(&mut self, text: &Text<'_>, mut command: Command<'t>) -> Result<(), LensFileError> {
        let is_number = |value: &&Cell<'_>| value.number().is_some();
        let words = command.record.words();
        let qualifier = words.iter().take_while(|value| !is_number(value)).position(|value| {
            value.text.starts_with(['S', 's'])
                && (surface_of(value.text).is_some() || value.text.contains(".."))
        });
        let Some(last) = self.surfaces.len().checked_sub(1) else {
            let message =
                format!("{} belongs to a surface; expected SO, the object, before it", command.shown());
            return Err(text.error(command.location(), message));
        };
        let number = match qualifier.map(|at| command.record.take(at)) {
            None => last,
            Some(cell) => match surface_of(cell.text) {
                Some(SurfaceName::Object) => 0,
                Some(SurfaceName::Number(own)) if own <= last => own,
                Some(SurfaceName::Image) if is_image(&self.surfaces[last].entry) => last,
                _ => {
                    let message = format!(
                        "\"{cell}\" is not one surface before this statement; write the statement once for each surface, \
                         behind its S"
                    );
                    return Err(text.error(cell.location, message));
                }
            },
        };
        self.surfaces[number].statements.push(command);
        Ok(())
    }

    /// Returns the last statement of this keyword about the whole lens.
    pub(super) fn find(&self, key: &str) -> Option<&Command<'t>> {
        self.general.iter().rev().find(|statement| statement.key == key)
    }
}

/// A surface as a statement names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SurfaceName {
    Object,
    Next,
    Image,
    Number(usize),
}

/// Returns the surface of a word: `SO`, `S`, `SI` or `S3`.
fn surface_of(word: &str) -> Option<SurfaceName> {
    match word.strip_prefix(['S', 's'])? {
        "" => Some(SurfaceName::Next),
        "O" | "o" | "0" => Some(SurfaceName::Object),
        "I" | "i" => Some(SurfaceName::Image),
        digits if digits.bytes().all(|byte| byte.is_ascii_digit()) => {
            digits.parse().ok().map(SurfaceName::Number)
        }
        _ => None,
    }
}

/// Returns whether a statement enters the image.
pub(super) fn is_image(entry: &Command<'_>) -> bool {
    surface_of(entry.record.key.text) == Some(SurfaceName::Image)
}
