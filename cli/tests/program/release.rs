//! The release archive: packed by its script, unpacked elsewhere, and used without the source tree.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::plugin::{built, taken};

/// Returns the output of a command that must succeed.
fn succeed(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

/// Unpacks the archive of this build.
fn unpacked(into: &Path) -> PathBuf {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.ci/release");
    let packed = into.join("packed");
    let output = succeed(
        Command::new(script).arg(&packed).args([Path::new(env!("CARGO_BIN_EXE_realistic")), &built()]),
    );
    let archive = PathBuf::from(String::from_utf8(output.stdout).unwrap().trim());
    succeed(Command::new("tar").arg("-xzf").arg(&archive).arg("-C").arg(into));
    let name = archive.file_name().unwrap().to_str().unwrap().strip_suffix(".tar.gz").unwrap();
    // Moving the folder reveals any path that was stored while packing.
    let root = into.join("moved");
    std::fs::rename(into.join(name), &root).unwrap();
    root
}

#[test]
fn a_release_is_used_without_the_checkout() {
    let folder = tempfile::tempdir().unwrap();
    let root = unpacked(folder.path());
    let elsewhere = folder.path().join("elsewhere");
    std::fs::create_dir(&elsewhere).unwrap();

    let mut program = Command::new(root.join("bin/realistic"));
    program.env_clear().current_dir(&elsewhere);
    let rendered = succeed(program.args(["render", "--size", "6x4", "--spp", "1", "--out", "picture.png"]));
    assert_eq!(taken(&rendered), root.join("lib/librealistic.so").canonicalize().unwrap());

    let compiler = std::env::var_os("CC").unwrap_or_else(|| "cc".into());
    let library = root.join("lib");
    succeed(
        Command::new(compiler)
            .arg("-std=c99")
            .arg("-I")
            .arg(root.join("include"))
            .arg(root.join("share/realistic/examples/host.c"))
            .arg("-L")
            .arg(&library)
            .arg("-lrealistic")
            .arg(format!("-Wl,-rpath,{}", library.display()))
            .args(["-o", "host"])
            .current_dir(&elsewhere),
    );
    succeed(Command::new(elsewhere.join("host")).arg("vignetting.pgm").env_clear().current_dir(&elsewhere));
    assert!(std::fs::read(elsewhere.join("vignetting.pgm")).unwrap().starts_with(b"P5"));

    let plugin = std::fs::read(root.join("lib/pbrt/realistic.so")).unwrap();
    assert!(plugin == std::fs::read(built()).unwrap(), "the plugin for pbrt is not the library");
    let description = std::fs::read_to_string(root.join("lib/pkgconfig/realistic.pc")).unwrap();
    assert!(description.contains(&format!("Version: {}", env!("CARGO_PKG_VERSION"))), "{description}");
    let cmake = root.join("share/cmake/realistic/realistic-config-version.cmake");
    let cmake = std::fs::read_to_string(cmake).unwrap();
    assert!(cmake.contains(&format!("set(PACKAGE_VERSION {})", env!("CARGO_PKG_VERSION"))), "{cmake}");
    let notices = std::fs::read_to_string(root.join("share/realistic/NOTICES")).unwrap();
    for part in ["Bitstream", "== glam", "== libc", "== thiserror", "== clap"] {
        assert!(notices.contains(part), "no notice of {part}");
    }

    // The newest version of glibc that either of the two files needs.
    let needs = std::fs::read_to_string(root.join("share/realistic/NEEDS")).unwrap();
    let both = ["bin/realistic", "lib/librealistic.so"].map(|file| root.join(file));
    let symbols = succeed(Command::new("objdump").arg("-T").args(both)).stdout;
    let symbols = String::from_utf8(symbols).unwrap();
    let minors = symbols.split("(GLIBC_2.").skip(1).map(|rest| rest.split(['.', ')']).next().unwrap());
    let newest = minors.map(|minor| minor.parse::<u32>().unwrap()).max().unwrap();
    assert!(needs.contains(&format!("glibc 2.{newest} or newer")), "{needs}");
}
