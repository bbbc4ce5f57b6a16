//! Correlated noise: an autoregressive process of order one.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::check::{SceneError, between, not_negative};

/// `n[i] = correlation n[i-1] + sqrt(1 - correlation²) std_n z[i]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coloured {
    /// Standard deviation, N.
    pub std_n: f64,
    /// Correlation of neighbours, -0.999 to 0.999.
    pub correlation: f64,
}

impl Coloured {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        not_negative("measurement.coloured.std_n", self.std_n)?;
        between("measurement.coloured.correlation", self.correlation, -0.999, 0.999)
    }
}

/// The process, sample by sample.
#[derive(Clone, Debug)]
pub(super) struct Process {
    law: Coloured,
    value_n: f64,
    random: ChaCha8Rng,
}

impl Process {
    pub(super) fn new(law: Coloured, mut random: ChaCha8Rng) -> Self {
        let z: f64 = StandardNormal.sample(&mut random);
        Self { law, value_n: law.std_n * z, random }
    }

    pub(super) fn next_n(&mut self) -> f64 {
        let value_n = self.value_n;
        let z: f64 = StandardNormal.sample(&mut self.random);
        let Coloured { std_n, correlation } = self.law;
        self.value_n = correlation * value_n + (1.0 - correlation * correlation).sqrt() * std_n * z;
        value_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::random::{self, Stream};

    #[test]
    fn variance_and_correlation_are_as_asked() {
        let law = Coloured { std_n: 3.0, correlation: 0.8 };
        let mut process = Process::new(law, random::stream(4, Stream::Coloured));
        let x: Vec<f64> = (0..200_000).map(|_| process.next_n()).collect();
        let moment = |lag: usize| {
            x.iter().zip(x.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / x.len() as f64
        };
        assert!((moment(0) / 9.0 - 1.0).abs() < 0.03, "{}", moment(0));
        for (lag, expected) in [(1, 0.8), (3, 0.512)] {
            assert!((moment(lag) / moment(0) - expected).abs() < 0.02);
        }
    }
}
