//! Numbers of a caller, one per sample or ray, at any distance from each other: as slices where they lie side by side, by
//! copies where they do not.

use std::slice;

use super::super::types::realistic_reason;

/// Numbers that are read, one per sample.
#[derive(Clone, Copy)]
pub(super) struct Column {
    /// The first.
    pub first: *const f32,
    /// Bytes from one to the next.
    pub stride: isize,
    /// Samples one after the other that have a number in common.
    pub shared_by: usize,
}

impl Column {
    /// Numbers side by side.
    pub(super) const fn packed(first: *const f32) -> Self {
        Self { first, stride: size_of::<f32>() as isize, shared_by: 1 }
    }

    /// Whether they can be read as a slice.
    #[inline(always)]
    pub(super) fn is_slice(self) -> bool {
        self.stride == size_of::<f32>() as isize && self.shared_by == 1 && self.first.is_aligned()
    }

    /// `count` of them from `first` on.
    ///
    /// # Safety
    /// They can be read as a slice, there are so many, and nobody writes them.
    #[inline(always)]
    pub(super) unsafe fn slice<'a>(self, first: usize, count: usize) -> &'a [f32] {
        // SAFETY: the caller's promise.
        unsafe { slice::from_raw_parts(self.first.add(first), count) }
    }

    /// The number of sample `i`.
    ///
    /// # Safety
    /// There is one.
    #[inline(always)]
    pub(super) unsafe fn number(self, i: usize) -> f32 {
        // SAFETY: the caller's promise; nothing needs to be aligned.
        unsafe { self.first.byte_offset((i / self.shared_by) as isize * self.stride).read_unaligned() }
    }

    /// Copies those from `first` on.
    ///
    /// # Safety
    /// There are so many.
    pub(super) unsafe fn read(self, first: usize, to: &mut [f32]) {
        for (i, to) in to.iter_mut().enumerate() {
            // SAFETY: the caller's promise.
            *to = unsafe { self.number(first + i) };
        }
    }

    /// Copies those from `first` on of two columns, where they are no slices.
    ///
    /// # Safety
    /// There are so many in each.
    pub(super) unsafe fn read_two([a, b]: [Self; 2], first: usize, [to_a, to_b]: [&mut [f32]; 2]) {
        let is_one_of_pairs =
            |column: Self| column.stride == size_of::<[f32; 2]>() as isize && column.shared_by == 1;
        // SAFETY: the caller's promise. A pair is read at once; where it begins with `a`, it ends with `b`.
        unsafe {
            if is_one_of_pairs(a) && is_one_of_pairs(b) && b.first == a.first.wrapping_add(1) {
                let pairs = a.first.cast::<[f32; 2]>().add(first);
                for (i, (to_a, to_b)) in to_a.iter_mut().zip(to_b).enumerate() {
                    [*to_a, *to_b] = pairs.add(i).read_unaligned();
                }
            } else {
                for (column, to) in [(a, to_a), (b, to_b)] {
                    if !column.is_slice() {
                        column.read(first, to);
                    }
                }
            }
        }
    }
}

/// Room for numbers, one per ray; of none where `first` is NULL.
#[derive(Clone, Copy)]
pub(super) struct ColumnMut {
    /// Room for the first.
    pub first: *mut f32,
    /// Bytes from one to the next.
    pub stride: isize,
}

impl ColumnMut {
    /// Room side by side.
    pub(super) const fn packed(first: *mut f32) -> Self {
        Self { first, stride: size_of::<f32>() as isize }
    }

    /// Whether there is any.
    #[inline(always)]
    pub(super) fn is_there(self) -> bool {
        !self.first.is_null()
    }

    /// Whether it can be taken as a slice, of nothing where there is none.
    #[inline(always)]
    pub(super) fn is_slice(self) -> bool {
        self.stride == size_of::<f32>() as isize && self.first.is_aligned()
    }

    /// Room for `count` numbers from `first` on.
    ///
    /// # Safety
    /// It can be taken as a slice, is there and so long, and nothing else refers to it.
    #[inline(always)]
    pub(super) unsafe fn slice<'a>(self, first: usize, count: usize) -> &'a mut [f32] {
        // SAFETY: the caller's promise.
        unsafe { slice::from_raw_parts_mut(self.first.add(first), count) }
    }

    /// Puts the number of ray `i`.
    ///
    /// # Safety
    /// There is room.
    #[inline(always)]
    pub(super) unsafe fn put(self, i: usize, number: f32) {
        // SAFETY: the caller's promise; nothing needs to be aligned.
        unsafe { self.first.byte_offset(i as isize * self.stride).write_unaligned(number) };
    }

    /// Copies numbers to the rays from `first` on, of those with a weight.
    ///
    /// # Safety
    /// There is room for so many.
    pub(super) unsafe fn write(self, first: usize, numbers: &[f32], weights: &[f32]) {
        for (i, (number, weight)) in numbers.iter().zip(weights).enumerate() {
            if *weight > 0.0 {
                // SAFETY: the caller's promise.
                unsafe { self.put(first + i, *number) };
            }
        }
    }

    /// Copies all numbers to the rays from `first` on.
    ///
    /// # Safety
    /// There is room for so many.
    pub(super) unsafe fn write_all(self, first: usize, numbers: &[f32]) {
        for (i, number) in numbers.iter().enumerate() {
            // SAFETY: the caller's promise.
            unsafe { self.put(first + i, *number) };
        }
    }
}

/// Room for reasons, one per sample; of none where `first` is NULL.
#[derive(Clone, Copy)]
pub(super) struct Reasons {
    /// Room for the first.
    pub first: *mut realistic_reason,
    /// Bytes from one to the next.
    pub stride: isize,
}

impl Reasons {
    /// Room side by side.
    pub(super) const fn packed(first: *mut realistic_reason) -> Self {
        Self { first, stride: size_of::<realistic_reason>() as isize }
    }

    /// Puts why the samples from `first` on have these weights; `reason` says it of one that has no ray. Found out apart,
    /// because it costs more than a ray.
    ///
    /// # Safety
    /// There is room for so many, or none.
    pub(super) unsafe fn give(
        self,
        first: usize,
        weights: &[f32],
        reason: impl Fn(usize) -> realistic_reason,
    ) {
        if self.first.is_null() {
            return;
        }
        for (i, weight) in weights.iter().enumerate() {
            let reason = if *weight > 0.0 { realistic_reason::Ok } else { reason(i) };
            // SAFETY: the caller's promise.
            unsafe { self.first.byte_offset((first + i) as isize * self.stride).write_unaligned(reason) };
        }
    }
}
