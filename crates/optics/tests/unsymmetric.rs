//! Lenses that are not round: mirrors, tilts, decentres, cylinders, toroids and biconics, traced by the walk and compared
//! with closed forms and with the same lens described otherwise.

use realistic_optics::{
    imaging::focus::Focus,
    lens::{Lens, Ray, first_order::FirstOrder},
    prescription::{Meridian, read},
    trace::{Blocked, Path, Walk},
};

fn lens(text: &str) -> Lens {
    Lens::at_d_line(&read("lens", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}")))
}

fn to_film(lens: &Lens, origin: [f64; 3], direction: [f64; 3]) -> Walk {
    Path::<f64>::scene_to_film(lens).walk(Ray { origin, direction })
}

fn close(a: [f64; 3], b: [f64; 3], error: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= error)
}

/// Returns a ray's point in the plane z, with the ray.
fn at(ray: Ray, z: f64) -> [f64; 2] {
    let t = (z - ray.origin[2]) / ray.direction[2];
    [0, 1].map(|i| ray.origin[i] + t * ray.direction[i])
}

#[test]
fn a_parabola_images_the_axis_at_its_focus() {
    // Concave toward the scene: its centre lies in front, so that the radius is negative.
    let mirror = lens("-200 -100 1 60\nmirror 1\nasphere 1 conic=-1\n");
    for [x, y] in [[0.0, 0.0], [10.0, 0.0], [-7.0, 20.0]] {
        let walk = to_film(&mirror, [x, y, 50.0], [0.0, 0.0, -1.0]);
        assert_eq!(walk.blocked, None);
        // The image space is that of the film, which faces the mirror.
        let film = mirror.rear().vertex - 100.0;
        let [fx, fy] = at(walk.ray, film);
        assert!(fx.abs() < 1e-13 && fy.abs() < 1e-13, "{x} {y}: {fx} {fy}");
    }
}

/// A Cassegrain of two conics: focal length 500, the primary's 150.
const CASSEGRAIN: &str = "-300 -100 1 100\n-142.857142857142857 120 1 40\nmirror 1\nmirror 2\nasphere 1 conic=-1\n\
                          asphere 2 conic=-3.4489795918367347\nobstruction 1 circle 15\n";

#[test]
fn a_cassegrain_images_the_axis_and_traces_back() {
    let telescope = lens(CASSEGRAIN);
    // The secondary, 50 in front of the primary's focus, images it at s' with 1/s' = 1/50 - 2/R: magnification s'/50.
    let back = (1.0 / 50.0 - 2.0 / (1000.0_f64 / 7.0)).recip();
    let film = telescope.rear().vertex - back;
    let [to_film, to_scene] =
        [Path::<f64>::scene_to_film(&telescope), Path::<f64>::film_to_scene(&telescope)];
    for [x, y] in [[30.0, 0.0], [-12.0, 40.0], [20.0, 20.0]] {
        let origin = [x, y, 200.0];
        let ray = to_film.trace(Ray { origin, direction: [0.0, 0.0, -1.0] }).expect("passes");
        let [fx, fy] = at(ray, film);
        assert!(fx.abs() < 1e-11 && fy.abs() < 1e-11, "{x} {y}: {fx} {fy}");
        let start = Ray { origin: [fx, fy, film], direction: ray.direction.map(|d| -d) };
        let out = to_scene.trace(start).expect("passes back");
        assert!(close(out.direction, [0.0, 0.0, 1.0], 1e-14), "{out:?}");
        assert!((out.origin[0] - x).abs() < 1e-12 && (out.origin[1] - y).abs() < 1e-12);
    }
}

