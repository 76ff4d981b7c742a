//! Materials of the objects in the street, with patterns computed by formula from the position in mm.

use super::board::{SQUARE, on_board};
use crate::host::scene::noise::{hash, value};
use crate::host::scene::solids::Block;
use crate::host::scene::{FLOOR, Finish, Material, Pane};
use glam::{Vec2, Vec3};
use std::ops::Range;

fn coated(colour: Vec3, roughness: f32) -> Material {
    Material::new(colour, Finish::Coated).rough(roughness)
}

fn mix(a: [f32; 3], b: [f32; 3], part: f32) -> Vec3 {
    Vec3::from(a).lerp(Vec3::from(b), part.clamp(0.0, 1.0))
}

/// Returns the grain of wood at a position, from 0 to 1; the grain runs along the first axis.
fn grain(position: Vec3) -> f32 {
    let bend = 9.0 * value(position * Vec3::new(0.004, 0.02, 0.02));
    let rings = value(Vec3::new(position.x * 0.006, position.y * 0.05, position.z * 0.22 + bend));
    let fibres = value(Vec3::new(position.x * 0.03, position.y * 0.6, position.z * 1.7));
    0.7 * rings + 0.3 * fibres
}

/// The framed chequered top of the board.
pub fn board(point: Vec3, normal: Vec3) -> Material {
    let position = on_board(point) / SQUARE;
    let inside = position.x.abs().max(position.y.abs()) < 4.0;
    let cell = position.floor();
    let odd = (cell.x + cell.y).rem_euclid(2.0) > 0.5;
    let seed = 300.0 * hash(cell.x as i32, cell.y as i32, 5);
    let texture = grain(Vec3::new(position.x * SQUARE + seed, seed, position.y * SQUARE));
    let line = (position.x.abs().max(position.y.abs()) - 4.16).abs() < 0.02;
    let colour = if normal.y < 0.5 || (!inside && !line) {
        mix([0.085, 0.032, 0.014], [0.16, 0.065, 0.026], texture)
    } else if line || !odd {
        mix([0.60, 0.41, 0.20], [0.76, 0.58, 0.33], texture)
    } else {
        mix([0.12, 0.042, 0.018], [0.23, 0.092, 0.04], texture)
    };
    coated(colour, 0.16)
}

/// Boards of oiled oak, for the top of a table.
pub fn oak(point: Vec3, _: Vec3) -> Material {
    const PLANK: f32 = 118.0;
    let turned = Vec3::new(0.94 * point.x + 0.34 * point.z, point.y, 0.94 * point.z - 0.34 * point.x);
    let plank = (turned.z / PLANK).floor();
    let gap = (turned.z / PLANK - plank - 0.5).abs() > 0.486;
    let seed = hash(plank as i32, 3, 1);
    let texture = grain(turned + 900.0 * seed);
    let colour = mix([0.17, 0.085, 0.038], [0.40, 0.225, 0.105], 0.25 * seed + 0.8 * texture);
    coated(if gap { 0.25 * colour } else { colour }, 0.28)
}

/// Paving setts of stone, wet in patches.
pub fn paving(point: Vec3) -> Material {
    const SETT: f32 = 160.0;
    let row = (point.z / SETT).floor();
    let x = point.x / SETT + 0.5 * row.rem_euclid(2.0);
    let column = x.floor();
    let (across, along) = ((x - column - 0.5).abs(), (point.z / SETT - row - 0.5).abs());
    let joint = across.max(along) > 0.45;
    let shade = 0.6 + 0.6 * hash(column as i32, row as i32, 0);
    let wet = 0.6 + 0.5 * value(point * 0.0011);
    let dark = if joint { 0.35 } else { shade };
    coated(wet * dark * Vec3::new(0.075, 0.072, 0.074), 0.0)
}

/// Width of a house, mm, and the height of a shop.
const HOUSE: f32 = 7600.0;
const SHOP: f32 = 3300.0;
/// Width and height of a bay, which has one window.
const BAY: f32 = 1900.0;
const STOREY: f32 = 3100.0;
/// Storeys over the shops.
const STOREYS: u8 = 4;
/// Positions of the window in a bay, and of the shop's window in a house: along the front, and upward.
const WINDOW: [Range<f32>; 2] = [480.0..1420.0, 750.0..2500.0];
const DISPLAY: [Range<f32>; 2] = [500.0..5200.0, 450.0..2600.0];

/// Returns the direction along a front, and the origin of its coordinates.
fn front(normal: Vec3) -> (Vec3, Vec3) {
    if normal.x.abs() > 0.5 {
        (Vec3::Z, Vec3::new(0.0, FLOOR.height, -31_000.0))
    } else {
        (Vec3::X, Vec3::new(450.0, FLOOR.height, 0.0))
    }
}

/// Whether the shop in a house is open.
fn is_open(house: i32, side: i32) -> bool {
    hash(house, side, 23) > 0.25
}

/// Returns the random number of a window's light, if the window is lit.
fn lit(column: i32, storey: i32, side: i32) -> Option<f32> {
    Some(hash(column, storey, 7 + side)).filter(|chance| *chance <= 0.42)
}

