//! The C ABI from its hosts: C, C++, Rust and a pbrt-v1 host, the header, and arbitrary input.

#[path = "../truth/support/abi_camera.rs"]
mod abi_camera;
mod fuzz_bodies;
mod fuzz_seeds;
mod header;
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
mod hosts;
mod importance;
mod lens;
mod models;
mod parameters;
#[path = "../truth/support/properties.rs"]
mod properties;
