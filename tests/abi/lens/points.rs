//! The surfaces of a lens, and the intersections of rays with them.

use std::ffi::CString;
use std::ptr::{null, null_mut};

use super::{Lens, SINGLET, last_error};
use realistic::ffi::*;

/// Returns the sagitta of a surface at distance `r` from the axis, and its slope there.
fn sagitta(surface: &realistic_lens_surface, r: f64) -> [f64; 2] {
    let c = surface.conic_radius_mm.recip();
    let root = (1.0 - (1.0 + surface.conic) * c * c * r * r).sqrt();
    let mut found = [c * r * r / (1.0 + root), c * r / root];
    for (term, i) in surface.aspheric.iter().zip(1..) {
        found[0] += term * r.powi(i);
        found[1] += f64::from(i) * term * r.powi(i - 1);
    }
    found
}

fn unit(d: [f64; 3]) -> [f64; 3] {
    let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
    d.map(|x| x / length)
}

/// Checks that the intersections lie on the lens's surfaces, and that refraction obeys Snell's law: the tangential
/// component of the vector of length n along the ray is conserved.
#[test]
fn points_lie_on_their_surfaces_and_obey_snell_at_each() {
    let (mut refractions, mut stopped, mut aspheres) = (0, 0, 0);
    for name in realistic_optics::prescription::catalogue::round() {
        let lens = Lens::named(&CString::new(name).expect("a name"));
        let info = lens.info();
        let surfaces: Vec<_> = (0..info.surfaces).map(|k| lens.surface(k).expect("there")).collect();
        aspheres +=
            surfaces.iter().filter(|s| s.conic != 0.0 || s.aspheric.iter().any(|a| *a != 0.0)).count();
        for from in [realistic_side::Scene, realistic_side::Film] {
            let is_scene = from == realistic_side::Scene;
            let (first, toward) =
                if is_scene { (&surfaces[0], -1.0) } else { (surfaces.last().unwrap(), 1.0) };
            let rays: Vec<[f64; 6]> = (0..60)
                .map(|i| {
                    let part = |step: f64| 2.0 * (f64::from(i) * step).fract() - 1.0;
                    let [x, y] = [part(0.618), part(0.754)].map(|u| 0.8 * first.semi_diameter_mm * u);
                    let z = first.vertex_mm - toward * 2.0 * first.semi_diameter_mm;
                    [x, y, z, 0.2 * part(0.569), 0.2 * part(0.831), toward]
                })
                .collect();
            let (plain, reasons) = lens.trace(from, &rays);
            for (i, traced) in lens.trace_points(from, &rays).iter().enumerate() {
                assert_eq!(traced.reason, reasons[i], "{name}");
                let size = -info.rear_vertex_mm + first.semi_diameter_mm;
                for (a, b) in traced.ray.iter().zip(plain[i]) {
                    assert!((a - b).abs() < 1e-13 * size.max(1.0), "{name}: {a} {b}");
                }
                let along: Vec<usize> = if is_scene {
                    (0..surfaces.len()).collect()
                } else {
                    (0..surfaces.len()).rev().collect()
                };
                let (met, not) = along.split_at(traced.met);
                assert!(not.iter().all(|k| traced.points[*k].iter().all(|x| x.is_nan())), "{name}");
                let passes = traced.reason == realistic_reason::Ok;
                assert!(!passes || not.is_empty(), "{name}");
                assert!(met.last().is_none_or(|last| traced.points[*last] == traced.ray[..3]), "{name}");
                stopped += usize::from(!passes);
                let mut before = [rays[i][0], rays[i][1], rays[i][2]];
                for (number, k) in met.iter().enumerate() {
                    let (surface, point) = (&surfaces[*k], traced.points[*k]);
                    let r = point[0].hypot(point[1]);
                    if r > surface.semi_diameter_mm {
                        // The ray ends here, because the prescription puts this point outside the surface's clear
                        // aperture.
                        assert_eq!(
                            (traced.reason, number + 1),
                            (realistic_reason::Clipped, traced.met),
                            "{name}"
                        );
                        break;
                    }
                    let [depth, slope] = sagitta(surface, r);
                    let off = surface.vertex_mm - depth - point[2];
                    assert!(off.abs() < 1e-13 * size.max(1.0), "{name} {k}: {off}");
                    let after = match met.get(number + 1) {
                        Some(next) => traced.points[*next],
                        None if passes => std::array::from_fn(|j| point[j] + traced.ray[3 + j]),
                        None => break,
                    };
                    let steps =
                        [(before, point), (point, after)].map(|(a, b)| [0, 1, 2].map(|j| b[j] - a[j]));
                    let normal =
                        unit([slope * point[0] / r.max(1e-300), slope * point[1] / r.max(1e-300), 1.0]);
                    let indices = if is_scene {
                        [surface.index_scene, surface.index_film]
                    } else {
                        [surface.index_film, surface.index_scene]
                    };
                    let [a, b] = [0, 1].map(|side: usize| {
                        let d = unit(steps[side]);
                        let across: f64 = (0..3).map(|j| d[j] * normal[j]).sum();
                        [0, 1, 2].map(|j: usize| indices[side] * (d[j] - across * normal[j]))
                    });
                    let shortest = steps.iter().map(|s| s[2].abs()).fold(f64::INFINITY, f64::min);
                    for (a, b) in a.iter().zip(b) {
                        assert!((a - b).abs() < 1e-13 + 1e-14 * size / shortest, "{name} {k}: {a} {b}");
                    }
                    refractions += 1;
                    before = point;
                }
            }
        }
    }
    assert!(refractions > 10_000 && stopped > 100 && aspheres > 6, "{refractions} {stopped} {aspheres}");
}

