//! Tests with two thin lenses in air, for which closed formulas exist: f = f1 f2/(f1 + f2 - d), back focus f (f1 -
//! d)/f1 (E. Hecht, *Optics*, §6.1).

use super::super::axial_beam::AxialBeam;
use super::*;
use crate::prescription::{Interface, Medium, Position, Shape, read};

/// Returns the two surfaces of a thin lens.
fn thin(focal_length: f64) -> [Interface; 2] {
    let glass = Medium::Glass { n_d: 1.5, abbe: None };
    // Surfaces this narrow touch; wider surfaces would cross.
    let surface = |radius: f64, medium| Interface::new(Shape::Sphere { radius }, 0.0, medium, 0.2);
    // (n - 1)(1/R + 1/R) = 1/f.
    [surface(focal_length, glass), surface(-focal_length, Medium::Air)]
}

const F: [f64; 2] = [-90.0, 60.0];

/// Returns the focal length and back focus of the two lenses at a distance of `gap` between them.
fn known(gap: f64) -> [f64; 2] {
    let focal_length = F[0] * F[1] / (F[0] + F[1] - gap);
    [focal_length, focal_length * (F[0] - gap) / F[0]]
}

/// Returns the two lenses with a position for each of `gaps`, whose film distance is the true back focus. If `near` is
/// not empty, adds positions with the gaps `near` for objects at 500 mm, with the film unmoved.
fn zoom(gaps: &[f64], near: &[f64]) -> Prescription {
    let plane = Interface { shape: Shape::Plane, ..thin(F[0])[1].clone() };
    let stop = Interface { semi_diameter: 8.0, is_stop: true, ..plane.clone() };
    let interfaces: Vec<Interface> = thin(F[0]).into_iter().chain([stop]).chain(thin(F[1])).collect();
    let column = |gap: f64, film: f64, object_distance: Option<f64>| Position {
        name: Some(format!("at {gap}")),
        gaps: vec![gap, film],
        fnumber: Some(1000.0),
        object_distance,
        ..Position::default()
    };
    let columns = gaps.iter().map(|&gap| column(gap, known(gap)[1], None));
    let near = gaps.iter().zip(near).map(|(&gap, &near)| column(near, known(gap)[1], Some(500.0)));
    Prescription {
        name: "two".to_owned(),
        positions: Some(Positions { gaps: vec![1, 4], columns: columns.chain(near).collect() }),
        ..Prescription::new(interfaces)
    }
}

const GAPS: [f64; 4] = [40.0, 22.0, 10.0, 2.0];

fn optics(prescription: &Prescription) -> FirstOrder {
    FirstOrder::of(&Lens::at_d_line(prescription)).expect("focal")
}

/// Returns the image distance of a point by first-order optics.
fn image(prescription: &Prescription, vergence: f64) -> Option<f64> {
    Some(optics(prescription).image_distance(vergence))
}

fn groups(prescription: &Prescription) -> MovingGroups<'_> {
    MovingGroups::of(prescription).expect("positions")
}

#[test]
fn focal_lengths_between_positions_are_exact_to_rounding() {
    for gaps in [GAPS.to_vec(), GAPS.iter().rev().copied().collect(), vec![GAPS[0], GAPS[3]]] {
        let prescription = zoom(&gaps, &[]);
        let groups = groups(&prescription);
        let [short, long] = groups.focal_range();
        assert!((short - known(40.0)[0]).abs() < 1e-12 && (long - known(2.0)[0]).abs() < 1e-12);
        for i in 0..=500 {
            let focal_length = short + (long - short) * f64::from(i) / 500.0;
            let zoomed = groups.zoomed(focal_length.min(long), image).expect("in range");
            let lens = zoomed.at(zoomed.start());
            assert!((optics(&lens).focal_length / focal_length - 1.0).abs() < 1e-14, "{focal_length}");
            // The focal length determines the single gap of this lens, and the gap determines the film distance.
            let gap = F[0] + F[1] - F[0] * F[1] / focal_length;
            assert!((lens.interfaces[1].thickness - gap).abs() < 1e-11, "{focal_length}");
            let film = lens.nominal_film_distance.expect("stated");
            assert!((film - known(gap)[1]).abs() < 1e-10, "{focal_length}: {film}");
        }
    }
}

