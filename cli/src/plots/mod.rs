//! Work-precision diagrams: log-log charts, every mark or line with its name beside it.
//!
//! [`placement`] keeps names apart, [`chart`] draws.

pub mod chart;
pub mod placement;

/// Colours distinct for every kind of colour vision, darkest first (M. Okabe and K. Ito, "Color
/// Universal Design", 2008; their yellow and light blue are too faint for lines on white).
pub const PALETTE: [&str; 6] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00"];
