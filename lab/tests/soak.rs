//! A short soak of the C ABI (`examples/soak.rs`), in which the promises must hold and every reason must occur.

#[path = "../examples/soak.rs"]
mod soak;

#[test]
fn random_bits_through_random_cameras_make_sound_rays_or_none() {
    let counts = soak::soak(20_000_000, 7, |_| ());
    println!("{counts}");
    assert_eq!(counts.violations, 0, "{counts}");
    assert!(counts.passed >= counts.rays / 10, "{counts}");
    // If a reason does not occur, the soak covers too little.
    assert!((0..=6).all(|reason| counts.reasons.contains_key(&reason)), "{counts}");
}
