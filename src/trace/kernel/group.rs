//! Vectors that are worked on side by side: up to `U` of them, as many as there are.

use std::mem::MaybeUninit;

/// Up to `U` values, in order. Nothing is written that is not put in: zeros at every index would be as many stores as a step of
/// all vectors has.
pub struct Group<T, const U: usize> {
    values: [MaybeUninit<T>; U],
    /// So many are there.
    count: usize,
}

impl<T: Copy, const U: usize> Group<T, U> {
    /// Without any.
    #[inline(always)]
    pub fn new() -> Self {
        Self { values: [const { MaybeUninit::uninit() }; U], count: 0 }
    }

    /// Puts one in behind the others.
    ///
    /// # Panics
    /// There are `U` already.
    #[inline(always)]
    pub fn push(&mut self, value: T) {
        self.values[self.count].write(value);
        self.count += 1;
    }

    /// The one at an index.
    ///
    /// # Panics
    /// There is none.
    #[inline(always)]
    pub fn get(&self, index: usize) -> T {
        assert!(index < self.count, "fewer values than that");
        // SAFETY: so many values from the first on have been written.
        unsafe { self.values[index].assume_init() }
    }

    /// An array of them, with the first one again where there are none.
    ///
    /// # Panics
    /// There is none at all.
    #[inline(always)]
    pub fn filled(&mut self) -> &mut [T; U] {
        assert!(self.count > 0, "no value to fill the others with");
        for index in self.count..U {
            self.values[index] = self.values[0];
        }
        // SAFETY: now all have been written.
        unsafe { &mut *self.values.as_mut_ptr().cast() }
    }
}
