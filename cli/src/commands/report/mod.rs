//! `realistic report`: error against run time, as a folder of pages.

mod advice;
mod conclusions;
mod figures;
mod findings;
mod page;

use crate::console;
use crate::drawing::output;
use crate::failure::Failure;
use crate::files;
use crate::host::scene::chequers;
use indicatif::{ProgressBar, ProgressStyle};
use realistic_lab::accuracy::suite::{Results, Suite};
use realistic_lab::stability::{self, CaseResult};
use realistic_lab::timing::machine;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{ErrorKind, IsTerminal as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The options of `report`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Folder to write; created if missing
    #[arg(short, long, value_name = "DIR", default_value = "realistic-report")]
    out: PathBuf,
    /// Fewer rays, samples and rounds: about a minute instead of several
    #[arg(long)]
    quick: bool,
    /// Repeat one stability case by its name, with every ray that fails, and write no report
    #[arg(long, value_name = "NAME", conflicts_with_all = ["out", "quick"])]
    case: Option<String>,
}

/// Measures, writes the folder and reports its path.
///
/// # Errors
/// A folder or a file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    if let Some(name) = &args.case {
        return Ok(console::answer(&case(name)?, None)?);
    }
    make_folder(&args.out)?;
    let suite = if args.quick { Suite::quick(chequers::radiance) } else { Suite::full(chequers::radiance) };
    let progress = if console::is_quiet() { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
    progress.set_style(ProgressStyle::with_template("{elapsed} {msg}").expect("a valid template"));
    let start = Instant::now();
    let mut log = Log { terminal: std::io::stderr().is_terminal(), last: None };
    let measured = suite.run(&mut |what| {
        progress.set_message(what.to_owned());
        progress.tick();
        log.print(start.elapsed(), what);
    });
    let results = measured.map_err(|error| Failure::Other(error.to_string()))?;
    progress.finish_and_clear();
    write(&results, &suite, start.elapsed(), &args.out)?;
    let page = args.out.join(PAGE);
    Ok(console::report(&format!("{}\n", page.display()), &page)?)
}

/// Repeats a stability case: lists the result of every tracer, and each ray that fails.
fn case(name: &str) -> Result<String, Failure> {
    let results = stability::rerun(name);
    if results.is_empty() {
        let example = random_case(0);
        return Err(Failure::Other(format!(
            "there is no stability case \"{name}\"; the names stand in a report's stability.csv, or are such as \"{example}\""
        )));
    }
    let mut text =
        format!("{name}\n{:<22}{:>7}{:>11}{:>12}  fails because\n", "", "rays", "undecided", "error*");
    for result in &results {
        let because = if result.holds() { "does not fail".to_owned() } else { result.fails_because() };
        let CaseResult { tracer, rays, undecided, ratio, .. } = result;
        let _ = writeln!(text, "{tracer:<22}{rays:>7}{undecided:>11}{ratio:>12.3}  {because}");
    }
    text += "* over what rounding alone must be expected to do\n";
    for (result, failure) in
        results.iter().flat_map(|result| result.failures.iter().map(move |f| (result, f)))
    {
        let _ = writeln!(text, "{}, ray {}: {}", result.tracer, failure.ray, failure.what);
    }
    Ok(text)
}

fn random_case(number: u64) -> String {
    stability::random::Kind::Aspheres.case(number).name
}

/// Name of the page's file.
const PAGE: &str = "index.html";

/// Progress; without a terminal, a line at most every two seconds.
struct Log {
    terminal: bool,
    last: Option<Duration>,
}

impl Log {
    fn print(&mut self, now: Duration, what: &str) {
        let due = self.last.is_none_or(|last| now - last >= Duration::from_secs(2));
        if due && !self.terminal && !console::is_quiet() {
            eprintln!("{:6.1} s  {what}", now.as_secs_f64());
            self.last = Some(now);
        }
    }
}

/// Makes the folder and checks that the page can be written there, so that an error is reported before the
/// measurements, which take minutes.
fn make_folder(folder: &Path) -> Result<(), Failure> {
    files::make_folder(folder)?;
    let page = folder.join(PAGE);
    match File::create_new(&page) {
        Ok(_) => std::fs::remove_file(&page),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            File::options().append(true).open(&page).map(drop)
        }
        Err(error) => Err(error),
    }
    .map_err(|error| Failure::cannot_write(&page, &error))
}

