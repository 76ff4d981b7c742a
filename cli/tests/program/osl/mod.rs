//! `realistic blender`: compares the text of the shader, compiled as C++, with exact rays in double precision. OSL is
//! so close to C that a few replacements convert it; the arithmetic remains in single precision.

mod apertures;
mod media;
mod picture;
mod unsymmetric;

use realistic_camera::sampling::PupilDisk;
use realistic_camera::{FocusBy, Host, Parameters, Raster, Zoom, group_reach, open_lens};
use realistic_light::{LitPath, Surfaces};
use realistic_optics::imaging::{
    axial_beam::stop_or_limiting, focus::Focus, irradiance, moving::MovingGroups,
};
use realistic_optics::lens::{Lens, Ray, first_order::FirstOrder, pupil::SlopeDisk};
use realistic_optics::prescription::{Coating, catalogue, read};
use realistic_optics::trace::Path;
use std::collections::BTreeMap;
use std::env;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, OnceLock};

use rayon::prelude::*;

use super::{fails, succeeds};

const PRELUDE: &str = include_str!("prelude.hpp");

/// Converts the shader's text to C++.
fn translated(text: &str) -> String {
    let (functions, body) = text.split_once("shader realistic_camera(").expect("a shader");
    let mut parameters = String::new();
    let mut rest = body;
    // Blender's panel needs the metadata, but the test does not.
    while let Some((before, after)) = rest.split_once("[[") {
        parameters += before;
        rest = after.split_once("]]").expect("closed").1;
    }
    let (last, body) = rest.split_once(")\n{").expect("a body");
    parameters += last;
    // The zoom is an argument of the program, so that one program serves all focal lengths.
    let declare = |parameter: &str| {
        let parameter = parameter.trim().trim_start_matches("output ");
        let parameter = parameter.strip_prefix("float zoom = ").map_or_else(
            || parameter.to_owned(),
            |own| format!("float zoom = requested_zoom > 0 ? requested_zoom : {own}"),
        );
        format!("    {parameter};\n")
    };
    let declared: Vec<String> = parameters.split(',').map(declare).collect();
    // The variables that move follow these eight values.
    let recorded = "template <class... Moved> static int recorded(float stop, float nm, float &x, float &y, float &z, float &vx,\n\
         float &vy, float &vz, Moved &&...moved) {\n\
         float now[8] = {1, stop, nm, x, y, vx, vy, vz};\n\
         for (int i = 0; i < 8; i++) traced[i] = now[i];\n\
         return trace(stop, nm, x, y, z, vx, vy, vz, moved...);\n}\n";
    let body = body.replace("!trace(", "!recorded(").replace("return;", "goto done;");
    let body = body.trim_end().trim_end_matches('}');
    let result = "float all[9] = {throughput[0], position[0], position[1], position[2], direction[0], direction[1],\n\
         direction[2], throughput[1], throughput[2]};\n\
         for (int i = 0; i < 9; i++) out[i] = all[i];\n";
    let functions =
        single(&functions.replace("output float ", "float &").replace("output vector ", "vector &"));
    // A jump must not skip a declaration with an initial value, so the body is a separate function.
    let body = body.replace("goto done;", "return;");
    let arguments: Vec<&str> = declared
        .iter()
        .filter_map(|declared| {
            declared.trim().trim_end_matches(';').split_once('=').map(|(left, _)| left.trim())
        })
        .collect();
    let names: Vec<&str> = arguments.iter().map(|left| left.split_once(' ').expect("a type").1).collect();
    let by_reference: Vec<String> = arguments
        .iter()
        .map(|left| left.split_once(' ').map(|(kind, name)| format!("{kind} &{name}")).expect("a type"))
        .collect();
    format!(
        "{PRELUDE}\nnamespace osl {{\n{functions}\n{recorded}\nstatic void camera({}) {{{}}}\nstatic void shader(float *out) {{\n{}\
         camera({});\n{result}}}\n}}\nint main(int, char **given) {{ return osl::serve(osl::shader, given[1]); }}\n",
        by_reference.join(", "),
        single(&body),
        single(&declared.concat()),
        names.join(", "),
    )
}

