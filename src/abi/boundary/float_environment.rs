//! The host's floating-point environment: its control word (rounding mode, exceptions that trap, treatment of
//! subnormal numbers) and its flags. The library's work runs in the default environment; the host's
//! environment is restored afterwards.
//!
//! The arithmetic is branch-free: it also takes square roots for blocked rays, which then become NaN. A host
//! in which invalid operations trap (`feenableexcept`) would crash there, and a host that rounds upward or
//! flushes subnormal numbers to zero would receive different rays. On x86-64 the environment is the vector
//! unit's MXCSR; the library does not use the x87.

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use machine::{call_in_default, has_raised, is_default, read, set_flags};

/// Runs `work` in the default environment, and restores the host's control word and flags.
#[inline(always)]
pub fn in_default<T>(work: impl FnOnce() -> T) -> T {
    let before = read();
    if !is_default(before) {
        return apart(work);
    }
    let result = work();
    set_flags(before);
    result
}

/// Runs work as short as one ray like [`in_default`], but restores the flags only if the work raised invalid
/// operation, division by zero or overflow, which most rays do not.
#[inline(always)]
pub fn for_ray<T>(work: impl FnOnce() -> T) -> T {
    let before = read();
    if !is_default(before) {
        return apart(work);
    }
    let result = work();
    if has_raised(before) {
        set_flags(before);
    }
    result
}

/// Runs work like [`for_ray`], but leaves raised flags as they are, because reading them would wait for the
/// ray.
#[cfg(realistic_shim)]
#[inline(always)]
pub fn for_triple<T>(work: impl FnOnce() -> T) -> T {
    if is_default(read()) { work() } else { apart(work) }
}

/// Runs work like [`in_default`], for a host whose environment is not the default.
#[cold]
#[inline(never)]
fn apart<T>(work: impl FnOnce() -> T) -> T {
    let (mut work, mut result) = (Some(work), None);
    // Unwind safety: the panic is resumed below.
    let mut run_work = || result = work.take().map(|work| catch_unwind(AssertUnwindSafe(work)));
    let mut call: &mut dyn FnMut() = &mut run_work;
    // SAFETY: the pointer is to this closure, which `run` expects; `run` does not unwind.
    unsafe { call_in_default((&raw mut call).cast(), run) };
    match result {
        Some(Ok(result)) => result,
        Some(Err(panic)) => resume_unwind(panic),
        None => unreachable!("the call ran"),
    }
}

/// # Safety
/// `call` points to a `&mut dyn FnMut()`, which nobody else uses.
unsafe extern "C" fn run(call: *mut c_void) {
    // SAFETY: the caller's promise.
    unsafe { (*call.cast::<&mut dyn FnMut()>())() };
}

#[cfg(all(target_arch = "x86_64", unix, not(miri)))]
mod machine {
    use std::arch::asm;
    use std::ffi::c_void;

    /// Default MXCSR: every exception masked, rounding to nearest, subnormal numbers kept, no flag raised.
    const DEFAULT: u32 = 0x1F80;
    const FLAGS: u32 = 0x3F;
    /// Flags that are restored: invalid operation, division by zero, overflow.
    const RESTORED: u32 = 0b1101;

    /// Reads MXCSR.
    #[inline(always)]
    pub fn read() -> u32 {
        let mut now = 0_u32;
        // SAFETY: the instruction writes the four bytes of `now`.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut now, options(nostack, preserves_flags)) };
        now
    }

    #[inline(always)]
    pub fn is_default(state: u32) -> bool {
        state & !FLAGS == DEFAULT
    }

    /// Whether the work raised flags that must not remain.
    #[inline(always)]
    pub fn has_raised(before: u32) -> bool {
        read() & !before & RESTORED != 0
    }

    #[inline(always)]
    pub fn set_flags(before: u32) {
        // SAFETY: the control word does not change.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const before, options(nostack, readonly)) };
    }

