//! Events without an access by the program: time, the script, resets, the end.

use super::access::at;
use super::{Board, Emulator};
use crate::board::BASES;
use crate::rcc::cause;
use crate::rtc::Rtc;
use crate::rtt;
use crate::rules::At;
use crate::run::{CONSOLE_FILE, Incident, LOGGED_FILE, OUTCOME_FILE, Outcome, When};
use crate::ssd1306::Ssd1306;
use crate::wires::Hold;

/// Interrupt numbers (RM0351, table 57).
const USART2_LINE: u32 = 38;
const LPTIM1_LINE: u32 = 65;

/// Longest interval between two wake-ups of the board, ns: without wake-ups the emulator gives up
/// on a program that waits for minutes. In real time, and with a log, wake-ups are more frequent.
const HEARTBEAT_NS: u64 = 1_000_000_000;
const BUSY_HEARTBEAT_NS: u64 = 10_000_000;

/// Word with which `cortex-m-rt` paints the stack.
const PAINT: u32 = 0xCCCC_CCCC;
/// Address and length of the RAM that a power failure destroys.
const RAM: (u32, usize) = (0x2000_0000, 96 * 1024);

const CONVERTER_RESET: u8 = 0x06;

impl Board {
    /// Processes all events due at the current time.
    pub fn wake(&mut self, emulator: &mut dyn Emulator) {
        let now_ns = emulator.now_ns();
        self.follow_clocks(now_ns);
        self.lptim.advance(at!(self, now_ns));
        self.usart.advance(at!(self, now_ns));
        if self.iwdg.deadline_ns().is_some_and(|due| due <= now_ns) && self.cause.is_none() {
            self.cause = Some((cause::WATCHDOG, "the watchdog"));
            emulator.restart();
        }
        self.play(emulator, now_ns);
        self.listen(emulator, now_ns);
        self.settle(emulator, now_ns);
    }

    /// Updates the interrupt lines and requests the next wake-up.
    pub(super) fn settle(&mut self, emulator: &mut dyn Emulator, now_ns: u64) {
        let lines_up = (self.lptim.interrupt(), self.usart.interrupt());
        if lines_up.0 != self.lines_up.0 {
            emulator.set_interrupt(LPTIM1_LINE, lines_up.0);
        }
        if lines_up.1 != self.lines_up.1 {
            emulator.set_interrupt(USART2_LINE, lines_up.1);
        }
        if lines_up.0 && self.waiting_for_tick {
            self.waiting_for_tick = false;
            self.outcome.first_ticks_s.push(now_ns as f64 * 1e-9);
        }
        self.lines_up = lines_up;
        let often = self.remote.is_some() || self.setup.rtt.is_some();
        let heartbeat = now_ns + if often { BUSY_HEARTBEAT_NS } else { HEARTBEAT_NS };
        let script = self.script.iter().filter_map(|(when, _)| self.due_ns(when));
        let script = script.min();
        let at = At { now_ns, clocks: self.clocks, rules: &mut self.rules };
        let due = [self.lptim.deadline_ns(&at), self.usart.deadline_ns(), self.iwdg.deadline_ns()];
        let next = due.into_iter().chain([script]).flatten().min().unwrap_or(heartbeat);
        emulator.wake_at(next.clamp(now_ns + 1, heartbeat));
    }

    /// Time of a script entry, ns; `None` if it is not known yet.
    fn due_ns(&self, when: &When) -> Option<u64> {
        match *when {
            When::Seconds(s) => Some((s * 1e9) as u64),
            When::Sample(number) => self.wires.converter.sample_end_ns(number),
        }
    }

    /// Runs the script's due entries.
    fn play(&mut self, emulator: &mut dyn Emulator, now_ns: u64) {
        let script = std::mem::take(&mut self.script);
        let is_due = |when: &When| self.due_ns(when).is_some_and(|due_ns| due_ns <= now_ns);
        let (mut due, waits): (Vec<_>, Vec<_>) =
            script.into_iter().partition(|(when, _)| is_due(when));
        self.script = waits;
        // The next entry is last.
        while let Some((_, incident)) = due.pop() {
            self.happen(emulator, now_ns, incident);
        }
    }

    fn happen(&mut self, emulator: &mut dyn Emulator, now_ns: u64, incident: Incident) {
        match incident {
            Incident::Type(text) => self.usart.type_in(text.as_bytes(), at!(self, now_ns)),
            Incident::PullCard => self.slot.pull(now_ns),
            Incident::PutCard => self.slot.present = true,
            Incident::HoldBus(s) => {
                self.wires.hold = Some(Hold::Until(now_ns + (s * 1e9) as u64));
            }
            Incident::HoldBusForClocks(clocks) => self.wires.hold = Some(Hold::Clocks(clocks)),
            Incident::ResetConverter => self.wires.converter.command(now_ns, CONVERTER_RESET),
            Incident::StopClock => {
                self.tim2.rebase(at!(self, now_ns));
                self.tim2.dead = true;
            }
            Incident::FailAccess(base) => self.failing = Some(base),
            Incident::UseUpStack(left) => emulator.move_stack(self.setup.stack.0 + left),
            Incident::Dip => {
                self.cause = Some((cause::POWER, "a dip"));
                emulator.restart();
            }
            Incident::CutPower => self.cut_power(emulator, now_ns),
            Incident::Photograph => {
                self.outcome.photographs.push(self.wires.display.picture());
            }
            Incident::End => {
                self.end(emulator, now_ns);
                emulator.finish();
            }
        }
    }

