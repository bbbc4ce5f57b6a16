//! The pull of `host` with noise, and every effect switched off. A build without the effects says
//! the same of it, bit for bit: `cargo xtask test` holds the two against each other.

use floe_core::{Config, ConfigError, Effects, Newtons, Pipeline, RawSample, Reading};

#[allow(dead_code, reason = "its own main")]
mod host;

fn main() -> Result<(), ConfigError> {
    let config = Config { weight_n: 630.0, effects: Effects::NONE, ..Config::default() };
    let mut pipeline = Pipeline::new(&config)?;
    let mut random = 1_u32;
    for index in 0..1920 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // Even between -3.5 and 3.5 N: a standard deviation of 2 N.
        let noise_n = 7.0 * (random as f32 / u32::MAX as f32 - 0.5);
        let force_n = host::force_n(index as f32 / config.rate_hz) + noise_n;
        let step = pipeline.step(RawSample { index, reading: Reading::Force(Newtons(force_n)) });
        if step.provisional.is_some() || step.event.is_some() {
            println!("{step:?}");
        }
    }
    println!("{:?}", pipeline.report());
    Ok(())
}
