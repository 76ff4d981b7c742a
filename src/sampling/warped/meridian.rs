//! The innermost ray of a film point's pupil: a guess on the meridian, the plane of axis and film point, in; the slope that
//! is farthest inside every aperture out.

use super::view::{Excess, GROUP, View};

/// How far around a guess for a pupil about so wide, within reach, a search looks first: film close behind a lens sees
/// the rear element much larger than the pupil.
pub(crate) fn first_look(reach: f64, width: f64) -> f64 {
    (0.02 * reach).min(0.25 * width)
}

impl View<'_> {
    /// The slope sx on the meridian that is farthest inside the pupil, sought from `guess`, first as far as `width` from it,
    /// and within `reach` where there is nothing to go by; and its excess: where that is positive, the pupil is empty. With
    /// `any` the search ends at the first slope inside.
    pub fn innermost(&self, guess: f64, width: f64, reach: f64, any: bool) -> (f64, f64) {
        let near = self.descended(None, guess, width, reach, any);
        if near.1 < f64::INFINITY {
            return near;
        }
        // Nothing to descend along.
        let near = self.scanned(guess, width, any);
        if near.1 < f64::INFINITY { near } else { self.scanned(guess, reach, any) }
    }

    /// The same after a coarse scan.
    pub fn scanned(&self, guess: f64, reach: f64, any: bool) -> (f64, f64) {
        const GRID: u32 = 24;
        let width = 2.0 * reach / f64::from(GRID);
        let grid: Vec<_> = (0..=GRID).map(|i| guess - reach + width * f64::from(i)).collect();
        let least = self.least_of(&grid);
        self.descended(Some(least), least.slope, width, reach, any)
    }

    /// Where on the meridian a descent of the excess ends, and the excess there: at the least one as far as that matters,
    /// which is for the sign with `any`, else to a thousandth; at once where nothing has an excess. It begins with looks
    /// around `middle`; `best` is one that is known already.
    fn descended(
        &self,
        mut best: Option<Look>,
        mut middle: f64,
        mut width: f64,
        reach: f64,
        any: bool,
    ) -> (f64, f64) {
        /// As many as a packet takes: where the middle is known, and where it is not.
        const BESIDE: [f64; GROUP] = [-1.0, -0.6, -0.3, -0.1, 0.1, 0.3, 0.6, 1.0];
        const AROUND: [f64; GROUP] = [-1.0, -0.5, -0.2, 0.0, 0.1, 0.3, 0.6, 1.0];
        /// How much narrower the next looks are around where the last ones expect the least.
        const NARROWER: f64 = 1.0 / 32.0;
        let enough = if any { 0.5 } else { 1e-3 };
        let mut is_expected = false;
        let mut found = Vec::with_capacity(GROUP);
        let mut looks: Vec<Look> = Vec::with_capacity(GROUP + 1);
        loop {
            let is_known = best.is_some_and(|best| best.slope == middle);
            let slopes = if is_known { BESIDE } else { AROUND }.map(|place| middle + place * width);
            self.excesses(&slopes.map(|slope| [slope, 0.0]), &mut found);
            looks.clear();
            looks.extend(slopes.iter().zip(&found).map(|(&slope, &excess)| Look { slope, excess }));
            if let Some(best) = best {
                let place = looks.iter().take_while(|look| look.slope < best.slope).count();
                looks.insert(place, best);
            }
            let less = |a: usize, b: usize| if looks[b].excess.value < looks[a].excess.value { b } else { a };
            let least = (0..looks.len()).reduce(less).expect("some looks");
            let own = looks[least];
            best = Some(own);
            let is_enough = own.excess.value == f64::INFINITY || any && own.excess.value < 0.0;
            if is_enough || width <= 1e-9 * reach || self.tracer.is_spent() {
                return (own.slope, own.excess.value);
            }
            if least == 0 || least + 1 == looks.len() {
                (middle, width, is_expected) = (own.slope, 4.0 * width, false);
                continue;
            }
            let around = &looks[least.saturating_sub(2)..(least + 3).min(looks.len())];
            if around.iter().any(|look| look.excess.lost) {
                // The excess jumps.
                is_expected = false;
                let falls_from =
                    [least - 1, least + 1].into_iter().find(|&beside| own.is_nearer(looks[beside]));
                let Some(beside) = falls_from else {
                    (middle, width) = (own.slope, 0.25 * width);
                    continue;
                };
                // It falls toward the aperture's edge, and jumps before the next look.
                let steepness = own.steepness(looks[beside]);
                let gap = looks[2 * least - beside].slope - own.slope;
                let to_edge = -own.excess.value / steepness;
                if to_edge.abs() < gap.abs() {
                    (middle, width) = (own.slope + to_edge, NARROWER * width);
                } else if (steepness * gap).abs() < enough * own.excess.value {
                    return (own.slope, own.excess.value);
                } else {
                    (middle, width) = (own.slope + gap / 2.0, 0.45 * gap.abs());
                }
                continue;
            }
            let bottom = Bottom::of(&looks, least);
            // The excess falls and then rises: it is no deeper than the neighbours are higher.
            let neighbours = looks[least - 1].excess.value.max(looks[least + 1].excess.value);
            let deepest = if is_expected { bottom.value } else { 2.0 * own.excess.value - neighbours };
            if own.excess.value - deepest < enough * own.excess.value.abs() {
                return (own.slope, own.excess.value);
            }
            (middle, width, is_expected) = (bottom.slope, NARROWER * width, true);
        }
    }

    /// Of some slopes on the meridian the one with the least excess.
    fn least_of(&self, slopes: &[f64]) -> Look {
        let pairs: Vec<_> = slopes.iter().map(|&slope| [slope, 0.0]).collect();
        let mut found = Vec::with_capacity(pairs.len());
        self.excesses(&pairs, &mut found);
        let looks = slopes.iter().zip(&found).map(|(&slope, &excess)| Look { slope, excess });
        let less = |best: Look, new: Look| if new.excess.value < best.excess.value { new } else { best };
        looks.reduce(less).expect("at least one")
    }
}

