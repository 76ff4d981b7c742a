//! The map from a spot's plane to film or stop that fits places best, and how far off it is.

use super::{
    super::fan::{Fan, Image, LEAST_BEND, MOST_BEND},
    probe::Place,
};
use crate::numeric::minimum;

/// The map from the plane to the film that fits these places best, and how far off it is.
pub(super) fn fit(fan: &Fan, places: &[Place]) -> Image {
    let ends = [LEAST_BEND, MOST_BEND].map(|bend| bend / fan.farthest().powi(2));
    let bend = minimum(ends[0], ends[1], 0.02, |bend| fit_bent(fan, places, bend).spread);
    let [straight, bent] = [0.0, bend].map(|bend| fit_bent(fan, places, bend));
    if bent.spread < straight.spread { bent } else { straight }
}

/// The same with a given bend.
pub(super) fn fit_bent(fan: &Fan, places: &[Place], bend: f64) -> Image {
    let count = places.len().max(1) as f64;
    let bent = |[a, b]: [f64; 2]| {
        let stretch = 1.0 + bend * fan.square([a, b]);
        [stretch * (a - fan.center), stretch * b]
    };
    let (mut middle, mut place) = (0.0, 0.0);
    for (point, at) in places {
        middle += bent(*point)[0] / count;
        place += at[0] / count;
    }
    // Of each axis, the products of both coordinates and the squares of the first.
    let (mut products, mut squares) = ([0.0; 2], [0.0; 2]);
    for (point, at) in places {
        let [a, b] = bent(*point);
        for (i, (from, to)) in [(a - middle, at[0] - place), (b, at[1])].into_iter().enumerate() {
            products[i] += from * to;
            squares[i] += from * from;
        }
    }
    let [along, across] = [0, 1].map(|i| if squares[i] > 0.0 { products[i] / squares[i] } else { 0.0 });
    let image = Image { place: place - along * middle, along, across, bend, spread: 0.0 };
    let spread = places.iter().map(|(point, at)| image.off_square(fan, *point, *at)).fold(0.0, f64::max);
    Image { spread: spread.sqrt(), ..image }
}

impl Image {
    /// How far from where it is expected a ray through a point reaches the film.
    pub fn off(&self, fan: &Fan, point: [f64; 2], at: [f64; 2]) -> f64 {
        self.off_square(fan, point, at).sqrt()
    }

    fn off_square(&self, fan: &Fan, [a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        let stretch = 1.0 + self.bend * fan.square([a, b]);
        let along = self.place + self.along * stretch * (a - fan.center) - x;
        let across = self.across * stretch * b - y;
        along * along + across * across
    }
}
