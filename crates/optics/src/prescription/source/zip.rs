//! Zip archives, as far as collections of lenses use them: members that are stored or deflated (APPNOTE.TXT of PKWARE,
//! sections 4.3 and 4.4; RFC 1951). Nothing is written to disk, so a member's name is a name and never a path.
//!
//! The list of members is read from the end of the archive. A member is unpacked only if it is read, up to the limit of
//! its kind and never beyond the size that the list states; its packed form may have at most twice that size. The work
//! is therefore bounded whatever an archive contains. Zip64 archives and members that are encrypted, or packed by other
//! methods, are refused.

use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

use flate2::{Crc, read::DeflateDecoder};

use super::place::bounded;
use crate::prescription::MAX_ARCHIVE_BYTES;

/// A zip archive with the list of its members.
#[derive(Debug)]
pub(super) struct Zip {
    file: PathBuf,
    /// The position in the file from which the archive counts; it is not 0 if another file precedes the archive.
    start: u64,
    members: Vec<Member>,
}

/// A file in an archive.
#[derive(Clone, Debug)]
pub(super) struct Member {
    /// The path of the file, with `/` between folders.
    pub(super) name: String,
    /// The unpacked size, in bytes, as the archive states it.
    pub(super) size: u64,
    packed: u64,
    offset: u64,
    method: u16,
    flags: u16,
    crc: u32,
}

/// The signature of the record at the end of the list.
const END: &[u8; 4] = b"PK\x05\x06";
/// The size of that record without its comment.
const END_SIZE: usize = 22;
/// The signature and the size of a member's record in the list, without its name, extra fields and comment.
const LISTED: (&[u8; 4], usize) = (b"PK\x01\x02", 46);
/// The signature and the size of the record before a member's bytes, without its name and extra fields.
const LOCAL: (&[u8; 4], usize) = (b"PK\x03\x04", 30);
/// The value of a size or offset of 4 bytes that only zip64 can state.
const ZIP64: u64 = 0xFFFF_FFFF;
/// Bits of a member's flags that mean encryption.
const ENCRYPTED: u16 = 1 | 1 << 6 | 1 << 13;
/// Packed bytes beyond twice the unpacked size that a small member may have.
const SPARE: u64 = 1024;

/// Returns whether bytes begin as a zip archive does.
pub(in crate::prescription) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(LOCAL.0) || bytes.starts_with(END)
}

impl Zip {
    /// Returns whether a file begins as a zip archive does.
    pub(super) fn is_at(file: &Path) -> bool {
        let start = File::open(file).and_then(|file| bounded(file, 3));
        start.is_ok_and(|start| is_zip(&start))
    }

    /// Reads the list of an archive's members.
    ///
    /// # Errors
    /// The file cannot be read, or is not an archive that is supported. The text completes the sentence "the archive …".
    pub(super) fn open(file: &Path) -> Result<Self, String> {
        let damaged = |what: &str| format!("is damaged: {what}; copy or pack it again");
        let unreadable = |error| format!("cannot be read: {error}");
        let mut opened = File::open(file).map_err(unreadable)?;
        let length = opened.metadata().map_err(unreadable)?.len();
        // The comment at the end has at most 65,535 bytes.
        let from = length.saturating_sub(END_SIZE as u64 + 0xFFFF);
        let tail = read_at(&mut opened, from, length - from).map_err(unreadable)?;
        let is_end = |at: &usize| tail[*at..].starts_with(END);
        let last = tail.len().checked_sub(END_SIZE).and_then(|last| (0..=last).rev().find(is_end));
        let at = last.ok_or_else(|| damaged("its list of members is missing at the end"))?;
        let end = &tail[at..];
        let [count, size, offset] = [number(end, 10, 2), number(end, 12, 4), number(end, 16, 4)];
        if count == 0xFFFF || size == ZIP64 || offset == ZIP64 {
            return Err(
                "is a zip64 archive, which is not read: pack it in parts of less than 4 GiB and 65,535 files"
                    .to_owned(),
            );
        }
        if number(end, 4, 4) != 0 {
            return Err("is a part of an archive in several files: pack it as one".to_owned());
        }
        if size > MAX_ARCHIVE_BYTES {
            return Err(format!(
                "has a list of members of more than {MAX_ARCHIVE_BYTES} bytes (16 MiB): pack it in parts"
            ));
        }
        let list = (from + at as u64).checked_sub(size);
        let (list, start) = list
            .and_then(|list| Some((list, list.checked_sub(offset)?)))
            .ok_or_else(|| damaged("its list of members begins before the file"))?;
        let list = read_at(&mut opened, list, size).map_err(unreadable)?;
        let members = members(&list).ok_or_else(|| damaged("its list of members is cut off"))?;
        Ok(Self { file: file.to_owned(), start, members })
    }

    /// Returns the path of the archive.
    pub(super) fn file(&self) -> &Path {
        &self.file
    }

    /// Returns the files in the archive, in its own order.
    pub(super) fn members(&self) -> &[Member] {
        &self.members
    }

