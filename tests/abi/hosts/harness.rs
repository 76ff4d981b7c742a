//! Builds hosts in C and C++, the pbrt-v1 host for both `std::string` ABIs, and runs them with the plugin.
//!
//! With `REALISTIC_SANITIZE`, an argument of the compiler's `-fsanitize=`, the hosts are built with that sanitizer;
//! with `REALISTIC_HOSTS_PLUGIN` they load that plugin. `.ci/sanitize` sets both.

use std::collections::BTreeSet;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{self, Command};
use std::sync::{Mutex, OnceLock};

/// The `std::string` ABI of a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Abi {
    Old = 0,
    New = 1,
}

impl Abi {
    pub const BOTH: [Self; 2] = [Self::Old, Self::New];
}

/// Returns the C++ compiler: `CXX`, or `c++`.
pub fn compiler() -> OsString {
    env::var_os("CXX").unwrap_or_else(|| "c++".into())
}

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abi/hosts/pbrt_host.cpp")
}

/// Returns the C compiler: `CC`, or `cc`.
pub fn c_compiler() -> OsString {
    env::var_os("CC").unwrap_or_else(|| "cc".into())
}

/// Flags for a C99 program that must compile without a warning.
pub const C99: [&str; 7] = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1", "-g"];
/// Flags for a C++11 program that must compile without a warning.
pub const CXX11: [&str; 7] = ["-std=c++11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1", "-g"];

/// Compiles C++ to a program in Cargo's directory for test artifacts.
pub fn compile(source: &Path, name: &str, flags: &[&str]) -> PathBuf {
    let flags: Vec<&str> =
        ["-std=c++11", "-Wall", "-Wextra", "-O1", "-g"].iter().chain(flags).copied().collect();
    compile_with(&compiler(), &flags, source, name, &["-ldl"])
}

/// Compiles with a given compiler; the project's headers are on the include path.
pub fn compile_with(
    compiler: &OsStr,
    flags: &[&str],
    source: &Path,
    name: &str,
    libraries: &[&str],
) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let sanitizer = env::var("REALISTIC_SANITIZE").ok();
    let name = format!("{name}{}", sanitizer.as_deref().unwrap_or_default());
    let program = directory.join(&name);
    // Write under another name first: two test processes may compile the same program at once.
    let fresh = directory.join(format!("{name}-{}", process::id()));
    let output = Command::new(compiler)
        .args(flags)
        .args(sanitizer.map(|word| format!("-fsanitize={word}")))
        .args(["-fno-sanitize=vptr", "-fno-sanitize-recover=all"])
        .arg("-I")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("include"))
        .arg(source)
        .arg("-o")
        .arg(&fresh)
        .args(libraries)
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}; name a compiler in CC and CXX", compiler.display()));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::rename(&fresh, &program).unwrap();
    program
}

/// Returns the host built like the renderer: the program exports its symbols.
pub fn host(abi: Abi) -> &'static Path {
    static HOSTS: [OnceLock<PathBuf>; 2] = [OnceLock::new(), OnceLock::new()];
    HOSTS[abi as usize].get_or_init(|| {
        let define = format!("-D_GLIBCXX_USE_CXX11_ABI={}", abi as u32);
        compile(&source(), &format!("pbrt_host_{}", abi as u32), &["-rdynamic", &define])
    })
}

/// Returns a host without exported symbols, unlike a renderer with plugins.
pub fn closed_host() -> PathBuf {
    compile(&source(), "pbrt_host_closed", &[])
}

/// Returns the plugin that Cargo built for these tests, which lies beside them, or the requested one.
pub fn plugin() -> PathBuf {
    if let Some(directory) = env::var_os("REALISTIC_HOSTS_PLUGIN") {
        return directory.into();
    }
    let beside = env::current_exe().unwrap().parent().unwrap().join("librealistic.so");
    assert!(beside.is_file(), "{} is missing", beside.display());
    beside
}

/// Returns the flags that link a program with the library and set its run-time search path.
pub fn linking() -> [String; 5] {
    let plugin = plugin();
    let directory = plugin.parent().unwrap().display().to_string();
    let search = format!("-L{directory}");
    [search, "-lrealistic".into(), format!("-Wl,-rpath,{directory}"), "-lpthread".into(), "-lm".into()]
}

/// Copies the plugin to a directory of its own, under the name that a host expects.
pub fn installed(name: &str) -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let copy = directory.path().join(name);
    fs::copy(plugin(), &copy).unwrap();
    (directory, copy)
}

/// Returns the command of a program, under valgrind if `REALISTIC_VALGRIND=1`. Only the first run of each action in any
/// host uses valgrind, under which a run takes fifty times as long.
pub fn program(program: &Path, action: &str) -> Command {
    static SEEN: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let is_first = || SEEN.lock().unwrap().insert(action.to_owned());
    if env::var_os("REALISTIC_VALGRIND").is_none_or(|value| value != "1") || !is_first() {
        return without_search(Command::new(program));
    }
    let mut valgrind = Command::new("valgrind");
    valgrind.args([
        "--quiet",
        "--leak-check=full",
        "--show-leak-kinds=definite,indirect,possible",
        "--errors-for-leak-kinds=definite,indirect,possible",
        "--error-exitcode=99",
        concat!("--suppressions=", env!("CARGO_MANIFEST_DIR"), "/tests/abi/hosts/valgrind.supp"),
    ]);
    valgrind.arg(program);
    without_search(valgrind)
}

