//! The configuration of a test: from the options, else from the log.

use floe_core::{Calibration, Config, Effect, Effects};

use crate::error::InputError;
use crate::log::metadata::Note;
use crate::log::{Log, STANDARD_GRAVITY, Unit};
use crate::replay::input::Input;
use crate::replay::known::{KnownMetadata, KnownOptions};

/// What the caller says about the test.
// A default in brackets, as every help has it, is no link.
#[allow(rustdoc::broken_intra_doc_links)]
#[derive(Clone, Debug, Default, clap::Args)]
pub struct TestOptions {
    /// Weight of the block in newtons [default: `# weight_n:` in the log]
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    pub weight_n: Option<f64>,
    /// Mass of the block in kilograms, instead of its weight (times 9.80665 m/s²)
    #[arg(long, value_name = "M", allow_negative_numbers = true, conflicts_with = "weight_n")]
    pub mass_kg: Option<f64>,
    /// Normal force in newtons of a block that is pulled along the underside of the ice, where
    /// buoyancy less weight presses it: the coefficients are of it, and --mass-kg is the mass
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "weight_n")]
    pub normal_n: Option<f64>,
    /// Slope of the ice along the pull in degrees, uphill positive
    /// [default: `# slope_deg:` in the log, else 0]
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    pub slope_deg: Option<f64>,
    /// Take-up speed of the winch in m/s
    /// [default: `# winch_m_per_s:` in the log]
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    pub winch_m_per_s: Option<f64>,
    /// Force in newtons from which on the sensor or the converter is at its limit
    /// [default: `# range_n:` in the log]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub range_n: Option<f64>,
    /// What to look for beyond the linear model: auto (the data decide), none, or names
    #[arg(long, value_name = "auto|none|LIST", value_parser = effects, help = effects_help())]
    pub effects: Option<Effects>,
    /// Converter code at zero force, for --unit counts
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    pub tare_counts: Option<i32>,
    /// Converter codes per newton, for --unit counts
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub counts_per_n: Option<f64>,
    /// How well all this is known.
    #[command(flatten)]
    pub known: Box<KnownOptions>,
}

/// What `--help` says of them.
fn effects_help() -> String {
    format!(
        "What to look for beyond the linear model: auto (the data decide), none, or names with \
         commas between them: {} [default: auto, or what the log says]",
        names()
    )
}

/// Names of all effects.
fn names() -> String {
    Effect::ALL.map(Effect::name).join(", ")
}

/// An effect of earlier versions that improved no scene: logs and scripts may still name it.
const RETIRED: &str = "forgetting";

/// Parses a set of effects from their names.
///
/// # Errors
/// An unknown name.
fn effects(text: &str) -> Result<Effects, String> {
    match text {
        "auto" => return Ok(Effects::default()),
        "none" => return Ok(Effects::NONE),
        _ => {}
    }
    let mut asked = text.split(',').map(str::trim).filter(|&name| name != RETIRED);
    asked.try_fold(Effects::NONE, |set, name| {
        let effect = Effect::named(name).ok_or_else(|| {
            format!("no effect is called '{name}': auto, none, or some of {}", names())
        })?;
        Ok(set.with(effect, true))
    })
}

/// The effects that the log names; all if it names none.
fn said_effects(log: &Log) -> Result<Effects, InputError> {
    let said = log.metadata().effects.as_deref().unwrap_or("auto");
    effects(said).map_err(|error| {
        let line = log.metadata().line("effects").unwrap_or_default();
        InputError::new(format!("line {line}: '# effects: {said}': {error}"))
    })
}

/// The core's configuration for a log.
///
/// # Errors
/// The weight is not known, a force in counts has no calibration, or a value is
/// out of its range.
pub fn configure(log: &Log, options: &TestOptions) -> Result<Config, InputError> {
    options.inputs(log).try_for_each(|input| input.check(log))?;
    let said = log.metadata();
    let slope_deg = options.slope_deg.or(said.slope_deg).unwrap_or(0.0);
    let Pressed { force_n: weight_n, mass_kg } = pressed(log, options, slope_deg)?;
    let effects = options.effects.map_or_else(|| said_effects(log), Ok)?;
    let drifts = effects.has(Effect::Drift) && options.known.both_zeros(&said.known).is_none();
    let winch_m_per_s = options.winch_m_per_s.or(said.winch_m_per_s);
    let config = Config {
        rate_hz: log.rate_hz() as f32,
        weight_n: weight_n as f32,
        mass_kg: mass_kg.map(|mass| mass as f32),
        slope_rad: slope_deg.to_radians() as f32,
        winch_m_per_s: winch_m_per_s.map(|speed| speed as f32),
        range_n: options.range_n.or(said.range_n).map(|range| range as f32),
        calibration: calibration(log, options)?,
        effects: effects.with(Effect::Drift, drifts),
        std: options.known.std(&said.known, weight_n, winch_m_per_s),
    };
    config.validate().map_err(InputError::new)?;
    Ok(config)
}

/// The force that presses the block onto the ice.
struct Pressed {
    /// Weight of the block, or the normal force under the ice, N.
    force_n: f64,
    /// Mass of the block, kg, where it is not the force over gravity.
    mass_kg: Option<f64>,
}

