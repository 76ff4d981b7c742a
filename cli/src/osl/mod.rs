//! A lens as a camera of Blender: the text of an OSL shader that traces it.
//!
//! The input is a lens file. `stations` has its groups at several positions of the zoom, and `optics` its focus and
//! stop; `field`, `region`, `table` and `stop` turn the library's map of the pupil into a table small enough for a
//! shader; `quarter` makes the table of a lens that is not round. The output is OSL (`numbers`, `trace`, `figure`, `glass`,
//! `light`, `pupil`, `quarter`, `shader`). OSL cameras work in
//! metres with +z forward and +y up; the shader works in millimetres in lens space.

mod field;
mod figure;
mod glass;
mod light;
mod numbers;
mod optics;
mod polynomial;
mod pupil;
mod quarter;
mod region;
mod shader;
mod stations;
mod stop;
mod table;
mod text;
mod trace;

pub use shader::{OslCamera, ShaderRequest};
pub use stations::{Station, StationRequest, stations};
