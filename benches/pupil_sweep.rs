//! Where the warped pupil accepts too little, or misses light: `cargo bench --bench pupil_sweep [LENS FILE]...` over the
//! catalogue (or the files given), three film sizes, two resolutions, three stops and seven focus distances, and over
//! random cameras. Every field point whose samples are blocked too often is looked at by brute force. `--test` for as
//! little as shows that it runs, `--missed` for the light missed, too, which takes ten times as long.

#[path = "../tests/truth/pupil_fit/mod.rs"]
mod pupil_fit;

use pupil_fit::{
    Case, lenses, stopped,
    survey::{Pupil, Survey},
};
use realistic::unstable::{
    imaging::focus::Focus,
    lens::Lens,
    prescription::{catalogue, read},
    sampling::{GivenUp, MapFailure},
};
use realistic_lab::timing::repeated;

/// Field points of a camera, from the axis to the corner.
const FIELDS: u32 = 41;
/// Random cameras.
const RANDOM: u64 = 400;
/// Share that is to pass.
const ENOUGH: f64 = 0.99;

/// What was found on some cameras.
#[derive(Default)]
struct Found {
    cameras: u32,
    points: u32,
    /// Points that accept less than [`ENOUGH`], and those among them that no warning names.
    low: u32,
    silent: u32,
    worst: f64,
    missed: f64,
    /// Field points that miss more than 1e-4.
    missing: u32,
    /// Field points that warnings name.
    named: u32,
    /// Longest build, seconds, and over what a start-up may take.
    build: f64,
    over_limit: f64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_given = |name: &str| arguments.iter().any(|argument| argument == name);
    let (test, missed) = (is_given("--test"), is_given("--missed"));
    let files: Vec<&String> = arguments.iter().filter(|argument| !argument.starts_with('-')).collect();
    println!(
        "| lens | interfaces | cameras | field points | below 99 % | of these unnamed | worst | named | missed worst | \
         over 1e-4 | build ms | of the limit |\n|---|---|---|---|---|---|---|---|---|---|---|---|"
    );
    let mut all = Found::new();
    let lenses: Vec<Lens> = if files.is_empty() {
        catalogue::names().map(|name| Lens::at_d_line(&catalogue::find(name).expect("listed"))).collect()
    } else {
        files.iter().map(|file| opened(file)).collect()
    };
    for lens in &lenses {
        let mut found = Found::new();
        sweep(lens, test, missed, &mut found);
        println!("| {} | {} | {}", lens.name, lens.surfaces.len(), found.row());
        all.add(&found);
    }
    if files.is_empty() {
        let mut found = Found::new();
        for number in 0..if test { 3 } else { RANDOM } {
            let random = lenses::camera(number);
            if let Some(case) = Case::try_reach(&random.lens, random.distance, random.corner) {
                let name = format!("camera {number}");
                found.look_at(&name, &random.lens, &case, 0.995 * random.corner, missed);
            }
        }
        println!("| random | 2 to 14 | {}", found.row());
        all.add(&found);
    }
    println!("| all | | {}", all.row());
}

