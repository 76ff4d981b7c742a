//! The tests of rays in lanes against shaped apertures and obstructions, with the constants of [`ApertureTest`].

use realistic_base::numeric::Real;
use realistic_optics::trace::{ApertureTest, ConvexTest, Edge, OutlineTest};
use realistic_simd::{Cpu, Lanes};

/// Returns the two sides of an aperture's inequality: the aperture passes a point if the first is at most the second.
/// The points, x and y in mm, were multiplied by `w`, positive, so that they need no division.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn sides<L: Lanes>(cpu: Cpu<L>, test: &ApertureTest<L::Scalar>, point: [L; 2], w: L) -> (L, L) {
    match &test.outline {
        OutlineTest::Convex(convex) => {
            let (power, limit) = power(cpu, convex, point, w);
            if test.is_obstruction { (limit, power) } else { (power, limit) }
        }
        OutlineTest::Polygon(edges) => {
            (side(cpu, edges, test.is_obstruction, point, w), L::splat(cpu, L::Scalar::ONE))
        }
    }
}

/// Returns the two sides of the inequality of a [`ConvexTest`].
#[cfg_attr(not(debug_assertions), inline(always))]
fn power<L: Lanes>(cpu: Cpu<L>, test: &ConvexTest<L::Scalar>, [x, y]: [L; 2], w: L) -> (L, L) {
    let [[xx, xy], [yx, yy]] = test.axes;
    let [cx, cy] = [L::splat(cpu, test.center[0]), L::splat(cpu, test.center[1])];
    let [x, y] = [w.neg_mul_add(cx, x), w.neg_mul_add(cy, y)];
    let [x, y] = [
        y.mul_add(L::splat(cpu, xy), x * L::splat(cpu, xx)),
        y.mul_add(L::splat(cpu, yy), x * L::splat(cpu, yx)),
    ];
    // If there are three normals or more, the angle between at least one of them and the point is less than a right
    // angle.
    let mut most = L::splat(cpu, L::Scalar::ZERO);
    for normal in &test.normals {
        let product = y.mul_add(L::splat(cpu, normal[1]), x * L::splat(cpu, normal[0]));
        most = product.larger(most);
    }
    // The product is NaN if the point is NaN, even if the factor is 0.
    let round = L::splat(cpu, test.bulge) * y.mul_add(y, x * x);
    let power = (most * w).mul_add(L::splat(cpu, test.slant), round);
    (power, (w * w) * L::splat(cpu, test.limit))
}

/// Returns 0 for points that a polygon passes and 2 for others, by the number of edges that a ray from the point
/// crosses.
#[cfg_attr(not(debug_assertions), inline(always))]
fn side<L: Lanes>(cpu: Cpu<L>, edges: &[Edge<L::Scalar>], is_obstruction: bool, [x, y]: [L; 2], w: L) -> L {
    let zero = L::splat(cpu, L::Scalar::ZERO);
    let two = L::splat(cpu, L::Scalar::ONE + L::Scalar::ONE);
    let mut side = if is_obstruction { zero } else { two };
    for Edge { lower, upper, along } in edges {
        let [x0, y0] = [w * L::splat(cpu, lower[0]), w * L::splat(cpu, lower[1])];
        let is_level = L::both(y0.less_equal(y), y.less(w * L::splat(cpu, *upper)));
        let [dx, dy] = [L::splat(cpu, along[0]), L::splat(cpu, along[1])];
        let is_left = ((x - x0) * dy).less((y - y0) * dx);
        side = L::select(L::both(is_level, is_left), two - side, side);
    }
    side
}
