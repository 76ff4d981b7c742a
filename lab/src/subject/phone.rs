//! A telephone's lens: six plastic elements, twelve strong aspheres.

use realistic::prescription::{Asphere, FIRST_POWER, Interface, Medium, Prescription, Shape};

/// Radius, thickness, n_d and V behind (0: air), clear diameter, conic constant, and A4, A6, ….
type Row = (f64, f64, [f64; 2], f64, f64, &'static [f64]);

const AIR: [f64; 2] = [0.0; 2];
const CLEAR: [f64; 2] = [1.545, 55.9];

/// US 2016/0341934 A1, example 11 (tables 11A and 11B), f = 4.10 mm, f/1.8; the clear diameters by rays.
const ROWS: [Row; 14] = [
    (
        1.942,
        0.7603,
        CLEAR,
        2.31,
        -0.498_533_96,
        &[0.002_823_08, 0.020_646_1, -0.032_575_1, 0.025_697_8, -0.009_439_7],
    ),
    (-43.409, 0.0555, AIR, 2.18, 0.0, &[-0.051_699_4, 0.121_884, -0.131_873, 0.057_698_7, -0.009_674_5]),
    (
        7.984,
        0.2494,
        [1.651, 21.5],
        2.17,
        0.0,
        &[-0.112_242, 0.188_446, -0.172_552, 0.060_297_7, 0.004_606_42, -0.004_148_86],
    ),
    (
        2.979,
        0.5868,
        AIR,
        2.15,
        -7.584_190_32,
        &[-0.062_631_1, 0.114_977, -0.143_652, 0.081_498_9, -0.023_232_4, -0.000_908_662],
    ),
    (
        -9.473,
        0.4081,
        [1.651, 21.5],
        2.13,
        0.0,
        &[-0.155_42, 0.005_641_68, -0.045_701, 0.016_167_9, -0.011_584_6, 0.007_823_47],
    ),
    (
        -28.062,
        0.235,
        AIR,
        2.56,
        0.0,
        &[-0.127_643, 0.012_278_8, 0.010_425_2, -0.009_087_95, 0.005_904_65, 0.000_112_693],
    ),
    (
        -8.682,
        0.9771,
        CLEAR,
        3.35,
        0.0,
        &[-0.009_742_11, -0.035_742_3, 0.055_077_9, -0.026_255_7, 0.005_424_19, -0.000_353_494, -2.057_92e-5],
    ),
    (
        -1.508,
        0.1,
        AIR,
        3.74,
        -0.968_941_94,
        &[0.039_387_8, -0.019_958_5, 0.014_067_7, -0.003_376_07, 0.000_347_83, -2.923_23e-5, 1.647_55e-6],
    ),
    (
        1.681,
        0.328,
        CLEAR,
        4.47,
        -0.830_780_6,
        &[-0.174_274, 0.047_487_6, -0.008_975_72, 0.000_661_592, 2.912_23e-5, -4.361_44e-6],
    ),
    (
        1.128,
        0.7,
        AIR,
        4.88,
        -2.853_919_57,
        &[-0.083_504_7, 0.022_733_6, -0.004_976_27, 0.000_507_058, -1.042_43e-5, -1.868_59e-6],
    ),
    (-22.861, 0.3, [1.661, 20.4], 5.01, 0.0, &[-0.058_171_9, 0.016_704_1, -0.001_885_51, 6.125_28e-5]),
    (
        3.522,
        0.45,
        AIR,
        5.58,
        0.308_029_64,
        &[-0.097_708_4, 0.021_514_6, -0.002_293_45, 9.181_6e-5, -9.456_31e-7],
    ),
    (f64::INFINITY, 0.15, [1.516, 64.1], 6.09, 0.0, &[]),
    (f64::INFINITY, 0.0971, AIR, 6.17, 0.0, &[]),
];

/// The lens; its film stands 0.0971 mm behind the last surface.
pub fn phone_lens() -> Prescription {
    let stop = Interface { shape: Shape::Stop, thickness: 0.0, medium: Medium::Air, semi_diameter: 1.1401 };
    let interface = |&(radius, thickness, [n_d, abbe], diameter, conic, even): &Row| {
        let mut terms = [0.0; 19];
        for (place, term) in (4 - FIRST_POWER..).step_by(2).zip(even) {
            terms[place] = *term;
        }
        let shape = match radius.is_finite() {
            true => Shape::Asphere(Asphere { radius, conic, terms }),
            false => Shape::Plane,
        };
        let medium = if n_d == 0.0 { Medium::Air } else { Medium::Glass { n_d, abbe: Some(abbe) } };
        Interface { shape, thickness, medium, semi_diameter: diameter / 2.0 }
    };
    let mut interfaces: Vec<Interface> = std::iter::once(stop).chain(ROWS.iter().map(interface)).collect();
    let film = interfaces.last_mut().map(|last| std::mem::take(&mut last.thickness));
    Prescription {
        name: "phone.4mm".to_owned(),
        title: None,
        interfaces,
        nominal_film_distance: film,
        stated_focal_length: Some(4.1),
        positions: None,
        stated: Default::default(),
        glasses: Vec::new(),
        blades: None,
        remarks: Vec::new(),
    }
}
