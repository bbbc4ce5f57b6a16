//! A pull on a PC: a force a sample in, an event a slip out.

use floe_core::{Config, ConfigError, Newtons, Pipeline, RawSample, Reading};

fn main() -> Result<(), ConfigError> {
    let config = Config { weight_n: 630.0, ..Config::default() };
    let mut pipeline = Pipeline::new(&config)?;
    for index in 0..1920 {
        let reading = Reading::Force(Newtons(force_n(index as f32 / config.rate_hz)));
        let Some(event) = pipeline.step(RawSample { index, reading }).event else { continue };
        if let (Some(mu_s), Some(mu)) = (event.mu_s, event.mu) {
            println!("mu_s {:.3} ± {:.3}", mu_s.value, mu_s.std);
            println!("mu   {:.3} ± {:.3}", mu.value, mu.std);
        }
    }
    let report = pipeline.report();
    if let Some(mean) = report.mu {
        println!("{} events, mean mu {:.4}", report.events, mean.mean);
    }
    Ok(())
}

/// A block of 630 N with `mu_s` 1.24 and `mu` 0.78: line, ellipse, line.
pub(crate) fn force_n(time_s: f32) -> f32 {
    const PULL_N_PER_S: f32 = 360.0;
    const OMEGA: f32 = 18.92;
    let (highest_n, centre_n) = (1.24 * 630.0, 0.78 * 630.0);
    let half_n = highest_n - centre_n;
    let stick_s = 2.0 * half_n / PULL_N_PER_S;
    let slip_s = 2.0 / OMEGA * (core::f32::consts::PI - (half_n * OMEGA / PULL_N_PER_S).atan());
    let in_cycle_s = time_s % (stick_s + slip_s);
    if in_cycle_s < stick_s {
        return centre_n - half_n + PULL_N_PER_S * in_cycle_s;
    }
    let (sine, cosine) = (OMEGA * (in_cycle_s - stick_s)).sin_cos();
    centre_n + half_n * cosine + PULL_N_PER_S / OMEGA * sine
}
