//! Room for one block on its way through the camera, kept by each thread that asks for batches.

use std::cell::RefCell;

use super::{block::BLOCK, tracer::Bundle, warped::Places};
use crate::trace::{Real, kernel::Precision};

/// A block between its samples and its rays.
pub(super) struct Scratch<S> {
    /// Film points, mm.
    pub film: [[f64; BLOCK]; 2],
    /// Points of the unit disk.
    pub disk: [[f64; BLOCK]; 2],
    pub places: Places<BLOCK>,
    pub slopes: [[f64; BLOCK]; 2],
    /// The slope area that each sample stands for; NaN where there is nothing to trace.
    pub area: [f64; BLOCK],
    pub bundle: Bundle<S, BLOCK>,
}

impl<S: Real + Precision> Scratch<S> {
    fn new() -> Box<Self> {
        let zero = [0.0; BLOCK];
        Box::new(Self {
            film: [zero; 2],
            disk: [zero; 2],
            places: Places::new(),
            slopes: [zero; 2],
            area: zero,
            bundle: Bundle::new(),
        })
    }
}

/// A precision that blocks are traced in.
pub(super) trait Blocks: Real + Precision {
    /// Works with this thread's room, in which the last block's numbers still lie.
    fn with_scratch(work: impl FnOnce(&mut Scratch<Self>));
}

macro_rules! blocks {
    ($($float:ident),*) => {$(
        impl Blocks for $float {
            fn with_scratch(work: impl FnOnce(&mut Scratch<Self>)) {
                thread_local! {
                    static SCRATCH: RefCell<Option<Box<Scratch<$float>>>> = const { RefCell::new(None) };
                }
                // At a thread's end its room is gone already.
                let mut kept = SCRATCH.try_with(RefCell::take).ok().flatten().unwrap_or_else(Scratch::new);
                work(&mut kept);
                let _ = SCRATCH.try_with(|scratch| scratch.replace(Some(kept)));
            }
        }
    )*};
}

blocks!(f64, f32);
