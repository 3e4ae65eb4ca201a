//! Loops compiled for 512-bit registers, where the machine has them.

/// Runs `work` compiled for AVX-512; `None` on a machine without it.
///
/// The compiler neither fuses operations nor reorders sums, so the bits are those of any other machine.
/// Functions that `work` calls must be inlined into it to be compiled for AVX-512.
#[inline]
pub(crate) fn wide<T>(work: impl FnOnce() -> T) -> Option<T> {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
        fn compiled<T>(work: impl FnOnce() -> T) -> T {
            work()
        }
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            #[expect(unsafe_code, reason = "safe Rust cannot call what not every machine can run")]
            // SAFETY: the machine supports these instructions, as has just been tested.
            return Some(unsafe { compiled(work) });
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    drop(work);
    None
}
