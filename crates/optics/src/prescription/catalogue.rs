//! The built-in lenses, by name: the files of `lenses/`, embedded. Each file states the source of its data.

use super::{interfaces::Prescription, reader::read};

macro_rules! catalogue {
    ($($name:literal),* $(,)?) => {
        const FILES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../lenses/", $name, ".dat")))),*];
    };
}

catalogue![
    "dgauss.50mm",
    "dgauss.100mm",
    "wide.22mm",
    "telephoto.250mm",
    "fisheye.10mm",
    "triplet.210mm",
    "petzval.100mm",
    "tessar.50mm",
    "sonnar.50mm",
    "biotar.100mm",
    "planar.50mm",
    "portrait.85mm",
    "tele.135mm",
    "telephoto.300mm",
    "macro.105mm",
    "retrofocus.35mm",
    "retrofocus.24mm",
    "retrofocus.20mm",
    "ultrawide.14mm",
    "fisheye.16mm",
    "fisheye.6mm",
    "zoom.24-70mm",
    "zoom.70-200mm",
    "phone.4mm",
    "anamorphic.129mm",
    "anamorphic.42mm",
    "mirror.500mm",
];

/// The default lens.
pub const DEFAULT: &str = "dgauss.50mm";

/// Returns the names of all built-in lenses, the default first.
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|&(name, _)| name)
}

/// Returns the names of the lenses whose surfaces are symmetric about one axis and refract.
pub fn round() -> impl Iterator<Item = &'static str> {
    names().filter(|name| !name.starts_with("anamorphic.") && !name.starts_with("mirror."))
}

/// Returns the built-in lens of that name. The name may end in `.dat`, because the course's scenes use file names.
pub fn find(name: &str) -> Option<Prescription> {
    let name = name.strip_suffix(".dat").unwrap_or(name);
    let &(name, text) = FILES.iter().find(|&&(known, _)| known == name)?;
    Some(read(name, text.as_bytes()).expect("a test reads every built-in lens"))
}

/// Returns the default lens.
pub fn default() -> Prescription {
    find(DEFAULT).expect("a test finds it in the catalogue")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::Shape;

    #[test]
    fn every_built_in_lens_reads_and_names_its_source() {
        for (name, text) in FILES {
            assert_eq!(find(name).expect("listed").name, *name);
            assert_eq!(find(&format!("{name}.dat")), find(name));
            assert!(text.contains("# Source: "), "{name} does not say where it comes from");
        }
    }

    /// Tests whose rays must suit a randomly chosen lens or film use the first five lenses; other tests use all lenses.
    #[test]
    fn spherical_lenses_without_moving_groups_come_first() {
        let first: Vec<&str> = names().take(5).collect();
        assert_eq!(first, ["dgauss.50mm", "dgauss.100mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"]);
        for lens in first.into_iter().map(|name| find(name).expect("listed")) {
            let is_asphere = |shape: Shape| matches!(shape, Shape::Asphere(_));
            assert!(lens.positions.is_none() && !lens.interfaces.iter().any(|i| is_asphere(i.shape)));
        }
    }

    #[test]
    fn the_round_lenses_are_those_without_cylinders_tilts_and_mirrors() {
        let is_round = |name: &&str| find(name).expect("listed").is_round();
        assert!(round().eq(names().filter(is_round)));
    }

    #[test]
    fn the_two_double_gausses_are_one_design() {
        let large = find("dgauss.100mm").expect("listed").scaled(0.5);
        let small = find("dgauss.50mm").expect("listed");
        for (half, own) in large.interfaces.iter().zip(&small.interfaces) {
            assert!((half.thickness - own.thickness).abs() < 1e-12);
            assert!((half.semi_diameter - own.semi_diameter).abs() < 1e-12);
            match (half.shape, own.shape) {
                (Shape::Sphere { radius: half }, Shape::Sphere { radius: own }) => {
                    assert!((half - own).abs() < 1e-12);
                }
                (half, own) => assert_eq!(half, own),
            }
        }
    }
}
