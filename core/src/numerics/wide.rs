//! Loops on registers of 512 bits, where the machine has them.

/// What `work` gives, compiled for AVX-512; nothing on a machine without it.
///
/// The compiler neither fuses operations nor puts sums in another order, so the bits are those of any other machine. What
/// `work` calls must be inlined into it to be compiled so, too.
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
            // SAFETY: this machine can, as it has just said.
            return Some(unsafe { compiled(work) });
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    drop(work);
    None
}
