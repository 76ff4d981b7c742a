//! Point spread functions and MTFs against closed forms of a perfect lens, and against a direct sum of spherical waves.

use std::f64::consts::{PI, TAU};

use realistic_light::Surfaces;
use realistic_optics::{
    imaging::{axial_beam::stop_or_limiting, focus::Focus},
    lens::{Lens, first_order::FirstOrder, pupil::EntrancePupil},
    prescription::{Coating, catalogue, read},
};
use realistic_waves::{
    FilmPlane, ObjectPoint, Psf, Sampling, Wavefront, airy_mtf, mtf::Contrast, seidel, wavefront::object_of,
    zernike::Ordering,
};

/// Returns a surface that focuses parallel light perfectly, in glass, and the distance of the focus behind it: an
/// ellipsoid of eccentricity 1/n.
fn perfect(diameter: f64) -> (Lens, f64) {
    let n = 1.5;
    let text = format!("50 0 {n} {diameter}\nasphere 1 conic={}\n", -1.0 / (n * n));
    (Lens::at_d_line(&read("perfect", text.as_bytes()).expect("a lens")), 50.0 * n / (n - 1.0))
}

/// Returns the wavefront of a point at infinity on the axis, with the film `ahead` mm nearer than the focus.
fn on_axis(diameter: f64, ahead: f64, sampling: Sampling) -> Wavefront {
    let (lens, focus) = perfect(diameter);
    let object = ObjectPoint::toward(&lens, [0.0, 0.0, 1.0]).expect("in front");
    Wavefront::new(&lens, object, &FilmPlane::across(ahead - focus), sampling).expect("lit")
}

const COARSE: Sampling = Sampling { across: 64 };

/// Returns the Bessel function J1, by its integral (periodic, so that the sum over even steps is exact to rounding).
fn j1(x: f64) -> f64 {
    const STEPS: u32 = 200;
    let each = (0..STEPS).map(|i| {
        let t = PI * (f64::from(i) + 0.5) / f64::from(STEPS);
        (t - x * t.sin()).cos()
    });
    each.sum::<f64>() / f64::from(STEPS)
}

#[test]
fn a_perfect_lens_has_airys_pattern() {
    let wavefront = on_axis(6.0, 0.0, COARSE);
    assert!(wavefront.rms() < 1e-9 && wavefront.peak_to_valley() < 1e-8, "{:e}", wavefront.rms());
    assert!((wavefront.strehl() - 1.0).abs() < 1e-12);
    // The edge of the pupil lies a little beyond its outermost nodes.
    let (lens, focus) = perfect(6.0);
    let sagitta = lens.front().sagitta(3.0);
    let edge = 1.5 * 3.0_f64.atan2(focus - sagitta.abs()).sin();
    let radius = wavefront.circle().1;
    assert!((radius / edge - 1.0).abs() < 2e-3, "{radius} {edge}");
    let k = TAU / wavefront.wavelength;
    // The first dark ring has the radius 3.8317/(k q).
    let pitch = 3.831_706 / (k * edge) / 8.0;
    let psf = Psf::new(&wavefront, 65, pitch);
    assert!((psf.peak() / psf.perfect_peak - 1.0).abs() < 1e-9);
    for row in 0..65 {
        for column in 0..65 {
            let v = k * edge * psf.place(row).hypot(psf.place(column));
            let expected = if v > 0.0 { (2.0 * j1(v) / v).powi(2) } else { 1.0 };
            let own = psf.values[65 * row + column] / psf.peak();
            assert!((own - expected).abs() < 1e-4, "{row} {column}: {own} {expected}");
        }
    }
    // 83.78 % of the light falls within the first dark ring.
    let fine = Psf::new(&wavefront, 256, pitch / 8.0);
    let (mut within, ring) = (0.0, 8.0 * pitch);
    for (at, value) in fine.values.iter().enumerate() {
        if fine.place(at % 256).hypot(fine.place(at / 256)) < ring {
            within += value * fine.pitch.powi(2);
        }
    }
    assert!((within - 0.8378).abs() < 1e-3, "{within}");
}

#[test]
fn defocus_lowers_the_peak_as_the_closed_form_says() {
    let edge = on_axis(6.0, 0.0, COARSE).circle().1;
    for waves in [0.1_f64, 0.25, 0.5, 1.0] {
        // W = (film's displacement) n' (1 - cos u), with n' sin u = q.
        let cosine = (1.0 - (edge / 1.5).powi(2)).sqrt();
        let wavelength = 587.56e-6;
        let ahead = waves * wavelength / (1.5 * (1.0 - cosine));
        let wavefront = on_axis(6.0, ahead, COARSE);
        let expected = ((PI * waves).sin() / (PI * waves)).powi(2);
        assert!((wavefront.strehl() - expected).abs() < 2e-3, "{waves}: {} {expected}", wavefront.strehl());
        let [_, _, _, defocus, ..] = wavefront.zernike(Ordering::Fringe, 9)[..] else { panic!("nine") };
        assert!((2.0 * defocus.abs() - waves).abs() < 2e-3 * waves, "{waves}: {defocus}");
        assert!((wavefront.rms() - waves / 12.0_f64.sqrt()).abs() < 2e-3 * waves, "{}", wavefront.rms());
    }
}