/// Converts the floating-point literals of C++ to single precision.
fn single(text: &str) -> String {
    let mut out = String::new();
    let mut number = String::new();
    let mut in_word = false;
    for c in text.chars().chain(['\n']) {
        let goes_on = c.is_ascii_digit() || c == '.' || (c == 'e' || c == '-') && !number.is_empty();
        let is_sign = c == '-' && !number.ends_with('e');
        if !in_word && goes_on && !is_sign {
            number.push(c);
            continue;
        }
        if !number.is_empty() {
            let is_float = number.contains(['.', 'e']);
            out += &std::mem::take(&mut number);
            if is_float {
                out.push('f');
            }
        }
        in_word = c.is_alphanumeric() || c == '_' || c == ']' || c == ')';
        out.push(c);
    }
    out
}

/// Returns the output of `realistic blender` for a lens and further arguments, and the path of the program compiled
/// from it as C++. All tests share the results, because the shader of a zoom lens takes seconds.
fn made(lens: &str, more: &[&str]) -> Arc<(String, PathBuf)> {
    type Made = Arc<OnceLock<Arc<(String, PathBuf)>>>;
    static ALL: Mutex<BTreeMap<String, Made>> = Mutex::new(BTreeMap::new());
    let arguments = [&["blender", lens, "--out", "-"], more].concat();
    let own = Arc::clone(ALL.lock().expect("no panic").entry(arguments.join("\n")).or_default());
    Arc::clone(own.get_or_init(|| {
        let text = succeeds(&arguments, "");
        let program = compiled(&translated(&text));
        Arc::new((text, program))
    }))
}

/// Compiles C++ to a program in Cargo's directory for temporary files of tests. The program's name is a hash of all
/// inputs, so an existing program is reused.
fn compiled(text: &str) -> PathBuf {
    const FLAGS: [&str; 3] = ["-std=c++11", "-O1", "-ffp-contract=off"];
    let compiler = env::var_os("CXX").unwrap_or_else(|| "c++".into());
    let mut hash = DefaultHasher::new();
    (&compiler, FLAGS, text).hash(&mut hash);
    let folder_of_tests = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let program = folder_of_tests.join(format!("shader-{:016x}", hash.finish()));
    if program.is_file() {
        return program;
    }
    let folder = tempfile::tempdir_in(folder_of_tests).expect("a folder");
    let [source, fresh] = ["shader.cpp", "shader"].map(|name| folder.path().join(name));
    std::fs::write(&source, text).expect("written");
    let mut command = Command::new(compiler);
    command.args(FLAGS).arg(&source).arg("-o").arg(&fresh);
    let output = command.output().expect("a C++ compiler: name it in CXX");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // Another process may compile the same program at the same time.
    std::fs::rename(fresh, &program).expect("renamed");
    program
}

/// A compiled shader.
struct Shader {
    program: PathBuf,
    /// Focal length, mm; `None` for the shader's own.
    zoom: Option<f64>,
    /// Distance from the axis up to which film points get light, mm.
    reach: f64,
    focuses_by_groups: bool,
}

/// A sample: raster, lens sample, aperture size (1/(2 N)), focus distance in m, sensor size in mm, and number of the
/// wavelength.
type Sample = [f32; 9];

/// The result of a sample.
#[derive(Clone, Copy, Debug)]
struct Answer {
    throughput: [f32; 3],
    /// Position, mm.
    position: [f64; 3],
    direction: [f64; 3],
    /// Whether the pupil gave a ray to trace. If so, the following fields are the ray's stop, and its x, y and
    /// direction on the rear vertex plane.
    is_traced: bool,
    stop: f64,
    start: [f64; 2],
    heading: [f64; 3],
}

impl Shader {
    fn new(lens: &str, more: &[&str]) -> Self {
        let made = made(lens, more);
        let (text, program) = made.as_ref();
        let facts = facts(text);
        let reach = facts["film_reach_mm"].as_f64().expect("a number");
        let focuses_by_groups = facts["focuses_by_groups"].as_bool().expect("a truth");
        Self { program: program.clone(), zoom: None, reach, focuses_by_groups }
    }

