#![no_main]

#[path = "../bodies/c_abi/mod.rs"]
mod checks;
#[path = "../bodies/contract.rs"]
mod contract;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    checks::run(data);
});
