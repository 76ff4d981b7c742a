//! Shaped apertures of the shader: the fates of its rays are those of the exact walk.

use super::{Comparison, Shader, samples};
use rayon::prelude::*;
use realistic_optics::lens::Lens;
use realistic_optics::prescription::read;

#[test]
fn shaped_apertures_are_the_librarys() {
    let lines = [
        "aperture 4 ring 1.5 3.5",
        "aperture 4 ellipse 3.5 1.5 x=0.3 rotation=30",
        "obstruction 4 rectangle 4 0.4 rotation=70",
        "aperture 4 polygon 0 -3.6 2.6 -0.9 3.4 1.2 2.5 2.6 0 1.6 -2.5 2.6 -3.4 1.2",
        "obstruction 2 polygon -4 -4 5 -3 0 1 rotation=20",
        "aperture 6 rectangle 4 1.5 y=0.5",
        "blades 7 rotation=20 curvature=0.3",
    ];
    lines.par_iter().for_each(|line| {
        let text =
            format!("flare 1 1 24\n50 6 1.5 22\n-50 4 1 22\nstop 2 1 8\ninf 2 1.5 24\ninf 45 1 24\n{line}\n");
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("shaped.dat");
        std::fs::write(&file, &text).unwrap();
        let lens = Lens::at_d_line(&read("shaped.dat", text.as_bytes()).expect(line));
        let shader = Shader::new(file.to_str().unwrap(), &[]);
        for camera in [[0.0, 0.0], [1.0 / 32.0, 2.0]] {
            let found = Comparison::of(&lens, &shader.answers(&samples(shader.reach, 10_000, camera)));
            let blocked = found.traced - found.passed;
            assert!(found.passed > 500 && blocked > 500, "{line}: {found:?}");
            assert!(found.fates_differ <= 4, "{line}: {} fates differ", found.fates_differ);
        }
    });
}
