//! The tests of a ray's point against the apertures and obstructions of a surface, in numbers of any type.
//!
//! An ellipse, a rectangle and the opening of blades share one inequality ([`ConvexTest`]). A polygon counts the edges
//! that a ray from the point crosses ([`Edge`]). A picture has a transmission ([`PictureTest`]). The kernel evaluates the
//! same constants in lanes.

use std::sync::Arc;

use crate::prescription::{Aperture, BladeConstants, Outline, StopPicture};
use realistic_base::numeric::Real;

/// The test of one aperture or obstruction of a surface.
#[derive(Clone, Debug)]
pub struct ApertureTest<R> {
    /// The outline.
    pub outline: OutlineTest<R>,
    /// Whether points inside the outline are blocked, and not those outside.
    pub is_obstruction: bool,
    /// Distance from the axis to the farthest point inside the outline, mm.
    pub reach: R,
}

/// The test whether a point lies inside an outline.
#[derive(Clone, Debug)]
pub enum OutlineTest<R> {
    /// An ellipse, a rectangle, or the opening of blades.
    Convex(ConvexTest<R>),
    /// The edges of a polygon.
    Polygon(Box<[Edge<R>]>),
    /// A picture, which counts as outside where it is black.
    Picture(PictureTest<R>),
}

/// A picture in a surface: the place in [`StopPicture::cells`] of the point p is `axes` p + `offset`.
#[derive(Clone, Debug)]
pub struct PictureTest<R> {
    /// The picture.
    pub picture: Arc<StopPicture>,
    /// The rows of the matrix from x and y, mm, to column and row.
    pub axes: [[R; 2]; 2],
    /// Column and row of the axis.
    pub offset: [R; 2],
}

/// An inequality for the points inside a convex outline.
///
/// Let q = (`axes` (p - `center`)) for the point p, and m the largest dot product of q with a normal, or 0 without
/// normals. Then p is inside if `bulge` q² + `slant` m w <= `limit` w². Here w is 1, or the factor by which p was
/// multiplied to avoid a division; the centre is then multiplied by w, too.
#[derive(Clone, Debug)]
pub struct ConvexTest<R> {
    /// The centre, mm.
    pub center: [R; 2],
    /// The matrix that turns the outline's axes to x and y, and makes an ellipse a circle.
    pub axes: [[R; 2]; 2],
    /// Unit vectors from the centre to the middle of each straight or curved edge.
    pub normals: Box<[[R; 2]]>,
    /// Factor of q² in the inequality; 0 for straight edges.
    pub bulge: R,
    /// Factor of m in the inequality, mm.
    pub slant: R,
    /// Upper bound of the sum in the inequality, mm².
    pub limit: R,
}

/// An edge of a polygon from its lower to its upper end. A ray from (x, y) toward +x crosses the edge if the edge's y
/// extends from at most y to above y, and (x - x0) dy < (y - y0) dx. A horizontal edge is never crossed.
#[derive(Clone, Copy, Debug)]
pub struct Edge<R> {
    /// x and y of the lower end, mm.
    pub lower: [R; 2],
    /// y of the upper end, mm.
    pub upper: R,
    /// x and y of the vector from the lower to the upper end, mm.
    pub along: [R; 2],
}

impl<R: Real> ApertureTest<R> {
    /// Builds the test of an aperture in a surface with a clear semi-diameter, mm.
    pub fn new(aperture: &Aperture, semi_diameter: f64) -> Self {
        let convex = |scale: [f64; 2], normals: &[[f64; 2]], constants: BladeConstants| {
            let (sine, cosine) = aperture.rotation.to_radians().sin_cos();
            let BladeConstants { bulge, slant, limit } = constants;
            OutlineTest::Convex(ConvexTest {
                center: aperture.center.map(|part| R::from_f64(part * semi_diameter)),
                axes: [[cosine * scale[0], sine * scale[0]], [-sine * scale[1], cosine * scale[1]]]
                    .map(|row| row.map(R::from_f64)),
                normals: normals.iter().map(|normal| normal.map(R::from_f64)).collect(),
                bulge: R::from_f64(bulge),
                slant: R::from_f64(slant * semi_diameter),
                limit: R::from_f64(limit * semi_diameter * semi_diameter),
            })
        };
        let outline = match &aperture.outline {
            Outline::Ellipse(axes) => {
                let constants = BladeConstants { bulge: 1.0, slant: 0.0, limit: 1.0 };
                convex(axes.map(f64::recip), &[], constants)
            }
            Outline::Rectangle(half_widths) => {
                let normals = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
                let constants = BladeConstants { bulge: 0.0, slant: 1.0, limit: 1.0 };
                convex(half_widths.map(f64::recip), &normals, constants)
            }
            Outline::Blades(blades) => {
                let normals: Vec<[f64; 2]> = blades.normals().collect();
                convex([1.0; 2], &normals, blades.constants())
            }
            Outline::Polygon(vertices) => {
                let placed: Vec<[f64; 2]> =
                    aperture.placed(vertices).map(|vertex| vertex.map(|part| part * semi_diameter)).collect();
                let next = placed.iter().cycle().skip(1);
                let edges = placed.iter().zip(next).filter(|(from, to)| from[1] != to[1]);
                OutlineTest::Polygon(edges.map(|(from, to)| Edge::between(*from, *to)).collect())
            }
            Outline::Picture(picture) => {
                let (sine, cosine) = aperture.rotation.to_radians().sin_cos();
                let [[right, column], [up, row]] = picture.to_place();
                let axes = [[right * cosine, right * sine], [-up * sine, up * cosine]];
                let [cx, cy] = aperture.center;
                let offset =
                    [column - axes[0][0] * cx - axes[0][1] * cy, row - axes[1][0] * cx - axes[1][1] * cy];
                OutlineTest::Picture(PictureTest {
                    picture: Arc::clone(picture),
                    axes: axes.map(|row| row.map(|part| R::from_f64(part / semi_diameter))),
                    offset: offset.map(R::from_f64),
                })
            }
        };
        let reach = R::from_f64(aperture.reach() * semi_diameter);
        Self { outline, is_obstruction: aperture.is_obstruction, reach }
    }