#[test]
fn a_fold_turns_the_axis_by_a_right_angle() {
    // A plane mirror at 45 degrees, 50 behind a lens, and the film above it.
    let straight = lens("50 5 1.5 20\n-50 90 1 20\n");
    let folded =
        lens("50 5 1.5 20\n-50 50 1 20\ninf -40 1 40\nmirror 3\nbreak 3 tilt_x=45\nbreak film tilt_x=45\n");
    for [x, y] in [[0.0, 0.0], [3.0, -4.0], [-8.0, 1.0]] {
        let origin = [x, y, 10.0];
        let direction = [0.05, 0.02, -1.0];
        let [plain, turned] = [&straight, &folded].map(|lens| to_film(lens, origin, direction));
        assert_eq!((plain.blocked, turned.blocked), (None, None));
        let plain = at(plain.ray, straight.rear().vertex - 90.0);
        let turned = at(turned.ray, folded.rear().vertex - 40.0);
        // The mirror turns the picture over in neither direction as the film sees it.
        assert!(
            (plain[0] - turned[0]).abs() < 1e-12 && (plain[1] - turned[1]).abs() < 1e-12,
            "{plain:?} {turned:?}"
        );
    }
    // The film lies above the mirror in lens space.
    let mut points = Vec::new();
    Path::<f64>::scene_to_film(&folded)
        .walk_by(Ray { origin: [0.0, 0.0, 10.0], direction: [0.0, 0.0, -1.0] }, |_, point| {
            points.push(point)
        });
    assert!(close(points[2], [0.0, 0.0, -55.0], 1e-12), "{points:?}");
}

#[test]
fn a_decentre_moves_a_lens_and_a_tilt_about_its_centre_does_nothing_to_a_sphere() {
    let plain = lens("50 5 1.5 20\n-50 45 1 20\n");
    let moved = lens("50 5 1.5 20\n-50 45 1 20\nbreak 1 x=2 y=-1\nbreak film x=-2 y=1\n");
    let ray = ([1.0, 3.0, 20.0], [0.02, -0.03, -1.0]);
    let expected = to_film(&plain, [ray.0[0] - 2.0, ray.0[1] + 1.0, ray.0[2]], ray.1).ray;
    let own = to_film(&moved, ray.0, ray.1).ray;
    assert!(close(own.direction, expected.direction, 1e-15));
    assert!((own.origin[0] - expected.origin[0] - 2.0).abs() < 1e-14);
    // A sphere turned about its centre is the same sphere; the other surface stays where it was.
    let turned = lens(
        "50 5 1.5 20\n-50 45 1 20\nbreak 1 z=50\nbreak 1 tilt_x=7 tilt_y=-3 z=-50\nbreak 2 z=45\nbreak 2 first=tilt \
         tilt_x=-7 tilt_y=3 z=-45\n",
    );
    let [own, expected] = [&turned, &plain].map(|lens| to_film(lens, ray.0, ray.1).ray);
    assert!(
        close(own.direction, expected.direction, 1e-14) && close(own.origin, expected.origin, 1e-13),
        "{own:?}"
    );
}

#[test]
fn a_cylinder_bends_in_one_meridian_and_agrees_with_a_sphere_there() {
    let sphere = lens("40 6 1.6 20\n-70 50 1 20\n");
    let cylinder = lens("40 6 1.6 20\n-70 50 1 20\ntoroid 1 profile=x\ntoroid 2 profile=x\n");
    for x in [0.0, 3.0, -8.5] {
        let [round, flat] =
            [&sphere, &cylinder].map(|lens| to_film(lens, [x, 0.0, 9.0], [0.1, 0.0, -1.0]).ray);
        assert!(close(round.direction, flat.direction, 1e-15) && close(round.origin, flat.origin, 1e-14));
    }
    // In the other meridian it is a plate of the same thickness along the ray: the direction stays.
    let along = to_film(&cylinder, [0.0, 5.0, 9.0], [0.0, 0.1, -1.0]).ray;
    let length = 1.01_f64.sqrt();
    assert!(close(along.direction, [0.0, 0.1 / length, -1.0 / length], 1e-15), "{along:?}");
}

