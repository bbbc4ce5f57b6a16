//! Checks of a scene before it is computed.

use time::Date;

use super::{Scene, SceneError, Weighing, WinchProfile};
use crate::rounding::short;
use crate::sim::check::{above_zero, between, not_negative, positive, require};

/// Largest force, stiffness or length; a larger one is a typing error.
const LARGEST: f64 = 1e12;
/// Most samples of a scene: two years at 16 Hz.
const MOST_SAMPLES: f64 = 1e9;
/// Most slips of a scene, and most steps for its winch.
const MOST_SLIPS: f64 = 1e8;

impl Scene {
    /// Checks every value.
    ///
    /// # Errors
    /// The first value out of its range; the message names it.
    pub fn validate(&self) -> Result<(), SceneError> {
        let one_line = self.test_id.as_deref().is_none_or(|id| !id.contains(char::is_control));
        require(one_line, || "test_id: must be one line of plain text".to_owned())?;
        for (name, value, most) in [
            ("duration_s", self.duration_s, 1e8),
            ("stiffness_n_per_m", self.stiffness_n_per_m, LARGEST),
            ("cable_length_m", self.cable_length_m, LARGEST),
            ("winch_m_per_s", self.winch_m_per_s, 100.0),
        ] {
            above_zero(name, value, most)?;
        }
        between("start_force_n", self.start_force_n, 0.0, LARGEST)?;
        between("weight_n", self.weight_n, 1e-3, LARGEST)?;
        between("mu_s", self.mu_s, 0.0, 100.0)?;
        between("rate_hz", self.rate_hz, 1.0, 2000.0)?;
        between("slope_deg", self.slope_deg, -60.0, 60.0)?;
        self.validate_start()?;
        self.validate_terms()?;
        self.validate_friction()?;
        self.validate_length()?;
        self.validate_work()?;
        self.measurement.validate(self.rate_hz)
    }

    fn validate_terms(&self) -> Result<(), SceneError> {
        if let Some(snow) = &self.snow {
            not_negative("snow.depth_mm", snow.depth_mm)?;
            between("snow.mu_s_offset", snow.mu_s_offset, -10.0, 10.0)?;
            between("snow.mu_offset", snow.mu_offset, -10.0, 10.0)?;
        }
        if let Some(variation) = &self.variation {
            between("variation.mu_s_fraction", variation.mu_s_fraction, 0.0, 0.3)?;
            between("variation.mu_fraction", variation.mu_fraction, 0.0, 0.3)?;
        }
        if let Some(partial) = &self.partial_slips {
            between("partial_slips.probability", partial.probability, 0.0, 1.0)?;
            between("partial_slips.drop_fraction", partial.drop_fraction, 0.0, 1.0)?;
        }
        if let Some(creep) = &self.creep {
            between("creep.onset_fraction", creep.onset_fraction, 0.0, 0.99)?;
            positive("creep.range_n", creep.range_n)?;
        }
        if let Some(sag) = &self.sag {
            positive("sag.weight_n_per_m", sag.weight_n_per_m)?;
            positive("sag.height_m", sag.height_m)?;
        }
        if let Some(breaking) = &self.breaking {
            positive("breaking.at_s", breaking.at_s)?;
            positive("breaking.weight_n", breaking.weight_n)?;
        }
        if let Some(drag) = &self.drag {
            not_negative("drag.n_s2_per_m2", drag.n_s2_per_m2)?;
            not_negative("drag.n_s_per_m", drag.n_s_per_m)?;
        }
        self.weighing.as_ref().map_or(Ok(()), |w| self.validate_weighing(w))?;
        self.hold_time.as_ref().map_or(Ok(()), |h| h.validate())?;
        self.rate_dependence.as_ref().map_or(Ok(()), |r| r.validate(self.mu))?;
        self.validate_laws()?;
        self.winch_profile.as_ref().map_or(Ok(()), WinchProfile::validate)
    }

