//! The reader of lens files. This module recognises the format of a text. Each format has its own module: the
//! project's own [`table`], [`optical_bench`] text, [`zemax`] files and their archives ([`zar`]), [`code_v`] sequences,
//! [`oslo`], [`flaresim`], [`physical_camera`] and [`json`] files, and [`agf`] catalogues of glass. Every lens format produces rows, from which
//! [`surface_rows`] builds checked interfaces. Files of other programs are not supported; [`binary`] and [`foreign`]
//! recognise them by their beginning, so that the message names the program instead of reporting a misread number.
//!
//! To add a format, write a module here that builds a [`Prescription`] from a text, within the limits, with a
//! `SurfaceRow` for each surface. Add recognition of the format to [`Format::of`], malformed files to the tests of the
//! module, and a valid file to the files that `tests/abi/fuzz_bodies.rs` mutates. Describe the format in
//! `docs/lens-format.md` and `docs/lenses.md`.
//!
//! A file has at most [`MAX_FILE_BYTES`] bytes (an archive has `MAX_ARCHIVE_BYTES`), `MAX_INTERFACES` interfaces and
//! the same number of glass definitions. The name of the file and the names of its glasses have at most
//! [`MAX_NAME_BYTES`] bytes. Larger input is refused before anything is computed from it. No real lens comes near
//! these limits, and a file from elsewhere must not keep the reader busy.

pub(super) mod agf;
mod code_v;
mod commands;
mod flaresim;
mod json;
mod ledger;
mod named_glass;
mod optical_bench;
mod oslo;
mod physical_camera;
mod record;
mod reflections;
mod sequential;
mod surface_rows;
mod table;
mod text;
mod zar;
mod zemax;

use super::{
    Fate, LensFileError, MAX_FILE_BYTES, MAX_NAME_BYTES, glass::GlassLibrary, interfaces::Prescription,
    source::is_zip,
};
use ledger::Ledger;
use realistic_base::message::{counted, cut, folded};
use text::Text;
pub(super) use zar::is_archive;

/// Reads the text of a lens file in any format. Glass names are looked up among the built-in glasses.
///
/// # Errors
/// See [`read_with`].
pub fn read(name: &str, bytes: &[u8]) -> Result<Prescription, LensFileError> {
    read_with(name, bytes, &GlassLibrary::default())
}

/// Reads the text of a lens file in any format. Glass names are looked up in `library`.
///
/// `name` is the name of the file as the caller knows it; every error message begins with `name`. The text is UTF-8
/// with or without a byte-order mark, or UTF-16 with a byte-order mark. Comments may be in any encoding. A Zemax
/// archive is read as the lens in it; the file in the errors of that lens is `name/MEMBER`.
///
/// # Errors
/// The text is not a lens; the error gives the first location at which the text is malformed, and the expected content.
/// Also an error are a text of more than [`MAX_FILE_BYTES`] bytes, more interfaces or glasses than a lens may have, and
/// a name of more than [`MAX_NAME_BYTES`] bytes.
pub fn read_with(name: &str, bytes: &[u8], library: &GlassLibrary) -> Result<Prescription, LensFileError> {
    let short_name = short_name(name);
    if short_name.len() > MAX_NAME_BYTES {
        let message =
            format!("the lens's name has {} bytes; a name has at most {MAX_NAME_BYTES}", short_name.len());
        return Err(LensFileError { file: cut(&short_name), line: 1, column: 1, message });
    }
    if is_archive(bytes) {
        return Ok(Prescription { name: short_name, ..zar::read(name, bytes, library)? });
    }
    if let Some(within) = bytes.get(..MAX_FILE_BYTES as usize).filter(|within| within.len() < bytes.len()) {
        let line_start = within.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        return Err(LensFileError {
            file: name.to_owned(),
            line: within.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: within.len() - line_start + 1,
            message: format!("the file goes on here; a lens file has at most {MAX_FILE_BYTES} bytes (1 MiB)"),
        });
    }
    let bytes = text::decoded(bytes);
    let text = Text::new(name, &bytes);
    let mut ledger = Ledger::of(&text);
    let lens = match Format::of(&bytes) {
        Format::Table => table::read(name, &bytes, library, &mut ledger),
        Format::OpticalBench => optical_bench::read(&text, library, &mut ledger),
        Format::Zemax => zemax::read(&text, library, None, &mut ledger),
        Format::CodeV => code_v::read(&text, library, &mut ledger),
        Format::Oslo => oslo::read(&text, library, &mut ledger),
        Format::FlareSim => flaresim::read(&text, &mut ledger),
        Format::PhysicalCamera => physical_camera::read(&text, &mut ledger),
        Format::Json => json::read(&text, library, &mut ledger),
        Format::Foreign(message) => Err(LensFileError { file: name.to_owned(), line: 1, column: 1, message }),
    }?;
    Ok(Prescription { name: short_name, ..finished(lens, ledger, library) })
}

