//! Zemax archives (.zar): a lens with the files that its program needs for it. The lens is the member `.zmx` or `.zos`.
//! Its glasses are looked up in the catalogues (`.agf`) of the archive too, and its coatings in the coating file that
//! the lens names. Other members are left out, and reported by name.
//!
//! Members follow each other without a table of contents. Each begins with a header, which states the name of the
//! member, its packed size and, in the present form, its unpacked size. Members whose names end in `.LZW` are packed
//! (`lzw`). A member is unpacked only if it is used, and only up to the limit of its kind.

mod lzw;

use super::{
    Format, agf::Catalogue, finished, ledger::Ledger, text, text::Location, text::Text, zemax,
    zemax::CoatingFile,
};
use crate::prescription::{
    Fate, LensFileError, MAX_ARCHIVE_BYTES, MAX_CATALOG_BYTES, MAX_CATALOG_GLASSES, MAX_CATALOGS,
    MAX_FILE_BYTES, glass::GlassLibrary, interfaces::Prescription,
};
use lzw::{Fault, Restart};
use realistic_base::message::cut;

/// Maximum number of members of an archive. Real archives have about ten.
const MAX_MEMBERS: usize = 1000;

/// The end of the names of packed members.
const PACKED: &str = ".LZW";

/// Returns whether bytes begin as an archive does.
pub fn is_archive(bytes: &[u8]) -> bool {
    Header::of(bytes).is_some()
}

/// Reads the lens of an archive; `file` is the name of the archive in messages.
///
/// # Errors
/// The archive is damaged or has no lens, or its lens cannot be read. Errors in the archive give the byte at which they
/// occur as a column of the first line; errors in a member give the location in the member.
pub(super) fn read(file: &str, bytes: &[u8], library: &GlassLibrary) -> Result<Prescription, LensFileError> {
    let archive = Archive::of(file, bytes)?;
    let member = archive.lens()?;
    let lens_file = archive.name_of(member);
    let bytes = archive.unpacked(member, MAX_FILE_BYTES)?.ok_or_else(|| {
        let message = format!("has more than {MAX_FILE_BYTES} bytes (1 MiB), which is the most for a lens");
        archive.error(member, member.offset, &message)
    })?;
    let bytes = text::decoded(&bytes);
    let text = Text::new(&lens_file, &bytes);
    let start = Location { line: 1, column: 1 };
    match Format::of(&bytes) {
        Format::Zemax => {}
        Format::Foreign(message) => return Err(text.error(start, message)),
        _ => return Err(text.error(start, "no Zemax lens: it has no line SURF n")),
    }
    let mut ledger = Ledger::of(&text).of_member(&member.name);
    let library = library.with_archived(archive.catalogues(&mut ledger)?);
    let coating_member = archive.coating_member(&text, &mut ledger);
    let coatings = coating_member.map(|member| archive.coatings(member)).transpose()?;
    let lens = zemax::read(&text, &library, coatings.as_ref(), &mut ledger)?;
    for other in &archive.members {
        let fate = if std::ptr::eq(other, member) {
            (Fate::Used, "")
        } else if coating_member.is_some_and(|coatings| std::ptr::eq(coatings, other)) {
            match coatings.as_ref().is_some_and(CoatingFile::is_used) {
                true => (Fate::Used, ""),
                false => (Fate::LeftOut, "no surface has one of its coatings"),
            }
        } else if other.is_a("agf") {
            let own = archive.name_of(other);
            match library.archived().iter().find(|catalogue| catalogue.file() == own) {
                Some(catalogue) if catalogue.is_used() => (Fate::Used, ""),
                Some(_) => (Fate::LeftOut, "the lens has none of its glasses"),
                // Reported when it was left out.
                None => continue,
            }
        } else {
            (Fate::LeftOut, other.reason_of_no_use())
        };
        ledger.note_of_file(fate.0, &other.name, fate.1);
    }
    Ok(finished(lens, ledger, &library))
}

/// The form of a member's header.
struct Header {
    /// The size of the header, in bytes.
    size: usize,
    /// The position of the packed size, and the number of its bytes.
    packed: [usize; 2],
    /// The position of the unpacked size, 8 bytes, if the header states it.
    unpacked: Option<usize>,
    /// The position of the name, which ends with a zero or with the header.
    name: usize,
    /// The number of bytes of a character of the name.
    character: usize,
}

