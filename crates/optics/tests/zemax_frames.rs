//! Coordinate breaks compared with OpticStudio's reports of the frames of all surfaces of a lens, in the table
//! `tests/golden/zemax_frames.csv`.

use realistic_optics::prescription::CoordinateBreak;

const TABLE: &str = include_str!("../../../tests/golden/zemax_frames.csv");

/// Returns the change of frame of six cells: decentre, tilts, and 1 for the tilts first.
fn change(cells: &[f64]) -> CoordinateBreak {
    let [x, y, a, b, c, tilts_first] = cells[..] else { panic!("{cells:?}") };
    CoordinateBreak::zemax([x, y], [a, b, c], tilts_first == 1.0)
}

#[test]
fn coordinate_breaks_lead_to_the_frames_of_opticstudio() {
    let mut before: Option<(&str, CoordinateBreak)> = None;
    let (mut steps, mut changes) = (0, 0);
    for line in TABLE.lines().skip(1) {
        let mut cells = line.split(',');
        let [report, surface] = [cells.next(), cells.next()].map(|cell| cell.expect("a cell"));
        let cells: Vec<f64> = cells.map(|cell| cell.parse().expect("a number")).collect();
        let (step, frame) = cells.split_at(13);
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| frame[3 * i + j]));
        let stated = CoordinateBreak { rotation, shift: [frame[9], frame[10], frame[11]] };
        if let Some((_, before)) = before.filter(|(own, _)| *own == report) {
            let gap = CoordinateBreak::shifted([0.0, 0.0, step[0]]);
            let own = before.then(&change(&step[1..7])).then(&gap).then(&change(&step[7..]));
            let numbers = |frame: &CoordinateBreak| [frame.rotation.as_flattened(), &frame.shift].concat();
            for (own, stated) in numbers(&own).iter().zip(numbers(&stated)) {
                assert!((own - stated).abs() < 1e-6, "{report}, surface {surface}: {own} {stated}");
            }
            steps += 1;
            changes += usize::from(step[1..].iter().any(|cell| *cell != 0.0));
        }
        before = Some((report, stated));
    }
    assert_eq!((steps, changes), (182, 88), "steps, and those with a change of frame");
}
