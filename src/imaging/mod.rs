//! What tracing tells about a lens: focus, depth of field, field of view, image scale and film irradiance.

pub mod depth_of_field;
pub mod field;
pub mod focus;
pub mod image_scale;
pub mod irradiance;
