use super::{
    Header, OLD, PRESENT,
    lzw::{Restart, packing::pack},
};
use crate::prescription::{
    Coating, Fate, GlassLibrary, Layer, MAX_FILE_BYTES, Medium, Prescription, SurfaceCoating, glass, load,
    read, read_with, source::SearchPath,
};

const LENS: &str = "MODE SEQ\nENPD 10\nGCAT OWN\nWAVM 1 0.5 1\nPWAV 1\nCOFN QF \"MINE.DAT\" \"SCATTER.DAT\"\n\
    SURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  COAT AR\n  CURV 0.02\n  DISZ 4\n  GLAS PRIVATE 0 0 1.5 40\n  DIAM 10 1\n\
    SURF 2\n  COAT AR\n  CURV -0.02\n  DISZ 40\n  DIAM 10 1\nSURF 3\n  DISZ 0\n";
const OWN: &str = "CC made up\nNM PRIVATE 1 0 1.7 50\nCD 2.89 0 0 0 0 0\n";
const COATINGS: &str =
    "MATE L\n0.5 1.4 0\nMATE H\n0.4 2.1 0\n0.6 1.9 0\nCOAT AR\nL .25\nH 0.1 1\nCOAT METAL\nAL 1\n";

/// Returns a member: its header and its bytes, packed if its name ends so.
fn member(form: &Header, name: &str, bytes: &[u8]) -> Vec<u8> {
    let own = if name.ends_with(".LZW") { pack(bytes, Restart::Fresh) } else { bytes.to_vec() };
    let mut header = vec![0; form.size];
    let is_present = form.unpacked.is_some();
    header[..2].copy_from_slice(&[if is_present { 0xEC } else { 0xEA }, 3]);
    header[form.packed[0]..form.packed[0] + 4].copy_from_slice(&(own.len() as u32).to_le_bytes());
    if let Some(unpacked) = form.unpacked {
        header[unpacked..unpacked + 8].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
    }
    for (i, byte) in name.bytes().enumerate() {
        header[form.name + i * form.character] = byte;
    }
    header.extend(own);
    header
}

fn archive(form: &Header, members: &[(&str, &[u8])]) -> Vec<u8> {
    members.iter().flat_map(|(name, bytes)| member(form, name, bytes)).collect()
}

/// Returns an archive with a lens and everything that it refers to.
fn whole(form: &Header) -> Vec<u8> {
    let members: [(&str, &[u8]); 6] = [
        ("LENS.ZMX.LZW", LENS.as_bytes()),
        ("LENS.SES.LZW", &[0; 3000]),
        ("C:\\Glass\\OWN.AGF.LZW", OWN.as_bytes()),
        ("OTHER.AGF.LZW", b"NM OTHER 1 0 1.7 50\nCD 2.89 0 0 0 0 0\n"),
        ("MINE.DAT.LZW", COATINGS.as_bytes()),
        ("LOGO.BMP", b"BM"),
    ];
    archive(form, &members)
}

