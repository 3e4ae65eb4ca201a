//! Counter-based random streams: every draw has an address, so results depend on nothing else.
//!
//! The generator is Philox4x64-10 (Salmon, Moraes, Dror and Shaw, *Parallel random numbers: as easy as
//! 1, 2, 3*, SC11, doi:10.1145/2063384.2063405), a keyed bijection of 256-bit counters.
//!
//! The layout is frozen: a change is a change of values. The key is `[seed, 0]`; block b = 1, 2, … of a
//! stream is the image of the counter `[b, index, purpose, 0]`, and its four words come out in order.
//! numpy increments the low word before its first block, so [`Stream::new`]`(seed, purpose, index)` gives,
//! word for word, `numpy.random.Philox(key=[seed, 0], counter=[0, index, purpose, 0]).random_raw()`.

use std::convert::Infallible;

use rand_core::TryRng;

/// What the draws of a stream are for; the numbers are part of the frozen layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[repr(u64)]
pub enum Purpose {
    /// Successive thresholds of a contact, a new one at each re-formation.
    Thresholds = 1,
    /// Stretches at which a contact re-forms.
    Reforming = 2,
    /// The stretch of a contact at X = 0.
    Initial = 3,
    /// Draws conditional on the rest of a contact's state that plain draws failed to meet.
    Conditional = 4,
    /// The one threshold that a contact keeps for ever.
    QuenchedThresholds = 5,
    /// Differences between the cells of an interface.
    Cells = 6,
    /// Draws of a law for their own sake: samples, tests, pictures.
    Sample = 7,
    /// How much of its rate of breaking by heat a contact survives, anew in each life.
    Breaking = 8,
    /// The way of a threshold that diffuses.
    Diffusion = 9,
}

/// A stream of random words, addressed by seed, purpose and index.
///
/// Streams that differ in any of the three are independent. A stream has 2⁶⁴ blocks of four words.
/// It is a [`rand_core::Rng`], so every distribution of `rand_distr` can draw from it.
#[derive(Debug, Clone)]
pub struct Stream {
    key: u64,
    counter: [u64; 3],
    words: [u64; 4 * AHEAD],
    used: usize,
    filled: usize,
    /// Blocks before the first one computed.
    begun: u64,
}

/// Most blocks computed at once: their multiplications overlap, and what uses the words runs longer undisturbed.
const AHEAD: usize = 16;

impl Stream {
    /// The stream of `seed` for `purpose`, of the contact or cell number `index`.
    #[must_use]
    #[inline]
    pub fn new(seed: u64, purpose: Purpose, index: u64) -> Self {
        let counter = [0, index, purpose as u64];
        Self { key: seed, counter, words: [0; 4 * AHEAD], used: 0, filled: 0, begun: 0 }
    }

    /// Goes to the stream of another `index`, of the same seed and purpose, from which so many words have been taken.
    #[inline]
    pub(crate) fn seek(&mut self, index: u64, taken: u64) {
        self.begun = taken / 4;
        self.counter = [self.begun, index, self.counter[2]];
        // The words of the block that lie before are passed over once it is computed.
        (self.used, self.filled) = ((taken % 4) as usize, (taken % 4) as usize);
    }

    /// The words taken so far, by which [`Stream::seek`] comes back here.
    #[inline]
    pub(crate) fn taken(&self) -> u64 {
        4 * self.counter[0] + self.used as u64 - 4 * (self.filled as u64 / 4)
    }

    /// The next 64 random bits.
    ///
    /// Blocks are made as many at once as there have been: a short stream costs no more than it must.
    #[inline]
    pub fn word(&mut self) -> u64 {
        if self.used == self.filled {
            self.refill((self.counter[0] - self.begun) as usize);
        }
        let word = self.words[self.used % (4 * AHEAD)];
        self.used += 1;
        word
    }

    /// The words that come next, at least one of them, hardly more than are `wanted`; they are not taken.
    #[inline]
    pub(crate) fn coming(&mut self, wanted: usize) -> &[u64] {
        if self.used == self.filled {
            self.refill(wanted.div_ceil(4));
        }
        &self.words[self.used..self.filled]
    }

    /// Takes words that [`Stream::coming`] has shown.
    #[inline]
    pub(crate) fn skip(&mut self, words: usize) {
        self.used += words;
    }

