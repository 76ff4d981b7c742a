//! The position of the board, and the coordinates on it.

use crate::host::scene::FLOOR;
use glam::{Vec2, Vec3};

/// Side of a square of the board, mm.
pub const SQUARE: f32 = 57.0;
/// The middle of the board's top.
pub const BOARD: Vec3 = Vec3::new(40.0, FLOOR.height + 762.0, 680.0);
/// Rotation of the board, radians.
pub const TURN: f32 = 0.47;
/// Height of the table over the floor, mm.
pub const TABLE: f32 = 740.0;
/// Returns the middle of a square.
pub fn middle_of([file, rank]: [u8; 2]) -> Vec3 {
    in_world((Vec2::new(f32::from(file), f32::from(rank)) - 3.5) * SQUARE)
}

/// Converts a position on the board, mm from its middle along files and ranks, to the world.
pub fn in_world(position: Vec2) -> Vec3 {
    let turned = Vec2::from_angle(-TURN).rotate(position);
    BOARD + Vec3::new(turned.x, 0.0, turned.y)
}

/// Converts a point of the world to a position on the board.
pub fn on_board(point: Vec3) -> Vec2 {
    Vec2::from_angle(TURN).rotate(Vec2::new(point.x - BOARD.x, point.z - BOARD.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::shapes::{Ray, Shape};
    use crate::host::scene::solids::Block;

    #[test]
    fn squares_turn_with_the_board() {
        for square in [[0, 0], [2, 5], [7, 1]] {
            let back = on_board(middle_of(square)) / SQUARE + 3.5;
            assert!((back - Vec2::from(square.map(f32::from))).length() < 1e-4, "{square:?}: {back}");
        }
        // The axes of a block are those of the board.
        let block = Block {
            centre: BOARD,
            half: Vec3::new(4.0 * SQUARE, 1.0, 4.0 * SQUARE),
            turn: Vec2::from_angle(TURN),
        };
        let inside = in_world(Vec2::new(3.9, -3.9) * SQUARE) + 50.0 * Vec3::Y;
        let ray = Ray { origin: inside, direction: Vec3::NEG_Y, time: 0.5 };
        assert!(block.intersect(&ray, 0.0, 100.0).is_some());
    }
}