    fn answers(&self, samples: &[Sample]) -> Vec<Answer> {
        let mut child = Command::new(&self.program)
            .args(self.zoom.map(|focal_length| focal_length.to_string()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the shader starts");
        let mut pipe = child.stdin.take().expect("a pipe");
        let bytes: Vec<u8> = samples.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
        let writer = std::thread::spawn(move || pipe.write_all(&bytes));
        let output = child.wait_with_output().expect("the shader ends");
        writer.join().expect("no panic").expect("written");
        let values: Vec<f32> =
            output.stdout.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert_eq!(values.len(), 17 * samples.len());
        let answer = |v: &[f32]| {
            let wide = |i: usize| f64::from(v[i]);
            Answer {
                throughput: [v[0], v[7], v[8]],
                position: [1000.0 * wide(1), 1000.0 * wide(2), 1000.0 * wide(3)],
                direction: [wide(4), wide(5), wide(6)],
                is_traced: v[9] == 1.0,
                stop: wide(10),
                start: [wide(12), wide(13)],
                heading: [wide(14), wide(15), wide(16)],
            }
        };
        values.chunks(17).map(answer).collect()
    }
}

/// Returns the points of Korobov's rank-1 lattice with these generators, which are evenly spread over a cube.
fn points<const N: usize>(count: usize) -> impl Iterator<Item = [f32; N]> {
    const GENERATORS: [f64; 4] =
        [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_997_5, 0.450_301_4];
    (0..count).map(|i| {
        std::array::from_fn(|k| (((i as f64 + 0.5) * GENERATORS[k]).fract() as f32).min(0.999_999_9))
    })
}

/// Returns the facts in a shader's text.
fn facts(text: &str) -> serde_json::Value {
    let line = text.lines().find_map(|line| line.strip_prefix("// facts: ")).expect("facts");
    serde_json::from_str(line).expect("JSON")
}

fn lens_of(name: &str) -> Lens {
    Lens::at_d_line(&catalogue::find(name).expect("listed"))
}

/// Returns the lens with its groups focused at a distance, m from the front vertex; 0 stands for infinity. The
/// library measures distances from the film.
fn focused(name: &str, zoom: Option<f64>, distance: f32) -> Lens {
    let host = Host::new(Raster { xres: 1, yres: 1 }, None);
    let mut parameters = Parameters {
        lens_file: Some(name.to_owned()),
        zoom: zoom.map(Zoom::FocalLength),
        focus_by: Some(FocusBy::Group),
        ..Parameters::default()
    };
    let mut length = 0.0;
    // Each round leaves a sixth of the previous error at near distances.
    for _ in 0..16 {
        let from_film = if distance > 0.0 { 1000.0 * f64::from(distance) + length } else { f64::INFINITY };
        // A distance slightly nearer than the limit is replaced by the limit itself.
        let reach = group_reach(&parameters, &host).expect("it focuses");
        parameters.focus_distance = Some(from_film.max(reach[0].object_distance * (1.0 + 1e-9)));
        let (prescription, lens) = open_lens(&parameters, &host, &mut |_, _| ()).expect("in reach");
        length = prescription.nominal_film_distance.expect("stated") - lens.rear().vertex;
        if distance == 0.0 {
            return lens;
        }
    }
    open_lens(&parameters, &host, &mut |_, _| ()).expect("in reach").1
}

/// Errors of directions, radians, errors of the points where the ray comes nearest, mm, and counts.
#[derive(Debug, Default)]
struct Comparison {
    directions: Vec<f64>,
    offsets: Vec<f64>,
    fates_differ: usize,
    passed: usize,
    traced: usize,
}

impl Comparison {
    fn of(lens: &Lens, answers: &[Answer]) -> Self {
        let mut result = Self::default();
        let stop = stop_or_limiting(lens);
        let mut path: Option<(f64, Path)> = None;
        for answer in answers.iter().filter(|answer| answer.is_traced) {
            result.traced += 1;
            if path.as_ref().is_none_or(|(s, _)| *s != answer.stop) {
                let mut lens = lens.clone();
                lens.surfaces[stop].semi_diameter *= answer.stop;
                path = Some((answer.stop, Path::film_to_scene(&lens).with_apertures(&lens)));
            }
            let (_, path) = path.as_ref().expect("made");
            // The exact ray starts behind the whole rear surface.
            let ([x, y], [vx, vy, vz]) = (answer.start, answer.heading);
            let back = 2.0 * lens.rear().semi_diameter;
            let origin = [x - back * vx / vz, y - back * vy / vz, lens.rear().vertex - back];
            let exact = path.trace(Ray { origin, direction: answer.heading });
            let passes = answer.throughput.iter().sum::<f32>() > 0.0;
            result.passed += usize::from(passes);
            result.fates_differ += usize::from(passes != exact.is_ok());
            if let (true, Ok(exact)) = (passes, exact) {
                let d = std::array::from_fn::<f64, 3, _>(|i| answer.direction[i] - exact.direction[i]);
                result.directions.push(d.iter().map(|d| d * d).sum::<f64>().sqrt());
                let o: [f64; 3] = std::array::from_fn(|i| answer.position[i] - exact.origin[i]);
                let along: f64 = o.iter().zip(&exact.direction).map(|(a, b)| a * b).sum();
                let across: f64 = o.iter().map(|a| a * a).sum::<f64>() - along * along;
                result.offsets.push(across.max(0.0).sqrt());
            }
        }
        result.directions.sort_by(f64::total_cmp);
        result.offsets.sort_by(f64::total_cmp);
        result
    }

    fn median_and_most(list: &[f64]) -> [f64; 2] {
        [list[list.len() / 2], list[list.len() - 1]]
    }
}

/// Returns cameras with a full-frame sensor: wide open, at the far and the near end of the focus range, then stopped
/// down.
fn cameras() -> [[f32; 2]; 4] {
    // Each row has the aperture size 1/(2 N) and the distance in m.
    [[0.0, 0.0], [0.0, 0.0001], [1.0 / 11.2, 2.0], [1.0 / 32.0, 0.0]]
}

fn samples(reach: f64, count: usize, [aperture, distance]: [f32; 2]) -> Vec<Sample> {
    let width = (2.0 * reach * 0.832).min(36.0) as f32;
    let height = width / 1.5;
    points::<4>(count).map(|[x, y, u, v]| [x, y, u, v, aperture, distance, width, height, 0.5]).collect()
}

#[test]
fn the_stop_of_an_f_number_is_the_librarys() {
    let host = Host::new(Raster { xres: 1, yres: 1 }, None);
    for name in ["planar.50mm", "dgauss.50mm", "fisheye.16mm"] {
        let shader = Shader::new(name, &[]);
        let stop = |fnumber: Option<f64>| {
            let parameters =
                Parameters { lens_file: Some(name.to_owned()), fnumber, ..Parameters::default() };
            let lens = open_lens(&parameters, &host, &mut |_, _| ()).expect("a lens").1;
            lens.surfaces[lens.stop_index().expect("a stop")].semi_diameter
        };
        for number in [3.0, 4.0, 5.6, 11.0, 22.0] {
            let center = [0.5, 0.5, 0.5, 0.5, (0.5 / number) as f32, 0.0, 36.0, 24.0, 0.5];
            let own = shader.answers(&[center])[0].stop;
            let expected = stop(Some(number)) / stop(None);
            assert!((own / expected - 1.0).abs() < 3e-4, "{name} f/{number}: {own} {expected}");
        }
    }
}

#[test]
fn a_shaders_zoom_is_right_at_any_focal_length() {
    let name = "zoom.24-70mm";
    let mut shader = Shader::new(name, &[]);
    let prescription = catalogue::find(name).expect("listed");
    let groups = MovingGroups::of(&prescription).expect("positions");
    let facts = facts(&made(name, &[]).0);
    assert!((facts["focal_lengths_mm"][0].as_f64().unwrap() - groups.focal_range()[0]).abs() < 1e-9);
    // The ends of the range, a position of the file, and focal lengths that are not in the table.
    for focal_length in [24.701, 28.0, 31.7, 34.93, 43.2, 50.0, 61.0, 67.87] {
        shader.zoom = Some(focal_length);
        let travel = groups.zoomed(focal_length, |_, _| None).expect("in range");
        let lens = Lens::at_d_line(&travel.at(travel.start()));
        for camera in cameras() {
            let answers = shader.answers(&samples(shader.reach, 10_000, camera));
            let found = Comparison::of(&lens, &answers);
            let [median, most] = Comparison::median_and_most(&found.directions);
            let acceptance = found.passed as f64 / found.traced as f64;
            let figures = format!(
                "{focal_length} at {camera:?}: {median:e} {most:e} rad, {} fates, {acceptance}",
                found.fates_differ
            );
            println!("{figures}");
            // Groups are within a few micrometres of the lens's exact positions.
            assert!(found.traced > 9000 && found.fates_differ <= 10, "{figures}");
            assert!(most < 1e-3 && median < 5e-5 && acceptance > 0.95, "{figures}");
        }
        if [24.701, 43.2, 67.87].contains(&focal_length) {
            let cases = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.5), (1.0 / 11.2, 2.0, 0.6)];
            is_bright_and_in_focus(name, &lens, &shader, &cases);
        }
    }
}

