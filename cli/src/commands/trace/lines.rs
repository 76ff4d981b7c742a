//! The lines of `trace`: parses a line as a ray, and formats a ray as a line.

use realistic_base::message::cut;
use realistic_optics::trace::{Blocked, Ray};
use serde_json::json;
use std::io::{self, Write};

/// A line of input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InputLine {
    /// Only white space or a comment.
    Empty,
    /// Names of columns.
    Header,
    /// A ray.
    Ray(Ray),
}

const NAMES: [&str; 6] = ["x", "y", "z", "dx", "dy", "dz"];

/// An error, as the column in bytes, counted from 1, and the expected text.
type Wrong = (usize, String);

/// Parses a line. `film` is the z of a ray whose z is empty; `may_be_header` is true up to and including the first
/// line that is not empty.
pub fn read_line(line: &[u8], film: Option<f64>, may_be_header: bool) -> Result<InputLine, Wrong> {
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    let text = std::str::from_utf8(&line[..end])
        .map_err(|error| (error.valid_up_to() + 1, "not text; expected a ray, x,y,z,dx,dy,dz".to_owned()))?;
    // Some editors write UTF-8's byte order mark before the first line.
    let (text, shift) = text.strip_prefix('\u{feff}').map_or((text, 0), |rest| (rest, 3));
    if text.trim().is_empty() {
        return Ok(InputLine::Empty);
    }
    let mut numbers = [0.0; 6];
    let mut count = 0;
    let mut start = 0;
    for field in text.split(',') {
        let column = shift + start + 1 + (field.len() - field.trim_start().len());
        start += field.len() + 1;
        let word = field.trim();
        let Some(&name) = NAMES.get(count) else {
            return Err((column, "expected the line's end after six values, x,y,z,dx,dy,dz".to_owned()));
        };
        numbers[count] = match word.parse::<f64>() {
            Ok(number) if number.is_finite() => number,
            Err(_) if count == 0 && may_be_header && word.starts_with(char::is_alphabetic) => {
                return Ok(InputLine::Header);
            }
            Err(_) if word.is_empty() && name == "z" => film.ok_or_else(|| {
                (
                    column,
                    "z is empty; expected a number in mm, or the film's place by --film-distance".to_owned(),
                )
            })?,
            _ => return Err((column, format!("expected a finite number for {name}, got \"{}\"", cut(word)))),
        };
        count += 1;
    }
    if count < NAMES.len() {
        let column = shift + text.trim_end().len() + 1;
        return Err((column, format!("the line ends; expected , and a number for {}", NAMES[count])));
    }
    let [x, y, z, dx, dy, dz] = numbers;
    if [dx, dy, dz] == [0.0; 3] {
        return Err((1 + shift, "the direction dx,dy,dz is 0,0,0; expected one of some length".to_owned()));
    }
    Ok(InputLine::Ray(Ray { origin: [x, y, z], direction: [dx, dy, dz] }))
}

/// Output format of rays, one per line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineFormat {
    /// Values separated by commas.
    Csv,
    /// A JSON object.
    Json,
}

impl LineFormat {
    /// Writes the names of the columns, if the format has columns.
    pub fn write_header(self, output: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Csv => writeln!(output, "x,y,z,dx,dy,dz,status"),
            Self::Json => Ok(()),
        }
    }

    /// Writes a ray as a line.
    pub fn write_ray(self, output: &mut impl Write, ray: Ray, blocked: Option<Blocked>) -> io::Result<()> {
        let status = blocked.map_or_else(|| "ok".to_owned(), |reason| reason.to_string());
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        match self {
            Self::Csv => {
                for number in [x, y, z, dx, dy, dz] {
                    write!(output, "{number:.16e},")?;
                }
                writeln!(output, "{status}")
            }
            Self::Json => {
                let object = json!({ "x_mm": x, "y_mm": y, "z_mm": z, "dx": dx, "dy": dy, "dz": dz, "status": status });
                writeln!(output, "{object}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_six_numbers() {
        let row = read_line(b" 1, 2 ,-3e0,\t0,0,+.5\r\n", None, true).unwrap();
        assert_eq!(row, InputLine::Ray(Ray { origin: [1.0, 2.0, -3.0], direction: [0.0, 0.0, 0.5] }));
        assert_eq!(read_line(b"\xef\xbb\xbfx,y,z\n", None, true), Ok(InputLine::Header));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_column() {
        let wrong = |line: &[u8]| read_line(line, None, false).unwrap_err();
        for (line, column, part) in [
            (&b"x,y,z,dx,dy,dz"[..], 1, "for x"),
            (b"1,2,,0,0,1", 5, "--film-distance"),
            (b"1,2,3,0,0,", 11, "for dz, got \"\""),
            (&[b'1'; 20_000_000], 1, "got \"1111111111111111111111111111111111111111...\""),
            (b"1,2,3,0,0", 10, "for dz"),
            (b"1,2,3,0,0,1,ok", 13, "six"),
            (b"1, nan,3,0,0,1", 4, "finite"),
            (b"1,inf,3,0,0,1", 3, "finite"),
            (b"1,2,3,0,0,0", 1, "0,0,0"),
            (b"1,\xff,3,0,0,0", 3, "text"),
        ] {
            let (at, expected) = wrong(line);
            assert_eq!(at, column, "{expected}");
            assert!(expected.contains(part), "{expected}");
        }
        // Infinity is a number, so this line is not a header, although a ray cannot have infinite coordinates.
        assert!(read_line(b"inf,0,0,0,0,1", None, true).is_err());
    }

    #[test]
    fn seventeen_digits_bring_every_double_back() {
        let direction = [0.1, f64::MIN_POSITIVE / 3.0, -1.0 / 3.0];
        let ray = Ray { origin: [1e300, -0.0, 2.0_f64.sqrt()], direction };
        let mut line = Vec::new();
        LineFormat::Csv.write_ray(&mut line, ray, Some(Blocked::TurnedBack)).unwrap();
        let text = String::from_utf8(line).unwrap();
        let values = text.strip_suffix(",turned_back\n").unwrap();
        assert_eq!(read_line(values.as_bytes(), None, false), Ok(InputLine::Ray(ray)));
    }
}
