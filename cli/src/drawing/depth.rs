//! The depth of field as a range of distances from the film, on a logarithmic scale.

use super::axis::LogScale;
use super::labels::spread;
use super::shapes::{Anchor, Page, SMALL, Stroke, text_width};
use super::{COLORS, FAINT, INK};
use realistic_base::message::fixed;
use realistic_optics::imaging::focus::DepthOfField;

/// Data of the drawing. Distances are in mm from the film, and all but `nearest` may be infinite.
#[derive(Clone, Debug)]
pub struct DepthDrawing {
    /// The title.
    pub title: String,
    /// The plane in focus.
    pub focus: f64,
    /// The nearest plane that can be focused.
    pub nearest: f64,
    /// The depth of field.
    pub depth: DepthOfField,
    /// The circle of confusion, mm.
    pub confusion: f64,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 40.0;
/// End of the logarithmic scale; infinity is drawn near the page's edge.
const RIGHT: f64 = 780.0;
const INFINITY_AT: f64 = 850.0;
const SCALE_AT: f64 = 200.0;
const BAR_AT: f64 = 150.0;
/// Baseline of the texts above the bar.
const NAMES_AT: f64 = 96.0;

/// Draws the depth of field.
pub fn draw(drawing: &DepthDrawing) -> Page {
    let DepthOfField { near, far, hyperfocal } = drawing.depth;
    let marks = [
        ("nearest focus", drawing.nearest, FAINT),
        ("near limit", near, COLORS[0]),
        ("in focus", drawing.focus, COLORS[2]),
        ("far limit", far, COLORS[0]),
        ("hyperfocal", hyperfocal, COLORS[1]),
    ];
    let finite =
        || marks.iter().map(|mark| mark.1).filter(|distance| distance.is_finite() && *distance > 0.0);
    let low = finite().fold(f64::MAX, f64::min) / 1.25;
    let high = finite().fold(f64::MIN_POSITIVE, f64::max) * 1.25;
    let scale = LogScale { range: [low, high], pixels: [LEFT, RIGHT] };
    let at = |distance: f64| {
        if distance.is_finite() { scale.position(distance) } else { INFINITY_AT }
    };
    let mut page = Page::new(WIDTH, HEIGHT);
    page.title(&drawing.title, LEFT, WIDTH - 2.0 * LEFT);
    page.line([[at(near), BAR_AT], [at(far), BAR_AT]], Stroke::new(COLORS[0], 16.0));
    page.line([[LEFT, SCALE_AT], [RIGHT, SCALE_AT]], Stroke::new(INK, 1.0));
    page.line([[RIGHT, SCALE_AT], [INFINITY_AT, SCALE_AT]], Stroke::new(INK, 1.0).dashed("3 5"));
    for (distance, name) in ticks(&scale) {
        page.line([[at(distance), SCALE_AT], [at(distance), SCALE_AT + 7.0]], Stroke::new(INK, 1.0));
        page.text(&name, [at(distance), SCALE_AT + 26.0], SMALL, Anchor::Middle, INK);
    }
    page.text("infinity", [INFINITY_AT, SCALE_AT + 26.0], SMALL, Anchor::Middle, INK);
    let mut sorted = marks;
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let names = sorted.map(|(name, distance, _)| format!("{name} {}", metres(distance)));
    let anchors = sorted.map(|(_, distance, _)| at(distance));
    let widths = [0, 1, 2, 3, 4].map(|i| text_width(&names[i], SMALL));
    let positions = spread(&anchors, &widths, [LEFT / 2.0, WIDTH - LEFT / 2.0]);
    for (i, (_, _, color)) in sorted.iter().enumerate() {
        let stroke = Stroke::new(color, 1.5);
        page.line(
            [[positions[i], NAMES_AT + 8.0], [anchors[i], BAR_AT - 20.0], [anchors[i], SCALE_AT]],
            stroke,
        );
        page.text(&names[i], [positions[i], NAMES_AT], SMALL, Anchor::Middle, INK);
    }
    let confusion = drawing.confusion;
    let foot =
        format!("sharp: blurred on film to at most {} mm; distances from the film", fixed(confusion, 4));
    page.text(&foot, [LEFT, HEIGHT - 26.0], SMALL, Anchor::Start, INK);
    page
}

/// Returns round distances in the scale's range with their names: at 1, 2 and 5 in each decade, or only at 1 if there
/// is no room for more.
fn ticks(scale: &LogScale) -> impl Iterator<Item = (f64, String)> {
    const ROOM: f64 = 40.0;
    let labelled = scale.ticks(ROOM).into_iter().filter(|tick| tick.label.is_some());
    labelled.map(|tick| (tick.value, metres(tick.value)))
}

fn metres(distance: f64) -> String {
    if !distance.is_finite() {
        return "infinity".to_owned();
    }
    let metres = distance / 1e3;
    // Three significant digits, without trailing zeros.
    let digits = (2 - metres.log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{metres:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} m")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_is_drawn_with_its_limits_and_infinity_has_a_position() {
        let depth = DepthOfField { near: 960.1, far: f64::INFINITY, hyperfocal: 20257.3 };
        let drawing =
            DepthDrawing { title: "t".to_owned(), focus: 1000.0, nearest: 197.0, depth, confusion: 0.06 };
        let picture = draw(&drawing).to_string();
        for text in ["near limit 0.96 m", "in focus 1 m", "far limit infinity", "hyperfocal 20.3 m", "0.06"] {
            assert!(picture.contains(text), "{text}: {picture}");
        }
        assert!(!picture.contains("NaN"));
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let ticks =
            |low, high| ticks(&LogScale { range: [low, high], pixels: [LEFT, RIGHT] }).collect::<Vec<_>>();
        let names: Vec<String> = ticks(450.0, 6000.0).into_iter().map(|(_, name)| name).collect();
        assert_eq!(names, ["0.5 m", "1 m", "2 m", "5 m"]);
        assert!(ticks(100.0, 1e8).iter().all(|(distance, _)| distance.log10().fract() == 0.0));
    }
}