/// A look at a slope on the meridian.
#[derive(Clone, Copy, Debug)]
struct Look {
    slope: f64,
    excess: Excess,
}

impl Look {
    /// Whether this ray is nearer than another to the edge of an aperture that both are outside of, and both get lost.
    fn is_nearer(self, other: Self) -> bool {
        let [own, farther] = [self, other].map(|look| look.excess.value);
        let are_alike = self.excess.limit == other.excess.limit && self.excess.lost && other.excess.lost;
        are_alike && own > 0.0 && own < farther && farther < f64::INFINITY
    }

    fn steepness(self, other: Self) -> f64 {
        (self.excess.value - other.excess.value) / (self.slope - other.slope)
    }
}

/// Where a function that falls and then rises is expected to be least, from looks on both sides.
struct Bottom {
    slope: f64,
    value: f64,
}

impl Bottom {
    /// Next to the look of number `least`, which is neither the first nor the last.
    fn of(looks: &[Look], least: usize) -> Self {
        let [before, own, after] = [least - 1, least, least + 1].map(|i| looks[i]);
        if before.excess.limit == own.excess.limit && own.excess.limit == after.excess.limit {
            return Self::of_parabola([before, own, after]);
        }
        // Two limits, one falling and one rising, each about straight: their lines meet on one side of the least look or
        // on the other.
        let right = Self::of_lines([before, own], after, looks.get(least + 2));
        let left = Self::of_lines([after, own], before, least.checked_sub(2).map(|i| &looks[i]));
        if right.value < left.value { right } else { left }
    }

    fn of_parabola([a, b, c]: [Look; 3]) -> Self {
        let [left, right] = [b.slope - a.slope, c.slope - b.slope];
        let [down, up] = [b.steepness(a), c.steepness(b)];
        let bend = (up - down) / (left + right);
        let steepness = (down * right + up * left) / (left + right);
        let step = (-steepness / (2.0 * bend)).clamp(-left, right);
        Self { slope: b.slope + step, value: b.excess.value + step * (steepness + step * bend) }
    }

    /// Where the line through the first two meets that through `next` and the one after it; `next` itself where there is none.
    fn of_lines([first, second]: [Look; 2], next: Look, after: Option<&Look>) -> Self {
        let falling = second.steepness(first);
        let way = next.slope - second.slope;
        let part = after.map_or(1.0, |&after| {
            let rising = after.steepness(next);
            let step = (next.excess.value - second.excess.value - rising * way) / (falling - rising);
            (step / way).clamp(0.0, 1.0)
        });
        let step = part * way;
        Self { slope: second.slope + step, value: second.excess.value + step * falling }
    }
}
