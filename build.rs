//! Compiles the C++ interface for a pbrt-v1 host (`pbrt-shim/`) on platforms where such
//! a host can run: Linux x86-64 with glibc. Elsewhere, and when `REALISTIC_NO_SHIM` is
//! set, the library builds without it. All output goes to Cargo's output directory.

use std::env;

/// Translation units; `HEADERS` are the headers that they include.
const SOURCES: [&str; 4] = ["camera.cpp", "find_new.cpp", "find_old.cpp", "host.cpp"];
const HEADERS: [&str; 3] = ["find.hpp", "layout.hpp", "shim.h"];

fn main() {
    println!("cargo::rustc-check-cfg=cfg(realistic_shim)");
    println!("cargo::rerun-if-env-changed=REALISTIC_NO_SHIM");
    for file in SOURCES.iter().chain(&HEADERS) {
        println!("cargo::rerun-if-changed=pbrt-shim/{file}");
    }
    let target = |key: &str| env::var(format!("CARGO_CFG_TARGET_{key}")).unwrap_or_default();
    let measured = target("OS") == "linux"
        && target("ARCH") == "x86_64"
        && target("ENV") == "gnu"
        && target("POINTER_WIDTH") == "64";
    if !measured || env::var_os("REALISTIC_NO_SHIM").is_some() {
        return;
    }
    let mut build = cc::Build::new();
    build.cpp(true).std("c++11").warnings(true).extra_warnings(true).flag("-fvisibility=hidden");
    build.files(SOURCES.map(|file| format!("pbrt-shim/{file}")));
    match build.try_compile("realistic_shim") {
        Ok(()) => println!("cargo::rustc-cfg=realistic_shim"),
        Err(error) => {
            println!(
                "cargo::error=the pbrt face (pbrt-shim/) needs a C++11 compiler: install g++, or name one \
                 in CXX, or set REALISTIC_NO_SHIM=1 to build without CreateCamera. The compiler said: {}",
                error.to_string().replace('\n', " ")
            );
            std::process::exit(1);
        }
    }
}
