//! Finds the costliest of many random short aspheric lenses, by the time to build a camera and by the time of its first
//! ray from the scene. `cargo run --release -p realistic-lab --example aspheric_cost -- [LENSES] [FIRST SEED]`.
//!
//! The run ends with the time for 1,000 aspheres with odd terms.

use std::fmt::Write;

use realistic_lab::{stability::random::aspheric_lens_text, timing::cost::Cost};

fn main() {
    let number = |index: usize, default: u64| {
        std::env::args().nth(index).map_or(default, |text| text.parse().expect("a number"))
    };
    let (lenses, first) = (number(1, 400), number(2, 1));
    let seeds = first..first + lenses;
    let mut costs: Vec<(u64, Cost)> =
        seeds.filter_map(|seed| Some((seed, Cost::of(&aspheric_lens_text(seed))?))).collect();
    println!("{} of {lenses} lenses make cameras", costs.len());
    type Order = fn(&Cost) -> f64;
    let orders: [(&str, Order); 2] =
        [("build, s", |cost| cost.build), ("first direction, s", |cost| cost.first)];
    for (name, by) in orders {
        costs.sort_by(|(_, a), (_, b)| by(b).total_cmp(&by(a)));
        println!("worst by {name}:");
        for (seed, Cost { build, first }) in costs.iter().take(4) {
            println!("  seed {seed}: built in {build:.3} s, first direction in {first:.3} s");
        }
    }
    let mut text = String::new();
    for i in 0..1000 {
        let radius = [2e3, -3e3, 9e3, -5e3][i % 4];
        let _ = writeln!(text, "{radius} 0.03 {} 14", [1.5, 1.0][i % 2]);
    }
    for i in 1..=1000 {
        let _ = writeln!(text, "asphere {i} conic=0.3 A3=1e-8 A4=1e-9 A5=1e-10 A6=-1e-11 A7=1e-12");
    }
    println!("1,000 odd aspheres: {:?}", Cost::of(&text));
}
