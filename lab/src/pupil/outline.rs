//! The outline of the true pupil of a film point: the slopes of the rays that pass the lens.
//!
//! A grid of rays finds the open region, its centroid and its components. From the centroid, the edge is then found
//! along equally spaced directions, to the last bit. The true pupil is an intersection of warped disks and usually
//! star-shaped about its centroid; if it is not, the outline is the outermost edge, and a flag reports this.

use std::f64::consts::{PI, TAU};

use realistic_optics::lens::{cos4, pupil::SlopeDisk};
use realistic_trace::kernel::{Kernel, PlaneRays, RayBuffer};

/// The pupil of a film point, in slopes (dx/dz, dy/dz) at that point.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Centroid.
    pub center: [f64; 2],
    /// Points of the edge, at equally spaced angles about the centroid, counter-clockwise from +x.
    pub points: Vec<[f64; 2]>,
    /// Connected components of the open region, at the resolution of the grid.
    pub pieces: usize,
    /// Whether every direction from the centroid leaves the region exactly once.
    pub star_shaped: bool,
    /// Area in the plane of slopes.
    pub slope_area: f64,
    /// Film irradiance for unit radiance, ∫ cos⁴ d(slope)² over the region.
    pub irradiance: f64,
}

/// Cells along the disk's diameter in the first search.
const GRID: usize = 192;
/// Steps along a direction in the search for several edges.
const STEPS: u32 = 96;

/// Bisections of a step along a direction, which find the edge to the last bit.
const HALVINGS: u32 = 52;

impl Outline {
    /// Finds the pupil of the film point `point` on film at `film` (z in lens space). The pupil lies in `cover`;
    /// `directions` (3 or more) is the number of points found on its edge. `kernel` traces from the film to the scene.
    /// Returns `None` if no ray passes.
    pub fn of(
        kernel: &Kernel<f64>,
        film: f64,
        point: [f64; 2],
        cover: SlopeDisk,
        directions: usize,
    ) -> Option<Self> {
        Self::of_region(cover, directions, |slopes| {
            let count = slopes.len();
            let [x, y] = point.map(|at| vec![at; count]);
            let [slope_x, slope_y] =
                [0, 1].map(|axis| slopes.iter().map(|own| own[axis]).collect::<Vec<_>>());
            let mut out = RayBuffer::new(count);
            let from = PlaneRays { plane: film, x: &x, y: &y, slope_x: &slope_x, slope_y: &slope_y };
            kernel.trace_batch(&from, &mut out.rays());
            (0..count).map(|i| out.get(i).is_some()).collect()
        })
    }

    /// Finds the outline of a region; `passes` tests many slopes at once.
    fn of_region(
        cover: SlopeDisk,
        directions: usize,
        passes: impl Fn(&[[f64; 2]]) -> Vec<bool>,
    ) -> Option<Self> {
        let grid = Grid::of(cover, &passes);
        let center = grid.center()?;
        let mut star_shaped = passes(&[center])[0];
        let towards: Vec<[f64; 2]> = (0..directions)
            .map(|i| (TAU * i as f64 / directions as f64).sin_cos())
            .map(|(sin, cos)| [cos, sin])
            .collect();
        let at = |[cos, sin]: [f64; 2], radius: f64| [center[0] + radius * cos, center[1] + radius * sin];
        // For every direction, a radius inside and a radius outside its outermost edge.
        let mut brackets: Vec<[f64; 2]> = towards
            .iter()
            .map(|&toward| {
                // The region lies within the cover, whatever the centroid.
                let end = chord(cover, center, toward);
                let step = |i: u32| end * f64::from(i) / f64::from(STEPS);
                let open = passes(&(0..=STEPS).map(|i| at(toward, step(i))).collect::<Vec<_>>());
                star_shaped &= open.windows(2).filter(|pair| pair[0] != pair[1]).count() <= 1;
                match open.iter().rposition(|&open| open) {
                    Some(last) => [step(last as u32), step(STEPS.min(last as u32 + 1))],
                    None => [0.0; 2],
                }
            })
            .collect();
        for _ in 0..HALVINGS {
            let middles: Vec<f64> =
                brackets.iter().map(|[inside, beyond]| f64::midpoint(*inside, *beyond)).collect();
            let slopes: Vec<_> =
                towards.iter().zip(&middles).map(|(&toward, &middle)| at(toward, middle)).collect();
            for ((bracket, middle), open) in brackets.iter_mut().zip(middles).zip(passes(&slopes)) {
                bracket[usize::from(!open)] = middle;
            }
        }
        let radii: Vec<f64> = brackets.iter().map(|[inside, _]| *inside).collect();
        let points = towards.iter().zip(&radii).map(|(&toward, &radius)| at(toward, radius)).collect();
        let (slope_area, irradiance) =
            if star_shaped { integrals(center, &radii) } else { (grid.slope_area(), grid.irradiance()) };
        Some(Self { center, points, pieces: grid.components(), star_shaped, slope_area, irradiance })
    }
}

