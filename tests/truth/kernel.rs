//! The kernel: its portable instance is compared with exact arithmetic and the walk, and every other instance with the
//! portable one, bit for bit.

use super::{
    aspheres::{asphere, lens as aspheric_lens},
    support::Random,
    tables,
};

use realistic_optics::{
    lens::{Figure, Lens, Surface},
    prescription::Shape,
    trace::{Direction, Path, Ray, Real},
};
use realistic_simd::Simd;
use realistic_trace::kernel::{Kernel, KernelScalar, LensRays, PlaneRays};
use tables::{LENSES, difference, lens, numbers, outcome, ray, table};

/// The error bounds of a precision, and the bits of its values.
trait Checked: KernelScalar + std::fmt::Debug {
    /// Margin of a table's row below which a ray may either pass or be blocked.
    const MARGIN: f64;
    /// Largest errors of position (mm) and direction (rad) over all golden lenses.
    const ERRORS: (f64, f64);
    /// Returns the bits of the value.
    fn bits(self) -> u64;
}

impl Checked for f64 {
    const MARGIN: f64 = 0.0;
    const ERRORS: (f64, f64) = (1e-12, 1e-14);
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

impl Checked for f32 {
    const MARGIN: f64 = 1e-4;
    const ERRORS: (f64, f64) = (2e-4, 5e-6);
    fn bits(self) -> u64 {
        self.to_bits().into()
    }
}

/// Structure of arrays, whose data start `offset` elements after the allocation.
#[derive(Clone)]
struct Arrays<S> {
    columns: [Vec<S>; 7],
    offset: usize,
}

impl<S: Checked> Arrays<S> {
    fn new(rays: &[Ray], offset: usize) -> Self {
        let column = |f: &dyn Fn(&Ray) -> f64| {
            let padding = std::iter::repeat_n(S::from_f64(7.0), offset);
            padding.chain(rays.iter().map(|ray| S::from_f64(f(ray)))).collect()
        };
        let columns = std::array::from_fn(|i| match i {
            0..3 => column(&|ray: &Ray| ray.origin[i]),
            3..6 => column(&|ray: &Ray| ray.direction[i - 3]),
            _ => column(&|_: &Ray| f64::NAN),
        });
        Self { columns, offset }
    }

    fn rays(&mut self) -> LensRays<'_, S> {
        let [x, y, z, dx, dy, dz, weight] = self.columns.each_mut().map(|column| &mut column[self.offset..]);
        LensRays { origin: [x, y, z], direction: [dx, dy, dz], weight }
    }

    fn at(&self, i: usize) -> [S; 7] {
        self.columns.each_ref().map(|column| column[self.offset + i])
    }

    fn result(&self, i: usize) -> Option<Ray> {
        let [x, y, z, dx, dy, dz, weight] = self.at(i).map(S::to_f64);
        (weight > 0.0).then_some(Ray { origin: [x, y, z], direction: [dx, dy, dz] })
    }
}

fn bits<S: Checked>(numbers: [S; 7]) -> [u64; 7] {
    numbers.map(S::bits)
}

fn kernel<S: Checked>(lens: &Lens, direction: Direction, simd: Simd) -> Kernel<S> {
    Kernel::with_simd(lens, direction, simd).expect("the caller has asked")
}

fn in_place<S: Checked>(kernel: &Kernel<S>, rays: &[Ray], offset: usize) -> Arrays<S> {
    let mut arrays = Arrays::new(rays, offset);
    kernel.trace_in_place(&mut arrays.rays());
    arrays
}

/// Film points and slopes: x, y, dx/dz, dy/dz.
type Film<S> = Vec<[S; 4]>;

fn from_plane<S: Checked>(kernel: &Kernel<S>, plane: f64, film: &[[S; 4]], offset: usize) -> Arrays<S> {
    let column = |i: usize| -> Vec<S> {
        std::iter::repeat_n(S::ONE, offset).chain(film.iter().map(|ray| ray[i])).collect()
    };
    let [x, y, slope_x, slope_y] = [0, 1, 2, 3].map(column);
    let blank = Ray { origin: [7.0; 3], direction: [7.0; 3] };
    let mut out = Arrays::new(&vec![blank; film.len()], offset);
    let from = PlaneRays {
        plane,
        x: &x[offset..],
        y: &y[offset..],
        slope_x: &slope_x[offset..],
        slope_y: &slope_y[offset..],
    };
    kernel.trace_batch(&from, &mut out.rays());
    out
}

