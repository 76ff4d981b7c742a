//! Cases of whole lenses, which vary the number of interfaces, the scale, the stop, the film position, and coordinates
//! at the ends of the number range.

use realistic_optics::{
    lens::{
        Lens,
        first_order::FirstOrder,
        pupil::{EntrancePupil, ExitPupil},
    },
    trace::{
        Direction::{FilmToScene, SceneToFilm},
        Path, Ray,
    },
};

use super::{
    case::Case,
    lenses::{Row, SIDES, bundle, catalogue, lens},
};

/// Film from the rear vertex plane to 1e6 mm behind it, including the focal plane.
pub fn film_positions() -> Vec<Case> {
    let mut cases = Vec::new();
    for name in ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"] {
        let lens = catalogue(name, 1.0);
        let focus = FirstOrder::of(&lens).expect("not afocal").back_focal_distance();
        let aim = lens.rear().semi_diameter;
        for (position, distance) in [
            ("1e-6 mm".to_owned(), 1e-6),
            ("the focal plane".to_owned(), focus),
            ("1e3 mm".to_owned(), 1e3),
            ("1e6 mm".to_owned(), 1e6),
        ] {
            let heights = [0.0, 0.1 * distance.min(focus), (0.5 * distance).min(17.5)];
            let rays = bundle(&lens, FilmToScene, distance, &heights, aim);
            cases.push(Case::new("film", format!("{name}, film at {position}"), &lens, FilmToScene, rays));
        }
        let distant = bundle(&lens, SceneToFilm, 1e7, &[0.0, 1e6, 4e6], lens.front().semi_diameter);
        cases.push(Case::new("film", format!("{name}, object at 10 km"), &lens, SceneToFilm, distant));
    }
    cases
}

/// A stop in the front focal plane of the elements behind it: the exit pupil lies at infinity.
pub fn telecentric() -> Vec<Case> {
    let group = [(80.0, 5.0, 1.6, 15.0), (-60.0, 0.0, 1.0, 15.0)];
    let before = -FirstOrder::of(&lens("group", &group)).expect("not afocal").front_focal_point;
    let [first, last] = group;
    let rows = [(f64::INFINITY, before.abs(), 1.0, 4.0), first, last];
    let name = "stop in the focal plane".to_owned();
    let shape = lens(&name, &rows);
    [("film", FilmToScene, 60.0, 12.0), ("scene", SceneToFilm, 100.0, 4.0)]
        .map(|(side, direction, distance, aim)| {
            let rays = bundle(&shape, direction, distance, &[0.0, 2.0, 9.0], aim);
            Case::new("telecentric", format!("{name}, from the {side}"), &shape, direction, rays)
        })
        .into()
}

/// Stops from f/1e5 to f/0.5.
pub fn stops() -> Vec<Case> {
    let mut pinhole = catalogue("dgauss.50mm", 1.0);
    let stop = pinhole.stop_index().expect("it has a stop");
    pinhole.surfaces[stop].semi_diameter = 50.0 / 1e5 / 2.0;
    let focus = FirstOrder::of(&pinhole).expect("not afocal").back_focal_distance();
    let (film, through) = central_rays(&pinhole, stop, focus);
    // A ball of index 2 images infinity on its own back: its focal length equals its radius.
    let ball = lens("ball", &[(10.0, 20.0, 2.0, 10.0), (-10.0, 0.0, 1.0, 10.0)]);
    let rays = bundle(&ball, SceneToFilm, 1e4, &[0.0, 1e3], 9.99);
    vec![
        Case::new("stop", "f/1e5 from the film", &pinhole, FilmToScene, film),
        Case::new("stop", "f/1e5 from the scene", &pinhole, SceneToFilm, through),
        Case::new("stop", "f/0.5, a ball of index 2", &ball, SceneToFilm, rays),
    ]
}

/// Returns rays from the film, at `back` behind the lens, and from the scene, near the rays of the thick
/// lens through the stop's centre.
fn central_rays(lens: &Lens, stop: usize, back: f64) -> (Vec<Ray>, Vec<Ray>) {
    let (entrance, exit) = (EntrancePupil::of_surface(lens, stop), ExitPupil::of_surface(lens, stop));
    let film = lens.rear().vertex - back;
    let fan = |i: i32| (f64::from(i % 3) * 0.02, f64::from(i) / 30.0 - 1.0);
    let from_film = (0..60).map(|i| {
        let (field, across) = fan(i);
        let slopes = exit.slopes(0.0, 50.0 * field, film);
        let direction = [slopes.center[0] + across * slopes.radius, slopes.center[1], 1.0];
        Ray { origin: [0.0, 50.0 * field, film], direction }
    });
    let pupil = entrance.position().expect("not telecentric");
    let from_scene = (0..60).map(|i| {
        let (field, across) = fan(i);
        let x = entrance.diameter() / 2.0 * across;
        Ray { origin: [x, -field * 100.0, pupil + 100.0], direction: [0.0, field, -1.0] }
    });
    (from_film.collect(), from_scene.collect())
}