#[test]
fn at_its_positions_a_lens_has_their_numbers_to_the_last_bit() {
    let prescription = zoom(&GAPS, &[39.0, 21.5, 9.9, 1.7]);
    let groups = groups(&prescription);
    let columns = &prescription.positions.as_ref().expect("positions").columns;
    for (zoom, gap) in GAPS.into_iter().enumerate() {
        let named = groups.named(&format!("at {gap}")).expect("listed");
        for step in 0..2 {
            let column = &columns[groups.layout.column(zoom, step)];
            let lens = named.at(column.vergence());
            assert_eq!(lens.interfaces[1].thickness, column.gaps[0]);
            assert_eq!(lens.nominal_film_distance, Some(column.gaps[1]));
        }
        let lens = named.at(named.start());
        let beam = AxialBeam::of(&Lens::at_d_line(&lens));
        assert!((beam.fnumber(optics(&lens).focal_length) / 1000.0 - 1.0).abs() < 1e-12, "{beam:?}");
    }
    let first = groups.position(0);
    assert_eq!(first.at(first.start()).interfaces[1].thickness, GAPS[0]);
}

#[test]
fn nothing_jumps_as_the_lens_zooms_or_focuses() {
    let prescription = zoom(&GAPS, &[39.0, 21.5, 9.9, 1.7]);
    let groups = groups(&prescription);
    let numbers = |focal_length: f64, share: f64| {
        let travel = groups.zoomed(focal_length, image).expect("in range");
        let [far, near] = travel.range();
        let lens = travel.at(far + (near - far) * share);
        let film = lens.nominal_film_distance.expect("stated");
        [lens.interfaces[1].thickness, film, lens.interfaces[2].semi_diameter]
    };
    const STEP: f64 = 1e-5;
    // The slopes from the left and from the right agree at the inner positions, where segments meet, and elsewhere.
    for gap in [22.0, 10.0, 15.0, 30.0] {
        let at = known(gap)[0];
        for share in [0.0, 0.3, 1.0] {
            let [left, middle, right] = [-STEP, 0.0, STEP].map(|off| numbers(at * (1.0 + off), share));
            for i in 0..3 {
                let slopes = [middle[i] - left[i], right[i] - middle[i]].map(|rise| rise / STEP);
                assert!((slopes[0] - slopes[1]).abs() < 0.02, "{gap} {share} {i}: {slopes:?}");
            }
        }
    }
}

#[test]
fn groups_pass_their_ends_a_little_and_never_collide() {
    let prescription = zoom(&[40.0, 2.0], &[39.0, 0.05]);
    let groups = groups(&prescription);
    let range = groups.position(0).range();
    assert!((range[0] + 0.1 / 500.0).abs() < 1e-15 && (range[1] - 1.1 / 500.0).abs() < 1e-15, "{range:?}");
    // The gap closes by 1.95 mm up to the listed position, and by 0.05 mm more until the lenses touch.
    let close = groups.named("at 2").expect("listed");
    let [_, near] = close.range();
    assert!((near * 500.0 - 2.0 / 1.95).abs() < 1e-12, "{near}");
    let touching = close.at(near).interfaces[1].thickness;
    assert!((0.0..1e-12).contains(&touching));
}

