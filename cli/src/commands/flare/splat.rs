//! Irradiance on film from landing points: converts the landings of a grid of cells to watts per pixel, multiplied by
//! any factors, such as a wavelength's shares of red, green and blue.
//!
//! The watts of each cell are spread as a tent, which reaches the landings of the neighbouring cells on either side.
//! Such tents add up to a constant, so an even light stays even. Whatever the map from the grid to the film, a tent's
//! total is the watts of its cell (for wide tents on average). In a fold of the map, the density is high and the
//! total is still right, because landings are never joined to form quadrilaterals.
//!
//! A cell lands at nearly the same position at neighbouring wavelengths. Landings that are too close for a tent to
//! resolve are spread as one.

use realistic_camera::Film;
use realistic_light::{Landing, Spray};

/// A film that accumulates light.
#[derive(Clone, Debug)]
pub struct Target {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// The film point at the raster's origin, mm, and the number of pixels per mm.
    origin: [f64; 2],
    per_mm: f64,
}

/// Largest number of points along one side of a tent: neighbouring landings that are farther apart are separated by
/// an edge, not by the width of a cell.
const MOST: f64 = 192.0;
/// Distance in pixels between opposite sides of a tent's parallelogram from which on the tent counts as wide.
const WIDE: f64 = 2.0;

impl Target {
    /// Makes a target of a film's pixels.
    pub fn new(film: &Film, size: [u32; 2]) -> Self {
        Self { size, origin: film.point(0.0, 0.0), per_mm: film.pixel().recip() }
    }

    /// Allocates `N` zeros for each pixel.
    pub fn dark<const N: usize>(&self) -> Vec<[f64; N]> {
        vec![[0.0; N]; self.size[0] as usize * self.size[1] as usize]
    }

    /// Returns the raster coordinates of a film point: the inverse of `Film::point`.
    fn raster(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(self.origin[0] - x) * self.per_mm, (y - self.origin[1]) * self.per_mm]
    }

    /// Returns an accumulator of light on pixels; light for which [spread](PendingLight::spread) is not called at the
    /// end is lost.
    pub fn light<'a, const N: usize>(&'a self, pixels: &'a mut [[f64; N]]) -> PendingLight<'a, N> {
        PendingLight { target: self, pixels, band: Vec::new() }
    }

    /// Adds watts as a tent about a position; the tent falls to 0 one step away in either direction.
    fn tent<const N: usize>(
        &self,
        pixels: &mut [[f64; N]],
        here: [f64; 2],
        steps: [[f64; 2]; 2],
        watts: [f64; N],
    ) {
        let reach = reach(steps);
        let is_near = (0..2).all(|axis| {
            here[axis] + reach[axis] >= 0.0 && here[axis] - reach[axis] <= f64::from(self.size[axis])
        });
        if !is_near {
            return;
        }
        if let Some(inverse) = inverse(steps) {
            return self.wide_tent(pixels, here, reach, inverse, watts);
        }
        // Points are at most half a pixel apart. An even light then ripples by at most 3 % along each side; for
        // points one pixel apart, it would ripple by an eighth.
        let points = steps.map(|[x, y]| (2.0 * x.hypot(y)).ceil().clamp(1.0, MOST));
        let numbers = points.map(|points| points as i32);
        let each = (points[0] * points[1]).recip();
        for i in 1 - numbers[0]..numbers[0] {
            let s = f64::from(i) / points[0];
            for j in 1 - numbers[1]..numbers[1] {
                let t = f64::from(j) / points[1];
                let position = [0, 1].map(|axis| here[axis] + s * steps[0][axis] + t * steps[1][axis]);
                let share = each * (1.0 - s.abs()) * (1.0 - t.abs());
                self.point(pixels, position, watts.map(|watts| watts * share));
            }
        }
    }

    /// Adds a tent that is at least [`WIDE`], by its height in the middle of each pixel. The heights of the tents of
    /// an even light then add up exactly to a constant. The sum of the heights of one tent differs from its watts by
    /// at most a share of 1/(4 s²), for s pixels per step; the sign of the difference depends on the tent's position.
    fn wide_tent<const N: usize>(
        &self,
        pixels: &mut [[f64; N]],
        here: [f64; 2],
        reach: [f64; 2],
        inverse: [[f64; 2]; 2],
        watts: [f64; N],
    ) {
        let range = |axis: usize| {
            let end = |at: f64| at.clamp(0.0, f64::from(self.size[axis])) as usize;
            end((here[axis] - reach[axis]).floor())..end((here[axis] + reach[axis]).ceil())
        };
        let [a, b] = inverse;
        let per_area = (a[0] * b[1] - a[1] * b[0]).abs();
        let top = watts.map(|watts| watts * per_area);
        let width = self.size[0] as usize;
        let columns = range(0);
        for row in range(1) {
            let y = row as f64 + 0.5 - here[1];
            let line = &mut pixels[row * width..][columns.clone()];
            for (column, pixel) in columns.clone().zip(line) {
                let x = column as f64 + 0.5 - here[0];
                let [s, t] = [a, b].map(|[by_x, by_y]| 1.0 - (by_x * x + by_y * y).abs());
                let height = s.max(0.0) * t.max(0.0);
                pixel.iter_mut().zip(top).for_each(|(sum, top)| *sum += top * height);
            }
        }
    }

    /// Adds watts to the four pixels around a position.
    fn point<const N: usize>(&self, pixels: &mut [[f64; N]], [x, y]: [f64; 2], watts: [f64; N]) {
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let [width, height] = self.size.map(f64::from);
        for (column, share_x) in [(left, 1.0 - (x - left)), (left + 1.0, x - left)] {
            for (row, share_y) in [(top, 1.0 - (y - top)), (top + 1.0, y - top)] {
                if column >= 0.0 && column < width && row >= 0.0 && row < height {
                    let pixel = &mut pixels[row as usize * self.size[0] as usize + column as usize];
                    pixel.iter_mut().zip(watts).for_each(|(sum, watts)| *sum += watts * share_x * share_y);
                }
            }
        }
    }
}