/// Returns the panes of the lit windows and the open shops of an unrotated block of houses.
pub fn windows(block: &Block) -> Vec<Pane> {
    let mut panes = Vec::new();
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let (across, origin) = front(normal);
        let side = normal.x.round() as i32;
        let middle = block.centre + normal * block.half;
        let centre = Vec2::new((middle - origin).dot(across), middle.y - origin.y);
        let half = Vec2::new(block.half.dot(across), block.half.y);
        let (low, high) = (centre - half, centre + half);
        let mut add = |corner: Vec2, [along, up]: &[Range<f32>; 2]| {
            let from = (corner + Vec2::new(along.start, up.start)).max(low);
            let size = (corner + Vec2::new(along.end, up.end)).min(high) - from;
            if size.min_element() > 0.0 {
                let offset = from - centre;
                panes.push(Pane {
                    corner: middle + offset.x * across + offset.y * Vec3::Y,
                    sides: [size.x * across, size.y * Vec3::Y],
                    normal,
                    material_at: houses,
                });
            }
        };
        let numbers = |width: f32| (low.x / width).floor() as i32..=(high.x / width).floor() as i32;
        for house in numbers(HOUSE).filter(|house| is_open(*house, side)) {
            add(Vec2::new(house as f32 * HOUSE, 0.0), &DISPLAY);
        }
        for storey in 0..STOREYS {
            for column in numbers(BAY).filter(|column| lit(*column, storey.into(), side).is_some()) {
                add(Vec2::new(column as f32 * BAY, SHOP + f32::from(storey) * STOREY), &WINDOW);
            }
        }
    }
    panes
}

/// The front of a row of houses: plaster, windows, of which some are lit, and shops.
pub fn houses(point: Vec3, normal: Vec3) -> Material {
    let (across, origin) = front(normal);
    let (along, height) = ((point - origin).dot(across), point.y - origin.y);
    let house = (along / HOUSE).floor();
    let side = normal.x.round() as i32;
    let plaster = [[0.20, 0.13, 0.09], [0.12, 0.13, 0.15], [0.22, 0.17, 0.10], [0.15, 0.09, 0.08]];
    let number = (4.0 * hash(house as i32, side, 11)) as usize;
    let rough = 0.75 + 0.35 * value(point * 0.004);
    let wall = Material::new(rough * Vec3::from(plaster[number.min(3)]), Finish::Matte);
    if normal.y.abs() > 0.5 {
        return wall;
    }
    if height < SHOP {
        // A shop has a window, and a door beside the window.
        let within = (along / HOUSE - house) * HOUSE;
        let [columns, rows] = &DISPLAY;
        let pane = columns.contains(&within) && rows.contains(&height);
        let post = (within - columns.start).rem_euclid(1566.0) < 70.0;
        if pane && !post && is_open(house as i32, side) {
            let tint = [[1.0, 0.55, 0.20], [1.0, 0.72, 0.40], [0.30, 0.80, 0.75], [1.0, 0.42, 0.22]];
            let shelf = 0.5 + 0.5 * value(Vec3::new(along * 0.0016, height * 0.003, house));
            let glow = shelf * (0.6 + 0.5 * height / rows.end);
            let colour = Vec3::from(tint[(4.0 * hash(house as i32, side, 31)) as usize % 4]);
            return Material::new(1.5 * glow * colour, Finish::Lamp);
        }
        return Material { colour: 0.5 * wall.colour, ..wall };
    }
    let (column, storey) = ((along / BAY).floor(), ((height - SHOP) / STOREY).floor());
    let (across, up) = (along - column * BAY, height - SHOP - storey * STOREY);
    if !WINDOW[0].contains(&across) || !WINDOW[1].contains(&up) || storey >= f32::from(STOREYS) {
        return wall;
    }
    let frame = (across - 950.0).abs() < 35.0 || (up - 1850.0).abs() < 30.0;
    let Some(chance) = lit(column as i32, storey as i32, side).filter(|_| !frame) else {
        return coated(Vec3::splat(0.02), 0.08);
    };
    let curtain = 0.55 + 0.45 * value(Vec3::new(across * 0.008, up * 0.0007, column));
    let colour = if chance > 0.36 {
        Vec3::new(0.35, 0.62, 0.95)
    } else {
        mix([1.0, 0.50, 0.17], [1.0, 0.72, 0.38], chance / 0.36)
    };
    Material::new(1.25 * curtain * colour, Finish::Lamp)
}

/// Leaves.
pub fn leaves(point: Vec3, _: Vec3) -> Material {
    let part = value(point * 0.02);
    Material::new(mix([0.035, 0.065, 0.02], [0.09, 0.14, 0.035], part), Finish::Matte)
}

/// Painted iron.
pub fn iron(_: Vec3, _: Vec3) -> Material {
    coated(Vec3::new(0.018, 0.022, 0.022), 0.22)
}

#[cfg(test)]
mod tests {
    use super::super::terrace;
    use super::*;

    #[test]
    fn fronts_shine_where_there_are_panes_and_nowhere_else() {
        let (mut inside, mut shining) = (0, 0);
        for block in terrace::houses() {
            let panes = windows(&block);
            for index in 0..20_000_u32 {
                let [u, v] =
                    [0.754_877_7, 0.569_840_3].map(|step: f32| (index as f32 * step).fract() * 2.0 - 1.0);
                for normal in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
                    let (across, _) = front(normal);
                    let point = block.centre + block.half * (normal + u * across + v * Vec3::Y);
                    let shines = houses(point, normal).finish == Finish::Lamp;
                    let pane = panes.iter().find(|pane| pane.normal == normal && pane.contains(point));
                    assert!(pane.is_some() || !shines, "{point} {normal}");
                    (inside, shining) = (inside + i32::from(pane.is_some()), shining + i32::from(shines));
                    if let Some(pane) = pane {
                        assert_eq!(pane.radiance(point) != Vec3::ZERO, shines, "{point} {normal}");
                    }
                }
            }
        }
        // The rest of the area is window frames.
        let part = f64::from(shining) / f64::from(inside);
        assert!(part > 0.8 && part < 0.97, "{part}");
    }
}
