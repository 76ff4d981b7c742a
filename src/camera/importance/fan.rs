//! The region of a plane that directions toward a lens are sampled from: a polygon about a centre, symmetric about the
//! plane of the axis and the point, cut where the film ends. Two numbers in, a point of it and its density out; the
//! density is the same everywhere.

use std::f64::consts::PI;

use crate::camera::pipeline::on_demand::OnDemand;

/// Sectors of a half of the polygon.
pub(super) const SECTORS: usize = 32;
/// Angle of a sector.
pub(super) const SECTOR: f64 = PI / SECTORS as f64;

/// The least bend ρ² with which ρ (1 + bend ρ²) grows, and less.
const MONOTONE: f64 = -0.32;
/// The least that images are fitted with: fans grow later.
pub(super) const LEAST_BEND: f64 = -0.2;
/// The largest.
pub(super) const MOST_BEND: f64 = 0.6;
/// Steps of Newton's iteration that take a bent distance back.
const NEWTON: u32 = 8;

/// The directions of the polygon's corners.
fn directions() -> &'static [[f64; 2]; SECTORS + 1] {
    static DIRECTIONS: OnDemand<[[f64; 2]; SECTORS + 1]> = OnDemand::new();
    DIRECTIONS.get_or_make(|| {
        std::array::from_fn(|knot| {
            let (sin, cos) = (SECTOR * knot as f64).sin_cos();
            [cos, if knot == SECTORS { 0.0 } else { sin }]
        })
    })
}

/// A polygon about (`center`, 0), in a frame scaled by `extent`: its corners lie `reach` away from the centre, at equal
/// angles from 0 to π and, mirrored, on to 2π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fan {
    pub center: f64,
    pub extent: [f64; 2],
    pub reach: [f64; SECTORS + 1],
}

/// Where points of the plane are imaged on the film, about: at (`place` + `along` a', `across` b') in the frame of the
/// point's azimuth, at most `spread` away, mm. (a', b') is the point as it is seen from the centre, times 1 + `bend` ρ²,
/// ρ being its distance over the extent: what spherical aberration does to a large blur.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image {
    pub place: f64,
    pub along: f64,
    pub across: f64,
    pub bend: f64,
    pub spread: f64,
}

/// The part of the film that makes the picture: its middle, and half its width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub center: [f64; 2],
    pub half: [f64; 2],
}

/// What images must lie within: p · n <= distance of a film point p, as [n, n, distance], or of a point of another plane.
pub(super) type Limit = [f64; 3];
/// Limits that cut a region, at most.
pub(super) const LIMITS: usize = 10;

impl Window {
    /// Its four sides.
    pub fn limits(&self) -> [Limit; 4] {
        let side = |axis: usize, sign: f64| {
            let distance = self.half[axis] + sign * self.center[axis];
            if axis == 0 { [sign, 0.0, distance] } else { [0.0, sign, distance] }
        };
        [side(0, 1.0), side(0, -1.0), side(1, 1.0), side(1, -1.0)]
    }
}

/// Where points are imaged, and within what those that are sampled must be; at most [`LIMITS`].
pub(super) type View<'a> = (&'a Image, &'a [Limit]);

/// A point of a region and its density per area.
pub(super) type Sampled = ([f64; 2], f64);

/// A half-plane: p · n + c >= 0, as [n, n, c].
type HalfPlane = [f64; 3];

impl Fan {
    /// A disk, and hardly more.
    pub fn disk(center: f64, radius: f64) -> Self {
        Self { center, extent: [radius; 2], reach: [1.0 / (SECTOR / 2.0).cos(); SECTORS + 1] }
    }

    /// A corner of the upper half.
    pub fn corner(&self, knot: usize) -> [f64; 2] {
        let ([cos, sin], reach) = (directions()[knot], self.reach[knot]);
        [self.center + self.extent[0] * reach * cos, self.extent[1] * reach * sin]
    }

    /// How far from the centre a point lies, over the distance of the edge there, and the sector that it lies in: at most 1
    /// inside.
    pub fn ratio(&self, [a, b]: [f64; 2]) -> (f64, usize) {
        let [x, y] = [(a - self.center) / self.extent[0], (b / self.extent[1]).abs()];
        let sector = ((y.atan2(x) / SECTOR) as usize).min(SECTORS - 1);
        // Where the half-line meets the edge: p = s V + t W of the sector's corners, over the sum of both.
        let ([c, d], [e, f]) = (directions()[sector], directions()[sector + 1]);
        let area = c * f - d * e;
        let (s, t) = ((x * f - y * e) / area, (c * y - d * x) / area);
        (s / self.reach[sector] + t / self.reach[sector + 1], sector)
    }

