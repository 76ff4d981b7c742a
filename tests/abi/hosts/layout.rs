//! Layouts of structures in the C++ compiler against those in Rust, and the plugin's exports.

use super::harness;

use std::collections::HashMap;
use std::fmt::Write;
use std::fs;
use std::mem::{align_of, offset_of, size_of};
use std::path::Path;
use std::process::Command;

use harness::{Abi, compile};
use realistic::ffi::{
    realistic_camera_info, realistic_input, realistic_options, realistic_output, realistic_ray,
    realistic_ray_differential, realistic_request, realistic_sample, realistic_vectors,
};

/// Returns numbers by key, from lines of `layout key numbers…`.
fn table(program: &Path) -> HashMap<String, Vec<usize>> {
    let output = Command::new(program).args(["no-plugin", "layout"]).output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| {
            let mut words = line.split(' ').skip(1);
            let key = words.next().unwrap().to_owned();
            (key, words.map(|word| word.parse().unwrap()).collect())
        })
        .collect()
}

#[test]
fn a_hosts_sample_and_ray_begin_with_ours() {
    for abi in Abi::BOTH {
        let host = table(harness::host(abi));
        let pairs = [
            ("Sample.imageX", offset_of!(realistic_sample, image_x)),
            ("Sample.imageY", offset_of!(realistic_sample, image_y)),
            ("Sample.lensU", offset_of!(realistic_sample, lens_u)),
            ("Sample.lensV", offset_of!(realistic_sample, lens_v)),
            ("Sample.time", offset_of!(realistic_sample, time)),
            ("Ray.o", offset_of!(realistic_ray, o)),
            ("Ray.d", offset_of!(realistic_ray, d)),
            ("Ray.mint", offset_of!(realistic_ray, mint)),
            ("Ray.maxt", offset_of!(realistic_ray, maxt)),
            ("Ray.time", offset_of!(realistic_ray, time)),
        ];
        for (key, ours) in pairs {
            assert_eq!(host[key], [ours], "{key}");
        }
        assert_eq!(host["Ray"], [size_of::<realistic_ray>(), align_of::<realistic_ray>()]);
        assert!(host["Sample"][0] >= size_of::<realistic_sample>());
        assert!(host["Sample"][1] >= align_of::<realistic_sample>());
    }
}

#[test]
fn the_test_host_has_the_measured_layouts() {
    // The values are from a pbrt 1.05 build; `pbrt-shim/layout.hpp` asserts them on the plugin's side.
    for abi in Abi::BOTH {
        let host = table(harness::host(abi));
        let measured: [(&str, &[usize]); 25] = [
            ("Sample", &[88, 8]),
            ("Sample.n1D", &[24]),
            ("Sample.oneD", &[72]),
            ("RayDifferential", &[112, 4]),
            ("RayDifferential.hasDifferentials", &[36]),
            ("RayDifferential.rx", &[40]),
            ("RayDifferential.ry", &[76]),
            ("Matrix4x4", &[68, 4]),
            ("Matrix4x4.m", &[4]),
            ("Transform", &[16, 8]),
            ("Transform.mInv", &[8]),
            ("Film", &[16, 8]),
            ("Film.xResolution", &[8]),
            ("Film.yResolution", &[12]),
            ("Camera", &[64, 8]),
            ("Camera.film", &[8]),
            ("Camera.WorldToCamera", &[16]),
            ("Camera.CameraToWorld", &[32]),
            ("Camera.ClipHither", &[48]),
            ("Camera.ClipYon", &[52]),
            ("Camera.ShutterOpen", &[56]),
            ("Camera.ShutterClose", &[60]),
            ("ParamSet", &[216, 8]),
            ("ParamSet.strings", &[168]),
            ("std::string", if abi == Abi::New { &[32, 8] } else { &[8, 8] }),
        ];
        for (key, numbers) in measured {
            assert_eq!(host[key], numbers, "{key} {abi:?}");
        }
    }
}

/// Compares a C structure with its Rust namesake: size, alignment, and members in order.
macro_rules! structure {
    ($name:ident: $($member:ident)*) => {
        (
            stringify!($name),
            vec![size_of::<$name>(), align_of::<$name>()],
            vec![$((stringify!($member), offset_of!($name, $member))),*],
        )
    };
}

#[test]
fn the_c_structures_are_as_the_cpp_compiler_lays_them_out() {
    let structures = [
        structure!(realistic_sample: image_x image_y lens_u lens_v time),
        structure!(realistic_ray: o d mint maxt time),
        structure!(realistic_ray_differential: struct_size has ray rx_o rx_d ry_o ry_d),
        structure!(realistic_input: x y z stride),
        structure!(realistic_output: x y z stride),
        structure!(realistic_vectors: x y z stride),
        structure!(realistic_request: struct_size wavelengths_per_sample image lens time wavelength origin direction
            weight mint maxt ray_time reason reason_stride rx_origin rx_direction rx_weight ry_origin ry_direction
            ry_weight),
        // One parameter of each kind, and the last parameter: both sides have the parameters in the table's order.
        structure!(realistic_options: struct_size xres yres camera_to_world camera_to_world_end transform_start
            transform_end lens_text lens_text_size donor log log_user model lens_file simple_weighting crop lens_plane),
        structure!(realistic_camera_info: struct_size interfaces focal_length_mm fnumber film_distance
            focus_distance_mm film_diagonal crop),
    ];
    let directory = tempfile::tempdir().unwrap();
    let mut program =
        "#include \"realistic.h\"\n#include <cstddef>\n#include <cstdio>\nint main() {\n".to_owned();
    for (name, _, members) in &structures {
        writeln!(program, "std::printf(\"layout {name} %zu %zu\\n\", sizeof({name}), alignof({name}));")
            .unwrap();
        for (member, _) in members {
            writeln!(program, "std::printf(\"layout {name}.{member} %zu\\n\", offsetof({name}, {member}));")
                .unwrap();
        }
    }
    program.push_str("}\n");
    let source = directory.path().join("layout.cpp");
    fs::write(&source, program).unwrap();
    let seen = table(&compile(&source, "c_layout", &[]));
    for (name, whole, members) in structures {
        assert_eq!(seen[name], whole, "{name}");
        for (member, offset) in members {
            assert_eq!(seen[&format!("{name}.{member}")], [offset], "{name}.{member}");
        }
    }
}

#[test]
fn nothing_but_the_abi_is_exported() {
    let output = Command::new("nm")
        .args(["--dynamic", "--defined-only", "--format=posix"])
        .arg(harness::plugin())
        .output()
        .expect("nm comes with the compiler");
    let symbols = String::from_utf8(output.stdout).unwrap();
    let names: Vec<&str> = symbols.lines().filter_map(|line| line.split(' ').next()).collect();
    assert!(names.contains(&"CreateCamera") && names.contains(&"GenerateRay"), "{names:?}");
    for name in names {
        let ours = matches!(name, "CreateCamera" | "GenerateRay")
            || name.starts_with("realistic_") && !name.starts_with("realistic_shim_");
        assert!(ours, "{name} is exported");
    }
}

#[test]
fn nothing_of_the_host_is_bound_when_the_plugin_loads() {
    let output =
        Command::new("nm").args(["--dynamic", "--undefined-only"]).arg(harness::plugin()).output().unwrap();
    let symbols = String::from_utf8(output.stdout).unwrap();
    for name in ["ParamSet", "Transform", "_Z5Error", "_Z7Warning", "_Z4Info", "_ZN6Camera", "_ZTV6Camera"] {
        assert!(!symbols.contains(name), "{name} is bound at load time");
    }
}