#[test]
fn a_toroid_and_a_biconic_with_equal_radii_are_spheres() {
    let sphere = lens("40 6 1.6 30\n-70 50 1 30\n");
    for text in ["toroid 1 rotation=40\ntoroid 2 rotation=-70\n", "biconic 1 x=40\nbiconic 2 x=-70\n"] {
        let other = lens(&format!("40 6 1.6 30\n-70 50 1 30\n{text}"));
        for [x, y] in [[0.0, 0.0], [9.0, 4.0], [-13.0, 2.0], [6.0, -12.0]] {
            let trace = |lens: &Lens| to_film(lens, [x, y, 9.0], [0.05, -0.08, -1.0]);
            let [round, own] = [trace(&sphere), trace(&other)];
            assert_eq!(round.blocked, own.blocked);
            assert!(close(round.ray.direction, own.ray.direction, 1e-14), "{text} {x} {y}");
            assert!(close(round.ray.origin, own.ray.origin, 1e-12));
        }
    }
}

#[test]
fn a_hollow_cylinder_is_met_from_any_distance() {
    let lens = lens("-50 3 1.5 20\n80 40 1 20\ntoroid 1 profile=x\n");
    let near = to_film(&lens, [4.0, 1.0, 10.0], [0.01, 0.0, -1.0]);
    let far = to_film(&lens, [4.0 - 29.9, 1.0, 3000.0], [0.01, 0.0, -1.0]);
    assert_eq!((near.blocked, far.blocked), (None, None));
    assert!(close(near.ray.origin, far.ray.origin, 1e-12));
}

#[test]
fn rays_that_no_surface_meets_are_reported() {
    let cylinder = lens("10 6 1.6 20\n-70 50 1 40\ntoroid 1 profile=x\n");
    assert_eq!(to_film(&cylinder, [11.0, 0.0, 9.0], [0.0, 0.0, -1.0]).blocked, Some(Blocked::Missed));
    assert_eq!(to_film(&cylinder, [9.0, 9.0, 9.0], [0.0, 0.0, -1.0]).blocked, Some(Blocked::Clipped));
    let telescope = lens(CASSEGRAIN);
    let path = Path::<f64>::scene_to_film(&telescope).with_apertures(&telescope);
    let blocked = |x: f64| path.walk(Ray { origin: [x, 3.0, 9.0], direction: [0.0, 0.0, -1.0] }).blocked;
    assert_eq!([blocked(3.0), blocked(16.0)], [Some(Blocked::Clipped), None]);
}

#[test]
fn mirrors_and_folds_have_the_first_order_optics_of_the_unfolded_lens() {
    let first_order = |text: &str| FirstOrder::of(&lens(text)).expect("not afocal");
    // f = f_primary times the magnification of the secondary.
    let back = (1.0 / 50.0 - 2.0 / (1000.0_f64 / 7.0)).recip();
    let telescope = first_order(CASSEGRAIN);
    assert!((telescope.focal_length - 150.0 * back / 50.0).abs() < 1e-10, "{telescope:?}");
    assert!((telescope.back_focal_distance() - back).abs() < 1e-10);
    let straight = first_order("50 5 1.5 20\n-50 90 1 20\n");
    let folded = first_order(
        "50 5 1.5 20\n-50 50 1 20\ninf -40 1 40\nmirror 3\nbreak 3 tilt_x=45\nbreak film tilt_x=45\n",
    );
    assert!((folded.focal_length - straight.focal_length).abs() < 1e-8, "{folded:?} {straight:?}");
    assert!((folded.back_focal_distance() + 50.0 - straight.back_focal_distance()).abs() < 1e-8);
    // Film distances of exact rays agree as well.
    let film = |text: &str, distance: f64| Focus::new(&lens(text)).expect("focuses").film_distance(distance);
    let rows = "50 5 1.5 20\n-50 20 1 20\n";
    let fold = "inf -40 1 60\nmirror 3\nbreak 3 tilt_x=45\nbreak film tilt_x=45\n";
    let [plain, turned] =
        [rows.to_owned(), format!("{rows}{fold}")].map(|text| film(&text, f64::INFINITY).expect("a film"));
    assert!((plain - 20.0 - turned).abs() < 1e-9, "{plain} {turned}");
}

/// Two cylinders that make an afocal squeeze of 2 in x in front of a lens.
const ANAMORPHIC: &str = "-100 2 1.5 40\ninf 96 1 40\n200 4 1.5 40\ninf 10 1 40\n80 5 1.5 20\n-80 70 1 20\n\
                          toroid 1 profile=x\ntoroid 3 profile=x\n";

