//! The surroundings of the board: the table, the terrace with its strings of lamps, and the street.

use super::board::{BOARD, TABLE};
use super::materials;
use super::pieces::turned;
use crate::host::scene::noise::hash;
use crate::host::scene::objects::{Ball, FLOOR, Finish, Lamps, Material};
use crate::host::scene::shapes::Sphere;
use crate::host::scene::solids::{Appearance, Block, Form, Rod};
use glam::{Vec2, Vec3};

const AMBER: [f32; 3] = [1.0, 0.43, 0.09];
const GOLD: [f32; 3] = [1.0, 0.58, 0.20];
const PEARL: [f32; 3] = [1.0, 0.74, 0.44];
const ROSE: [f32; 3] = [1.0, 0.22, 0.13];
const SEA: [f32; 3] = [0.16, 0.80, 0.68];
const BLUE: [f32; 3] = [0.26, 0.46, 1.0];

/// Returns a point at a height over the ground.
fn at(x: f32, height: f32, z: f32) -> Vec3 {
    Vec3::new(x, FLOOR.height + height, z)
}

/// A string of lamps: its ends, its sag in mm, and the number, radius and radiance of its lamps.
struct Garland {
    ends: [Vec3; 2],
    sag: f32,
    lamps: u8,
    radius: f32,
    radiance: f32,
}

fn garlands() -> Vec<Garland> {
    let garland = |from: [f32; 3], to: [f32; 3], sag: f32, lamps: u8, radius: f32, radiance: f32| Garland {
        ends: [at(from[0], from[1], from[2]), at(to[0], to[1], to[2])],
        sag,
        lamps,
        radius,
        radiance,
    };
    vec![
        // Strings over the terrace.
        garland([-3300.0, 2550.0, 3500.0], [3100.0, 2350.0, 4300.0], 1230.0, 30, 20.0, 17.0),
        garland([-4200.0, 2800.0, 6200.0], [3600.0, 2850.0, 5400.0], 1250.0, 32, 22.0, 17.0),
        garland([-3900.0, 2900.0, 8200.0], [4100.0, 2900.0, 7700.0], 1000.0, 32, 25.0, 17.0),
        // Strings along the railing.
        garland([-2300.0, 1120.0, 2750.0], [700.0, 1060.0, 3050.0], 130.0, 14, 9.0, 34.0),
        garland([700.0, 1060.0, 3050.0], [3000.0, 1150.0, 2500.0], 110.0, 11, 9.0, 34.0),
        // Strings overhead, for lenses with a wide field.
        garland([-2600.0, 2500.0, 1500.0], [2600.0, 2500.0, 1900.0], 380.0, 16, 18.0, 16.0),
        garland([-2600.0, 2500.0, 400.0], [2600.0, 2550.0, 300.0], 350.0, 16, 18.0, 16.0),
    ]
}

impl Garland {
    fn point(&self, part: f32) -> Vec3 {
        let [from, to] = self.ends;
        from.lerp(to, part) - 4.0 * self.sag * part * (1.0 - part) * Vec3::Y
    }

    fn lamps(&self, number: usize) -> Lamps {
        let count = f32::from(self.lamps);
        let lit = |index: u8| {
            let position = self.point((f32::from(index) + 0.5) / count) - (2.2 * self.radius) * Vec3::Y;
            let colours = [AMBER, GOLD, PEARL, GOLD, AMBER, ROSE, GOLD, SEA, AMBER];
            let chance = hash(index.into(), number as i32, 77);
            let colour = colours[(chance * colours.len() as f32) as usize];
            lamp(
                position,
                self.radius,
                colour,
                self.radiance * (0.75 + 0.5 * hash(index.into(), number as i32, 78)),
            )
        };
        (0..self.lamps).map(lit).collect()
    }

    fn wire(&self) -> impl Iterator<Item = Form> {
        const SEGMENTS: u8 = 12;
        (0..SEGMENTS).map(|segment| {
            let ends = [segment, segment + 1].map(|end| self.point(f32::from(end) / f32::from(SEGMENTS)));
            Form::Rod(Rod { ends, radius: 2.5 })
        })
    }
}