fn one<S: Checked>(kernel: &Kernel<S>, plane: f64, [x, y, sx, sy]: [S; 4]) -> [S; 7] {
    kernel.trace_one(plane, [x, y], [sx, sy]).map_or([S::ZERO; 7], |ray| {
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        [x, y, z, dx, dy, dz, ray.weight]
    })
}

/// Returns z of a film behind the lens, and `n` rays from that film through a disk slightly larger than the rear
/// element.
fn film<S: Checked>(lens: &Lens, n: usize) -> (f64, Film<S>) {
    let (rear, mut numbers) = (lens.rear(), Random::new(n as u64));
    let distance = 2.5 * rear.semi_diameter;
    let rays = (0..n).map(|_| {
        let [u, v, x, y] = std::array::from_fn(|_| numbers.next());
        let (x, y) = (rear.semi_diameter * (x - 0.5), rear.semi_diameter * (y - 0.5));
        let (r, phi) = (1.1 * rear.semi_diameter * u.sqrt(), std::f64::consts::TAU * v);
        [x, y, (r * phi.cos() - x) / distance, (r * phi.sin() - y) / distance].map(S::from_f64)
    });
    (rear.vertex - distance, rays.collect())
}

fn as_ray<S: Real>(plane: f64, film: &[S; 4]) -> Ray {
    let [x, y, sx, sy] = film.map(S::to_f64);
    Ray { origin: [x, y, plane], direction: [sx, sy, 1.0] }
}

/// Returns a lens of alternating glass and air, with every radius, thickness and semi-diameter multiplied by `scale`.
fn many_surfaces(n: usize, scale: f64) -> Lens {
    let radius = |i: usize| scale * [120.0, -150.0, 90.0, 100.0, 900.0, f64::INFINITY, -45.0][i % 7];
    let surface = |i: usize| Surface {
        vertex: -2.5 * scale * i as f64,
        radius: radius(i),
        curvature: radius(i).recip(),
        figure: None,
        unsymmetric: None,
        thickness: if i + 1 < n { 2.5 * scale } else { 0.0 },
        n_scene: if (n - i).is_multiple_of(2) { 1.0 } else { 1.6 },
        n_film: if (n - i).is_multiple_of(2) { 1.6 } else { 1.0 },
        absorption: 0.0,
        semi_diameter: 12.0 * scale,
        is_stop: false,
        is_mirror: false,
        is_reversed: false,
        coordinate_break: None,
        apertures: std::sync::Arc::default(),
        is_contact: false,
    };
    Lens {
        name: format!("{n} surfaces"),
        surfaces: (0..n).map(surface).collect(),
        wavelength: 587.56,
        nominal_film_distance: None,
        film_break: None,
    }
}

/// Returns eight surfaces with every kind of figure: conics, even and odd terms, waves, planes, a sphere.
fn aspheres() -> Lens {
    let figures = [
        asphere(120.0, -1.0, &[]),
        asphere(f64::INFINITY, 0.0, &[(4, 2e-5), (6, -1e-7)]),
        asphere(90.0, -3.0, &[(4, -4e-6), (6, 3e-8), (8, -1e-10)]),
        asphere(-80.0, 2.0, &[]),
        asphere(-150.0, 1.5, &[(2, 1e-4), (3, -2e-5), (5, 3e-7)]),
        asphere(60.0, 0.0, &[]),
        asphere(f64::INFINITY, 0.0, &[(3, 1e-4), (4, -2e-5)]),
        asphere(100.0, -5.0, &[(4, 1e-5), (10, -1e-13), (20, 1e-25)]),
    ];
    let glass = |i: usize| if i.is_multiple_of(2) { 1.6 } else { 1.0 };
    let rows: Vec<_> = figures
        .iter()
        .enumerate()
        .map(|(i, figure)| (Shape::Asphere(*figure), 4.0, glass(i), 12.0))
        .collect();
    aspheric_lens(&rows)
}

fn every_lens() -> Vec<Lens> {
    let named = LENSES.map(|name| lens(name, 587.56));
    named.into_iter().chain([1, 2, 26, 200].map(|n| many_surfaces(n, 1.0))).chain([aspheres()]).collect()
}

