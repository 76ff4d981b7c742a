//! What tracing tells about a lens: focus, depth of field, field of view, image scale and film irradiance.
//!
//! A lens and a film's place in; distances (mm), angles (radians) and scales out. Nothing here knows of a raster, a
//! sampler or a camera.

pub mod axial_image;
pub mod depth_of_field;
pub mod field;
pub mod focus;
pub mod image_scale;
pub mod irradiance;
