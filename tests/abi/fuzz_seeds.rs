//! Seed inputs of the fuzzer (`fuzz/README.md`): lens files of every form, and options and samples of cameras that
//! build, in the byte format that `fuzz/bodies/c_abi` decodes.
//!
//! `REALISTIC_WRITE_SEEDS=DIR cargo test --test abi seeds` writes the inputs to `DIR/lens_text` and `DIR/c_abi`.

use super::fuzz_bodies::{c_abi, lens_text};

const CATALOGUE: [&[u8]; 5] = [
    include_bytes!("../../crates/optics/lenses/dgauss.50mm.dat"),
    include_bytes!("../../crates/optics/lenses/dgauss.100mm.dat"),
    include_bytes!("../../crates/optics/lenses/fisheye.10mm.dat"),
    include_bytes!("../../crates/optics/lenses/telephoto.250mm.dat"),
    include_bytes!("../../crates/optics/lenses/wide.22mm.dat"),
];

/// Small lens files, which contain: a focal length; commas; words for planes and stops; glasses by name, by code and by
/// group; old line endings; an asphere; a zoom in Optical Bench's format; UTF-16; statements of Zemax files; a column
/// of radii; an archive; a list of numbers; TOML.
const SMALL: [&[u8]; 16] = [
    include_bytes!("../golden/files/archive.zar"),
    b"[lens]\nname = \"x\"\nfocal_length = 50.0\ncoating = \"multi\"\n[[surface]]\nradius = 50.0\nthickness = 4\nior = 1.6\nabbe_v = 60.0\n\
      aperture = 20.0\n[[surface]]\ntype = \"aspheric\"\nradius = -80.0\nthickness = 2\nior = 1.0\naperture = 19.0\nconic = -0.5\n\
      aspheric_coeffs = [1e-6, -2e-9]\n[[surface]]\ntype = \"stop\"\nradius = 0.0\nthickness = 40.0\nior = 1.0\naperture = 16.0\n",
    b"# a list\n20 5 1.5 10 0 1 0 8 -20 30 1 10\n",
    b"# radius thickness eta aperture_radius\n0.0 2.0 0.0 9.0\n65.0 6.0 517642 11.0\n-65.0 52.0 AIR 11.0\n",
    b"MODE SEQ\nENPD 10\nGCAT SCHOTT\nWAVM 1 0.5875618 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  DISZ 4\n  \
      GLAS SCHOTT-BK|N-BK7\n  DIAM 10 1\nSURF 2\n  CURV -0.02\n  DISZ 40\n  DIAM 10 1\nSURF 3\n",
    b"\xEF\xBB\xBF50\r\n20,5,1.5,10 # \xDF\r\n-20 30 0 10",
    b"30 4 1.6 12\n-30 2 0 12\nstop 3 0 8\ninf 2 1.5 12\n-25 40 1 12\n",
    b"30 4 1.62 60.3 12\n-40 1 12\nstop 2 8\ninf 2 1.7 30 12\n-25 40 12\n",
    b"glass BK7 sellmeier B1=1.03961212 C1=0.00600069867 B2=0.231792344 C2=0.0200179144 B3=1.01046945 C3=103.560653\n\
      30 4 BK7 12\n-30 2 0 12\n0 25 0 8\n",
    b"20 5 1.5 10\r-20 3 1 10\r0 1 1 8\r",
    b"20 5 N-BK7 10\n-20 30 1 10\nasphere 1 conic=-1.2 A4=1e-5 A20=-3e-30\n",
    b"[descriptive data]\ntitle\tA zoom\n[constants]\nScaled\t50\t100\n[variable distances]\n\
      Focal Length\t28.0\t50.0\nF-Number\t2.8\t4\nAngle of View\t75.2\t46.4\nd0\tInfinity\tInfinity\n\
      d3\t3.0\t9.0\nBf\t40.0\t35.0\nAperture Diameter\t6.2\t6.8\n\
      [lens data]\n1\t20.0\t5.0\t1.51680\t10.0\t64.17\tN-BK7\tSCHOTT\n2\t-20\t1\t\t10\n3\tFS\td3\t\t9\t\n\
      4AS\tAS\t1\t\t6.5\n5\t30\t2\t1.6\t8\t40\tXQ7?\n6\t-30\t1\t\t8\n7\tCG\t1.5\t1.52\t30\t64.1\n\
      8\tInfinity\tBf\t\t30\n[aspherical data]\n2\t-20\t-0.5\t1e-5\t\t2e-9\t\n",
    b"ENPD 16\nWAVM 1 0.58756 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  TYPE XASPHERE\n  CURV 0.02\n  PARM 2 1e-5\n  DISZ 4\n  \
      GLAS ___BLANK 1 0 1.5\n  DIAM 8 1\n  CLAP 0 6 0\nSURF 2\n  CURV -0.02\n  DISZ 48\n  DIAM 8 1\nSURF 3\n  TYPE JONESMAT\n  \
      DISZ -3\n  DIAM 9 1\nSURF 4\n  DISZ 0\nMNUM 3 1\nTHIC 0 1 1e10\nTHIC 0 2 1e10\nTHIC 0 3 500\nTHIC 2 1 48\nTHIC 2 2 50\n\
      THIC 2 3 52\nPAR2 1 1 1e-5\nPAR2 1 2 2e-5\n",
    b"FLOA\nENVD 20 0 1\nSURF 1\nSTOP\nTYPE XOSPHERE\nCURV 0.02\nXDAT 1 2\nXDAT 2 5\nXDAT 4 1e-4\nDISZ -0.00001\n\
      GLAS ___BLANK 1 0 1.5\nSURF 2\nCURV -0.02\nDISZ 48\nDIAM 8 1\nSURF 3\nDISZ 0\nMNUM 2 1\nSDIA 1 1 5\nSDIA 1 2 2.5\n",
    b" FNUM 4 1\n SURF   0\n   DISZ 100\n SURF   1\n   CURV 0.02\n   DISZ 4\n   GLAS ___BLANK 1 0 1.6 60\n   DIAM 8\n SURF   2\n   \
      CURV -0.02\n   DISZ 40\n   DIAM 8 1\n   SQAP 9 9 0\n SURF   3\n   STOP\n   DISZ 1\n SURF   4\n",
    b"\xFF\xFE2\x000\x00 \x005\x00 \x001\x00.\x005\x00 \x001\x000\x00\n\x00-\x002\x000\x00 \x003\x00 \x001\x00 \x009\x00",
];