#[test]
fn groups_focus_where_the_file_has_them() {
    for (name, zooms) in [("macro.105mm", &[None][..]), ("zoom.70-200mm", &[None, Some(150.0)])] {
        let mut shader = Shader::new(name, &[]);
        for zoom in zooms {
            shader.zoom = *zoom;
            // Distances are in metres; 0 stands for infinity.
            for distance in [0.0, 5.0, 2.0, 1.2420, 0.2550001_f32] {
                if distance > 0.0 && distance < 1.0 && name != "macro.105mm" {
                    continue;
                }
                let lens = focused(name, *zoom, distance);
                for aperture in [0.0, 1.0 / 16.0] {
                    let answers = shader.answers(&samples(shader.reach, 10_000, [aperture, distance]));
                    let found = Comparison::of(&lens, &answers);
                    let [median, most] = Comparison::median_and_most(&found.directions);
                    let acceptance = found.passed as f64 / found.traced as f64;
                    let point = points::<2>(2000)
                        .map(|[u, v]| [0.5, 0.5, u, v, aperture, distance, 36.0, 24.0, 0.5])
                        .collect::<Vec<Sample>>();
                    let back = film_distance(&shader.answers(&point));
                    let film = lens.nominal_film_distance.expect("stated");
                    let figures = format!(
                        "{name} {zoom:?} at {distance} m: {median:e} {most:e} rad, {} fates, {acceptance}, film {back} {film}",
                        found.fates_differ
                    );
                    println!("{figures}");
                    assert!(found.traced > 9000 && found.fates_differ <= 2, "{figures}");
                    assert!(most < 1e-5 && median < 4e-6 && acceptance > 0.94, "{figures}");
                    // The film stays at its position in the file, except for the shift to the sharpest focus.
                    assert!((back - film).abs() < 0.01 * film, "{figures}");
                }
            }
        }
    }
}

