//! `realistic convert`: a lens file of any format that is read, or a lens of the catalogue, as the project's own table.

mod table;

use crate::failure::Failure;
use crate::files::save;
use crate::lens_and_film::{glasscatalog_help, open};
use std::io::Write as _;
use std::path::PathBuf;

/// What `convert` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Lens: a file, - for standard input, or a name of the catalogue; NAME@35mm scales it to that focal length
    #[arg(value_name = "IN")]
    lens: String,
    #[arg(long, value_name = "FILE", help = glasscatalog_help())]
    glasscatalog: Option<String>,
    /// Table to write; - for standard output
    #[arg(value_name = "OUT")]
    out: PathBuf,
}

/// Writes the table and says where to.
///
/// # Errors
/// No such lens, or a file that cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let (prescription, _) = open(&args.lens, args.glasscatalog.as_deref(), |_| ())?;
    let text = table::write(&prescription);
    if args.out.as_os_str() == "-" {
        return Ok(std::io::stdout().write_all(text.as_bytes())?);
    }
    save(&args.out, text.as_bytes()).map_err(|error| Failure::cannot_write(&args.out, &error))?;
    Ok(writeln!(std::io::stdout(), "{}", args.out.display())?)
}
