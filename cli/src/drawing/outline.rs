//! The outline of a film point's pupil, with the disks in which samples are taken.

use super::COLORS;
use super::shapes::{AXIS, Page, Stroke};
use super::view::View;
use realistic_base::message::fixed;

/// Data of the drawing, in mm in the plane through the rear vertex.
#[derive(Clone, Debug)]
pub struct PupilDrawing<'a> {
    /// The title.
    pub title: String,
    /// Points of the outline; empty for an empty pupil.
    pub edge: &'a [[f64; 2]],
    /// Images of lines of the unit disk under the map of lens samples.
    pub map: &'a [Vec<[f64; 2]>],
    /// Name, centre and radius of each disk.
    pub disks: [(&'static str, [f64; 2], f64); 2],
}

const WIDTH: f64 = 800.0;
const MARGIN: f64 = 40.0;
const HEAD: f64 = 70.0;
const FOOT: f64 = 80.0;

/// Draws the outline as seen from the film: x grows to the right, y upward.
pub fn draw(drawing: &PupilDrawing<'_>) -> Page {
    let reach = |axis: usize| {
        let disks = drawing.disks.iter().flat_map(|(_, center, radius)| {
            [center[axis] - radius, center[axis] + radius].into_iter().filter(|x| x.is_finite())
        });
        let all = disks.chain(drawing.edge.iter().map(|point| point[axis])).chain([0.0]);
        let (low, high) = all.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        let spare = 0.05 * (high - low);
        [low - spare, high + spare]
    };
    let view = View::fit([MARGIN, HEAD], WIDTH - 2.0 * MARGIN, [200.0, 700.0], reach(0), reach(1));
    let mut page = Page::new(WIDTH, HEAD + view.frame.height + FOOT);
    page.title(&drawing.title, MARGIN, WIDTH - 2.0 * MARGIN);
    let [[left, right], [low, high]] = [view.across, view.up];
    page.line([view.at([left, 0.0]), view.at([right, 0.0])], AXIS);
    page.line([view.at([0.0, low]), view.at([0.0, high])], AXIS);
    if !drawing.edge.is_empty() {
        page.area(drawing.edge.iter().map(|&point| view.at(point)), "#d6e6f2", Stroke::new(COLORS[0], 2.0));
    }
    for line in drawing.map {
        page.line(line.iter().map(|&point| view.at(point)), Stroke::new(COLORS[0], 0.7));
    }
    let y = HEAD + view.frame.height + FOOT - 26.0;
    let length = view.round_length(140.0);
    page.scale_bar([MARGIN, y], length * view.scale, length);
    let pupil = if drawing.edge.is_empty() { "no light gets through" } else { "the pupil" };
    let mut legend = vec![(pupil.to_owned(), Stroke::new(COLORS[0], 2.0))];
    let strokes = [Stroke::new(COLORS[2], 1.5).dashed("8 4"), Stroke::new(COLORS[1], 1.5).dashed("3 3")];
    for ((name, center, radius), stroke) in drawing.disks.iter().zip(strokes) {
        if center.iter().chain([radius]).all(|x| x.is_finite()) {
            page.circle(view.at(*center), radius * view.scale, "none", stroke);
        }
        legend.push((format!("{name}: {} mm", fixed(*radius, 2)), stroke));
    }
    page.legend([MARGIN + 190.0, y], legend);
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pupil_is_drawn_to_scale_and_an_empty_one_is_stated() {
        let edge = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let disks = [("rear", [0.0, 0.0], 2.0), ("disk", [0.5, 0.0], 1.0)];
        let map = [vec![[0.0, 0.0], [1.0, 0.0]]];
        let full = draw(&PupilDrawing { title: "t".to_owned(), edge: &edge, map: &map, disks }).to_string();
        assert!(full.contains("the pupil") && full.contains("rear: 2.00 mm"));
        assert_eq!(full.matches("stroke-width=\"0.7\"").count(), 1);
        // 4 mm with a margin of a tenth fill the 700 pixels of the frame's height, which gives the radii of the disks
        // in pixels.
        let scale = 700.0 / 4.4;
        for radius in [2.0 * scale, scale] {
            let circle = format!("r=\"{radius}");
            assert!(full.contains(&circle[..7]), "{circle}: {full}");
        }
        let empty = draw(&PupilDrawing { title: "t".to_owned(), edge: &[], map: &[], disks }).to_string();
        assert!(empty.contains("no light gets through"));
    }
}