#[test]
fn every_lens_of_the_catalogue_is_traced_as_in_double_precision() {
    let of_a_lens = |name: &&str| {
        let shader = Shader::new(name, &[]);
        let lens = if shader.focuses_by_groups { focused(name, None, 0.0) } else { lens_of(name) };
        cameras().map(|camera| {
            // Groups are at their positions for infinity; the test above covers nearer distances.
            let camera = if shader.focuses_by_groups { [camera[0], 0.0] } else { camera };
            let answers = shader.answers(&samples(shader.reach, 20_000, camera));
            let found = Comparison::of(&lens, &answers);
            let [median, most] = Comparison::median_and_most(&found.directions);
            let [_, offset] = Comparison::median_and_most(&found.offsets);
            let acceptance = found.passed as f64 / found.traced as f64;
            let figures =
                format!("{name} at {camera:?}: {median:e} {most:e} rad, {offset:e} mm, {acceptance}");
            assert!(found.traced > 19_000, "{figures}: {} asked", found.traced);
            assert!(found.fates_differ <= 4, "{figures}: {} fates differ", found.fates_differ);
            assert!(most < 1.2e-5 && median < 2e-6 && offset < 1e-3, "{figures}");
            assert!(acceptance > 0.96, "{figures}");
            acceptance
        })
    };
    let names: Vec<&str> = catalogue::round().collect();
    let acceptance: Vec<[f64; 4]> = names.par_iter().map(of_a_lens).collect();
    let mean = acceptance.as_flattened().iter().sum::<f64>() / (4 * names.len()) as f64;
    assert!(mean > 0.985, "mean acceptance {mean}");
}

/// Returns the slopes of the ray on the film side of the lens.
fn slopes(answer: &Answer) -> [f64; 2] {
    let [vx, vy, vz] = answer.heading;
    [vx / vz, vy / vz]
}

/// Returns the distance behind the last vertex, mm, at which the rays of one film point meet, which is where they
/// start.
fn film_distance(answers: &[Answer]) -> f64 {
    let traced: Vec<&Answer> = answers.iter().filter(|answer| answer.is_traced).collect();
    let (mut along, mut squares) = (0.0, 0.0);
    for pair in traced.windows(2) {
        let ([ax, ay], [bx, by]) = (slopes(pair[0]), slopes(pair[1]));
        along += (pair[0].start[0] - pair[1].start[0]) * (ax - bx)
            + (pair[0].start[1] - pair[1].start[1]) * (ay - by);
        squares += (ax - bx).powi(2) + (ay - by).powi(2);
    }
    along / squares
}

