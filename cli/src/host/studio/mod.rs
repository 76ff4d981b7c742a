//! Takes pictures of scenes: the user's options, focusing and metering, and the lecture's slides.

mod autofocus;
mod focus;
mod session;
mod slides;

pub use autofocus::Method;
pub use session::{Options, Shot, ShotOptions, Studio, stopped_down, whole_only};
pub use slides::Slide;