#[track_caller]
fn ok(bytes: &[u8]) -> Prescription {
    read("a/lens.zar", bytes).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(bytes: &[u8], at: &str, parts: &[&str]) {
    let message = read("lens.zar", bytes).expect_err("refused").to_string();
    assert!(message.starts_with(&format!("lens.zar{at}")), "{message}");
    for part in parts {
        assert!(message.contains(part), "{message} lacks {part:?}");
    }
}

#[test]
fn a_lens_is_read_with_the_glasses_and_coatings_of_its_archive() {
    for form in [PRESENT, OLD] {
        let lens = ok(&whole(&form));
        assert_eq!((lens.name.as_str(), lens.interfaces.len()), ("lens.zar", 2));
        assert!((glass::refractive_index(lens.interfaces[0].medium, 500.0) - 1.7).abs() < 1e-12);
        let low = Layer::of_waves(1.4, 0.25, 500.0);
        let Some([SurfaceCoating::Stack(front), SurfaceCoating::Stack(back)]) = lens.coatings.as_deref()
        else {
            panic!("{:?}", lens.coatings)
        };
        assert!((front[1].index - 2.0).abs() < 1e-12, "{front:?}");
        assert_eq!((front[0], front[1].thickness, front), (low, 100.0, back));
        // The numbers 1.5 and 40 stand for none.
        assert_eq!(lens.remarks, [""; 0]);
        let fate_of = |statement: &str| {
            let found = lens.findings.iter().find(|finding| finding.statement == statement);
            found.map(|finding| (finding.fate, finding.reason.as_str(), finding.places.len()))
        };
        for used in ["LENS.ZMX", "OWN.AGF", "MINE.DAT"] {
            assert_eq!(fate_of(used), Some((Fate::Used, "", 0)), "{used}");
        }
        for (left_out, reason) in [
            ("OTHER.AGF", "the lens has none of its glasses"),
            ("LENS.SES", "settings of the file's program and of its displays"),
            ("LOGO.BMP", "a picture"),
        ] {
            assert_eq!(fate_of(left_out), Some((Fate::LeftOut, reason, 0)), "{left_out}");
        }
        assert_eq!(fate_of("COFN"), Some((Fate::Used, "", 1)));
        // The lines are those of the lens.
        assert_eq!(fate_of("COAT").map(|(fate, _, lines)| (fate, lines)), Some((Fate::Replaced, 2)));
    }
}

#[test]
fn members_in_utf_16_and_with_restarts_are_the_same() {
    let plain = ok(&whole(&PRESENT));
    let utf16 = |text: &str| -> Vec<u8> {
        [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
    };
    let lens = archive(
        &PRESENT,
        &[("LENS.ZOS.LZW", &utf16(LENS)), ("OWN.AGF.LZW", &utf16(OWN)), ("mine.dat.LZW", &utf16(COATINGS))],
    );
    assert_eq!(
        (ok(&lens).interfaces, ok(&lens).coatings),
        (plain.interfaces.clone(), plain.coatings.clone())
    );
    // A comment that hardly repeats fills the table of strings. Both kinds of restart are told by the stated size.
    let mut state = 1_u32;
    let comment = |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        char::from(b' ' + (state >> 26) as u8)
    };
    let long = format!("{OWN}CC {}\n", (0..200_000).map(comment).collect::<String>());
    for restart in [Restart::Fresh, Restart::Continued] {
        let packed = pack(long.as_bytes(), restart);
        let mut catalogue = member(&PRESENT, "OWN.AGF.LZW", b"");
        catalogue.truncate(PRESENT.size);
        catalogue[0x10..0x14].copy_from_slice(&(packed.len() as u32).to_le_bytes());
        catalogue[0x18..0x1C].copy_from_slice(&(long.len() as u32).to_le_bytes());
        let lens =
            [&member(&PRESENT, "LENS.ZMX", LENS.as_bytes()), &catalogue, &packed].map(Vec::as_slice).concat();
        assert_eq!(ok(&lens).interfaces, plain.interfaces);
    }
    let old = archive(&OLD, &[("LENS.ZMX", LENS.as_bytes()), ("OWN.AGF.LZW", long.as_bytes())]);
    let at = OLD.size + LENS.len();
    refused(
        &old,
        &format!(":1:{}: ", at + 1),
        &[&format!("member OWN.AGF at byte {at}"), "without a stated size"],
    );
}

#[test]
fn without_the_files_of_the_archive_the_lens_is_read_as_by_itself() {
    // An unknown glass is refused with its place in the member.
    let alone = archive(&PRESENT, &[("LENS.ZMX", LENS.as_bytes())]);
    refused(&alone, "/LENS.ZMX:14:8", &["glass \"PRIVATE\" is not known"]);
    // The user's own catalogue precedes that of the archive.
    let mut library = GlassLibrary::default();
    library.add("mine.agf", OWN.replace("2.89", "4").as_bytes()).expect("a catalogue");
    let n_d = |bytes: &[u8], library: &GlassLibrary| {
        let lens = read_with("lens.zar", bytes, library).unwrap_or_else(|error| panic!("{error}"));
        (glass::refractive_index(lens.interfaces[0].medium, 587.56), lens.coatings)
    };
    assert_eq!(n_d(&whole(&PRESENT), &library).0, 2.0);
    // Without a coating file, names have the meaning that they have in a lens file.
    let named = SurfaceCoating::Named { coating: Coating::QuarterWave, wavelength: 500.0 };
    assert_eq!(n_d(&alone, &library).1, Some(vec![named; 2]));
    assert!(library.warnings().is_empty());
    // A coating that cannot be used is reported.
    let metal = LENS.replacen("COAT AR", "COAT METAL", 1);
    let members: [(&str, &[u8]); 2] = [("LENS.ZMX", metal.as_bytes()), ("MINE.DAT", COATINGS.as_bytes())];
    let lens = read_with("lens.zar", &archive(&PRESENT, &members), &library).expect("a lens");
    assert!(
        lens.remarks[0]
            .starts_with("lens.zar/LENS.ZMX:11:8: surface 1: coating METAL of MINE.DAT is not read"),
        "{:?}",
        lens.remarks
    );
    assert!(lens.coatings.is_some_and(|all| all[0].is_bare() && !all[1].is_bare()));
}

#[test]
fn a_damaged_archive_is_refused_with_the_member_and_the_byte() {
    let right = whole(&PRESENT);
    let with = |at: usize, bytes: &[u8]| {
        let mut wrong = right.clone();
        wrong[at..at + bytes.len()].copy_from_slice(bytes);
        wrong
    };
    let size =
        |at: usize| right[at..at + 4].iter().rev().fold(0, |size, byte| size << 8 | usize::from(*byte));
    let second = PRESENT.size + size(0x10);
    refused(
        &right[..24],
        ":1:1",
        &["the Zemax archive is damaged: the header of member 1 at byte 0 is cut off"],
    );
    refused(&right[..700], ":1:1", &["member LENS.ZMX.LZW at byte 0 has ", "by its header, and 52 follow"]);
    refused(&right[..second + 9], &format!(":1:{}", second + 1), &["the header of member 2"]);
    refused(&with(0x10, &[0xFF; 8]), ":1:1", &["has 18446744073709551615 bytes by its header"]);
    refused(
        &with(0x10, &[9]),
        &format!(":1:{}", second - size(0x10) + (size(0x10) & !0xFF) + 9 + 1),
        &["expected the header of member 2"],
    );
    refused(&with(0x30, &[0, 0]), ":1:1", &["member 1 at byte 0 has no name"]);
    refused(
        &with(0x18, &[9, 0]),
        ":1:1",
        &["member LENS.ZMX at byte 0 of the archive is damaged", "more than 9 bytes"],
    );
    refused(&with(0x18, &[0xFF, 0x7F]), ":1:1", &[&format!("it unpacks to {} bytes, not 32767", LENS.len())]);
    refused(
        &with(0x1F, &[1]),
        ":1:1",
        &["has more than 1048576 bytes (1 MiB), which is the most for a lens"],
    );
    let at = PRESENT.size + 10;
    refused(
        &with(at, &[0xFF; 8]),
        "",
        &["member LENS.ZMX at byte 0 of the archive is damaged: the code at byte 6"],
    );
    // Every truncation and every changed byte is a lens or an error, and never a panic.
    for end in (2..right.len()).step_by(7) {
        assert!(read("lens.zar", &right[..end]).is_err());
        let _ = read("lens.zar", &with(end, &[!right[end]]));
    }
}

#[test]
fn what_is_no_lens_or_too_large_is_refused() {
    let of = |members: &[(&str, &[u8])]| archive(&PRESENT, members);
    let lens = LENS.as_bytes();
    refused(&of(&[("OWN.AGF", OWN.as_bytes())]), ":1:1", &["has no lens (.zmx)"]);
    refused(&of(&[("A.ZMX", lens), ("b.zmx", lens)]), ":1:", &["has two lenses, A.ZMX and b.zmx"]);
    refused(&of(&[("A.ZOS", b"ZoS\0\x01\0\0\0")]), "/A.ZOS:1:1", &["a binary file of OpticStudio (.zos)"]);
    refused(&of(&[("A.ZMX", &whole(&PRESENT))]), "/A.ZMX:1:1", &["archive (.zar) in an archive"]);
    refused(&of(&[("A.ZMX", b"20 5 1.5 10\n")]), "/A.ZMX:1:1", &["no Zemax lens"]);
    let empty = vec![b' '; MAX_FILE_BYTES as usize + 1];
    for form in [PRESENT, OLD] {
        for name in ["A.ZMX", "A.ZMX.LZW"] {
            refused(
                &archive(&form, &[(name, &empty)]),
                ":1:1",
                &["member A.ZMX", "has more than 1048576 bytes"],
            );
        }
    }
    let many: Vec<(&str, &[u8])> = vec![("A.BMP", b""); 1001];
    refused(&of(&many), ":1:", &["at most 1000 members"]);
    let mut large = whole(&PRESENT);
    large.extend(member(&PRESENT, "A.BMP", &vec![0; 1 << 24]));
    refused(&large, ":1:16777217", &["an archive has at most 16777216 bytes (16 MiB)"]);
    // Catalogues that are no catalogues or too large are left out.
    let own = OWN.as_bytes();
    let lens = ok(&of(&[
        ("A.ZMX", lens),
        ("X.AGF", b"nothing"),
        ("Y.AGF.LZW", &vec![b' '; (8 << 20) + 1]),
        ("OWN.AGF", own),
    ]));
    assert!(lens.remarks[0].contains("X.AGF: no glass; a glass catalogue"), "{:?}", lens.remarks);
    assert!(
        lens.remarks[1].contains("Y.AGF: the catalogues of an archive have at most 64 files, 8388608 bytes")
    );
    assert_eq!(lens.interfaces[1].medium, Medium::Air);
    // Catalogues that are left out use up the limit, so that many of them take no longer than one.
    let bomb = pack(&vec![b' '; 8 << 20], Restart::Fresh);
    let mut many = archive(&PRESENT, &[("A.ZMX", LENS.as_bytes()), ("OWN.AGF", own)]);
    for _ in 0..900 {
        let mut header = member(&OLD, "B.AGF.LZW", b"");
        header.truncate(OLD.size);
        header[0x0C..0x10].copy_from_slice(&(bomb.len() as u32).to_le_bytes());
        many.extend(header);
        many.extend(&bomb);
    }
    let left_out = ok(&many).findings.iter().filter(|finding| finding.statement == "B.AGF").count();
    assert_eq!(left_out, 1);
}

#[test]
fn an_archive_may_be_larger_than_a_lens_file() {
    let here = tempfile::tempdir().expect("a temporary directory");
    let path = here.path().join("lens.zar");
    let mut large = whole(&PRESENT);
    large.extend(member(&PRESENT, "A.BMP", &vec![0; 2 << 20]));
    std::fs::write(&path, &large).expect("written");
    let name = path.to_str().expect("UTF-8");
    let found = load(name, &SearchPath::default(), GlassLibrary::default()).expect("a lens");
    assert_eq!(found.interfaces, ok(&whole(&PRESENT)).interfaces);
}