/// Returns a disk twice as wide as the slopes that the shader samples, with the same middle. Wherever the pupil of a
/// film point lies (in a phone's lens, it lies far from its first-order position), the disk also contains any part
/// that the shader omits.
fn twice_around(answers: &[Answer]) -> SlopeDisk {
    let all = || answers.iter().filter(|answer| answer.is_traced).map(slopes);
    let middle = |axis: usize| {
        let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), slopes| {
            (low.min(slopes[axis]), high.max(slopes[axis]))
        });
        f64::midpoint(low, high)
    };
    let center = [middle(0), middle(1)];
    let farthest = all().map(|[x, y]| (x - center[0]).hypot(y - center[1])).fold(0.0, f64::max);
    SlopeDisk { center, radius: 2.0 * farthest }
}

#[test]
fn film_is_as_bright_as_all_rays_make_it_and_in_focus() {
    for name in ["dgauss.50mm", "wide.22mm", "fisheye.10mm", "sonnar.50mm", "phone.4mm"] {
        let shader = Shader::new(name, &[]);
        // Each case has the aperture size, the distance in m, and the field as a share of the reach.
        let cases = [
            (0.0, 0.0, 0.0),
            (0.0, 2.0, 0.5),
            (0.0, 0.0, 0.8),
            (1.0 / 11.2, 2.0, 0.6),
            (1.0 / 32.0, 0.0, 0.75),
        ];
        is_bright_and_in_focus(name, &lens_of(name), &shader, &cases);
    }
}

/// Checks that the film of a shader is as bright as all rays of its lens make it, and that the film is in focus for
/// these rays. Each case has an aperture size, a distance in m, and the film point as a share of the reach.
fn is_bright_and_in_focus(name: &str, own: &Lens, shader: &Shader, cases: &[(f32, f32, f64)]) {
    is_bright(name, own, shader, [1.0, 0.0], cases);
}

/// Checks the same for film points in a direction from the axis.
fn is_bright(name: &str, own: &Lens, shader: &Shader, direction: [f64; 2], cases: &[(f32, f32, f64)]) {
    for &(aperture, distance, share) in cases {
        let mut lens = own.clone();
        let radius = share * shader.reach.min(21.0);
        let point = direction.map(|part| part * radius);
        let [x, y] = point.map(|part| 0.5 - (part / 50.0) as f32);
        let at: Vec<Sample> =
            points::<2>(40_000).map(|[u, v]| [x, y, u, v, aperture, distance, 50.0, 50.0, 0.5]).collect();
        let answers = shader.answers(&at);
        let mean =
            answers.iter().map(|answer| f64::from(answer.throughput[0])).sum::<f64>() / answers.len() as f64;
        let stop = stop_or_limiting(&lens);
        lens.surfaces[stop].semi_diameter *=
            answers.iter().find(|answer| answer.is_traced).expect("bright").stop;
        let back = film_distance(&answers);
        let expected = match distance {
            0.0 => Focus::new(&lens).and_then(|focus| focus.film_distance(f64::INFINITY)),
            // The library measures the distance from the film.
            _ => Focus::new(&lens).and_then(|focus| {
                focus.film_distance(1000.0 * f64::from(distance) - lens.rear().vertex + back)
            }),
        };
        let expected = expected.expect("in reach");
        let off = (back - expected).abs() / FirstOrder::of(&lens).expect("focal").focal_length;
        assert!(off < 3e-4, "{name}: film at {back}, not {expected}");

        let path: Path = Path::film_to_scene(&lens);
        let film = lens.rear().vertex - back;
        let irradiance = |point: [f64; 2], cover: SlopeDisk| {
            irradiance::survey(&path, film, point, cover, cover, 300).irradiance
        };
        // The disk of the rear element would be too wide for a grid of rays.
        let exit = PupilDisk::exit(&lens, film).seen_from([0.0, 0.0]);
        let center = SlopeDisk { radius: 2.5 * exit.radius, ..exit };
        let expected = irradiance(point, twice_around(&answers)) / irradiance([0.0; 2], center);
        assert!(
            (mean / expected - 1.0).abs() < 0.01,
            "{name} at {point:?} mm, f {aperture}: {mean} {expected}"
        );
    }
}