/// Light of the same cells at one wavelength after another, to be added to pixels.
pub struct PendingLight<'a, const N: usize> {
    target: &'a Target,
    pixels: &'a mut [[f64; N]],
    /// Light that is not spread yet, by cell; it comes from neighbouring wavelengths.
    band: Vec<Option<Cell<N>>>,
}

/// The light of a cell at some wavelengths.
struct Cell<const N: usize> {
    /// Raster coordinates of the cell's first landing.
    first: [f64; 2],
    /// Largest distance from `first`, pixels, of landings that are spread together: half a pixel, or half of the
    /// distance to the next cell if that is more, because a tent hides this difference.
    near: f64,
    /// Reach of the cell's tent, pixels.
    reach: [f64; 2],
    /// Watts of the cell, and the sum over landings of position times watts.
    sum: f64,
    moment: [f64; 2],
    /// Watts multiplied by the shares.
    watts: [f64; N],
}

impl<const N: usize> PendingLight<'_, N> {
    /// Adds the watts of a spray's cells, multiplied by each of `shares`.
    pub fn add(&mut self, spray: &Spray, shares: [f64; N]) {
        if self.band.len() != spray.cells.len() || !self.holds(spray) {
            self.spread();
        }
        self.band.resize_with(spray.cells.len(), || None);
        let position = |i: usize| spray.cells[i].map(|landing: Landing| self.target.raster(landing.point));
        for (i, landing) in spray.cells.iter().enumerate() {
            let (Some(Landing { watts, .. }), Some(here)) = (landing, position(i)) else { continue };
            let cell = self.band[i].get_or_insert_with(|| {
                let steps = steps(i, spray.side, here, position);
                let shorter = steps.map(|[x, y]| x.hypot(y)).into_iter().fold(f64::INFINITY, f64::min);
                let near = 0.5 * shorter.max(1.0);
                Cell { first: here, near, reach: reach(steps), sum: 0.0, moment: [0.0; 2], watts: [0.0; N] }
            });
            cell.sum += watts;
            cell.moment = [0, 1].map(|axis| cell.moment[axis] + watts * here[axis]);
            cell.watts = std::array::from_fn(|k| cell.watts[k] + watts * shares[k]);
        }
    }

    /// Whether every cell lands near enough to its first landing, or both landings lie, with their tents, beyond the
    /// same side of the film.
    fn holds(&self, spray: &Spray) -> bool {
        let near = |(cell, landing): (&Option<Cell<N>>, &Option<Landing>)| {
            let (Some(cell), Some(landing)) = (cell, landing) else { return true };
            let there = self.target.raster(landing.point);
            let is_beyond = |axis: usize| {
                let [from, to] = [cell.first[axis].min(there[axis]), cell.first[axis].max(there[axis])];
                to < -cell.reach[axis] || from > f64::from(self.target.size[axis]) + cell.reach[axis]
            };
            (cell.first[0] - there[0]).hypot(cell.first[1] - there[1]) <= cell.near || (0..2).any(is_beyond)
        };
        self.band.iter().zip(&spray.cells).all(near)
    }

    /// Spreads the light that is still pending.
    pub fn spread(&mut self) {
        let band = std::mem::take(&mut self.band);
        let side = band.len().isqrt();
        let position = |i: usize| {
            let cell: &Cell<N> = band[i].as_ref().filter(|cell| cell.sum > 0.0)?;
            Some(cell.moment.map(|moment| moment / cell.sum))
        };
        for (i, cell) in band.iter().enumerate() {
            let (Some(cell), Some(here)) = (cell, position(i)) else { continue };
            self.target.tent(self.pixels, here, steps(i, side, here, position), cell.watts);
        }
    }
}

