//! The environment of a report: processor, compiler, version, date.

/// Returns name and value of every fact.
pub fn facts() -> Vec<(&'static str, String)> {
    vec![
        ("processor", processor()),
        ("processors seen", std::thread::available_parallelism().map_or(1, usize::from).to_string()),
        ("vector units", vector_units().join(", ")),
        ("system", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ("compiler", env!("REALISTIC_RUSTC").to_owned()),
        ("compiled for", compiled_for()),
        ("realistic", env!("CARGO_PKG_VERSION").to_owned()),
        ("date", time::OffsetDateTime::now_utc().date().to_string()),
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

/// Returns the features of this processor by which kernels are selected.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fact_has_a_value() {
        assert!(
            facts().iter().filter(|(name, _)| *name != "vector units").all(|(_, value)| !value.is_empty())
        );
        assert!(facts().iter().any(|(name, value)| *name == "compiler" && value.starts_with("rustc ")));
    }
}
