//! Where a report was made: processor, compiler, version, day.

use std::time::{SystemTime, UNIX_EPOCH};

/// Name and value of every fact.
pub fn facts() -> Vec<(&'static str, String)> {
    let date = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs() / 86_400);
    let (year, month, day) = civil(date as i64);
    vec![
        ("processor", processor()),
        ("processors seen", std::thread::available_parallelism().map_or(1, usize::from).to_string()),
        ("vector units", vector_units().join(", ")),
        ("system", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ("compiler", env!("REALISTIC_RUSTC").to_owned()),
        ("compiled for", compiled_for()),
        ("realistic", env!("CARGO_PKG_VERSION").to_owned()),
        ("date", format!("{year}-{month:02}-{day:02}")),
    ]
}

fn processor() -> String {
    let about = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let value = |key: &str| {
        let line = about.lines().find(|line| line.starts_with(key))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    match (value("model name"), value("cpu family"), value("model\t")) {
        (Some(name), Some(family), Some(model)) => format!("{name}, family {family}, model {model}"),
        (Some(name), ..) => name,
        _ => "unknown".to_owned(),
    }
}

/// The features of this processor that kernels choose by.
fn vector_units() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    {
        let known = [
            ("AVX2", std::arch::is_x86_feature_detected!("avx2")),
            ("FMA", std::arch::is_x86_feature_detected!("fma")),
            ("AVX-512F", std::arch::is_x86_feature_detected!("avx512f")),
        ];
        known.into_iter().filter(|(_, there)| *there).map(|(name, _)| name).collect()
    }
    #[cfg(not(target_arch = "x86_64"))]
    vec![]
}

fn compiled_for() -> String {
    let flags = env!("REALISTIC_RUSTFLAGS");
    let flags = if flags.is_empty() { "no extra flags" } else { flags };
    format!("{}, optimisation level {}, {flags}", env!("REALISTIC_TARGET"), env!("REALISTIC_OPT_LEVEL"))
}

/// Year, month and day of a day counted from 1970-01-01 in the Gregorian calendar (H. Hinnant,
/// "chrono-Compatible Low-Level Date Algorithms", 2013).
fn civil(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let era = days.div_euclid(146_097);
    let day_of_era = days.rem_euclid(146_097);
    let year = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (year + era * 400 + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        for (days, date) in
            [(0, (1970, 1, 1)), (11_016, (2000, 2, 29)), (20_454, (2026, 1, 1)), (-1, (1969, 12, 31))]
        {
            assert_eq!(civil(days), date);
        }
    }

    #[test]
    fn every_fact_has_a_value() {
        assert!(
            facts().iter().filter(|(name, _)| *name != "vector units").all(|(_, value)| !value.is_empty())
        );
        assert!(facts().iter().any(|(name, value)| *name == "compiler" && value.starts_with("rustc ")));
    }
}
