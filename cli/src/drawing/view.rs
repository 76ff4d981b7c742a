//! A map from a window of lens space in millimetres to a part of the page, at the same scale in both directions.

/// A part of the page, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Left edge.
    pub left: f64,
    /// Top edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// A window in mm, shown in a frame. The first coordinate grows to the right of the page, the second upward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Frame on the page.
    pub frame: Frame,
    /// Range shown of the first coordinate, mm.
    pub across: [f64; 2],
    /// Range shown of the second coordinate, mm.
    pub up: [f64; 2],
    /// Pixels per mm.
    pub scale: f64,
}

impl View {
    /// Fits `across` to a frame with this corner and width. The frame is high enough to show `up`, but at least `least`
    /// and at most `most` pixels; extra room in either direction is divided between both sides.
    pub fn fit(
        [left, top]: [f64; 2],
        width: f64,
        [least, most]: [f64; 2],
        across: [f64; 2],
        up: [f64; 2],
    ) -> Self {
        let scale = (width / (across[1] - across[0])).min(most / (up[1] - up[0]));
        let height = (scale * (up[1] - up[0])).max(least);
        let widened = |[low, high]: [f64; 2], pixels: f64| {
            let spare = (pixels / scale - (high - low)) / 2.0;
            [low - spare, high + spare]
        };
        Self {
            frame: Frame { left, top, width, height },
            across: widened(across, width),
            up: widened(up, height),
            scale,
        }
    }

    /// Returns the page's point.
    pub fn at(&self, [across, up]: [f64; 2]) -> [f64; 2] {
        [
            self.frame.left + (across - self.across[0]) * self.scale,
            self.frame.top + (self.up[1] - up) * self.scale,
        ]
    }

    /// Returns the distance from `from` along `direction` to the window's edge, in lengths of `direction`; 0 if
    /// `from` is outside.
    pub fn distance_to_edge(&self, from: [f64; 2], direction: [f64; 2]) -> f64 {
        let windows = [self.across, self.up];
        let distances = (0..2).filter(|&i| direction[i] != 0.0).map(|i| {
            let edge = if direction[i] > 0.0 { windows[i][1] } else { windows[i][0] };
            (edge - from[i]) / direction[i]
        });
        distances.fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// Returns the largest length, in mm, that is 1, 2 or 5 times a power of ten and occupies at most `pixels`.
    pub fn round_length(&self, pixels: f64) -> f64 {
        let length = pixels / self.scale;
        let power = 10.0_f64.powf(length.log10().floor());
        // Rounding must not turn a length just below a power of ten into 10 times the power below.
        power * [5.0, 2.0, 1.0].into_iter().find(|step| step * power <= length).unwrap_or(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View::fit([50.0, 20.0], 1000.0, [200.0, 600.0], [-10.0, 90.0], [-20.0, 20.0])
    }

    #[test]
    fn the_scale_is_one_and_the_window_fills_the_frame() {
        let view = view();
        assert_eq!((view.scale, view.frame.height), (10.0, 400.0));
        assert_eq!(view.at([-10.0, 20.0]), [50.0, 20.0]);
        assert_eq!(view.at([90.0, -20.0]), [1050.0, 420.0]);
        let tall = View::fit([0.0, 0.0], 1000.0, [200.0, 600.0], [0.0, 1.0], [-30.0, 30.0]);
        assert_eq!((tall.scale, tall.across), (10.0, [-49.5, 50.5]));
    }

    #[test]
    fn lines_end_at_the_windows_edge() {
        assert_eq!(view().distance_to_edge([0.0, 0.0], [-1.0, 0.5]), 10.0);
        assert_eq!(view().distance_to_edge([0.0, 0.0], [0.0, 4.0]), 5.0);
        assert_eq!(view().distance_to_edge([-11.0, 0.0], [-1.0, 0.0]), 0.0);
    }

    #[test]
    fn scale_bars_are_round() {
        assert_eq!(view().round_length(150.0), 10.0);
        assert_eq!(view().round_length(60.0), 5.0);
        assert!((view().round_length(3.9) - 0.2).abs() < 1e-15);
    }
}