/// Lenses of other programs: sequences of Code V and OSLO, and JSON of every format. The properties mutate them, too.
pub const OTHERS: [&[u8]; 15] = [
    b"RDM;LEN \"VERSION: 11.2\"\nTITLE 'x'\nEPD 8; DIM M\nWL 656.3 587.6 &\n486.1\nREF 2\nYAN 0 5\nPRV\nPWL 656.3 587.6 486.1\n\
      'OWN' 1.514 1.517 1.523\n'NOA' LAU 2.36 0 0.025\nEND\nSO 0 1e14\nS 50 4 OWN ! front\n  ASP\n  K -0.5; A 1e-6; J 0\n  \
      CIR 12; CIR OBS L'A' 2\nS -50 2 620.603\n  REX 9; REY 8; ADY 1\n  XDE 0\nS 0 1\n  STO\nS -80 60 NBK7_SCHOTT\nS 0 40\n  \
      THI HMY 0\nSI 0 -0.5\nCIR S3 8\nGO\n",
    b"tit 'a singlet'\nepd 5\nwl 650 550 450\nyim 0 3\nso 0 1e10\ns .02 4 517642\ns -.02 47\nsi 0 0\n",
    b"// OSLO 6.6\nLEN NEW \"x\" 100 5\nEBR 4\nANG 5\nUNI 1.0\n// SRF 0\nAIR\nTH 1e20\nNXT // SRF 1\nGLA N-BK7\nRD 50; TH 4\nCC -0.5\n\
      AD 1e-7\nAP CHK 5\nNXT\nAIR\nRD -50\nTH 1.5\nAP 5\nNXT\nAIR\nAST\nTH 2\nNXT\nWV 0.58756 0.48613 0.65627\nGLA MOD M 1.62 1.6272 \
      1.6169\nRD -250\nTH 2\nNXT\nAIR\nTH 40\nNXT\nAIR\nWV 0.58756 0.48613 0.65627\nEND 6\n",
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
    b"MODE SEQ\nUNIT MM\nENPD 8\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  TYPE TOROIDAL\n  CURV 0.02\n  PARM 1 80\n  DISZ 4\n  \
      GLAS ___BLANK 1 0 1.5 60\n  DIAM 9 1\nSURF 2\n  TYPE BICONICX\n  CURV -0.02\n  PARM 1 -60\n  DISZ 20\n  DIAM 9 1\nSURF 3\n  \
      TYPE COORDBRK\n  PARM 3 45\n  PARM 6 1\n  DISZ 1\n  SCBD 3 3 2\nSURF 4\n  SCBD 1 0 0 1 2 3 4 5\n  SCBD 2 1 0 -1 -2 -3 -4 -5\n  \
      GLAS MIRROR\n  DISZ -30\n  DIAM 15 1\nSURF 5\n  TYPE TILTSURF\n  PARM 1 0.1\n  DISZ -5\n  DIAM 20 1\nSURF 6\n  DISZ 0\n\
      MNUM 2 1\nTHIC 2 1 20\nTHIC 2 2 21\n",
    b"SURF 0\n  DISZ INFINITY\nSURF 1\n  DISZ 35\n  DIAM 9 1\nSURF 2\n  CURV -.004\n  DISZ 8\n  GLAS ___BLANK 1 0 1.5 60\n  DIAM 40 1\n\
      SURF 3\n  CURV -.003\n  DIAM 40 1\nSURF 4\n  CURV -.003\n  GLAS ___BLANK 1 0 -1\n  DIAM 40 1\nSURF 5\n  CURV -.003\n  DISZ -8\n  \
      GLAS ___BLANK 1 0 1.5 60\n  DIAM 40 1\nSURF 6\n  CURV -.004\n  DISZ -34\n  DIAM 40 1\nSURF 7\n  DISZ 60\n  GLAS MIRROR\n  DIAM 9 1\n\
      SURF 8\n",
    b"RDM\nEPD 8\nDIM M\nSO 0 1e14\nS 50 4 517642\n  STO; CIR 6\nS -50 20\n  CIR 6\nS 0 -30 REFL\n  ADE -40; BEN; CIR 9; CIR HOL 1\n\
      S -60 -3 517642\n  XDE 1; ZDE 0.5; BDE 2; CDE 3; DAR; CIR 8\nS 60 -15\n  CIR 8\nSI 0 0\n  ADE 5\n",
    b"[lens data]\n1\t-300\t0\t-1\t80\n2\t-300\t-90\t\t80\n3\t-140\t100\t-1.0\t30\n",
    br#"{"surface_group": {"surfaces": [{"geometry": {"cs": {"z": -Infinity}}}, {"geometry": {"type": "ToroidalGeometry", "cs": {"z": 0,
        "rx": 0.1}, "radius_x": -200, "radius_y": -220, "conic_yz": -1, "coeffs_poly_y": [0, 1e-8]}, "material_post": {"type":
        "Mirror"}, "aperture": {"type": "RadialAperture", "r_max": 9}}, {"geometry": {"type": "Plane", "cs": {"z": -95, "y": 2}}}]}}"#,
];

