//! Forces of a block whose every event has friction and swing of its own.

use std::f64::consts::PI;

/// What an event has of its own.
#[derive(Clone, Copy, Debug)]
pub struct Slip {
    /// Force at the onset, N.
    pub static_n: f64,
    /// Force of the friction while the block slides, N.
    pub dynamic_n: f64,
    /// Natural frequency, rad per sampling period.
    pub omega: f64,
}

/// A slip with the moment of its onset and the line before it.
struct Placed {
    slip: Slip,
    onset: f64,
    /// Moment and force at which the line begins.
    line: (f64, f64),
}

impl Slip {
    /// Half the drop, N, and the duration, at a loading rate in N per sampling period.
    fn drop_and_time(&self, rate: f64) -> (f64, f64) {
        let drop_n = self.static_n - self.dynamic_n;
        (drop_n, (PI + 2.0 * (rate / self.omega / drop_n).atan()) / self.omega)
    }

    /// Force after a time from the onset, N.
    fn force_n(&self, rate: f64, since: f64) -> f64 {
        let (drop_n, time) = self.drop_and_time(rate);
        if since > time {
            return self.static_n - 2.0 * drop_n + rate * (since - time);
        }
        let (sin, cos) = (self.omega * since).sin_cos();
        self.dynamic_n + drop_n * cos + rate / self.omega * sin
    }
}

/// Forces at every sampling period, N, and the onsets of the slips. The first comes after
/// `start` periods; the loading rate is in N per period.
#[must_use]
pub fn saw(slips: &[Slip], rate: f64, start: f64) -> (Vec<f64>, Vec<f64>) {
    let mut line = (0.0, slips.first().map_or(0.0, |slip| slip.static_n) - rate * start);
    let place = |slip: &Slip| {
        let onset = line.0 + (slip.static_n - line.1) / rate;
        let placed = Placed { slip: *slip, onset, line };
        let (drop_n, time) = slip.drop_and_time(rate);
        line = (onset + time, slip.static_n - 2.0 * drop_n);
        placed
    };
    let placed: Vec<Placed> = slips.iter().map(place).collect();
    let end = placed.last().map_or(0.0, |it| it.onset) + 10.0;
    let force_n = |index: u32| {
        let time = f64::from(index);
        let now = placed.partition_point(|it| it.line.0 <= time).saturating_sub(1);
        let Placed { slip, onset, line } = &placed[now];
        if time > *onset {
            slip.force_n(rate, time - onset)
        } else {
            line.1 + rate * (time - line.0)
        }
    };
    let forces_n = (0..end as u32).map(force_n).collect();
    (forces_n, placed.iter().map(|it| it.onset).collect())
}