fn golden_rays<S: Checked>() {
    for name in LENSES {
        let lens = lens(name, 587.56);
        for (prefix, direction) in
            [("truth_", Direction::FilmToScene), ("truth_scene_", Direction::SceneToFilm)]
        {
            let kernel = kernel::<S>(&lens, direction, Simd::Portable);
            let file = format!("{prefix}{name}.csv");
            let rows: Vec<_> = table(&file)
                .into_iter()
                .filter(|row| row[13].parse::<f64>().expect("a margin") >= S::MARGIN)
                .collect();
            let rays: Vec<_> = rows.iter().map(|row| ray(numbers(&row[..6]))).collect();
            let traced = in_place(&kernel, &rays, 0);
            let mut worst = (0.0_f64, 0.0_f64);
            for (i, row) in rows.iter().enumerate() {
                let expected = outcome(&row[12]);
                assert_eq!(traced.result(i).is_none(), expected.is_some(), "{file}, ray {i}: {row:?}");
                match (traced.result(i), expected) {
                    (Some(ray_got), _) => {
                        let (p, d) = difference(ray_got, ray(numbers(&row[6..12])));
                        // The tables start scene rays up to 1 km away, where single precision cannot resolve the lens.
                        let far = S::EPSILON > 1e-10 && rays[i].origin[2].abs() > 1e3;
                        if !far {
                            worst = (worst.0.max(p), worst.1.max(d));
                        }
                    }
                    (None, Some(reason)) => assert_eq!(kernel.reason(rays[i]), reason),
                    (None, None) => unreachable!("compared above"),
                }
            }
            println!("{file}: {:.1e} mm, {:.1e} rad", worst.0, worst.1);
            assert!(worst.0 < S::ERRORS.0 && worst.1 < S::ERRORS.1, "{file}: {worst:?}");
        }
    }
}

fn film_rays<S: Checked>() {
    for lens in every_lens() {
        let kernel = kernel::<S>(&lens, Direction::FilmToScene, Simd::Portable);
        let path = Path::<f64>::film_to_scene(&lens);
        let (plane, film) = film::<S>(&lens, 4000);
        let traced = from_plane(&kernel, plane, &film, 0);
        let (mut passed, mut disagree) = (0, 0);
        for (i, ray) in film.iter().enumerate() {
            match (traced.result(i), path.trace(as_ray(plane, ray))) {
                (Some(got), Ok(expected)) => {
                    passed += 1;
                    let (p, d) = difference(got, expected);
                    let chaos = if lens.surfaces.len() == 200 { 100.0 } else { 1.0 };
                    assert!(d < chaos * S::ERRORS.1 && p < chaos * S::ERRORS.0, "{} {i}: {p} {d}", lens.name);
                }
                (None, Err(_)) => {}
                _ => disagree += 1,
            }
        }
        let allowed = if S::EPSILON > 1e-10 { 1 } else { 0 };
        assert!(disagree <= allowed, "{}: {disagree} rays go another way", lens.name);
        println!("{} passes {passed}", lens.name);
        assert!(passed > 100, "{} passes {passed}", lens.name);
    }
}

/// Returns zeros, subnormals, infinities and NaN, and the neighbours of these numbers.
fn extremes<S: Checked>() -> Vec<S> {
    let single = S::EPSILON > 1e-10;
    let (tiny, huge) = if single { (1e-42, 1e38) } else { (1e-310, 1e308) };
    [0.0, -0.0, 1.0, -0.3, 1e-20, 1e20, tiny, -tiny, huge, -huge, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]
        .map(S::from_f64)
        .to_vec()
}

/// Compares batches and triples of `n` film rays, some with extreme values, which start `offset` elements after an
/// aligned address.
fn film_rays_agree<S: Checked>(lens: &Lens, simd: Simd, n: usize, random: &mut Random) {
    let reference = kernel::<S>(lens, Direction::FilmToScene, Simd::Portable);
    let kernel = kernel::<S>(lens, Direction::FilmToScene, simd);
    let (plane, mut film) = film::<S>(lens, n);
    let extremes = extremes::<S>();
    let mut among = |n: usize| (random.next() * n as f64) as usize;
    let offset = among(5);
    if among(3) == 0 {
        for ray in &mut film {
            for _ in 0..1 + among(2) {
                ray[among(4)] = extremes[among(extremes.len())];
            }
        }
    }
    let singles: Vec<_> = film.iter().map(|ray| one(&reference, plane, *ray)).collect();
    let batch = from_plane(&kernel, plane, &film, offset);
    for (i, (ray, single)) in film.iter().zip(&singles).enumerate() {
        let context = || format!("{}, ray {i} of {n}: {ray:?}", lens.name);
        assert_eq!(bits(batch.at(i)), bits(*single), "{}", context());
        assert_eq!(bits(one(&kernel, plane, *ray)), bits(*single), "{}", context());
        assert!(single.iter().all(|number| number.to_f64().is_finite()), "{}", context());
        if ray.iter().any(|number| !number.to_f64().is_finite()) {
            assert_eq!(*single, [S::ZERO; 7], "{}", context());
        }
    }
    for (i, three) in film.windows(3).enumerate() {
        let points = [0, 1, 2].map(|j| [three[j][0], three[j][1]]);
        let slopes = [0, 1, 2].map(|j| [three[j][2], three[j][3]]);
        for (j, traced) in kernel.trace_triple(plane, points, slopes).into_iter().enumerate() {
            let expected = reference.trace_one(plane, points[j], slopes[j]);
            assert_eq!(traced, expected, "{}, ray {j} of the triple {i}", lens.name);
        }
    }
}