#[test]
fn points_want_room_and_a_side() {
    let lens = Lens::of_text(SINGLET, |_| ()).expect("a lens");
    let mut numbers = [0.0; 6];
    let [ox, oy, oz, dx, dy, dz] = numbers.each_mut().map(std::ptr::from_mut);
    let struct_size = size_of::<realistic_lens_rays>() as u32;
    let rays = realistic_lens_rays {
        struct_size,
        origin: realistic_vectors::columns([ox, oy, oz]),
        direction: realistic_vectors::columns([dx, dy, dz]),
        reason: null_mut(),
        reason_stride: 0,
        optical_path: null_mut(),
        optical_path_stride: 0,
    };
    let mut room = [[5.0; 3]; 3];
    let [x, y, z] = room.each_mut().map(|column| column.as_mut_ptr());
    let struct_size = size_of::<realistic_lens_points>() as u32;
    let points = realistic_lens_points {
        struct_size,
        point: realistic_vectors::columns([x, y, z]),
        met: null_mut(),
        met_stride: 0,
    };
    let none = realistic_lens_points { point: realistic_vectors { y: null_mut(), ..points.point }, ..points };
    let small = realistic_lens_points { struct_size: 8, ..points };
    // SAFETY: structures and arrays of a ray, or NULL.
    unsafe {
        use realistic_status::{InvalidParameter, NotALens, NullPointer, Ok, StructSize};
        for (lens, from, n, rays, points, status, words) in [
            (null(), 0, 1, &raw const rays, &raw const points, NotALens, "no lens"),
            (lens.0.cast_const(), 2, 1, &rays, &points, InvalidParameter, "from is 2"),
            (lens.0, 0, 1, null(), &points, NullPointer, "rays is NULL"),
            (lens.0, 0, 1, &rays, &none, NullPointer, "points.point.y is NULL"),
            (lens.0, 0, 1, &rays, &small, StructSize, "realistic_lens_points.struct_size is 8"),
            (lens.0, 0, usize::MAX / 16, &rays, &points, InvalidParameter, "no memory holds"),
        ] {
            assert_eq!(realistic_lens_trace(lens, from, n, rays, points), status, "{words}");
            assert!(last_error().contains(words), "{}", last_error());
        }
        assert_eq!(realistic_lens_trace(lens.0, 0, 0, &rays, &none), Ok);
    }
    assert_eq!(room, [[5.0; 3]; 3]);
    let strange = [[f64::NAN, 0.0, 10.0, 0.0, 0.0, -1.0], [0.0, 0.0, 10.0, 0.0, 0.0, 0.0]];
    for (traced, given) in lens.trace_points(realistic_side::Scene, &strange).iter().zip(strange) {
        assert_eq!((traced.reason, traced.met), (realistic_reason::Missed, 0));
        assert_eq!(traced.ray.map(f64::to_bits), given.map(f64::to_bits));
        assert!(traced.points.as_flattened().iter().all(|x| x.is_nan()));
    }
}
