//! What a program writes that reads a serial port.

use super::*;

/// Samples that are read eight at a time, a millisecond apart, when the last of them is there.
fn in_eights() -> String {
    let arrived = |t: f64| (2.0 * t).floor() / 2.0 + t.rem_euclid(0.5) * 0.016;
    table("time_s,force_n\n", |t, f| format!("{:.4},{f}", arrived(t)))
}

pub fn stamps() -> Vec<Form> {
    vec![
        form(
            "whole seconds, halves to even",
            table("time_s,force_n\n", |t, f| format!("{},{f}", t.round_ties_even())),
            Same,
        ),
        form(
            "eight samples at a time",
            in_eights(),
            Refused(&[
                "the samples come 8 at a time, every 0.500 s: give --rate-hz 16.000 if these are the",
                "arrived, or --rate-hz 1000 if what lies between them is missing",
            ]),
        ),
        form("eight samples at a time, --rate-hz 16", in_eights(), Same)
            .with(|o| o.rate_hz = Some(16.0)),
        form(
            "eight samples at a time, # rate_hz: 16",
            "# rate_hz: 16\n".to_string() + &in_eights(),
            Same,
        ),
        form(
            "eight samples at a time, one lost",
            in_eights().replacen("\n3.0000,", "\n# 3.0000,", 1),
            Noted(""),
        )
        .with(|o| o.rate_hz = Some(16.0)),
    ]
}

pub fn first_lines() -> Vec<Form> {
    let after = || [b"\x00\xF8\x80rce\r\n", plain().as_bytes()].concat();
    vec![
        form(
            "what a port holds at first",
            after(),
            Refused(&["line 1 is no text: take it out, or give --skip-lines 1"]),
        ),
        form("what a port holds at first, --skip-lines 1", after(), Same)
            .with(|o| o.skip_lines = 1),
    ]
}