fn lamp(centre: Vec3, radius: f32, colour: [f32; 3], radiance: f32) -> Ball {
    Ball::new(Sphere::resting(centre, radius), Material::new(radiance * Vec3::from(colour), Finish::Lamp))
}

/// Positions of the street lamps: x and z.
const POSTS: [[f32; 2]; 9] = [
    [-2600.0, 9800.0],
    [3300.0, 11_500.0],
    [-2900.0, 15_500.0],
    [3300.0, 17_500.0],
    [-3000.0, 22_000.0],
    [3300.0, 24_500.0],
    [-3100.0, 29_500.0],
    [-8200.0, 11_000.0],
    [-8600.0, 19_000.0],
];
const POST: f32 = 3300.0;

/// The lantern that lights the board from outside the picture, and the globe on the table.
const LANTERN: ([f32; 3], f32) = ([-760.0, 1420.0, 250.0], 125.0);
const GLOBE: ([f32; 3], f32) = ([235.0, TABLE + 92.0, 985.0], 36.0);

/// A lamp behind the board for rim light, and one beside the camera that fills shadows.
const COLD: Vec3 = Vec3::new(1250.0, 1745.0, 1500.0);
const FILL: Vec3 = Vec3::new(1150.0, 1645.0, -200.0);

/// Returns all light sources, in groups.
pub fn lamps() -> Vec<Lamps> {
    let mut groups: Vec<Lamps> =
        garlands().iter().enumerate().map(|(number, garland)| garland.lamps(number)).collect();
    let posts = POSTS.iter().map(|[x, z]| lamp(at(*x, POST, *z), 150.0, PEARL, 9.0));
    groups.push(posts.collect());
    // The lights of cars in both directions, and of a crossing.
    let cars = [(-700.0, 19_000.0), (-1000.0, 31_000.0), (900.0, 15_500.0), (1000.0, 26_000.0)];
    let pairs = cars.into_iter().flat_map(|(x, z)| {
        let (colour, radiance) = if x < 0.0 { (PEARL, 26.0) } else { (ROSE, 13.0) };
        [-620.0, 620.0].map(|aside| lamp(at(x + aside, 680.0, z), 85.0, colour, radiance))
    });
    let signals = [
        lamp(at(2500.0, 2500.0, 27_000.0), 120.0, SEA, 14.0),
        lamp(at(-2300.0, 2900.0, 27_500.0), 120.0, ROSE, 14.0),
        lamp(at(-5200.0, 2300.0, 16_000.0), 140.0, BLUE, 9.0),
        lamp(at(3900.0, 2600.0, 13_000.0), 110.0, SEA, 10.0),
    ];
    groups.push(pairs.chain(signals).collect());
    let tables = OTHERS.iter().map(|[x, z]| lamp(at(*x, TABLE + 90.0, *z), 42.0, AMBER, 9.0));
    groups.push(tables.collect());
    let ([x, y, z], radius) = LANTERN;
    groups.push([lamp(at(x, y, z), radius, GOLD, 84.0)].into_iter().collect());
    groups.push([lamp(COLD, 150.0, BLUE, 22.0)].into_iter().collect());
    groups.push([lamp(FILL, 140.0, PEARL, 15.0)].into_iter().collect());
    let ([x, y, z], radius) = GLOBE;
    groups.push([lamp(at(x, y, z), radius, GOLD, 5.5)].into_iter().collect());
    groups
}

/// Positions of the other tables: x and z.
const OTHERS: [[f32; 2]; 5] =
    [[-1250.0, 2150.0], [1500.0, 2050.0], [-2500.0, 4300.0], [2300.0, 4500.0], [150.0, 5200.0]];