/// Compares `n` rays of any origin, traced in place in either direction.
fn rays_from_anywhere_agree<S: Checked>(lens: &Lens, simd: Simd, n: usize, random: &mut Random) {
    let direction = if random.next() < 0.5 { Direction::FilmToScene } else { Direction::SceneToFilm };
    let mut number = |scale: f64| (2.0 * random.next() - 1.0) * scale;
    let length = 2.0 * lens.front().semi_diameter - lens.rear().vertex;
    let rays: Vec<_> = (0..n)
        .map(|_| Ray {
            origin: [number(5.0), number(5.0), lens.rear().vertex / 2.0 + number(length)],
            direction: [number(0.5), number(0.5), number(1.0)],
        })
        .collect();
    let expected = in_place(&kernel::<S>(lens, direction, Simd::Portable), &rays, 0);
    let got = in_place(&kernel::<S>(lens, direction, simd), &rays, n % 5);
    for (i, ray) in rays.iter().enumerate() {
        assert_eq!(bits(got.at(i)), bits(expected.at(i)), "{} {ray:?}", lens.name);
    }
}

fn instances_agree<S: Checked>() {
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        let random = &mut Random::new(1);
        for lens in every_lens() {
            // The number of rays goes up to more than two groups of the widest vectors, so that any number of lanes and
            // of vectors is idle.
            for _ in 0..30 {
                let n = (71.0 * random.next()) as usize;
                film_rays_agree::<S>(&lens, simd, n, random);
                rays_from_anywhere_agree::<S>(&lens, simd, n, random);
            }
        }
    }
}

#[test]
fn every_instance_has_the_bits_of_portable_single_rays() {
    instances_agree::<f64>();
    instances_agree::<f32>();
}

/// Compares axis-parallel rays at the exact height of grazing, x = R, and of the critical angle, x = R/n' with n = 2.
/// At these heights the squares under both roots are exactly 0, but not for the neighbours on either side.
fn grazing_and_critical_rays<S: Checked>() {
    let surface = |vertex: f64, radius: f64, n_scene: f64, n_film: f64| Surface {
        vertex,
        radius,
        curvature: radius.recip(),
        figure: None,
        unsymmetric: None,
        thickness: 0.0,
        n_scene,
        n_film,
        absorption: 0.0,
        semi_diameter: 20.0,
        is_stop: false,
        is_mirror: false,
        is_reversed: false,
        coordinate_break: None,
        apertures: std::sync::Arc::default(),
        is_contact: false,
    };
    let plane = |vertex: f64, n_scene: f64, n_film: f64| surface(vertex, f64::INFINITY, n_scene, n_film);
    let lens = |surfaces: &[Surface]| {
        let mut surfaces = surfaces.to_vec();
        for i in 1..surfaces.len() {
            surfaces[i - 1].thickness = surfaces[i - 1].vertex - surfaces[i].vertex;
        }
        Lens {
            name: "exact".to_owned(),
            surfaces,
            wavelength: 587.56,
            nominal_film_distance: None,
            film_break: None,
        }
    };
    // The lenses are the near half of a ball, seen from the film; and glass with a convex front and a plane back, or
    // with a sphere in between.
    let grazing = lens(&[surface(0.0, -8.0, 1.5, 1.0)]);
    let critical = lens(&[surface(0.0, 8.0, 1.0, 2.0), plane(-8.0, 2.0, 1.0)]);
    let linked = lens(&[surface(0.0, 8.0, 1.0, 2.0), surface(-4.0, -16.0, 2.0, 2.0), plane(-8.0, 2.0, 1.0)]);
    for (lens, height) in [(&grazing, 8.0), (&critical, 4.0), (&linked, 4.0)] {
        let step = S::EPSILON * 16.0;
        let film: Film<S> = (-40..=40)
            .map(|i| [S::from_f64(height + step * f64::from(i)), S::ZERO, S::ZERO, S::ZERO])
            .collect();
        let reference = kernel::<S>(lens, Direction::FilmToScene, Simd::Portable);
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            let batch = from_plane(&kernel::<S>(lens, Direction::FilmToScene, simd), -30.0, &film, 0);
            for (i, ray) in film.iter().enumerate() {
                assert_eq!(bits(batch.at(i)), bits(one(&reference, -30.0, *ray)), "{i}");
            }
            assert!(batch.result(80).is_none() && batch.result(0).is_some());
            assert!(lens.surfaces.len() > 2 || batch.result(40).is_none(), "the exact one");
        }
        if lens.surfaces.len() < 3 {
            let path = Path::<f64>::film_to_scene(lens);
            assert!(path.trace(as_ray(-30.0, &film[40])).is_err());
        }
    }
}