    /// Unpacks a member, up to one byte more than `most`.
    ///
    /// # Errors
    /// The member cannot be unpacked. The text completes the sentence "the member …".
    pub(super) fn bytes(&self, member: &Member, most: u64) -> Result<Vec<u8>, String> {
        let Member { size, packed, offset, method, flags, crc, .. } = *member;
        let damaged = |what: &str| Err(format!("is damaged in its archive: {what}; copy or pack it again"));
        if flags & ENCRYPTED != 0 {
            return Err("is encrypted, and is not read: unpack the archive with its password".to_owned());
        }
        if [size, packed, offset].contains(&ZIP64) {
            return Err("is a member of the kind zip64, which is not read: unpack the archive".to_owned());
        }
        if !matches!(method, 0 | 8) {
            return Err(format!(
                "is packed by method {method}; read are members that are stored or deflated"
            ));
        }
        if packed > 2 * size + SPARE {
            return damaged(&format!("{packed} packed bytes for {size}"));
        }
        let unpack = || -> std::io::Result<Option<Vec<u8>>> {
            let mut file = File::open(&self.file)?;
            let header = read_at(&mut file, self.start + offset, LOCAL.1 as u64)?;
            if header.len() < LOCAL.1 || !header.starts_with(LOCAL.0) {
                return Ok(None);
            }
            file.seek(SeekFrom::Current((number(&header, 26, 2) + number(&header, 28, 2)) as i64))?;
            let source = file.take(packed);
            match method {
                0 => bounded(source, most.min(size)),
                _ => bounded(DeflateDecoder::new(source), most.min(size)),
            }
            .map(Some)
        };
        let bytes = match unpack() {
            Ok(Some(bytes)) => bytes,
            Ok(None) => return damaged("its bytes do not begin where the list says"),
            Err(error) => return damaged(&error.to_string()),
        };
        if bytes.len() as u64 > most && size > most {
            return Ok(bytes);
        }
        if bytes.len() as u64 != size {
            return damaged(&format!("it does not unpack to the stated {size} bytes"));
        }
        let mut sum = Crc::new();
        sum.update(&bytes);
        if sum.sum() == crc { Ok(bytes) } else { damaged("its checksum is wrong") }
    }
}

/// Returns the files of a list of members, without folders; `None` if a record is cut off.
fn members(mut list: &[u8]) -> Option<Vec<Member>> {
    let mut members = Vec::new();
    while !list.is_empty() {
        let record = list.get(..LISTED.1).filter(|record| record.starts_with(LISTED.0))?;
        let [name, extra, comment] = [28, 30, 32].map(|at| number(record, at, 2) as usize);
        let own = list.get(LISTED.1..LISTED.1 + name)?;
        // Some programs for Windows write backslashes.
        let name_of = String::from_utf8_lossy(own).replace('\\', "/");
        if !name_of.ends_with('/') {
            members.push(Member {
                name: name_of,
                size: number(record, 24, 4),
                packed: number(record, 20, 4),
                offset: number(record, 42, 4),
                method: number(record, 10, 2) as u16,
                flags: number(record, 8, 2) as u16,
                crc: number(record, 16, 4) as u32,
            });
        }
        list = list.get(LISTED.1 + name + extra + comment..)?;
    }
    Some(members)
}

/// Returns the number of `length` bytes at a position, lowest byte first.
fn number(bytes: &[u8], at: usize, length: usize) -> u64 {
    bytes[at..at + length].iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
}