#[test]
fn the_contrast_of_a_perfect_lens_is_that_of_overlapping_circles() {
    let wavefront = on_axis(6.0, 0.0, Sampling { across: 192 });
    let contrast = Contrast::new(&wavefront);
    let fractions = [0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97];
    let frequencies = fractions.map(|part| part * contrast.cutoff);
    for direction in [[1.0, 0.0], [0.0, 1.0], [0.6, 0.8]] {
        let mtf = contrast.along(direction, &frequencies);
        for (own, fraction) in mtf.with_diffraction.iter().zip(fractions) {
            let (own, expected) = (own[0].hypot(own[1]), airy_mtf(fraction));
            assert!((own - expected).abs() < 3e-4, "{direction:?} {fraction}: {own} {expected}");
        }
        assert!(mtf.geometric.iter().all(|[re, _]| (re - 1.0).abs() < 1e-6));
    }
}

/// Returns the power per area at a film point by Huygens's principle: a sum of spherical waves from where the rays leave
/// the last surface, relative to that at another point.
#[test]
fn the_field_is_a_sum_of_spherical_waves() {
    let (lens, focus) = perfect(6.0);
    let film = FilmPlane::across(-focus - 0.5);
    let object = ObjectPoint::toward(&lens, [0.0, 0.01, 1.0]).expect("in front");
    let wavefront = Wavefront::new(&lens, object, &film, COARSE).expect("lit");
    let pitch = 0.4 * wavefront.wavelength / wavefront.circle().1;
    let psf = Psf::new(&wavefront, 33, pitch);
    // On a sphere around the image point, 140 mm before it, the phase of each ray is that of W, and its amplitude goes with
    // the root of q's area, as that of the plane waves does.
    let (n, k) = (1.5, TAU / wavefront.wavelength);
    let radius = 140.0;
    let field = |x: f64, y: f64| {
        let mut sum = [0.0; 2];
        for node in &wavefront.nodes {
            let [dx, dy] = node.q.map(|q| q / n);
            let dz = -(1.0 - dx * dx - dy * dy).sqrt();
            // The ray passes the foot of the perpendicular from the image point; its point on the sphere lies behind.
            let foot = {
                let [lx, ly] = node.landing;
                let along = lx * dx + ly * dy;
                [lx - along * dx, ly - along * dy, -along * dz]
            };
            let back = (radius * radius - foot.iter().map(|part| part * part).sum::<f64>()).sqrt();
            let source = [foot[0] - back * dx, foot[1] - back * dy, foot[2] - back * dz];
            let [ax, ay, az] = [x - source[0], y - source[1], -source[2]];
            let distance = (ax * ax + ay * ay + az * az).sqrt();
            let (sin, cos) = (k * (node.w - n * back + n * distance)).sin_cos();
            let amplitude = node.amplitude * radius / distance;
            sum = [sum[0] + amplitude * cos, sum[1] + amplitude * sin];
        }
        sum[0] * sum[0] + sum[1] * sum[1]
    };
    let values: Vec<f64> = (0..33 * 33).map(|at| field(psf.place(at % 33), psf.place(at / 33))).collect();
    let scale = (wavefront.wavelength.powi(2) * wavefront.power()).recip();
    for (at, (own, direct)) in psf.values.iter().zip(values).enumerate() {
        assert!(
            (own - scale * direct).abs() < 3e-3 * psf.peak(),
            "{at}: {own} {} {}",
            scale * direct,
            psf.peak()
        );
    }
    assert!(psf.peak() < 0.95 * psf.perfect_peak, "the film is out of focus");
}

#[test]
fn power_is_kept_and_error_falls_with_sampling_for_every_lens() {
    for name in catalogue::names() {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let distance = 1e6;
        let film = lens.rear().vertex
            - Focus::new(&lens).expect("not afocal").film_distance(distance).expect("in reach");
        let point = [1.0, 1.5, film];
        let object = object_of(&lens, point, distance).unwrap_or_else(|error| panic!("{name}: {error}"));
        let wave = |across: usize| {
            Wavefront::new(&lens, object, &FilmPlane::across(film), Sampling { across })
                .unwrap_or_else(|error| panic!("{name}: {error}"))
        };
        let fine = wave(128);
        let miss: f64 = (0..2).map(|i| (fine.image[i] - point[i]).powi(2)).sum::<f64>().sqrt();
        assert!(miss < 1e-6, "{name}: the chief ray returns to its film point: {miss:e}");
        let waves = fine.rms();
        let coarse = wave(96);
        assert!((coarse.rms() / waves - 1.0).abs() < 2e-2, "{name}: {waves} {}", coarse.rms());
        assert!((coarse.power() / fine.power() - 1.0).abs() < 2e-3, "{name}");
        println!("{name:20} RMS {waves:8.3} waves, Strehl {:.4}, {} rays", fine.strehl(), fine.nodes.len());
    }
}

