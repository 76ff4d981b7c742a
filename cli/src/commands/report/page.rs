//! The page: one HTML file, which needs no files except those beside it.

use super::advice::{advice, stability, what_to_use_when};
use super::conclusions::{answers, sentences};
use super::figures::{Figure, Section};
use super::findings::seconds;
use realistic_lab::accuracy::suite::{Results, Suite, Tie, failures_table};
use realistic_lab::results::table::{Cell, Table};
use std::fmt::Write as _;
use std::time::Duration;

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #222; --paper: #fff; --line: #ddd; --link: #0b57d0; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e6; --paper: #171717; --line: #444; --link: #8ab4f8; }
  figure img { filter: invert(0.91) hue-rotate(180deg); }
}
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); margin: 0 auto; padding: 0 16px 48px; max-width: 1480px; }
a { color: var(--link); }
h1 { font-size: 1.7rem; line-height: 1.2; } h2 { font-size: 1.25rem; margin-top: 2.4em; } h3 { font-size: 1rem; margin-bottom: 0.2em; }
h3 + ul { margin-top: 0; }
p, ul { max-width: 76ch; }
.result { font-size: 1.15rem; }
nav a { margin-right: 1.1em; display: inline-block; }
.warning { border-left: 4px solid #D55E00; padding-left: 12px; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 0.92rem; }
th, td { text-align: left; padding: 5px 12px 5px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
code { overflow-wrap: anywhere; }
details { margin-top: 14px; } summary { cursor: pointer; }
.needs td, .needs th { min-width: 11em; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 600px), 1fr)); gap: 24px; }
figure { margin: 0; } figure img { width: 100%; max-width: 780px; height: auto; display: block; }
figcaption { font-size: 0.85rem; } figcaption a { display: inline-block; padding: 4px 10px 4px 0; }
@media (max-width: 700px) {
  .needs, .needs tbody, .needs tr, .needs td { display: block; }
  .needs tr:first-child { display: none; }
  .needs tr { border-bottom: 1px solid var(--line); padding: 8px 0; }
  .needs td { border: 0; padding: 2px 0; }
  .needs td:first-child { font-weight: 600; }
  .needs td[data-lens]::before { content: attr(data-lens) \": \"; opacity: 0.75; }
}
";

/// Writes the whole page.
pub fn page(
    results: &Results,
    suite: &Suite,
    overview: &[Figure],
    sections: &[Section],
    facts: &[(&str, String)],
    took: Duration,
) -> String {
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>realistic: what a camera ray costs</title>\n\
         <style>{STYLE}</style>\n<h1>What a ray through a lens costs, and how far off the cheaper ways are</h1>\n"
    );
    if let Some(result) = what_to_use_when(results) {
        let _ = writeln!(html, "<p class=\"result\">{}</p>", escaped(&result));
    }
    if cfg!(debug_assertions) {
        html += "<p class=\"warning\">This program was built for debugging: its times are not those of a release.</p>\n";
    }
    if !overview.is_empty() {
        figures(&mut html, "What a camera's ray costs", "leaving-out", overview);
        html += "<p>Each mark is a camera wide open: \"f64\" and \"f32\" trace exactly, in double and in single precision, 1, \
            0.1 and 0.01 are cameras with that tolerance, in pixels; cameras that trace by the same are one mark. To the \
            left is faster, down is nearer to the exact ray.</p>\n";
    }
    html += "<p>Every error is against the exact ray, computed with 106 bits. All lenses are focused at infinity on film of \
        35 mm diagonal; pixels are those of 1920 x 1280 on it.</p>\n<nav>";
    let contents =
        [("conclusions", "Conclusions")].into_iter().chain(sections.iter().map(|s| (s.anchor, s.title)));
    for (anchor, title) in contents.chain([("method", "How it was measured")]) {
        let _ = write!(html, "<a href=\"#{anchor}\">{}</a> ", escaped(title));
    }
    html += "</nav>\n";
    conclusions(&mut html, results, suite);
    for section in sections {
        let _ = writeln!(html, "<h2 id=\"{}\">{}</h2>", section.anchor, escaped(section.title));
        if section.anchor == "stability" {
            failures(&mut html, results, suite);
        }
        let _ = writeln!(html, "<p>{}</p>", escaped(section.text));
        figures(&mut html, section.title, section.table, &section.figures);
        if let Some(summary) = &section.summary {
            let _ = writeln!(html, "<details><summary>The figures as a table</summary>");
            table(&mut html, summary);
            html += "</details>\n";
        }
    }
    method(&mut html, results, suite, facts, took);
    html
}

