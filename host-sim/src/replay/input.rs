//! The numbers of a test: the caller's, the log's, and the limits of each.

use crate::error::InputError;
use crate::log::Log;
use crate::rounding::short;

/// Largest number of a test, in any unit: far above that of any block or winch.
const LARGEST: f64 = 1e9;
/// Smallest number of a quantity that must be above zero.
const SMALLEST: f64 = 1e-9;
/// Steepest slope, degrees: just below the limit of the core.
const STEEPEST_DEG: f64 = 68.7;
/// Largest damping that the core accepts.
const MOST_DAMPING: f64 = 0.3;

/// A number of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Key of the number in the log.
    pub key: &'static str,
    /// The caller's number, which takes precedence.
    pub given: Option<f64>,
    /// The log's number, used where the caller gives none.
    pub said: Option<f64>,
}

impl Input {
    /// Name of the command-line option: the key with hyphens and without `_percent`.
    fn option(&self) -> String {
        format!("--{}", self.key.trim_end_matches("_percent").replace('_', "-"))
    }

    /// Smallest and largest permitted value.
    fn limits(&self) -> [f64; 2] {
        match self.key {
            "slope_deg" => [-STEEPEST_DEG, STEEPEST_DEG],
            "damping_std" => [0.0, MOST_DAMPING],
            "zero_before_n" | "zero_after_n" => [-LARGEST, LARGEST],
            key if key.contains("_std") => [0.0, LARGEST],
            _ => [SMALLEST, LARGEST],
        }
    }

    /// Checks the number that is used against its limits.
    ///
    /// # Errors
    /// The number is out of its limits; the message names the option or the line of the log.
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

    /// Every option that is named exists, and a value out of limits is reported with the option's
    /// name.
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
