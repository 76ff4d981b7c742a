//! Point sets of low discrepancy: the additive recurrence of M. Roberts ("The Unreasonable Effectiveness of Quasirandom
//! Sequences", 2018), which needs no table and no seed.

/// Fractional parts of multiples of these fill the four-dimensional unit cube evenly: the powers of 1/g, g > 1
/// with g^5 = g + 1 (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
pub const STEPS: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_808_7, 0.538_597_257_225_901_9];
