//! Counter-based random streams: every random number has an address, so that results depend on nothing else.
//!
//! The generator is Philox4x64-10 (Salmon, Moraes, Dror and Shaw, *Parallel random numbers: as easy as 1, 2,
//! 3*, SC11, doi:10.1145/2063384.2063405), a keyed bijection of 256-bit counters.
//!
//! The layout is frozen: a change is a change of values. The key is `[seed, 0]`; block b = 1, 2, … of a
//! stream is the image of the counter `[b, index, purpose, 0]`, and its four words are used in order. NumPy
//! increments the low word before its first block, so [`Stream::new`]`(seed, purpose, index)` gives, word for
//! word, `numpy.random.Philox(key=[seed, 0], counter=[0, index, purpose, 0]).random_raw()`.

use std::convert::Infallible;

use rand_core::TryRng;

use crate::numerics::wide::wide;

/// The purpose of a stream; the numbers are part of the frozen layout.
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
    /// Draws conditional on the state of a contact, after rejection sampling has failed.
    Conditional = 4,
    /// The one threshold that a contact keeps for ever.
    QuenchedThresholds = 5,
    /// Differences between the cells of an interface.
    Cells = 6,
    /// Draws of a law for their own sake: samples, tests, pictures.
    Sample = 7,
    /// The cumulative hazard that a contact survives, drawn for each life.
    Breaking = 8,
    /// The path of a diffusing threshold.
    Diffusion = 9,
    /// Sample paths of the force of many contacts.
    SamplePaths = 10,
    /// Chains of draws from a posterior.
    Posterior = 11,
    /// The times for which a contact is free after its breaks.
    FreeTimes = 12,
    /// Whether a contact is one of those that form as the normal load rises.
    Replacement = 13,
}

/// A stream of random words, addressed by seed, purpose and index.
///
/// Streams that differ in any of the three are independent. A stream has 2⁶⁴ blocks of four words.
/// It is a [`rand_core::Rng`], so every distribution of `rand_distr` can draw from it.
///
/// ```
/// use asperity::random::{Purpose, Stream};
///
/// let mut first = Stream::new(1, Purpose::Thresholds, 17);
/// let mut again = Stream::new(1, Purpose::Thresholds, 17);
/// let mut other = Stream::new(1, Purpose::Thresholds, 18);
/// let number = first.uniform();
/// assert!(number == again.uniform() && number != other.uniform());
/// ```
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

/// Largest number of blocks computed at once: their multiplications overlap.
const AHEAD: usize = 32;

/// Up to this many blocks, pairs are faster than wide registers.
const FEW: usize = 8;

impl Stream {
    /// The stream of `seed` for `purpose`, of the contact or cell number `index`.
    #[must_use]
    #[inline]
    pub fn new(seed: u64, purpose: Purpose, index: u64) -> Self {
        let counter = [0, index, purpose as u64];
        Self { key: seed, counter, words: [0; 4 * AHEAD], used: 0, filled: 0, begun: 0 }
    }

    /// Goes to the stream of another `index`, with the same seed and purpose, at the position `taken` in
    /// words.
    #[inline]
    pub(crate) fn seek(&mut self, index: u64, taken: u64) {
        self.begun = taken / 4;
        self.counter = [self.begun, index, self.counter[2]];
        // The words of the block that lie before are passed over once it is computed.
        (self.used, self.filled) = ((taken % 4) as usize, (taken % 4) as usize);
    }

    /// The number of words taken so far, for [`Stream::seek`].
    #[inline]
    pub(crate) fn taken(&self) -> u64 {
        4 * self.counter[0] + self.used as u64 - 4 * (self.filled as u64 / 4)
    }

    /// The next 64 random bits.
    ///
    /// As many blocks are computed at once as there have been before: a short stream costs no more than
    /// necessary.
    #[inline]
    pub fn word(&mut self) -> u64 {
        if self.used == self.filled {
            self.refill((self.counter[0] - self.begun) as usize);
        }
        let word = self.words[self.used % (4 * AHEAD)];
        self.used += 1;
        word
    }

    /// The next words, at least one and hardly more than `wanted`, without taking them.
    #[inline]
    pub(crate) fn coming(&mut self, wanted: usize) -> &[u64] {
        if self.used == self.filled {
            self.refill(wanted.div_ceil(4));
        }
        &self.words[self.used..self.filled]
    }

    /// Takes words that [`Stream::coming`] has returned.
    #[inline]
    pub(crate) fn skip(&mut self, words: usize) {
        self.used += words;
    }

    /// Computes `blocks` blocks or a few more, at least one and at most [`AHEAD`].
    ///
    /// Out of line, so that `word` is inlined in distributions.
    #[inline(never)]
    fn refill(&mut self, blocks: usize) {
        let [done, index, purpose] = self.counter;
        let (first, key) = ([done.wrapping_add(1), index, purpose, 0], [self.key, 0]);
        let made = fill(&mut self.words, blocks.min(AHEAD), first, key);
        self.filled = 4 * made;
        self.used %= 4;
        self.counter[0] = done.wrapping_add(made as u64);
    }

