//! Loops compiled for the widest registers that the machine has.

/// Runs `work` compiled for AVX-512 or AVX2, where the machine has them.
///
/// The compiler neither fuses operations nor reorders sums, so the bits are those of any other machine.
/// Functions that `work` calls must be inlined into it to be compiled for these registers.
#[inline]
pub(crate) fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
        fn on_512<T>(work: impl FnOnce() -> T) -> T {
            work()
        }
        #[target_feature(enable = "avx2")]
        fn on_256<T>(work: impl FnOnce() -> T) -> T {
            work()
        }
        if has_avx512() {
            #[expect(unsafe_code, reason = "safe Rust cannot call what not every machine can run")]
            // SAFETY: the machine supports these instructions, as has just been tested.
            return unsafe { on_512(work) };
        }
        if is_x86_feature_detected!("avx2") {
            #[expect(unsafe_code, reason = "safe Rust cannot call what not every machine can run")]
            // SAFETY: as above.
            return unsafe { on_256(work) };
        }
    }
    work()
}

/// Runs `work` as [`vectorised`] does, if the machine has AVX-512: for what pays only there.
#[inline]
pub(crate) fn wide<T>(work: impl FnOnce() -> T) -> Option<T> {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
        fn compiled<T>(work: impl FnOnce() -> T) -> T {
            work()
        }
        if has_avx512() {
            #[expect(unsafe_code, reason = "safe Rust cannot call what not every machine can run")]
            // SAFETY: the machine supports these instructions, as has just been tested.
            return Some(unsafe { compiled(work) });
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    drop(work);
    None
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}
