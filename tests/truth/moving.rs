//! A zoom lens with moving groups against its patent, by first-order optics and exact rays.

use crate::support::Random;
use realistic::imaging::focus::Focus;
use realistic::lens::{Lens, first_order::FirstOrder, moving::MovingGroups, pupil::EntrancePupil};
use realistic::prescription::{Position, Positions, Prescription, read};

/// US 2003/0133200 A1 (S. Sato, Nikon 2003), example 1: 70-200 mm f/2.8, focused by its second group; the last
/// three positions at a distance of 1.5 m. Clear diameters are derived. Radius, thickness, index behind, clear diameter.
const ROWS: &str = "\
136.2696 2.2 1.804 72.7
65.921 9 1.49782 68.7
184.6175 0.1 1 67.5
73.1041 8.9 1.49782 67.7
435.0246 14.1595 1 67.2
65.0851 1.8 1.84666 60.8
51.8175 1.92 1 58.7
63.216 8.7 1.64 58.7
1772.4929 2.52314 1 57.8
-1067.204 1.9 1.741 36.5
34.3923 6.835 1 32.8
-61.8566 1.8 1.48749 32.9
39.434 7 1.80518 34.8
-223.2401 1.803 1 34.9
-64.5266 1.9 1.8044 34.9
872.3457 34.06279 1 35.8
-599.1428 3.9 1.49782 36.4
-73.5485 0.2 1 36.9
93.8405 8 1.49782 37.7
-48.567 2 1.741 37.6
-149.5043 7.92945 1 38.1
0 1 1 37.4282
117.0055 2 1.80518 37.8
44.695 7 1.6968 37.1
-325.3499 0.1 1 36.8
76.1777 3.5 1.603 36.1
152.3247 20.6216 1 35.3
376.5966 3.8 1.84666 29.3
-57.886 1.5 1.741 29.2
50.043 3.9 1 28.6
-246.5579 1.5 1.741 29.0
102.2448 6.6784 1 29.5
-427.7771 4 1.49782 32.6
-58.2736 0.1 1 33.4
68.1118 7.5 1.741 34.8
-60.14 2 1.84666 34.7
-641.0882 66.21049 1 34.9
";
/// The interfaces, from 0, behind which the gap changes, and the gaps at each position.
const GAPS: [(usize, [f64; 6]); 4] = [
    (4, [14.1595, 14.1595, 14.1595, 4.43994, 4.43994, 4.43994]),
    (8, [2.52314, 17.06549, 31.15139, 12.24271, 26.78505, 40.87095]),
    (15, [34.06279, 25.29743, 1.96176, 34.06279, 25.29743, 1.96176]),
    (20, [7.92945, 2.15247, 11.40223, 7.92945, 2.15247, 11.40223]),
];
const FOCAL_LENGTHS: [f64; 3] = [71.4, 105.0, 196.0];
/// From the first vertex, mm: the patent's D0.
const NEAR: f64 = 1241.9566;

fn zoom_lens() -> Prescription {
    let mut prescription = read("70-200", ROWS.as_bytes()).expect("a lens");
    let column = |i: usize| Position {
        gaps: GAPS.iter().map(|(_, gaps)| gaps[i]).collect(),
        focal_length: FOCAL_LENGTHS.get(i).copied(),
        fnumber: (i < 3).then_some(2.88),
        object_distance: (i >= 3).then_some(NEAR),
        ..Position::default()
    };
    let gaps = GAPS.iter().map(|(row, _)| *row).collect();
    prescription.positions = Some(Positions { gaps, columns: (0..6).map(column).collect() });
    prescription
}

fn groups(prescription: &Prescription) -> MovingGroups<'_> {
    MovingGroups::of(prescription).expect("in order").expect("positions")
}

#[test]
fn at_its_positions_the_lens_is_what_the_patent_states() {
    let prescription = zoom_lens();
    let groups = groups(&prescription);
    for (zoom, stated) in FOCAL_LENGTHS.into_iter().enumerate() {
        let travel = groups.position(zoom);
        let placed = travel.at(travel.start());
        let lens = Lens::at_d_line(&placed);
        let optics = FirstOrder::of(&lens).expect("focal");
        assert!((optics.focal_length / stated - 1.0).abs() < 1e-3, "{}", optics.focal_length);
        assert!((optics.back_focal_distance() - 66.21049).abs() < 0.03, "{}", optics.back_focal_distance());
        assert_eq!(placed.stated_focal_length, Some(stated));
        let stop = lens.stop_index().expect("a stop");
        let fnumber = optics.focal_length / EntrancePupil::of_surface(&lens, stop).diameter();
        assert!((fnumber - 2.88).abs() < 1e-12, "{fnumber}");
        // The stop that a real ray at f/2.88 meets is as wide at all three, 37.42 mm.
        let diameter = 2.0 * lens.surfaces[stop].semi_diameter;
        assert!((diameter / 37.42 - 1.0).abs() < 0.02, "{diameter}");
        // Focused near, the film still has the image.
        let lens = Lens::at_d_line(&travel.at(NEAR.recip()));
        let image = FirstOrder::of(&lens).expect("focal").image_distance(NEAR.recip());
        assert!((image - 66.21049).abs() < 0.03, "{stated} mm near: {image}");
    }
}

#[test]
fn a_focal_length_between_the_positions_is_exact_and_the_film_stays_in_focus() {
    let prescription = zoom_lens();
    let groups = groups(&prescription);
    // How far the film of a prescription is from the best image of a distant point, by exact rays.
    let off = |prescription: &Prescription| {
        let focus = Focus::new(&Lens::at_d_line(prescription)).expect("focal");
        prescription.nominal_film_distance.expect("stated")
            - focus.film_distance(f64::INFINITY).expect("focal")
    };
    let listed = [0, 1, 2].map(|zoom| off(&groups.position(zoom).at(0.0)));
    let (least, most) =
        (listed.iter().copied().fold(f64::INFINITY, f64::min), listed.iter().copied().fold(0.0, f64::max));
    let [short, long] = groups.focal_range();
    let mut random = Random::new(12);
    for _ in 0..60 {
        let focal_length = short * (long / short).powf(random.next());
        let travel = groups.zoomed(focal_length).expect("in range");
        let placed = travel.at(travel.start());
        let own = FirstOrder::of(&Lens::at_d_line(&placed)).expect("focal").focal_length;
        assert!((own / focal_length - 1.0).abs() < 1e-14, "{own} is not {focal_length}");
        let off = off(&placed);
        // A quarter of the depth of focus at f/2.88 for a circle of 0.03 mm.
        assert!(
            (least - 0.02..most + 0.02).contains(&off),
            "{focal_length}: {off}, at the positions {listed:?}"
        );
        // Near, too: the groups' way there is between the positions' ways.
        let [_, near] = travel.range();
        let near = near / 1.1;
        let image = FirstOrder::of(&Lens::at_d_line(&travel.at(near))).expect("focal").image_distance(near);
        assert!(
            (image - placed.nominal_film_distance.expect("stated")).abs() < 0.1,
            "{focal_length}: near {image}"
        );
    }
}
