//! The host's floating-point environment: its control word (rounding mode, exceptions that trap, what becomes of
//! subnormal numbers) and its flags. In comes work; it runs in the default environment, and the host's is as it was.
//!
//! The arithmetic is free of branches: roots are taken of blocked rays, too, and are no numbers then. A host in which
//! invalid operations trap (`feenableexcept`) would die of them, and one that rounds upward or flushes subnormal
//! numbers to zero would get other rays. On x86-64 that is the vector unit's MXCSR; the library does not use the x87.

use std::any::Any;
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

/// [`in_default`] for what takes no longer than a ray: only the flags of invalid operation, division by zero and
/// overflow are restored, which for most rays is nothing to do.
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

/// [`for_ray`] that leaves flags raised, for to look at them is to wait for the ray.
#[cfg(realistic_shim)]
#[inline(always)]
pub fn for_triple<T>(work: impl FnOnce() -> T) -> T {
    if is_default(read()) { work() } else { apart(work) }
}

/// [`in_default`] in an environment of the host's own.
#[cold]
#[inline(never)]
fn apart<T>(work: impl FnOnce() -> T) -> T {
    let mut call = Call { work: Some(work), result: None };
    // SAFETY: the function is this structure's and does not unwind.
    unsafe { call_in_default((&raw mut call).cast(), run_of(&call)) };
    match call.result {
        Some(Ok(result)) => result,
        Some(Err(panic)) => resume_unwind(panic),
        None => unreachable!("the call ran"),
    }
}

/// What is to be run, and what it returned or how it panicked.
struct Call<T, F> {
    work: Option<F>,
    result: Option<Result<T, Box<dyn Any + Send>>>,
}

/// [`run`] of a structure's type, which cannot be named.
fn run_of<T, F: FnOnce() -> T>(_: &Call<T, F>) -> unsafe extern "C" fn(*mut c_void) {
    run::<T, F>
}

/// # Safety
/// `call` points to a structure of these types, which nobody else uses.
unsafe extern "C" fn run<T, F: FnOnce() -> T>(call: *mut c_void) {
    // SAFETY: the caller's promise.
    let call = unsafe { &mut *call.cast::<Call<T, F>>() };
    // Unwind safety: the panic goes on in the caller.
    call.result = call.work.take().map(|work| catch_unwind(AssertUnwindSafe(work)));
}

#[cfg(all(target_arch = "x86_64", unix, not(miri)))]
mod machine {
    use std::arch::asm;
    use std::ffi::c_void;

    /// Every exception masked, to nearest, subnormal numbers kept, no flag.
    const DEFAULT: u32 = 0x1F80;
    const FLAGS: u32 = 0x3F;
    /// Of them invalid operation, division by zero, overflow.
    const RESTORED: u32 = 0b1101;

    /// MXCSR.
    #[inline(always)]
    pub fn read() -> u32 {
        let mut now = 0_u32;
        // SAFETY: writes the four bytes.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut now, options(nostack, preserves_flags)) };
        now
    }

    #[inline(always)]
    pub fn is_default(state: u32) -> bool {
        state & !FLAGS == DEFAULT
    }

    /// Whether flags are up that must not stay.
    #[inline(always)]
    pub fn has_raised(before: u32) -> bool {
        read() & !before & RESTORED != 0
    }

    #[inline(always)]
    pub fn set_flags(before: u32) {
        // SAFETY: the control word is what it is.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const before, options(nostack, readonly)) };
    }

    /// # Safety
    /// `function` takes `data` and does not unwind.
    pub unsafe fn call_in_default(data: *mut c_void, function: unsafe extern "C" fn(*mut c_void)) {
        let (host, default) = (read(), DEFAULT);
        // SAFETY: the caller's promise; the registers that hold what is needed after the call survive it.
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

    /// Of FPSR: invalid operation, division by zero, overflow.
    const RESTORED: u64 = 0b111;

    /// FPCR, which is 0 by default, and FPSR.
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

    /// Whether flags are up that must not stay.
    #[inline(always)]
    pub fn has_raised([_, before]: [u64; 2]) -> bool {
        let [_, after] = read();
        after & !before & RESTORED != 0
    }

    #[inline(always)]
    pub fn set_flags([_, before]: [u64; 2]) {
        // SAFETY: only flags are written.
        unsafe { asm!("msr fpsr, {}", in(reg) before, options(nostack, nomem)) };
    }

    /// # Safety
    /// `function` takes `data` and does not unwind.
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

/// Where nobody has tried it, and under Miri, which has no assembly, work runs in the host's environment.
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
    /// `function` takes `data`.
    pub unsafe fn call_in_default(data: *mut c_void, function: unsafe extern "C" fn(*mut c_void)) {
        // SAFETY: the caller's promise.
        unsafe { function(data) }
    }
}

#[cfg(all(test, target_arch = "x86_64", unix, not(miri)))]
mod tests {
    use super::*;

    /// Rounding upward, invalid operations trap.
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