fn figures(html: &mut String, title: &str, table: &str, figures: &[Figure]) {
    *html += "<div class=\"figures\">\n";
    for Figure { file, chart } in figures {
        let _ = writeln!(
            html,
            "<figure><img src=\"{file}.svg\" alt=\"{}: {}\"><figcaption><a href=\"{file}.svg\">SVG</a> \
             <a href=\"{table}.csv\">CSV</a></figcaption></figure>",
            escaped(title),
            escaped(&chart.title),
        );
    }
    *html += "</div>\n";
}

fn table(html: &mut String, table: &Table) {
    *html += "<div class=\"wide\"><table>\n<tr>";
    for heading in &table.columns {
        let _ = write!(html, "<th>{}</th>", escaped(&heading.replace('_', " ")));
    }
    *html += "</tr>\n";
    for row in &table.rows {
        *html += "<tr>";
        for cell in row {
            let text = match cell {
                Cell::Text(text) => escaped(text),
                // Counts are exact, and measurements are shown with their significant digits.
                Cell::Number(number) if number.fract() == 0.0 && number.abs() < 1e9 => format!("{number}"),
                Cell::Number(number) if (0.01..1e4).contains(&number.abs()) => format!("{number:.2}"),
                Cell::Number(number) => format!("{number:.1e}"),
            };
            let _ = write!(html, "<td>{text}</td>");
        }
        *html += "</tr>\n";
    }
    *html += "</table></div>\n";
}

fn conclusions(html: &mut String, results: &Results, suite: &Suite) {
    *html += "<h2 id=\"conclusions\">Conclusions</h2>\n<ul>\n";
    for sentence in advice(results, suite) {
        let _ = writeln!(html, "<li>{}</li>", escaped(&sentence));
    }
    let ties = results.ties();
    let _ = writeln!(
        html,
        "</ul>\n<p>What differs by less than the same method did when it was measured twice in this run is a tie, here and \
         everywhere on this page: times per ray {}, times to an error of irradiance {}, times to an error of a picture {}. \
         The table names, of rays, what a camera with that tolerance chose to trace by, with its time on one core; of light, \
         what is first to the error, and what ties with it.</p>",
        in_words(ties.times),
        in_words(ties.irradiance),
        in_words(ties.pictures),
    );
    *html += "<div class=\"wide\"><table class=\"needs\">\n<tr><th>need</th>";
    for lens in &results.lenses {
        let _ = write!(html, "<th>{}</th>", escaped(lens));
    }
    *html += "</tr>\n";
    for answer in answers(results) {
        let _ = write!(html, "<tr><td>{}</td>", escaped(&answer.need));
        for (lens, text) in results.lenses.iter().zip(&answer.by_lens) {
            let _ = write!(html, "<td data-lens=\"{}\">{}</td>", escaped(lens), escaped(text));
        }
        *html += "</tr>\n";
    }
    *html += "</table></div>\n";
    for (heading, sentences) in sentences(results) {
        let _ = writeln!(html, "<h3>{}</h3>\n<ul>", escaped(heading));
        for sentence in sentences {
            let _ = writeln!(html, "<li>{}</li>", escaped(&sentence));
        }
        *html += "</ul>\n";
    }
}

