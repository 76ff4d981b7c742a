//! The camera models: the real lens, the thick and thin one, and the textbook cameras.

pub(crate) mod environment;
pub(crate) mod ideal;
pub(crate) mod lens;
pub(crate) mod projective;
pub mod spaces;
