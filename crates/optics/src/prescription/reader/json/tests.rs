#[test]
#[ignore]
fn trial() {
    use crate::prescription::{GlassLibrary, read_with};
    let list = std::fs::read_to_string(std::env::var("TRIAL").unwrap()).unwrap();
    for path in list.lines() {
        let bytes = std::fs::read(path).unwrap();
        let library = match std::env::var("BESIDE") {
            Ok(p) => GlassLibrary::default().beside(std::path::Path::new(&p)),
            _ => GlassLibrary::default(),
        };
        match read_with("F", &bytes, &library) {
            Ok(lens) => {
                use crate::prescription::glass::{D_LINE, refractive_index};
                let w = lens.wavelength.unwrap_or(D_LINE);
                let (mut y, mut u, mut n) = (1.0, 0.0, refractive_index(lens.object_medium, w));
                for i in &lens.interfaces {
                    let behind = refractive_index(i.medium, w);
                    let c = match i.shape {
                        crate::prescription::Shape::Plane => 0.0,
                        crate::prescription::Shape::Sphere { radius } => 1.0 / radius,
                        crate::prescription::Shape::Asphere(a) => 1.0 / a.radius + 2.0 * a.terms[0],
                    };
                    u -= (behind - n) * c * y;
                    n = behind;
                    y += i.thickness * u / n;
                }
                println!("OK\t{path}\t{}\t{}\t{:?}\t{:?}\t{}\t{}", 1.0 / -u, -y * n / u, lens.nominal_film_distance, lens.stated_focal_length, lens.interfaces.len(), lens.remarks.join(" | "));
            }
            Err(e) => println!("NO\t{path}\t{e}"),
        }
    }
}