/// Texts that are refused: an unknown catalogue, a catalogue of glasses with wrong lines, files of other programs.
const REFUSED: [&[u8]; 5] = [
    b"50 5 NIKON:J-SK16 - 20\n-50 40 1 - 20\n",
    b"NM PLAS 2 0 1.5168 64.17 0 1\nCD 1.03961212 0.00600069867 0.231792344 0.16 1.01046945 103.560653 0 x\nLD 0.3 2.5\nIT 0.70 12.0 10\n",
    b"! exported\nINI \"A\"\nRDM;LEN\nSO 0 0.1E+21 AIR\nS 50 4 516.64\nCYL\nSI 0 0\n",
    b"[lens]\nname = \"doublet\"\n[[surface]]\nradius = 50.0\n",
    b"\xEC\x03\x00\x00\x00\x00\x00\x00\x01\x00\x00\x00",
];

/// A writer of the format that `Bytes` reads.
#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn choice(&mut self, choice: usize) {
        self.0.push(u8::try_from(choice).expect("a choice of at most 256"));
    }

    fn number(&mut self, number: f64) {
        match number {
            _ if number.is_nan() => self.choice(0),
            _ if (0.0..1024.0).contains(&number) && (64.0 * number).fract() == 0.0 => {
                self.choice(26);
                self.0.extend(((64.0 * number) as u16).to_le_bytes());
            }
            _ => {
                self.choice(31);
                self.0.extend(number.to_bits().to_le_bytes());
            }
        }
    }

    fn float(&mut self, float: f32) {
        self.choice(3);
        self.0.extend(float.to_bits().to_le_bytes());
    }

    /// Writes a float as a share of its scale.
    fn share(&mut self, share: f64) {
        self.choice(0);
        self.0.extend(((65535.0 * share) as u16).to_le_bytes());
    }

    fn text(&mut self, text: &[u8]) {
        self.0.extend(u16::try_from(text.len()).expect("a short text").to_le_bytes());
        self.0.extend(text);
    }
}

