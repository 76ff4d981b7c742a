//! Places the groups of a lens for a zoom and a focus: returns a prescription with its groups in position,
//! and with the resulting film distance.

use super::focusing::Focusing;
use crate::parameters::{CameraError, FocusBy, ParameterError, Parameters, Zoom};
use realistic_base::numeric::root;
use realistic_optics::{
    imaging::{
        focus::{AxialImage, Conjugates, FocusError},
        moving::{FocusTravel, MovingError, MovingGroups},
        open::OpenLens,
    },
    lens::{Lens, first_order::FirstOrder},
    prescription::Prescription,
};

/// Returns the prescription zoomed to `zoom`, or at its first position, and focused by its groups if
/// `focus_by` requests that. `set_up` makes a lens from a prescription at the wavelength and stop in use. If
/// the prescription has no positions, nothing moves.
pub(super) fn place_groups(
    prescription: Prescription,
    given: &Parameters,
    focusing: Focusing,
    set_up: impl Fn(&Prescription) -> Result<OpenLens, CameraError>,
) -> Result<Prescription, CameraError> {
    let Some(travel) = travel(&prescription, given, focusing)? else { return Ok(prescription) };
    if given.focus_by() == FocusBy::Group && given.film_distance.is_some() {
        return Err(CameraError::FilmStays);
    }
    match focus_distance(given)? {
        Some(distance) => GroupFocus::new(&travel, focusing, set_up)?.on(distance),
        None => Ok(travel.at(travel.start())),
    }
}

/// Returns the nearest and the farthest plane on which the groups of a lens can focus, by exact rays, at the
/// zoom `zoom`.
pub(super) fn reach(
    prescription: &Prescription,
    given: &Parameters,
    set_up: impl Fn(&Prescription) -> Result<OpenLens, CameraError>,
) -> Result<[Conjugates; 2], CameraError> {
    let no_focus = || MovingError::NoFocus { lens: prescription.name.clone() };
    let travel =
        travel(prescription, given, Focusing::Exact)?.filter(FocusTravel::is_known).ok_or_else(no_focus)?;
    GroupFocus::new(&travel, Focusing::Exact, set_up)?.reach()
}

/// Returns the travel of the groups during focusing, at `zoom` or at the first position; `None` if the groups
/// do not move. Returns an error if a lens that is to be focused by its groups has no moving groups.
fn travel(
    prescription: &Prescription,
    given: &Parameters,
    focusing: Focusing,
) -> Result<Option<FocusTravel>, CameraError> {
    let by_groups = given.focus_by() == FocusBy::Group;
    let lens = || prescription.name.clone();
    let groups = MovingGroups::of(prescription);
    // The film's position must not depend on the wavelength and stop in use.
    let image = |prescription: &Prescription, vergence: f64| {
        let image = FocusImage::of(OpenLens::new(Lens::at_own_wavelength(prescription)), focusing).ok()?;
        Some(image.distance(vergence)).filter(|distance| distance.is_finite())
    };
    let travel = match (&groups, &given.zoom) {
        (Some(groups), None) => Some(groups.position(0)),
        (Some(groups), Some(Zoom::FocalLength(focal_length))) => Some(groups.zoomed(*focal_length, image)?),
        (Some(groups), Some(Zoom::Position(name))) => Some(groups.named(name)?),
        (None, Some(_)) => return Err(MovingError::Prime { lens: lens() }.into()),
        (None, None) => None,
    };
    if by_groups && !travel.as_ref().is_some_and(FocusTravel::is_known) {
        return Err(MovingError::NoFocus { lens: lens() }.into());
    }
    Ok(travel)
}

/// Returns the distance at which the groups are focused, mm from the film; `None` if the groups do not focus
/// the lens or no distance is given.
pub(super) fn focus_distance(given: &Parameters) -> Result<Option<f64>, ParameterError> {
    let distance = given.focus_distance()?.filter(|_| given.focus_by() == FocusBy::Group);
    distance.map(|distance| Ok(distance * given.mm_per_unit()?)).transpose()
}

/// A lens that is focused by its groups, with its film fixed.
struct GroupFocus<'a, S> {
    travel: &'a FocusTravel,
    focusing: Focusing,
    set_up: S,
    /// Film distance to use if the lens table has none, mm.
    film: Option<f64>,
}

/// The images of points on a lens's axis.
struct FocusImage {
    first_order: FirstOrder,
    /// The image by exact rays; `None` for first-order optics.
    exact: Option<AxialImage>,
    /// Distance from the first vertex to the last, mm.
    length: f64,
}

