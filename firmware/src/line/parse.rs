//! Parsing of lines, used by the host.

use crate::weighing::{Load, Swing};
use floe_core::{
    Calibration, Change, Coefficient, Config, Counters, Estimate, Event, InputStd, Provisional,
    Quantity, Report, SampleTime, Stretch, StretchKind,
};
use heapless::String;

use super::fields::Reader;
use super::{About, Health, Line, LineError, LiveSample, Mean, Weighed, checksum};
use crate::measuring::Hindrance;
use crate::notebook::Notes;
use crate::settings::{Effects, Settings, Stds, Zero};

impl<'a> Line<'a> {
    /// Parses a line, with or without its end (CR, LF, spaces).
    ///
    /// # Errors
    /// The defect of the line.
    pub fn parse(text: &'a str) -> Result<Self, LineError> {
        let (body, sum) = text.trim_end().rsplit_once('*').ok_or(LineError::NoChecksum)?;
        let sum = u16::from_str_radix(sum, 16).map_err(|_| LineError::NoChecksum)?;
        if sum != checksum(body) {
            return Err(LineError::Checksum);
        }
        let (kind, fields) = body.split_once(',').ok_or(LineError::UnknownKind)?;
        let from = &mut Reader(fields.split(','));
        Ok(match kind {
            "T" => Line::Start { run: from.take()?, settings: settings(from)? },
            "S" => Line::Sample(live_sample(from)?),
            "P" => Line::Spike(from.take()?),
            "A" => Line::About(about(from)?),
            "E" => Line::Event(event(from)?),
            "C" => Line::Change(change(from)?.ok_or(LineError::Field)?),
            "F" => Line::Stretch(stretch(from)?),
            "R" => Line::Report(report(from)?),
            "Z" => Line::End { run: from.take()? },
            "H" => Line::Health(health(from)?),
            "M" => Line::Mean(mean(from)?),
            "G" => Line::Weighed(weighed(from)?),
            "N" => Line::Note(fields),
            "W" => Line::Mark { index: from.take()?, winch: from.take_word()? },
            "Y" => Line::Sync { index: from.take()?, unix_ms: from.take()? },
            "K" => Line::Climate {
                index: from.take()?,
                temperature_c: from.take_some()?,
                supply_v: from.take_some()?,
            },
            "I" => Line::Info(fields),
            "!" => Line::Trouble(fields),
            _ => return Err(LineError::UnknownKind),
        })
    }
}

fn settings(from: &mut Reader<'_>) -> Result<Settings, LineError> {
    let name = String::try_from(from.text()?).map_err(|_| LineError::Field)?;
    let config = Config {
        rate_hz: from.take()?,
        weight_n: from.take()?,
        mass_kg: None,
        slope_rad: from.take()?,
        winch_m_per_s: from.take_some()?,
        range_n: from.take_some()?,
        calibration: Calibration {
            tare_counts: from.take()?,
            counts_per_n: from.take()?,
            range_counts: (from.take()?, from.take()?),
        },
        effects: floe_core::Effects::default(),
        // See `Settings::core_config`.
        std: InputStd::default(),
    };
    let mut settings = Settings {
        config,
        name,
        weight_from: from.take_late_word()?,
        stds: Stds {
            weight_n: from.take_late()?,
            slope_rad: from.take_late()?,
            zero_n: from.take_late()?,
            span: from.take_late()?,
            damping: from.take_late()?,
            winch_m_per_s: None,
        },
        zero: Zero { before_n: from.take_late()?, after_n: from.take_late()? },
        notes: Notes {
            kind: from.take_late_word()?,
            track: from.take_late_word()?,
            snow_mm: from.take_late()?,
            length_m: from.take_late()?,
            width_m: from.take_late()?,
            height_m: from.take_late()?,
            cable_length_m: from.take_late()?,
            cable_ae_n: from.take_late()?,
        },
        effects: Effects { enabled: from.take_late()?, compiled: from.take_late()? },
    };
    settings.stds.winch_m_per_s = from.take_late()?;
    Ok(settings)
}

fn live_sample(from: &mut Reader<'_>) -> Result<LiveSample, LineError> {
    Ok(LiveSample {
        index: from.take()?,
        force_n: from.take_some()?,
        flag: from.take_word()?,
        phase: from.take_word()?,
        gap: from.take()?,
        rate_n_per_s: from.take_late()?,
    })
}

fn weighed(from: &mut Reader<'_>) -> Result<Weighed, LineError> {
    let duration_s = from.take()?;
    let (value, std) = (from.take_some()?, from.take_some()?);
    let (period_s, amplitude_rad) = (from.take_some()?, from.take_some()?);
    let excess = from.take_some()?;
    let why = from.take_some_word()?;
    let swing = (period_s.zip(amplitude_rad).zip(excess))
        .map(|((period_s, amplitude_rad), excess)| Swing { period_s, amplitude_rad, excess });
    let load = value.zip(std).map(|(value, std)| Load { value, std, swing });
    Ok(Weighed { duration_s, load: load.ok_or(why.unwrap_or(Hindrance::Short)) })
}

fn about(from: &mut Reader<'_>) -> Result<About, LineError> {
    let index = from.take()?;
    let (mut mu_s, mut mu) = (coefficient(from)?, coefficient(from)?);
    systematic(from, &mut mu_s)?;
    systematic(from, &mut mu)?;
    let mu_s = mu_s.ok_or(LineError::Field)?;
    Ok(About { index, answer: Provisional { mu_s, mu } })
}

