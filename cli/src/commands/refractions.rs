//! `realistic refractions`: measures the lecture's comparison of refraction methods.

use crate::failure::Failure;
use realistic_lab::accuracy::refractions::{Operations, errors, operations, times};
use realistic_lab::timing::Effort;
use realistic_optics::lens::refraction::Refraction;
use serde_json::json;
use std::io::Write as _;
use std::time::Duration;

/// The options of `refractions`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Write JSON
    #[arg(long)]
    json: bool,
}

/// Prints the comparison.
///
/// # Errors
/// Standard output cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let seconds = times(Effort { rounds: 41, least: Duration::from_micros(500) });
    let clock = reference_clock();
    let mut out = std::io::stdout().lock();
    let mut rows = Vec::new();
    for ((name, method), seconds) in Refraction::NAMES.into_iter().zip(seconds) {
        rows.push((name, operations(method), seconds, errors::<f64>(method), errors::<f32>(method)));
    }
    if args.json {
        let rows = rows.iter().map(|(name, operations, seconds, double, single)| {
            json!({
                "method": name,
                "square_roots": operations.square_roots,
                "divisions": operations.divisions,
                "multiplications": operations.multiplications,
                "additions": operations.additions,
                "latency_ns": seconds * 1e9,
                "latency_reference_cycles": clock.map(|hertz| seconds * hertz),
                "f64_median_error_rad": double.median,
                "f64_largest_error_rad": double.largest,
                "f32_median_error_rad": single.median,
                "f32_largest_error_rad": single.largest,
            })
        });
        writeln!(out, "{:#}", serde_json::Value::from_iter(rows))?;
        return Ok(());
    }
    writeln!(
        out,
        "{:<10} {:>5} {:>4} {:>4} {:>4} {:>9} {:>8}   {:>9} {:>9}   {:>9} {:>9}",
        "method", "sqrt", "div", "mul", "add", "ns", "cycles", "f64 med.", "largest", "f32 med.", "largest"
    )?;
    for (name, operations, seconds, double, single) in rows {
        let Operations { square_roots, divisions, multiplications, additions } = operations;
        let cycles = clock.map_or("-".to_owned(), |hertz| format!("{:.1}", seconds * hertz));
        writeln!(
            out,
            "{name:<10} {square_roots:>5} {divisions:>4} {multiplications:>4} {additions:>4} {:>9.2} {cycles:>8}   \
             {:>9.1e} {:>9.1e}   {:>9.1e} {:>9.1e}",
            seconds * 1e9,
            double.median,
            double.largest,
            single.median,
            single.largest
        )?;
    }
    writeln!(
        out,
        "\nOperations of one refraction, counted. Time of one in double precision in a chain where each waits for the \
         one before{}.\nErrors in rad against 106-bit arithmetic, incidence up to 60 degrees.",
        clock.map_or(String::new(), |hertz| format!(
            "; cycles of the {:.2} GHz time-stamp counter",
            hertz / 1e9
        ))
    )?;
    Ok(())
}

/// Returns the ticks per second of the processor's time-stamp counter.
fn reference_clock() -> Option<f64> {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::_rdtsc;
        let start = std::time::Instant::now();
        // SAFETY: every x86-64 processor has this instruction.
        let ticks = unsafe { _rdtsc() };
        std::thread::sleep(Duration::from_millis(50));
        // SAFETY: as above.
        let ticks = unsafe { _rdtsc() } - ticks;
        Some(ticks as f64 / start.elapsed().as_secs_f64())
    }
    #[cfg(not(target_arch = "x86_64"))]
    None
}
