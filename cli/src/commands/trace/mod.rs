//! `realistic trace`: traces rays through a lens, one per line.

mod lines;

use crate::arguments::LensChoice;
use crate::failure::Failure;
use lines::{InputLine, LineFormat, read_line};
use realistic_lab::methods::Method;
use realistic_lab::methods::any_ray;
use realistic_optics::trace::{Blocked, Direction, Ray};
use std::io::{self, BufRead, BufReader, BufWriter, Write};

/// The options of `trace`.
#[derive(clap::Args, Debug)]
#[command(after_help = FORMATS, after_long_help = with_methods())]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Method of tracing; --help lists the methods
    #[arg(long, value_name = "NAME", default_value = "f64", value_parser = Method::find)]
    method: &'static Method,
    /// Side from which the rays come
    #[arg(long, value_name = "SIDE", default_value = "film")]
    from: Side,
    /// Write one JSON object per line
    #[arg(long)]
    json: bool,
}

/// The side from which the light comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Side {
    /// From behind the lens, toward +z
    Film,
    /// From in front of the lens, toward -z
    Scene,
}

/// Formats of the input and of the output.
const FORMATS: &str = "Standard input: a ray a line, x,y,z,dx,dy,dz: a point on it and its direction (of any length), in \
     mm in lens space: origin at the vertex of the first interface, +z toward the scene, film at \
     negative z. Blank lines and # comments are skipped; a first line that begins with a letter is a \
     header. With the film's place, as by --film-distance, a line may leave its z empty (1.5,0,,0,0,1) and starts on \
     the film.\n\
     Standard output: x,y,z,dx,dy,dz,status: the point on the last interface met (where none was met, the \
     point given), the unit direction there, 17 significant digits; status ok, or why the ray stopped: \
     missed, clipped, reflected or turned_back. With --json the same as an object a line: x_mm, y_mm, z_mm, dx, dy, \
     dz, status.";

fn with_methods() -> String {
    let mut text = format!("{FORMATS}\n\nMethods:\n");
    for (name, help, _) in Method::offered() {
        text += &format!("  {name:<9} {help}\n");
    }
    text
}

/// Traces the rays on standard input and writes them to standard output.
///
/// # Errors
/// There is no such lens, or a line is not a ray; the lines before that line are traced.
pub fn run(args: &Args) -> Result<(), Failure> {
    if args.lens.is_piped() {
        return Err(Failure::Usage("standard input has the rays; give the lens as a file".to_owned()));
    }
    let opened = args.lens.open()?;
    let lens = &opened.lens;
    let direction = match args.from {
        Side::Film => Direction::FilmToScene,
        Side::Scene if opened.is_placed() => {
            return Err(Failure::Usage(
                "the film's place says where rays from the film start; leave it out with --from scene"
                    .to_owned(),
            ));
        }
        Side::Scene => Direction::SceneToFilm,
    };
    let film = if opened.is_placed() { Some(lens.rear().vertex - opened.film_distance()?) } else { None };
    let tracer = any_ray::tracer(args.method, lens, direction)
        .map_err(|error| Failure::Other(error.to_string()))?
        .expect("`trace` offers no method for a film's rays alone");
    let input = BufReader::with_capacity(1 << 16, io::stdin().lock());
    let mut output = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    let outcome =
        copy(input, &mut output, film, if args.json { LineFormat::Json } else { LineFormat::Csv }, |ray| {
            tracer.one(ray)
        });
    // The rays before a bad line are still written.
    output.flush()?;
    outcome
}

fn copy(
    mut input: impl BufRead,
    output: &mut impl Write,
    film: Option<f64>,
    format: LineFormat,
    trace: impl Fn(Ray) -> (Ray, Option<Blocked>),
) -> Result<(), Failure> {
    let mut line = Vec::new();
    let mut first = true;
    for number in 1_u64.. {
        line.clear();
        let length = input
            .read_until(b'\n', &mut line)
            .map_err(|error| Failure::Other(format!("cannot read standard input: {error}")))?;
        if length == 0 {
            break;
        }
        let row = read_line(&line, film, first).map_err(|(column, expected)| {
            Failure::Other(format!("standard input:{number}:{column}: {expected}"))
        })?;
        match row {
            InputLine::Empty => continue,
            InputLine::Header => format.write_header(output)?,
            InputLine::Ray(ray) => {
                let (ray, blocked) = trace(ray);
                format.write_ray(output, ray, blocked)?;
            }
        }
        first = false;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn traced(input: &str) -> (String, Result<(), Failure>) {
        let mut output = Vec::new();
        let outcome = copy(input.as_bytes(), &mut output, Some(-5.0), LineFormat::Csv, |ray| (ray, None));
        (String::from_utf8(output).unwrap(), outcome)
    }

    #[test]
    fn a_header_is_answered_and_comments_are_skipped() {
        let (output, outcome) =
            traced("\n# rays\nx,y,z,dx,dy,dz\n1,2,,0,0,1 # on the film\r\n\n0,0,-3,0,0,1");
        outcome.unwrap();
        let lines: Vec<&str> = output.lines().collect();
        assert_eq!(lines[0], "x,y,z,dx,dy,dz,status");
        assert!(lines[1].contains(",-5.0000000000000000e0,") && lines[1].ends_with(",ok"), "{}", lines[1]);
        assert_eq!(lines.len(), 3);
        assert!(!traced("0,0,-3,0,0,1").0.contains("status"), "no header is written where none was read");
    }

    #[test]
    fn a_bad_line_is_named_after_the_good_ones_are_out() {
        let (output, outcome) = traced("0,0,-3,0,0,1\n0,0,-3,0,up,1\n");
        assert_eq!(output.lines().count(), 1);
        let Err(Failure::Other(message)) = outcome else { panic!("{outcome:?}") };
        assert!(message.starts_with("standard input:2:10: ") && message.contains("dy"), "{message}");
    }
}