    /// The farthest that any point of it can lie from the centre, over the extent.
    pub fn farthest(&self) -> f64 {
        self.reach.iter().copied().fold(0.0, f64::max)
    }

    /// A point of the whole polygon, for two numbers in [0, 1].
    fn anywhere(&self, [u, v]: [f64; 2]) -> Option<Sampled> {
        let weights: [f64; SECTORS] = std::array::from_fn(|i| self.reach[i] * self.reach[i + 1]);
        let total: f64 = weights.iter().sum();
        let area = total * SECTOR.sin() * self.extent[0] * self.extent[1];
        let (half, u) = if u < 0.5 { (1.0, 2.0 * u) } else { (-1.0, 2.0 * u - 1.0) };
        let mut target = u * total;
        let mut sector = 0;
        while sector + 1 < SECTORS && target >= weights[sector] {
            target -= weights[sector];
            sector += 1;
        }
        let part = (target / weights[sector]).clamp(0.0, 1.0);
        let (first, last) = (self.corner(sector), self.corner(sector + 1));
        let out = v.sqrt();
        let a = self.center + out * (first[0] + part * (last[0] - first[0]) - self.center);
        let b = half * out * (first[1] + part * (last[1] - first[1]));
        let density = area.recip();
        (area > 0.0 && density.is_finite()).then_some(([a, b], density))
    }

    /// A point of what the polygon has within half-planes.
    fn within(&self, planes: &[HalfPlane], bend: f64, [u, v]: [f64; 2]) -> Option<Sampled> {
        let bent = |[a, b]: [f64; 2]| {
            let stretch = 1.0 + bend * self.square([a, b]);
            [self.center + stretch * (a - self.center), stretch * b]
        };
        let mut pieces: [Convex; 2 * SECTORS] = [Convex::EMPTY; 2 * SECTORS];
        let mut total = 0.0;
        for (i, piece) in pieces.iter_mut().enumerate() {
            let (sector, half) = if i < SECTORS { (i, 1.0) } else { (2 * SECTORS - 1 - i, -1.0) };
            let mirrored = |[a, b]: [f64; 2]| [a, half * b];
            let corners = [self.corner(sector), self.corner(sector + 1)].map(|corner| mirrored(bent(corner)));
            *piece = Convex::triangle([[self.center, 0.0], corners[0], corners[1]]);
            for plane in planes {
                piece.cut(plane);
            }
            piece.area = piece.measure();
            total += piece.area;
        }
        let density = total.recip();
        if !(total > 0.0 && density.is_finite()) {
            return None;
        }
        let mut target = u * total;
        let mut chosen = None;
        for piece in pieces.iter().filter(|piece| piece.area > 0.0) {
            chosen = Some(piece);
            if target < piece.area {
                break;
            }
            target -= piece.area;
        }
        let point = chosen?.sample(target, v);
        // Where that comes from: ρ (1 + bend ρ²) is known.
        let far = self.square(point).sqrt();
        let mut near = far;
        for _ in 0..NEWTON {
            near -= (near * (1.0 + bend * near * near) - far) / (1.0 + 3.0 * bend * near * near);
        }
        let square = bend * near * near;
        let shrink = 1.0 / (1.0 + square);
        let unbent = [self.center + shrink * (point[0] - self.center), shrink * point[1]];
        Some((unbent, density * (1.0 + square) * (1.0 + 3.0 * square)))
    }

    /// The square of how far a point lies from the centre, over the extent.
    pub fn square(&self, [a, b]: [f64; 2]) -> f64 {
        ((a - self.center) / self.extent[0]).powi(2) + (b / self.extent[1]).powi(2)
    }