/// A camera, as indices into the lists of `options`.
#[derive(Clone, Default)]
struct Seed {
    /// Words for lens, weighting, pupil, disk, refraction, precision and shutter; `None` for a word that is not given.
    words: [Option<usize>; 7],
    /// Some of the 14 numbers, with their index in the list.
    numbers: Vec<(usize, f64)>,
    model: Option<usize>,
    /// Some of the numbers of a model, with their index.
    model_numbers: Vec<(usize, f64)>,
    moves: bool,
    blades: Option<usize>,
    text: Option<&'static [u8]>,
    autofocus: Option<bool>,
}

const FILM_DISTANCE: usize = 0;
const FOCUS_DISTANCE: usize = 1;
const TOLERANCE: usize = 11;
const CAMERA: [f32; 12] = [1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 1.0, -4.0];

impl Seed {
    fn bytes(&self, number: usize) -> Vec<u8> {
        let mut to = Writer::default();
        let counts = [6, 5, 4, 4, 4, 3, 4];
        self.words.iter().zip(counts).for_each(|(word, none)| to.choice(word.unwrap_or(none)));
        to.choice(1);
        to.choice(0);
        let value = |from: &[(usize, f64)], index| {
            from.iter().find(|(at, _)| *at == index).map_or(f64::NAN, |&(_, number)| number)
        };
        (0..14).for_each(|index| to.number(value(&self.numbers, index)));
        to.choice(usize::from(self.model.is_none()));
        if let Some(model) = self.model {
            to.choice(model);
            to.choice(0);
            (0..8).for_each(|index| to.number(value(&self.model_numbers, index)));
        }
        to.choice(usize::from(!self.moves));
        if self.moves {
            CAMERA.iter().for_each(|&entry| to.float(entry));
        }
        to.choice(usize::from(!self.moves));
        if self.moves {
            [0.0, 1.0].iter().for_each(|&time| to.number(time));
            (0..12).for_each(|entry| to.float(if entry == 3 { 0.5 } else { 0.0 }));
        }
        // The lens is neither zoomed nor focused by its groups.
        to.choice(1);
        to.choice(usize::from(self.blades.is_none()));
        if let Some(blades) = self.blades {
            to.choice(blades);
            [30.0, 0.5].iter().for_each(|&number| to.number(number));
        }
        to.choice(usize::from(self.text.is_some()));
        if let Some(text) = self.text {
            to.text(text);
        }
        // Irrational steps make all numbers different.
        (0..37 * 5).for_each(|i| to.share((0.618_033_988_749_895 * (i + 1) as f64).fract()));
        to.choice(usize::from(self.autofocus.is_none()));
        if let Some(by_contrast) = self.autofocus {
            to.choice(1);
            [0.4, 0.4, 0.6, 0.6].iter().for_each(|&edge| to.share(edge));
            [900.0, 2000.5].iter().for_each(|&answer| to.number(answer));
            to.choice(1);
            to.choice(usize::from(!by_contrast));
        }
        // Strides, offsets and optional arrays, varied in turn.
        [5, 4, 4, 2, 16, 4, 4].iter().for_each(|count| to.choice(number % count));
        // The lens without a film: rays from both sides, and two distances.
        (0..2 * 11 * 6).for_each(|i| to.share((0.754_877_666_246_693 * (i + 1) as f64).fract()));
        to.number(1000.0);
        to.share(0.5);
        self.newer(number, &mut to);
        to.0
    }