/// The header of archives since about 2010.
const PRESENT: Header =
    Header { size: 0x288, packed: [0x10, 8], unpacked: Some(0x18), name: 0x30, character: 2 };
/// The header of older archives.
const OLD: Header = Header { size: 0x14C, packed: [0x0C, 4], unpacked: None, name: 0x20, character: 1 };

impl Header {
    /// Returns the form of the header with which bytes begin. A header begins with its version.
    fn of(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0xEC, 0x03, ..] => Some(PRESENT),
            [0xEA, 0x00 | 0x03, ..] => Some(OLD),
            _ => None,
        }
    }

    /// Returns the number at a position of a header, lowest byte first.
    fn number(header: &[u8], start: usize, length: usize) -> u64 {
        header[start..start + length].iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
    }

    /// Returns the name of the member, without its directories and control characters.
    fn name(&self, header: &[u8]) -> String {
        let units = header[self.name..].chunks_exact(self.character);
        let units =
            units.map(|unit| Self::number(unit, 0, self.character) as u16).take_while(|unit| *unit != 0);
        let name = String::from_utf16_lossy(&units.collect::<Vec<u16>>());
        let own = name.rsplit(['/', '\\']).next().unwrap_or(&name);
        own.chars().filter(|character| !character.is_control()).collect()
    }
}

/// A member of an archive.
struct Member<'a> {
    /// The name of the file that was packed, without directories and without the end for packed members.
    name: String,
    /// The position of the header in the archive.
    offset: usize,
    /// The position of the bytes behind the header.
    start: usize,
    bytes: &'a [u8],
    is_packed: bool,
    /// The unpacked size that the header states.
    stated: Option<u64>,
}

impl Member<'_> {
    /// Returns whether the name has one of these ends, in any case.
    fn is_a(&self, end: &str) -> bool {
        self.name.rsplit_once('.').is_some_and(|(_, own)| own.eq_ignore_ascii_case(end))
    }

    /// Returns the reason why a member that is neither a lens nor a catalogue is left out.
    fn reason_of_no_use(&self) -> &'static str {
        const KINDS: [(&[&str], &str); 4] = [
            (&["ses", "zda", "cfg"], "settings of the file's program and of its displays"),
            (&["zec"], "coatings that only the file's program can decrypt"),
            (&["uda"], "the outline of an aperture, whose vertices the lens's own lines hold"),
            (&["bmp", "jpg", "jpeg", "png", "ima", "bim"], "a picture"),
        ];
        let of_kind = |(ends, _): &&(&[&str], &str)| ends.iter().any(|end| self.is_a(end));
        KINDS.iter().find(of_kind).map_or("a kind of file that is not read", |(_, reason)| reason)
    }
}

/// The members of an archive.
struct Archive<'a> {
    file: &'a str,
    members: Vec<Member<'a>>,
}

impl<'a> Archive<'a> {
    /// Finds the members.
    ///
    /// # Errors
    /// The archive is too large, has too many members, or is damaged.
    fn of(file: &'a str, bytes: &'a [u8]) -> Result<Self, LensFileError> {
        let mut archive = Self { file, members: Vec::new() };
        if bytes.len() as u64 > MAX_ARCHIVE_BYTES {
            let message = format!(
                "the archive goes on here; an archive has at most {MAX_ARCHIVE_BYTES} bytes (16 MiB)"
            );
            return Err(archive.error_at(MAX_ARCHIVE_BYTES as usize, message));
        }
        let mut at = 0;
        while at < bytes.len() {
            let member = archive.member(bytes, at)?;
            at = member.start + member.bytes.len();
            archive.members.push(member);
            if archive.members.len() > MAX_MEMBERS {
                return Err(archive.error_at(at, format!("an archive has at most {MAX_MEMBERS} members")));
            }
        }
        Ok(archive)
    }