/// Removes Cargo's library search path, which precedes a program's own and may lead to a library of an earlier
/// build.
fn without_search(mut command: Command) -> Command {
    command.env_remove("LD_LIBRARY_PATH");
    command
}

/// A run of a host.
pub struct Run {
    command: Command,
}

impl Run {
    /// Builds a run of the host of one ABI with the plugin and an action.
    pub fn new(abi: Abi, plugin: &Path, action: &str) -> Self {
        Self::of(host(abi), plugin, action)
    }

    /// Builds a run of any host, as [`Run::new`] does for the pbrt-v1 host.
    pub fn of(host: &Path, plugin: &Path, action: &str) -> Self {
        Self::by(program(host, action), plugin, action)
    }

    /// Builds a run as [`Run::of`] does, but never under valgrind, which does not emulate traps, flags and
    /// rounding modes.
    pub fn bare(host: &Path, plugin: &Path, action: &str) -> Self {
        Self::by(without_search(Command::new(host)), plugin, action)
    }

    fn by(mut command: Command, plugin: &Path, action: &str) -> Self {
        command.arg(plugin).arg(action).env_remove("PBRT_SEARCHPATH");
        Self { command }
    }

    /// Adds an argument: `float:film_distance=50`, `res=30x20`, …
    pub fn with(mut self, argument: impl AsRef<str>) -> Self {
        self.command.arg(argument.as_ref());
        self
    }

    /// Adds many arguments.
    pub fn with_all<T: AsRef<str>>(self, arguments: impl IntoIterator<Item = T>) -> Self {
        arguments.into_iter().fold(self, Self::with)
    }

    /// Sets the working directory.
    pub fn in_directory(mut self, directory: &Path) -> Self {
        self.command.current_dir(directory);
        self
    }

    /// Sets an environment variable.
    pub fn env(mut self, key: &str, value: &Path) -> Self {
        self.command.env(key, value);
        self
    }

    /// Runs the host, which must exit successfully.
    pub fn run(mut self) -> Report {
        let output = self.command.output().expect("the host runs");
        let report = Report {
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        };
        assert!(output.status.success(), "{}\n{}\n{}", output.status, report.out, report.err);
        report
    }
}

/// A ray as the host received it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Got {
    pub weight: f64,
    pub o: [f64; 3],
    pub d: [f64; 3],
    pub mint: f64,
    pub maxt: f64,
    pub time: f64,
}

impl Got {
    pub fn is_blocked(&self) -> bool {
        self.weight == 0.0 || self.weight as f32 == f32::MIN_POSITIVE
    }

    pub fn length(&self) -> f64 {
        self.d.iter().map(|part| part * part).sum::<f64>().sqrt()
    }
}

/// The host's output.
#[derive(Debug)]
pub struct Report {
    pub out: String,
    pub err: String,
}

impl Report {
    /// Returns the rest of every line that begins with `key`.
    pub fn all(&self, key: &str) -> Vec<&str> {
        self.out.lines().filter_map(|line| line.strip_prefix(key)?.strip_prefix(' ')).collect()
    }

    /// Returns the rest of the only line that begins with `key`.
    pub fn one(&self, key: &str) -> &str {
        match self.all(key)[..] {
            [only] => only,
            ref other => panic!("{} lines of {key}:\n{}\n{}", other.len(), self.out, self.err),
        }
    }

    /// Returns the numbers of the only line that begins with `key`.
    pub fn numbers(&self, key: &str) -> Vec<f64> {
        numbers(self.one(key))
    }

    /// Returns the only number of the only line that begins with `key`.
    pub fn number(&self, key: &str) -> f64 {
        self.numbers(key)[0]
    }

    /// Returns the rays of every line that begins with `key`.
    pub fn rays(&self, key: &str) -> Vec<Got> {
        let ray = |line| match numbers(line)[..] {
            [weight, ox, oy, oz, dx, dy, dz, mint, maxt, time] => {
                Got { weight, o: [ox, oy, oz], d: [dx, dy, dz], mint, maxt, time }
            }
            ref other => panic!("no ray: {other:?}"),
        };
        self.all(key).into_iter().map(ray).collect()
    }

    /// Checks that the plugin did not create a camera, reported the reason once in a text that has all of
    /// `words`, and left the film to the host.
    pub fn refused(&self, words: &[&str]) {
        assert_eq!(self.one("camera"), "null", "{}", self.out);
        assert_eq!(self.one("films"), "0");
        let message = self.one("error");
        for word in words {
            assert!(message.contains(word), "no \"{word}\" in: {message}");
        }
    }

    /// Checks that a camera was created without a warning or an error, and that everything was released.
    pub fn clean(&self) {
        assert_eq!(self.one("camera"), "made", "{}", self.out);
        assert_eq!(self.all("error"), [""; 0]);
        assert_eq!(self.all("warning"), [""; 0]);
        self.ended();
    }

    /// Checks that the film was deleted once, and that the host's base class and the reference counts of its
    /// matrices are unchanged.
    pub fn ended(&self) {
        assert_eq!(self.one("films"), "1");
        assert_eq!(self.one("base"), "0");
        assert_eq!(self.one("references"), "1 1");
    }
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap_or_else(|_| panic!("{text}"))).collect()
}