impl FocusImage {
    fn of(optics: OpenLens, focusing: Focusing) -> Result<Self, CameraError> {
        let OpenLens { lens, first_order, beam } = optics;
        let exact = (focusing == Focusing::Exact).then(|| AxialImage::of(&lens, beam.entrance));
        if exact.is_some() && beam.is_dark() {
            return Err(FocusError::Dark { lens: lens.name }.into());
        }
        Ok(Self { first_order: first_order?, exact, length: -lens.rear().vertex })
    }

    /// Returns the distance from the last vertex to the image of the axial point that lies 1/`vergence` mm in
    /// front of the first vertex.
    fn distance(&self, vergence: f64) -> f64 {
        match &self.exact {
            Some(exact) => exact.best(vergence).distance,
            None => self.first_order.image_distance(vergence),
        }
    }

    /// Returns the signed distance by which the image of [`FocusImage::distance`] lies behind a film
    /// `film_distance` mm behind the last vertex, divided by the larger of the two distances (for a virtual
    /// image, by the image's distance). The result grows monotonically as the image moves from inside the
    /// lens through the film and infinity until it is a virtual image, whose bundles leave the lens
    /// diverging.
    fn beyond(&self, vergence: f64, film_distance: f64) -> f64 {
        let image = self.distance(vergence);
        let is_virtual = image < -self.length || vergence * self.first_order.front_focal_point > 1.0;
        if image > film_distance || is_virtual {
            1.0 - film_distance / image
        } else {
            image / film_distance - 1.0
        }
    }
}

impl<'a, S: Fn(&Prescription) -> Result<OpenLens, CameraError>> GroupFocus<'a, S> {
    fn new(travel: &'a FocusTravel, focusing: Focusing, set_up: S) -> Result<Self, CameraError> {
        let mut groups = Self { travel, focusing, set_up, film: None };
        let first = travel.at(travel.start());
        if first.nominal_film_distance.is_none() {
            // The film distance at which the lens in its first position images that position's object
            // sharply.
            let image = FocusImage::of((groups.set_up)(&first)?, focusing)?;
            groups.film = Some(image.distance(travel.start()));
        }
        Ok(groups)
    }

    /// Returns the lens at one focus position of [`FocusTravel`] (a vergence), with its image and its film
    /// distance.
    fn at(&self, position: f64) -> Result<(Prescription, FocusImage, f64), CameraError> {
        let mut prescription = self.travel.at(position);
        let image = FocusImage::of((self.set_up)(&prescription)?, self.focusing)?;
        let film = prescription.nominal_film_distance.or(self.film);
        // If the last gap of the table is closed, no film distance is known.
        let film_distance = film.unwrap_or_else(|| image.distance(position));
        prescription.nominal_film_distance = Some(film_distance);
        Ok((prescription, image, film_distance))
    }

    /// Returns the distance by which the image of the plane `distance` mm in front of the film lies behind
    /// the film, in the measure of [`FocusImage::beyond`].
    fn beyond_film(&self, position: f64, distance: f64) -> Result<f64, CameraError> {
        let (_, image, film_distance) = self.at(position)?;
        let object = distance - image.length - film_distance;
        // A plane inside the lens has no image on any film.
        Ok(if object > 0.0 { image.beyond(object.recip(), film_distance) } else { 1.0 })
    }

    /// Returns the planes in focus at the near and the far end of the travel.
    fn reach(&self) -> Result<[Conjugates; 2], CameraError> {
        let at = |position: f64| -> Result<Conjugates, CameraError> {
            let (_, image, film_distance) = self.at(position)?;
            let beyond = |vergence| image.beyond(vergence, film_distance);
            // The front focal point is imaged to infinity, if that point lies in front of the lens.
            let FirstOrder { front_focal_point: focal_point, focal_length, .. } = image.first_order;
            let end = if focal_point > 0.0 { focal_point.recip() } else { 1e3 / focal_length.abs() };
            let from_film = |vergence: f64| vergence.recip() + image.length + film_distance;
            let object_distance = match (beyond(0.0) >= 0.0, beyond(end) >= 0.0) {
                (true, _) => f64::INFINITY,
                (false, true) => from_film(root(0.0, end, beyond)),
                // Even a plane that touches the lens is not in focus.
                (false, false) => from_film(f64::INFINITY),
            };
            Ok(Conjugates { object_distance, film_distance })
        };
        let [far, near] = self.travel.range();
        Ok([at(near)?, at(far)?])
    }

