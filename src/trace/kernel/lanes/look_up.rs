//! Tables that lanes look numbers up in.

/// A vector with a place in a table for each lane.
pub trait LookUp: Copy {
    /// A place for each lane, an integer.
    type Places: Copy;

    /// Two pairs of a table one after the other for each lane, `K` times: as vectors of their numbers. The first
    /// pair is `STEP` (1 or 2) times `at` and `K` numbers more; where there is none, any. By loads
    /// and shuffles: the instructions that gather are slow on some processors.
    ///
    /// # Panics
    /// The table has not so many pairs that there is one for `at` = 0.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_up<const K: usize, const STEP: usize>(
        table: &[[f32; 2]],
        at: Self::Places,
        further: [usize; K],
    ) -> [[Self; 4]; K] {
        let places = Self::up_to::<STEP>(at, last_place(table, further));
        // SAFETY: up to the last place, and `further` on, the table has two pairs.
        let mut found = [unsafe { Self::pairs(table.as_ptr().add(further[0]), places) }; K];
        let mut k = 1;
        while k < K {
            // SAFETY: as above.
            found[k] = unsafe { Self::pairs(table.as_ptr().add(further[k]), places) };
            k += 1;
        }
        found
    }
    /// An entry of a table for each lane; where there is none, any.
    ///
    /// # Panics
    /// The table is empty.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_up_indexed(table: &[Indexed], at: Self::Places) -> (Self::Places, [Self; 3]) {
        assert!(!table.is_empty(), "an empty table to look something up in");
        // SAFETY: an entry is as large as two pairs, and so there are two from twice the number of each on.
        unsafe { Self::indexed(table.as_ptr(), Self::up_to::<2>(at, 2 * (table.len() - 1))) }
    }
    /// The sums of places.
    fn add_places(a: Self::Places, b: Self::Places) -> Self::Places;
    /// `STEP` (1 or 2) times the places, or `last` where that is less.
    fn up_to<const STEP: usize>(places: Self::Places, last: usize) -> Self::Places;
    /// Two pairs of a table at each place: as vectors of their numbers.
    ///
    /// # Safety
    /// There are two pairs from each place on.
    unsafe fn pairs(table: *const [f32; 2], places: Self::Places) -> [Self; 4];
    /// The entry at half of each place.
    ///
    /// # Safety
    /// There is one, and the places are even.
    unsafe fn indexed(table: *const Indexed, places: Self::Places) -> (Self::Places, [Self; 3]);
}

/// An entry of a table: where in another one something stands, and three numbers.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Indexed {
    pub index: u32,
    pub numbers: [f32; 3],
}

/// The last number for which a look-up finds all its pairs.
#[inline(always)]
fn last_place<const K: usize>(table: &[[f32; 2]], further: [usize; K]) -> usize {
    let (mut most, mut k) = (0, 0);
    while k < K {
        most = if further[k] > most { further[k] } else { most };
        k += 1;
    }
    assert!(table.len() >= most + 2, "a table too short to look anything up in");
    table.len() - (most + 2)
}

/// Places in tables, and what stands there, of which `$vector` makes a vector.
#[cfg(target_arch = "x86_64")]
macro_rules! places {
    ($type:ident: $as_places:ident; add $add:ident, up to $up_to:ident;
     $pairs_of:ident, $numbers:ident => $vector:expr) => {
        type Places = $type;

        #[inline(always)]
        fn add_places(a: $type, b: $type) -> $type {
            // SAFETY: places are those of a vector.
            unsafe { $add(a, b) }
        }
        #[inline(always)]
        fn up_to<const STEP: usize>(places: $type, last: usize) -> $type {
            // SAFETY: as above.
            unsafe { $up_to::<STEP>(places, last) }
        }
        #[inline(always)]
        unsafe fn pairs(table: *const [f32; 2], places: $type) -> [Self; 4] {
            // SAFETY: places are those of a vector, which exists only where `Cpu` did; and the caller's promise.
            unsafe {
                let [a, b, c, d] = $pairs_of(table, places);
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
        unsafe fn indexed(table: *const Indexed, places: $type) -> ($type, [Self; 3]) {
            // SAFETY: as above; an entry has the size of two pairs.
            unsafe {
                let [index, a, b, c] = $pairs_of(table.cast(), places);
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
pub(super) use places;
