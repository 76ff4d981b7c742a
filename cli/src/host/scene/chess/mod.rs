//! A game of chess on a café's terrace at dusk: the king is in focus 65 cm from the lens, and a street with its lamps
//! lies far behind. All objects are lathe-turned parts, boxes, rods and balls; patterns are formulas.

mod board;
mod materials;
mod pieces;
mod terrace;

use super::objects::{FLOOR, Finish, Material};
use super::pose::tilted;
use super::sky::Sun;
use super::solids::{Appearance, Block, Form, Solids};
use super::world::{Light, Scene};
use board::{BOARD, SQUARE, TABLE, TURN, in_world, middle_of};
use glam::{Vec2, Vec3};
use pieces::Piece::{self, Bishop, King, Pawn, Queen, Rook};
use std::sync::Arc;

/// Height of the camera over the board, mm.
const EYE: f32 = 168.0;
/// Downward tilt of the camera, degrees.
const TILT: f32 = 5.4;
/// Square of the king, as file and rank counted from 0.
const SUBJECT: [u8; 2] = [2, 2];

/// The end of a game: each entry has the piece, whether it is white, and its square.
const GAME: [(Piece, bool, [u8; 2]); 14] = [
    (King, true, SUBJECT),
    (Queen, false, [4, 3]),
    (Pawn, true, [1, 3]),
    (Pawn, true, [0, 1]),
    (Rook, true, [0, 5]),
    (Bishop, true, [2, 5]),
    (King, false, [6, 6]),
    (Rook, false, [2, 7]),
    (Bishop, false, [6, 3]),
    (Pawn, false, [5, 5]),
    (Pawn, false, [7, 5]),
    (Pawn, false, [1, 6]),
    (Pawn, true, [3, 4]),
    (Queen, true, [4, 6]),
];

/// Makes the scene.
pub fn scene() -> Scene {
    let mut solids = terrace::solids();
    let half = Vec3::new(4.55 * SQUARE, 11.0, 4.55 * SQUARE);
    let centre = BOARD - half.y * Vec3::Y;
    solids.push((
        Form::Block(Block { centre, half, turn: Vec2::from_angle(TURN) }),
        Appearance::Painted(materials::board),
    ));
    let white = Material::new([0.74, 0.60, 0.40], Finish::Coated).rough(0.17);
    let red = Material::new([0.36, 0.018, 0.014], Finish::Coated).rough(0.15);
    for (piece, is_white, square) in GAME {
        let appearance = Appearance::Plain(if is_white { white } else { red });
        solids.extend(pieces::solids(piece, middle_of(square), appearance));
    }
    // Captured pieces stand beside the board.
    let beside = [
        (Pawn, [-1.7, 5.2]),
        (Pawn, [-1.2, 6.3]),
        (Bishop, [-2.3, 6.6]),
        (Pawn, [5.0, 9.3]),
        (Rook, [3.7, 9.6]),
    ];
    for (piece, [file, rank]) in beside {
        let position = in_world(Vec2::new(file - 3.5, rank - 3.5) * SQUARE);
        let foot = Vec3::new(position.x, FLOOR.height + TABLE, position.z);
        let appearance = Appearance::Plain(if file > 0.0 { white } else { red });
        solids.extend(pieces::solids(piece, foot, appearance));
    }
    Scene {
        floor: materials::paving,
        floor_roughness: 0.08,
        balls: Vec::new(),
        boards: Vec::new(),
        solids: Arc::new(solids.into_iter().collect::<Solids>()),
        lamps: terrace::lamps(),
        panes: terrace::houses().iter().flat_map(materials::windows).collect(),
        light: Light::Dusk,
        sun: Sun::EVENING,
        pose: tilted(TILT, [0.0, BOARD.y + EYE, 0.0]),
        subject: |_, _| depth(middle_of(SUBJECT) + 60.0 * Vec3::Y),
    }
}

/// Returns the distance of a point from the camera along the camera's axis.
fn depth(point: Vec3) -> f32 {
    let (sine, cosine) = TILT.to_radians().sin_cos();
    cosine * point.z - sine * (point.y - BOARD.y - EYE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::shapes::Ray;

    #[test]
    fn the_camera_sees_the_king_where_it_focuses() {
        let scene = scene();
        let king = middle_of(SUBJECT) + 60.0 * Vec3::Y;
        let eye = Vec3::new(0.0, BOARD.y + EYE, 0.0);
        let ray = Ray { origin: eye, direction: (king - eye).normalize(), time: 0.5 };
        let (hit, _) = scene.nearest(&ray, 0.0).unwrap();
        let subject = (scene.subject)(50.0, 43.0);
        assert!((hit.distance - (king - eye).length()).abs() < 15.0, "something stands before the king");
        assert!((depth(ray.at(hit.distance)) - subject).abs() < 15.0);
    }

    #[test]
    fn no_two_pieces_stand_on_one_square() {
        for (index, (_, _, square)) in GAME.iter().enumerate() {
            assert!(GAME[index + 1..].iter().all(|other| other.2 != *square), "{square:?}");
        }
    }
}
