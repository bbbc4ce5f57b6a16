//! Transfer of the samples that lie on a stick line, whatever the slip does, into that line.

use crate::cycle::slip_record::SlipRecord;
use crate::stats::line::Line;

impl SlipRecord {
    /// Moves the samples before the time `from` into the stick line before the slip, and those
    /// after `to` into the line after it, if there is one: a fit then uses two numbers of a line
    /// instead of each sample. Returns the squared residuals about the lines that this takes out of
    /// the fit, N².
    pub(crate) fn shorten(&mut self, after: &mut Line, (from, to): (f32, f32)) -> f32 {
        let around_n2 = self.before.residual_n2 + after.residual_n2;
        let place = |time: f32| (time - self.start) as usize;
        let first = place(from);
        let last = if after.count > 0 { place(to) } else { self.length };
        let mut kept = 0;
        for i in 0..self.length {
            let time = self.start + i as f32;
            let Some(&force_n) = self.forces_n.get(i) else { break };
            if i >= first && i <= last {
                if let Some(entry) = self.forces_n.get_mut(kept) {
                    *entry = force_n;
                }
                kept += 1;
            } else if !force_n.is_nan() {
                let weight = self.samples().weight(time);
                let line = if i < first { &mut self.before } else { &mut *after };
                line.add(time, force_n, weight, 1.0);
            }
        }
        self.start += first as f32;
        self.length = kept;
        self.before.residual_n2 + after.residual_n2 - around_n2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cycle::slip_record::{CORE, Extreme, Rough};
    use crate::effect::Kept;
    use crate::fit::{Data, Priors};
    use crate::model::elongation::Elongation;
    use crate::model::tests::dff8_13;
    use crate::noise::ripple::ColoredNoise;
    use crate::num::math;
    use crate::stats::normal_equations::{Normal, UNKNOWNS};

    const SAMPLES: usize = 20;

    fn line(cycle: &crate::model::CycleParams, from: i16, to: i16) -> Line {
        let (shape, mut line) = (cycle.shape(), Line::default());
        (from..to).for_each(|t| line.add(t.into(), shape.force(t.into()).0 + 0.5, 1.0, 1.0));
        line
    }

    /// A record of DFF8-13's slip with a little noise, and a sample that is missing.
    fn record() -> (SlipRecord, Line) {
        let cycle = dff8_13();
        let (shape, start) = (cycle.shape(), -6.0);
        let mut forces_n = [0.0; CORE];
        for (i, force_n) in forces_n.iter_mut().take(SAMPLES).enumerate() {
            let noise_n = [0.7, -1.1, 0.4, 0.2, -0.6][i % 5];
            *force_n = if i == 2 { f32::NAN } else { shape.force(start + i as f32).0 + noise_n };
        }
        let point = Extreme { time: 0.0, force_n: 0.0 };
        let record = SlipRecord {
            origin: 100,
            before: line(&cycle, -30, -6),
            forces_n,
            start,
            length: SAMPLES,
            peak: point,
            low: point,
            rough: Rough::default(),
            noise_n2: 4.0,
            wander: ColoredNoise::NONE.into(),
            oscillation: Kept::default(),
            rest_weight: 0.5,
            rest_from: shape.stop(),
            elongation: Elongation::default(),
            late: Kept::default(),
            hidden: None,
            early: None,
            stop: 0.0,
            limit: f32::MAX,
            refused: None,
        };
        (record, line(&cycle, -6 + SAMPLES as i16, 40))
    }

    fn normal(record: &SlipRecord, after: &Line) -> Normal {
        let data = Data {
            before: &record.before,
            samples: record.samples(),
            after,
            wander: record.wander,
            priors: &Priors::default(),
        };
        let mut cycle = dff8_13();
        cycle.onset += 0.3;
        cycle.rate *= 1.02;
        let (mut normal, shape) = (Normal::default(), cycle.shape());
        data.add_samples(&mut normal, &shape, 0, usize::MAX);
        data.add_lines(&mut normal, &shape);
        normal
    }

    #[test]
    fn the_normal_equations_stay_what_they_were() {
        let (mut record, mut after) = record();
        let whole = normal(&record, &after);
        let cycle = dff8_13();
        let ends = (cycle.onset - 1.25, cycle.shape().stop() + 1.25);
        let left_n2 = record.shorten(&mut after, ends);
        assert!(record.length < SAMPLES - 8 && record.start > ends.0 - 1.0);
        let short = normal(&record, &after);
        let near = |a: f32, b: f32, size: f32| (a - b).abs() < 2e-5 * size;
        assert!(near(short.cost + left_n2, whole.cost, whole.cost), "{} {left_n2}", short.cost);
        for i in 0..UNKNOWNS {
            let size = math::sqrt(whole.matrix[[i, i]] * whole.cost);
            assert!(near(short.right[i], whole.right[i], size), "{i} {}", short.right[i]);
            for j in 0..=i {
                let size = math::sqrt(whole.matrix[[i, i]] * whole.matrix[[j, j]]);
                assert!(near(short.matrix[[i, j]], whole.matrix[[i, j]], size), "{i} {j}");
            }
        }
    }
}
