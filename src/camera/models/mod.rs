//! The camera models: the real lens, the thick and thin one, and cameras like those that pbrt has in stock.

pub(crate) mod environment;
pub(crate) mod ideal;
pub(crate) mod lens;
pub(crate) mod projective;
pub mod spaces;
pub(crate) mod stock_cameras;
