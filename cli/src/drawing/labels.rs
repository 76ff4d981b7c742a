//! Texts in a row without overlap, each as near as possible to its anchor; isotonic regression finds their positions.

/// Space between two texts, pixels.
const GAP: f64 = 14.0;

/// Returns the centres of texts with preferred positions `anchors` (from left to right) and `widths`, within
/// `[left, right]`: the positions that minimise the sum of squared shifts.
///
/// After subtraction of the texts' own widths the centres must not descend, so this is isotonic regression, solved
/// by pooling adjacent violators (R. E. Barlow et al., *Statistical Inference under Order Restrictions*, 1972).
pub fn spread(anchors: &[f64], widths: &[f64], [left, right]: [f64; 2]) -> Vec<f64> {
    let mut offset = 0.0;
    let offsets: Vec<f64> = widths
        .iter()
        .map(|width| {
            let center = offset + width / 2.0;
            offset += width + GAP;
            center
        })
        .collect();
    let total = (offset - GAP).max(0.0);
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (anchor, offset) in anchors.iter().zip(&offsets) {
        let mut pool = (anchor - offset, 1);
        while let Some(&(value, count)) = pools.last() {
            if value <= pool.0 {
                break;
            }
            let both = count + pool.1;
            pool = ((value * count as f64 + pool.0 * pool.1 as f64) / both as f64, both);
            pools.pop();
        }
        pools.push(pool);
    }
    let starts = pools.iter().flat_map(|&(value, count)| std::iter::repeat_n(value, count));
    // Too much text for the row overflows to the right.
    starts.zip(offsets).map(|(start, offset)| start.min(right - total).max(left) + offset).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_keep_apart_in_order_and_inside() {
        let widths = [30.0, 80.0, 20.0, 100.0];
        for anchors in
            [[100.0, 101.0, 102.0, 900.0], [0.0, 0.0, 0.0, 0.0], [999.0; 4], [0.0, 300.0, 301.0, 310.0]]
        {
            let centers = spread(&anchors, &widths, [10.0, 600.0]);
            assert!(centers[0] - 15.0 >= 10.0 && centers[3] + 50.0 <= 600.0, "{centers:?}");
            for i in 1..4 {
                let free = (centers[i] - widths[i] / 2.0) - (centers[i - 1] + widths[i - 1] / 2.0);
                assert!(free >= GAP - 1e-9, "{centers:?}");
            }
        }
    }

    #[test]
    fn texts_with_room_stay_where_they_belong() {
        assert_eq!(spread(&[50.0, 200.0], &[40.0, 40.0], [0.0, 600.0]), [50.0, 200.0]);
        let [a, b] = spread(&[100.0, 100.0], &[40.0, 40.0], [0.0, 600.0])[..] else { panic!("two") };
        assert_eq!((a + b, b - a), (200.0, 40.0 + GAP));
    }
}
