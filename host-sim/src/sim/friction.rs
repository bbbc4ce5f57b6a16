//! Friction coefficients, drawn for each event.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use super::scene::Scene;
use super::terms::{PartialSlips, Variation};
use super::wander::Wander;

/// Coefficients of one event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Static coefficient; at the reference time of rest if a law of rest is on.
    pub mu_s: f64,
    /// Dynamic coefficient; at zero speed if a law of speed is on.
    pub mu: f64,
    /// Whether only a part of the contact slips.
    pub partial: bool,
}

/// Generator of the coefficients of successive events.
#[derive(Clone, Debug)]
pub struct Friction {
    mean: Pair,
    /// Least value of both coefficients: with less, the block would slide down the slope by itself.
    least: f64,
    variation: Option<Variation>,
    wander: Option<Wander>,
    level: Option<f64>,
    partial_slips: Option<PartialSlips>,
    random: ChaCha8Rng,
}

impl Friction {
    /// Draws around the scene's coefficients.
    #[must_use]
    pub fn new(scene: &Scene, random: ChaCha8Rng) -> Self {
        let (mu_s, mu) = scene.coefficients();
        Self {
            mean: Pair { mu_s, mu, partial: false },
            least: mu.min(1.01 * scene.steepest()),
            variation: scene.variation,
            wander: scene.wander,
            level: None,
            partial_slips: scene.partial_slips,
            random,
        }
    }

    /// The coefficients of the next event.
    pub fn draw(&mut self) -> Pair {
        let pair = match self.variation {
            Some(variation) => self.vary(variation),
            None => self.mean,
        };
        let pair = match self.wander {
            Some(wander) => self.wandered(pair, wander),
            None => pair,
        };
        let pair = match self.partial_slips {
            Some(partial) => self.reduce(pair, partial),
            None => pair,
        };
        Pair { mu_s: pair.mu_s.max(self.least), mu: pair.mu.max(self.least), ..pair }
    }

    /// With the probability of partial slips, the coefficients of such a slip. The drop of the
    /// force is twice the difference of the coefficients; the dynamic one is at least a tenth of
    /// its full value.
    fn reduce(&mut self, full: Pair, partial: PartialSlips) -> Pair {
        if self.uniform() >= partial.probability {
            return full;
        }
        let difference = full.mu_s - full.mu;
        let mu_s = full.mu + self.uniform() * difference;
        let mu = (mu_s - partial.drop_fraction * difference).max(0.1 * full.mu);
        Pair { mu_s, mu, partial: true }
    }

    fn wandered(&mut self, pair: Pair, wander: Wander) -> Pair {
        let level = wander.next(self.level, &mut self.random);
        self.level = Some(level);
        Pair { mu_s: pair.mu_s * (1.0 + level), mu: pair.mu * (1.0 + level), ..pair }
    }

    fn vary(&mut self, variation: Variation) -> Pair {
        loop {
            let mu_s = self.mean.mu_s * (1.0 + variation.mu_s_fraction * self.normal());
            let mu = self.mean.mu * (1.0 + variation.mu_fraction * self.normal());
            if mu > 0.0 && mu_s >= mu {
                return Pair { mu_s, mu, partial: false };
            }
        }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }

    fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.random)
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::{self, Stream};
    use super::*;

    #[test]
    fn no_draw_lets_the_block_slide_down_by_itself() {
        let scene = Scene {
            slope_deg: -36.0,
            variation: Some(Variation { mu_s_fraction: 0.3, mu_fraction: 0.3 }),
            wander: Some(Wander { fraction: 0.2, events: 3.0 }),
            partial_slips: Some(PartialSlips { probability: 0.5, drop_fraction: 1.0 }),
            ..Scene::default()
        };
        let mut friction = Friction::new(&scene, random::stream(1, Stream::Friction));
        for pair in (0..1000).map(|_| friction.draw()) {
            assert!(pair.mu_s >= pair.mu && pair.mu > 36_f64.to_radians().tan(), "{pair:?}");
        }
    }
}