/// Returns a lens with the findings and warnings of its file.
fn finished(mut lens: Prescription, mut ledger: Ledger<'_>, library: &GlassLibrary) -> Prescription {
    keep_paired_positions(&mut lens, &mut ledger);
    for remark in &lens.remarks {
        ledger.replaced_by("glass", remark);
    }
    let (findings, warnings) = ledger.close();
    lens.remarks = folded(&[warnings, lens.remarks, library.warnings()].concat());
    Prescription { findings: findings.into(), ..lens }
}

/// Leaves out the positions that do not pair, and puts the others in the order of `Positions::layout`.
fn keep_paired_positions(lens: &mut Prescription, ledger: &mut Ledger<'_>) {
    let Some(positions) = &mut lens.positions else { return };
    let paired = positions.paired();
    let left_out: Vec<usize> =
        (0..positions.columns.len()).filter(|i| !paired.contains(i)).map(|i| i + 1).collect();
    positions.columns = paired.iter().map(|&i| positions.columns[i].clone()).collect();
    if !lens.stated.fields.is_empty() {
        lens.stated.fields = paired.iter().map(|&i| lens.stated.fields.get(i).copied().flatten()).collect();
    }
    if !left_out.is_empty() {
        let reason = format!(
            "{} without its like: a lens has its zoom positions for its farthest object first, then as many, in the same order, \
             for each nearer one",
            counted("position", "positions", &left_out)
        );
        ledger.warn_of_file(Fate::LeftOut, "positions", reason);
    }
}

/// The format of a lens file.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Format {
    Table,
    OpticalBench,
    Zemax,
    CodeV,
    Oslo,
    FlareSim,
    PhysicalCamera,
    Json,
    /// A glass catalogue or a file of another program, with the message that says so.
    Foreign(String),
}

impl Format {
    /// Recognises the format of a text by a line that occurs only in this format.
    fn of(bytes: &[u8]) -> Self {
        let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
        let begins = |line: &[u8], word: &str, then: fn(&u8) -> bool| {
            line.strip_prefix(word.as_bytes()).is_some_and(|rest| rest.first().is_some_and(then))
        };
        if let Some(message) = binary(bytes) {
            return Self::Foreign(message.to_owned());
        }
        let known = |line: &[u8]| {
            if line.trim_ascii().to_ascii_lowercase().starts_with(b"[lens data]") {
                Some(Self::OpticalBench)
            } else if zemax::is_surface(line) {
                Some(Self::Zemax)
            } else if begins(line, "NM ", |_| true) {
                let message = "a catalogue of glasses (AGF), not a lens; give it as \"glass_catalog\"";
                Some(Self::Foreign(message.to_owned()))
            } else if line.trim_ascii() == b"surfaces:" {
                Some(Self::FlareSim)
            } else {
                None
            }
        };
        let start = bytes.trim_ascii_start();
        let unknown = || match foreign(start) {
            _ if is_toml(start) && physical_camera::is_lens(bytes) => Self::PhysicalCamera,
            Some(message) => Self::Foreign(message),
            None if json::is_json(start) => Self::Json,
            None => by_commands(start).unwrap_or(Self::Table),
        };
        lines.into_iter().find_map(known).unwrap_or_else(unknown)
    }
}

fn short_name(name: &str) -> String {
    std::path::Path::new(name)
        .file_name()
        .map_or_else(|| name.to_owned(), |file| file.to_string_lossy().into_owned())
}

/// The supported formats, for messages about other files.
const READ: &str = "read are a table with a line for each surface (radius, thickness, index and clear diameter in mm: \
                    docs/lens-format.md), Optical Bench text, Zemax text (.zmx) and archives (.zar), Code V \
                    sequences (.seq), OSLO text (.len), FlareSim text (.lens), Physical Camera's lenses (.toml), and \
                    JSON of LensHH (.lhlt), RayOptics (.roa), Optiland, DeepLens, ghostlight (.lens), ISET and Geopter; \
                    export one of these";

