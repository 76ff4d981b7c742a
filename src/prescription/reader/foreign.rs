//! Files of other programs, which are not read: recognised by their first bytes, so that the answer says what they are and what is
//! read instead of complaining of their first number.

/// What is read, for whoever has something else.
const READ: &str = "read are a table with a line for each surface (radius, thickness, index and clear diameter in mm: \
                    docs/lens-format.md), Optical Bench text, Zemax text (.zmx) and FlareSim text (.lens); export one of these";

/// That a text, or no text at all, is a file of another program.
pub(super) fn recognised(bytes: &[u8]) -> Option<String> {
    let start = bytes.trim_ascii_start();
    let json = |byte: &u8| matches!(byte, b'{' | b'[' | b'"' | b'-' | b'0'..=b'9');
    // The first bytes of an archive are its version, 0xEA00 or 0xEC03.
    let what = match bytes {
        [0x00, 0xEA, ..] | [0x03, 0xEC, ..] => "a Zemax archive (.zar), and archives are not read",
        [b'P', b'K', 3, 4, ..] => "a zip archive, and archives are not read",
        _ => match start {
            [b'{', ..] => "JSON, and no lens is read from JSON",
            [b'[', rest @ ..] if rest.trim_ascii_start().first().is_some_and(json) => {
                "JSON, and no lens is read from JSON"
            }
            [b'<', ..] => "XML, and no lens is read from XML",
            _ => by_first_command(start)?,
        },
    };
    Some(format!("{what}; {READ}"))
}

/// By the first line that is no comment of theirs.
fn by_first_command(text: &[u8]) -> Option<&'static str> {
    const CODE_V: &str = "a lens of Code V (.seq), which is not read";
    const OSLO: &str = "a lens of OSLO (.len), which is not read";
    let mut lines = text.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
    let line = lines.find(|line| !line.is_empty() && !line.starts_with(b"!"))?.to_ascii_uppercase();
    let mut words = line.split(|byte| byte.is_ascii_whitespace() || *byte == b';');
    match (words.next()?, words.next()) {
        (b"//", Some(b"OSLO")) | (b"LEN", Some(b"NEW")) => Some(OSLO),
        (b"RDM" | b"LEN" | b"TIT" | b"TITLE" | b"DIM" | b"EPD" | b"FNO" | b"WL", _) => Some(CODE_V),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::prescription::read;

    #[test]
    fn files_of_other_programs_are_told_by_how_they_begin() {
        for (text, what) in [
            (&b"RDM;LEN\nTITLE 'x'\n"[..], "Code V"),
            (b"! a comment\nLEN\nS 20 5 NBK7\n", "Code V"),
            (b"tit 'a singlet'\ndim m\nso 0 1e10\n", "Code V"),
            (b"// OSLO 6.1\nLEN NEW \"x\" 50 3\n", "OSLO"),
            (b"LEN NEW \"x\" 50 3\n", "OSLO"),
            (b" {\"surfaces\": []}", "JSON"),
            (b"[ [20, 5, 1.5]]", "JSON"),
            (b"<?xml version=\"1.0\"?>", "XML"),
            (b"\x03\xEC\x00\x00", "Zemax archive"),
            (b"PK\x03\x04", "zip"),
        ] {
            let error = read("other", text).expect_err(what).to_string();
            assert!(error.contains(what) && error.contains("FlareSim"), "{error}");
        }
    }
}
