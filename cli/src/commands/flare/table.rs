//! The table of a lamp's ghosts, sorted by watts.

use realistic_base::message::fixed;
use realistic_light::{LeftOut, Pair};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A ghost.
#[derive(Clone, Copy, Debug)]
pub struct Ghost {
    /// The two surfaces of the ghost, counted from 0 at the scene side.
    pub pair: Pair,
    /// Power that reaches the plane of the film, W per W/m² at the lens.
    pub watts: f64,
    /// Centre of the ghost on the film, mm.
    pub middle: [f64; 2],
    /// RMS distance from the centre, mm.
    pub radius: f64,
    /// Distance in front of the film, mm, at which light from infinity near the axis is in focus; `None` if it is in
    /// focus nowhere.
    pub focus: Option<f64>,
}

/// All ghosts, the brightest first.
#[derive(Clone, Debug)]
pub struct GhostTable {
    /// The ghosts.
    pub ghosts: Vec<Ghost>,
    /// Power that reaches the plane of the film without a reflection, W per W/m².
    pub direct: f64,
    /// Wavelength, nm.
    pub wavelength: f64,
    /// Power of light that is reflected four times or more in a stack of plates, as a multiple of the direct light.
    pub beyond: f64,
    /// Largest share of the ghosts' watts that the ghosts left out of the picture may have.
    pub left_out: f64,
    /// Pairs that are not traced, because there are too many pairs.
    pub not_traced: LeftOut,
}

/// Number of rows of the printed table.
const ROWS: usize = 12;

impl GhostTable {
    /// Returns the watts of all ghosts.
    pub fn watts(&self) -> f64 {
        self.ghosts.iter().fold(0.0, |sum, ghost| sum + ghost.watts)
    }

    /// Returns the brightest pairs: all except the faintest pairs, which together have at most
    /// [`GhostTable::left_out`] of the watts.
    pub fn brightest_pairs(&self) -> Vec<Pair> {
        let mut rest = self.left_out * self.watts();
        let mut ghosts = &self.ghosts[..];
        while let [before @ .., last] = ghosts
            && last.watts <= rest
        {
            rest -= last.watts;
            ghosts = before;
        }
        ghosts.iter().map(|ghost| ghost.pair).collect()
    }

    /// Returns the share of the ghosts' watts that the picture leaves out.
    fn omitted(&self) -> f64 {
        let count = self.brightest_pairs().len();
        let omitted: f64 = self.ghosts[count..].iter().fold(0.0, |sum, ghost| sum + ghost.watts);
        if omitted > 0.0 { omitted / self.watts() } else { 0.0 }
    }

    /// Formats the table as text.
    pub fn text(&self, coating: &str) -> String {
        if self.direct + self.watts() == 0.0 {
            return format!(
                "surfaces {coating}, at {} nm; no light of this lamp gets through the lens\n",
                self.wavelength
            );
        }
        let share = |watts: f64| watts / self.direct;
        let mut text = format!(
            "surfaces {coating}, at {} nm; W per W/m² of the lamp at the lens\n\
             direct light {:.4e} W, {} pairs {:.4e} W in the film's plane: {:.3e} of it\n\
             four reflections and more about {:.1e} of it, as in a stack of plates; {} pairs, {:.1e} of the ghosts, left out of \
             the picture\n\
             surfaces     watts        of direct   middle x, y (mm)     radius (mm)  in focus before the film (mm)\n",
            self.wavelength,
            self.direct,
            self.ghosts.len(),
            self.watts(),
            share(self.watts()),
            self.beyond,
            self.ghosts.len() - self.brightest_pairs().len(),
            self.omitted(),
        );
        if self.not_traced.pairs > 0 {
            writeln!(
                text,
                "{} more pairs are not traced, because this lens has too many; by first-order optics an even sky sends {:.1e} of \
                 all ghosts along them",
                self.not_traced.pairs, self.not_traced.share
            )
            .expect("a string grows");
        }
        for ghost in self.ghosts.iter().take(ROWS).filter(|ghost| ghost.watts > 0.0) {
            let [near, far] = ghost.pair.map(|surface| surface + 1);
            let [x, y] = ghost.middle.map(|at| fixed(at, 2));
            let focus = ghost.focus.map_or("nowhere".to_owned(), |z| fixed(z, 2));
            writeln!(
                text,
                "{:<12} {:<12.4e} {:<11.3e} {:<20} {:<12} {focus}",
                format!("{near}, {far}"),
                ghost.watts,
                share(ghost.watts),
                format!("{x}, {y}"),
                fixed(ghost.radius, 2),
            )
            .expect("a string grows");
        }
        text
    }

    /// Formats every pair as JSON.
    pub fn json(&self, coating: &str) -> Value {
        let pairs: Vec<Value> = self
            .ghosts
            .iter()
            .map(|ghost| {
                json!({
                    "surfaces": ghost.pair.map(|surface| surface + 1),
                    "watts": ghost.watts,
                    "middle_mm": ghost.middle,
                    "rms_radius_mm": ghost.radius,
                    "focus_before_film_mm": ghost.focus,
                })
            })
            .collect();
        json!({
            "coating": coating,
            "wavelength": self.wavelength,
            "direct_watts": self.direct,
            "ghost_watts": self.watts(),
            "beyond_pairs_of_direct": self.beyond,
            "pairs_not_traced": self.not_traced.pairs,
            "share_not_traced": self.not_traced.share,
            "pairs": pairs,
        })
    }
}
