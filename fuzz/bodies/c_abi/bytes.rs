//! Values read off the front of the fuzzer's data.

/// What is left of the data; zeros where it ends.
pub struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    pub fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_at(N.min(self.0.len()));
        self.0 = rest;
        let mut taken = [0; N];
        taken[..head.len()].copy_from_slice(head);
        taken
    }

    /// One of `count`, at most 256.
    pub fn choice(&mut self, count: usize) -> usize {
        usize::from(self.take::<1>()[0]) % count
    }

    /// Mostly not given (NaN); a plain value of everyday size, or any bits at all.
    pub fn number(&mut self) -> f64 {
        match self.choice(32) {
            0..26 => f64::NAN,
            26..30 => f64::from(u16::from_le_bytes(self.take())) / 64.0,
            30 => [0.0, -1.0, f64::INFINITY, 1e-300, 1e300, 1e30, 1e-30, 5e-324][self.choice(8)],
            _ => f64::from_bits(u64::from_le_bytes(self.take())),
        }
    }

    /// Mostly in [0, scale]; any bits at all.
    pub fn float(&mut self, scale: f32) -> f32 {
        match self.choice(4) {
            0..3 => scale * f32::from(u16::from_le_bytes(self.take())) / 65535.0,
            _ => f32::from_bits(u32::from_le_bytes(self.take())),
        }
    }

    /// Up to `most` bytes of all that is left, the number of them before them.
    pub fn text(&mut self, most: usize) -> &'a [u8] {
        let length = usize::from(u16::from_le_bytes(self.take())) % (most + 1);
        let (text, rest) = self.0.split_at(length.min(self.0.len()));
        self.0 = rest;
        text
    }
}