    /// Returns the member whose header begins at a byte.
    fn member(&self, bytes: &'a [u8], offset: usize) -> Result<Member<'a>, LensFileError> {
        let number = self.members.len() + 1;
        let damaged = |what: String| self.error_at(offset, format!("the Zemax archive is damaged: {what}"));
        let form = Header::of(&bytes[offset..])
            .ok_or_else(|| damaged(format!("expected the header of member {number} at byte {offset}")))?;
        let start = offset + form.size;
        let Some(header) = bytes.get(offset..start) else {
            return Err(damaged(format!("the header of member {number} at byte {offset} is cut off")));
        };
        let name = form.name(header);
        if name.is_empty() {
            return Err(damaged(format!("member {number} at byte {offset} has no name")));
        }
        let [position, length] = form.packed;
        let size = Header::number(header, position, length);
        let rest = &bytes[start..];
        let own = usize::try_from(size).ok().and_then(|size| rest.get(..size)).ok_or_else(|| {
            damaged(format!(
                "member {} at byte {offset} has {size} bytes by its header, and {} follow",
                cut(&name),
                rest.len()
            ))
        })?;
        let end = name.len().checked_sub(PACKED.len()).filter(|end| name.is_char_boundary(*end));
        let packed_name = end.filter(|end| name[*end..].eq_ignore_ascii_case(PACKED));
        Ok(Member {
            name: packed_name.map_or(name.as_str(), |end| &name[..end]).to_owned(),
            offset,
            start,
            bytes: own,
            is_packed: packed_name.is_some(),
            stated: form.unpacked.map(|position| Header::number(header, position, 8)),
        })
    }

    /// Returns an error at a byte of the archive, shown as a column of the first line.
    fn error_at(&self, offset: usize, message: String) -> LensFileError {
        LensFileError { file: self.file.to_owned(), line: 1, column: offset + 1, message }
    }

    /// Returns an error about a member at a byte of the archive.
    fn error(&self, member: &Member<'_>, offset: usize, message: &str) -> LensFileError {
        let name = cut(&member.name);
        self.error_at(offset, format!("member {name} at byte {} of the archive {message}", member.offset))
    }

    /// Returns the name of a member in messages.
    fn name_of(&self, member: &Member<'_>) -> String {
        format!("{}/{}", self.file, cut(&member.name))
    }

    /// Returns the member with the lens.
    ///
    /// # Errors
    /// There is no such member, or more than one.
    fn lens(&self) -> Result<&Member<'a>, LensFileError> {
        let mut lenses = self.members.iter().filter(|member| member.is_a("zmx") || member.is_a("zos"));
        let Some(lens) = lenses.next() else {
            return Err(self.error_at(0, "the Zemax archive has no lens (.zmx)".to_owned()));
        };
        match lenses.next() {
            Some(other) => {
                let [first, second] = [lens, other].map(|member| cut(&member.name));
                let message = format!(
                    "the Zemax archive has two lenses, {first} and {second}: unpack it and give one of them"
                );
                Err(self.error_at(other.offset, message))
            }
            None => Ok(lens),
        }
    }

    /// Returns the bytes of the file that a member packs; `None` if it has more than `most` bytes.
    ///
    /// # Errors
    /// The member is damaged.
    fn unpacked(&self, member: &Member<'_>, most: u64) -> Result<Option<Vec<u8>>, LensFileError> {
        let stated = member.stated.filter(|_| member.is_packed).unwrap_or(0);
        if stated.max(if member.is_packed { 0 } else { member.bytes.len() as u64 }) > most {
            return Ok(None);
        }
        if !member.is_packed {
            return Ok(Some(member.bytes.to_vec()));
        }
        let limit = member.stated.unwrap_or(most) as usize;
        let unpacked = lzw::unpack(member.bytes, limit, Restart::Fresh);
        if lzw::restarts(member.bytes) {
            return self.unpacked_across_restarts(member, unpacked).map(Some);
        }
        match unpacked {
            Err(Fault::TooLong) if member.stated.is_none() => Ok(None),
            Err(fault) => Err(self.damage(member, fault)),
            Ok(bytes) => self.with_stated_size(member, bytes).map(Some),
        }
    }

    /// Returns the bytes of a member in which the table of strings starts again. The treatment of the string before a
    /// restart is not documented: of the two possible ones, the one that gives the stated size is right.
    fn unpacked_across_restarts(
        &self,
        member: &Member<'_>,
        fresh: Result<Vec<u8>, Fault>,
    ) -> Result<Vec<u8>, LensFileError> {
        let Some(stated) = member.stated else {
            let message = "restarts its table of strings without a stated size; it cannot be checked";
            return Err(self.error(member, member.offset, message));
        };
        let is_right = |bytes: &Vec<u8>| bytes.len() as u64 == stated;
        let continued = lzw::unpack(member.bytes, stated as usize, Restart::Continued);
        match (fresh.as_ref().is_ok_and(is_right), continued.as_ref().is_ok_and(is_right)) {
            (true, true) if fresh != continued => {
                let message = "can be unpacked in two ways, and both have the stated size";
                Err(self.error(member, member.offset, message))
            }
            (false, true) => continued.map_err(|fault| self.damage(member, fault)),
            _ => match fresh {
                Ok(bytes) => self.with_stated_size(member, bytes),
                Err(fault) => Err(self.damage(member, fault)),
            },
        }
    }

