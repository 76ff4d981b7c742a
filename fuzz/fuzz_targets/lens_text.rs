#![no_main]

#[path = "../bodies/lens_text.rs"]
mod body;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    body::run(data);
});
