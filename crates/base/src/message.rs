//! Messages for people: their severity, and the formatting of names, numbers, suggestions for misspelt names and
//! truncated text from outside the program. Numbers have few digits. The minimum of a range is rounded up, so that the
//! printed minimum lies inside the range.

use std::{borrow::Cow, collections::HashMap, fmt::Display};

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Information.
    Info,
    /// The camera is built, but differs from the request.
    Warning,
    /// The camera is not built.
    Error,
}

/// A function that receives messages.
pub type Log<'a> = &'a mut dyn FnMut(Level, &str);

/// Merges the warnings about one lens that differ only in line number and numeric values. Keeps the first warning of
/// each kind, in order, and appends the line numbers of the others to it.
pub fn folded(warnings: &[String]) -> Vec<String> {
    let mut kinds: Vec<Vec<&String>> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    for warning in warnings {
        let kind = *known.entry(without_numbers(warning)).or_insert_with(|| {
            kinds.push(Vec::new());
            kinds.len() - 1
        });
        kinds[kind].push(warning);
    }
    let one = |alike: Vec<&String>| {
        let (first, others) = alike.split_first().expect("a kind has its first");
        let lines: Vec<&str> = others.iter().filter_map(|warning| line_of(warning)).collect();
        let at = if lines.is_empty() {
            String::new()
        } else {
            format!(", on {}", counted("line", "lines", &lines))
        };
        match others.len() {
            0 => (*first).clone(),
            1 => format!("{first} (and one more such warning{at})"),
            more => format!("{first} (and {more} more such warnings{at})"),
        }
    };
    kinds.into_iter().map(one).collect()
}

