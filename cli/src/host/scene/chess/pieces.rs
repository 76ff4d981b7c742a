//! Chess pieces of Staunton's pattern, turned on a lathe, with profiles that are smooth curves through a few points.
//! The knight is left out, because a lathe cannot make it.

use crate::host::scene::Sphere;
use crate::host::scene::solids::{Appearance, Block, Form, Rod, Turned};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A kind of piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    King,
    Queen,
    Bishop,
    Rook,
    Pawn,
}

/// Number of segments of a smooth curve between two of its points.
const STEPS: u8 = 5;
/// Slope below which a part of a profile is level.
const LEVEL: f32 = 1e-3;
/// Cosine of the angle between neighbouring segments below which there is an edge.
const EDGE: f32 = 0.75;

/// Radius and height of each point, mm, from the foot up. A repeated point makes an edge.
const KING: &[[f32; 2]] = &[
    [20.5, 0.0],
    [20.5, 0.0],
    [21.2, 2.5],
    [20.8, 5.5],
    [18.6, 8.0],
    [18.0, 8.6],
    [18.0, 8.6],
    [18.4, 10.0],
    [17.6, 12.5],
    [14.0, 16.5],
    [10.8, 22.0],
    [8.6, 30.0],
    [7.5, 39.0],
    [7.1, 47.0],
    [7.6, 53.6],
    [7.6, 53.6],
    [11.2, 55.0],
    [12.2, 56.6],
    [11.2, 58.2],
    [8.6, 59.2],
    [8.6, 59.2],
    [9.9, 60.4],
    [10.0, 61.6],
    [8.4, 63.0],
    [8.4, 63.0],
    [8.3, 66.0],
    [9.4, 73.0],
    [11.6, 81.0],
    [12.4, 83.4],
    [12.4, 83.4],
    [11.6, 85.2],
    [8.4, 87.8],
    [4.2, 89.8],
    [2.6, 90.6],
    [2.6, 90.6],
    [3.0, 91.8],
    [2.2, 93.0],
    [0.0, 93.4],
];
const QUEEN: &[[f32; 2]] = &[
    [19.5, 0.0],
    [19.5, 0.0],
    [20.2, 2.4],
    [19.8, 5.2],
    [17.8, 7.6],
    [17.2, 8.2],
    [17.2, 8.2],
    [17.5, 9.6],
    [16.6, 12.0],
    [13.2, 16.0],
    [10.2, 21.0],
    [8.1, 28.0],
    [7.0, 36.0],
    [6.7, 43.0],
    [7.1, 48.6],
    [7.1, 48.6],
    [10.6, 50.0],
    [11.5, 51.4],
    [10.6, 52.8],
    [8.1, 53.8],
    [8.1, 53.8],
    [9.2, 54.8],
    [9.3, 55.8],
    [7.9, 57.2],
    [7.9, 57.2],
    [7.8, 60.0],
    [8.8, 66.0],
    [11.2, 73.5],
    [12.2, 76.6],
    [12.2, 76.6],
    [9.8, 76.2],
    [9.4, 75.4],
    [9.4, 75.4],
    [7.4, 77.6],
    [4.4, 79.4],
    [2.2, 80.2],
    [2.2, 80.2],
    [3.3, 82.4],
    [2.9, 84.6],
    [0.0, 86.0],
];
const BISHOP: &[[f32; 2]] = &[
    [17.5, 0.0],
    [17.5, 0.0],
    [18.2, 2.2],
    [17.8, 4.8],
    [15.8, 7.0],
    [15.2, 7.6],
    [15.2, 7.6],
    [15.5, 8.8],
    [14.6, 11.0],
    [11.4, 14.6],
    [8.7, 19.0],
    [6.8, 25.0],
    [5.8, 32.0],
    [5.5, 37.4],
    [5.5, 37.4],
    [9.0, 38.8],
    [9.8, 40.0],
    [9.0, 41.2],
    [6.6, 42.2],
    [6.6, 42.2],
    [7.6, 43.2],
    [7.6, 44.2],
    [5.8, 45.6],
    [5.8, 45.6],
    [7.6, 49.4],
    [8.8, 54.0],
    [8.5, 58.6],
    [6.6, 63.2],
    [3.6, 67.2],
    [1.9, 68.8],
    [1.9, 68.8],
    [2.8, 70.4],
    [2.4, 72.2],
    [0.0, 73.2],
];
const ROOK: &[[f32; 2]] = &[
    [18.5, 0.0],
    [18.5, 0.0],
    [19.2, 2.3],
    [18.8, 5.0],
    [16.8, 7.3],
    [16.2, 7.9],
    [16.2, 7.9],
    [16.5, 9.2],
    [15.7, 11.4],
    [13.4, 14.6],
    [11.6, 19.0],
    [10.6, 25.0],
    [10.2, 32.0],
    [10.4, 37.0],
    [10.4, 37.0],
    [12.2, 39.4],
    [14.0, 41.4],
    [14.0, 41.4],
    [14.2, 49.0],
    [14.2, 49.0],
    [10.6, 49.0],
    [10.6, 49.0],
    [10.4, 46.5],
    [10.4, 46.5],
    [0.0, 46.5],
];
const PAWN: &[[f32; 2]] = &[
    [15.5, 0.0],
    [15.5, 0.0],
    [16.2, 2.0],
    [15.8, 4.4],
    [13.9, 6.4],
    [13.3, 7.0],
    [13.3, 7.0],
    [13.6, 8.2],
    [12.6, 10.4],
    [9.4, 14.0],
    [7.2, 18.4],
    [5.9, 23.4],
    [5.4, 28.4],
    [5.4, 28.4],
    [8.6, 29.8],
    [9.4, 31.0],
    [8.6, 32.2],
    [5.8, 33.2],
];

