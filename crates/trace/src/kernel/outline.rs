//! The tests of rays in lanes against shaped apertures and obstructions, with the constants of [`ApertureTest`], and
//! the transmission of a picture.

use realistic_base::numeric::Real;
use realistic_optics::trace::{ApertureTest, ConvexTest, Edge, OutlineTest, PictureTest};
use realistic_simd::{Cpu, Lanes, Scalar};

/// Returns the two sides of an aperture's inequality: the aperture passes a point if the first is at most the second.
/// The second is the transmission, if the aperture is a picture. The points, x and y in mm, were multiplied by `w`,
/// positive, so that shapes need no division.
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
        OutlineTest::Picture(picture) => {
            (L::splat(cpu, L::Scalar::LEAST), transmission(cpu, picture, point, w))
        }
    }
}

/// Returns the transmission of a picture, interpolated between the centres of its pixels; 0 outside it and for NaN.
#[cfg_attr(not(debug_assertions), inline(always))]
fn transmission<L: Lanes>(cpu: Cpu<L>, test: &PictureTest<L::Scalar>, [x, y]: [L; 2], w: L) -> L {
    let per_w = L::splat(cpu, L::Scalar::ONE) / w;
    let [x, y] = [x * per_w, y * per_w];
    let [from, to] = test.picture.borders();
    let mut place = [per_w; 2];
    let mut is_inside = x.less_equal(x);
    for axis in 0..2 {
        let ([of_x, of_y], offset) = (test.axes[axis], L::splat(cpu, test.offset[axis]));
        let at = y.mul_add(L::splat(cpu, of_y), x.mul_add(L::splat(cpu, of_x), offset));
        let [from, to] = [from[axis], to[axis]];
        is_inside = L::both(is_inside, L::splat(cpu, L::Scalar::from_f64(from)).less_equal(at));
        is_inside = L::both(is_inside, at.less_equal(L::splat(cpu, L::Scalar::from_f64(to))));
        place[axis] = at;
    }
    let [column, row] = [place[0].trunc(), place[1].trunc()];
    let [right, down] = [place[0] - column, place[1] - row];
    let cell = row.mul_add(L::splat(cpu, L::Scalar::from_f64(test.picture.stride() as f64)), column).whole();
    let [[a, b, c, d]] = L::look_up::<1, 1>(test.picture.cells(), cell, [0]);
    let [upper, lower] = [right.mul_add(c - a, a), right.mul_add(d - b, b)];
    down.mul_add(lower - upper, upper).or_zero(is_inside)
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
