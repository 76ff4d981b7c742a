//! A zoom lens with moving groups against its patent, by first-order optics and exact rays.

use crate::support::{Random, build, camera, host, host_with, ray};
use ::realistic_camera::{Camera, FocusBy, Host, Model};
use realistic_optics::imaging::{
    axial_beam::AxialBeam,
    focus::{AxialImage, DepthOfField, Focus},
    moving::MovingGroups,
};
use realistic_optics::lens::{Lens, first_order::FirstOrder};
use realistic_optics::prescription::{Prescription, catalogue, read};

/// Rows of US 2003/0133200 A1 (S. Sato, Nikon 2003), example 1: 70-200 mm f/2.8, focused by its second group; the last
/// three positions are at a distance of 1.5 m. Clear diameters are derived. The columns are radius, thickness, index
/// behind and clear diameter.
const ROWS: &str = "\
136.2696 2.2 1.804 72.7
65.921 9 1.49782 68.7
184.6175 0.1 1 67.5
73.1041 8.9 1.49782 67.7
435.0246 14.1595 1 67.2
65.0851 1.8 1.84666 60.8
51.8175 1.92 1 58.7
63.216 8.7 1.64 58.7
1772.4929 2.52314 1 57.8
-1067.204 1.9 1.741 36.5
34.3923 6.835 1 32.8
-61.8566 1.8 1.48749 32.9
39.434 7 1.80518 34.8
-223.2401 1.803 1 34.9
-64.5266 1.9 1.8044 34.9
872.3457 34.06279 1 35.8
-599.1428 3.9 1.49782 36.4
-73.5485 0.2 1 36.9
93.8405 8 1.49782 37.7
-48.567 2 1.741 37.6
-149.5043 7.92945 1 38.1
0 1 1 37.4282
117.0055 2 1.80518 37.8
44.695 7 1.6968 37.1
-325.3499 0.1 1 36.8
76.1777 3.5 1.603 36.1
152.3247 20.6216 1 35.3
376.5966 3.8 1.84666 29.3
-57.886 1.5 1.741 29.2
50.043 3.9 1 28.6
-246.5579 1.5 1.741 29.0
102.2448 6.6784 1 29.5
-427.7771 4 1.49782 32.6
-58.2736 0.1 1 33.4
68.1118 7.5 1.741 34.8
-60.14 2 1.84666 34.7
-641.0882 66.21049 1 34.9
";
/// The positions, in the format of a lens file. The last three are the patent's positions for D0 = 1241.9566 mm.
const POSITIONS: &str = "\
positions wide middle tele - - -
gap 5 14.1595 14.1595 14.1595 4.43994 4.43994 4.43994
gap 9 2.52314 17.06549 31.15139 12.24271 26.78505 40.87095
gap 16 34.06279 25.29743 1.96176 34.06279 25.29743 1.96176
gap 21 7.92945 2.15247 11.40223 7.92945 2.15247 11.40223
focal 71.4 105 196 - - -
fnumber 2.88 2.88 2.88 - - -
object inf inf inf 1241.9566 1241.9566 1241.9566
";
const FOCAL_LENGTHS: [f64; 3] = [71.4, 105.0, 196.0];
const NEAR: f64 = 1241.9566;
/// Distance from the last vertex to the film in the table, mm.
const FILM: f64 = 66.21049;

fn text() -> String {
    format!("{POSITIONS}{ROWS}")
}