    /// Writes strides, wavelengths, importance or a crop window: one of the four in turn, and all four for the first
    /// camera.
    fn newer(&self, number: usize, to: &mut Writer) {
        let asks = |which: usize| number == 0 || number % 4 == which;
        let mut parts = (0..).map(|i: u32| (0.569_840_290_998_053 * f64::from(i + 1)).fract());
        let layouts = |to: &mut Writer, arrays: usize| {
            (0..2 * arrays).for_each(|i| to.choice((number + i) % 3));
        };
        to.choice(usize::from(asks(0)));
        if asks(0) {
            layouts(to, 9);
        }
        to.choice(usize::from(asks(1)));
        if asks(1) {
            (0..37).for_each(|_| to.share(parts.next().expect("endless")));
            layouts(to, 10);
        }
        to.choice(usize::from(asks(2)));
        if asks(2) {
            (0..13 * (7 + 6)).for_each(|_| to.share(parts.next().expect("endless")));
        }
        to.choice(usize::from(asks(3)));
        if asks(3) {
            [3, 20, 4, 10, 1].iter().for_each(|&choice| to.choice(choice));
        }
    }

    /// Returns one camera of each kind.
    fn all() -> Vec<Self> {
        let plain = Self::default();
        let mut all = vec![plain.clone()];
        for (index, count) in [6, 4, 3, 3, 3, 3, 3].into_iter().enumerate() {
            for word in 0..count {
                // Word 4 is no catalogue name: "@1e9mm" is a scale, but "@mm" is not.
                if (index, word) != (0, 4) {
                    let mut seed = plain.clone();
                    seed.words[index] = Some(word);
                    all.push(seed);
                }
            }
        }
        let numbers = [
            (FILM_DISTANCE, 40.0),
            (FOCUS_DISTANCE, 800.0),
            (2, 6.5),
            (3, 8.0),
            (4, 20.0),
            (5, 0.5),
            (6, 1e9),
            (7, -2.0),
            (8, 3.0),
            (9, 450.0),
            (10, 1000.0),
            (TOLERANCE, 0.25),
        ];
        all.extend(numbers.map(|number| Self { numbers: vec![number], ..plain.clone() }));
        all.extend((0..6).map(|model| Self { model: Some(model), ..plain.clone() }));
        let thin_lens = vec![(4, 40.0), (6, 0.5), (7, 100.0)];
        all.push(Self { model: Some(2), model_numbers: thin_lens, ..plain.clone() });
        all.push(Self { blades: Some(1), ..plain.clone() });
        all.push(Self { moves: true, ..plain.clone() });
        all.push(Self { moves: true, numbers: vec![(TOLERANCE, 0.125)], ..plain.clone() });
        all.extend([true, false].map(|by_contrast| Self { autofocus: Some(by_contrast), ..plain.clone() }));
        let texts = CATALOGUE.into_iter().chain(SMALL);
        all.extend(texts.map(|text| Self {
            text: Some(text),
            numbers: vec![(FILM_DISTANCE, 40.0)],
            ..plain.clone()
        }));
        all
    }
}

#[test]
fn the_seeds_of_the_fuzzers_are_lenses_and_cameras() {
    let lenses: Vec<Vec<u8>> =
        CATALOGUE.into_iter().chain(SMALL).chain(OTHERS).chain(REFUSED).map(<[u8]>::to_vec).collect();
    let cameras: Vec<_> = Seed::all().iter().enumerate().map(|(number, seed)| seed.bytes(number)).collect();
    if let Some(folder) = std::env::var_os("REALISTIC_WRITE_SEEDS") {
        for (target, seeds) in [("lens_text", &lenses), ("c_abi", &cameras)] {
            let folder = std::path::Path::new(&folder).join(target);
            std::fs::create_dir_all(&folder).unwrap();
            for (number, seed) in seeds.iter().enumerate() {
                std::fs::write(folder.join(format!("seed-{number:02}")), seed).unwrap();
            }
        }
    }
    for (number, lens) in lenses.iter().enumerate() {
        let is_refused = REFUSED.contains(&lens.as_slice());
        assert_eq!(lens_text::run(lens), !is_refused, "lens {number}: {}", String::from_utf8_lossy(lens));
    }
    for (number, camera) in cameras.iter().enumerate() {
        assert!(c_abi::run(camera), "camera {number}");
    }
}
