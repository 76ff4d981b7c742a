//! Hosts in C, C++ and Rust, compiled and run with the plugin.

mod c_host;
mod cpp_host;
mod examples;
mod float_host;
mod harness;
mod layout;
mod memory;
mod pbrt_host;
mod threads;
