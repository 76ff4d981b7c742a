//! Table look-up: each lane reads a table of numbers at an index of its own.

/// A vector type with table look-ups, one index per lane.
pub trait LookUp: Copy {
    /// Type of the indices: an integer for each lane.
    type Places: Copy;

    /// Looks up two consecutive pairs of a table for each lane, `K` times, and returns the four numbers of both pairs
    /// as vectors. In look-up k, the index of the first pair is `STEP` (1 or 2) times `at` plus `further[k]`; an index
    /// beyond the table gives arbitrary pairs. The look-up uses loads and shuffles, because gather instructions are
    /// slow on some processors.
    ///
    /// # Panics
    /// If the table is too short to contain the pairs for `at` = 0.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_up<const K: usize, const STEP: usize>(
        table: &[[f32; 2]],
        at: Self::Places,
        further: [usize; K],
    ) -> [[Self; 4]; K] {
        let indices = Self::up_to::<STEP>(at, last_index(table, further));
        // SAFETY: `last_index` limits the indices so that, for every k, the table holds two pairs from index +
        // `further[k]` on.
        let mut found = [unsafe { Self::pairs(table.as_ptr().add(further[0]), indices) }; K];
        let mut k = 1;
        while k < K {
            // SAFETY: as above.
            found[k] = unsafe { Self::pairs(table.as_ptr().add(further[k]), indices) };
            k += 1;
        }
        found
    }
    /// Looks up an entry of a table for each lane; an index beyond the table gives an arbitrary entry.
    ///
    /// # Panics
    /// If the table is empty.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_up_indexed(table: &[Indexed], at: Self::Places) -> (Self::Places, [Self; 3]) {
        assert!(!table.is_empty(), "an empty table to look something up in");
        // SAFETY: an entry has the size of two pairs, so the entry with index i starts at the pair with index 2 i.
        unsafe { Self::indexed(table.as_ptr(), Self::up_to::<2>(at, 2 * (table.len() - 1))) }
    }
    /// Adds the indices of each lane.
    fn add_places(a: Self::Places, b: Self::Places) -> Self::Places;
    /// Returns `STEP` (1 or 2) times the indices, but at most `last`.
    fn up_to<const STEP: usize>(indices: Self::Places, last: usize) -> Self::Places;
    /// Returns the two pairs of a table that start at each index, as four vectors of their numbers.
    ///
    /// # Safety
    /// Two pairs must start at each index.
    unsafe fn pairs(table: *const [f32; 2], indices: Self::Places) -> [Self; 4];
    /// Returns the entries whose indices are half of the given ones.
    ///
    /// # Safety
    /// The entries must exist, and the indices must be even.
    unsafe fn indexed(table: *const Indexed, indices: Self::Places) -> (Self::Places, [Self; 3]);
}

/// An entry of a table: an index into another table, and three numbers.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Indexed {
    /// The index.
    pub index: u32,
    /// The numbers.
    pub numbers: [f32; 3],
}

/// Returns the largest index at which a look-up finds all of its pairs.
#[inline(always)]
fn last_index<const K: usize>(table: &[[f32; 2]], further: [usize; K]) -> usize {
    let (mut most, mut k) = (0, 0);
    while k < K {
        most = if further[k] > most { further[k] } else { most };
        k += 1;
    }
    assert!(table.len() >= most + 2, "a table too short to look anything up in");
    table.len() - (most + 2)
}

/// Implements [`LookUp`] for indices of a given type; `$vector` makes a vector of the numbers found.
#[cfg(target_arch = "x86_64")]
macro_rules! lookup_methods {
    ($type:ident: $as_places:ident; add $add:ident, up to $up_to:ident;
     $pairs_of:ident, $numbers:ident => $vector:expr) => {
        type Places = $type;

        #[inline(always)]
        fn add_places(a: $type, b: $type) -> $type {
            // SAFETY: indices come from a vector, which exists only if a `Cpu` existed.
            unsafe { $add(a, b) }
        }
        #[inline(always)]
        fn up_to<const STEP: usize>(indices: $type, last: usize) -> $type {
            // SAFETY: as above.
            unsafe { $up_to::<STEP>(indices, last) }
        }
        #[inline(always)]
        unsafe fn pairs(table: *const [f32; 2], indices: $type) -> [Self; 4] {
            // SAFETY: indices come from a vector, which exists only if a `Cpu` existed; the caller ensures the rest.
            unsafe {
                let [a, b, c, d] = $pairs_of(table, indices);
                [
                    {
                        let $numbers = a;
                        $vector
                    },
                    {
                        let $numbers = b;
                        $vector
                    },
                    {
                        let $numbers = c;
                        $vector
                    },
                    {
                        let $numbers = d;
                        $vector
                    },
                ]
            }
        }
        #[inline(always)]
        unsafe fn indexed(table: *const Indexed, indices: $type) -> ($type, [Self; 3]) {
            // SAFETY: as above; an entry has the size of two pairs.
            unsafe {
                let [index, a, b, c] = $pairs_of(table.cast(), indices);
                let numbers = [
                    {
                        let $numbers = a;
                        $vector
                    },
                    {
                        let $numbers = b;
                        $vector
                    },
                    {
                        let $numbers = c;
                        $vector
                    },
                ];
                ($as_places(index), numbers)
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
pub(super) use lookup_methods;
