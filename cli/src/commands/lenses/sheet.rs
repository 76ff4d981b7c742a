//! The cross-sections of the listed lenses on one page of HTML, which needs no other files.

use super::row::ListRow;
use super::scan::{AT_ONCE, Glasses};
use super::table::focal_lengths;
use crate::console;
use crate::drawing::catalogue::{Entry, draw_one};
use crate::failure::Failure;
use crate::files;
use rayon::prelude::*;
use realistic_optics::lens::{Lens, first_order::FirstOrder};
use realistic_optics::prescription::{CollectionFile, SearchPath, catalogue};
use std::path::{Path, PathBuf};

/// Maximum number of lenses on a page; a drawing takes some 50 kB.
const MOST: usize = 1000;

const STYLE: &str = "body { font: 16px/1.5 system-ui, sans-serif; margin: 16px; } \
                     main { display: grid; grid-template-columns: repeat(auto-fill, 300px); gap: 12px; } \
                     figure { margin: 0; } figcaption { font-size: 0.75rem; overflow-wrap: anywhere; }";

/// Parses the path of the page.
pub fn path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_page = path.extension().is_some_and(|own| own.eq_ignore_ascii_case("html"));
    if is_page || files::is_stdout(&path) {
        Ok(path)
    } else {
        Err("must end in .html, or be - for standard output".to_owned())
    }
}

/// Writes the page.
///
/// # Errors
/// The file cannot be written; the message names it.
pub fn write(rows: &[(ListRow, Option<CollectionFile>)], out: &Path) -> Result<(), Failure> {
    let lenses: Vec<_> = rows.iter().filter(|(row, _)| row.text("error").is_none()).collect();
    if lenses.len() > MOST {
        console::warn(&format!(
            "the page shows the first {MOST} of {} lenses; select some with --focal, --fnumber or --maker",
            lenses.len()
        ));
    }
    let shown = &lenses[..lenses.len().min(MOST)];
    let search = SearchPath::from_environment();
    let draw = |rows: &[&(ListRow, Option<CollectionFile>)]| {
        let mut glasses = Glasses::new(&search);
        rows.iter().filter_map(|(row, file)| figure(row, file.as_ref(), &mut glasses)).collect::<Vec<_>>()
    };
    let figures: Vec<String> = shown.par_chunks(AT_ONCE).flat_map_iter(draw).collect();
    let page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{} lenses</title>\n\
         <style>{STYLE}</style>\n<main>\n{}</main>\n</html>\n",
        figures.len(),
        figures.concat()
    );
    files::save(out, page.as_bytes()).map_err(|error| Failure::cannot_write(out, &error))
}

/// Draws a lens; `None` if its file has changed and is no lens any more.
fn figure<'f>(row: &ListRow, file: Option<&'f CollectionFile>, glasses: &mut Glasses<'f>) -> Option<String> {
    let prescription = match file {
        Some(file) => file.lens(glasses.of(file)).ok()?,
        None => catalogue::find(row.text("lens_file")?)?,
    };
    let lens = Lens::at_own_wavelength(&prescription);
    let focused = || FirstOrder::of(&lens).map_or(0.0, |optics| optics.back_focal_distance());
    let film_distance = prescription.nominal_film_distance.unwrap_or_else(focused);
    let fnumber = row.number("fnumber").map_or_else(String::new, |number| format!(", f/{number:.2}"));
    let title = row.text("title").map_or_else(String::new, |title| format!(": {title}"));
    let text = format!("{} mm{fnumber}{title}", focal_lengths(row));
    let drawing = draw_one(&Entry { lens, film_distance, text });
    let name = row.text("name").unwrap_or_default();
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    Some(format!("<figure>\n{drawing}<figcaption>{name}</figcaption>\n</figure>\n"))
}