/// Returns all objects that are not light sources.
pub fn solids() -> Vec<(Form, Appearance)> {
    let iron = Appearance::Painted(materials::iron);
    let mut all: Vec<(Form, Appearance)> = Vec::new();
    let mut add = |appearance: Appearance, forms: &mut dyn Iterator<Item = Form>| {
        all.extend(forms.map(|form| (form, appearance)))
    };
    let rod = |from: Vec3, to: Vec3, radius: f32| Form::Rod(Rod { ends: [from, to], radius });
    // Tables have one foot each.
    let round = |radius: f32| {
        [
            [0.0, TABLE - 34.0],
            [radius - 6.0, TABLE - 34.0],
            [radius - 6.0, TABLE - 34.0],
            [radius, TABLE - 26.0],
            [radius, TABLE - 7.0],
            [radius - 6.0, TABLE],
            [radius - 6.0, TABLE],
            [0.0, TABLE],
        ]
    };
    let tables =
        std::iter::once((BOARD.x, BOARD.z, 500.0)).chain(OTHERS.iter().map(|[x, z]| (*x, *z, 380.0)));
    for (x, z, radius) in tables {
        add(Appearance::Painted(materials::oak), &mut turned(&round(radius), at(x, 0.0, z)));
        let foot = [[230.0, 0.0], [230.0, 12.0], [60.0, 30.0], [34.0, 90.0], [30.0, 600.0], [60.0, 700.0]];
        add(iron, &mut turned(&foot, at(x, 0.0, z)));
    }
    // Feet of the globes.
    let brass = Appearance::Plain(Material::new([0.80, 0.52, 0.22], Finish::Metal).rough(0.18));
    let globes = std::iter::once([GLOBE.0[0], GLOBE.0[2]]).chain(OTHERS);
    for [x, z] in globes {
        let foot = [
            [38.0, 0.0],
            [38.0, 0.0],
            [38.0, 5.0],
            [30.0, 9.0],
            [9.0, 14.0],
            [7.0, 40.0],
            [16.0, 56.0],
            [26.0, 66.0],
        ];
        add(brass, &mut turned(&foot, at(x, TABLE, z)));
    }
    // Chairs have four legs, a seat, and a back of bent rods.
    let chairs = [
        (-1250.0, 2700.0, 0.2),
        (1500.0, 2650.0, -0.3),
        (-1800.0, 2200.0, 1.5),
        (2050.0, 2100.0, -1.4),
        (-330.0, 1640.0, 0.25),
        (-2500.0, 4900.0, 0.0),
        (2300.0, 5100.0, 0.3),
        (700.0, 5300.0, -1.0),
    ];
    for (x, z, angle) in chairs {
        let turn = Vec2::from_angle(angle);
        let local = |x0: f32, height: f32, z0: f32| {
            let position = turn.rotate(Vec2::new(x0, z0));
            at(x + position.x, height, z + position.y)
        };
        let half = Vec3::new(200.0, 12.0, 200.0);
        let seat =
            Form::Block(Block { centre: local(0.0, 450.0, 0.0), half, turn: Vec2::new(turn.x, -turn.y) });
        add(Appearance::Painted(materials::oak), &mut [seat].into_iter());
        let legs = [[-185.0, -185.0], [185.0, -185.0], [-185.0, 185.0], [185.0, 185.0]];
        let bars = [[-185.0, 185.0], [-62.0, 200.0], [62.0, 200.0], [185.0, 185.0]];
        let legs = legs.map(|[x0, z0]| rod(local(x0, 0.0, z0), local(0.95 * x0, 450.0, 0.95 * z0), 13.0));
        let backs = bars.map(|[x0, z0]| rod(local(0.95 * x0, 450.0, z0), local(x0, 860.0, z0 + 60.0), 10.0));
        let tops = [0, 1, 2].map(|i| {
            let [a, b] = [bars[i], bars[i + 1]].map(|[x0, z0]| local(x0, 860.0, z0 + 60.0));
            rod(a, b, 14.0)
        });
        add(iron, &mut legs.into_iter().chain(backs).chain(tops));
    }
    // The railing, with plant boxes along it.
    let bend = [[-2300.0, 2750.0], [700.0, 3050.0], [3000.0, 2500.0]];
    for pair in bend.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        for height in [120.0, 1020.0] {
            add(iron, &mut [rod(at(a[0], height, a[1]), at(b[0], height, b[1]), 18.0)].into_iter());
        }
        let bars = (0..=10_u8).map(|bar| {
            let part = f32::from(bar) / 10.0;
            let [x, z] = [0, 1].map(|axis| a[axis] + part * (b[axis] - a[axis]));
            rod(at(x, 0.0, z), at(x, 1020.0, z), if bar % 5 == 0 { 22.0 } else { 8.0 })
        });
        add(iron, &mut bars.collect::<Vec<_>>().into_iter());
    }
    let bushes = [
        (-2900.0, 3300.0, 900.0),
        (3350.0, 3600.0, 1000.0),
        (-1700.0, 3250.0, 520.0),
        (1900.0, 3200.0, 480.0),
    ];
    let trees = [(-4800.0, 8200.0, 2600.0), (4300.0, 9200.0, 2300.0), (-5600.0, 14_000.0, 2700.0)];
    let green = Appearance::Painted(materials::leaves);
    for (number, (x, z, size)) in (0..).zip(bushes.into_iter().chain(trees)) {
        let is_tree = size > 2000.0;
        let centre = if is_tree { at(x, 2600.0 + 0.6 * size, z) } else { at(x, 0.75 * size, z) };
        if is_tree {
            let bark = Appearance::Plain(Material::new([0.05, 0.04, 0.03], Finish::Matte));
            add(bark, &mut [rod(at(x, 0.0, z), centre, 140.0)].into_iter());
        }
        let ball = |index: i32| {
            let random = |salt: i32| hash(index, number, salt) * 2.0 - 1.0;
            let out = Vec3::new(random(1), random(2), random(3));
            let out = out / out.length().max(1.0) * Vec3::new(1.0, 0.75, 1.0);
            Form::Ball(Sphere::resting(
                centre + 0.6 * size * out,
                size * (0.05 + 0.05 * hash(index, number, 4)),
            ))
        };
        add(green, &mut (0..220).map(ball));
    }
    // Street lamps, and posts for the garlands.
    for [x, z] in POSTS {
        add(iron, &mut [rod(at(x, 0.0, z), at(x, POST - 140.0, z), 55.0)].into_iter());
    }
    for garland in garlands() {
        add(iron, &mut garland.wire());
        let posts = garland.ends.into_iter().filter(|end| end.y > at(0.0, 2000.0, 0.0).y);
        add(iron, &mut posts.map(|end| rod(Vec3 { y: FLOOR.height, ..end }, end, 32.0)));
    }
    for lamp in [COLD, FILL] {
        let top = lamp - 140.0 * Vec3::Y;
        add(iron, &mut [rod(Vec3 { y: FLOOR.height, ..top }, top, 24.0)].into_iter());
    }
    let ([x, y, z], radius) = LANTERN;
    add(iron, &mut [rod(at(x, y + radius, z), at(x, 2500.0, z), 4.0)].into_iter());
    add(Appearance::Painted(materials::houses), &mut houses().into_iter().map(Form::Block));
    all
}

/// Returns the houses: along the street, at its end, and around the square on the left.
pub fn houses() -> [Block; 6] {
    let house = |centre: Vec3, half: Vec3| Block { centre, half, turn: Vec2::X };
    [
        house(at(9000.0, 6200.0, 17_000.0), Vec3::new(3800.0, 6200.0, 13_500.0)),
        house(at(-14_800.0, 4700.0, 33_500.0), Vec3::new(6700.0, 4700.0, 12_000.0)),
        house(at(-18_500.0, 5600.0, 9000.0), Vec3::new(5000.0, 5600.0, 9500.0)),
        house(at(-14_000.0, 3300.0, 88_000.0), Vec3::new(16_000.0, 3300.0, 5000.0)),
        house(at(16_000.0, 2700.0, 74_000.0), Vec3::new(13_000.0, 2700.0, 5000.0)),
        house(at(0.0, 5000.0, -5200.0), Vec3::new(22_000.0, 5000.0, 3000.0)),
    ]
}
