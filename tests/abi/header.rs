//! The checked-in header is what cbindgen makes from the source.

use std::path::Path;

/// The two unprefixed exports, declared only where a caller asks for them, so that the header can stand
/// beside a pbrt-v1 host's own types.
const PBRT_ENTRY: &str = "
#ifdef REALISTIC_PBRT_ENTRY
#ifdef __cplusplus
extern \"C\" {
#endif
/* What a pbrt-v1 host calls: takes its const ParamSet &, const Transform & (world to camera) and
 * Film *, and returns its Camera *, which the host deletes. NULL when there is none; the reason went to the
 * host's Error function (where there is none, to standard error) and is realistic_last_error(). Rays that the host asks
 * for through its own vtable may raise floating-point flags, but do not trap. */
realistic_camera *CreateCamera(const void *params, const void *world2cam, void *film);
/* realistic_generate_ray under the name that the assignment gives it. */
float GenerateRay(const realistic_camera *camera, const realistic_sample *sample,
                  realistic_ray *ray);
#ifdef __cplusplus
}
#endif
#endif /* REALISTIC_PBRT_ENTRY */
";

#[test]
fn the_header_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config =
        cbindgen::Config::from_file(root.join("include/cbindgen.toml")).expect("a valid configuration");
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in [
        "types",
        "boundary/mod",
        "library",
        "options",
        "camera",
        "ray",
        "batch/rays",
        "batch/differentials",
        "batch/wavelengths",
        "batch/strided",
        "importance/arrays",
        "importance/arrive",
        "importance/aim",
        "autofocus",
        "lens/handle",
        "lens/facts",
        "lens/focus",
        "lens/trace",
        "lens/points",
        "lens/catalogue",
    ] {
        builder = builder.with_src(root.join(format!("src/abi/{file}.rs")));
    }
    let mut made = Vec::new();
    builder.generate().expect("bindings").write(&mut made);
    let made = String::from_utf8(made).expect("UTF-8");
    let guard = "#endif  /* REALISTIC_H */";
    assert!(made.contains(guard), "cbindgen writes its guard in another way now");
    let made = made.replace(guard, &format!("{}\n{guard}", PBRT_ENTRY.trim_start()));
    let path = root.join("include/realistic.h");
    if std::env::var_os("REALISTIC_WRITE_HEADER").is_some() {
        std::fs::write(&path, &made).expect("the header is written");
    }
    let checked_in = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        checked_in == made,
        "include/realistic.h is not what src/abi says; run `REALISTIC_WRITE_HEADER=1 cargo test --test abi header`"
    );
}

/// The names that begin with `realistic_`, end before a parenthesis, and stand in C code outside comments.
fn functions(code: &str) -> Vec<String> {
    let mut plain = String::new();
    for (i, part) in code.split("/*").enumerate() {
        plain.push_str(if i == 0 { part } else { part.split_once("*/").map_or("", |(_, after)| after) });
    }
    let words =
        |before: &str| before.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().map(str::to_owned);
    let called = plain.match_indices('(').filter_map(|(at, _)| words(&plain[..at]));
    called.filter(|name| name.starts_with("realistic_")).collect()
}

#[test]
fn realistic_hpp_reaches_every_function_of_the_header() {
    let read = |file: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("a header")
    };
    let (header, hpp) = (read("include/realistic.h"), read("include/realistic.hpp"));
    let all = functions(&header);
    assert!(all.len() >= 27 && all.contains(&"realistic_capabilities".to_owned()), "{all:?}");
    // A function is reached by its name, or as a line of the list that `Api` has a member of each of.
    let lacking = all.iter().filter(|name| {
        let listed = format!("X({})", name.trim_start_matches("realistic_"));
        !hpp.contains(&listed) && !functions(&hpp).contains(name)
    });
    assert_eq!(lacking.collect::<Vec<_>>(), [""; 0]);
}