/// Fields beyond 90 degrees: rays from the film that leave a fisheye backward, and the reversed rays, which enter the
/// fisheye from the front's plane, from 1 m and from 1 km.
pub fn fisheyes() -> Vec<Case> {
    let rows = [
        (35.0, 2.0, 1.7, 34.9),
        (11.0, 14.0, 1.0, 10.9),
        (f64::INFINITY, 1.0, 1.0, 2.5),
        (30.0, 3.0, 1.6, 8.0),
        (-14.0, 0.0, 1.0, 8.0),
    ];
    let lens = lens("fisheye", &rows);
    let film = bundle(&lens, FilmToScene, 12.0, &[0.0, 4.0, 8.0, 10.0, 12.0, 14.0], 5.0);
    let name = "beyond 90 degrees from the film";
    let mut cases = vec![Case::new("fisheye", name, &lens, FilmToScene, film.clone())];
    let path = Path::<f64>::film_to_scene(&lens);
    let leaving: Vec<Ray> = film.iter().filter_map(|&ray| path.trace(ray).ok()).collect();
    for distance in [1.0, 1e3, 1e6] {
        let back = leaving.iter().map(|ray| Ray {
            origin: std::array::from_fn(|i| ray.origin[i] + distance * ray.direction[i]),
            direction: ray.direction.map(|d| -d),
        });
        let name = format!("beyond 90 degrees from {distance:e} mm");
        cases.push(Case::new("fisheye", name, &lens, SceneToFilm, back.collect()));
    }
    cases
}

/// 1, 2, 50 and 200 interfaces: a relay of weak singlets that keeps rays together.
pub fn counts() -> Vec<Case> {
    let mut cases = Vec::new();
    for count in [1, 2, 50, 200] {
        let singlet = [(60.0, 3.0, 1.5, 6.0), (-60.0, 5.0, 1.0, 6.0)];
        let mut rows: Vec<Row> = singlet.into_iter().cycle().take(count).collect();
        rows.last_mut().expect("one row or more").1 = 0.0;
        for (side, direction) in SIDES {
            let name = format!("{count} interfaces from the {side}");
            let shape = lens(&name, &rows);
            let rays = bundle(&shape, direction, 50.0, &[0.0, 1.0], 2.0);
            cases.push(Case::new("count", name, &shape, direction, rays));
        }
    }
    cases
}

/// The double Gauss a million times smaller and larger.
pub fn scales() -> Vec<Case> {
    let mut cases = Vec::new();
    for factor in [1e-6, 1.0, 1e6] {
        let lens = catalogue("dgauss.50mm", factor);
        for (side, direction) in SIDES {
            let aim = if direction == SceneToFilm { 12.0 } else { 9.0 };
            let rays = bundle(&lens, direction, 38.0 * factor, &[0.0, 10.0 * factor], aim * factor);
            let name = format!("dgauss x {factor:e} from the {side}");
            cases.push(Case::new("scale", name, &lens, direction, rays));
        }
    }
    cases
}

/// Coordinates of 0, subnormal and 1e-30, and directions of any length, including exactly axial rays.
pub fn tiny_coordinates() -> Vec<Case> {
    let mut cases = Vec::new();
    for name in ["dgauss.50mm", "fisheye.10mm"] {
        let lens = catalogue(name, 1.0);
        let film = lens.rear().vertex - 40.0;
        let mut rays = Vec::new();
        for x in [0.0, -0.0, 5e-324, 1e-310, 1e-30, 1e-7] {
            for slope in [0.0, -0.0, 5e-324, 1e-310, 1e-30, 1e-7] {
                for length in [1.0, 1e-300, 1e-308, 1e300] {
                    let direction = [slope * length, x, length];
                    rays.push(Ray { origin: [x, -slope, film], direction });
                }
            }
        }
        let name = format!("{name}, coordinates of 0 to 1e-7");
        cases.push(Case::new("tiny", name, &lens, FilmToScene, rays));
    }
    cases
}