#[test]
fn a_pair_of_cylinders_squeezes_one_meridian() {
    let lens = lens(ANAMORPHIC);
    let of = |meridian| FirstOrder::in_meridian(&lens, meridian).expect("not afocal");
    let [x, y] = [Meridian::X, Meridian::Y].map(of);
    // Thick lenses by Gauss's formula, with plates and gaps reduced: the matrix of two powers at a distance.
    let powers = [-0.5 / 100.0, 0.5 / 200.0];
    let (reduced, block) = (2.0 / 1.5 + 96.0, 4.0 / 1.5 + 10.0);
    let a = 1.0 - reduced * powers[0];
    let c = -(powers[0] + powers[1] - reduced * powers[0] * powers[1]);
    let power = |height: f64, slope: f64| {
        let height = height + block * slope;
        let curved = 0.5 / 80.0;
        let slope = slope - curved * height;
        -(slope - curved * (height + 5.0 / 1.5 * slope))
    };
    assert!((x.focal_length.recip() - power(a, c)).abs() < 1e-15, "{x:?}");
    assert!((y.focal_length.recip() - power(1.0, 0.0)).abs() < 1e-15, "{y:?}");
    let squeeze = FirstOrder::squeeze(&lens).expect("not afocal");
    assert!((squeeze * power(1.0, 0.0) / power(a, c) - 1.0).abs() < 1e-12, "{squeeze}");
    // The film lies between the foci of the two meridians.
    let film = Focus::new(&lens).expect("focuses").film_distance(f64::INFINITY).expect("a film");
    let foci = [x.back_focal_distance(), y.back_focal_distance()];
    assert!(film > foci[0].min(foci[1]) - 1.0 && film < foci[0].max(foci[1]), "{film} {foci:?}");
}

#[test]
fn close_rays_at_a_toroid_meet_where_coddington_says() {
    // For parallel light n' cos²I'/t' and n'/s' are (n' cos I' - cos I)/R, with the radius of the plane of incidence, and
    // that across it (Kingslake and Johnson, *Lens Design Fundamentals*, 2nd ed., §11.1).
    let (n, profile, rotation) = (1.65_f64, 30.0_f64, 50.0_f64);
    let surface = lens(&format!("{profile} 0 {n} 40\ntoroid 1 rotation={rotation}\n"));
    for (height, angle) in [(0.0_f64, 0.3_f64), (6.0, 0.0), (8.0, 0.2), (-9.0, 0.25)] {
        let direction = [0.0, angle.sin(), -angle.cos()];
        let sagitta = profile - (profile * profile - height * height).sqrt();
        let trace = |[x, y]: [f64; 2]| {
            let hit = [x, height + y, -sagitta];
            let walk = to_film(&surface, std::array::from_fn(|i| hit[i] - 40.0 * direction[i]), direction);
            assert_eq!(walk.blocked, None);
            walk.ray
        };
        let chief = trace([0.0; 2]);
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        // The distance along the chief ray at which rays on both sides come closest, in the mean.
        let focus = |beside: [f64; 2]| {
            let of = |sign: f64| {
                let other = trace(beside.map(|part| sign * part));
                let between = std::array::from_fn(|i| chief.origin[i] - other.origin[i]);
                let cosine = dot(chief.direction, other.direction);
                (cosine * dot(other.direction, between) - dot(chief.direction, between))
                    / (1.0 - cosine * cosine)
            };
            f64::midpoint(of(1.0), of(-1.0))
        };
        // The normal points to the centre of the profile, and meets the axis of rotation behind it.
        let sine = height / profile;
        let tilt = (1.0 - sine * sine).sqrt();
        let radius_across = (rotation - sagitta) / tilt;
        let cosine = -direction[1] * sine - direction[2] * tilt;
        let behind = (1.0 - (1.0 - cosine * cosine) / (n * n)).sqrt();
        let power = n * behind - cosine;
        let expected = [n * behind * behind * profile / power, n * radius_across / power];
        let found = [focus([0.0, 0.01]), focus([0.01, 0.0])];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 2e-5, "{height} {angle}: {found} {expected}");
        }
    }
}