fn event(from: &mut Reader<'_>) -> Result<Event, LineError> {
    let mut event = Event {
        index: from.take()?,
        onset: time(from)?,
        stop: time(from)?,
        static_force_n: from.take()?,
        dynamic_force_n: from.take()?,
        peak_force_n: from.take()?,
        restick_force_n: from.take()?,
        mu_s: coefficient(from)?,
        mu: coefficient(from)?,
        stick_s: from.take_some()?,
        slip_s: from.take()?,
        loading_rate_n_per_s: from.take()?,
        omega_rad_per_s: from.take_some()?,
        slack: from.take_word()?,
        quality: from.take_word()?,
        reason: from.take_some_word()?,
    };
    systematic(from, &mut event.mu_s)?;
    systematic(from, &mut event.mu)?;
    Ok(event)
}

fn time(from: &mut Reader<'_>) -> Result<SampleTime, LineError> {
    Ok(SampleTime { index: from.take()?, fraction: from.take()? })
}

fn coefficient(from: &mut Reader<'_>) -> Result<Option<Coefficient>, LineError> {
    let (value, std) = (from.take_some()?, from.take_some()?);
    Ok(value.zip(std).map(|(value, std)| Coefficient::random(value, std)))
}

fn systematic(from: &mut Reader<'_>, of: &mut Option<Coefficient>) -> Result<(), LineError> {
    let std = from.take_late()?;
    if let (Some(coefficient), Some(std)) = (of, std) {
        coefficient.systematic_std = std;
    }
    Ok(())
}

fn report(from: &mut Reader<'_>) -> Result<Report, LineError> {
    let quantity = |value: Option<f32>| value.map(|value| Quantity { value, std: 0.0 });
    let mut report = Report {
        counters: Counters {
            samples: from.take()?,
            missing: from.take()?,
            duplicates: from.take()?,
            rejected: from.take()?,
            saturated: from.take()?,
        },
        events: from.take()?,
        mu_s: estimate(from)?,
        mu: estimate(from)?,
        noise_n: from.take_some()?,
        loading_rate_n_per_s: quantity(from.take_some()?),
        omega_rad_per_s: quantity(from.take_some()?),
        stiffness_n_per_m: from.take_some()?,
        recurrence_s: from.take_some()?,
        change: change(from)?,
        zero_n: from.take_late()?,
        zero_std_n: 0.0,
        zero_drift_n: 0.0,
        damping_std: 0.0,
        weight_ratio: 1.0,
        weight_ratio_std: 0.0,
        found: floe_core::Effects::NONE,
    };
    uncertainty(from, &mut report)?;
    Ok(report)
}

/// Reads the uncertainties, which lines of older boards lack.
fn uncertainty(from: &mut Reader<'_>, report: &mut Report) -> Result<(), LineError> {
    for estimate in [&mut report.mu_s, &mut report.mu] {
        let all = (from.take_late()?, from.take_late()?, from.take_late()?);
        if let (Some(estimate), (Some(freedom), Some(systematic_std), Some(common_std))) =
            (estimate, all)
        {
            *estimate = Estimate { freedom, systematic_std, common_std, ..*estimate };
        }
    }
    for quantity in [&mut report.loading_rate_n_per_s, &mut report.omega_rad_per_s] {
        if let (Some(quantity), Some(std)) = (quantity, from.take_late()?) {
            quantity.std = std;
        }
    }
    report.zero_std_n = from.take_late()?.unwrap_or(0.0);
    report.zero_drift_n = from.take_late()?.unwrap_or(0.0);
    report.weight_ratio = from.take_late()?.unwrap_or(1.0);
    report.weight_ratio_std = from.take_late()?.unwrap_or(0.0);
    report.damping_std = from.take_late()?.unwrap_or(0.0);
    report.found = from.take_late()?.map_or(report.found, floe_core::Effects::from_mask);
    Ok(())
}

fn change(from: &mut Reader<'_>) -> Result<Option<Change>, LineError> {
    let Some(event) = from.take_late()? else { return Ok(None) };
    Ok(Some(Change {
        event,
        onset: time(from)?,
        cause: from.take_word()?,
        weight_ratio: from.take()?,
        weight_ratio_std: from.take()?,
    }))
}

fn stretch(from: &mut Reader<'_>) -> Result<Stretch, LineError> {
    let (reason, start, stop) = (from.take_some_word()?, time(from)?, time(from)?);
    let kind = match reason {
        Some(reason) => StretchKind::NotUnderstood(reason),
        None => StretchKind::Steady {
            force_over_weight: from.take()?,
            std: from.take()?,
            moving: from.take_some_word()?,
        },
    };
    Ok(Stretch { start, stop, kind })
}

fn estimate(from: &mut Reader<'_>) -> Result<Option<Estimate>, LineError> {
    let (mean, std_error) = (from.take_some()?, from.take_some()?);
    let (spread, events) = (from.take_some()?, from.take_some()?.unwrap_or(0));
    // Lines of older boards lack these; the values mean no uncertainty.
    let (freedom, systematic_std, common_std) = (f32::INFINITY, 0.0, 0.0);
    Ok(mean.map(|mean| Estimate {
        mean,
        std_error,
        freedom,
        systematic_std,
        common_std,
        spread,
        events,
    }))
}

fn health(from: &mut Reader<'_>) -> Result<Health, LineError> {
    Ok(Health {
        samples: from.take()?,
        overruns: from.take()?,
        deepest: from.take()?,
        adc_faults: from.take()?,
        saturated: from.take()?,
        period_s: from.take_some()?,
        jitter_s: from.take_some()?,
        sectors: from.take()?,
        store_failures: from.take()?,
    })
}

fn mean(from: &mut Reader<'_>) -> Result<Mean, LineError> {
    Ok(Mean {
        input: from.take_word()?,
        count: from.take()?,
        failed: from.take()?,
        mean: from.take()?,
        deviation: from.take()?,
        different: from.take()?,
    })
}
