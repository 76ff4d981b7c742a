//! The four lenses of Kolb's figure 6, from one place: a telephoto, a wide-angle lens, a double Gauss
//! and a fisheye, scaled to its focal lengths.

use super::{Effects, Panel, Slide};

pub fn panels(spp: u32) -> Vec<Panel> {
    let lens = |label: &str, name: &str, diagonal: f64| {
        let effects = Effects { soft_shadow: true, ..Slide::Lenses.shown() };
        Panel::new(label, effects, spp).set("specfile", name).set("filmdiag", diagonal)
    };
    vec![
        lens("200 mm telephoto", "telephoto.250mm@200mm", 43.3),
        lens("35 mm wide-angle", "wide.22mm@35mm", 43.3),
        lens("50 mm double Gauss", "dgauss.50mm", 43.3),
        lens("16 mm fisheye", "fisheye.10mm@16mm", 48.0),
    ]
}
