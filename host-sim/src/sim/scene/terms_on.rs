//! Names of the terms of a scene that are on.

use super::{Measurement, Scene};

impl Scene {
    /// Names of the terms that are on, beyond the linear block on level ice.
    #[must_use]
    pub fn terms(&self) -> Vec<&'static str> {
        let all = self.of_motion().into_iter().chain(of_measurement(&self.measurement));
        all.filter_map(|(name, on)| on.then_some(name)).collect()
    }

    pub(super) fn of_motion(&self) -> [(&'static str, bool); 22] {
        [
            ("slope", self.slope_deg.abs() > 0.0),
            ("post", self.post),
            ("weighing", self.weighing.is_some()),
            ("start_sliding", self.start_sliding),
            ("snow", self.snow.is_some()),
            ("variation", self.variation.is_some()),
            ("wander", self.wander.is_some()),
            ("partial_slips", self.partial_slips.is_some()),
            ("hold_time", self.hold_time.is_some()),
            ("rate_dependence", self.rate_dependence.is_some()),
            ("stribeck", self.stribeck.is_some()),
            ("rate_and_state", self.rate_and_state.is_some()),
            ("along_slip", self.along_slip.is_some()),
            ("rocking", self.rocking.is_some()),
            ("creep", self.creep.is_some()),
            ("shortening", self.shortening),
            ("sag", self.sag.is_some()),
            ("cable_damping", self.cable_damping.is_some()),
            ("winch_profile", self.winch_profile.is_some()),
            ("breaking", self.breaking.is_some()),
            ("tilt", self.tilt.is_some()),
            ("drag (ours, not the paper's)", self.drag.is_some()),
        ]
    }
}

fn of_measurement(measurement: &Measurement) -> [(&'static str, bool); 19] {
    [
        ("flop", measurement.flop.is_some()),
        ("hum", measurement.hum.is_some()),
        ("aperture", measurement.aperture_s > 0.0),
        ("lag", measurement.lag.is_some()),
        ("ramp", measurement.ramp.is_some()),
        ("drift", measurement.drift.is_some()),
        ("zero_step", measurement.zero_step.is_some()),
        ("white noise", measurement.white_n > 0.0),
        ("coloured noise", measurement.coloured.is_some()),
        ("1/f noise", measurement.flicker_n > 0.0),
        ("tare", measurement.tare_n.abs() > 0.0),
        ("range", measurement.range_n > 0.0),
        ("step", measurement.step_n > 0.0),
        ("spikes", measurement.spikes.is_some()),
        ("dropped", measurement.dropped.is_some()),
        ("repeated", measurement.repeated.is_some()),
        ("jitter", measurement.jitter.is_some()),
        ("late", measurement.late.is_some()),
        ("clock", measurement.clock_ppm.abs() > 0.0),
    ]
}