    /// # Safety
    /// `function` accepts `data` and does not unwind.
    pub unsafe fn call_in_default(data: *mut c_void, function: unsafe extern "C" fn(*mut c_void)) {
        let (host, default) = (read(), DEFAULT);
        // SAFETY: the caller guarantees that the call is valid. The values needed after it are in registers that the
        // called function preserves.
        unsafe {
            asm!(
                "ldmxcsr [{default}]",
                "call {function}",
                "ldmxcsr [r12]",
                default = in(reg) &raw const default,
                function = in(reg) function,
                in("r12") &raw const host,
                in("rdi") data,
                clobber_abi("C"),
            );
        }
    }
}

#[cfg(all(target_arch = "aarch64", not(miri)))]
mod machine {
    use std::arch::asm;
    use std::ffi::c_void;

    /// Flags of FPSR that are restored: invalid operation, division by zero, overflow.
    const RESTORED: u64 = 0b111;

    /// Reads FPCR, which is 0 by default, and FPSR.
    #[inline(always)]
    pub fn read() -> [u64; 2] {
        let (control, flags): (u64, u64);
        // SAFETY: reads two registers.
        unsafe {
            asm!(
                "mrs {}, fpcr", "mrs {}, fpsr", out(reg) control, out(reg) flags,
                options(nostack, nomem, preserves_flags)
            );
        }
        [control, flags]
    }

    #[inline(always)]
    pub fn is_default([control, _]: [u64; 2]) -> bool {
        control == 0
    }

    /// Whether the work raised flags that must not remain.
    #[inline(always)]
    pub fn has_raised([_, before]: [u64; 2]) -> bool {
        let [_, after] = read();
        after & !before & RESTORED != 0
    }

    #[inline(always)]
    pub fn set_flags([_, before]: [u64; 2]) {
        // SAFETY: only the flags are written.
        unsafe { asm!("msr fpsr, {}", in(reg) before, options(nostack, nomem)) };
    }

    /// # Safety
    /// `function` accepts `data` and does not unwind.
    pub unsafe fn call_in_default(data: *mut c_void, function: unsafe extern "C" fn(*mut c_void)) {
        let [control, flags] = read();
        // SAFETY: the caller's promise; the registers that hold what is needed after the call survive it.
        unsafe {
            asm!(
                "msr fpcr, xzr",
                "blr {function}",
                "msr fpcr, x20",
                "msr fpsr, x21",
                function = in(reg) function,
                in("x20") control,
                in("x21") flags,
                in("x0") data,
                clobber_abi("C"),
            );
        }
    }
}

/// Fallback for untested machines and for Miri, which has no assembly: work runs in the host's environment.
#[cfg(any(miri, not(any(all(target_arch = "x86_64", unix), target_arch = "aarch64"))))]
mod machine {
    use std::ffi::c_void;

    pub fn read() {}

    pub fn is_default((): ()) -> bool {
        true
    }

    pub fn has_raised((): ()) -> bool {
        false
    }

    pub fn set_flags((): ()) {}

    /// # Safety
    /// `function` accepts `data`.
    pub unsafe fn call_in_default(data: *mut c_void, function: unsafe extern "C" fn(*mut c_void)) {
        // SAFETY: the caller's promise.
        unsafe { function(data) }
    }
}

#[cfg(all(test, target_arch = "x86_64", unix, not(miri)))]
mod tests {
    use super::*;

    /// MXCSR with rounding upward and trapping invalid operations.
    const STRANGE: u32 = 0x5F00;

    #[test]
    fn the_hosts_float_environment_returns_even_after_a_panic() {
        let own = read();
        let all_work: [fn() -> u32; 2] = [read, || panic!("with {:x}", read())];
        for work in all_work {
            set_flags(STRANGE);
            let inside = [catch_unwind(|| in_default(work)), catch_unwind(|| for_ray(work))];
            let after = read();
            set_flags(own);
            assert_eq!(after, STRANGE);
            for inside in inside {
                match inside {
                    Ok(control) => assert!(is_default(control)),
                    Err(panic) => {
                        assert_eq!(panic.downcast_ref(), Some(&"with 1f80".to_owned()));
                    }
                }
            }
        }
    }
}