fn scaled_rays<S: Checked>() {
    for lens in every_lens() {
        let (plane, film) = film::<S>(&lens, 300);
        let plain = from_plane(&kernel::<S>(&lens, Direction::FilmToScene, Simd::Portable), plane, &film, 0);
        for scale in [2.0_f64.powi(20), 2.0_f64.powi(-20)] {
            let mut scaled = lens.clone();
            for surface in &mut scaled.surfaces {
                surface.vertex *= scale;
                surface.radius *= scale;
                surface.curvature /= scale;
                surface.thickness *= scale;
                surface.semi_diameter *= scale;
                surface.figure = surface
                    .figure
                    .and_then(|figure| Figure::new(&figure.asphere.scaled(scale), surface.semi_diameter));
            }
            let times = S::from_f64(scale);
            let film: Film<S> = film.iter().map(|&[x, y, sx, sy]| [x * times, y * times, sx, sy]).collect();
            let kernel = kernel::<S>(&scaled, Direction::FilmToScene, Simd::Portable);
            let got = from_plane(&kernel, plane * scale, &film, 0);
            for i in 0..film.len() {
                let [x, y, z, rest @ ..] = plain.at(i);
                let [dx, dy, dz, weight] = rest;
                let expected = [x * times, y * times, z * times, dx, dy, dz, weight];
                assert_eq!(bits(got.at(i)), bits(expected), "{} ray {i} times {scale}", lens.name);
            }
        }
    }
}

#[test]
fn golden_rays_end_where_exact_arithmetic_says() {
    golden_rays::<f64>();
    golden_rays::<f32>();
}

#[test]
fn film_rays_pass_and_end_where_the_walk_says() {
    film_rays::<f64>();
    film_rays::<f32>();
}

#[test]
fn exact_grazing_and_the_exact_critical_angle_block() {
    grazing_and_critical_rays::<f64>();
    grazing_and_critical_rays::<f32>();
}

#[test]
fn a_lens_scaled_by_powers_of_two_gives_scaled_bits() {
    scaled_rays::<f64>();
    scaled_rays::<f32>();
}

/// Checks the choice of instructions; the next test runs this test again for every value of the variable.
#[test]
fn the_choice_is_available_and_within_the_limit() {
    let best = Simd::best();
    assert!(best.is_available());
    let limit = std::env::var("REALISTIC_SIMD").ok();
    let limit = Simd::ALL.into_iter().find(|simd| limit.as_deref() == Some(simd.name()));
    let most = Simd::ALL.into_iter().rfind(|simd| simd.is_available()).expect("one always is");
    assert_eq!(best, limit.map_or(most, |limit| limit.min(most)));
    assert_eq!(Kernel::<f32>::new(&many_surfaces(2, 1.0), Direction::FilmToScene).simd(), best);
}

#[test]
fn the_environment_variable_only_lowers_the_choice() {
    for value in ["portable", "avx2", "avx512", "something else"] {
        let output = std::process::Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "kernel::the_choice_is_available_and_within_the_limit"])
            .env("REALISTIC_SIMD", value)
            .output()
            .expect("it starts");
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && text.contains("1 passed"), "{value}: {text}");
    }
}