/// Recognises, by its first bytes, a file that is not text, or a file that only refers to another file.
fn binary(bytes: &[u8]) -> Option<&'static str> {
    const POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";
    match bytes {
        _ if is_archive(bytes) => Some("a Zemax archive (.zar) in an archive; give the inner one by itself"),
        [b'Z', b'o', b'S', 0, ..] => {
            Some("a binary file of OpticStudio (.zos), which is not read: save it there as Zemax text (.zmx)")
        }
        _ if is_zip(bytes) => Some(
            "a zip archive of files: give one of its lenses, as ARCHIVE.zip/LENS; `realistic lenses ARCHIVE.zip` lists them",
        ),
        [0x1F, 0x8B, ..] => Some("a gzip archive, which is not read: unpack it and give the lens file in it"),
        _ if bytes.starts_with(POINTER) => Some(
            "a Git LFS pointer: the lens file itself was not downloaded; run \"git lfs pull\" where it comes from",
        ),
        _ => None,
    }
}

/// Recognises a text written for another program.
fn foreign(text: &[u8]) -> Option<String> {
    let what = match text {
        _ if is_toml(text) => "TOML without the tables [lens] and [[surface]] of Physical Camera",
        [b'<', ..] => "XML, and no lens is read from XML",
        _ => return None,
    };
    Some(format!("{what}; {READ}"))
}

/// Returns the lines of a text that contain more than a comment. A comment begins with any of the characters
/// `comments`.
fn statements<'t>(text: &'t [u8], comments: &'static [u8]) -> impl Iterator<Item = &'t [u8]> {
    let lines = text.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
    lines.filter(move |line| line.first().is_some_and(|first| !comments.contains(first)))
}

/// Returns whether a text begins with the heading of a TOML table, `[lens]` or `[[surface]]`, or with `key = value`.
fn is_toml(text: &[u8]) -> bool {
    let Some(line) = statements(text, b"#").next() else { return false };
    let is_key = |key: &[u8]| {
        key.first().is_some_and(u8::is_ascii_alphabetic)
            && key.iter().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.'))
    };
    let bare = |line: &[u8]| -> Option<Vec<u8>> {
        let inner = line.strip_prefix(b"[")?.split(|byte| *byte == b']').next()?;
        Some(inner.strip_prefix(b"[").unwrap_or(inner).trim_ascii().to_owned())
    };
    let key = line.iter().position(|byte| *byte == b'=').map(|end| line[..end].trim_ascii());
    bare(line).is_some_and(|key| is_key(&key)) || key.is_some_and(is_key)
}

/// Number of leading lines that are searched for a command of another program, not counting empty lines and comments. A
/// title and similar lines may precede the command.
const BEGINNING: usize = 20;