fn pressed(log: &Log, options: &TestOptions, slope_deg: f64) -> Result<Pressed, InputError> {
    let said = log.metadata();
    let refuse = |why: &str| Err(InputError::new(why));
    let normal_n =
        if options.weight_n.is_some() { None } else { options.normal_n.or(said.normal_n) };
    if let Some(force_n) = normal_n {
        return match options.mass_kg.or(said.mass_kg) {
            None => refuse(
                "under the ice the mass moves and the normal force presses: \
                            --normal-n needs --mass-kg M, or '# mass_kg: M' in the log",
            ),
            Some(_) if slope_deg.abs() > 0.0 => {
                refuse("a block under the ice is pulled level: leave the slope out, or --normal-n")
            }
            mass_kg => Ok(Pressed { force_n, mass_kg }),
        };
    }
    let mass_kg = options.mass_kg.or_else(|| said.mass_kg.filter(|_| said.weight_n.is_none()));
    let of_mass = mass_kg.map(|mass| mass * STANDARD_GRAVITY);
    match options.weight_n.or(of_mass).or(said.weight_n) {
        Some(force_n) => Ok(Pressed { force_n, mass_kg: None }),
        None => Err(no_weight(&said.notes)),
    }
}

/// The error for an unknown weight; it names a line of the log that looks like a misspelt weight.
fn no_weight(notes: &[Note]) -> InputError {
    let meant = notes.iter().find(|note| ["weight_n", "mass_kg"].contains(&note.key.as_str()));
    InputError::new(match meant {
        Some(note) => format!("the block's weight is not known: {}", note.text),
        None => "the block's weight is not known: give --weight-n W or --mass-kg M, \
                 or put '# weight_n: W' into the log"
            .to_string(),
    })
}

impl TestOptions {
    /// The settings that the core does not need.
    #[must_use]
    pub fn around(&self) -> Around {
        Around { known: *self.known, keeps_means: false }
    }

    /// The numbers of the test, without the calibration.
    pub fn inputs(&self, log: &Log) -> impl Iterator<Item = Input> {
        let said = log.metadata();
        // A weight or mass of the caller replaces both of the log.
        let is_given = self.weight_n.or(self.mass_kg).is_some();
        let weighed = |said: Option<f64>| said.filter(|_| !is_given);
        let normal_n = said.normal_n.filter(|_| self.weight_n.is_none());
        let own = [
            ("weight_n", self.weight_n, weighed(said.weight_n)),
            ("mass_kg", self.mass_kg, weighed(said.mass_kg)),
            ("normal_n", self.normal_n, normal_n),
            ("slope_deg", self.slope_deg, said.slope_deg),
            ("winch_m_per_s", self.winch_m_per_s, said.winch_m_per_s),
            ("range_n", self.range_n, said.range_n),
        ];
        let own = own.map(|(key, given, said)| Input { key, given, said });
        own.into_iter().chain(self.known.inputs(&said.known))
    }

    /// Keys of a log that these options replace.
    pub fn settles(&self) -> impl Iterator<Item = &'static str> {
        let is_weighed = self.weight_n.or(self.mass_kg).is_some();
        let own = [
            ("weight_n", is_weighed || self.normal_n.is_some()),
            ("mass_kg", is_weighed),
            ("normal_n", self.normal_n.or(self.weight_n).is_some()),
            ("slope_deg", self.slope_deg.is_some()),
            ("winch_m_per_s", self.winch_m_per_s.is_some()),
            ("range_n", self.range_n.is_some()),
            ("effects", self.effects.is_some()),
            ("tare_counts", self.tare_counts.is_some()),
            ("counts_per_n", self.counts_per_n.is_some()),
            ("weight_from", self.known.weight_from.is_some()),
        ];
        let known = self.known.inputs(&KnownMetadata::default());
        let known = known.map(|input| (input.key, input.given.is_some()));
        own.into_iter().chain(known).filter(|(_, is_given)| *is_given).map(|(key, _)| key)
    }
}

/// Settings of a replay that the core does not need.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Around {
    /// Whether the means after each event are kept, for a report to draw.
    pub keeps_means: bool,
    /// Uncertainties of the inputs, and the zero to subtract.
    pub known: KnownOptions,
}

/// Converter codes to newtons, if the log is in codes.
///
/// # Errors
/// A force in counts without a calibration.
pub fn calibration(log: &Log, options: &TestOptions) -> Result<Calibration, InputError> {
    let said = log.metadata();
    let calibration = Calibration::default();
    if log.unit() != Unit::Counts {
        let given = options.tare_counts.is_some() || options.counts_per_n.is_some();
        let unit = log.unit().name();
        return if given { Err(no_counts(unit)) } else { Ok(calibration) };
    }
    let missing = "a force in counts needs --tare-counts and --counts-per-n, \
                   or '# tare_counts:' and '# counts_per_n:' in the log";
    let tare = options.tare_counts.or(said.tare_counts.map(|tare| tare.round() as i32));
    let span = options.counts_per_n.or(said.counts_per_n);
    let (Some(tare_counts), Some(span)) = (tare, span) else {
        return Err(InputError::new(missing));
    };
    if !span.is_finite() || span == 0.0 {
        return Err(InputError::new(format!(
            "counts_per_n is {span}: --counts-per-n, or '# counts_per_n:' in the log, must be a number \
             that is not zero"
        )));
    }
    let range_counts = range_counts(tare_counts, calibration.range_counts);
    Ok(Calibration { tare_counts, counts_per_n: span as f32, range_counts })
}

/// Codes of the converter: those of 24 bits with a sign, unless the one at zero force is beyond them;
/// then of 24 bits from 0 on, as the HX711's data sheet reads them, else of 32 bits.
fn range_counts(tare_counts: i32, signed: (i32, i32)) -> (i32, i32) {
    const UNSIGNED: (i32, i32) = (0, (1 << 24) - 1);
    let holds = |range: &(i32, i32)| (range.0..range.1).contains(&tare_counts);
    [signed, UNSIGNED].into_iter().find(holds).unwrap_or((i32::MIN, i32::MAX))
}

fn no_counts(unit: &str) -> InputError {
    InputError::new(format!(
        "--tare-counts and --counts-per-n are for a force in counts, and this one is in {unit}: leave \
         them out, or give --unit counts"
    ))
}