fn in_words(Tie { ratio, share, pairs }: Tie) -> String {
    match pairs {
        0 => "(not measured twice: everything is a tie)".to_owned(),
        _ => format!("{:.1} % ({:.0} in 100 of {pairs} pairs)", 100.0 * (ratio - 1.0), 100.0 * share),
    }
}

/// Writes the failing rays, each with the command line that repeats its case.
fn failures(html: &mut String, results: &Results, suite: &Suite) {
    if let Some(headline) = stability(results, suite) {
        let _ = writeln!(html, "<p><strong>{}</strong></p>", escaped(&headline));
    }
    let failures = failures_table(&results.stability);
    if failures.rows.is_empty() {
        return;
    }
    // The CSV file of the table has all rows.
    const SHOWN: usize = 200;
    let left = failures.rows.len().saturating_sub(SHOWN);
    table(html, &Table { rows: failures.rows.into_iter().take(SHOWN).collect(), ..failures });
    if left > 0 {
        let _ = writeln!(html, "<p>And {left} more, in <a href=\"stability-failures.csv\">the CSV</a>.</p>");
    }
}

fn method(html: &mut String, results: &Results, suite: &Suite, facts: &[(&str, String)], took: Duration) {
    let Suite { ray_map, irradiance, picture, .. } = suite;
    let _ = write!(
        html,
        "<h2 id=\"method\">How it was measured</h2>\n<p>Times: one thread, and of its time only that for which it \
         had a processor, which is wall time where nothing else runs. Every task is warmed up until one measurement \
         of it lasts {least}, then timed {rounds} times in pairs with one yardstick (the first of its group), in rounds that \
         go forward and backward through the tasks; its time \
         is the median of the ratios times the yardstick's median, so that a drifting clock and busy neighbours \
         cancel. Methods are entered twice, in two places of memory: what 99 in 100 pairs of the same method differ by at the \
         most, of light 90 in 100, is the threshold of a tie. Single rays are timed over blocks of {block} in which the processor may overlap one \
         ray with the next; a camera's rays one by one wait for each other. Renders are timed whole, the median of \
         {renders}. Building times are medians, too.</p>\n\
         <p>Errors of rays: {rays} samples of a camera with the default pupil, uniform over the film's pixels and the \
         lens samples, those that an aperture blocks among them; an error is that of the rays that pass for the method and in \
         truth, and the table counts those that do not. Polynomials \
         are fitted to other rays. Position is the distance of the exact point on the front surface from the line of \
         the ray. Pixels: the distance between the points where the ray and the exact one meet the plane in focus, \
         brought back to the film by the scale that the lens's own chief rays have there, meridional and sagittal. \
         Irradiance: {repeats} repetitions at 5 film points on a half-diagonal, less those that get no light; exact \
         values by {survey} x {survey} rays over the rear disk. Pictures: {x} x {y} pixels against a mean of two of \
         {reference} samples per pixel, whose own RMS errors are {floors}.</p>\n<p>The whole took {took}.</p>\n",
        least = seconds(ray_map.effort.least.as_secs_f64()),
        rounds = ray_map.effort.rounds,
        block = ray_map.block,
        renders = picture.repeats,
        rays = ray_map.rays,
        repeats = irradiance.repeats,
        survey = irradiance.survey,
        x = picture.raster.xres,
        y = picture.raster.yres,
        reference = picture.reference,
        floors = results
            .floors
            .iter()
            .map(|(lens, error)| format!("{:.2} % ({})", 100.0 * error, escaped(lens)))
            .collect::<Vec<_>>()
            .join(", "),
        took = seconds(took.as_secs_f64()),
    );
    *html += "<div class=\"wide\"><table>\n";
    for (name, value) in facts {
        let _ = writeln!(html, "<tr><th>{}</th><td>{}</td></tr>", escaped(name), escaped(value));
    }
    *html += "</table></div>\n";
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
