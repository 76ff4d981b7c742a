//! Mirror lenses of patents, read from Optical Bench text.

use realistic_optics::{
    lens::{Lens, Ray},
    prescription::read,
    trace::Path,
};

/// US 3,632,190, example 1, with the separation of the mirrors that its shared surfaces enforce; two mirrors behind glass.
const NIKON: &str = "[lens data]\n1\t46.264\t2.2\t1.5245\t17\t59.6\n2\t124.08\t17.3\t\t17\n3\t-36.552\t1.76\t1.54072\t15.6\t47.2\n\
    4\t-57.8\t0\t\t15.6\n5\t-57.8\t0\t-1\t15.6\n6\t-57.8\t-1.76\t1.54072\t15.6\t47.2\n7\t-36.552\t-15.38\t\t15.6\n\
    8\t-23.166\t-.78\t1.54814\t8.4\t45.9\n9\t-35.719\t0\t\t8.4\n10\t-35.719\t0\t-1\t8.4\n11\t-35.719\t.78\t1.54814\t8.4\t45.9\n\
    12\t-23.166\t14.72\t\t8.4\n13\t-12.466\t.22\t1.56883\t7.4\t56\n14\tInfinity\t.44\t1.72825\t7.4\t28.3\n\
    15\t-36.552\t1.76\t1.54072\t7.4\t47.2\n16\t-57.8\t13.0614\t\t7.4\n";

#[test]
fn a_lens_with_two_mirrors_behind_glass_has_the_focal_length_of_its_patent() {
    let prescription = read("lens", NIKON.as_bytes()).expect("a lens");
    let lens = Lens::at_d_line(&prescription);
    let height = 1e-4;
    let near_axis = Ray { origin: [0.0, height, 5.0], direction: [0.0, 0.0, -1.0] };
    let ray = Path::<f64>::scene_to_film(&lens).walk(near_axis).ray;
    let slope = ray.direction[1] / ray.direction[2].abs();
    let (focal_length, back) = (-height / slope, -ray.origin[1] / slope);
    assert!((focal_length - 99.993).abs() < 1e-3, "{focal_length}");
    assert!((back - 13.0614).abs() < 1e-3, "{back}");
}
