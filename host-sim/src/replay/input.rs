//! The numbers of a test: which the caller gives, which the log says, and which there can be.

use crate::error::InputError;
use crate::log::Log;
use crate::rounding::short;

/// Largest number that a test can have: no block, and no winch, has more of anything.
const LARGEST: f64 = 1e9;
/// Smallest of what is above zero.
const SMALLEST: f64 = 1e-9;
/// Steepest slope, degrees: just within that of the core.
const STEEPEST_DEG: f64 = 68.7;
/// Most damping that the core takes into account.
const MOST_DAMPING: f64 = 0.3;

/// A number of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// The log's word for it.
    pub key: &'static str,
    /// The caller's number, which counts.
    pub given: Option<f64>,
    /// The log's, if it is used where the caller gives none.
    pub said: Option<f64>,
}

impl Input {
    /// The option that gives it: named like the key, but for the unit of a percentage.
    fn option(&self) -> String {
        format!("--{}", self.key.trim_end_matches("_percent").replace('_', "-"))
    }

    /// Least and most that it may be.
    fn limits(&self) -> [f64; 2] {
        match self.key {
            "slope_deg" => [-STEEPEST_DEG, STEEPEST_DEG],
            "damping_std" => [0.0, MOST_DAMPING],
            "zero_before_n" | "zero_after_n" => [-LARGEST, LARGEST],
            key if key.contains("_std") => [0.0, LARGEST],
            _ => [SMALLEST, LARGEST],
        }
    }

    /// Refuses a number that cannot be.
    ///
    /// # Errors
    /// Names the option, or the line of the log, and what may be.
    pub fn check(&self, log: &Log) -> Result<(), InputError> {
        let [least, most] = self.limits();
        let Some(number) = self.given.or(self.said).filter(|it| !(least..=most).contains(it))
        else {
            return Ok(());
        };
        let least = if least > 0.0 { "above zero," } else { &format!("from {}", short(least)) };
        let must = format!("must be a number {least} up to {}, not {}", short(most), short(number));
        let (key, option) = (self.key, self.option());
        Err(InputError::new(match self.given.map_or_else(|| log.metadata().line(key), |_| None) {
            Some(line) => format!("line {line}: '# {key}:' {must}: correct it, or give {option}"),
            None => format!("{option} {must}"),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::test::TestOptions;
    use floe_core::{Config, InputStd};

    #[test]
    fn the_limits_are_those_of_the_core() {
        assert_eq!((MOST_DAMPING as f32).to_bits(), InputStd::MOST_DAMPING.to_bits());
        let steepest_deg = f64::from(Config::STEEPEST_RAD).to_degrees();
        assert!((0.0..0.1).contains(&(steepest_deg - STEEPEST_DEG)), "{steepest_deg}");
    }

    /// Every option that is named can be given, and where it is out of limits that is said of it.
    #[test]
    fn every_input_has_its_option_and_its_limits() {
        let log = "# test_id: A\ntime_s,force_n\n0,1\n0.0625,2\n";
        let log = Log::from_reader(Box::new(log.as_bytes()), &Default::default()).unwrap();
        let command = <TestOptions as clap::Args>::augment_args(clap::Command::new("test"));
        for input in TestOptions::default().inputs(&log) {
            let option = input.option();
            let is_one = |arg: &clap::Arg| arg.get_long() == option.strip_prefix("--");
            assert!(command.get_arguments().any(is_one), "{option}");
            for wrong in [f64::NAN, f64::NEG_INFINITY, 1e300] {
                let wrong = Input { given: Some(wrong), ..input };
                let said = wrong.check(&log).unwrap_err().to_string();
                assert!(said.starts_with(&format!("{option} must be a number ")), "{said}");
            }
            assert_eq!(input.check(&log), Ok(()));
        }
    }
}