/// Lists the first dozen items in a sentence: `1, 2, 3 and 9 more`.
pub fn some_of<T: Display>(items: &[T]) -> String {
    const MOST: usize = 12;
    let shown: Vec<String> = items.iter().take(MOST).map(T::to_string).collect();
    let more = items.len() - shown.len();
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// Returns the word `singular` or `plural`, whichever suits the number of items, followed by [`some_of`] the items:
/// `surfaces 1, 2 and 3`.
pub fn counted<T: Display>(singular: &str, plural: &str, items: &[T]) -> String {
    format!("{} {}", if items.len() == 1 { singular } else { plural }, some_of(items))
}

/// Replaces each number with `0`. Digits within a name, such as a glass's, stay.
fn without_numbers(text: &str) -> String {
    let is_part = |c: char| c.is_alphanumeric() || c == '.';
    let (mut words, mut before, mut is_number) = (String::with_capacity(text.len()), ' ', false);
    for c in text.chars() {
        if is_part(c) && !is_part(before) {
            is_number = c.is_ascii_digit();
            words.extend(is_number.then_some('0'));
        }
        words.extend((!is_number || !is_part(c)).then_some(c));
        before = c;
    }
    words
}

/// Returns the line number of a warning that begins with its position, `file:line:column: `.
fn line_of(warning: &str) -> Option<&str> {
    let mut parts = warning.split(": ").next()?.rsplit(':');
    let (_, line) = (parts.next()?, parts.next()?);
    Some(line).filter(|line| !line.is_empty() && line.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Joins names into a list of alternatives for a sentence: `"a", "b" or "c"`.
pub fn quoted(names: &[&str]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    match &names[..] {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => names.concat(),
    }
}

/// Truncates text from outside the program, which may have any length, to 40 characters.
pub fn cut(text: &str) -> String {
    const MOST: usize = 40;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Makes a text safe for a terminal: control characters are written as escapes such as `\u{1b}`. Line ends and tabs
/// stay.
pub fn printable(text: &str) -> Cow<'_, str> {
    let is_escaped = |letter: char| letter.is_control() && !matches!(letter, '\n' | '\t');
    if !text.contains(is_escaped) {
        return text.into();
    }
    let escaped = |letter: char| {
        if is_escaped(letter) { letter.escape_unicode().to_string() } else { letter.to_string() }
    };
    text.chars().map(escaped).collect::<String>().into()
}

/// Makes a message safe for a host: makes it printable, and removes the middle of a message that is too long to read. A
/// message may quote outside text of any length.
pub fn bounded(text: &str) -> Cow<'_, str> {
    const MOST: usize = 4000;
    const END: usize = 800;
    if text.len() <= MOST {
        let printable = printable(text);
        // Escapes are longer than the characters that they replace.
        return if printable.len() <= MOST { printable } else { bounded(&printable).into_owned().into() };
    }
    let start = &text[..text.floor_char_boundary(MOST - END)];
    let end = &text[text.ceil_char_boundary(text.len() - END)..];
    let short = format!("{start} ... {end}");
    match printable(&short) {
        Cow::Borrowed(_) => short.into(),
        Cow::Owned(printable) => bounded(&printable).into_owned().into(),
    }
}

/// Returns the end of a message about an unknown name. Suggests the nearest known name or, if no name is near, lists
/// all known names.
pub fn nearest_or_all(given: &str, names: &[&str]) -> String {
    match nearest(given, names.iter().copied()) {
        Some(name) => format!("did you mean \"{name}\"?"),
        None => format!("the names are {}", names.join(", ")),
    }
}

/// Returns the name that a misspelt name probably means: the first name that needs the fewest edits (letters omitted,
/// inserted, changed or swapped), if the number of edits is less than a third of the number of letters. A name of three
/// letters allows no edit, because nearly any word of three letters is one edit away from another.
pub fn nearest<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let given: Vec<char> = given.chars().take(64).map(|letter| letter.to_ascii_lowercase()).collect();
    let near = names.into_iter().filter_map(|name| {
        let edits = edit_distance(&given, name);
        (3 * edits < given.len().max(name.len())).then_some((edits, name))
    });
    near.min_by_key(|(edits, _)| *edits).map(|(_, name)| name)
}

/// Returns the edit distance of F. J. Damerau 1964: the number of letters to omit, insert, change or swap with the next
/// letter. The distance is computed row by row.
fn edit_distance(given: &[char], name: &str) -> usize {
    let name: Vec<char> = name.chars().collect();
    let (mut above, mut row) = (Vec::new(), (0..=given.len()).collect::<Vec<usize>>());
    for (i, letter) in name.iter().enumerate() {
        let mut next = vec![i + 1];
        for (j, own) in given.iter().enumerate() {
            let changed = row[j] + usize::from(own != letter);
            let mut least = changed.min(row[j + 1] + 1).min(next[j] + 1);
            if i > 0 && j > 0 && *own == name[i - 1] && given[j - 1] == *letter {
                least = least.min(above[j - 1] + 1);
            }
            next.push(least);
        }
        (above, row) = (row, next);
    }
    row[given.len()]
}

/// Writes a number as the user gave it. A number that single precision represents exactly has the digits of single
/// precision; a number longer than 24 characters is written with a power of ten.
pub fn as_given(number: f64) -> String {
    let single = number as f32;
    let plain = if f64::from(single) == number { single.to_string() } else { number.to_string() };
    if plain.len() > 24 { format!("{number:e}") } else { plain }
}

/// Writes a number with the given number of decimals. A number that would show only zeros, or is at least 1e12, is
/// written with a power of ten. Values below 1e-12 are rounding errors and are written as 0.
pub fn fixed(number: f64, digits: usize) -> String {
    let size = number.abs();
    let least = 0.5 * 0.1_f64.powi(digits as i32);
    let has_power = (1e-12..least).contains(&size) || size >= 1e12 && size.is_finite();
    if has_power { format!("{number:.4e}") } else { format!("{number:.digits$}") }
}

/// Writes a number with at most six significant digits. A number below 1e-4, or of 1e7 or more, has a power of ten.
pub fn short(number: f64) -> String {
    written(rounded(number))
}

/// Writes a positive number as [`short`] does, but rounded up, so that the printed minimum of a range lies inside the
/// range.
pub fn short_above(number: f64) -> String {
    // Rounding changes the number by at most half a unit of the last digit, which is at most 5e-6 of the number.
    let mut nudged = (0..=6).map(|step: u8| rounded(number * (1.0 + 1e-6 * f64::from(step))));
    written(nudged.find(|rounded| *rounded >= number).unwrap_or(number))
}

fn rounded(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

fn written(number: f64) -> String {
    let is_plain = number == 0.0 || !number.is_finite() || (1e-4..1e7).contains(&number.abs());
    if is_plain { number.to_string() } else { format!("{number:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_numbers_keep_six_digits_and_round_ones_stay() {
        for (number, text) in [
            (237.983_410_372_1, "237.983"),
            (-0.051_234_567, "-0.0512346"),
            (17.1, "17.1"),
            (f64::from(0.1_f32), "0.1"),
            (250.0, "250"),
            (0.0, "0"),
            (1e300, "1e300"),
            (1.234_567_89e-7, "1.23457e-7"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(number), text);
        }
    }

    #[test]
    fn many_equal_warnings_are_one_with_their_number_and_lines() {
        let alike =
            |line: usize| format!("a.zmx:{line}:3: surface {} has no size; {}.25 is used", line / 4, line);
        let other = "a.zmx: glass F4 is another's".to_owned();
        let mut warnings: Vec<String> = (1..=16).map(|i| alike(4 * i)).collect();
        warnings.insert(3, other.clone());
        let [first, second] = &folded(&warnings)[..] else { panic!("{:?}", folded(&warnings)) };
        let lines = "8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52 and 3 more";
        assert_eq!(*first, format!("{} (and 15 more such warnings, on lines {lines})", alike(4)));
        assert_eq!(*second, other);
        assert_eq!(
            folded(&[alike(4), alike(8)]),
            [format!("{} (and one more such warning, on line 8)", alike(4))]
        );
        assert_eq!(folded(&vec![other.clone(); 3]), [format!("{other} (and 2 more such warnings)")]);
        // Digits in a name belong to the name.
        let names = ["a: glass F4", "a: glass F5", "a: N-BK7 1.5e-4", "a: N-BK10 1.5e-4"].map(str::to_owned);
        assert_eq!(folded(&names), names);
        assert_eq!(folded(&["1e5 mm".into(), "1.25e-3 mm".into(), "2.5e7 mm".into()]).len(), 2);
        assert_eq!(folded(&[]), [""; 0]);
    }

    #[test]
    fn names_are_offered_as_a_sentence_does() {
        let offers = [&["a"][..], &["a", "b"], &["a", "b", "c"]].map(quoted);
        assert_eq!(offers, ["\"a\"", "\"a\" or \"b\"", "\"a\", \"b\" or \"c\""]);
    }

    #[test]
    fn numbers_that_were_given_are_never_longer_than_a_line() {
        let texts = [1e308, -1e-300, 0.1, 123_456.789, 50.0, f64::from(0.1_f32)].map(as_given);
        assert_eq!(texts, ["1e308", "-1e-300", "0.1", "123456.789", "50", "0.1"]);
    }

    #[test]
    fn numbers_in_columns_are_never_zeros_alone() {
        let texts =
            [36.132_458, 1e-9, -0.000_04, 0.000_06, 1e-17, -0.0, 1e308, 20_224.938].map(|x| fixed(x, 4));
        assert_eq!(
            texts,
            ["36.1325", "1.0000e-9", "-4.0000e-5", "0.0001", "0.0000", "-0.0000", "1.0000e308", "20224.9380"]
        );
    }

    #[test]
    fn a_long_text_is_cut_between_two_letters() {
        assert_eq!(cut("dgauss.50mm"), "dgauss.50mm");
        assert_eq!(cut(&"ä".repeat(40)), "ä".repeat(40));
        assert_eq!(cut(&"ä".repeat(900_000)), format!("{}...", "ä".repeat(40)));
    }

    #[test]
    fn a_long_message_keeps_its_beginning_and_its_end() {
        assert_eq!(bounded("short"), "short");
        let long = format!("lens \"{}\": what to do", "ä".repeat(50_000_000));
        let text = bounded(&long);
        assert!(text.len() <= 4005, "{}", text.len());
        assert!(text.starts_with("lens \"ää") && text.ends_with("ää\": what to do"), "{text}");
    }

    #[test]
    fn the_nearest_name_is_a_few_letters_away_or_none() {
        let near = |given: &str| nearest(given, ["focus_distance", "film_distance", "fov", "fnumber", "yon"]);
        assert_eq!(near("focusdistnace"), Some("focus_distance"));
        assert_eq!(near("FilmDistance"), Some("film_distance"));
        assert_eq!(near("focus_distance"), Some("focus_distance"));
        assert_eq!([near("fnubmer"), near("fov2")], [Some("fnumber"), Some("fov")]);
        assert_eq!([near("exposure"), near(""), near("xy"), near("foo"), near("fo")], [None; 5]);
        assert_eq!(near("yon"), Some("yon"));
        assert_eq!(near(&"f".repeat(1_000_000)), None);
    }

    #[test]
    fn rounding_up_never_rounds_down() {
        assert_eq!(short_above(237.983_410_372_1), "237.984");
        assert_eq!(short_above(250.0), "250");
        for i in 1..2000 {
            let number = 1e-3 * f64::from(i).powf(1.7);
            let above: f64 = short_above(number).parse().expect("a number");
            assert!(above >= number && above <= number * (1.0 + 1e-5), "{number}: {above}");
        }
    }
}
