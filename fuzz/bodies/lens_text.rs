//! Any bytes give either a lens that can be traced, or an error with its position in the bytes.

use realistic_optics::prescription::{GlassLibrary, Shape, read};
use realistic_optics::trace::{Path, Ray};
use realistic_optics::{
    imaging::focus::Focus,
    lens::{Lens, first_order::FirstOrder},
};

/// Checks the reader's promises, and panics if one is broken. Returns whether the bytes are a lens.
pub fn run(data: &[u8]) -> bool {
    // The same bytes are read as a catalogue of glasses: they give glasses by name, or an error.
    let mut library = GlassLibrary::default();
    if let Err(error) = library.add("fuzz", data) {
        assert!(error.line >= 1 && error.column >= 1 && !error.message.is_empty());
    }
    for word in String::from_utf8_lossy(data).split_whitespace().take(64) {
        let _ = library.find(word);
    }
    let prescription = match read("fuzz", data) {
        Ok(prescription) => prescription,
        Err(error) => {
            assert!(error.line >= 1 && error.column >= 1 && !error.message.is_empty());
            // The file of an error in an archive may be one of its members.
            let position = format!("{}:{}:{}: ", error.file, error.line, error.column);
            assert!(error.to_string().starts_with(&position), "{error}");
            assert!(error.file == "fuzz" || error.file.starts_with("fuzz/"), "{error}");
            return false;
        }
    };
    assert!(!prescription.interfaces.is_empty());
    // Distance along the light from one surface that bends rays to the next; planes that only limit rays may lie anywhere
    // in between, and a change of frame may lead anywhere.
    let (mut distance, mut in_front, mut sign) = (f64::INFINITY, prescription.object_medium, 1.0);
    for interface in &prescription.interfaces {
        if interface.coordinate_break.is_some() {
            distance = f64::INFINITY;
        }
        if interface.shape != Shape::Plane || interface.medium != in_front || interface.is_mirror {
            assert!(distance >= 0.0, "{:?}", prescription.interfaces);
            distance = 0.0;
        }
        sign = if interface.is_mirror { -sign } else { sign };
        distance += sign * interface.thickness;
        in_front = interface.medium;
        assert!(interface.thickness.is_finite());
        assert!(interface.semi_diameter > 0.0 && interface.semi_diameter.is_finite());
        if let Shape::Sphere { radius } = interface.shape {
            assert!(radius.is_finite() && interface.semi_diameter <= radius.abs());
        }
    }
    let lens = Lens::at_d_line(&prescription);
    let _ = FirstOrder::of(&lens);
    if let Ok(focus) = Focus::new(&lens) {
        let _ = focus.film_distance(f64::INFINITY);
    }
    let rear = lens.rear();
    for height in [0.0, 0.5, 0.99] {
        let origin = [0.3 * rear.semi_diameter, 0.0, rear.vertex - 2.0 * rear.semi_diameter];
        let aim = [0.0, height * rear.semi_diameter, rear.vertex];
        let direction = std::array::from_fn(|i| aim[i] - origin[i]);
        if let Ok(ray) = Path::<f64>::film_to_scene(&lens).trace(Ray { origin, direction }) {
            assert!(ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite()), "{ray:?}");
        }
    }
    true
}
