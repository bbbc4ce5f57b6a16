//! Random numbers: one seed and an independent stream for each purpose, so that turning a term on
//! does not change the numbers of those with another purpose.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Purpose of a stream of random numbers.
#[derive(Clone, Copy, Debug)]
pub enum Stream {
    /// White noise.
    White = 0,
    /// Coefficients of the events.
    Friction = 1,
    /// 1/f noise.
    Flicker = 2,
    /// Spikes, dropped, repeated and late samples.
    Faults = 3,
    /// Coloured noise.
    Coloured = 4,
    /// Jitter of the time stamps.
    Jitter = 5,
    /// Pauses of the winch.
    Winch = 6,
}

/// The generator for a purpose.
#[must_use]
pub fn stream(seed: u64, stream: Stream) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream as u64);
    random
}