/// Returns the steps from a cell's landing to those of its neighbours, along either axis of the grid.
fn steps(
    i: usize,
    side: usize,
    here: [f64; 2],
    position: impl Fn(usize) -> Option<[f64; 2]>,
) -> [[f64; 2]; 2] {
    let step = |number: usize, stride: usize| {
        let before = (number > 0).then(|| position(i - stride)).flatten();
        let after = (number + 1 < side).then(|| position(i + stride)).flatten();
        let (from, to, cells) = match (before, after) {
            (Some(before), Some(after)) => (before, after, 2.0),
            (Some(before), None) => (before, here, 1.0),
            (None, Some(after)) => (here, after, 1.0),
            (None, None) => (here, here, 1.0),
        };
        [0, 1].map(|axis| (to[axis] - from[axis]) / cells)
    };
    [step(i % side, 1), step(i / side, side)]
}

/// Returns the reach of a tent with these steps along each axis, pixels.
fn reach(steps: [[f64; 2]; 2]) -> [f64; 2] {
    [0, 1].map(|axis| steps[0][axis].abs() + steps[1][axis].abs() + 1.0)
}

/// Returns the map from pixels to multiples of the two steps of a tent; `None` unless the tent is at least [`WIDE`]
/// in every direction.
fn inverse([[ax, ay], [bx, by]]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let area = ax * by - ay * bx;
    let longest = ax.hypot(ay).max(bx.hypot(by));
    (area.abs() > WIDE * longest).then(|| [[by / area, -bx / area], [-ay / area, ax / area]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_camera::Raster;

    fn target() -> Target {
        Target::new(&Film::new(Raster { xres: 60, yres: 40 }, 36.0), [60, 40])
    }

    /// Makes a grid of cells that carry one watt each and land at the positions given by `map`.
    fn spray(side: usize, map: impl Fn(f64, f64) -> [f64; 2]) -> Spray {
        let cell = |i: usize| {
            let point = map((i % side) as f64, (i / side) as f64);
            Some(Landing { point, watts: 1.0 })
        };
        Spray { side, cells: (0..side * side).map(cell).collect() }
    }

    /// Returns the pixels of all sprays added one after another to the same pixels, and of each spray added to pixels
    /// of its own.
    fn spread_jointly_and_separately<const N: usize>(
        target: &Target,
        sprays: &[Spray],
        shares: &[[f64; N]],
    ) -> [Vec<[f64; N]>; 2] {
        let [mut joint, mut separate] = [target.dark(), target.dark()];
        let mut light = target.light(&mut joint);
        sprays.iter().zip(shares).for_each(|(spray, shares)| light.add(spray, *shares));
        light.spread();
        for (spray, shares) in sprays.iter().zip(shares) {
            add(target, &mut separate, spray, *shares);
        }
        [joint, separate]
    }

    fn add<const N: usize>(target: &Target, pixels: &mut [[f64; N]], spray: &Spray, shares: [f64; N]) {
        let mut light = target.light(pixels);
        light.add(spray, shares);
        light.spread();
    }

    #[test]
    fn every_watt_lands_wherever_the_map_folds() {
        let target = target();
        for map in [
            (|_: f64, _: f64| [1.0, 2.0]) as fn(f64, f64) -> [f64; 2],
            |x, y| [0.4 * (x - 10.0), 0.3 * (y - 10.0)],
            |x, y| [0.2 * (x - 10.0), 0.25 * (y - 10.0)],
            |x, y| [0.05 * (x - 10.0).powi(2) - 3.0, 0.3 * (y - 10.0)],
        ] {
            let mut pixels = target.dark();
            add(&target, &mut pixels, &spray(20, map), [0.5]);
            assert!((pixels.iter().flatten().sum::<f64>() - 200.0).abs() < 1e-9);
        }
    }

    #[test]
    fn an_even_light_is_even() {
        // Cells at distances of 1.7 and 2.3 pixels, on a skewed grid.
        let target = target();
        let mut pixels = target.dark();
        let askew = spray(40, |x, y| [0.85 * (x - 20.0) + 0.2 * y - 4.0, 1.15 * (y - 20.0) + 0.1 * x]);
        add(&target, &mut pixels, &askew, [1.0]);
        let inner = (14..26).flat_map(|row| (20..40).map(move |column| row * 60 + column));
        let (least, most) = inner.fold((f64::INFINITY, 0.0_f64), |(least, most), i| {
            (least.min(pixels[i][0]), most.max(pixels[i][0]))
        });
        assert!(most / least < 1.1, "{least} {most}");
    }

    #[test]
    fn wide_tents_are_even_and_keep_the_watts() {
        // Cells at distances of 5 pixels and more on a skewed grid, from far beyond one edge to far beyond the other.
        let target = target();
        let mut pixels = target.dark();
        let step = [[5.3, 1.1], [-1.7, 6.2]].map(|pixels| pixels.map(|x| x / target.per_mm));
        let map = |x: f64, y: f64| {
            let at = |axis: usize| (x - 20.0) * step[0][axis] + (y - 20.0) * step[1][axis];
            [at(0), at(1)]
        };
        add(&target, &mut pixels, &spray(41, map), [1.0]);
        let even = 1.0 / (5.3 * 6.2 + 1.1 * 1.7);
        assert!(pixels.iter().flatten().all(|watts| (watts / even - 1.0).abs() < 1e-9));
        // Few cells, all of which are on the film.
        let mut pixels = target.dark();
        add(&target, &mut pixels, &spray(4, |x, y| map(x + 18.3, y + 18.6)), [1.0]);
        let sum: f64 = pixels.iter().flatten().sum();
        assert!((sum / 16.0 - 1.0).abs() < 2e-3, "{sum}");
    }

    #[test]
    fn wavelengths_are_spread_jointly_where_no_cell_moves() {
        // A cell is 3 pixels wide; the grid moves from one wavelength to the next.
        let target = target();
        let moved = |pixels: f64| {
            let at = move |x: f64| (3.0 * (x - 4.0) + pixels) / target.per_mm;
            spray(8, move |x, y| [at(x), at(y)])
        };
        let sprays = |step: f64| [0.0, 1.0, 2.0, 3.0, 4.0].map(|number| moved(step * number));
        let bands = |step: f64| {
            let (mut pixels, all) = (target.dark(), sprays(step));
            let mut light = target.light(&mut pixels);
            light.add(&all[0], [1.0]);
            all.iter().take_while(|spray| light.holds(spray)).count()
        };
        assert_eq!([0.0, 0.2, 0.4, 0.6, 1.2].map(bands), [5, 5, 3, 2, 1]);
        let shares = [[1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [0.5, 0.0], [0.0, 0.5]];
        for step in [0.2, 0.6] {
            let [joint, separate] = spread_jointly_and_separately(&target, &sprays(step), &shares);
            // Each cell of 3 x 3 pixels has two watts of each colour. At a corner, the edges along both axes fall by
            // a third per pixel, and each colour lies a fifth of a pixel from the common middle.
            let even = 2.0 / 9.0;
            let off = joint.iter().flatten().zip(separate.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 0.15 * even, "{step}");
            for k in 0..2 {
                let sum = |pixels: &[[f64; 2]]| pixels.iter().map(|pixel| pixel[k]).sum::<f64>();
                assert!((sum(&joint) / sum(&separate) - 1.0).abs() < 1e-3, "{step}");
            }
        }
    }

    #[test]
    fn light_that_first_lands_off_the_film_is_spread_later() {
        // The light covers 2 x 2 pixels. At the first wavelength, it lies 3 pixels left of the film, or lands
        // nowhere; at each further wavelength, it lies farther right.
        let target = target();
        let at = |pixels: f64| {
            let position = move |x: f64, from: f64| from / target.per_mm + x * 0.25 / target.per_mm;
            // The raster's x falls as the film's x grows.
            spray(8, move |x, y| [position(-x, 33.0 - pixels), position(y, 0.0)])
        };
        let nowhere = Spray { side: 8, cells: vec![None; 64] };
        let later = [3.0, 9.0, 15.0].map(at);
        let shares = [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for first in [at(0.0), nowhere] {
            let [a, b, c] = later.clone();
            let [joint, separate] = spread_jointly_and_separately(&target, &[first, a, b, c], &shares);
            assert!(separate.iter().flatten().sum::<f64>() > 150.0);
            let off = joint.iter().flatten().zip(separate.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9);
        }
    }

    #[test]
    fn the_raster_is_the_films() {
        let film = Film::new(Raster { xres: 60, yres: 40 }, 36.0);
        let [x, y] = target().raster(film.point(12.5, 31.0));
        assert!((x - 12.5).abs() < 1e-9 && (y - 31.0).abs() < 1e-9);
    }
}
