//! Places names beside their marks, so that they overlap no other names and no marks.

/// A rectangle on the page: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left and top.
    pub from: [f64; 2],
    /// Right and bottom.
    pub to: [f64; 2],
}

impl Area {
    /// Makes an area about a centre.
    pub fn about([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        Self { from: [x - width / 2.0, y - height / 2.0], to: [x + width / 2.0, y + height / 2.0] }
    }

    /// Returns the centre.
    pub fn center(&self) -> [f64; 2] {
        [0, 1].map(|i| f64::midpoint(self.from[i], self.to[i]))
    }

    /// Returns the overlap of two rectangles, in square pixels.
    pub fn overlap(&self, other: &Self) -> f64 {
        let side = |i: usize| (self.to[i].min(other.to[i]) - self.from[i].max(other.from[i])).max(0.0);
        side(0) * side(1)
    }

    /// Returns the point of this area nearest to the given point.
    pub fn nearest(&self, point: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| point[i].clamp(self.from[i], self.to[i]))
    }

    fn outside(&self, frame: &Self) -> f64 {
        let area = (self.to[0] - self.from[0]) * (self.to[1] - self.from[1]);
        area - self.overlap(frame)
    }
}

/// Distances from a mark that the search tries, pixels.
const RINGS: [f64; 11] = [8.0, 14.0, 22.0, 34.0, 48.0, 64.0, 84.0, 110.0, 140.0, 175.0, 215.0];
/// Directions that the search tries, to the right first.
const TURNS: u32 = 24;

/// Returns small areas along the line from a mark to its name, without the part within the mark.
fn leader(mark: [f64; 2], area: &Area) -> Vec<Area> {
    let end = area.nearest(mark);
    let steps = ((end[0] - mark[0]).hypot(end[1] - mark[1]) / 3.0) as usize;
    let at = |step: usize| [0, 1].map(|i| mark[i] + (end[i] - mark[i]) * step as f64 / steps as f64);
    (4..steps).map(|step| Area::about(at(step), [2.0, 2.0])).collect()
}

/// Returns the areas of names with `sizes` for `marks`, inside `frame` and clear of `obstacles`. Each name in turn
/// gets the nearest free area. If there is room, no name crosses the line between another name and its mark.
pub fn beside(marks: &[[f64; 2]], sizes: &[[f64; 2]], frame: Area, obstacles: &[Area]) -> Vec<Area> {
    let mut taken = obstacles.to_vec();
    let mut lines: Vec<Area> = Vec::new();
    let mut areas = Vec::new();
    for (mark, size) in marks.iter().zip(sizes) {
        let candidates =
            RINGS.iter().flat_map(|ring| (0..TURNS).map(move |turn| (ring, turn))).map(|(ring, turn)| {
                // The turns are 0, -1, 1, -2, 2, ...: to the right first, then farther and farther to either side.
                let turn = if turn % 2 == 0 { f64::from(turn / 2) } else { -f64::from(turn / 2 + 1) };
                let (sin, cos) = (turn * std::f64::consts::TAU / f64::from(TURNS)).sin_cos();
                let side = |i: usize, part: f64| mark[i] + part * (ring + size[i] / 2.0);
                Area::about([side(0, cos), side(1, sin)], *size)
            });
        let cost = |area: &Area| {
            let names = areas
                .iter()
                .flat_map(|name: &Area| leader(*mark, area).into_iter().map(|dot| dot.overlap(name)));
            let texts: f64 = taken.iter().map(|other| area.overlap(other)).sum();
            let crossed: f64 = lines.iter().map(|line| area.overlap(line)).chain(names).sum();
            // If not all conditions can hold, a line across a name is better than two names on top of each other.
            100.0 * (area.outside(&frame) + texts) + crossed
        };
        let mut best = (f64::INFINITY, Area::about(*mark, *size));
        for area in candidates {
            let cost = cost(&area);
            if cost < best.0 {
                best = (cost, area);
            }
            if cost <= 0.0 {
                break;
            }
        }
        lines.extend(leader(*mark, &best.1));
        taken.push(best.1);
        areas.push(best.1);
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_names_about_one_point_are_all_readable() {
        let frame = Area { from: [0.0, 0.0], to: [600.0, 400.0] };
        let marks: Vec<_> =
            (0..20).map(|i| [300.0 + f64::from(i % 5) * 9.0, 200.0 + f64::from(i / 5) * 7.0]).collect();
        let obstacles: Vec<_> = marks.iter().map(|mark| Area::about(*mark, [8.0, 8.0])).collect();
        let areas = beside(&marks, &[[80.0, 16.0]; 20], frame, &obstacles);
        for (i, area) in areas.iter().enumerate() {
            assert!(area.outside(&frame) < 1e-9, "{area:?}");
            assert!(obstacles.iter().all(|mark| area.overlap(mark) < 1e-9), "{area:?}");
            assert!(areas[..i].iter().all(|other| area.overlap(other) < 1e-9), "{area:?}");
        }
    }

    #[test]
    fn a_lone_name_is_on_the_right_and_turns_inward_at_the_frame() {
        let frame = Area { from: [0.0, 0.0], to: [200.0, 100.0] };
        let lone = |mark| beside(&[mark], &[[60.0, 14.0]], frame, &[Area::about(mark, [6.0, 6.0])])[0];
        assert_eq!(lone([50.0, 50.0]).center()[1], 50.0);
        assert!(lone([50.0, 50.0]).from[0] >= 55.0);
        assert!(lone([190.0, 50.0]).to[0] <= 200.0);
    }
}
