//! The packing of members: LZW (T. A. Welch, *IEEE Computer* 17, 1984) without codes for clearing and ending.
//!
//! Codes are written from their highest bit on, with 9 bits at first. Codes below 256 are bytes. Each code after the
//! first adds a string to the table: that of the code before it, and the first byte of its own. A code has one bit more
//! as soon as the table has an entry for every code of the present width. At 65,536 entries the table starts again.
//! Bits at the end that are no whole code are padding.

/// The number of codes of single bytes.
const BYTES: usize = 256;
/// The width of the first codes, in bits.
const FIRST_WIDTH: u32 = 9;
/// The number of entries at which the table starts again.
const FULL: usize = 1 << 16;
/// The number of bits of the codes that fill the table: one code of the first width, and then one code for each entry,
/// each with the width of its time.
const BITS_TO_FULL: usize = {
    let (mut bits, mut entries, mut width) = (FIRST_WIDTH as usize, BYTES, FIRST_WIDTH);
    while entries < FULL {
        if entries == 1 << width {
            width += 1;
        }
        bits += width as usize;
        entries += 1;
    }
    bits
};

/// The treatment of the string before a restart of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Restart {
    /// The first code after the restart adds no string, as the first code of all.
    Fresh,
    /// The first code after the restart adds a string.
    Continued,
}

/// The reason why bytes cannot be unpacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// There are more bytes than expected.
    TooLong,
    /// A code has no entry in the table. The code ends at this byte of the packed bytes.
    NoEntry(usize),
}

/// Returns whether the table starts again within packed bytes.
pub(super) fn restarts(packed: &[u8]) -> bool {
    packed.len() * 8 >= BITS_TO_FULL + FIRST_WIDTH as usize
}

/// Unpacks at most `most` bytes. The strings of the table are parts of the unpacked bytes, so that the table's size
/// does not depend on their lengths.
///
/// # Errors
/// There are more bytes, or a code has no entry.
pub(super) fn unpack(packed: &[u8], most: usize, restart: Restart) -> Result<Vec<u8>, Fault> {
    let mut bytes: Vec<u8> = Vec::new();
    // The start in `bytes` and the length of each string from code 256 on.
    let mut strings: Vec<[usize; 2]> = Vec::new();
    let mut before: Option<[usize; 2]> = None;
    let (mut bits, mut count, mut width) = (0_u32, 0, FIRST_WIDTH);
    for (at, &byte) in packed.iter().enumerate() {
        // At most 15 bits are left over from the bytes before.
        (bits, count) = (bits << 8 | u32::from(byte), count + 8);
        if count < width {
            continue;
        }
        count -= width;
        let code = (bits >> count) as usize;
        bits &= (1 << count) - 1;
        let start = bytes.len();
        // The last byte of the new string is the first one that follows now.
        strings.extend(before.map(|[start, length]| [start, length + 1]));
        let [from, length] = match code.checked_sub(BYTES) {
            None => [start, 1],
            Some(entry) => *strings.get(entry).ok_or(Fault::NoEntry(at))?,
        };
        if length > most - start {
            return Err(Fault::TooLong);
        }
        if code < BYTES {
            bytes.push(code as u8);
        } else {
            // A string may extend into the bytes that it is copied to.
            (from..from + length).for_each(|i| bytes.push(bytes[i]));
        }
        before = Some([start, length]);
        if strings.len() == FULL - BYTES {
            strings.clear();
            width = FIRST_WIDTH;
            before = before.filter(|_| restart == Restart::Continued);
        } else if strings.len() + BYTES == 1 << width {
            width += 1;
        }
    }
    Ok(bytes)
}

/// A packer for tests.
#[cfg(test)]
pub(super) mod packing {
    use super::{BYTES, FIRST_WIDTH, FULL, Restart};
    use std::collections::HashMap;