#[test]
fn a_shader_traces_each_wavelength_and_all_sum_to_white() {
    for name in ["dgauss.50mm", "anamorphic.42mm"] {
        let shader = Shader::new(name, &["--dispersion"]);
        for number in [0.1, 0.5, 0.9_f32] {
            let nm = 420.0 + 260.0 * f64::from(number);
            let lens = Lens::new(&catalogue::find(name).expect("listed"), nm);
            let mut at = samples(shader.reach, 4000, [0.0, 3.0]);
            at.iter_mut().for_each(|sample| sample[8] = number);
            let found = Comparison::of(&lens, &shader.answers(&at));
            let [_, most] = Comparison::median_and_most(&found.directions);
            assert!(
                most < 3e-5 && found.fates_differ <= 4,
                "{name} {nm} nm: {most}, {} differ",
                found.fates_differ
            );
        }
        let mut sums = [0.0; 3];
        let at: Vec<Sample> =
            points::<3>(20_000).map(|[w, u, v]| [0.5, 0.5, u, v, 0.1, 0.0, 36.0, 24.0, w]).collect();
        for answer in shader.answers(&at) {
            (0..3).for_each(|i| sums[i] += f64::from(answer.throughput[i]) / at.len() as f64);
        }
        assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 0.01), "{name} {sums:?}");
    }
}

#[test]
fn what_cannot_be_a_camera_is_refused_with_why() {
    let afocal = "50 5 1.5 20\n-50 100 1 20\n0 0 0 10\n50 5 1.5 20\n-50 0 1 20\n";
    let stderr = fails(&["blender", "-", "--out", "-"], afocal, 1);
    assert!(stderr.contains("afocal") || stderr.contains("focal length"), "{stderr}");
    let many: String = (0..66).map(|_| "1000 1 1.5 10\n-1000 1 1 10\n").collect();
    assert!(fails(&["blender", "-", "--out", "-"], &many, 1).contains("at most 64"));
    assert!(
        // `Cargo.toml` is a file, so it cannot serve as a folder.
        fails(&["blender", "dgauss.50mm", "--out", "Cargo.toml/a.osl"], "", 1).contains("Cargo.toml/a.osl")
    );
}

/// Returns two numbers at a wavelength number. The first is the largest relative difference between two
/// transmissions: that of a shader with `transmission`, relative to a shader without it, and that of the library's
/// walk with polarisation. The second is the least transmission.
fn worst_loss(name: &str, lens: &Lens, arguments: &[&str], surfaces: &Surfaces, number: f32) -> [f64; 2] {
    let is_dispersive = arguments.contains(&"--dispersion");
    let [plain, lit] = [if is_dispersive { &["--dispersion"][..] } else { &[] }, arguments]
        .map(|arguments| Shader::new(name, arguments));
    let lost = LitPath::new(Path::film_to_scene(lens), surfaces);
    let mut most = [0.0_f64, 1.0];
    for distance in [0.0, 3.0] {
        let mut at = samples(plain.reach, 4000, [0.0, distance]);
        at.iter_mut().for_each(|sample| sample[8] = number);
        let mut compared = 0;
        for (plain, lit) in plain.answers(&at).iter().zip(lit.answers(&at)) {
            let channel =
                (0..3).max_by(|a, b| plain.throughput[*a].total_cmp(&plain.throughput[*b])).unwrap();
            let [of_plain, of_lit] = [plain.throughput[channel], lit.throughput[channel]].map(f64::from);
            assert_eq!((plain.position, plain.direction), (lit.position, lit.direction));
            assert_eq!(of_plain > 0.0, of_lit > 0.0);
            if of_plain == 0.0 {
                continue;
            }
            let ([x, y], direction) = (plain.start, plain.heading);
            let back = 2.0 * lens.rear().semi_diameter / direction[2];
            let [dx, dy, dz] = direction.map(|d| d * back);
            let origin = [x - dx, y - dy, lens.rear().vertex - dz];
            if let Ok((_, left)) = lost.trace(Ray { origin, direction }) {
                most = [most[0].max((of_lit / of_plain / left - 1.0).abs()), most[1].min(left)];
                compared += 1;
            }
        }
        assert!(compared > 3300, "{name}: {compared}");
    }
    most
}

