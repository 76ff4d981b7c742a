//! FlareSim text (`.lens`), the format of the largest open collection of lenses from patents. It has `name:`,
//! `focal_length:`, `surfaces:`, and a row for each surface. A row has six values: the radius (0 for a plane, `stop`
//! for the stop), the thickness, the index behind the surface, the V-number behind the surface, the size, and the
//! number of coating layers.
//!
//! The column of sizes is called semi-aperture, but most files have *diameters* in it. The sizes are read as diameters
//! if, read as semi-diameters, they would let neighbours cross or would exceed a radius. A remark states which reading
//! is used.
//!
//! No file states the materials of the layers. On surfaces between air and glass, one layer is read as a quarter wave,
//! two layers as the V-coat, and more layers as the three-layer broadband coating.

use super::{
    ledger::Ledger,
    surface_rows::{self, Role, SurfaceRow},
    text::{Cell, Location, Text, no_number, words},
};
use crate::prescription::{
    Fate, LensFileError,
    coating::{Coating, SurfaceCoating},
    interfaces::{Medium, Prescription, Stated, has_coating},
};

const COLUMNS: &str = "a row has six values: radius, thickness, index, V-number, semi-aperture, coating";

/// The reason recorded when a number of layers is read as a coating.
const COATED: &str = "the number of a coating's layers is taken for a coating that has as many";

/// Reads a lens from a text.
///
/// # Errors
/// The text is not a lens; the error gives the first location at which it is malformed.
pub(super) fn read(text: &Text<'_>, ledger: &mut Ledger<'_>) -> Result<Prescription, LensFileError> {
    let (mut title, mut stated_focal_length) = (None, None);
    let mut rows: Vec<SurfaceRow> = Vec::new();
    let mut locations: Vec<Location> = Vec::new();
    let mut layers: Vec<u32> = Vec::new();
    let mut in_surfaces = false;
    for (number, line) in text.lines() {
        let data = line.split('#').next().unwrap_or("");
        let cells = words(number, data);
        let Some(first) = cells.first() else { continue };
        match data.trim().split_once(':') {
            Some(("name", name)) => {
                let plain = name.chars().filter(|c| !c.is_control()).collect::<String>();
                title = Some(plain.trim().to_owned()).filter(|name| !name.is_empty());
            }
            Some(("focal_length", length)) => {
                let length = length.trim();
                let number = length.parse().ok().filter(|length: &f64| length.is_finite());
                let expected = "a focal length in mm";
                stated_focal_length =
                    Some(number.ok_or_else(|| text.error(first.location, no_number(length, expected)))?);
            }
            Some(("surfaces", _)) => in_surfaces = true,
            _ if in_surfaces => {
                locations.push(first.location);
                let (row, coating) = row(text, &cells)?;
                rows.push(row);
                layers.push(coating);
            }
            _ => return Err(text.error(first.location, "expected name:, focal_length: or surfaces:")),
        }
    }
    let Some(last) = rows.len().checked_sub(1) else {
        let location = Location { line: text.lines().count(), column: 1 };
        return Err(text.error(location, "no rows behind surfaces:; expected at least one surface"));
    };
    let are_diameters = cross(&rows);
    if !are_diameters {
        rows.iter_mut().for_each(|row| row.diameter *= 2.0);
    }
    let at = |row: usize, message: &str| text.error(locations[row], message);
    let mut interfaces = surface_rows::interfaces(&rows, Medium::Air, &at, ledger)?;
    surface_rows::film_in_air(&interfaces, &at)?;
    let coatings: Vec<Coating> = has_coating(Medium::Air, &interfaces)
        .zip(&layers)
        .map(|(is_in_air, count)| match count {
            1 if is_in_air => Coating::QuarterWave,
            2 if is_in_air => Coating::VCoat,
            3.. if is_in_air => Coating::ThreeLayer,
            _ => Coating::Bare,
        })
        .collect();
    let is_coated = coatings.iter().any(|coating| *coating != Coating::Bare);
    let back = std::mem::take(&mut interfaces[last].thickness);
    let sizes = match are_diameters {
        true => "the column of semi-apertures holds diameters: as semi-apertures neighbours would cross",
        false => "the column of semi-apertures is taken for semi-apertures, with which no neighbours cross",
    };
    ledger.warn(Fate::Replaced, locations[0], "row", None, sizes);
    for (location, layers) in locations.iter().zip(&layers) {
        if *layers > 0 {
            ledger.note(Fate::Replaced, *location, "row", None, COATED);
        }
    }
    let is_row = |line: usize| locations.iter().any(|location| location.line == line);
    ledger.use_open(|line, word| Some(if is_row(line) { "row" } else { word }));
    Ok(Prescription {
        title,
        nominal_film_distance: (back > 0.0).then_some(back),
        stated_focal_length: stated_focal_length.filter(|length| *length > 0.0),
        stated: Stated::default(),
        coatings: is_coated.then(|| coatings.into_iter().map(SurfaceCoating::from).collect()),
        ..Prescription::new(interfaces)
    })
}