/// Reads bytes at a position of a file, as many as are there.
fn read_at(file: &mut File, at: u64, length: u64) -> std::io::Result<Vec<u8>> {
    file.seek(SeekFrom::Start(at))?;
    let mut bytes = Vec::new();
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
pub(super) mod tests {
    use std::io::Write;

    use flate2::{Compression, write::DeflateEncoder};

    use super::*;

    /// Returns an archive of deflated members, as other programs write it.
    pub(in crate::prescription::source) fn packed(members: &[(&str, &[u8])]) -> Vec<u8> {
        let (mut archive, mut list) = (Vec::new(), Vec::new());
        for (name, bytes) in members {
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(bytes).expect("written");
            let body = encoder.finish().expect("packed");
            let mut sum = Crc::new();
            sum.update(bytes);
            let offset = (archive.len() as u32).to_le_bytes();
            let mut common = [20, 0, 0, 0, 8, 0, 0, 0, 0, 0].to_vec();
            for size in [sum.sum(), body.len() as u32, bytes.len() as u32] {
                common.extend(size.to_le_bytes());
            }
            common.extend((name.len() as u32).to_le_bytes());
            archive.extend([&LOCAL.0[..], &common, name.as_bytes(), &body].concat());
            list.extend([&LISTED.0[..], &[20, 0], &common, &[0; 10], &offset, name.as_bytes()].concat());
        }
        let [size, offset] = [list.len(), archive.len()].map(|number| (number as u32).to_le_bytes());
        let count = (members.len() as u16).to_le_bytes();
        [&archive, &list, &END[..], &[0; 4], &count, &count, &size, &offset, &[0; 2]].concat()
    }

    fn opened(bytes: &[u8]) -> (tempfile::TempDir, Result<Zip, String>) {
        let folder = tempfile::tempdir().expect("a temporary directory");
        let file = folder.path().join("a.zip");
        std::fs::write(&file, bytes).expect("written");
        let zip = Zip::open(&file);
        (folder, zip)
    }

    /// Returns the outcome of reading the first member of an archive.
    fn first(bytes: &[u8]) -> Result<Vec<u8>, String> {
        let (_folder, zip) = opened(bytes);
        let zip = zip?;
        zip.bytes(&zip.members()[0], 100)
    }

    #[test]
    fn members_are_unpacked_up_to_the_limit_of_their_kind() {
        let archive = packed(&[("a/b.txt", b"text"), ("a/", b""), ("c\\d", &[7; 1000])]);
        // A program before the archive and a comment behind it.
        for bytes in [archive.clone(), [&[0; 99], &archive[..]].concat(), commented(&archive)] {
            let (_folder, zip) = opened(&bytes);
            let zip = zip.expect("an archive");
            let names: Vec<_> =
                zip.members().iter().map(|member| (member.name.as_str(), member.size)).collect();
            assert_eq!(names, [("a/b.txt", 4), ("c/d", 1000)]);
            assert_eq!(zip.bytes(&zip.members()[0], 100).expect("unpacked"), b"text");
            assert_eq!(zip.bytes(&zip.members()[1], 1000).expect("unpacked"), [7; 1000]);
            assert_eq!(
                zip.bytes(&zip.members()[1], 999).expect("unpacked"),
                [7; 1000],
                "one more than the most"
            );
            assert_eq!(zip.bytes(&zip.members()[1], 10).expect("unpacked").len(), 11);
        }
        assert!(is_zip(&archive) && is_zip(&packed(&[])) && !is_zip(b"PK"));
        assert!(opened(&packed(&[])).1.expect("an archive").members().is_empty());
    }

    fn commented(archive: &[u8]) -> Vec<u8> {
        let end = archive.len() - 2;
        [&archive[..end], &[3, 0], b"abc"].concat()
    }

    #[test]
    fn other_members_and_archives_are_refused_by_their_kind() {
        let archive = packed(&[("a", b"some text of some length")]);
        let list = archive.windows(4).position(|four| four == LISTED.0).expect("a list");
        let end = archive.len() - END_SIZE;
        let with = |at: usize, bytes: &[u8]| {
            let mut archive = archive.clone();
            archive[at..at + bytes.len()].copy_from_slice(bytes);
            first(&archive).expect_err("refused")
        };
        for (at, bytes, words) in [
            (list + 8, &[1, 0][..], "is encrypted"),
            (list + 10, &[14, 0], "is packed by method 14"),
            (list + 20, &[0xFF; 4], "of the kind zip64"),
            (list + 20, &[0, 0, 1, 0], "65536 packed bytes for 24"),
            (list + 24, &[23, 0], "does not unpack to the stated 23 bytes"),
            (list + 24, &[25, 0], "does not unpack to the stated 25 bytes"),
            (list + 16, &[0; 4], "its checksum is wrong"),
            (list + 42, &[1, 0], "do not begin where the list says"),
            (LOCAL.1 + 1, &[0xFF; 4], "is damaged in its archive"),
            (list, &[0], "its list of members is cut off"),
            (end + 10, &[0xFF; 2], "is a zip64 archive"),
            (end + 4, &[1, 0], "archive in several files"),
            (end + 12, &[0, 0, 0, 2], "more than 16777216 bytes"),
            (end + 12, &[0, 0, 1, 0], "begins before the file"),
            (end + 16, &[0, 0, 1, 0], "begins before the file"),
            (end, &[0], "is missing at the end"),
        ] {
            let message = with(at, bytes);
            assert!(message.contains(words), "{message} lacks {words}");
        }
        // An archive that is cut anywhere, or has any wrong byte, is an archive or an error.
        for at in 0..archive.len() {
            let _ = first(&archive[..at]);
            for byte in [0, 0xFF] {
                let mut archive = archive.clone();
                archive[at] = byte;
                let _ =
                    opened(&archive).1.map(|zip| zip.members().first().map(|member| zip.bytes(member, 100)));
            }
        }
    }

    #[test]
    fn a_bomb_is_unpacked_up_to_its_stated_size() {
        let bomb = packed(&[("bomb", &vec![0; 10_000_000])]);
        let list = bomb.windows(4).position(|four| four == LISTED.0).expect("a list");
        assert_eq!(first(&bomb).expect("unpacked").len(), 101, "no more than the limit of the kind");
        let mut small = bomb.clone();
        small[list + 24..list + 28].copy_from_slice(&9000_u32.to_le_bytes());
        let (_folder, zip) = opened(&small);
        let zip = zip.expect("an archive");
        let message = zip.bytes(&zip.members()[0], 1 << 20).expect_err("a bomb");
        assert!(message.contains("does not unpack to the stated 9000 bytes"), "{message}");
    }
}
