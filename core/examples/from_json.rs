//! Configuration and result as JSON: `cargo run --example from_json --features serde`.

use floe_core::{Config, Newtons, Pipeline, RawSample, Reading, Report};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let default = serde_json::to_value(Config::default())?;
    let mut said = default.clone();
    said["weight_n"] = 630.0.into();
    let config: Config = serde_json::from_value(said)?;
    let mut pipeline = Pipeline::new(&config)?;
    for index in 0..32 {
        let _ = pipeline.step(RawSample { index, reading: Reading::Force(Newtons(index as f32)) });
    }
    let text = serde_json::to_string_pretty(&pipeline.report())?;
    let back: Report = serde_json::from_str(&text)?;
    assert_eq!(back, pipeline.report());
    println!("{text}");
    Ok(())
}