/// Reads one row. Returns the surface row, whose diameter is the size as written, and the number of coating layers.
fn row(text: &Text<'_>, cells: &[Cell<'_>]) -> Result<(SurfaceRow, u32), LensFileError> {
    let [radius, thickness, index, abbe, size, coating] = cells else {
        let message = format!(
            "{} value(s); {COLUMNS}, and cylinders, toroids and aspheres have others, which are not read",
            cells.len()
        );
        return Err(text.error(cells[0].location, message));
    };
    let is_stop = radius.is("stop");
    let curved = if is_stop { 0.0 } else { text.number(radius, "a radius in mm, 0 for a plane, or stop")? };
    let n_d = surface_rows::index(text.number(index, "a refractive index")?)
        .map_err(|why| text.error(index.location, format!("{why}; air has 1")))?;
    let abbe = Some(text.number(abbe, "a V-number, or 0 where there is none")?).filter(|abbe| *abbe > 0.0);
    let layers = coating.text.parse().map_err(|_| {
        text.error(coating.location, no_number(coating.text, "a count of layers, 0 for a bare surface"))
    })?;
    let row = SurfaceRow {
        radius: if curved == 0.0 { f64::INFINITY } else { curved },
        role: if is_stop { Role::Stop } else { Role::Any },
        thickness: text.number(thickness, "a thickness in mm")?,
        behind: n_d.map_or(Medium::Air, |n_d| Medium::Glass { n_d, abbe }).into(),
        diameter: text.number(size, "a semi-aperture in mm")?,
        asphere: None,
        apertures: Vec::new(),
        general: Default::default(),
    };
    Ok((row, layers))
}

/// Returns whether sizes, read as semi-diameters, exceed a radius or let two neighbours that are not stops cross.
fn cross(rows: &[SurfaceRow]) -> bool {
    let sagitta = |row: &SurfaceRow, height: f64| {
        let c = row.radius.recip();
        c * height * height / (1.0 + (1.0 - (c * height).powi(2)).max(0.0).sqrt())
    };
    let mut before: Option<&SurfaceRow> = None;
    let mut distance = 0.0;
    for row in rows {
        if row.diameter > row.radius.abs() {
            return true;
        }
        if row.role == Role::Any {
            if let Some(before) = before {
                let height = before.diameter.min(row.diameter);
                if distance + sagitta(row, height) - sagitta(before, height) < 0.0 {
                    return true;
                }
            }
            (before, distance) = (Some(row), 0.0);
        }
        distance += row.thickness;
    }
    false
}

#[cfg(test)]
mod tests {
    use crate::prescription::{Coating, Medium, SurfaceCoating, read};

    /// Returns a thick biconvex lens and a stop with the given sizes.
    fn lens(sizes: [f64; 3]) -> String {
        let [first, second, stop] = sizes;
        format!(
            "# patent\nname: Made up\nfocal_length: 20.5\n\nsurfaces:\n# radius thickness ior abbe semi_ap coating\n\
             20 5 1.5168 64.17 {first} 1\n-20 2 1.0 0 {second} 0\nstop 18 1 0 {stop} 0\n"
        )
    }

    #[test]
    fn sizes_are_diameters_where_semi_diameters_would_cross() {
        // The gap at a height h is 5 - 2 (20 - sqrt(400 - h²)), which is 0 at h = 9.68.
        for (size, semi_diameter) in [(9.6, 9.6), (9.7, 4.85), (19.0, 9.5)] {
            let read = read("lens", lens([size, size, 4.0]).as_bytes()).expect("a lens");
            assert_eq!(read.interfaces[0].semi_diameter, semi_diameter, "{size}");
            assert_eq!(read.interfaces[0].medium, Medium::Glass { n_d: 1.5168, abbe: Some(64.17) });
            assert_eq!((read.stop_index(), read.nominal_film_distance), (Some(2), Some(18.0)));
            assert_eq!((read.title.as_deref(), read.stated_focal_length), (Some("Made up"), Some(20.5)));
            assert!(read.coatings.as_ref().is_some_and(|own| !own[0].is_bare() && own[1].is_bare()));
            let words = if semi_diameter < size { "holds diameters" } else { "taken for semi-apertures" };
            assert!(read.remarks.iter().any(|remark| remark.contains(words)), "{:?}", read.remarks);
        }
    }

    #[test]
    fn a_count_of_layers_is_a_coating_where_glass_meets_air() {
        let coatings = |first: &str, second: &str| {
            let text = lens([4.0; 3]).replace("4 1\n", &format!("4 {first}\n"));
            let text =
                text.replace("0 4 0\nstop", &format!("0 4 {second}\nstop")).replace("1 0 4 0\n", "1 0 4 1\n");
            read("lens", text.as_bytes()).expect("a lens").coatings
        };
        assert_eq!(coatings("0", "0"), None, "the stop has none");
        let [one, two, three] = ["1", "2", "7"].map(|count| coatings(count, "3").expect("coated"));
        assert_eq!(one, [Coating::QuarterWave, Coating::ThreeLayer, Coating::Bare].map(SurfaceCoating::from));
        assert_eq!((&two[0], &three[0]), (&Coating::VCoat.into(), &Coating::ThreeLayer.into()));
    }

    #[test]
    fn a_malformed_row_is_reported_with_its_location() {
        let refused = |text: &str, words: &str| {
            let error = read("lens", text.as_bytes()).expect_err(words).to_string();
            assert!(error.contains(words), "{error}");
        };
        let right = lens([4.0; 3]);
        refused(&right.replace("20 5 1.5168", "20 cyl_y 5 1.5168"), "lens:7:1: 7 value(s)");
        refused(&right.replace("20 5", "20 x"), "lens:7:4: \"x\" is not a number");
        refused(
            &right.replace("4 1\n", "4 MgF2\n"),
            "lens:7:21: \"MgF2\" is not a number; expected a count of layers",
        );
        refused(&right.replace("1.5168", "0.5"), "a refractive index is 1 or more");
        refused("name: x\nsurfaces:\n", "no rows behind surfaces:");
        refused(&right.replace("20.5", "long"), "a focal length in mm");
        refused(&right.replace("name: Made up", "maker: me"), "lens:2:1: expected name:");
    }
}
