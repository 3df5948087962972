//! Copies to memory that nobody reads soon.

/// Copies numbers without bringing the memory that they go to into the cache, where the machine can: an ordinary store
/// reads a line before it changes it, which is half of the traffic where an array does not fit into the cache.
///
/// # Panics
/// Where the lengths differ: a bug of the caller.
#[cfg(target_arch = "x86_64")]
pub fn copy(from: &[f64], to: &mut [f64]) {
    use std::arch::x86_64::{__m128d, _mm_loadu_pd, _mm_sfence, _mm_stream_pd};

    assert_eq!(from.len(), to.len(), "a copy of another length");
    let pairs = to.len() / 2;
    // numpy's arrays begin at multiples of 16 bytes; a slice of one may not.
    if !to.as_ptr().cast::<__m128d>().is_aligned() {
        to.copy_from_slice(from);
        return;
    }
    let (source, target) = (from.as_ptr(), to.as_mut_ptr());
    for k in 0..pairs {
        // SAFETY: 2 k + 1 is below both lengths, which are the same. The target is aligned to 16 bytes, as was tested, and
        // nobody else reads or writes it meanwhile, because it is borrowed mutably. SSE2 is part of x86-64.
        unsafe { _mm_stream_pd(target.add(2 * k), _mm_loadu_pd(source.add(2 * k))) };
    }
    // SAFETY: no precondition. It orders these stores before all that follow, so that who borrows the target next, on any
    // thread, sees them like ordinary ones.
    unsafe { _mm_sfence() };
    to[2 * pairs..].copy_from_slice(&from[2 * pairs..]);
}

/// Copies numbers.
///
/// # Panics
/// Where the lengths differ: a bug of the caller.
#[cfg(not(target_arch = "x86_64"))]
pub fn copy(from: &[f64], to: &mut [f64]) {
    to.copy_from_slice(from);
}
