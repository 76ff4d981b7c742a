//! Random values for the parameters of the table; a new parameter of the table is varied automatically.

use std::ops::Bound::{Excluded, Included, Unbounded};

use ::realistic_camera::{Interval, Kind, Model, PARAMETERS, Parameter, Range};

/// Mean number of numeric parameters that are set, out of those that apply to a model.
const NUMBERS: f64 = 3.0;

/// Returns a model, and values for some of its parameters: names and numbers. The numbers are near the default, of any
/// magnitude in the parameter's range, or at the ends of the range. The caller provides free text, such as a lens's
/// name. `next` generates random numbers in [0, 1).
pub fn any_parameters(next: &mut impl FnMut() -> f64) -> Vec<(&'static str, String)> {
    let (name, model) = match next() {
        lens if lens < 0.4 => Model::NAMES[0],
        _ => *pick(&Model::NAMES, next),
    };
    let used = PARAMETERS.iter().filter(|row| row.models.contains(&model) && row.name != "model");
    let numbers = used.clone().filter(|row| matches!(row.range, Range::Numbers(_))).count();
    let mut given = vec![("model", name.to_owned())];
    for row in used {
        let (share, value) = match (&row.range, row.kind) {
            (Range::Names(names), _) => (0.6, (*pick(names, next)).to_owned()),
            (Range::Numbers(interval), kind) => {
                let count = if kind == Kind::Four { 4 } else { 1 };
                let mut value = || any_number(row, interval, next).to_string();
                let values: Vec<String> = (0..count).map(|_| value()).collect();
                (NUMBERS / numbers as f64, values.join(","))
            }
            (Range::Any, Kind::Bool) => (0.1, (next() < 0.5).to_string()),
            (Range::Any, _) => continue,
        };
        if next() < share {
            given.push((row.name, value));
        }
    }
    given
}

fn pick<'a, T>(choices: &'a [T], next: &mut impl FnMut() -> f64) -> &'a T {
    &choices[(next() * choices.len() as f64) as usize % choices.len()]
}

/// Returns a number in an interval.
fn any_number(row: &Parameter, interval: &Interval, next: &mut impl FnMut() -> f64) -> f64 {
    const TRIES: usize = 20;
    let ends = [interval.from, interval.to].map(|end| match end {
        Included(end) | Excluded(end) => end,
        Unbounded => f64::INFINITY,
    });
    let usual = row.default.parse::<f64>().ok().filter(|usual| *usual != 0.0).unwrap_or(1.0);
    for _ in 0..TRIES {
        let sign = if next() < 0.5 { -1.0 } else { 1.0 };
        let number = match next() {
            near if near < 0.3 => usual * 10_f64.powf(4.0 * next() - 2.0),
            whole if whole < 0.5 => sign * (32.0 * next()).round(),
            between if between < 0.6 => ends[0] + (ends[1] - ends[0]) * next(),
            anywhere if anywhere < 0.95 => sign * 10_f64.powf(78.0 * next() - 39.0),
            _ => *pick(&ends, next),
        };
        if interval.contains(number) {
            return number;
        }
    }
    usual
}
