//! Drawings of a lens, a pupil and a depth of field: SVG, and PNG by rasterising that same SVG.
//!
//! [`view`] maps millimetres to the page, [`axis`] numbers to a logarithmic scale, [`shapes`] has its lines, areas and texts, [`labels`] keeps texts
//! apart, [`picture`] writes the file; [`section`], [`positions`], [`catalogue`], [`outline`] and [`depth`] are the
//! drawings, [`glass`], [`rays`], [`ghost`] and [`marks`] parts of the first three.

pub mod axis;
pub mod catalogue;
pub mod depth;
pub mod ghost;
pub mod glass;
pub mod labels;
pub mod marks;
pub mod outline;
pub mod picture;
pub mod positions;
pub mod rays;
pub mod section;
pub mod shapes;
pub mod view;

/// Colours that stay apart for every kind of colour vision: blue, bluish green and vermilion of
/// M. Okabe and K. Ito, "Color Universal Design" (2008).
pub const COLORS: [&str; 3] = ["#0072B2", "#009E73", "#D55E00"];
/// Lines and texts.
pub const INK: &str = "#222222";
/// What is there to guide the eye.
pub const FAINT: &str = "#8a8a8a";