#[test]
fn transmission_of_surfaces_is_the_librarys() {
    for (name, coating, transmission) in [
        ("dgauss.50mm", Coating::Bare, "bare"),
        ("dgauss.50mm", Coating::ThreeLayer, "three-layer"),
        ("fisheye.10mm", Coating::QuarterWave, "quarter-wave"),
        ("phone.4mm", Coating::VCoat, "v-coat"),
    ] {
        let lens = lens_of(name);
        let surfaces = Surfaces::new(&lens, coating);
        let [most, least] = worst_loss(name, &lens, &["--transmission", transmission], &surfaces, 0.5);
        println!("{name} {transmission}: {most:e}, {least}");
        assert!(most < 5e-6 && least < 0.98, "{name} {transmission}: {most:e}, {least}");
    }
    let name = "dgauss.50mm";
    let of_wavelengths = ["--transmission", "quarter-wave", "--dispersion"];
    for number in [0.02, 0.5, 0.97_f32] {
        let nm = 420.0 + 260.0 * f64::from(number);
        let lens = Lens::new(&catalogue::find(name).expect("listed"), nm);
        let surfaces = Surfaces::new(&lens, Coating::QuarterWave);
        let [most, least] = worst_loss(name, &lens, &of_wavelengths, &surfaces, number);
        println!("{name} at {nm} nm: {most:e}, {least}");
        assert!(most < 5e-6 && least < 0.98, "{nm} nm: {most:e}, {least}");
    }
}

#[test]
fn absorption_of_glasses_is_the_librarys() {
    // The lens has an asphere, a cemented surface, a stop in the air behind that surface, and a plane in air.
    let text = "glass DARK polynomial A0=2.9 A2=-0.01 A-2=0.03\nglass CLEAR sellmeier B1=1.03961212 B2=0.231792344 \
        B3=1.01046945 C1=0.00600069867 C2=0.0200179144 C3=103.560653\n\
        absorption DARK 380 0.3 430 0.08 546.1 0.01 650 0.02 700 0\nabsorption CLEAR 500 0.004\n\
        asphere 1 conic=-0.4 A4=-1e-6\n30 6 CLEAR - 20\n-40 2.5 DARK - 20\n-400 3 - - 20\nstop 4 - - 14\n\
        inf 3 DARK - 16\n-70 40 - - 16\n";
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("own.dat");
    std::fs::write(&file, text).expect("written");
    let (name, prescription) =
        (file.to_str().expect("text"), read("own.dat", text.as_bytes()).expect("a lens"));
    for (number, arguments) in [
        (0.5, &["--transmission", "quarter-wave"][..]),
        (0.5, &["--transmission", "bare"]),
        (0.02, &["--transmission", "quarter-wave", "--dispersion"]),
        (0.484, &["--transmission", "quarter-wave", "--dispersion"]),
        (0.97, &["--transmission", "quarter-wave", "--dispersion"]),
    ] {
        let nm = match arguments {
            [.., "--dispersion"] => 420.0 + 260.0 * f64::from(number),
            _ => 587.56,
        };
        let lens = Lens::new(&prescription, nm);
        let coating = if arguments[1] == "bare" { Coating::Bare } else { Coating::QuarterWave };
        let [most, least] = worst_loss(name, &lens, arguments, &Surfaces::new(&lens, coating), number);
        println!("{nm} nm: {most:e}, {least}");
        assert!(most < 5e-6 && least < 0.97, "{nm} nm: {most:e}, {least}");
        // At the wavelengths where it is dark, the dark glass absorbs far more than the surfaces reflect.
        assert!(nm > 460.0 || least < 0.75, "{nm} nm: {least}");
    }
}

#[test]
fn coatings_of_a_lens_file_are_in_its_shader() {
    // A plano-convex lens with one film on the first surface and none on the second.
    let text = "coating 1 stack 1.38 99.6\n50 4 1.5168 20\n0 60 1 20\n0 0 0 8\n";
    let shader =
        |transmission: &str| succeeds(&["blender", "-", "--out", "-", "--transmission", transmission], text);
    let of_file = shader("file");
    assert!(of_file.contains("void stack0") && of_file.contains("void stack1"), "{of_file}");
    let bare = shader("bare");
    assert!(bare.contains("void stack0") && !bare.contains("void stack1"), "{bare}");
    assert!(facts(&bare)["loses_light"] == true);
    let plain = succeeds(&["blender", "-", "--out", "-"], text);
    assert!(!plain.contains("stokes") && facts(&plain)["loses_light"] == false);
    let stderr = fails(&["blender", "dgauss.50mm", "--out", "-", "--transmission", "file"], "", 2);
    assert!(stderr.contains("names no coatings"), "{stderr}");
}