/// The lens of a file.
fn opened(file: &str) -> Lens {
    let text = std::fs::read(file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let name = std::path::Path::new(file).file_stem().map_or(file.into(), |name| name.to_string_lossy());
    Lens::at_d_line(&read(&name, &text).unwrap_or_else(|error| panic!("{file}: {error}")))
}

/// Looks at a lens at all stops, distances, films and resolutions.
fn sweep(lens: &Lens, test: bool, missed: bool, found: &mut Found) {
    for stop in [None, Some(8.0), Some(16.0)] {
        let lens = stopped(lens, stop);
        let Ok(focus) = Focus::new(&lens) else { continue };
        for object in [545.0, 560.0, 1000.0, 3000.0, 10_000.0, 68_700.0, f64::INFINITY] {
            let Ok(distance) = focus.film_distance(object) else { continue };
            for (diagonal, pixels) in [24.0, 35.0, 43.27].into_iter().flat_map(|d| [(d, 300.0), (d, 1920.0)])
            {
                if test && !(object == 1000.0 && diagonal == 35.0 && pixels == 300.0) {
                    continue;
                }
                // Pixels of a picture of 4:3, three of which the reconstruction filter may go beyond.
                let reach = diagonal / 2.0 + 3.0 * 2_f64.sqrt() * diagonal / (1.25 * pixels);
                if let Some(case) = Case::try_reach(&lens, distance, reach) {
                    let name = format!("{} {stop:?} {object} mm, film {diagonal} mm, {pixels}", lens.name);
                    found.look_at(&name, &lens, &case, diagonal / 2.0, missed);
                }
            }
        }
    }
}

impl Found {
    fn new() -> Self {
        Self { worst: 1.0, ..Self::default() }
    }

    /// Looks at the field points of a camera up to `corner`.
    fn look_at(&mut self, name: &str, lens: &Lens, case: &Case, corner: f64, missed: bool) {
        self.cameras += 1;
        let (_, times) = repeated(3, || case.again());
        let build = times.into_iter().fold(f64::INFINITY, f64::min);
        let limit = 2e-3_f64.max(1e-4 * lens.surfaces.len() as f64);
        self.build = self.build.max(build);
        self.over_limit = self.over_limit.max(build / limit);
        for k in 0..FIELDS {
            let height = corner * f64::from(k) / f64::from(FIELDS - 1);
            let is_named = |GivenUp { radii, .. }: &GivenUp| (radii[0]..=radii[1]).contains(&height);
            let named = case.pupil.given_up().iter().find(|given_up| is_named(given_up));
            let mut acceptance = case.acceptance([height, 0.0], 20);
            if acceptance.is_some_and(|acceptance| acceptance < 0.996) {
                acceptance = case.acceptance([height, 0.0], 120);
            }
            let survey = || Survey::of(case, height);
            if acceptance.is_none_or(|acceptance| acceptance == 0.0) && survey().pupil() == Pupil::Dark {
                continue;
            }
            self.points += 1;
            self.named += u32::from(named.is_some());
            let acceptance = acceptance.unwrap_or(0.0);
            self.worst = self.worst.min(acceptance);
            if acceptance < ENOUGH {
                self.low += 1;
                self.silent += u32::from(named.is_none());
                let (pupil, end) = (survey().pupil(), case.pupil.image_radius());
                if named.is_none() || pupil == Pupil::Fan {
                    eprintln!("{name}: {height:.3} mm of {end:?}: {acceptance:.4}, {pupil:?}, {named:?}");
                }
            }
            let whole = named.is_none_or(|given_up| given_up.reason == MapFailure::TooFast);
            if missed && whole && acceptance > 0.5 {
                let (_, share) = case.fit([height, 0.0], 120);
                self.missed = self.missed.max(share);
                self.missing += u32::from(share > 1e-4);
                let beside = survey().beside_the_map(case, height);
                if share.max(beside) > 1e-3 {
                    eprintln!("{name}: {height:.3} mm: misses {share:.1e}, beside the map {beside:.1e}");
                }
            }
        }
    }

    fn add(&mut self, other: &Self) {
        self.cameras += other.cameras;
        self.points += other.points;
        self.low += other.low;
        self.silent += other.silent;
        self.missing += other.missing;
        self.named += other.named;
        self.worst = self.worst.min(other.worst);
        self.missed = self.missed.max(other.missed);
        self.build = self.build.max(other.build);
        self.over_limit = self.over_limit.max(other.over_limit);
    }

    fn row(&self) -> String {
        let Self { cameras, points, low, silent, worst, missed, missing, named, build, over_limit } = self;
        format!(
            "{cameras} | {points} | {low} | {silent} | {worst:.4} | {named} | {missed:.1e} | {missing} | {:.2} | \
             {over_limit:.2} |",
            build * 1e3
        )
    }
}
