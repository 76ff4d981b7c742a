use realistic::{camera::{PupilDisk, WarpedPupil, irradiance::film_ray}, optics::Lens, prescription::catalogue, trace::Path};
#[test]
fn dbg() {
    let lens = Lens::at_d_line(&catalogue::find("telephoto.250mm").unwrap());
    let film = lens.rear().vertex - realistic::optics::focus::Focus::new(&lens).unwrap().film_distance(f64::INFINITY).unwrap();
    let path = Path::<f64>::film_to_scene(&lens);
    let cover = PupilDisk::rear(&lens, film, 17.6).unwrap();
    let drift = PupilDisk::exit(&lens, film).seen_from([1.0, 0.0]).center[0];
    let pupil = WarpedPupil::new(&path, film, 17.6, cover, drift);
    for h in [15.4, 15.5] {
        let c = pupil.draw([h, 0.0], [0.0, 0.0]).unwrap().slopes;
        println!("{h} center {c:?} drift {}", drift * h);
        for i in 0..=12 {
            let phi = std::f64::consts::PI * f64::from(i) / 12.0;
            let [x, y] = pupil.draw([h, 0.0], [phi.cos(), phi.sin()]).unwrap().slopes;
            let (dx, dy) = (x - c[0], y - c[1]);
            let e = |k: f64| path.trace(film_ray([h, 0.0], film, [c[0] + k * dx, c[1] + k * dy])).is_ok();
            let (mut lo, mut hi) = (0.5, 2.0);
            while hi - lo > 1e-9 { let m = 0.5 * (lo + hi); if e(m) { lo = m } else { hi = m } }
            println!("{i} {:.7} {:.7} edge/r {lo:.7}", dx, dy);
        }
    }
}