/// Integrates area and irradiance of a star-shaped region, by the trapezoidal rule in angle and Simpson's rule along
/// each radius.
fn integrals(center: [f64; 2], radii: &[f64]) -> (f64, f64) {
    const PARTS: u32 = 64;
    let step = TAU / radii.len() as f64;
    let (mut area, mut irradiance) = (0.0, 0.0);
    for (i, radius) in radii.iter().enumerate() {
        let (sin, cos) = (step * i as f64).sin_cos();
        area += step * radius * radius / 2.0;
        for part in 0..=PARTS {
            let weight = if part % PARTS == 0 { 1.0 } else { f64::from(2 + 2 * (part % 2)) };
            let r = radius * f64::from(part) / f64::from(PARTS);
            let cos4 = cos4([center[0] + r * cos, center[1] + r * sin]);
            irradiance += step * weight / f64::from(3 * PARTS) * radius * r * cos4;
        }
    }
    (area, irradiance)
}

/// Returns the distance from `from`, a point in the disk, to the disk's edge in the unit direction `direction`.
fn chord(disk: SlopeDisk, from: [f64; 2], direction: [f64; 2]) -> f64 {
    let [x, y] = [from[0] - disk.center[0], from[1] - disk.center[1]];
    let along = x * direction[0] + y * direction[1];
    let outside = x * x + y * y - disk.radius * disk.radius;
    -along + (along * along - outside).max(0.0).sqrt()
}

/// The open cells of a square grid over the disk.
struct Grid {
    cover: SlopeDisk,
    open: Vec<bool>,
}

impl Grid {
    fn of(cover: SlopeDisk, passes: impl Fn(&[[f64; 2]]) -> Vec<bool>) -> Self {
        let mut grid = Self { cover, open: vec![false; GRID * GRID] };
        let is_inside = |cell: &usize| {
            let [x, y] = grid.slopes(*cell);
            let offset = [x - cover.center[0], y - cover.center[1]];
            offset.iter().map(|d| d * d).sum::<f64>() <= cover.radius * cover.radius
        };
        let inside: Vec<usize> = (0..GRID * GRID).filter(is_inside).collect();
        let slopes: Vec<_> = inside.iter().map(|cell| grid.slopes(*cell)).collect();
        for (cell, open) in inside.into_iter().zip(passes(&slopes)) {
            grid.open[cell] = open;
        }
        grid
    }

    fn step(&self) -> f64 {
        2.0 * self.cover.radius / GRID as f64
    }

    fn slopes(&self, cell: usize) -> [f64; 2] {
        let at = |i: usize| (i as f64 + 0.5) * self.step() - self.cover.radius;
        [self.cover.center[0] + at(cell % GRID), self.cover.center[1] + at(cell / GRID)]
    }

    fn cells(&self) -> impl Iterator<Item = [f64; 2]> {
        self.open.iter().enumerate().filter(|&(_, &open)| open).map(|(cell, _)| self.slopes(cell))
    }

    fn center(&self) -> Option<[f64; 2]> {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for [x, y] in self.cells() {
            sum = [sum[0] + x, sum[1] + y];
            count += 1.0;
        }
        (count > 0.0).then(|| sum.map(|sum| sum / count))
    }

    fn slope_area(&self) -> f64 {
        self.cells().count() as f64 * self.step() * self.step()
    }

    fn irradiance(&self) -> f64 {
        self.cells().map(cos4).sum::<f64>() * self.step() * self.step()
    }

    /// Counts components that touch neither along an edge nor at a corner.
    fn components(&self) -> usize {
        let mut left = self.open.clone();
        let mut components = 0;
        let mut todo = Vec::new();
        for start in 0..left.len() {
            if !left[start] {
                continue;
            }
            components += 1;
            left[start] = false;
            todo.push(start);
            while let Some(cell) = todo.pop() {
                let (x, y) = (cell % GRID, cell / GRID);
                for y in y.saturating_sub(1)..=(y + 1).min(GRID - 1) {
                    for x in x.saturating_sub(1)..=(x + 1).min(GRID - 1) {
                        let near = y * GRID + x;
                        if left[near] {
                            left[near] = false;
                            todo.push(near);
                        }
                    }
                }
            }
        }
        components
    }
}