#[test]
fn a_zoom_out_of_range_is_refused_with_the_range() {
    let prescription = zoom(&GAPS, &[]);
    let groups = groups(&prescription);
    let [short, long] = groups.focal_range();
    for off in [short * 0.999, long * 1.001, 1e300] {
        let refused = groups.zoomed(off, image).expect_err("out of range").to_string();
        assert!(refused.contains("zooms from 77.1429 to 168.75 mm"), "{refused}");
    }
    let refused = groups.named("at 3").expect_err("no position").to_string();
    assert!(
        refused.contains("from 77.1429 to 168.75 mm") && refused.contains("\"at 40\", \"at 22\""),
        "{refused}"
    );
    let prime = zoom(&GAPS[..1], &GAPS[1..2]);
    let prime = MovingGroups::of(&prime).expect("positions");
    for refused in [prime.zoomed(100.0, image), prime.named("at 40")] {
        assert!(refused.expect_err("a prime").to_string().contains("one focal length"));
    }
    // The focal lengths are not monotonic: the gap of 10 mm stands between the wider gaps of 40 mm and 22 mm.
    let wandering = zoom(&[40.0, 10.0, 22.0], &[]);
    let wandering = MovingGroups::of(&wandering).expect("positions");
    let refused = wandering.zoomed(100.0, image).expect_err("ambiguous").to_string();
    assert!(refused.contains("do not rise or fall") && refused.contains("\"at 10\""), "{refused}");
    assert!(wandering.named("at 22").is_ok());
}

#[test]
fn a_focal_length_rounded_outward_is_that_of_its_position() {
    let mut prescription = zoom(&GAPS, &[]);
    let columns = &mut prescription.positions.as_mut().expect("positions").columns;
    columns[0].focal_length = Some(77.0);
    // This differs too much from the computed focal length to be accepted.
    columns[3].focal_length = Some(200.0);
    let groups = groups(&prescription);
    assert_eq!(groups.focal_range()[0], 77.0);
    let widest = groups.zoomed(77.0, image).expect("stated");
    assert_eq!(widest.at(widest.start()).interfaces[1].thickness, 40.0);
    assert!(groups.zoomed(199.0, image).is_err() && groups.zoomed(76.9, image).is_err());
}

/// Two lenses with a flare stop between them. At the second position the flare stop lies within the sagitta of the
/// first lens.
const BULGE: &str = "positions a b\ngap 3 2 -0.5\nfilm 40 41\n50 4 1.5 20\n-50 3 1 20\nflare 2 1 18\n40 3 1.6 20\n-80 40 1 20\n\
    stop 1\n";

#[test]
fn a_negative_gap_beside_a_flare_stop_stays_what_it_is() {
    let lens = read("bulge", BULGE.as_bytes()).expect("a lens");
    let groups = groups(&lens);
    let travel = groups.named("b").expect("listed");
    let placed = travel.at(travel.start());
    assert_eq!(placed.interfaces[2].thickness, -0.5);
    // Computed by an independent paraxial trace, for the same lens with a single position.
    let found = optics(&placed);
    assert!((found.focal_length - 24.968_211_046).abs() < 1e-9, "{found:?}");
    assert!((found.back_focal_distance() - 21.497_941_813).abs() < 1e-9, "{found:?}");
    // A focal length between the two positions.
    let ends = groups.focal_range();
    let between = groups.zoomed(f64::midpoint(ends[0], ends[1]), image).expect("in range");
    assert!((-0.5..2.0).contains(&between.at(between.start()).interfaces[2].thickness));
}

#[test]
fn groups_with_a_negative_gap_stop_where_lenses_touch() {
    let near = BULGE.replace("film 40 41", "film 40 40\nobject inf 500");
    let ends = |gaps: &str| {
        let lens = read("bulge", near.replace("gap 3 2 -0.5", gaps).as_bytes()).expect("a lens");
        let travel = groups(&lens).position(0);
        travel.range().map(|vergence| (500.0 * vergence, travel.at(vergence)))
    };
    // The lenses approach from 5 mm to 0.1 mm apart. The last 0.1 mm extends this travel of 4.9 mm.
    let [(far, _), (close, touching)] = ends("gap 2 3 0.6\ngap 3 2 -0.5");
    assert!((far + 0.1).abs() < 1e-12 && (close - 5.0 / 4.9).abs() < 1e-12, "{far} {close}");
    assert!((touching.interfaces[1].thickness + touching.interfaces[2].thickness).abs() < 1e-12);
    // Here the lenses stay apart, and the flare stop limits nothing.
    let [_, (close, inside)] = ends("gap 3 2 -0.5");
    assert!((close - 1.1).abs() < 1e-12 && (inside.interfaces[2].thickness + 0.75).abs() < 1e-12, "{close}");
}
