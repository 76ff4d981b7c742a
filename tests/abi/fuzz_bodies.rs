//! The checks of the fuzz targets (`fuzz/bodies`), on random bytes and on mutations of valid input.

#[path = "../../fuzz/bodies/c_abi/mod.rs"]
pub mod c_abi;
#[path = "../../fuzz/bodies/collection.rs"]
mod collection;
#[path = "../../fuzz/bodies/contract.rs"]
mod contract;
#[path = "../../fuzz/bodies/lens_text.rs"]
pub mod lens_text;
use super::{fuzz_seeds::OTHERS, properties};

use proptest::prelude::*;

const FILES: [&[u8]; 15] = [
    include_bytes!("../../crates/optics/lenses/dgauss.100mm.dat"),
    include_bytes!("../../crates/optics/lenses/dgauss.50mm.dat"),
    include_bytes!("../../crates/optics/lenses/fisheye.10mm.dat"),
    include_bytes!("../../crates/optics/lenses/zoom.24-70mm.dat"),
    include_bytes!("../golden/files/bench.txt"),
    include_bytes!("../golden/files/aspheres.zmx"),
    include_bytes!("../golden/files/archive.zar"),
    b"[lens]\nname = \"x\"\nfocal_length = 50.0\ncoating = \"multi\"\n[[surface]]\nradius = 50.0\nthickness = 4\nior = 1.6\nabbe_v = 60.0\n\
      aperture = 20.0\n[[surface]]\ntype = \"aspheric\"\nradius = -80.0\nthickness = 2\nior = 1.0\naperture = 19.0\nconic = -0.5\n\
      aspheric_coeffs = [1e-6, -2e-9]\n[[surface]]\ntype = \"stop\"\nradius = 0.0\nthickness = 40.0\nior = 1.0\naperture = 16.0\n",
    b"# a list, as pbrt reads it\n20 5 1.5 10 0 1 0 8 -20 30 1 10\n",
    b"name: x\nfocal_length: 20\nsurfaces:\n20 5 1.5 60 8 1\n-20 -0.5 1 0 8 0\nstop 18 1 0 3 0\n",
    b"20 5 1.5 10\n-20 -0.5 1 10\nstop 30 1 9\n",
    b"NM N-SK16 2 0 1.62041 60.32\nCD 1.34317774 0.00704687339 0.241144399 0.0229005 0.994317969 92.7508526\n",
    b"\xEF\xBB\xBF50\r\n20,5,1.5,10 # \xDF\r\n-20 30 0 10",
    b"# radius thickness eta aperture_radius\n0.0 2.0 0.0 9.0\n65.0 6.0 517642 11.0\n-65.0 52.0 AIR 11.0\n",
    b"NM A 1 0 1.4 57\nCD 2.30 -0.80 0.014 0 0 0 x\nLD 0.4 1.6\nIT 0.70 12.0 10\nNM F4 2 0\nCD 1 0.01 0.2 0.16 1 100\n",
];

/// Returns the bytes of a lens file, with some of them replaced by tokens of the format or cut out.
fn mutated() -> impl Strategy<Value = Vec<u8>> {
    let insertion = prop_oneof![
        Just(b"-".to_vec()),
        Just(b"1e308".to_vec()),
        Just(b"-0".to_vec()),
        Just(b"5e-324".to_vec()),
        Just(b" stop ".to_vec()),
        Just(b"inf".to_vec()),
        Just(b"\n".to_vec()),
        Just(b",".to_vec()),
        Just(b"#".to_vec()),
        proptest::collection::vec(any::<u8>(), 0..3),
        "[0-9]{1,2}".prop_map(String::into_bytes),
    ];
    let edits = proptest::collection::vec((any::<prop::sample::Index>(), 0..3_usize, insertion), 0..6);
    let files: Vec<&[u8]> = FILES.into_iter().chain(OTHERS).collect();
    (prop::sample::select(files), edits).prop_map(|(file, edits)| {
        let mut bytes = file.to_vec();
        for (at, cut, insertion) in edits {
            let at = at.index(bytes.len() + 1);
            let end = (at + cut).min(bytes.len());
            bytes.splice(at..end, insertion);
        }
        bytes
    })
}

/// Returns bytes of which some are changed.
fn changed(bytes: &'static [u8]) -> impl Strategy<Value = Vec<u8>> {
    proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6).prop_map(move |edits| {
        let mut bytes = bytes.to_vec();
        for (at, byte) in edits {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        bytes
    })
}

fn bytes(size: usize) -> impl Strategy<Value = Vec<u8>> {
    proptest::collection::vec(any::<u8>(), 0..size)
}

/// Runs `check` on `cases` inputs; at least `least` of them must be accepted, or the test covers too little.
fn many(cases: u32, strategy: impl Strategy<Value = Vec<u8>>, least: u32, check: fn(&[u8]) -> bool) {
    let accepted = std::cell::Cell::new(0);
    proptest::test_runner::TestRunner::new(properties::cases(cases))
        .run(&strategy, |data| {
            accepted.set(accepted.get() + u32::from(check(&data)));
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(accepted.get() >= least, "only {} of {cases} were accepted", accepted.get());
}

#[test]
fn any_bytes_are_a_lens_or_an_error_with_its_position() {
    many(4000, bytes(200), 0, lens_text::run);
    many(4000, mutated(), 400, lens_text::run);
}

#[test]
fn any_options_are_a_camera_or_an_error_with_a_message() {
    many(1000, bytes(400), 10, c_abi::run);
    let with_text = (proptest::collection::vec(any::<u8>(), 320), mutated())
        .prop_map(|(options, text)| [options, text].concat());
    many(1000, with_text, 10, c_abi::run);
}

/// A collection as another program packs it, with a lens that is stored and one that is deflated.
const ARCHIVE: &[u8] = include_bytes!("../golden/files/collection.zip");

#[test]
fn any_archive_is_a_collection_or_an_error() {
    assert!(collection::run(ARCHIVE));
    many(500, changed(ARCHIVE), 100, collection::run);
    // Bytes behind the signature of an archive's first member, and in front of its end.
    let end = ARCHIVE.len() - 22;
    many(
        500,
        bytes(400).prop_map(move |bytes| [&ARCHIVE[..4], &bytes, &ARCHIVE[end..]].concat()),
        0,
        collection::run,
    );
}

/// Returns the smallest set of inputs with the fuzzer's full coverage (`fuzz/README.md` describes how it is
/// made).
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let archive = format!("{}/fuzz/corpus/{target}.tar.gz", env!("CARGO_MANIFEST_DIR"));
    let mut tar = std::process::Command::new("tar");
    let status = tar.args(["-xzf", &archive, "-C"]).arg(folder.path()).status().expect("tar runs");
    assert!(status.success(), "{archive}");
    let files = std::fs::read_dir(folder.path()).unwrap();
    files.map(|file| std::fs::read(file.unwrap().path()).unwrap()).collect()
}

#[test]
fn what_the_fuzzers_have_reached_is_reached_again() {
    for (target, check) in [("lens_text", lens_text::run as fn(&[u8]) -> bool), ("c_abi", c_abi::run)] {
        let corpus = corpus(target);
        let accepted = corpus.iter().filter(|input| check(input)).count();
        println!("{target}: {} inputs, {accepted} accepted", corpus.len());
        assert!(corpus.len() >= 100 && accepted >= 40, "{target}: {accepted} of {}", corpus.len());
    }
}
