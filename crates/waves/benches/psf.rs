//! Time of a wavefront and of its point spread function, in one thread: `cargo bench -p realistic-waves`.

use realistic_optics::{imaging::focus::Focus, lens::Lens, prescription::catalogue};
use realistic_waves::{FilmPlane, Psf, Sampling, Wavefront, wavefront::object_of};
use std::time::{Duration, Instant};

/// Number of repetitions. The fastest one is reported.
const REPETITIONS: usize = 20;

fn fastest<R>(work: impl Fn() -> R) -> (Duration, R) {
    let mut best = (Duration::MAX, None);
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        let found = work();
        let time = start.elapsed();
        if time < best.0 {
            best = (time, Some(found));
        }
    }
    (best.0, best.1.expect("repeated"))
}

fn main() {
    for name in ["planar.50mm", "zoom.24-70mm", "anamorphic.129mm", "mirror.500mm"] {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let focus = Focus::new(&lens).expect("not afocal");
        let film = lens.rear().vertex - focus.film_distance(1e6).expect("in reach");
        let object = object_of(&lens, [1.0, 2.0, film], 1e6).expect("a chief ray");
        let plane = FilmPlane::across(film);
        let trace = || Wavefront::new(&lens, object, &plane, Sampling::DEFAULT).expect("lit");
        let (traced, wavefront) = fastest(trace);
        let pitch = wavefront.wavelength / (8.0 * wavefront.circle().1);
        let (summed, _) = fastest(|| Psf::new(&wavefront, 128, pitch));
        println!(
            "{name:20} {} rays in {traced:.1?}, 128 x 128 pixels in {summed:.1?}",
            wavefront.nodes.len()
        );
    }
}
