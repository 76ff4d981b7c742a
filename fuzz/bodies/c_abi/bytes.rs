//! Values decoded from the front of the fuzzer's data.

/// The remaining data; reads past the end give zeros.
pub struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    pub fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_at(N.min(self.0.len()));
        self.0 = rest;
        let mut taken = [0; N];
        taken[..head.len()].copy_from_slice(head);
        taken
    }

    /// Returns a number below `count`, which is at most 256.
    pub fn choice(&mut self, count: usize) -> usize {
        usize::from(self.take::<1>()[0]) % count
    }

    /// Returns mostly NaN (not given); otherwise a number of ordinary size, an extreme number or any bits.
    pub fn number(&mut self) -> f64 {
        match self.choice(32) {
            0..26 => f64::NAN,
            26..30 => f64::from(u16::from_le_bytes(self.take())) / 64.0,
            30 => [0.0, -1.0, f64::INFINITY, 1e-300, 1e300, 1e30, 1e-30, 5e-324][self.choice(8)],
            _ => f64::from_bits(u64::from_le_bytes(self.take())),
        }
    }

    /// Returns a number that is mostly in [0, scale], otherwise any bits.
    pub fn float(&mut self, scale: f32) -> f32 {
        match self.choice(4) {
            0..3 => scale * f32::from(u16::from_le_bytes(self.take())) / 65535.0,
            _ => f32::from_bits(u32::from_le_bytes(self.take())),
        }
    }

    /// Returns up to `most` of the remaining bytes; the data give their number before them.
    pub fn text(&mut self, most: usize) -> &'a [u8] {
        let length = usize::from(u16::from_le_bytes(self.take())) % (most + 1);
        let (text, rest) = self.0.split_at(length.min(self.0.len()));
        self.0 = rest;
        text
    }
}
