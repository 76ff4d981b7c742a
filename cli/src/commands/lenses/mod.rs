//! `realistic lenses`: the lenses of folders, archives and files of any format, with their numbers.

mod cache;
mod filter;
mod outcome;
mod row;
mod scan;
mod sheet;
mod table;

use crate::console;
use crate::failure::Failure;
use crate::files;
use cache::Cache;
use filter::{Filter, NumberRange};
use realistic_optics::prescription::{Collection, CollectionFile, SearchPath};
use row::ListRow;
use scan::Listing;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The options of `lenses`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Folders, with all that is below them, zip archives and lens files [default: those in the variable
    /// REALISTIC_LENSES, or else the catalogue]
    #[arg(value_name = "DIR")]
    places: Vec<PathBuf>,
    /// List lenses with a focal length in this range, mm: A-B, -B or A-
    #[arg(long, value_name = "A-B", allow_hyphen_values = true, value_parser = NumberRange::parse)]
    focal: Option<NumberRange>,
    /// List lenses with an f-number in this range: A-B, -B or A-
    #[arg(long, value_name = "A-B", allow_hyphen_values = true, value_parser = NumberRange::parse)]
    fnumber: Option<NumberRange>,
    /// List lenses of a maker: a part of the name, in title or path where the maker is unknown
    #[arg(long, value_name = "NAME")]
    maker: Option<String>,
    /// Write JSON: an object for each lens and each file that cannot be read; keys carry units, null means unknown
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Write CSV, with the keys of --json as columns
    #[arg(long)]
    csv: bool,
    /// Write a page of cross-sections, .html; - for standard output
    #[arg(long, value_name = "FILE", value_parser = sheet::path, conflicts_with_all = ["json", "csv"])]
    sheet: Option<PathBuf>,
    /// Read every file again, and keep nothing in the cache
    #[arg(long)]
    no_cache: bool,
}

/// Lists the lenses.
///
/// # Errors
/// A named folder or file does not exist, or the output cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    if let Some(out) = &args.sheet {
        files::make_parent(out)?;
    }
    let Listing { mut rows, others } = listing(args)?;
    let filter = Filter { focal: args.focal, fnumber: args.fnumber, maker: args.maker.clone() };
    let unreadable = rows.iter().filter(|(row, _)| row.text("error").is_some()).count();
    let found = rows.len() - unreadable;
    rows.retain(|(row, _)| filter.passes(row));
    let listed = rows.iter().filter(|(row, _)| row.text("error").is_none()).count();
    let of_all = if filter.is_open() { String::new() } else { format!(" of {found}") };
    console::note(&format!(
        "{listed}{of_all} lenses; {unreadable} files that cannot be read; {others} other files"
    ));
    if let Some(out) = &args.sheet {
        sheet::write(&rows, out)?;
        return Ok(console::report(&format!("{}\n", out.display()), out)?);
    }
    let rows: Vec<ListRow> = rows.into_iter().map(|(row, _)| row).collect();
    let text = if args.json {
        table::json(&rows)
    } else if args.csv {
        table::csv(&rows)
    } else {
        table::text(&rows)
    };
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

/// Reads the collections that the user names, those of the environment, or the catalogue.
fn listing(args: &Args) -> Result<Listing, Failure> {
    let mut listing = Listing::default();
    let search = SearchPath::from_environment();
    let places = if args.places.is_empty() { search.collections() } else { &args.places };
    if places.is_empty() {
        listing.add_catalogue();
        return Ok(listing);
    }
    let folder = if args.no_cache { None } else { cache::folder() };
    let catalogues: Vec<CollectionFile> =
        search.glasses().iter().flat_map(|place| catalogues(place)).collect();
    for place in places {
        match Collection::open(place) {
            Ok(collection) => {
                let cache = Cache::of(folder.as_deref(), &collection, &catalogues);
                listing.add(&collection, &search, cache);
            }
            // A folder of the environment may be on a disk that is not there now.
            Err(error) if args.places.is_empty() => {
                let path = place.display().to_string();
                listing.rows.push((ListRow::of_error(&path, &path, &error.to_string()), None));
            }
            Err(error) => return Err(Failure::Other(error.to_string())),
        }
    }
    Ok(listing)
}

/// Returns the glass catalogues at a place of the environment.
fn catalogues(place: &Path) -> Vec<CollectionFile> {
    let files = Collection::open(place).map(|place| place.files().to_vec()).unwrap_or_default();
    files.into_iter().filter(cache::is_catalogue).collect()
}
