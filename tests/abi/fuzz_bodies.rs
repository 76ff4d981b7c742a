//! The checks of the fuzz targets (`fuzz/bodies`), on random bytes and on mutations of valid input.

#[path = "../../fuzz/bodies/c_abi/mod.rs"]
pub mod c_abi;
#[path = "../../fuzz/bodies/contract.rs"]
mod contract;
#[path = "../../fuzz/bodies/lens_text.rs"]
pub mod lens_text;
use super::properties;

use proptest::prelude::*;

const FILES: [&[u8]; 25] = [
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
    br#"{"FormatVersion": 1, "Title": "A", "Aperture": {"Type": "EPD", "Value": 10}, "Surfaces": [{"Thickness": "Infinity"},
        {"Radius": 50, "Thickness": 5, "Material": "N-BK7", "SemiDiameter": 12, "ClearAperturePercent": 125},
        {"Radius": -50, "Type": "EvenAsphere", "Conic": -1, "AsphericCoefficients": [0, 1e-5], "Thickness": 1},
        {"Thickness": 40, "IsStop": true}, {}], "Fields": [{"Y": 10}]}"#,
    br#"{"optical_model": {"seq_model": {"stop_surface": 1, "ifcs": [{}, {"profile_id": "1", "max_aperture": 8}, {"max_aperture": 8},
        {}], "gaps": [{"thi": 1e10}, {"thi": 5, "medium": {"__instance_type__": ["m", "ModelGlass"], "n": 1.5, "v": 60}},
        {"thi": 90}]}, "optical_spec": {"pupil": {"key": ["object", "epd"], "value": 10}},
        "profile_dict": {"1": {"__instance_type__": ["p", "EvenPolynomial"], "cv": 0.02, "coefs": [0, 1e-5]}}}}"#,
    br#"{"surface_group": {"surfaces": [{"geometry": {"cs": {"z": -Infinity}}}, {"geometry": {"type": "StandardGeometry",
        "cs": {"z": 0}, "radius": 50, "conic": 0}, "material_post": {"type": "IdealMaterial", "index": 1.5}, "is_stop": true},
        {"geometry": {"type": "Plane", "cs": {"z": 5}}}, {"geometry": {"type": "Plane", "cs": {"z": 95}, "radius": Infinity}}]},
        "aperture": {"type": "imageFNO", "value": 4}, "fields": {"fields": [{"y": 10}]}}"#,
    br#"{"info": "A", "foclen": 50, "surfaces": [{"type": "Spheric", "r": 8, "roc": 50, "mat2": "1.5/60", "d_next": 5},
        {"type": "Aspheric", "r": 8, "c": -0.02, "k": -1, "ai": [0, 1e-5], "mat2": "air", "d_next": 1},
        {"type": "Stop", "r": 4, "d_next": 40}]}"#,
    br#"{"format": "ghostlight-optical", "glass_catalogue": {"A": {"dispersion": {"model": "abbe", "nd": 1.5, "Vd": 60}}},
        "optical_system": [{"transform": {"position": {"z": -95}}, "materials": [{"glass": "A"}], "surfaces": [
        {"semi_aperture": 8, "form": {"type": "sphere", "radius": 50}, "thickness": 5, "is_stop": true},
        {"semi_aperture": 8, "form": {"type": "asphere", "radius": 0, "terms": [1e-5]}, "thickness": 90}]}]}"#,
    br#"{"name": "x", "surfaces": [{"radius": 50, "thickness": 4, "ior": [[400, 500, 700], [1.53, 1.52, 1.51]], "semi_aperture": 8,
        "conic_constant": -0.5}, {"radius": [-50, -50], "thickness": 1, "ior": 1, "semi_aperture": 8}, {"radius": 0, "thickness": 40,
        "ior": 0, "semi_aperture": 4}]}"#,
    br#"{"Assembly": {"0": {"Thickness": 1e10}, "1": {"Type": "ASP", "Curvature": 0.02, "Thickness": 4, "Material": "1.5:60",
        "Coefs": [1e-7], "Conic": -1}, "2": {"Curvature": -0.02, "Thickness": 48, "Aperture": {"Type": "Circular", "Radius": 9}},
        "3": {}, "Stop": 1}, "Spec": {"Pupil": {"Type": 0, "Value": 10}, "Field": {"Type": 0, "Y": [0, 10]}, "Wvl": {"Value": [550]}}}"#,
    b"RDM;LEN \"VERSION: 11.2\"\nTITLE 'x'\nEPD 8; DIM M\nWL 656.3 587.6 &\n486.1\nREF 2\nYAN 0 5\nPRV\nPWL 656.3 587.6 486.1\n\
      'OWN' 1.514 1.517 1.523\n'NOA' LAU 2.36 0 0.025\nEND\nSO 0 1e14\nS 50 4 OWN ! front\n  ASP\n  K -0.5; A 1e-6; J 0\n  \
      CIR 12; CIR OBS L'A' 2\nS -50 2 620.603\n  REX 9; REY 8; ADY 1\n  XDE 0\nS 0 1\n  STO\nS -80 60 NBK7_SCHOTT\nS 0 40\n  \
      THI HMY 0\nSI 0 -0.5\nCIR S3 8\nGO\n",
    b"tit 'a singlet'\nepd 5\nwl 650 550 450\nyim 0 3\nso 0 1e10\ns .02 4 517642\ns -.02 47\nsi 0 0\n",
    b"// OSLO 6.6\nLEN NEW \"x\" 100 5\nEBR 4\nANG 5\nUNI 1.0\n// SRF 0\nAIR\nTH 1e20\nNXT // SRF 1\nGLA N-BK7\nRD 50; TH 4\nCC -0.5\n\
      AD 1e-7\nAP CHK 5\nNXT\nAIR\nRD -50\nTH 1.5\nAP 5\nNXT\nAIR\nAST\nTH 2\nNXT\nWV 0.58756 0.48613 0.65627\nGLA MOD M 1.62 1.6272 \
      1.6169\nRD -250\nTH 2\nNXT\nAIR\nTH 40\nNXT\nAIR\nWV 0.58756 0.48613 0.65627\nEND 6\n",
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
    (prop::sample::select(FILES.to_vec()), edits).prop_map(|(file, edits)| {
        let mut bytes = file.to_vec();
        for (at, cut, insertion) in edits {
            let at = at.index(bytes.len() + 1);
            let end = (at + cut).min(bytes.len());
            bytes.splice(at..end, insertion);
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
