//! Whether there is memory for a camera or a lens, asked before it is built. Rust's library ends the process where memory is out;
//! what is found out beforehand becomes an error.

use std::hint::black_box;

use super::{Failure, out_of_memory};

/// Building takes 2.5 MB, with a tolerance up to 7.7 MB, of any lens; what it keeps is less.
const CAMERA: usize = 8 << 20;
/// Allocators take pieces of this size from where they take smaller ones.
const PIECE: usize = 1 << 16;

/// Takes what a camera or a lens needs while it is built, and gives it back; nothing is written to it.
///
/// # Errors
/// Memory is out.
pub fn to_build() -> Result<(), Failure> {
    let mut pieces: Vec<Vec<u8>> = Vec::new();
    let is_there = pieces.try_reserve_exact(CAMERA / PIECE).is_ok()
        && (0..CAMERA / PIECE).all(|_| {
            pieces.push(Vec::new());
            pieces.last_mut().is_some_and(|piece| piece.try_reserve_exact(PIECE).is_ok())
        });
    // What nobody reads might not be allocated at all.
    drop(black_box(pieces));
    if is_there { Ok(()) } else { Err(out_of_memory()) }
}