    fn cut_power(&mut self, emulator: &mut dyn Emulator, now_ns: u64) {
        self.rcc.lose_backup();
        self.rtc = Rtc::default();
        let present = self.slot.present;
        self.slot.pull(now_ns);
        self.slot.present = present;
        self.wires.converter.command(now_ns, CONVERTER_RESET);
        self.wires.display = Ssd1306::default();
        let garbage: Vec<u8> =
            (0..RAM.1).map(|i| (i as u32).wrapping_mul(0x9E37_79B1).to_be_bytes()[0]).collect();
        emulator.write(RAM.0, &garbage);
        self.cause = Some((cause::POWER, "the power"));
        emulator.restart();
    }

    /// Resets the peripherals after a restart of the processor.
    pub fn restarted(&mut self, now_ns: u64) {
        if now_ns == 0 {
            return;
        }
        let (bits, words) = self.cause.take().unwrap_or((cause::SOFTWARE, "the program"));
        self.outcome.resets.push((now_ns as f64 * 1e-9, words.into()));
        self.rcc.reset(bits | cause::PIN);
        BASES.into_iter().for_each(|base| self.reset_one(base));
        // A restart ends the failures that the script has caused.
        (self.tim2.dead, self.failing) = (false, None);
        self.waiting_for_tick = true;
        self.lines_up = (false, false);
        self.follow_clocks(now_ns);
    }

    /// Collects log and console output, and serves the TCP console.
    fn listen(&mut self, emulator: &mut dyn Emulator, now_ns: u64) {
        if let Some(block) = self.setup.rtt {
            self.logged.extend(rtt::drain(emulator, block));
        }
        let new = self.usart.said.get(self.heard..).unwrap_or_default();
        if let Some(remote) = &mut self.remote {
            remote.keep_pace(now_ns);
            let typed = remote.exchange(new);
            self.usart.type_in(&typed, at!(self, now_ns));
        }
        self.heard = self.usart.said.len();
    }

    /// Writes the files with the results of the run.
    fn end(&mut self, emulator: &mut dyn Emulator, now_ns: u64) {
        self.listen(emulator, now_ns);
        if self.slot.present {
            self.slot.pull(now_ns + HEARTBEAT_NS);
        }
        let outcome = Outcome {
            breaches: self.rules.said(),
            delivered: self.wires.converter.delivered().to_vec(),
            stack_used: self.stack_used(emulator),
            typed_lost: self.usart.lost,
            line_times_s: self.usart.line_ends_ns.iter().map(|&ns| ns as f64 * 1e-9).collect(),
            picture: self.wires.display.picture(),
            pictures: self.wires.display.pictures,
            blocks_written: self.slot.card.as_ref().map_or(0, |card| card.written()),
            emulated_s: now_ns as f64 * 1e-9,
            ..self.outcome.clone()
        };
        let text = serde_json::to_vec(&outcome).unwrap_or_default();
        let files: [(&str, &[u8]); 3] =
            [(CONSOLE_FILE, &self.usart.said), (LOGGED_FILE, &self.logged), (OUTCOME_FILE, &text)];
        for (name, bytes) in files {
            if let Err(error) = std::fs::write(name, bytes) {
                eprintln!("board model: {name}: {error}");
            }
        }
    }

    fn stack_used(&self, emulator: &mut dyn Emulator) -> u32 {
        let (lower, upper) = self.setup.stack;
        let mut bytes = vec![0; upper.saturating_sub(lower) as usize];
        emulator.read(lower, &mut bytes);
        let painted = bytes.chunks(4).take_while(|word| *word == PAINT.to_le_bytes()).count();
        upper - lower - 4 * painted as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::clock::Clock;
    use crate::run::Setup;

    const PERIOD_NS: u64 = 62_500_000;

    /// Time at which typing starts that is scripted for a sample, ns.
    fn typed_ns(setup: Setup, sample: u64, first_ns: u64) -> u64 {
        let script = vec![(When::Sample(sample), Incident::Type("x".into()))];
        let mut board = Board::new(Setup { script, ..setup }).unwrap();
        let mut clock = Clock { now_ns: first_ns, ..Clock::default() };
        const START: u8 = 0x08;
        board.wires.converter.command(first_ns, START);
        while board.usart.deadline_ns().is_none() {
            board.wake(&mut clock);
            assert!(clock.now_ns < 10_000_000_000, "nobody ever types");
            if board.usart.deadline_ns().is_none() {
                clock.now_ns = clock.wanted_ns;
            }
        }
        clock.now_ns
    }

    /// The time does not depend on the wake-ups: an image with a log is woken more often than one
    /// without, and both must receive the same input.
    #[test]
    fn a_moment_of_a_sample_is_the_same_whoever_is_looked_at() {
        for (sample, first_ns) in [(0, 1000), (3, 1000), (32, 7_777_777)] {
            let due_ns = first_ns + sample * PERIOD_NS + PERIOD_NS / 2;
            assert_eq!(typed_ns(Setup::quiet(), sample, first_ns), due_ns);
            let logging = Setup { rtt: Some(0x2000_0000), ..Setup::quiet() };
            assert_eq!(typed_ns(logging, sample, first_ns), due_ns);
        }
    }
}
