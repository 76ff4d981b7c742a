//! The rays of a ghost, for a drawing: from a lamp at infinity through a lens, reflected at two of its surfaces.

use super::rays::TracedRay;
use realistic_optics::lens::{Lens, Ray, refraction::Refraction};
use realistic_optics::trace::{Direction, Path};

/// Two surfaces, counted from 0 at the scene side.
pub type Pair = [usize; 2];

/// Traces `count` rays parallel to the axis, spread over the front surface. They are reflected at the second surface of
/// the pair, then at the first, and go on to the film at z = `film`.
pub fn rays(lens: &Lens, film: f64, [near, far]: Pair, count: u32) -> Vec<TracedRay> {
    let path = Path::<f64>::reflected(lens, Direction::SceneToFilm, Refraction::Fused, [near, far]);
    let front = lens.front();
    let start = front.sagitta_range()[1] + front.semi_diameter;
    (0..count)
        .map(|i| {
            let share = if count > 1 { f64::from(i) / f64::from(count - 1) } else { 0.5 };
            let height = 0.98 * front.semi_diameter * (2.0 * share - 1.0);
            let ray = Ray { origin: [0.0, height, start], direction: [0.0, 0.0, -1.0] };
            let mut points = vec![[start, height]];
            let walk = path.walk_by(ray, |_, [_, y, z]| points.push([z, y]));
            let [_, dy, dz] = walk.ray.direction;
            let arrives = walk.blocked.is_none() && dz < 0.0;
            if arrives {
                let [z, y] = points[points.len() - 1];
                points.push([film, y + (film - z) * dy / dz]);
            }
            TracedRay { points, onward: arrives.then_some([dz, dy]) }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn rays_turn_at_the_two_surfaces_and_nowhere_else() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").unwrap());
        let film = lens.rear().vertex - 36.0;
        let found = rays(&lens, film, [2, 6], 41);
        let arrived: Vec<&TracedRay> = found.iter().filter(|ray| ray.onward.is_some()).collect();
        assert!(arrived.len() > 3, "{}", arrived.len());
        for ray in arrived {
            // The start, surfaces 0 to 6, 5 to 2 and 3 to 10, and the film.
            assert_eq!(ray.points.len(), 1 + 7 + 4 + 8 + 1);
            let turns: Vec<usize> = (1..ray.points.len() - 1)
                .filter(|&i| {
                    (ray.points[i][0] < ray.points[i - 1][0]) != (ray.points[i + 1][0] < ray.points[i][0])
                })
                .collect();
            assert_eq!(turns, [7, 11]);
            assert_eq!(ray.points[ray.points.len() - 1][0], film);
        }
    }
}