/// Makes a piece of a given material, standing at a point.
pub fn solids(piece: Piece, foot: Vec3, appearance: Appearance) -> Vec<(Form, Appearance)> {
    let up = |y: f32| foot + y * Vec3::Y;
    let ball = |centre: Vec3, radius: f32| Form::Ball(Sphere::resting(centre, radius));
    let around = |count: u8, radius: f32, y: f32| {
        (0..count).map(move |index| {
            let direction = Vec2::from_angle(TAU * f32::from(index) / f32::from(count));
            (up(y) + radius * Vec3::new(direction.x, 0.0, direction.y), direction)
        })
    };
    let mut forms: Vec<Form>;
    match piece {
        Piece::King => {
            forms = turned(KING, foot).collect();
            let bar = |ends: [Vec3; 2]| Form::Rod(Rod { ends, radius: 1.5 });
            forms.push(bar([up(92.0), up(104.0)]));
            forms.push(bar([up(99.6) - 4.4 * Vec3::X, up(99.6) + 4.4 * Vec3::X]));
        }
        Piece::Queen => {
            forms = turned(QUEEN, foot).collect();
            forms.extend(around(9, 10.9, 77.0).map(|(centre, _)| ball(centre, 2.1)));
        }
        Piece::Bishop => forms = turned(BISHOP, foot).collect(),
        Piece::Rook => {
            forms = turned(ROOK, foot).collect();
            let merlon = |(centre, turn): (Vec3, Vec2)| {
                Form::Block(Block {
                    centre,
                    half: Vec3::new(1.9, 2.6, 4.2),
                    turn: Vec2::new(turn.x, -turn.y),
                })
            };
            forms.extend(around(6, 12.1, 50.6).map(merlon));
        }
        Piece::Pawn => {
            forms = turned(PAWN, foot).collect();
            forms.push(ball(up(40.0), 8.4));
        }
    }
    forms.into_iter().map(|form| (form, appearance)).collect()
}

