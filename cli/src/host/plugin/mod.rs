//! The plugin from a renderer's view: a shared library, its functions by name, and cameras made by
//! them.

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
pub use connections::{Connections, Places};
pub use library::{Plugin, PluginError};
pub use location::find;