fn zoom_lens() -> Prescription {
    read("70-200", text().as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

fn groups(prescription: &Prescription) -> MovingGroups<'_> {
    MovingGroups::of(prescription).expect("positions")
}

/// Returns z of a point's image by exact rays through the open lens.
fn image(prescription: &Prescription, vergence: f64) -> Option<f64> {
    let lens = Lens::at_d_line(prescription);
    Some(AxialImage::of(&lens, AxialBeam::of(&lens).entrance).best(vergence).distance)
}

#[test]
fn at_its_positions_the_lens_is_what_the_patent_states() {
    let prescription = zoom_lens();
    let groups = groups(&prescription);
    for (zoom, stated) in FOCAL_LENGTHS.into_iter().enumerate() {
        let travel = groups.position(zoom);
        let placed = travel.at(travel.start());
        let lens = Lens::at_d_line(&placed);
        let optics = FirstOrder::of(&lens).expect("focal");
        assert!((optics.focal_length / stated - 1.0).abs() < 1e-3, "{}", optics.focal_length);
        assert!((optics.back_focal_distance() - FILM).abs() < 0.03, "{}", optics.back_focal_distance());
        assert_eq!(placed.stated_focal_length, Some(stated));
        let stop = lens.stop_index().expect("a stop");
        let fnumber = AxialBeam::of(&lens).fnumber(optics.focal_length);
        assert!((fnumber - 2.88).abs() < 1e-12, "{fnumber}");
        // For a real ray at f/2.88, the stop is equally wide at all three positions, 37.42 mm.
        let diameter = 2.0 * lens.surfaces[stop].semi_diameter;
        assert!((diameter / 37.42 - 1.0).abs() < 1e-3, "{diameter}");
        // When the lens is focused near, the film is still at the image.
        let lens = Lens::at_d_line(&travel.at(NEAR.recip()));
        let image = FirstOrder::of(&lens).expect("focal").image_distance(NEAR.recip());
        assert!((image - FILM).abs() < 0.03, "{stated} mm near: {image}");
    }
}

#[test]
fn a_zoom_between_positions_is_exact_and_stays_in_focus() {
    let prescription = zoom_lens();
    let groups = groups(&prescription);
    // Returns the distance between the film of a prescription and the best image of a distant point, by exact rays.
    let off = |prescription: &Prescription| {
        let focus = Focus::new(&Lens::at_d_line(prescription)).expect("focal");
        prescription.nominal_film_distance.expect("stated")
            - focus.film_distance(f64::INFINITY).expect("focal")
    };
    let listed = [0, 1, 2].map(|zoom| off(&groups.position(zoom).at(0.0)));
    let (least, most) =
        (listed.iter().copied().fold(f64::INFINITY, f64::min), listed.iter().copied().fold(0.0, f64::max));
    let [short, long] = groups.focal_range();
    let mut random = Random::new(12);
    for _ in 0..60 {
        let focal_length = short * (long / short).powf(random.next());
        let travel = groups.zoomed(focal_length, image).expect("in range");
        let placed = travel.at(travel.start());
        let own = FirstOrder::of(&Lens::at_d_line(&placed)).expect("focal").focal_length;
        assert!((own / focal_length - 1.0).abs() < 1e-14, "{own} is not {focal_length}");
        let off = off(&placed);
        assert!(
            (least - 1e-9..most + 1e-9).contains(&off),
            "{focal_length}: {off}, at the positions {listed:?}"
        );
        // The near end is also within the depth of focus for a circle of 0.05 mm, although the groups' paths to it are
        // interpolated between the positions.
        let [_, near] = travel.range();
        let near = near / 1.1;
        let image = FirstOrder::of(&Lens::at_d_line(&travel.at(near))).expect("focal").image_distance(near);
        assert!(
            (image - placed.nominal_film_distance.expect("stated")).abs() < 0.1,
            "{focal_length}: near {image}"
        );
    }
}

fn zoom_host() -> Host {
    host_with(&text())
}

/// Returns the distance from the film at which the rays of the film's centre come closest to each other.
fn meeting(camera: &Camera) -> f64 {
    let (mut heights, mut slopes) = (0.0, 0.0);
    for i in 0..40 {
        for j in 0..40 {
            let lens = [i, j].map(|k| (k as f32 + 0.5) / 40.0);
            let Some((ray, _)) = ray(camera, [200.0, 150.0], lens) else { continue };
            let ([x, y, z], [dx, dy, dz]) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
            let (sx, sy) = (dx / dz, dy / dz);
            heights += (x - sx * z) * sx + (y - sy * z) * sy;
            slopes += sx * sx + sy * sy;
        }
    }
    -heights / slopes - camera.facts().expect("a lens").film_z()
}

#[test]
fn groups_focus_at_any_distance_with_the_film_fixed() {
    let mut random = Random::new(5);
    for _ in 0..12 {
        let focal_length = 71.5 * (195.5_f64 / 71.5).powf(random.next());
        // Distances are 1.5 m or more, uniform in the reciprocal.
        let distance = 1500.0 / (1.0 - 0.97 * random.next());
        let zoom = focal_length.to_string();
        let far = build(&zoom_host(), &[("zoom", &zoom), ("fnumber", "4")]).expect("in reach").0;
        assert!((far.facts().expect("a lens").focal_length() / focal_length - 1.0).abs() < 1e-13);
        assert!((far.facts().expect("a lens").fnumber() - 4.0).abs() < 1e-12);
        let given = [
            ("zoom", &*zoom),
            ("fnumber", "4"),
            ("focus_by", "group"),
            ("focus_distance", &*distance.to_string()),
        ];
        let (camera, warnings) = build(&zoom_host(), &given).expect("in reach");
        assert_eq!(warnings, [""; 0]);
        let facts = camera.facts().expect("a lens");
        assert!(
            (facts.film_distance - far.facts().expect("a lens").film_distance).abs() < 1e-9,
            "the film has moved"
        );
        assert_eq!(facts.focus_distance_mm, Some(distance));
        // In the reverse direction, from the film, spherical aberration shifts the narrowest point of the beam. The
        // shift is less than the distance at which a point is blurred to a fifth of a pixel of a 24 megapixel camera.
        let sharp = DepthOfField::of(&facts.lens, &facts.beam.entrance, facts.film_distance, distance, 0.03);
        let sharp = sharp.expect("focal").expect("a pupil");
        let found = meeting(&camera);
        assert!((sharp.near..sharp.far).contains(&found), "f = {zoom}: {found} is not {distance}");
        // With focusing by the film, the same plane is in focus.
        let by_film = facts.focus().ok().and_then(|focus| focus.object_distance(facts.film_distance));
        assert!((by_film.expect("in front") / distance - 1.0).abs() < 1e-8, "{by_film:?} is not {distance}");
    }
}

#[test]
fn a_position_by_name_has_the_tables_gaps_and_film() {
    for (name, focal_length) in ["wide", "middle", "tele"].into_iter().zip(FOCAL_LENGTHS) {
        let (camera, _) = build(&zoom_host(), &[("zoom", name)]).expect("a position");
        assert_eq!(camera.facts().expect("a lens").lens.nominal_film_distance, Some(FILM));
        assert!((camera.facts().expect("a lens").focal_length() / focal_length - 1.0).abs() < 1e-3);
        // At the long end, the clear diameters of the front elements limit the beam slightly.
        let most = if name == "tele" { 3.0 } else { 2.88 + 1e-12 };
        assert!(
            (2.88 - 1e-12..most).contains(&camera.facts().expect("a lens").fnumber()),
            "{}",
            camera.facts().expect("a lens").fnumber()
        );
    }
    // The default is the first position.
    let lens = |given: &[(&str, &str)]| {
        build(&zoom_host(), given).expect("a lens").0.facts().expect("a lens").lens.clone()
    };
    assert_eq!(lens(&[]), lens(&[("zoom", "wide")]));
    assert_eq!(lens(&[]), lens(&[("focus_by", "group")]));
}

/// Checks every column of every table of the catalogue in a camera that is zoomed and focused to that column.
#[test]
fn cameras_at_every_position_are_as_the_files_state() {
    let mut columns = [0, 0];
    for name in catalogue::round() {
        let prescription = catalogue::find(name).expect("listed");
        let Some(positions) = &prescription.positions else { continue };
        let layout = positions.layout();
        for (i, column) in positions.columns.iter().enumerate() {
            let zoom = i % layout.zooms;
            let mut given = vec![("lens_file", name.to_owned())];
            if layout.zooms > 1 {
                given
                    .push(("zoom", positions.columns[zoom].name.clone().expect("every position has a name")));
            }
            if let Some(object) = column.object_distance {
                // The thicknesses go from the object to the first vertex, through all gaps, to the film.
                let mut thicknesses: Vec<f64> =
                    prescription.interfaces.iter().map(|row| row.thickness).collect();
                *thicknesses.last_mut().expect("rows") = prescription.nominal_film_distance.expect("stated");
                positions.gaps.iter().zip(&column.gaps).for_each(|(&row, &gap)| thicknesses[row] = gap);
                let distance = object + thicknesses.iter().sum::<f64>();
                given.push(("focus_by", "group".to_owned()));
                given.push(("focus_distance", distance.to_string()));
            }
            let given: Vec<(&str, &str)> = given.iter().map(|(name, text)| (*name, text.as_str())).collect();
            let camera = camera(&given);
            let facts = camera.facts().expect("a lens");
            let far = &positions.columns[zoom];
            for ((&row, &gap), &start) in positions.gaps.iter().zip(&column.gaps).zip(&far.gaps) {
                let own = match facts.lens.surfaces.get(row) {
                    Some(surface) if row + 1 < facts.lens.surfaces.len() => surface.thickness,
                    _ => facts.film_distance,
                };
                // The groups are placed by the focus of real rays, which differs slightly from the table's paraxial
                // focus.
                let allowed = 1e-9 + if i < layout.zooms { 0.0 } else { 0.03 * (gap - start).abs() };
                assert!((own - gap).abs() <= allowed, "{name}, position {i}, row {row}: {own} for {gap}");
            }
            if let Some(stated) = column.focal_length {
                assert!((facts.focal_length() / stated - 1.0).abs() < 1e-3, "{name}, position {i}");
                columns[0] += 1;
            }
            if let Some(stated) = column.fnumber {
                // At a curved surface, first-order optics has a wider beam than real rays. The clear diameters are
                // derived from real rays, and limit the first-order beam slightly.
                let own = facts.fnumber();
                assert!((own / stated - 1.0).abs() < 0.05, "{name}, position {i}: f/{own} for f/{stated}");
                columns[1] += 1;
            }
        }
    }
    assert_eq!(columns, [8, 8], "3 and 3 of the zooms, and far those of the macro and the telephoto lens");
}

#[test]
fn the_ideal_models_zoom_and_focus_by_groups_too() {
    let builder = Camera::builder()
        .lens_text("70-200", text().as_bytes())
        .zoom(140.0)
        .focus_by(FocusBy::Group)
        .focus_distance(2500.0)
        .resolution(30, 20);
    for model in [Model::Thick, Model::Thin] {
        let camera = builder.clone().model(model).build().expect("in reach");
        let facts = camera.facts().expect("a lens");
        let in_focus = facts.first_order.clone().expect("focal").object_distance(facts.film_distance);
        assert!((in_focus.expect("in front") / 2500.0 - 1.0).abs() < 1e-10, "{in_focus:?}");
        assert!((facts.film_distance - FILM).abs() < 0.3);
    }
}

#[test]
fn impossible_values_are_refused_with_the_range_and_what_to_do() {
    let refused = |host: &Host, given: &[(&str, &str)]| build(host, given).expect_err("refused");
    for (given, parts) in [
        (&[("zoom", "300")][..], &["zooms from 71.39", "196"][..]),
        (&[("zoom", "50mm")], &["zooms from 71.39", "196"]),
        (&[("zoom", "wid")], &["\"wid\"", "from 71.39", "\"wide\", \"middle\" or \"tele\""]),
        (&[("zoom", "-35")], &["\"zoom\" is -35", "positive"]),
        (
            &[("zoom", "wide"), ("focus_by", "group"), ("focus_distance", "1000")],
            &["from 1", "to infinity", "1000 mm"],
        ),
        (
            &[("focus_by", "group"), ("film_distance", "70")],
            &["\"film_distance\" moves the film", "\"focus_distance\""],
        ),
        (&[("focus_by", "groups")], &["\"film\" or \"group\""]),
    ] {
        let error = refused(&zoom_host(), given);
        assert!(parts.iter().all(|part| error.contains(part)), "{given:?}: {error}");
    }
    assert!(refused(&host(), &[("zoom", "50")]).contains("one focal length"));
    assert!(refused(&host(), &[("focus_by", "group")]).contains("leave out \"focus_by\""));
    // A zoom lens cannot be scaled.
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("zoom-to-scale.dat");
    std::fs::write(&file, text()).expect("written");
    let scaled = format!("{}@100mm", file.display());
    let error = refused(&host(), &[("lens_file", &scaled)]);
    assert!(error.contains("\"zoom\", from 71.39") && error.contains("leave out the @"), "{error}");
}
