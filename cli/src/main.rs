//! The command line of `realistic`, and a small renderer that loads the plugin as a host does:
//! through the dynamic loader and the C ABI, not through the crate.

mod arguments;
mod commands;
mod console;
mod drawing;
mod export;
mod failure;
mod files;
mod host;
mod image;
mod osl;
mod plots;
mod spelling;

use arguments::{CameraChoice, ParameterFlags, with_groups, with_scene_defaults, with_stack_defaults};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use commands::pictures::{focus_stack, merge, render};
use commands::{
    blender, convert, disks, draw, flare, focus, install, lens, lenses, plan, pupil, refractions, report,
    trace,
    waves::{self, mtf, psf},
};
use failure::Failure;
use realistic_optics::prescription::catalogue;
use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

/// A real camera for renderers: rays traced through every interface of a real lens.
///
/// Without a command it runs `render`: it renders the built-in scene through `dgauss.50mm` to realistic.png. Lengths
/// are millimetres unless an option states another unit.
#[derive(Parser)]
#[command(name = "realistic", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Print only errors and the requested output
    #[arg(short, long, global = true)]
    quiet: bool,
    #[command(flatten)]
    flags: ParameterFlags,
    #[command(flatten)]
    render: render::PictureArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Render the built-in scene through a lens, with the plugin loaded as a host loads it
    Render(render::Args),
    /// Join the tiles of `render --crop` to the whole picture
    Merge(merge::Args),
    /// Report a lens: focal length, focal points, pupils, field of view, its table
    Lens(lens::Args),
    /// List the lenses of folders, archives and files of any format
    Lenses(lenses::Args),
    /// Write a lens, read from a file of any format, as the project's own table
    Convert(convert::Args),
    /// Write a lens as a camera for Blender: a shader in OSL
    Blender(blender::Args),
    /// Export a lens to other programs: distortion models, ST maps, rays, illumination, spots
    Export(commands::export::Args),
    /// Draw a lens's cross-section, to scale, with traced rays
    Draw(draw::Args),
    /// Trace rays: one per line on standard input, one per line on standard output
    Trace(trace::Args),
    /// Show the ghosts of a lamp: light that two surfaces of the lens reflect
    Flare(flare::Args),
    /// Find the film distance for an object distance, and the depth of field
    Focus(focus::Args),
    /// Show the true pupil of a film point
    Pupil(pupil::Args),
    /// Compute the picture of a point, with diffraction
    Psf(psf::Args),
    /// Compute the contrast of fine detail, with diffraction and by rays alone
    Mtf(mtf::Args),
    /// Show the parts that a camera keeps and leaves out, and the time saved
    Plan(plan::Args),
    /// Render the same picture focused from near to far
    FocusStack(focus_stack::Args),
    /// Draw and measure the mappings from samples to a disk
    Disks(disks::Args),
    /// Copy the plugin into a renderer's plugin directory
    Install(install::Args),
    /// Compare the methods of refraction: operations, time and error
    Refractions(refractions::Args),
    /// Measure error against run time and write a folder with a page, plots and tables
    Report(report::Args),
    /// Write a shell's completions of this command line to standard output
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// Returns the command line. Flags without a command are those of `render`, and the help of the whole program lists
/// them.
fn command() -> clap::Command {
    let command = with_scene_defaults(Cli::command())
        .mut_subcommand("render", with_scene_defaults)
        .mut_subcommand("focus-stack", with_stack_defaults)
        .mut_subcommand("blender", |command| with_groups(command, blender::GROUPS))
        .mut_subcommand("export", |command| with_groups(command, commands::export::GROUPS))
        .mut_subcommand("flare", |command| with_groups(command, flare::GROUPS))
        .mut_subcommand("mtf", |command| with_groups(command, waves::GROUPS))
        .mut_subcommand("psf", |command| with_groups(command, waves::GROUPS));
    command.mut_args(|arg| if arg.get_id() == "quiet" { arg } else { arg.hide_short_help(true) })
}

/// Parses the command line.
///
/// # Errors
/// Wrong use, or a request for help, with clap's own text and additions.
fn read(words: &[OsString]) -> Result<Cli, clap::Error> {
    let read = command().try_get_matches_from(words).and_then(|matches| Cli::from_arg_matches(&matches));
    read.map_err(|error| {
        let no_text = words.iter().find(|word| word.to_str().is_none());
        match (error.kind(), no_text) {
            (ErrorKind::InvalidUtf8, Some(word)) => clap::Error::raw(
                ErrorKind::InvalidUtf8,
                format!(
                    "{word:?} is not UTF-8, and names of files and lenses are; rename the file, or give a lens as - and its \
                     text on standard input\n"
                ),
            ),
            (ErrorKind::InvalidSubcommand, _) if is_lens(&error) => {
                let text = error.render().to_string();
                // `raw` writes this prefix again.
                let text = text.strip_prefix("error: ").unwrap_or(&text);
                let tip = "  tip: a lens follows a command, as in `realistic render LENS`";
                clap::Error::raw(ErrorKind::InvalidSubcommand, format!("{text}\n{tip}\n"))
            }
            (ErrorKind::UnknownArgument, _) => spelling::corrected(error, command(), words),
            _ => error,
        }
    })
}

/// Whether the word in command position is a lens.
fn is_lens(error: &clap::Error) -> bool {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return false };
    catalogue::names().any(|name| name == word) || std::path::Path::new(word).is_file()
}

fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    let cli = match read(&words) {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            let _ = write!(std::io::stderr(), "realistic: {}", error.render());
            return ExitCode::from(2);
        }
        Err(help) => {
            let _ = help.print();
            return ExitCode::SUCCESS;
        }
    };
    if cli.quiet {
        console::be_quiet();
    }
    let outcome = match &cli.command {
        None => render::run(&CameraChoice::of_flags(&cli.flags), &cli.render),
        Some(Command::Render(args)) => render::run(&args.camera, &args.picture),
        Some(Command::Merge(args)) => merge::run(args),
        Some(Command::Lens(args)) => lens::run(args),
        Some(Command::Lenses(args)) => lenses::run(args),
        Some(Command::Convert(args)) => convert::run(args),
        Some(Command::Blender(args)) => blender::run(args),
        Some(Command::Export(args)) => commands::export::run(args),
        Some(Command::Draw(args)) => draw::run(args),
        Some(Command::Trace(args)) => trace::run(args),
        Some(Command::Flare(args)) => flare::run(args),
        Some(Command::Focus(args)) => focus::run(args),
        Some(Command::Pupil(args)) => pupil::run(args),
        Some(Command::Psf(args)) => psf::run(args),
        Some(Command::Mtf(args)) => mtf::run(args),
        Some(Command::Plan(args)) => plan::run(args),
        Some(Command::FocusStack(args)) => focus_stack::run(args),
        Some(Command::Disks(args)) => disks::run(args),
        Some(Command::Install(args)) => install::run(args),
        Some(Command::Refractions(args)) => refractions::run(args),
        Some(Command::Report(args)) => report::run(args),
        Some(Command::Completions { shell }) => {
            clap_complete::generate(*shell, &mut command(), "realistic", &mut std::io::stdout());
            Ok(())
        }
    };
    outcome.map_or_else(Failure::report, |()| ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        command().debug_assert();
    }

    #[test]
    fn no_command_takes_the_flags_of_render() {
        let cli = Cli::try_parse_from(["realistic", "--spp", "3"]).unwrap();
        assert!(cli.command.is_none());
        assert_eq!(cli.render.options.spp, Some(3));
        assert!(Cli::try_parse_from(["realistic", "--spp", "3", "install", "x"]).is_err());
    }
}
