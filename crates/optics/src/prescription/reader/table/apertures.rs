//! Lines `aperture ROW SHAPE …` and `obstruction ROW SHAPE …`: the apertures of rows that are not round, and what
//! stands in the way of rays.

use super::lines::{Line, Lines};
use crate::prescription::{
    Aperture, LensFileError, MAX_INTERFACES, MAX_VERTICES, Outline,
    reader::{surface_rows::SurfaceRow, text::Cell},
};

const FORM: &str = "an aperture is: aperture ROW circle R, ellipse RX RY, rectangle HX HY (half widths), ring INNER OUTER, or polygon X Y \
     X Y X Y …, in mm, then x=… y=… rotation=… (mm and degrees; 0 where left out); obstruction instead of aperture for \
     a part that stops rays";

/// The names of the constants of a line.
const NAMES: [&str; 3] = ["x", "y", "rotation"];

/// The word that states a row, and the row's aperture with lengths in mm.
pub(super) type ApertureLine<'t> = (Cell<'t>, Aperture);

/// Takes the lines of apertures and obstructions out of `lines`.
pub(super) fn take<'t>(lines: &mut Lines<'t>) -> Result<Vec<ApertureLine<'t>>, LensFileError> {
    let taken = lines.take(&["aperture", "obstruction"]);
    lines.at_most(&taken, MAX_INTERFACES, "a lens has at most as many apertures as interfaces")?;
    let mut found = Vec::with_capacity(taken.len());
    for line in &taken {
        read(lines, line, &mut found)?;
    }
    Ok(found)
}

/// Reads one line; a ring becomes an aperture and an obstruction.
fn read<'t>(
    lines: &Lines<'t>,
    line: &Line<'t>,
    found: &mut Vec<ApertureLine<'t>>,
) -> Result<(), LensFileError> {
    let [keyword, row, shape, values @ ..] = line.as_slice() else {
        return Err(lines.error(&line[0], FORM));
    };
    let count = values.iter().position(|word| word.text.contains('=')).unwrap_or(values.len());
    let (sizes, constants) = values.split_at(count);
    let constants = lines.constants(constants, &NAMES.map(str::to_owned), "x=1.5", FORM)?;
    let [x, y, rotation] = [0, 1, 2].map(|index| constants[index].unwrap_or(0.0));
    let is_obstruction = keyword.is("obstruction");
    let mut add = |outline: Outline, is_obstruction: bool| {
        found.push((*row, Aperture { outline, center: [x, y], rotation, is_obstruction }));
    };
    let size = |word: &Cell<'_>| {
        let number = lines.number(word, "a length in mm")?;
        if number > 0.0 {
            Ok(number)
        } else {
            Err(lines.error(word, &format!("\"{word}\" is not above 0; {FORM}")))
        }
    };
    match sizes {
        [radius] if shape.is("circle") => add(Outline::Ellipse([size(radius)?; 2]), is_obstruction),
        [x, y] if shape.is("ellipse") => add(Outline::Ellipse([size(x)?, size(y)?]), is_obstruction),
        [x, y] if shape.is("rectangle") => add(Outline::Rectangle([size(x)?, size(y)?]), is_obstruction),
        [inner, outer] if shape.is("ring") && !is_obstruction => {
            let radii = [size(inner)?, size(outer)?];
            if radii[0] >= radii[1] {
                return Err(
                    lines.error(outer, &format!("the ring's outer radius is not above the inner; {FORM}"))
                );
            }
            add(Outline::Ellipse([radii[1]; 2]), false);
            add(Outline::Ellipse([radii[0]; 2]), true);
        }
        numbers if shape.is("polygon") => {
            let (points, rest) = numbers.as_chunks::<2>();
            if let [odd] = rest {
                return Err(lines.error(odd, &format!("the vertex of x {odd} has no y; {FORM}")));
            }
            if !(3..=MAX_VERTICES).contains(&points.len()) {
                let message =
                    format!("a polygon has 3 to {MAX_VERTICES} vertices, not {}; {FORM}", points.len());
                return Err(lines.error(shape, &message));
            }
            let vertex = |[x, y]: &[Cell<'_>; 2]| {
                Ok([lines.number(x, "a vertex in mm")?, lines.number(y, "a vertex in mm")?])
            };
            let vertices = points.iter().map(vertex).collect::<Result<Vec<_>, LensFileError>>()?;
            add(Outline::Polygon(vertices.into()), is_obstruction);
        }
        _ => return Err(lines.error(shape, &format!("\"{shape}\" with {count} numbers is no shape; {FORM}"))),
    }
    Ok(())
}

/// Gives the apertures to their rows.
pub(super) fn give(
    lines: &Lines<'_>,
    apertures: Vec<ApertureLine<'_>>,
    rows: &mut [SurfaceRow],
) -> Result<(), LensFileError> {
    for (word, aperture) in apertures {
        let row = lines.row_number(&word, rows.len(), FORM)?;
        rows[row].apertures.push(aperture);
    }
    Ok(())
}
