//! The page: one HTML file that needs nothing but the files beside it.

use super::advice::advice;
use super::conclusions::{answers, sentences};
use super::figures::Section;
use super::findings::seconds;
use realistic_lab::accuracy::suite::{Results, Suite};
use realistic_lab::results::table::{Cell, Table};
use std::fmt::Write as _;
use std::time::Duration;

const STYLE: &str = "
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff; margin: 0 auto; padding: 0 16px 48px; max-width: 1480px; }
h1 { font-size: 1.7rem; line-height: 1.2; } h2 { font-size: 1.25rem; margin-top: 2.4em; } h3 { font-size: 1rem; margin-bottom: 0.2em; }
h3 + ul { margin-top: 0; }
p, ul { max-width: 76ch; }
nav a { margin-right: 1.1em; }
.warning { border-left: 4px solid #D55E00; padding-left: 12px; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 0.92rem; }
th, td { text-align: left; padding: 5px 12px 5px 0; border-bottom: 1px solid #ddd; vertical-align: top; }
details { margin-top: 14px; } summary { cursor: pointer; }
.needs td, .needs th { min-width: 11em; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 600px), 1fr)); gap: 24px; }
figure { margin: 0; overflow-x: auto; } figure img { width: 100%; min-width: 520px; max-width: 780px; height: auto; display: block; }
figcaption { font-size: 0.85rem; }
";

/// The whole page.
pub fn page(
    results: &Results,
    suite: &Suite,
    sections: &[Section],
    facts: &[(&str, String)],
    took: Duration,
) -> String {
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>realistic: error against run time</title>\n\
         <style>{STYLE}</style>\n<h1>Error against run time</h1>\n"
    );
    html += "<p>What it costs to take a ray through a lens, and what the cheaper ways get wrong. Every error is against \
        the walk in double-double numbers of 106 bits. All lenses are focused at infinity on film of 35 mm diagonal; \
        pixels are those of 1920 x 1280 on it.</p>\n<nav>";
    let contents =
        [("conclusions", "Conclusions")].into_iter().chain(sections.iter().map(|s| (s.anchor, s.title)));
    for (anchor, title) in contents.chain([("method", "How it was measured")]) {
        let _ = write!(html, "<a href=\"#{anchor}\">{}</a> ", escaped(title));
    }
    html += "</nav>\n";
    if cfg!(debug_assertions) {
        html += "<p class=\"warning\">This program was built for debugging: its times are not those of a release.</p>\n";
    }
    conclusions(&mut html, results);
    for section in sections {
        let _ = write!(
            html,
            "<h2 id=\"{}\">{}</h2>\n<p>{}</p>\n",
            section.anchor,
            escaped(section.title),
            escaped(section.text)
        );
        html += "<div class=\"figures\">\n";
        for figure in &section.figures {
            let (file, title) = (&figure.file, escaped(&figure.chart.title));
            let _ = writeln!(
                html,
                "<figure><img src=\"{file}.svg\" alt=\"{}: {title}\"><figcaption><a href=\"{file}.svg\">SVG</a> \
                 <a href=\"{file}.png\">PNG</a> <a href=\"{}.csv\">CSV</a></figcaption></figure>",
                escaped(section.title),
                section.table
            );
        }
        html += "</div>\n";
        if let Some(summary) = &section.summary {
            let _ = writeln!(html, "<details><summary>The figures as a table</summary>");
            table(&mut html, summary);
            html += "</details>\n";
        }
    }
    method(&mut html, results, suite, facts, took);
    html
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
                // Counts as they are, measurements to the digits that mean something.
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

fn conclusions(html: &mut String, results: &Results) {
    *html += "<h2 id=\"conclusions\">Conclusions</h2>\n<ul>\n";
    for sentence in advice(results) {
        let _ = writeln!(html, "<li>{}</li>", escaped(&sentence));
    }
    *html += "</ul>\n<p>The cheapest of the methods measured here that serves each need, with its time on one core. Times within \
        a tenth of the least are a tie: of those the nearest to the exact ray is named, and the others in brackets. The \
        same threshold decides what is faster everywhere on this page.</p>\n<div class=\"wide\"><table class=\"needs\">\n<tr><th>need</th>";
    for lens in &results.lenses {
        let _ = write!(html, "<th>{}</th>", escaped(lens));
    }
    *html += "</tr>\n";
    for answer in answers(results) {
        let _ = write!(html, "<tr><td>{}</td>", escaped(&answer.need));
        for text in &answer.by_lens {
            let _ = write!(html, "<td>{}</td>", escaped(text));
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

fn method(html: &mut String, results: &Results, suite: &Suite, facts: &[(&str, String)], took: Duration) {
    let Suite { ray_map, irradiance, picture, .. } = suite;
    let _ = write!(
        html,
        "<h2 id=\"method\">How it was measured</h2>\n<p>Times: one thread, and of its time only that for which it \
         had a processor, which is wall time where nothing else runs. Every task is warmed up until one measurement \
         of it lasts {least}, then timed {rounds} times in pairs with one yardstick (the walk in f64, or the \
         irradiance estimate on the rear disk), in rounds that go forward and backward through the tasks; its time \
         is the median of the ratios times the yardstick's median, so that a drifting clock and busy neighbours \
         cancel. Single rays are timed over blocks of {block} in which the processor may overlap one ray with the \
         next. Renders are timed whole, the median of {renders}. Building times are medians, too.</p>\n\
         <p>Errors of rays: {rays} rays that get through, uniform over the film's disk and the pupil; polynomials \
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