/// Makes the turned parts of this profile, which lists radius and height of its points from the foot up.
pub fn turned(profile: &[[f32; 2]], foot: Vec3) -> impl Iterator<Item = Form> {
    let points = smooth(profile);
    let normals: Vec<Vec2> =
        points.windows(2).map(|ends| (ends[1] - ends[0]).normalize()).map(|t| Vec2::new(t.y, -t.x)).collect();
    let shared = |index: usize, other: Option<&Vec2>| match other {
        Some(other) if normals[index].dot(*other) > EDGE => (normals[index] + *other).normalize(),
        _ => normals[index],
    };
    let forms: Vec<Form> = (0..normals.len())
        .map(|index| {
            let mut ends = [
                (points[index], shared(index, index.checked_sub(1).and_then(|before| normals.get(before)))),
                (points[index + 1], shared(index, normals.get(index + 1))),
            ];
            if ends[0].0.y > ends[1].0.y {
                ends.reverse();
            }
            let [(low, below), (high, above)] = ends;
            Form::Turned(Turned {
                foot: foot + low.y * Vec3::Y,
                // Rounding must not turn a ring into a steep cone.
                height: if high.y - low.y < LEVEL * (high.x - low.x).abs() { 0.0 } else { high.y - low.y },
                radii: [low.x, high.x],
                normals: [below, above],
            })
        })
        .collect();
    forms.into_iter()
}

/// Returns points of the Catmull-Rom curve through the profile; a repeated point ends one curve and begins another.
fn smooth(profile: &[[f32; 2]]) -> Vec<Vec2> {
    let points: Vec<Vec2> = profile.iter().copied().map(Vec2::from).collect();
    let mut curve = vec![points[0]];
    for index in 0..points.len() - 1 {
        let [b, c] = [points[index], points[index + 1]];
        if b == c {
            continue;
        }
        let [a, d] = [points[index.saturating_sub(1)], points[(index + 2).min(points.len() - 1)]];
        for step in 1..=STEPS {
            let t = f32::from(step) / f32::from(STEPS);
            let [m, n] = [0.5 * (c - a), 0.5 * (d - b)];
            let (square, cube) = (t * t, t * t * t);
            let point = (2.0 * cube - 3.0 * square + 1.0) * b
                + (cube - 2.0 * square + t) * m
                + (3.0 * square - 2.0 * cube) * c
                + (cube - square) * n;
            curve.push(point.max(Vec2::ZERO));
        }
    }
    curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::shapes::Ray;
    use crate::host::scene::solids::Solids;
    use crate::host::scene::{Finish, Material};

    #[test]
    fn every_piece_is_closed_and_as_tall_as_its_profile_says() {
        let appearance = Appearance::Plain(Material::new(Vec3::ONE, Finish::Matte));
        let heights = [
            (Piece::King, 105.5),
            (Piece::Queen, 86.0),
            (Piece::Bishop, 73.2),
            (Piece::Rook, 53.2),
            (Piece::Pawn, 48.4),
        ];
        for (piece, height) in heights {
            let solids: Solids = solids(piece, Vec3::ZERO, appearance).into_iter().collect();
            let top = |x: f32, z: f32| {
                let ray = Ray { origin: Vec3::new(x, 300.0, z), direction: Vec3::NEG_Y, time: 0.5 };
                solids.nearest(&ray, 0.0, f32::INFINITY).map(|(hit, _)| 300.0 - hit.distance)
            };
            let grid = || {
                (-60..=60_i8)
                    .flat_map(|x| (-60..=60_i8).map(move |z| [x, z].map(|at| f32::from(at) * 0.25 + 0.01)))
            };
            let highest = grid().filter_map(|[x, z]| top(x, z)).fold(0.0, f32::max);
            assert!((highest - height).abs() < 0.4, "{piece:?}: {highest}");
            // The piece has no hole that is visible from above.
            assert!(
                grid().filter(|[x, z]| x.hypot(*z) < 14.9).all(|[x, z]| top(x, z).is_some()),
                "{piece:?}"
            );
            // The piece has no hole that is visible from the side either.
            for index in 0..200_u8 {
                let height = f32::from(index) / 200.0 * 28.0 + 0.1;
                let ray = Ray { origin: Vec3::new(-300.0, height, 0.3), direction: Vec3::X, time: 0.5 };
                let (hit, _) = solids.nearest(&ray, 0.0, f32::INFINITY).unwrap();
                assert!(hit.distance < 300.0 && hit.normal.x < 0.0, "{piece:?} at {height}: {hit:?}");
            }
        }
    }
}