    /// Returns the prescription with its groups focused on the plane `distance` mm in front of the film.
    fn on(&self, distance: f64) -> Result<Prescription, CameraError> {
        let [far, near] = self.travel.range();
        let beyond = |position| self.beyond_film(position, distance);
        if !(beyond(far)? >= 0.0 && beyond(near)? <= 0.0) {
            let [nearest, farthest] = self.reach()?.map(|ends| ends.object_distance);
            let lens = self.travel.at(far).name;
            return Err(MovingError::Unreachable { lens, distance, nearest, farthest }.into());
        }
        let position = root(far, near, |position| beyond(position).unwrap_or(f64::NAN));
        let (prescription, ..) = self.at(position)?;
        Ok(prescription)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::{
        imaging::{
            focus::Focus,
            open::{self, StopSize},
        },
        prescription::{Position, Positions, catalogue, read},
    };

    /// Returns a lens of the catalogue that focuses by moving as a whole, from infinity to half a metre in
    /// front of its first vertex.
    fn whole_lens(name: &str, film: f64) -> Prescription {
        let mut prescription = catalogue::find(name).expect("listed");
        let columns = [(film, None), (film + 6.0, Some(500.0))].map(|(film, object_distance)| Position {
            gaps: vec![film],
            object_distance,
            ..Position::default()
        });
        let last = prescription.interfaces.len() - 1;
        prescription.positions = Some(Positions { gaps: vec![last], columns: columns.to_vec() });
        prescription
    }

    /// US 4,392,724 (Y. Hamanishi, Nippon Kogaku 1983), example 1: a 105 mm f/2.8 lens with floating groups,
    /// which focuses down to 1 : 2.
    const MICRO: &str = "\
74.5 5 1.77279 37.9
-1042.7 0.15 1 37.4
29 5 1.717 34.8
57 2 1 33.3
91.28 2 1.7495 32.3
24.131 13.9866 1 28.6
-31.19 2 1.68893 27.1
300 10.5 1.7335 28.5
-41.983 1.5 1 30.3
0 1.5 1 29.3932
310.3 5 1.6935 29.5
-70.248 8.1258 1 29.1
-191.637 4 1.59507 24.3
-55.637 2 1 23.5
-114.216 1.8 1.79668 21.4
50.88 1.8 1 20.4
45.69 6 1.59507 20.0
-175.85 4.6 1 18.5
-38.545 2 1.80454 17.0
-77.213 43.1068 1 17.7
";

    /// Returns [`MICRO`] with the patent's two positions; the object distance of the second follows from first-order
    /// optics.
    fn micro() -> Prescription {
        let mut prescription = read("micro", MICRO.as_bytes()).expect("a lens");
        let columns = [(13.9866, 8.1258, None), (20.682, 34.3666, Some(254.996))];
        let columns = columns.map(|(front, rear, object_distance)| Position {
            gaps: vec![front, rear],
            object_distance,
            ..Position::default()
        });
        prescription.positions = Some(Positions { gaps: vec![5, 11], columns: columns.to_vec() });
        prescription
    }

    fn set_up(prescription: &Prescription) -> Result<OpenLens, CameraError> {
        Ok(open::set_up(prescription, 587.56, StopSize::FNumber(4.0), &mut |_, _| ())?)
    }

    fn given(parameters: &[(&str, &str)]) -> Parameters {
        let mut given = Parameters::default();
        for (name, text) in parameters {
            given.set_from_text(name, text).expect("in range");
        }
        given
    }

    fn placed(
        lens: &Prescription,
        parameters: &[(&str, &str)],
        focusing: Focusing,
    ) -> Result<Prescription, String> {
        place_groups(lens.clone(), &given(parameters), focusing, set_up).map_err(|error| error.to_string())
    }

    #[test]
    fn a_lens_that_moves_as_a_whole_is_focused_as_by_its_film() {
        for (name, film) in [("dgauss.50mm", 36.8), ("telephoto.250mm", 147.0)] {
            let lens = whole_lens(name, film);
            let OpenLens { lens: optics, first_order, beam } = set_up(&lens).expect("a lens");
            let first_order = first_order.expect("focal");
            let focus = Focus::of(&optics, first_order, &beam).expect("focal");
            let travel = MovingGroups::of(&lens).expect("positions").position(0);
            let films =
                travel.range().map(|position| travel.at(position).nominal_film_distance.expect("stated"));
            for share in [0.01, 0.2, 0.5, 0.77, 0.99] {
                let film = films[0] + (films[1] - films[0]) * share;
                for (focusing, distance) in [
                    (Focusing::Exact, focus.object_distance(film)),
                    (Focusing::Paraxial, first_order.object_distance(film)),
                ] {
                    let Some(distance) = distance.filter(|distance| distance.is_finite()) else { continue };
                    let requested = ("focus_distance", &*distance.to_string());
                    let found =
                        placed(&lens, &[("focus_by", "group"), requested], focusing).expect("in reach");
                    let found = found.nominal_film_distance.expect("placed");
                    assert!(
                        (found / film - 1.0).abs() < 1e-10,
                        "{name} at {distance}: {found} is not {film}"
                    );
                }
            }
        }
    }

    #[test]
    fn floating_groups_are_where_the_patent_has_them() {
        let lens = micro();
        let close = MovingGroups::of(&lens).expect("positions").position(0).at(1.0 / 254.996);
        let length: f64 = close.interfaces.iter().map(|interface| interface.thickness).sum();
        let distance = (254.996 + length + close.nominal_film_distance.expect("stated")).to_string();
        let requested = [("focus_by", "group"), ("focus_distance", &*distance)];
        // At f/4, exact rays are in focus slightly in front of the paraxial image, by a hundredth of the
        // travel of 26 mm.
        for (focusing, most) in [(Focusing::Paraxial, 1e-3), (Focusing::Exact, 0.26)] {
            let found = placed(&lens, &requested, focusing).expect("in reach");
            for row in [5, 11] {
                let off = found.interfaces[row].thickness - close.interfaces[row].thickness;
                assert!(off.abs() < most, "{focusing:?}, row {row}: {off} mm off");
            }
            assert_eq!(found.nominal_film_distance, Some(43.1068), "the film stays");
        }
    }

    #[test]
    fn floating_groups_focus_at_any_distance_to_rounding() {
        let lens = micro();
        let mut gaps = Vec::new();
        for distance in [f64::INFINITY, 1e7, 30_000.0, 4000.0, 1234.5, 700.0, 500.0, 420.0, 403.5] {
            let requested = [("focus_by", "group"), ("focus_distance", &*distance.to_string())];
            let found = placed(&lens, &requested, Focusing::Exact).expect("in reach");
            let OpenLens { lens: optics, beam, .. } = set_up(&found).expect("a lens");
            let object = distance + optics.rear().vertex - 43.1068;
            let image = AxialImage::of(&optics, beam.entrance).best(object.recip()).distance;
            assert!((image - 43.1068).abs() < 1e-10, "{distance}: image {image}");
            gaps.push(found.interfaces[11].thickness);
        }
        assert!(gaps.is_sorted_by(|far, near| far < near), "{gaps:?}");
    }

    #[test]
    fn without_a_distance_the_groups_have_the_tables_positions() {
        let lens = whole_lens("dgauss.50mm", 36.8);
        for parameters in [&[("focus_by", "group")][..], &[("focus_by", "film")], &[]] {
            assert_eq!(placed(&lens, parameters, Focusing::Exact).unwrap().nominal_film_distance, Some(36.8));
        }
    }

    #[test]
    fn an_impossible_request_is_refused_with_a_possible_one() {
        let lens = whole_lens("dgauss.50mm", 36.5);
        let refused = |lens: &Prescription, parameters: &[(&str, &str)]| {
            placed(lens, parameters, Focusing::Exact).expect_err("refused")
        };
        let near = refused(&lens, &[("focus_by", "group"), ("focus_distance", "100")]);
        assert!(near.contains("reaches from ") && near.contains("to infinity"), "{near}");
        let film = refused(&lens, &[("focus_by", "group"), ("film_distance", "40")]);
        assert!(film.contains("\"film_distance\" moves the film"), "{film}");
        assert!(refused(&lens, &[("zoom", "35")]).contains("one focal length"));
        let fixed = catalogue::find("dgauss.50mm").expect("listed");
        assert!(refused(&fixed, &[("zoom", "wide")]).contains("one focal length"));
        assert!(refused(&fixed, &[("focus_by", "group")]).contains("no positions for near objects"));
        // The film distance is too short for the lens: even at the end of the travel, infinity is imaged
        // behind the film.
        let short = whole_lens("dgauss.50mm", 20.0);
        let short = refused(&short, &[("focus_by", "group"), ("focus_distance", "inf")]);
        assert!(short.contains("reaches from "), "{short}");
    }

    #[test]
    fn columns_that_do_not_pair_leave_the_first() {
        let mut lens = whole_lens("dgauss.50mm", 36.8);
        lens.positions.as_mut().expect("positions").columns.swap(0, 1);
        let found = placed(&lens, &[], Focusing::Exact).expect("the first position");
        assert_eq!(found.nominal_film_distance, Some(42.8));
        let refused = placed(&lens, &[("focus_by", "group")], Focusing::Exact).expect_err("no way");
        assert!(refused.contains("no positions for near objects"), "{refused}");
    }
}