/// Recognises a text of Code V or OSLO by the commands at its beginning. Comments of either program and of tables are
/// ignored.
fn by_commands(text: &[u8]) -> Option<Format> {
    statements(text, b"!#").take(BEGINNING).find_map(|line| {
        let line = line.to_ascii_uppercase();
        let mut words = line.split(|byte| byte.is_ascii_whitespace() || *byte == b';');
        match (words.next()?, words.next()) {
            (b"//", Some(b"OSLO")) | (b"LEN", Some(b"NEW")) => Some(Format::Oslo),
            (
                b"RDM" | b"LEN" | b"TIT" | b"TITLE" | b"INI" | b"DIM" | b"EPD" | b"FNO" | b"NAO" | b"WL"
                | b"WTW" | b"REF" | b"XAN" | b"YAN" | b"XIM" | b"YIM" | b"XOB" | b"YOB" | b"SO" | b"SI",
                _,
            ) => Some(Format::CodeV),
            _ => None,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::Format;
    use crate::prescription::read;

    #[test]
    fn files_of_other_programs_are_told_by_how_they_begin() {
        for (text, what) in [
            (&b" {\"surfaces\": []}"[..], "JSON"),
            (b"[ [20, 5, 1.5]]", "JSON"),
            (b"[[20, 5, 1.5]]", "JSON"),
            (b"[lens]\nname = \"doublet\"\n\n[[surfaces]]\nradius = 50.0\n", "TOML"),
            (b"# a lens\n[[surface]] # front\nradius = 50.0\n", "TOML"),
            (b"name = \"doublet\"\n[[surface]]\n", "TOML"),
            (b"<?xml version=\"1.0\"?>", "XML"),
        ] {
            let error = read("other", text).expect_err(what).to_string();
            assert!(error.contains(what) && error.contains("FlareSim"), "{error}");
        }
        // A comment or stop row that begins with the letters of a command is not a command.
        for text in ["# SO it is\n20 5 1.5 10\n-20 30 1 10", "stop 3 1 8\n20 5 1.5 10\n-20 30 1 10"] {
            assert!(read("own", text.as_bytes()).is_ok(), "{text}");
        }
    }

    #[test]
    fn sequences_are_told_by_a_command_at_the_beginning() {
        let of = |text: &str| Format::of(text.as_bytes());
        for text in [
            "RDM;LEN\nTITLE 'x'\n",
            "! a comment\nLEN\nS 20 5 NBK7\n",
            "tit 'a singlet'\ndim m\nso 0 1e10\n",
            "! exported\nINI \"A\"\nRDM;LEN\nDIM M\nEPD 5\n",
            "# by hand\n'a title'\nepd 5\nso 0 1e10\n",
        ] {
            assert_eq!(of(text), Format::CodeV, "{text}");
        }
        for text in ["// OSLO 6.1\nLEN NEW \"x\" 50 3\n", "! from a colleague\nLEN NEW \"x\" 50 3\n"] {
            assert_eq!(of(text), Format::Oslo, "{text}");
        }
    }

    #[test]
    fn a_zos_file_that_is_text_in_utf_16_is_a_zemax_lens() {
        let text = "VERS 200831 258\r\nMODE SEQ\r\nFLOA\r\nSURF 0\r\n  DISZ INFINITY\r\nSURF 1\r\n  STOP\r\n  CURV 0.02\r\n\
            DISZ 4\r\n  GLAS N-BK7 0 0\r\n  DIAM 5 1\r\nSURF 2\r\n  CURV -0.02\r\n  DISZ 48\r\n  DIAM 5 1\r\nSURF 3\r\n";
        let plain = read("lens.zmx", text.as_bytes()).expect("a lens");
        let units = || std::iter::once(0xFEFF).chain(text.encode_utf16());
        for bytes in [
            units().flat_map(u16::to_le_bytes).collect::<Vec<u8>>(),
            units().flat_map(u16::to_be_bytes).collect(),
        ] {
            let lens = read("lens.zos", &bytes).expect("a lens");
            assert_eq!((lens.interfaces, lens.glasses), (plain.interfaces.clone(), plain.glasses.clone()));
        }
    }

    #[test]
    fn files_that_are_no_text_are_told_by_their_first_bytes() {
        for (bytes, what) in [
            (
                &b"\xEC\x03\0\0\0\0\0\0\x01\0\0\0\x01\0\0\0\xAB\x0B\0\0\0\0\0\0"[..],
                "the Zemax archive is damaged: the header of member 1",
            ),
            (b"\xEA\0\0\0\nSURF 0\n", "the Zemax archive is damaged: the header of member 1"),
            (b"ZoS\0\x01\0\0\0\x01\0\0\0", "a binary file of OpticStudio (.zos)"),
            (b"PK\x03\x04", "a zip archive of files: give one of its lenses"),
            (b"\x1F\x8B\x08", "a gzip archive"),
            (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 5529\n", "a Git LFS pointer"),
        ] {
            let error = read("other", bytes).expect_err(what).to_string();
            assert!(error.starts_with(&format!("other:1:1: {what}")), "{error}");
        }
    }
}

/// Checks shared by the tests of every reader: that a text is a lens, or that it is refused with the message that the
/// user reads.
#[cfg(test)]
mod checks {
    use crate::prescription::{Prescription, read};

    /// The file name in all tests. The format is recognised by the text and not by this name.
    pub const FILE: &str = "lens.dat";

    #[track_caller]
    pub fn ok(text: &(impl AsRef<[u8]> + ?Sized)) -> Prescription {
        read(FILE, text.as_ref()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Returns a text with the first `from`, which it contains, replaced.
    #[track_caller]
    pub fn replaced(text: &str, from: &str, to: &str) -> String {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    }

    /// Checks that the text is refused at `line:column`, with a message that contains all of `parts`.
    #[track_caller]
    pub fn refused(text: &(impl AsRef<[u8]> + ?Sized), at: &str, parts: &[&str]) {
        let message = read(FILE, text.as_ref()).expect_err("refused").to_string();
        assert!(message.starts_with(&format!("{FILE}:{at}: ")), "{message}");
        for part in parts {
            assert!(message.contains(part), "{message} lacks {part:?}");
        }
    }
}
