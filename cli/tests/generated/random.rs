//! Random numbers of a case: SplitMix64, so that a case is its number.

/// The generator of Steele, Lea & Flood, OOPSLA 2014.
pub struct SplitMix(u64);

impl SplitMix {
    /// The stream of a case.
    pub fn new(case: u64) -> Self {
        // Streams of successive numbers would be one stream, shifted: the first output is the seed.
        let mut seed = Self(case);
        Self(seed.next())
    }

    /// The stream of a place in a case: what is drawn at one does not depend on which others there are.
    pub fn at(case: u64, place: &str, visit: u64) -> Self {
        // FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo).
        let hash = place.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
        });
        let mut seed = Self(case ^ hash.rotate_left(17));
        Self(seed.next() ^ visit)
    }

    /// The next 64 bits.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to 1, without 1.
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number from one to another.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// A number whose logarithm is uniform.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }

    /// Whether something of this probability happens.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }

    /// One of the items.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[(self.next() % items.len() as u64) as usize]
    }
}
