//! The command line of `realistic`, and a small renderer that loads the plugin as a
//! stranger would: through the dynamic loader and the C ABI, not through the crate.

mod commands;
mod drawing;
mod failure;
mod files;
mod host;
mod image;
mod lens_and_film;
mod osl;
mod plots;

use clap::{Parser, Subcommand};
use commands::pictures::{focus_stack, merge, render};
use commands::{
    blender, convert, disks, draw, focus, install, lens, plan, pupil, refractions, report, trace,
};
use failure::Failure;
use std::io::Write;
use std::process::ExitCode;

/// A real camera for renderers: rays traced through every interface of a real lens.
///
/// Without a command it does what `render` does: it renders the built-in scene through
/// `dgauss.50mm` to realistic.png. Lengths are millimetres unless an option says otherwise.
#[derive(Parser)]
#[command(
    name = "realistic",
    version,
    args_conflicts_with_subcommands = true,
    disable_help_subcommand = true
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    render: render::Args,
}

#[derive(Subcommand)]
enum Command {
    /// Render the built-in scene through a lens, with the plugin loaded as a host loads it
    Render(render::Args),
    /// Put the tiles of `render --crop` together to the whole picture
    Merge(merge::Args),
    /// Report a lens: focal length, focal points, pupils, field of view, its table
    Lens(lens::Args),
    /// Write a lens, read from a file of any format, as the project's own table
    Convert(convert::Args),
    /// Write a lens as a camera for Blender: a shader in OSL
    Blender(blender::Args),
    /// Draw a lens's cross-section, to scale, with traced rays
    Draw(draw::Args),
    /// Trace rays: one a line on standard input, one a line on standard output
    Trace(trace::Args),
    /// Find the film distance for an object distance, and the depth of field
    Focus(focus::Args),
    /// Show which part of the lens a film point gets light from
    Pupil(pupil::Args),
    /// Show what a camera keeps and leaves out, and what that saves
    Plan(plan::Args),
    /// Take the same picture focused from near to far
    FocusStack(focus_stack::Args),
    /// Draw and measure the ways to sample a disk
    Disks(disks::Args),
    /// Copy the plugin into a renderer's plugin directory
    Install(install::Args),
    /// Compare the methods of refraction: operations, time and error
    Refractions(refractions::Args),
    /// Measure error against run time and write a folder with a page, plots and tables
    Report(report::Args),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
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
    let outcome = match &cli.command {
        None => render::run(&cli.render),
        Some(Command::Render(args)) => render::run(args),
        Some(Command::Merge(args)) => merge::run(args),
        Some(Command::Lens(args)) => lens::run(args),
        Some(Command::Convert(args)) => convert::run(args),
        Some(Command::Blender(args)) => blender::run(args),
        Some(Command::Draw(args)) => draw::run(args),
        Some(Command::Trace(args)) => trace::run(args),
        Some(Command::Focus(args)) => focus::run(args),
        Some(Command::Pupil(args)) => pupil::run(args),
        Some(Command::Plan(args)) => plan::run(args),
        Some(Command::FocusStack(args)) => focus_stack::run(args),
        Some(Command::Disks(args)) => disks::run(args),
        Some(Command::Install(args)) => install::run(args),
        Some(Command::Refractions(args)) => refractions::run(args),
        Some(Command::Report(args)) => report::run(args),
    };
    outcome.map_or_else(Failure::report, |()| ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_command_takes_the_flags_of_render() {
        let cli = Cli::try_parse_from(["realistic", "--spp", "3"]).unwrap();
        assert!(cli.command.is_none());
        assert_eq!(cli.render.options.spp, Some(3));
        assert!(Cli::try_parse_from(["realistic", "--spp", "3", "install", "x"]).is_err());
    }
}
