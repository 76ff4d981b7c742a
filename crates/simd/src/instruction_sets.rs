//! Instruction sets that the kernel is compiled for. The best one is determined once per process, within the limit that
//! the environment variable `REALISTIC_SIMD` sets. An [`Available`] proves that the processor has the instructions; to
//! call a compiled instance requires an [`Available`].

use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

use realistic_base::message::{cut, nearest_or_all};

/// A set of instructions, from the least to the most capable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Simd {
    /// The instructions that the library was compiled for. On x86-64 without FMA, fused multiply-adds are function
    /// calls: slow, but with the same bits.
    Portable,
    /// AVX2 and FMA: 256-bit registers.
    Avx2,
    /// AVX-512F in addition to AVX2 and FMA: 512-bit registers.
    Avx512,
}

/// An instruction set that this processor has; only detection creates a value of this type.
#[derive(Clone, Copy, Debug)]
pub struct Available(Simd);

impl Available {
    /// Returns the proof for [`Simd::best`].
    pub fn best() -> Self {
        /// Index of the best set in [`Simd::ALL`] plus 1; 0 until the set is known. An atomic number rather than a
        /// lock: a process that is forked while another thread holds a lock would wait for it forever.
        static BEST: AtomicU8 = AtomicU8::new(0);
        let known = usize::from(BEST.load(Relaxed)).checked_sub(1);
        if let Some(best) = known {
            return Self(Simd::ALL[best]);
        }
        let limit = Simd::limit().ok().flatten();
        let allowed = Simd::ALL.into_iter().filter(|simd| limit.is_none_or(|limit| *simd <= limit));
        let best = allowed.rev().find_map(Simd::available).unwrap_or(Self(Simd::Portable));
        BEST.store(best.0 as u8 + 1, Relaxed);
        best
    }

    /// Returns the set.
    #[inline(always)]
    pub fn simd(self) -> Simd {
        self.0
    }
}

/// Simple loops that are compiled for each instruction set; see [`Simd::run`].
pub trait Compiled {
    /// Does the work. This method must be marked `#[inline(always)]`, and the functions that it calls must be inlined
    /// into it.
    fn run(self);
}

/// The environment variable that limits the instruction set.
const VARIABLE: &str = "REALISTIC_SIMD";

impl Simd {
    /// Every set, the least capable first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// Returns the set's name in the environment variable.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether the processor and the operating system support the set.
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = || std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
            match self {
                Self::Portable => true,
                Self::Avx2 => avx2(),
                Self::Avx512 => avx2() && std::is_x86_feature_detected!("avx512f"),
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == Self::Portable
        }
    }

    /// Returns the most capable set that the environment variable allows; `None` if the variable is unset or empty.
    ///
    /// # Errors
    /// Returns a message for the user if the variable does not name an instruction set.
    pub fn limit() -> Result<Option<Self>, String> {
        let Some(given) = std::env::var_os(VARIABLE).filter(|given| !given.is_empty()) else {
            return Ok(None);
        };
        let given = given.to_string_lossy();
        let limit = Self::ALL.into_iter().find(|simd| given == simd.name());
        limit.map(Some).ok_or_else(|| {
            let known = nearest_or_all(&given, &Self::ALL.map(Self::name));
            format!("{VARIABLE} is \"{}\", no set of instructions, and changes nothing; {known}", cut(&given))
        })
    }

    /// Returns the proof that this processor has the set; `None` if the processor lacks it.
    pub fn available(self) -> Option<Available> {
        self.is_available().then_some(Available(self))
    }

    /// Returns the most capable set that the processor has and that the environment variable `REALISTIC_SIMD`
    /// (`portable`, `avx2`, `avx512`) allows; any other value allows all sets. The result is determined once per
    /// process.
    pub fn best() -> Self {
        Available::best().simd()
    }

    /// Does work with the instructions of this set or, if the processor lacks them, with the portable instructions
    /// only. The results are the same to the last bit, because the compiler fuses no operations.
    pub fn run(self, work: impl Compiled) {
        #[cfg(target_arch = "x86_64")]
        match self.available().map(Available::simd) {
            // SAFETY: the processor has these instructions.
            Some(Self::Avx512) => return unsafe { avx512(work) },
            // SAFETY: as above.
            Some(Self::Avx2) => return unsafe { avx2(work) },
            _ => {}
        }
        work.run();
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn avx512(work: impl Compiled) {
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2(work: impl Compiled) {
    work.run();
}