    /// Checks that unpacked bytes have the stated size.
    fn with_stated_size(&self, member: &Member<'_>, bytes: Vec<u8>) -> Result<Vec<u8>, LensFileError> {
        match member.stated.filter(|stated| *stated != bytes.len() as u64) {
            None => Ok(bytes),
            Some(stated) => {
                let message = format!("is damaged: it unpacks to {} bytes, not {stated}", bytes.len());
                Err(self.error(member, member.offset, &message))
            }
        }
    }

    fn damage(&self, member: &Member<'_>, fault: Fault) -> LensFileError {
        match fault {
            Fault::TooLong => {
                let stated = member.stated.unwrap_or(0);
                let message = format!("is damaged: it unpacks to more than {stated} bytes");
                self.error(member, member.offset, &message)
            }
            Fault::NoEntry(at) => {
                let at = member.start + at;
                let message = format!("is damaged: the code at byte {at} was not defined before");
                self.error(member, at, &message)
            }
        }
    }

    /// Returns the catalogues of glass, within the limits for catalogues beside a lens file. Catalogues that are left
    /// out are reported.
    ///
    /// # Errors
    /// A catalogue is damaged.
    fn catalogues(&self, ledger: &mut Ledger<'_>) -> Result<Vec<Catalogue>, LensFileError> {
        let mut catalogues: Vec<Catalogue> = Vec::new();
        let (mut bytes_left, mut glasses_left) = (MAX_CATALOG_BYTES, MAX_CATALOG_GLASSES);
        for member in self.members.iter().filter(|member| member.is_a("agf")) {
            let beyond = format!(
                "the catalogues of an archive have at most {MAX_CATALOGS} files, {MAX_CATALOG_BYTES} bytes and \
                 {MAX_CATALOG_GLASSES} glasses together"
            );
            let is_full = catalogues.len() == MAX_CATALOGS || bytes_left == 0;
            let unpacked = if is_full { None } else { self.unpacked(member, bytes_left)? };
            // Whatever was unpacked counts, so that catalogues that are left out do not keep the reader busy.
            bytes_left -= match &unpacked {
                Some(bytes) => bytes.len() as u64,
                None if member.is_packed && member.stated.is_none() => bytes_left,
                None => 0,
            };
            let reason = match unpacked.map(|bytes| Catalogue::new(&self.name_of(member), &bytes)) {
                Some(Ok(catalogue)) if catalogue.len() <= glasses_left => {
                    glasses_left -= catalogue.len();
                    catalogues.push(catalogue);
                    continue;
                }
                Some(Err(error)) => error.message,
                None | Some(Ok(_)) => beyond,
            };
            ledger.warn_of_file(Fate::LeftOut, &member.name, format!("{}: {reason}", cut(&member.name)));
        }
        Ok(catalogues)
    }

    /// Returns the member with the coatings: that which the lens names first in `COFN`, or else COATING.DAT.
    fn coating_member(&self, text: &Text<'_>, ledger: &mut Ledger<'_>) -> Option<&Member<'a>> {
        let named = text.lines().find_map(|(line, text)| {
            let names = text.trim_start().strip_prefix("COFN")?.trim_start();
            ledger.note(Fate::Used, Location { line, column: 1 }, "COFN", None, "");
            match names.split_once('"') {
                Some((_, name)) => name.split('"').next(),
                None => names.split_whitespace().next(),
            }
        });
        let name = named.unwrap_or("COATING.DAT");
        self.members.iter().find(|member| member.name.eq_ignore_ascii_case(name))
    }

    /// Returns the coatings of a member.
    ///
    /// # Errors
    /// The member is damaged or too large.
    fn coatings(&self, member: &Member<'_>) -> Result<CoatingFile, LensFileError> {
        let bytes = self.unpacked(member, MAX_FILE_BYTES)?.ok_or_else(|| {
            let message = format!("has more than {MAX_FILE_BYTES} bytes (1 MiB), the most for coatings");
            self.error(member, member.offset, &message)
        })?;
        Ok(CoatingFile::of(&cut(&member.name), &text::as_str(&text::decoded(&bytes))))
    }
}

#[cfg(test)]
mod tests;
