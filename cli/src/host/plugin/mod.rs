//! The plugin as a renderer uses it: a shared library, its functions by name, and the cameras that these functions
//! build.

mod camera;
mod connections;
mod library;
mod location;
mod options;

#[cfg(test)]
pub use camera::request_of;
pub use camera::{Camera, Warn, c_options, generate};
#[cfg(test)]
pub use connections::connect;
pub use connections::{Connections, ScenePoints};
pub use library::{Plugin, PluginError};
pub use location::find;
