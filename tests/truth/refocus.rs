//! A camera that is built from another camera has the same bits, facts and messages as one that is built from scratch.

use crate::support::columns::RayAt as _;
use crate::support::{Random, host, host_with};
use ::realistic_camera::{Camera, Host, Parameters, Rays, Sample, Samples};

type Given<'a> = &'a [(&'a str, &'a str)];

fn build(donor: Option<&Camera>, host: &Host, given: Given<'_>) -> Result<(Camera, Vec<String>), String> {
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).expect("a parameter");
    }
    let mut messages = Vec::new();
    let mut log = |_, text: &str| messages.push(text.to_owned());
    let camera = Camera::build_from(donor, &parameters, host, &mut log).map_err(|error| error.to_string())?;
    Ok((camera, messages))
}

const RAYS: usize = 600;

/// Returns the bits of rays over the whole picture and pupil, with their weights.
fn bits(camera: &Camera) -> Vec<u32> {
    let mut random = Random::new(5);
    let mut column = |size: f32| -> Vec<f32> { (0..RAYS).map(|_| random.next() as f32 * size).collect() };
    let [image_x, image_y] = [300.0, 200.0].map(&mut column);
    let [lens_u, lens_v, time] = [1.0; 3].map(&mut column);
    let samples = Samples::columns([&image_x, &image_y, &lens_u, &lens_v, &time]);
    let mut numbers = vec![[0.0_f32; RAYS]; 10];
    let [x, y, z, dx, dy, dz, weight, mint, maxt, times] = &mut numbers[..] else { unreachable!() };
    let rays = Rays::columns([x, y, z], [dx, dy, dz], weight).with_range([mint, maxt]);
    camera.trace(&samples, &mut rays.with_time(times));
    let mut bits: Vec<u32> = numbers.as_flattened().iter().map(|number| number.to_bits()).collect();
    // Single calls, and calls at a wavelength.
    for i in 0..8 {
        let sample = Sample {
            image_x: image_x[i],
            image_y: image_y[i],
            lens_u: lens_u[i],
            lens_v: lens_v[i],
            time: time[i],
        };
        for found in [camera.ray(&sample), camera.ray_at(&sample, 500.0)] {
            let (ray, weight) = found.unwrap_or_default();
            bits.extend(
                ray.origin.iter().chain(&ray.direction).chain([&weight]).map(|number| number.to_bits()),
            );
        }
    }
    bits
}

/// Builds each camera from the previous one, and compares it with one built from scratch.
fn compare(host: &Host, steps: &[Given<'_>]) {
    let mut donor: Option<Camera> = None;
    for given in steps {
        let anew = build(None, host, given);
        let refocused = build(donor.as_ref(), host, given);
        // The donor is freed before rays are requested from the camera.
        drop(donor.take());
        match (anew, refocused) {
            (Ok((anew, expected)), Ok((refocused, messages))) => {
                assert_eq!(bits(&refocused), bits(&anew), "{given:?}");
                assert_eq!(messages, expected, "{given:?}");
                let described =
                    [&refocused, &anew].map(|camera| format!("{:?} {}", camera.facts(), camera.plan()));
                assert_eq!(described[0], described[1], "{given:?}");
                donor = Some(refocused);
            }
            (anew, refocused) => {
                let [expected, error] =
                    [anew, refocused].map(|result| result.map(|_| ()).expect_err("refused by both"));
                assert_eq!(error, expected, "{given:?}");
            }
        }
    }
}

#[test]
fn a_refocused_camera_has_the_bits_of_a_new_one() {
    for lens in ["dgauss.50mm", "retrofocus.24mm", "ultrawide.14mm", "macro.105mm", "fisheye.16mm"] {
        let lens = ("lens_file", lens);
        compare(
            &host(),
            &[
                &[lens],
                &[lens, ("focus_distance", "2000")],
                &[lens, ("focus_distance", "1500"), ("fnumber", "8")],
                &[lens, ("focus_distance", "1400"), ("fnumber", "8"), ("pupil", "rear")],
                &[lens, ("film_distance", "1"), ("fnumber", "1.1")],
                &[lens, ("focus_distance", "1400"), ("wavelength", "500"), ("film_diagonal", "20")],
                &[lens, ("focus_distance", "1")],
                &[lens, ("model", "thick"), ("focus_distance", "1400")],
                &[lens, ("focus_distance", "1300"), ("transmission", "quarter-wave"), ("blades", "7")],
                &[("lens_file", "tessar.50mm"), ("focus_distance", "1300")],
            ],
        );
    }
}

#[test]
fn a_zoom_lens_may_be_zoomed_and_focused_by_its_groups() {
    let lens = ("lens_file", "zoom.24-70mm");
    compare(
        &host(),
        &[
            &[lens, ("zoom", "35")],
            &[lens, ("zoom", "35"), ("focus_distance", "3000")],
            &[lens, ("zoom", "36"), ("focus_distance", "3000")],
            &[lens, ("zoom", "36"), ("focus_distance", "2900"), ("focus_by", "group")],
            &[lens, ("zoom", "36"), ("focus_distance", "2800"), ("focus_by", "group")],
            &[lens, ("zoom", "36"), ("focus_distance", "2800")],
        ],
    );
}

#[test]
fn another_text_of_the_same_name_is_another_lens() {
    let text = |index: &str| format!("40 6 {index} 20\n-40 40 1 20\n");
    let given: Given<'_> = &[("film_distance", "38"), ("film_diagonal", "10")];
    let [first, second] = ["1.5", "1.6"].map(|index| host_with(&text(index)));
    let (donor, _) = build(None, &first, given).expect("a camera");
    let (anew, _) = build(None, &second, given).expect("a camera");
    let (refocused, _) = build(Some(&donor), &second, given).expect("a camera");
    assert_eq!(bits(&refocused), bits(&anew));
    assert_ne!(bits(&refocused), bits(&donor));
}