/// Returns the share of a disk's area that a region in it covers: the acceptance rate of samples taken in that disk.
pub fn acceptance(slope_area: f64, disk: SlopeDisk) -> f64 {
    slope_area / (PI * disk.radius * disk.radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_camera::sampling::PupilDisk;
    use realistic_optics::{
        imaging::irradiance,
        lens::{Lens, first_order::FirstOrder},
        prescription::{catalogue, read},
        trace::Path,
    };

    fn pupil(lens: &Lens, radius: f64) -> (Path, f64, SlopeDisk, Option<Outline>) {
        let film = FirstOrder::of(lens).expect("focal").rear_focal_point;
        let cover = PupilDisk::rear(lens, film, radius).expect("behind").seen_from([radius, 0.0]);
        let path = Path::film_to_scene(lens);
        let outline = Outline::of(&Kernel::along(&path), film, [radius, 0.0], cover, 360);
        (path, film, cover, outline)
    }

    #[test]
    fn a_bare_stop_behind_the_glass_is_a_circle() {
        // Light reaches the stop first: the stop's own edge is the pupil.
        let lens = read("t", b"60 3 1.5 30\n-60 5 1 30\n0 0 0 8\n").expect("a lens");
        let lens = Lens::at_d_line(&lens);
        let (_, film, _, outline) = pupil(&lens, 6.0);
        let outline = outline.expect("lit");
        let distance = lens.rear().vertex - film;
        assert!(outline.star_shaped && outline.pieces == 1);
        for [x, y] in &outline.points {
            let [x, y] = [6.0 + x * distance, y * distance];
            assert!((x.hypot(y) - 4.0).abs() < 1e-9, "({x}, {y})");
        }
        let area = PI * 16.0 / (distance * distance);
        assert!((outline.slope_area / area - 1.0).abs() < 1e-4, "{} {area}", outline.slope_area);
    }

    #[test]
    fn irradiance_is_that_of_a_grid_and_exact_on_the_axis() {
        // The telephone's lens is excluded: its pupil is a ten-thousandth of the rear element's disk, so the grid has
        // only a few points in the pupil.
        for name in catalogue::round().filter(|name| *name != "phone.4mm") {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            // The shortest lenses illuminate less film.
            let focal_length = FirstOrder::of(&lens).expect("focal").focal_length;
            let size = if focal_length < 8.0 { focal_length / 16.0 } else { 1.0 };
            for radius in [0.0, 4.0, 9.0].map(|radius| radius * size) {
                let (path, film, cover, outline) = pupil(&lens, radius);
                let outline = outline.expect("lit");
                assert!(outline.star_shaped && outline.pieces == 1, "{name} at {radius}");
                let survey = irradiance::survey(&path, film, [radius, 0.0], cover, cover, 256);
                let error = (outline.irradiance / survey.irradiance - 1.0).abs();
                assert!(error < 4e-3, "{name} at {radius}: {error}");
                if radius == 0.0 {
                    let exact = irradiance::on_axis(&path, film, cover.radius);
                    assert!((outline.irradiance / exact - 1.0).abs() < 1e-6, "{name}");
                }
            }
        }
    }

    #[test]
    fn dark_film_has_no_outline() {
        let lens = Lens::at_d_line(&catalogue::find("fisheye.10mm").expect("listed"));
        assert_eq!(pupil(&lens, 40.0).3, None);
    }

    #[test]
    fn two_components_and_a_ring_differ_from_a_disk() {
        let cover = SlopeDisk { center: [0.0, 0.0], radius: 1.0 };
        let each = |passes: fn([f64; 2]) -> bool| {
            move |slopes: &[[f64; 2]]| slopes.iter().copied().map(passes).collect::<Vec<bool>>()
        };
        let components = |passes: fn([f64; 2]) -> bool| Grid::of(cover, each(passes)).components();
        assert_eq!(components(|[x, y]| x.hypot(y) < 0.5), 1);
        assert_eq!(components(|[x, _]| x.abs() > 0.3), 2);
        assert_eq!(components(|_| false), 0);
        let ring = |[x, y]: [f64; 2]| (0.3..0.6).contains(&x.hypot(y));
        let outline = Outline::of_region(cover, 90, each(ring)).expect("open");
        assert!(!outline.star_shaped && outline.pieces == 1);
        assert!((outline.slope_area / (PI * 0.27) - 1.0).abs() < 0.02);
        assert!(outline.points.iter().all(|[x, y]| (x.hypot(*y) - 0.6).abs() < 0.01), "the outer edge");
        let disk = |[x, y]: [f64; 2]| (x - 0.2).hypot(y) < 0.5;
        let outline = Outline::of_region(cover, 90, each(disk)).expect("open");
        assert!(outline.star_shaped && (acceptance(outline.slope_area, cover) - 0.25).abs() < 1e-3);
    }
}