    /// Rejects terms of a pull beside a block that hangs: they would have no effect.
    fn validate_weighing(&self, weighing: &Weighing) -> Result<(), SceneError> {
        between("weighing.swing_deg", weighing.swing_deg, 0.0, 60.0)?;
        positive("weighing.length_m", weighing.length_m)?;
        between("weighing.damping_per_s", weighing.damping_per_s, 0.0, 1000.0)?;
        let others = self.of_motion().into_iter().filter(|(name, on)| *on && *name != "weighing");
        let others: Vec<&str> = others.map(|(name, _)| name).collect();
        require(others.is_empty(), || {
            format!("weighing: the block hangs and is not pulled: leave out {}", others.join(", "))
        })
    }

    /// Rejects laws of friction or of the cable that cannot be combined.
    fn validate_laws(&self) -> Result<(), SceneError> {
        self.wander.as_ref().map_or(Ok(()), |w| w.validate())?;
        self.stribeck.as_ref().map_or(Ok(()), |s| s.validate())?;
        self.along_slip.as_ref().map_or(Ok(()), |a| a.validate())?;
        self.rocking.as_ref().map_or(Ok(()), |r| r.validate())?;
        if let Some(law) = &self.rate_and_state {
            law.validate(self.mu)?;
            let other = self.stribeck.is_some()
                || self.rate_dependence.is_some()
                || self.hold_time.is_some()
                || self.creep.is_some();
            require(!other, || {
                "rate_and_state: has its own law of speed, rest and creep: leave out stribeck, \
                 rate_dependence, hold_time and creep"
                    .to_owned()
            })?;
        }
        let Some(damping) = &self.cable_damping else { return Ok(()) };
        damping.validate()?;
        let ripples = matches!(self.winch_profile, Some(WinchProfile::Ripple { .. }));
        require(!ripples, || "cable_damping: not with a winch that ripples".to_owned())
    }

    /// Checks that the block rests on the slope without the cable: the state machine has no sliding
    /// back.
    fn validate_friction(&self) -> Result<(), SceneError> {
        let (mu_s, mu) = self.coefficients();
        positive("mu", self.mu)?;
        positive("mu with snow", mu)?;
        require(mu_s.is_finite() && mu_s >= mu, || {
            format!("mu_s = {}: must be a number not below mu = {}", short(mu_s), short(mu))
        })?;
        let end_deg = self.end_deg();
        require(end_deg.abs() < 60.0 && self.steepest() < mu, || {
            format!(
                "slope_deg, {} to {end_deg:.1}: a block with mu = {mu} slides down by itself",
                self.slope_deg
            )
        })
    }

    /// Slope at the end of the test, degrees.
    fn end_deg(&self) -> f64 {
        self.slope_deg + self.tilt.map_or(0.0, |t| t.deg_per_m) * self.way_m()
    }

    /// Tangent of the steepest slope in the test, up or down.
    pub(in crate::sim) fn steepest(&self) -> f64 {
        let [start, end] = [self.slope_deg, self.end_deg()].map(|deg| deg.to_radians().tan().abs());
        start.max(end)
    }

    /// Distance that the winch takes up, m.
    fn way_m(&self) -> f64 {
        self.winch_m_per_s * self.duration_s
    }

    /// Checks that the block does not run into the winch.
    fn validate_length(&self) -> Result<(), SceneError> {
        let needs_room = self.shortening || self.sag.is_some();
        let largest_n = (self.weight_n * (self.coefficients().0 + 1.0)).max(self.start_force_n);
        // A slip is up to twice as long as the stretch; the rest is a margin for what varies.
        let needed_m = self.way_m() + 3.0 * largest_n / self.stiffness_n_per_m;
        require(!needs_room || needed_m < self.cable_length_m, || {
            format!(
                "cable_length_m = {}: in {} s the winch and the last slip take up {needed_m:.1} m",
                self.cable_length_m, self.duration_s
            )
        })
    }

    /// Checks that the computation ends and that the log fits on a disk.
    fn validate_work(&self) -> Result<(), SceneError> {
        let samples = self.duration_s * self.rate_hz;
        require(self.sample_count() > 0, || {
            format!("duration_s = {}: no sample at {} Hz", short(self.duration_s), self.rate_hz)
        })?;
        require(samples <= MOST_SAMPLES, || {
            format!(
                "duration_s = {}: {samples:.0} samples, at most {MOST_SAMPLES:e}",
                self.duration_s
            )
        })?;
        let (mu_s, mu) = self.coefficients();
        let drop_n = 2.0 * (mu_s - mu).max(1e-3) * self.weight_n;
        let slips = self.duration_s * self.stiffness_n_per_m * self.winch_m_per_s / drop_n;
        require(slips <= MOST_SLIPS, || {
            format!(
                "stiffness_n_per_m = {}: about {slips:.1e} slips in {} s, at most {MOST_SLIPS:e}",
                self.stiffness_n_per_m, self.duration_s
            )
        })?;
        let changes = self.winch_profile.as_ref().map_or(0.0, |it| it.work(self.duration_s));
        require(changes <= MOST_SLIPS, || {
            format!(
                "winch_profile: about {changes:.1e} steps in {} s, at most {MOST_SLIPS:e}",
                self.duration_s
            )
        })
    }