    /// Packs bytes. The packer mirrors the unpacker, whose table is one string behind that of the packer.
    pub(in super::super) fn pack(bytes: &[u8], restart: Restart) -> Vec<u8> {
        let mut table: HashMap<(Option<usize>, u8), usize> = HashMap::new();
        let (mut packed, mut bits, mut count) = (Vec::new(), 0_u64, 0);
        // The number of entries that the unpacker has, and the string that it adds next.
        let (mut entries, mut pending) = (BYTES, None);
        let mut at = 0;
        while at < bytes.len() {
            let first = bytes[at];
            if let Some(before) = pending {
                // A string that the table has already gets a second entry, as in the unpacker.
                table.insert((Some(before), first), entries);
                entries += 1;
            }
            let width = width_before(entries, pending.is_some());
            let mut code = usize::from(first);
            at += 1;
            while let Some(&longer) = bytes.get(at).and_then(|byte| table.get(&(Some(code), *byte))) {
                code = longer;
                at += 1;
            }
            (bits, count) = (bits << width | code as u64, count + width);
            while count >= 8 {
                count -= 8;
                packed.push((bits >> count) as u8);
                bits &= (1 << count) - 1;
            }
            pending = Some(code);
            if entries == FULL {
                table.clear();
                entries = BYTES;
                pending = pending.filter(|_| restart == Restart::Continued);
            }
        }
        if count > 0 {
            packed.push((bits << (8 - count)) as u8);
        }
        packed
    }

    /// Returns the width of a code that the unpacker reads before it adds the newest of `entries`.
    fn width_before(entries: usize, adds: bool) -> u32 {
        let known = entries - usize::from(adds);
        (FIRST_WIDTH..).find(|width| known < 1 << width).unwrap_or(FIRST_WIDTH)
    }
}

#[cfg(test)]
mod tests {
    use super::{packing::pack, *};

    /// Returns bytes of a linear congruential generator, 7 bits of each: they hardly repeat, and fill the table soon.
    fn noise(count: usize) -> Vec<u8> {
        let mut state = 1_u32;
        let next = |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 25) as u8
        };
        (0..count).map(next).collect()
    }

    #[test]
    fn packed_bytes_unpack_at_every_width_and_across_restarts() {
        for count in [0, 1, 2, 3, 255, 256, 257, 300, 1000, 5000, 40_000, 130_000, 300_000] {
            for bytes in [noise(count), vec![7; count], b"CURV 0.05\r\n".repeat(count / 11)] {
                for restart in [Restart::Fresh, Restart::Continued] {
                    let packed = pack(&bytes, restart);
                    assert_eq!(unpack(&packed, bytes.len(), restart).as_deref(), Ok(&bytes[..]), "{count}");
                    if !bytes.is_empty() {
                        assert_eq!(unpack(&packed, bytes.len() - 1, restart), Err(Fault::TooLong));
                    }
                }
            }
        }
        // The longest of them restarts more than once; the two kinds of restart differ.
        let packed = pack(&noise(300_000), Restart::Fresh);
        assert!(restarts(&packed) && packed.len() * 8 > 2 * BITS_TO_FULL);
        assert_ne!(unpack(&packed, 400_000, Restart::Continued).as_deref(), Ok(&noise(300_000)[..]));
    }

    #[test]
    fn the_restart_is_where_the_table_is_full() {
        assert_eq!(BITS_TO_FULL, 981_257);
        let packed = pack(&noise(300_000), Restart::Fresh);
        let differ = |length: usize| {
            let read = |restart| unpack(&packed[..length], 400_000, restart);
            read(Restart::Fresh) != read(Restart::Continued)
        };
        assert!(!restarts(&packed[..122_657]) && !differ(122_657));
        assert!(restarts(&packed[..122_659]) && differ(130_000));
    }

    #[test]
    fn a_code_without_an_entry_is_refused_where_it_stands() {
        // Codes 65 and 256, which is then the newest string, and 300, which no code has added.
        let codes = [65_u64, 256, 300].iter().fold(0, |bits, code| bits << 9 | code) << 5;
        let packed = &codes.to_be_bytes()[4..];
        assert_eq!(unpack(&packed[..3], 99, Restart::Fresh).as_deref(), Ok(&b"AAA"[..]));
        assert_eq!(unpack(packed, 99, Restart::Fresh), Err(Fault::NoEntry(3)));
        // The first code is a byte.
        assert_eq!(unpack(&[0xFF, 0xFF], 99, Restart::Fresh), Err(Fault::NoEntry(1)));
    }
}
