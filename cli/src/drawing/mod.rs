//! Drawings of a lens, a pupil and a depth of field: SVG, and PNG rasterised from the same SVG.
//!
//! [`view`] maps millimetres to the page, and [`axis`] maps numbers to a logarithmic scale. [`shapes`] has the page's
//! lines, areas and texts, [`labels`] keeps texts apart, and [`output`] writes the file. The drawings are
//! [`section`], [`positions`], [`catalogue`], [`outline`] and [`depth`]; [`glass`], [`rays`], [`ghost`] and [`marks`]
//! are parts of the first three.

pub mod axis;
pub mod catalogue;
pub mod depth;
pub mod ghost;
pub mod glass;
pub mod labels;
pub mod marks;
pub mod outline;
pub mod output;
pub mod positions;
pub mod rays;
pub mod section;
pub mod shapes;
pub mod view;

/// Colours distinct for every kind of colour vision: blue, bluish green and vermilion of M. Okabe and K. Ito, "Color
/// Universal Design" (2008).
pub const COLORS: [&str; 3] = ["#0072B2", "#009E73", "#D55E00"];
/// Colour of lines and texts.
pub const INK: &str = "#222222";
/// Colour of guide lines.
pub const FAINT: &str = "#8a8a8a";