    /// Returns whether the aperture passes a point of the surface, mm. An aperture blocks NaN.
    pub fn passes(&self, point: [R; 2]) -> bool {
        self.outline.contains(point) != self.is_obstruction
    }

    /// Returns the transmission at a point of the surface, mm, that the aperture passes: 1 except for a picture.
    pub fn transmission(&self, point: [R; 2]) -> f64 {
        match &self.outline {
            OutlineTest::Picture(test) => test.transmission(point),
            OutlineTest::Convex(_) | OutlineTest::Polygon(_) => 1.0,
        }
    }

    /// Returns the same test in numbers of another type.
    pub fn rounded<S: Real>(&self) -> ApertureTest<S> {
        let round = |number: R| S::from_f64(number.to_f64());
        let outline = match &self.outline {
            OutlineTest::Convex(ConvexTest { center, axes, normals, bulge, slant, limit }) => {
                OutlineTest::Convex(ConvexTest {
                    center: center.map(round),
                    axes: axes.map(|row| row.map(round)),
                    normals: normals.iter().map(|normal| normal.map(round)).collect(),
                    bulge: round(*bulge),
                    slant: round(*slant),
                    limit: round(*limit),
                })
            }
            OutlineTest::Polygon(edges) => OutlineTest::Polygon(
                edges
                    .iter()
                    .map(|Edge { lower, upper, along }| Edge {
                        lower: lower.map(round),
                        upper: round(*upper),
                        along: along.map(round),
                    })
                    .collect(),
            ),
            OutlineTest::Picture(PictureTest { picture, axes, offset }) => {
                OutlineTest::Picture(PictureTest {
                    picture: Arc::clone(picture),
                    axes: axes.map(|row| row.map(round)),
                    offset: offset.map(round),
                })
            }
        };
        ApertureTest { outline, is_obstruction: self.is_obstruction, reach: round(self.reach) }
    }
}

impl<R: Real> OutlineTest<R> {
    /// Returns whether a point lies inside the outline; false for NaN.
    pub fn contains(&self, [x, y]: [R; 2]) -> bool {
        match self {
            Self::Convex(test) => {
                let [x, y] = [x - test.center[0], y - test.center[1]];
                let [x, y] = test.axes.map(|[of_x, of_y]| of_x * x + of_y * y);
                let products = test.normals.iter().map(|[nx, ny]| *nx * x + *ny * y);
                let most = products.reduce(|most, product| if product > most { product } else { most });
                test.bulge * (x * x + y * y) + test.slant * most.unwrap_or(R::ZERO) <= test.limit
            }
            Self::Polygon(edges) => {
                let crosses = |edge: &&Edge<R>| {
                    let Edge { lower: [x0, y0], upper, along: [dx, dy] } = **edge;
                    y0 <= y && y < upper && (x - x0) * dy < (y - y0) * dx
                };
                edges.iter().filter(crosses).count() % 2 == 1
            }
            Self::Picture(test) => test.transmission([x, y]) > 0.0,
        }
    }
}

impl<R: Real> PictureTest<R> {
    /// Returns the transmission at a point, mm.
    pub fn transmission(&self, [x, y]: [R; 2]) -> f64 {
        let place = |axis: usize| self.axes[axis][0] * x + self.axes[axis][1] * y + self.offset[axis];
        self.picture.at([0, 1].map(|axis| place(axis).to_f64()))
    }
}

impl<R: Real> Edge<R> {
    /// Returns the edge between two vertices, mm, whose y differ.
    fn between(from: [f64; 2], to: [f64; 2]) -> Self {
        let (lower, upper) = if from[1] < to[1] { (from, to) } else { (to, from) };
        Self {
            lower: lower.map(R::from_f64),
            upper: R::from_f64(upper[1]),
            along: [upper[0] - lower[0], upper[1] - lower[1]].map(R::from_f64),
        }
    }
}
