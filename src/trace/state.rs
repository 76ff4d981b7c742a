//! A ray on its way through a lens, and why one stops there.

use thiserror::Error;

/// Why a ray does not get through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Error)]
pub enum Blocked {
    /// It passes beside a surface.
    #[error("missed")]
    Missed,
    /// It meets a surface outside the clear aperture.
    #[error("clipped")]
    Clipped,
    /// It is totally reflected.
    #[error("reflected")]
    Reflected,
    /// The next surface lies behind it, or it travels backward.
    #[error("turned_back")]
    TurnedBack,
}

/// Position and V = n D in the frame of the current vertex.
#[derive(Clone, Copy)]
pub struct State<R> {
    pub p: [R; 3],
    pub v: [R; 3],
    /// How far the ray was moved on from where it began or was last bent, in units of V.
    pub lead: R,
}