    /// A point of the region, for two numbers in [0, 1]: the polygon, without what the first view that cuts it at all has
    /// outside its limits, seen at this azimuth (a unit vector). `None` where nothing is left.
    pub fn sample(&self, views: &[View<'_>], azimuth: [f64; 2], numbers: [f64; 2]) -> Option<Sampled> {
        for (image, limits) in views {
            let (planes, count) = self.planes(image, limits, azimuth)?;
            if count > 0 {
                let bend = image.bend.max(MONOTONE / self.farthest().powi(2));
                return self.within(&planes[..count], bend, numbers);
            }
        }
        self.anywhere(numbers)
    }

    /// The half-planes of points that are imaged within limits, and how many they are: those that have something outside.
    /// `None` where one has all outside.
    fn planes(
        &self,
        image: &Image,
        limits: &[Limit],
        [cos, sin]: [f64; 2],
    ) -> Option<([HalfPlane; LIMITS], usize)> {
        let Image { place, along, across, bend, spread } = *image;
        let farthest = self.farthest();
        let far = farthest * (1.0 + bend.max(0.0) * farthest * farthest);
        let radius = far * (along * self.extent[0]).abs().max((across * self.extent[1]).abs()) + spread;
        let (mut planes, mut count) = ([[0.0; 3]; LIMITS], 0);
        for [nx, ny, distance] in limits {
            // The point is x (cos, sin) + y (-sin, cos).
            let (x, y) = (nx * cos + ny * sin, ny * cos - nx * sin);
            let room = distance - x * place;
            if room + radius < 0.0 {
                return None;
            }
            if room < radius {
                planes[count] = [-x * along, -y * across, room + x * along * self.center + spread];
                count += 1;
            }
        }
        Some((planes, count))
    }
}

/// Corners, at most.
const CORNERS: usize = 3 + LIMITS;

/// Corners of a convex polygon: a triangle's, and one more a half-plane that cuts it.
#[derive(Clone, Copy)]
struct Convex {
    corners: [[f64; 2]; CORNERS],
    count: usize,
    area: f64,
}

impl Convex {
    const EMPTY: Self = Self { corners: [[0.0; 2]; CORNERS], count: 0, area: 0.0 };

    fn triangle([a, b, c]: [[f64; 2]; 3]) -> Self {
        let mut whole = Self::EMPTY;
        whole.corners[..3].copy_from_slice(&[a, b, c]);
        whole.count = 3;
        whole
    }

    /// Keeps what lies within a half-plane (I. Sutherland and G. Hodgman, "Reentrant Polygon Clipping", *Communications of
    /// the ACM* 17(1), 1974).
    fn cut(&mut self, [x, y, c]: &HalfPlane) {
        let height = |point: [f64; 2]| x * point[0] + y * point[1] + c;
        if self.corners[..self.count].iter().all(|corner| height(*corner) >= 0.0) {
            return;
        }
        let mut kept = Self::EMPTY;
        let mut add = |point: [f64; 2]| {
            if kept.count < kept.corners.len() {
                kept.corners[kept.count] = point;
                kept.count += 1;
            }
        };
        for i in 0..self.count {
            let (from, to) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (low, high) = (height(from), height(to));
            if low >= 0.0 {
                add(from);
            }
            if (low >= 0.0) != (high >= 0.0) {
                let part = low / (low - high);
                add([0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis])));
            }
        }
        *self = kept;
    }

    /// The areas of the triangles from the first corner, twice.
    fn doubles(&self) -> impl Iterator<Item = f64> {
        let [[x, y], ..] = self.corners;
        (2..self.count).map(move |i| {
            let ([a, b], [c, d]) = (self.corners[i - 1], self.corners[i]);
            ((a - x) * (d - y) - (b - y) * (c - x)).abs()
        })
    }

    fn measure(&self) -> f64 {
        self.doubles().sum::<f64>() / 2.0
    }

    /// The point that part of the area, at most all of it, and a number in [0, 1] stand for.
    fn sample(&self, part: f64, v: f64) -> [f64; 2] {
        let mut target = 2.0 * part;
        let mut triangle = 2;
        let mut along = 0.0;
        for (i, double) in (2..).zip(self.doubles()) {
            triangle = i;
            along = if double > 0.0 { (target / double).clamp(0.0, 1.0) } else { 0.0 };
            if target < double {
                break;
            }
            target -= double;
        }
        let (apex, from, to) = (self.corners[0], self.corners[triangle - 1], self.corners[triangle]);
        let out = v.sqrt();
        [0, 1].map(|axis| apex[axis] + out * (from[axis] + along * (to[axis] - from[axis]) - apex[axis]))
    }
}