    /// A uniform number in the open interval (0, 1), from 53 bits.
    ///
    /// It is NumPy's `random()`, whose 0 (once in 2⁵³ draws) becomes 2⁻⁵⁴, so that logarithms and quantiles
    /// of it are finite.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        const ULP: f64 = 1.0 / (1u64 << 53) as f64;
        (((self.word() >> 11) as f64) * ULP).max(0.5 * ULP)
    }

    /// An exponentially distributed number of mean 1, by inversion.
    #[inline]
    pub fn exponential(&mut self) -> f64 {
        -self.uniform().ln()
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

/// Writes the images under `key` of `blocks` counters or a few more, from `first` on; returns their number.
#[inline]
fn fill(words: &mut [u64; 4 * AHEAD], blocks: usize, first: [u64; 4], key: [u64; 2]) -> usize {
    if blocks <= 1 {
        return philox::<1>(words, first, key);
    }
    if blocks > FEW
        && let Some(made) = many(words, blocks, first, key)
    {
        return made;
    }
    let pairs = blocks.div_ceil(2);
    let [block, rest @ ..] = first;
    for (words, i) in words.chunks_exact_mut(8).take(pairs).zip(0..) {
        philox::<2>(words, [block.wrapping_add(2 * i), rest[0], rest[1], rest[2]], key);
    }
    2 * pairs
}

/// The same on wide registers, if the machine has them. Out of line, which makes a single block faster.
#[inline(never)]
fn many(words: &mut [u64; 4 * AHEAD], blocks: usize, first: [u64; 4], key: [u64; 2]) -> Option<usize> {
    wide(
        #[inline(always)]
        || match blocks {
            ..=16 => philox::<16>(words, first, key),
            17..=24 => philox::<24>(words, first, key),
            _ => philox::<AHEAD>(words, first, key),
        },
    )
}

/// Philox4x64-10: the images under `key` of N counters from `first` on, side by side; returns N.
#[inline(always)]
fn philox<const N: usize>(words: &mut [u64], first: [u64; 4], mut key: [u64; 2]) -> usize {
    let mut a: [u64; N] = std::array::from_fn(|i| first[0].wrapping_add(i as u64));
    let [mut b, mut c, mut d] = [[first[1]; N], [first[2]; N], [first[3]; N]];
    for _ in 0..10 {
        for i in 0..N {
            // The multipliers, and below the Weyl increments of the key, are those of the reference
            // implementation: the identity with NumPy's generator depends on them.
            let (high0, low0) = multiply::<0xD2E7_470E_E14C_6C93, N>(a[i]);
            let (high1, low1) = multiply::<0xCA5A_8263_9512_1157, N>(c[i]);
            (a[i], b[i], c[i], d[i]) = (high1 ^ b[i] ^ key[0], low1, high0 ^ d[i] ^ key[1], low0);
        }
        key[0] = key[0].wrapping_add(0x9E37_79B9_7F4A_7C15);
        key[1] = key[1].wrapping_add(0xBB67_AE85_84CA_A73B);
    }
    for (i, block) in words[..4 * N].as_chunks_mut().0.iter_mut().enumerate() {
        *block = [a[i], b[i], c[i], d[i]];
    }
    N
}

/// The high and low word of a product by a constant; for many blocks in steps that wide registers support.
#[inline(always)]
fn multiply<const A: u64, const N: usize>(b: u64) -> (u64, u64) {
    const HALF: u64 = 0xffff_ffff;
    if N <= 2 {
        let product = u128::from(A) * u128::from(b);
        return ((product >> 64) as u64, product as u64);
    }
    let ((a0, a1), (b0, b1)) = ((A & HALF, A >> 32), (b & HALF, b >> 32));
    let left = a1 * b0 + ((a0 * b0) >> 32);
    let right = a0 * b1 + (left & HALF);
    (a1 * b1 + (left >> 32) + (right >> 32), A.wrapping_mul(b))
}

#[cfg(test)]
mod tests {
    use super::{AHEAD, Purpose, Stream, fill, philox};

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
            let mut words = [0; 4];
            philox::<1>(&mut words, counter, key);
            assert_eq!(words, image);
        }
    }

    /// However many are made at once, on whichever registers.
    #[test]
    fn blocks_side_by_side_are_those_one_by_one() {
        let (first, key) = ([u64::MAX - 3, 7, 1, 0], [0x4528_21e6_38d0_1377, 0]);
        let mut expected = [0; 4 * AHEAD];
        for (words, i) in expected.chunks_exact_mut(4).zip(0..) {
            philox::<1>(words, [first[0].wrapping_add(i), 7, 1, 0], key);
        }
        let mut words = [0; 4 * AHEAD];
        philox::<AHEAD>(&mut words, first, key);
        assert_eq!(words, expected);
        for blocks in 1..=AHEAD {
            let mut words = [0; 4 * AHEAD];
            let made = fill(&mut words, blocks, first, key);
            assert!(made >= blocks);
            assert_eq!(words[..4 * made], expected[..4 * made]);
        }
    }
}