#[test]
fn third_order_sums_are_those_of_the_wavefront_of_a_small_pupil_and_field() {
    for (name, number) in
        [("tessar.50mm", 11.0), ("telephoto.250mm", 16.0), ("dgauss.100mm", 11.0), ("phone.4mm", 11.0)]
    {
        let prescription = catalogue::find(name).expect("listed");
        let mut lens = Lens::at_d_line(&prescription);
        // The stop is closed to the f-number.
        let first_order = FirstOrder::of(&lens).expect("not afocal");
        let stop = stop_or_limiting(&lens);
        let diameter = first_order.focal_length / number;
        lens.surfaces[stop].semi_diameter =
            EntrancePupil::of_surface(&lens, stop).semi_diameter_for(diameter);
        let film = first_order.rear_focal_point;
        let tangent = 0.02;
        let object = ObjectPoint::toward(&lens, [0.0, tangent, 1.0]).expect("in front");
        let sums = seidel::sums(&lens, &object).expect("a round lens");
        let total: [f64; 5] = std::array::from_fn(|k| sums.iter().map(|surface| surface[k]).sum());
        let wavefront = Wavefront::new(&lens, object, &FilmPlane::across(film), COARSE).expect("lit");
        let z = wavefront.zernike(Ordering::Fringe, 16);
        let waves = wavefront.wavelength;
        // Coefficients of r⁴, of r³ along y, and of r² along y and across it, from those of the polynomials.
        let [spherical, coma, astigmatism] = [6.0 * z[8] - 30.0 * z[15], 3.0 * z[7], -2.0 * z[4]];
        let size = total.iter().map(|sum| (sum / waves).abs()).fold(0.0, f64::max);
        // A ray that is high in the pupil has a low q: coma changes its sign.
        for (own, sum) in
            [(spherical, total[0] / 8.0), (coma, -total[1] / 2.0), (astigmatism, total[2] / 2.0)]
        {
            let expected = -sum / waves;
            assert!(
                (own - expected).abs() < 0.05 * expected.abs() + 0.01 * size,
                "{name}: {own} {expected} {total:?}"
            );
        }
        // The image of the chief ray is displaced by the distortion.
        let landing = -wavefront.image[1] - tangent * first_order.focal_length;
        let angle = diameter / (2.0 * first_order.focal_length);
        let expected = total[4] / (2.0 * angle);
        assert!(
            (landing.abs() - expected.abs()).abs() < 0.1 * expected.abs() + 1e-6,
            "{name}: {landing} {expected}"
        );
    }
}

#[test]
fn an_uncoated_surface_dims_rays_by_fresnels_equations() {
    let (lens, focus) = perfect(70.0);
    let object = ObjectPoint::toward(&lens, [0.0, 0.0, 1.0]).expect("in front");
    let film = FilmPlane::across(-focus);
    let bare = Surfaces::new(&lens, Coating::Bare);
    let clear = Wavefront::new(&lens, object, &film, COARSE).expect("lit");
    let lit = Wavefront::about(&lens, Some(&bare), object, &film, COARSE, None).expect("lit");
    let n = 1.5_f64;
    let mut least = 1.0_f64;
    for (clear, lit) in clear.nodes.iter().zip(&lit.nodes) {
        assert_eq!((clear.q, clear.w), (lit.q, lit.w));
        // n d' - d is normal to the surface; d is along the axis, and q is n d' across it.
        let across = lit.q[0].hypot(lit.q[1]);
        let along = (n * n - across * across).sqrt() - 1.0;
        let cosine = along / across.hypot(along);
        let behind = (1.0 - (1.0 - cosine * cosine) / (n * n)).sqrt();
        let [s, p] =
            [(cosine, n * behind), (n * cosine, behind)].map(|(a, b)| 1.0 - ((a - b) / (a + b)).powi(2));
        let expected = f64::midpoint(s, p);
        least = least.min(expected);
        assert!((lit.power / clear.power - expected).abs() < 1e-6, "{} {expected}", lit.power / clear.power);
        assert!(((lit.amplitude / clear.amplitude).powi(2) - expected).abs() < 1e-6);
    }
    assert!(least < 0.955, "the edge loses more than the middle: {least}");
}
