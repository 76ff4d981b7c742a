//! Arguments that all commands share: the lens, the parameters of the library's table, the film, and numbers.

mod film;
mod lens;
mod parameters;
mod values;

pub use film::FilmSize;
pub use lens::{
    CameraChoice, LensChoice, OpenedLens, PIPED, POSED_FILM, STOP_SHAPE, TRANSMISSION, host, size_film,
    standard_input, with_groups, with_scene_defaults, with_stack_defaults,
};
pub use parameters::{ParameterFlags, flag_name};
pub use values::{distance, finite, not_negative, positive, size, whole};
