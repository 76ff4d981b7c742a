#![no_main]

#[path = "../bodies/c_abi/mod.rs"]
mod body;
#[path = "../bodies/contract.rs"]
mod contract;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    body::run(data);
});
