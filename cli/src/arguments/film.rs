//! The film: its pixels, and its size if the user gives none.

use realistic_base::message::short;
use realistic_camera::{Film, Host, Level, Parameters, Raster, film_distance, open_lens};
use realistic_optics::lens::{Lens, first_order::FirstOrder};
use realistic_optics::prescription::Prescription;
use realistic_trace::field::Field;
use std::fmt::{self, Display};

/// The film's pixels.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct FilmSize {
    /// Size of the film, in pixels
    #[arg(long, value_name = "WxH", default_value = "480x320", value_parser = super::size)]
    size: [u32; 2],
}

impl FilmSize {
    /// Returns the pixels.
    pub fn raster(self) -> Raster {
        let [xres, yres] = self.size;
        Raster { xres, yres }
    }

    /// Returns the film of this diagonal, mm.
    pub fn film(self, diagonal: f64) -> Film {
        Film::new(self.raster(), diagonal)
    }
}

/// The film that a lens's own image fills. It depends on the lens at its first position, wide open and focused at
/// infinity, so stopping down or focusing nearer does not change it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnFilm {
    /// Diagonal, mm.
    pub diagonal: f64,
    reason: Reason,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Reason {
    /// The lens's file states this full field of view, degrees.
    Stated(f64),
    /// The film fills the image circle, outside of which there is no light.
    Circle,
    /// The image is larger than this film.
    Default,
}

impl Display for OwnFilm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "film diagonal {} mm: ", short(self.diagonal))?;
        match self.reason {
            Reason::Stated(field) => {
                write!(f, "the image of the {} degrees that the lens file states", short(field))
            }
            Reason::Circle => write!(f, "the lens's image circle"),
            Reason::Default => write!(f, "the default"),
        }?;
        write!(f, " (--film-diagonal MM gives another)")
    }
}

impl OwnFilm {
    /// Description of the default film, the result of [`OwnFilm::of`], in words.
    pub const IN_WORDS: &str =
        "that of the lens's own image, by the field that its file states or by its image circle, else 35";

    /// The library's film.
    pub const DEFAULT: Self = Self { diagonal: 35.0, reason: Reason::Default };

    /// Returns the film for the lens of these parameters; `None` if there is no such lens.
    pub fn of(given: &Parameters, host: &Host) -> Option<Self> {
        let Parameters { lens_file, glass_catalog, .. } = given.clone();
        let alone = Parameters { lens_file, glass_catalog, ..Parameters::default() };
        let (prescription, lens) = open_lens(&alone, host, &mut |_: Level, _: &str| ()).ok()?;
        Some(Self::of_lens(&prescription, &lens).unwrap_or(Self::DEFAULT))
    }

    /// Whether the film is also the library's default.
    pub fn is_default(&self) -> bool {
        *self == Self::DEFAULT
    }

    /// Returns the film for a lens; `None` if the lens makes no image.
    fn of_lens(prescription: &Prescription, lens: &Lens) -> Option<Self> {
        let film_distance = film_distance(&Parameters::default(), lens).ok()?;
        let field = Field::new(lens, lens.rear().vertex - film_distance);
        let focal_length = FirstOrder::of(lens).ok()?.front_focal_length().abs();
        let stated = prescription.stated.fields.first().copied().flatten();
        let Some(stated) = stated.filter(|stated| *stated > 0.0 && *stated < 360.0) else {
            let half = Self::DEFAULT.diagonal / 2.0;
            // The search ends at a field of 166 degrees, so that its step is fine enough for a small lens.
            let lit = field.lit_radius(half.min(8.0 * focal_length))?;
            return Some(if lit < half { Self::rounded(2.0 * lit, Reason::Circle) } else { Self::DEFAULT });
        };
        // No image point lies farther out than three times f tan θ or three times f θ, whichever is larger, where θ
        // is half the field; in the tangent, θ is at most 1.2 radians.
        let half_angle = 0.5 * stated.to_radians();
        let farthest = 3.0 * focal_length * half_angle.max(half_angle.min(1.2).tan());
        let lit = field.lit_radius(farthest)?;
        let angle = |radius: f64| field.real(2.0 * radius).unwrap_or(f64::INFINITY);
        let stated_angle = stated.to_radians();
        if angle(lit) <= stated_angle {
            return Some(Self::rounded(2.0 * lit, Reason::Circle));
        }
        // The field angle grows with the height.
        let (mut inside, mut outside) = (0.0, lit);
        for _ in 0..24 {
            let middle = 0.5 * (inside + outside);
            if angle(middle) <= stated_angle { inside = middle } else { outside = middle }
        }
        Some(Self::rounded(2.0 * inside, Reason::Stated(stated)))
    }

    /// Rounds down to three digits, so that the corner still has light and the user can type the number.
    fn rounded(diagonal: f64, reason: Reason) -> Self {
        if !(diagonal > 0.0) {
            return Self::DEFAULT;
        }
        let unit = 10.0_f64.powi(diagonal.log10().floor() as i32 - 2);
        Self {
            diagonal: format!("{:.2e}", (diagonal / unit + 1e-6).floor() * unit).parse().unwrap_or(diagonal),
            reason,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str) -> OwnFilm {
        let given = Parameters { lens_file: Some(name.to_owned()), ..Parameters::default() };
        OwnFilm::of(&given, &Host::new(Raster { xres: 1, yres: 1 }, None)).unwrap()
    }

    #[test]
    fn a_lens_has_the_film_that_its_image_fills() {
        // Diagonals of the formats of these designs, up to distortion: 2 f tan of half the field for the phone, that
        // of 24 x 36 mm for the others.
        for (name, format) in [("phone.4mm", 6.1), ("planar.50mm", 43.3), ("zoom.24-70mm", 43.3)] {
            let film = of(name);
            assert!(
                (film.diagonal / format - 1.0).abs() < 0.04 && matches!(film.reason, Reason::Stated(_)),
                "{name}: {film}"
            );
        }
        assert!(of("dgauss.50mm").is_default());
        // The corners are dark on 35 mm.
        let fisheye = of("fisheye.10mm");
        assert!(fisheye.reason == Reason::Circle && fisheye.diagonal < 35.0, "{fisheye}");
        // The step of the search scales with the lens.
        let tiny = of("dgauss.50mm@1e-9mm").diagonal / of("dgauss.50mm@1mm").diagonal;
        assert!((tiny * 1e9 - 1.0).abs() < 0.02, "{tiny}");
        let scaled = of("phone.4mm@8.2mm").diagonal / of("phone.4mm@4.1mm").diagonal;
        assert!((scaled - 2.0).abs() < 0.02, "{scaled}");
    }

    #[test]
    fn films_are_rounded_down_to_three_digits() {
        let rounded = |diagonal| OwnFilm::rounded(diagonal, Reason::Circle).diagonal;
        assert_eq!(rounded(0.0), 35.0);
        assert_eq!([6.129, 43.27, 1.999e-8, 35.0, 108.2].map(rounded), [6.12, 43.2, 1.99e-8, 35.0, 108.0]);
    }
}
