//! Benchmarks camera builds against their time limits, for every lens of the catalogue and for long lenses of up to the
//! maximum number of interfaces in a file, from random valid ones to relays designed to be slow. It also builds the
//! cameras of an animation, each from scratch and each from the previous one.
//!
//! `cargo bench --bench startup` (`-- dgauss`: one lens of the catalogue; `-- --catalogue`, `-- --long` or
//! `-- --animation`: one part; `-- --test`: a minimal run). Times are CPU times of the thread. `REALISTIC_SIMD=avx2`
//! measures narrower registers.

mod animation;
mod long_lenses;

use long_lenses::{Kind, LongLens};
use realistic_camera::{Camera, Host, Parameters, Raster};
use realistic_lab::{
    results::statistics::{median, quantile},
    timing::{BenchArguments, repeated},
};
use realistic_optics::prescription::catalogue;
use realistic_simd::Simd;

const RASTER: Raster = Raster { xres: 1000, yres: 1000 };
/// A tolerance, pixels, and the time limit of a catalogue lens with that tolerance, ms.
const TOLERANCE: &str = "0.1";
const MOST_WITH_TOLERANCE: f64 = 8.0;
/// Numbers of interfaces of long lenses, each with the number of lenses of each kind.
const LONG: [(usize, u64); 4] = [(10, 60), (30, 60), (100, 60), (1000, 8)];

fn main() {
    let arguments = BenchArguments::from_command_line(15);
    let named = |name: &str| std::env::args().any(|argument| argument == name);
    println!("instructions: {}", Simd::best().name());
    let parts = ["--catalogue", "--long", "--animation"];
    let wants = |part: &str| named(part) || !parts.iter().any(|part| named(part));
    if wants("--catalogue") {
        catalogue_lenses(&arguments);
    }
    if wants("--animation") {
        animation::print(&arguments);
    }
    if wants("--long") {
        let part = if arguments.effort.rounds == 1 { 20 } else { 1 };
        for (interfaces, count) in LONG {
            long(interfaces, count.div_ceil(part));
        }
    }
}

/// A camera's parameters, and the lens file's text if the lens is not in the catalogue.
struct Given<'a> {
    parameters: &'a [(&'a str, &'a str)],
    text: Option<&'a str>,
}

impl Given<'_> {
    fn build(&self) -> Option<Camera> {
        let mut parameters = Parameters::default();
        for (name, text) in self.parameters {
            parameters.set_from_text(name, text).expect("a parameter");
        }
        let mut host = Host::new(RASTER, None);
        host.lens_text = self.text.map(|text| ("long".to_owned(), text.as_bytes().to_vec()));
        Camera::build(&parameters, &host, &mut |_, _| ()).ok()
    }
}

/// Returns the time limit, ms, of a camera with this number of interfaces.
fn limit(interfaces: usize) -> f64 {
    2.0_f64.max(interfaces as f64 / 10.0)
}

fn catalogue_lenses(arguments: &BenchArguments) {
    println!("\n## The catalogue, from a lens's name to the camera\n");
    println!(
        "| lens | interfaces | ms: median | least | may take | of that | tolerance {TOLERANCE}, ms: median | least | of {MOST_WITH_TOLERANCE} |\n\
         |---|---|---|---|---|---|---|---|---|"
    );
    let mut over = 0;
    for name in catalogue::round().filter(|name| arguments.wants(name)) {
        let interfaces = catalogue::find(name).expect("listed").interfaces.len();
        let lens = [("lens_file", name), ("tolerance", TOLERANCE)];
        let [default, tolerant] = [&lens[..1], &lens[..]].map(|parameters| {
            let given = Given { parameters, text: None };
            let (_, seconds) = repeated(arguments.effort.rounds, || given.build().expect("a camera"));
            [median(&seconds) * 1e3, quantile(&seconds, 0.0) * 1e3]
        });
        let most = limit(interfaces);
        let shares = [default[0] / most, tolerant[0] / MOST_WITH_TOLERANCE];
        over += shares.iter().filter(|&&share| share > 1.0).count();
        println!(
            "| {name} | {interfaces} | {:.2} | {:.2} | {most:.1} | {:.2} | {:.2} | {:.2} | {:.2} |",
            default[0], default[1], shares[0], tolerant[0], tolerant[1], shares[1]
        );
    }
    println!("\nover what they may take: {over}");
}

/// Builds long lenses of each kind; the slowest of each is timed again.
fn long(interfaces: usize, count: u64) {
    let most = (interfaces as f64).clamp(100.0, 1000.0);
    println!("\n## {interfaces} interfaces: at most {most} ms\n");
    println!(
        "| lenses | cameras | mean ms | slowest ms | number |\n\
         |---|---|---|---|---|---|---|"
    );
    for kind in Kind::ALL {
        let (mut cameras, mut sum, mut slowest) = (0, 0.0, (0.0, 0));
        for number in 0..count {
            let LongLens { text, parameters } = LongLens::new(kind, interfaces, number);
            let given: Vec<(&str, &str)> =
                parameters.iter().map(|(name, value)| (*name, value.as_str())).collect();
            let given = Given { parameters: &given, text: Some(&text) };
            let (camera, seconds) = repeated(1, || given.build());
            if camera.is_some() {
                let least = || {
                    let (_, again) = repeated(2, || given.build());
                    again.into_iter().fold(seconds[0], f64::min)
                };
                let seconds = if seconds[0] > slowest.0 { least() } else { seconds[0] };
                (cameras, sum) = (cameras + 1, sum + seconds);
                slowest = if seconds > slowest.0 { (seconds, number) } else { slowest };
            }
        }
        println!(
            "| {} | {cameras} of {count} | {:.2} | {:.2} | {} |",
            kind.name(),
            sum / f64::from(cameras) * 1e3,
            slowest.0 * 1e3,
            slowest.1
        );
    }
}
