//! Taking pictures of scenes: what the user asks for, focusing and metering, and the lecture's slides.

mod autofocus;
mod focus;
mod session;
mod slides;

pub use autofocus::Method;
pub use session::{Options, Order, Shot, Studio, stopped_down, whole_only};
pub use slides::Slide;