/// Writes the tables, the plots and the page.
fn write(results: &Results, suite: &Suite, took: Duration, folder: &Path) -> Result<(), Failure> {
    let save = |name: &str, text: &str| {
        let path = folder.join(name);
        files::save(&path, text.as_bytes()).map_err(|error| Failure::cannot_write(&path, &error))
    };
    for table in results.tables() {
        save(&format!("{}.csv", table.name), &table.to_csv())?;
    }
    let overview = figures::overview(results);
    let sections = figures::all(results);
    for figure in overview.iter().chain(sections.iter().flat_map(|section| &section.figures)) {
        output::write(&figure.chart.draw(), &folder.join(format!("{}.svg", figure.file)))?;
    }
    save(PAGE, &page::page(results, suite, &overview, &sections, &machine::facts(), took))
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_camera::Raster;
    use realistic_lab::accuracy::{
        irradiance::SampleCounts, pupils::PupilCounts, ray_map::RayCounts, set_up::FitCounts,
    };
    use realistic_lab::{accuracy::pictures, timing::Effort};

    /// Returns the smallest suite that provides data for every figure.
    fn tiny() -> Suite {
        let effort = Effort { rounds: 1, least: Duration::from_micros(20) };
        let raster = Raster { xres: 6, yres: 4 };
        Suite {
            lenses: vec!["dgauss.50mm"],
            ray_map: RayCounts { rays: 60, block: 32, effort },
            irradiance: SampleCounts { exponent: 2, repeats: 2, survey: 60, effort },
            picture: pictures::Size {
                scene: chequers::radiance,
                raster,
                exponent: 2,
                reference: 16,
                repeats: 1,
            },
            set_up: FitCounts { rays: 40, repeats: 1 },
            pupils: PupilCounts { points: 2, repeats: 1 },
            stability: stability::Extent { lenses: 1, cameras: 1 },
        }
    }

    #[test]
    fn a_folder_without_write_access_is_refused_before_measuring() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("report");
        make_folder(&folder).unwrap();
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
        std::fs::write(folder.join(PAGE), "an old page").unwrap();
        make_folder(&folder).unwrap();
        assert_eq!(std::fs::read_to_string(folder.join(PAGE)).unwrap(), "an old page");
        std::fs::remove_file(folder.join(PAGE)).unwrap();
        std::fs::create_dir(folder.join(PAGE)).unwrap();
        let Err(Failure::Other(error)) = make_folder(&folder) else { panic!("a folder is no page") };
        assert!(error.contains("index.html") && error.contains("another path"), "{error}");
    }

    #[test]
    fn every_file_of_the_page_exists_and_every_table_parses() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("deep/report");
        make_folder(&folder).unwrap();
        let suite = tiny();
        let results = suite.run(&mut |_| {}).unwrap();
        write(&results, &suite, Duration::from_secs(1), &folder).unwrap();
        let page = std::fs::read_to_string(folder.join("index.html")).unwrap();
        let named: Vec<&str> = ["src=\"", "href=\""]
            .iter()
            .flat_map(|key| page.split(key).skip(1))
            .map(|rest| &rest[..rest.find('"').unwrap()])
            .filter(|name| !name.starts_with('#'))
            .collect();
        // A result in words and a picture come before the first table.
        let at = |mark: &str| page.find(mark).unwrap_or_else(|| panic!("no {mark}"));
        assert!(at("class=\"result\"") < at("<img") && at("<img") < at("<table"));
        assert!(page.contains("prefers-color-scheme: dark"));
        // Every answer in the table of needs was chosen by a camera with that tolerance, and one row states the cost.
        assert!(page.contains("chose wide open, and what it cost"));
        for saving in &results.leaving_out {
            assert!(page.contains(&findings::tracing(saving.tracing)), "{saving:?}");
        }
        for ending in ["svg", "csv"] {
            assert!(named.iter().any(|name| name.ends_with(ending)), "no {ending}");
        }
        for name in named {
            assert!(folder.join(name).metadata().is_ok_and(|file| file.len() > 100), "{name}");
        }
        for table in results.tables() {
            let text = std::fs::read_to_string(folder.join(format!("{}.csv", table.name))).unwrap();
            let lines: Vec<Vec<&str>> = text.lines().map(|line| split(line)).collect();
            assert_eq!(lines.len(), table.rows.len() + 1);
            // Only the table of failures should be empty.
            assert!(lines.len() > 4 || table.name == "stability-failures", "{}", table.name);
            for line in &lines {
                assert_eq!(line.len(), table.columns.len(), "{line:?}");
            }
            for (column, heading) in table.columns.iter().enumerate() {
                let numeric =
                    heading.ends_with("_ns") || heading.ends_with("_rad") || heading.ends_with("_error");
                if numeric {
                    assert!(lines[1..].iter().all(|line| line[column].parse::<f64>().is_ok()), "{heading}");
                }
            }
        }
    }

    /// Splits a line of CSV into fields, with quotes kept.
    fn split(line: &str) -> Vec<&str> {
        let mut quoted = false;
        line.split(|c| {
            quoted ^= c == '"';
            c == ',' && !quoted
        })
        .collect()
    }

    #[test]
    fn a_case_is_repeated_by_its_name_and_an_unknown_one_is_refused() {
        let text = case("random aspheric lens 7").unwrap();
        assert!(text.contains("walk f64") && text.contains("does not fail"), "{text}");
        let Err(Failure::Other(error)) = case("no such case") else { panic!("no such case is known") };
        assert!(error.contains("random aspheric lens 0"), "{error}");
    }

    #[test]
    fn the_page_needs_nothing_from_elsewhere() {
        let suite = Suite { lenses: vec![], ..tiny() };
        let page = page::page(&Results::default(), &suite, &[], &[], &machine::facts(), Duration::ZERO);
        assert!(!page.contains("<script") && !page.contains("http"));
        assert!(page.contains("rustc "));
    }
}