    /// Makes `blocks`, one at least and [`AHEAD`] at most; more than one in pairs, half as dear as single ones.
    ///
    /// Out of line, so that `word` is inlined where distributions draw.
    #[inline(never)]
    fn refill(&mut self, blocks: usize) {
        let [done, index, purpose] = self.counter;
        let counter = |ahead: usize| [done.wrapping_add(1 + ahead as u64), index, purpose, 0];
        let key = [self.key, 0];
        if blocks <= 1 {
            let [block] = philox([counter(0)], key);
            self.words[..4].copy_from_slice(&block);
            self.filled = 4;
        } else {
            let pairs = blocks.min(AHEAD).div_ceil(2);
            for (i, words) in self.words.chunks_exact_mut(8).take(pairs).enumerate() {
                let pair = philox([counter(2 * i), counter(2 * i + 1)], key);
                words.copy_from_slice(pair.as_flattened());
            }
            self.filled = 8 * pairs;
        }
        self.used %= 4;
        self.counter[0] = done.wrapping_add(self.filled as u64 / 4);
    }

    /// A uniform number in the open interval (0, 1), from 53 bits.
    ///
    /// It is numpy's `random()`, whose 0 (once in 2⁵³ draws) becomes 2⁻⁵⁴: logarithms and quantiles of it
    /// are finite.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        const ULP: f64 = 1.0 / (1u64 << 53) as f64;
        (((self.word() >> 11) as f64) * ULP).max(0.5 * ULP)
    }
}

impl TryRng for Stream {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok((self.word() >> 32) as u32)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.word())
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            chunk.copy_from_slice(&self.word().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

/// Philox4x64-10: the images of `counters` under `key`, side by side.
#[inline(always)]
fn philox<const N: usize>(mut counters: [[u64; 4]; N], mut key: [u64; 2]) -> [[u64; 4]; N] {
    for _ in 0..10 {
        for counter in &mut counters {
            let (high0, low0) = multiply(0xD2E7_470E_E14C_6C93, counter[0]);
            let (high1, low1) = multiply(0xCA5A_8263_9512_1157, counter[2]);
            *counter = [high1 ^ counter[1] ^ key[0], low1, high0 ^ counter[3] ^ key[1], low0];
        }
        key[0] = key[0].wrapping_add(0x9E37_79B9_7F4A_7C15);
        key[1] = key[1].wrapping_add(0xBB67_AE85_84CA_A73B);
    }
    counters
}

/// The high and the low word of a product.
#[inline]
fn multiply(a: u64, b: u64) -> (u64, u64) {
    let product = u128::from(a) * u128::from(b);
    ((product >> 64) as u64, product as u64)
}

#[cfg(test)]
mod tests {
    use super::{Purpose, Stream, philox};

    #[test]
    fn a_stream_goes_on_where_it_was_left() {
        let mut whole = Stream::new(3, Purpose::Sample, 8);
        let mut parts = Stream::new(3, Purpose::Sample, 0);
        for length in (0..40).chain([1, 1, 1, 17]) {
            let taken = whole.taken();
            parts.seek(8, taken);
            assert_eq!(parts.taken(), taken);
            for _ in 0..length {
                assert_eq!(parts.word(), whole.word());
                assert_eq!(parts.taken(), whole.taken());
            }
            parts.seek(9, 2);
            parts.word();
        }
    }

    /// `kat_vectors` of the Random123 distribution.
    #[test]
    fn published_vectors() {
        let pi = [0x243f_6a88_85a3_08d3, 0x1319_8a2e_0370_7344, 0xa409_3822_299f_31d0, 0x082e_fa98_ec4e_6c89];
        let cases = [
            (
                [0; 4],
                [0; 2],
                [0x1655_4d9e_ca36_314c, 0xdb20_fe9d_672d_0fdc, 0xd7e7_72ce_e186_176b, 0x7e68_b68a_ec7b_a23b],
            ),
            (
                [u64::MAX; 4],
                [u64::MAX; 2],
                [0x87b0_92c3_013f_e90b, 0x438c_3c67_be8d_0224, 0x9cc7_d7c6_9cd7_77b6, 0xa09c_aebf_594f_0ba0],
            ),
            (
                pi,
                [0x4528_21e6_38d0_1377, 0xbe54_66cf_34e9_0c6c],
                [0xa528_f454_03e6_1d95, 0x38c7_2dbd_566e_9788, 0xa5a1_610e_72fd_18b5, 0x57bd_43b5_e52b_7fe6],
            ),
        ];
        for (counter, key, image) in cases {
            assert_eq!(philox([counter], key), [image]);
        }
    }
}