    fn validate_start(&self) -> Result<(), SceneError> {
        let s = &self.start;
        let is_date =
            |day| (1900..=2100).contains(&s.year) && Date::from_ordinal_date(s.year, day).is_ok();
        let ok = u16::try_from(s.day).is_ok_and(is_date) && s.hour < 24 && s.minute < 60;
        require(ok, || {
            "start: year must be 1900 to 2100, day one of that year from 1 on, hour 0 to 23, minute 0 \
             to 59"
                .to_owned()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::scene::Start;
    use crate::sim::terms::Breaking;

    /// Such a scene was computed for hours.
    #[test]
    fn a_winch_that_turns_on_and_off_too_often_is_refused() {
        let with = |go_s| {
            let winch_profile = Some(WinchProfile::StopAndGo { go_s, stop_s: 1e-9 });
            Scene { winch_profile, ..Scene::default() }.validate()
        };
        assert_eq!(with(1.0), Ok(()));
        let said = with(1e-9).unwrap_err().to_string();
        assert_eq!(said, "winch_profile: about 1.2e11 steps in 120 s, at most 1e8");
    }

    /// Such a log was written and not read again.
    #[test]
    fn a_record_starts_at_a_time_that_there_is() {
        let starts = |year, day| {
            let start = Start { year, day, hour: 0, minute: 0 };
            Scene { start, ..Scene::default() }.validate().is_ok()
        };
        assert!(starts(1995, 365) && starts(1996, 366) && starts(2100, 1));
        assert!(
            ![(1995, 366), (1996, 0), (1996, 1 << 16), (-5, 1), (99_999, 1)]
                .into_iter()
                .any(|(year, day)| starts(year, day))
        );
    }

    /// Such scenes were computed for hours, too.
    #[test]
    fn what_is_too_fine_to_compute_is_refused() {
        let with = |term: &str| {
            let text = toml::to_string(&Scene::default()).unwrap();
            Scene::from_toml(&(text + term)).unwrap_err().to_string()
        };
        for (term, said) in [
            (
                "[rocking]\nfraction = 0.1\nratio = 1e9",
                "rocking.ratio = 1e9: must be above zero, at most 1000",
            ),
            (
                "[along_slip]\nfraction = 0.1\nlength_m = 1e-300",
                "along_slip.length_m = 1e-300: must be a number not below 0.00001",
            ),
            (
                "[measurement.lag]\ntime_s = 1e-9",
                "measurement.lag.time_s = 0.000000001: must be a number not below 0.00001",
            ),
            (
                "[rate_dependence]\nreference_m_per_s = 1e-30\nper_decade = 0.02",
                "rate_dependence.reference_m_per_s = 1e-30: must be a number not below 1e-12",
            ),
            (
                "[weighing]\nswing_deg = 5\nlength_m = 3\ndamping_per_s = 1e9",
                "weighing.damping_per_s = 1e9: must be 0 to 1000",
            ),
        ] {
            assert!(with(term).starts_with(said), "{}", with(term));
        }
    }

    #[test]
    fn a_block_that_hangs_is_not_pulled() {
        let weighing = Weighing { swing_deg: 5.0, length_m: 3.0, damping_per_s: 0.0 };
        let hangs = Scene { weighing: Some(weighing), ..Scene::default() };
        assert_eq!(hangs.validate(), Ok(()));
        let breaking = Some(Breaking { at_s: 20.0, weight_n: 100.0 });
        let said = Scene { breaking, ..hangs }.validate().unwrap_err().to_string();
        assert_eq!(said, "weighing: the block hangs and is not pulled: leave out breaking");
    }
}
