//! Arrays of any layout that hosts and NumPy may use.

use std::ptr::null;

use realistic::ffi::{realistic_input, realistic_output};

use super::Random;

/// The byte that fills memory before a call.
const FILL: u8 = 0xA5;

/// The bits of a number that was not written.
pub const UNWRITTEN: u32 = u32::from_ne_bytes([FILL; 4]);

/// The layout of a field: bytes to its first element, from one element to the next, and from one component to the next.
#[derive(Clone, Copy)]
struct Field {
    start: usize,
    stride: isize,
    component_stride: isize,
    components: usize,
}

/// Memory for `n` elements of several fields, with gaps. Each field has one or more components of four bytes.
pub struct Memory {
    bytes: Vec<u8>,
    first: usize,
    fields: Vec<Field>,
    n: usize,
}

impl Memory {
    /// Generates a random layout of fields with these numbers of components: structures, columns, or separate fields
    /// with gaps and in reverse order. The layout may begin at an odd address.
    pub fn new(n: usize, components: &[usize], random: &mut Random) -> Self {
        let mut among = |n: usize| (random.next() * n as f64) as usize;
        let layout = among(3);
        let size = 4 * components.iter().sum::<usize>() + [0, 0, 16, 3][among(4)];
        let (mut fields, mut end) = (Vec::new(), 0);
        for &components in components {
            let gap = [0, 0, 4, 12, 3][among(5)];
            let (stride, component_stride, start, length) = match (layout, among(3)) {
                (0, _) => (size, 4, end, 4 * components),
                (1, _) => (4, 4 * n, end, 4 * n * components),
                (_, 0) => (4 * components + gap, 4, end + gap, (4 * components + gap) * n),
                (_, 1) => (4 + gap, (4 + gap) * n, end + gap, (4 + gap) * n * components),
                (_, _) => (4, 4 * n + gap, end + gap, (4 * n + gap) * components),
            };
            end = start + length;
            let is_backward = layout == 2 && among(3) == 0;
            fields.push(Field {
                start: start + if is_backward { stride * n.saturating_sub(1) } else { 0 },
                stride: if is_backward { -(stride as isize) } else { stride as isize },
                component_stride: component_stride as isize,
                components,
            });
        }
        let odd = [0, 0, 1, 2][among(4)];
        let bytes = vec![FILL; end + size * n + 8];
        let first = bytes.as_ptr().align_offset(4) + odd;
        Self { bytes, first, fields, n }
    }

    fn offset(&self, field: usize, i: usize, component: usize) -> usize {
        let Field { start, stride, component_stride, .. } = self.fields[field];
        (self.first + start).wrapping_add_signed(i as isize * stride + component as isize * component_stride)
    }

    pub fn set<const C: usize>(&mut self, field: usize, i: usize, numbers: [f32; C]) {
        for (component, number) in numbers.into_iter().enumerate() {
            let offset = self.offset(field, i, component);
            self.bytes[offset..offset + 4].copy_from_slice(&number.to_ne_bytes());
        }
    }

    pub fn bits<const C: usize>(&self, field: usize, i: usize) -> [u32; C] {
        std::array::from_fn(|component| {
            let offset = self.offset(field, i, component);
            u32::from_ne_bytes(self.bytes[offset..offset + 4].try_into().expect("four bytes"))
        })
    }

    pub fn input(&self, field: usize) -> realistic_input {
        let Field { start, stride, component_stride, .. } = self.fields[field];
        let x = self.bytes[self.first + start..].as_ptr();
        realistic_input { x: x.cast(), y: x.wrapping_offset(component_stride).cast(), z: null(), stride }
    }

    pub fn output(&mut self, field: usize) -> realistic_output {
        let Field { start, stride, component_stride, .. } = self.fields[field];
        let x = self.bytes[self.first + start..].as_mut_ptr();
        let [y, z] = [1, 2].map(|k| x.wrapping_offset(k * component_stride).cast());
        realistic_output { x: x.cast(), y, z, stride }
    }

    /// Whether the gaps are unchanged.
    pub fn is_whole(&self) -> bool {
        let mut bytes = self.bytes.clone();
        for (field, Field { components, .. }) in self.fields.iter().enumerate() {
            for (i, component) in (0..self.n).flat_map(|i| (0..*components).map(move |k| (i, k))) {
                let offset = self.offset(field, i, component);
                bytes[offset..offset + 4].fill(FILL);
            }
        }
        bytes.iter().all(|byte| *byte == FILL)
    }

    /// Whether all memory is unchanged.
    pub fn is_untouched(&self) -> bool {
        self.bytes.iter().all(|byte| *byte == FILL)
    }
}
