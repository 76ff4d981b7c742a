//! A group of up to `U` vectors that are processed side by side.

use std::mem::MaybeUninit;

/// Up to `U` values, in order. Values that were not pushed are not initialised: zeros at every index would cost as
/// many stores as one step of all vectors.
pub struct Group<T, const U: usize> {
    values: [MaybeUninit<T>; U],
    /// Number of values.
    count: usize,
}

/// Creates an empty group.
impl<T, const U: usize> Default for Group<T, U> {
    #[inline(always)]
    fn default() -> Self {
        Self { values: [const { MaybeUninit::uninit() }; U], count: 0 }
    }
}

impl<T: Copy, const U: usize> Group<T, U> {
    /// Appends a value.
    ///
    /// # Panics
    /// If the group already has `U` values.
    #[inline(always)]
    pub fn push(&mut self, value: T) {
        self.values[self.count].write(value);
        self.count += 1;
    }

    /// Returns the value at an index.
    ///
    /// # Panics
    /// If there is no value at this index.
    #[inline(always)]
    pub fn get(&self, index: usize) -> T {
        assert!(index < self.count, "fewer values than that");
        // SAFETY: all values below `count` have been written.
        unsafe { self.values[index].assume_init() }
    }

    /// Returns all values as an array, with the first one repeated at the unused indices.
    ///
    /// # Panics
    /// If the group is empty.
    #[inline(always)]
    pub fn filled(&mut self) -> &mut [T; U] {
        assert!(self.count > 0, "no value to fill the others with");
        for index in self.count..U {
            self.values[index] = self.values[0];
        }
        // SAFETY: all values have now been written.
        unsafe { &mut *self.values.as_mut_ptr().cast() }
    }
}
