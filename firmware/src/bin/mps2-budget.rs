//! Counts the core's instructions per step on the emulated board: run with `-icount shift=8`, where
//! an instruction takes 256 ns of the clock's 40 ns ticks.
//!
//! The file `samples` holds little-endian f32: rate, Hz, weight, N, slope, rad, range of the cell,
//! N (0: none); then the forces, N, NaN where a sample is bad. One line is printed:
//! `budget SAMPLES EVENTS QUIET MEAN WORST AT BYTES`. `QUIET` is the median of the steps in which
//! the block rests without any output, `AT` the sample of the worst step.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;

    use floe_core::{Config, Fault, Newtons, Phase, Pipeline, RawSample, Reading};
    use floe_firmware::board::mps2;
    use semihosting::fs::File;
    use semihosting::io::Read;
    use static_cell::StaticCell;

    /// Instructions per bin of the histogram, and number of bins.
    const WIDE: u32 = 8;
    const PLACES: usize = 2048;
    const SAMPLES_A_READ: usize = 256;

    /// Instruction counts of the steps so far.
    struct Tally {
        samples: u32,
        events: u32,
        sum: u64,
        worst: u32,
        worst_at: u32,
        quiet: [u32; PLACES],
        quiet_steps: u32,
    }

    impl Tally {
        const fn new() -> Self {
            let quiet = [0; PLACES];
            Self { samples: 0, events: 0, sum: 0, worst: 0, worst_at: 0, quiet, quiet_steps: 0 }
        }

        fn add(&mut self, instructions: u32, is_quiet: bool) {
            if instructions > self.worst {
                (self.worst, self.worst_at) = (instructions, self.samples);
            }
            self.samples += 1;
            self.sum += u64::from(instructions);
            if is_quiet {
                let place = ((instructions / WIDE) as usize).min(PLACES - 1);
                self.quiet[place] += 1;
                self.quiet_steps += 1;
            }
        }

        /// Median, to the width of a bin.
        fn quiet(&self) -> u32 {
            let mut left = self.quiet_steps / 2;
            for (place, &count) in (0..).zip(&self.quiet) {
                if count > left {
                    return place * WIDE + WIDE / 2;
                }
                left -= count;
            }
            0
        }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        mps2::start();
        static PIPELINE: StaticCell<Pipeline> = StaticCell::new();
        static TALLY: StaticCell<Tally> = StaticCell::new();
        let tally = TALLY.init_with(Tally::new);
        let mut file = File::open(c"samples").expect("a file of samples");
        let mut head = [0; 16];
        file.read_exact(&mut head).expect("rate, weight, slope, range");
        let [rate_hz, weight_n, slope_rad, range_n] = numbers(&head);
        let range_n = (range_n > 0.0).then_some(range_n);
        let config = Config { rate_hz, weight_n, slope_rad, range_n, ..Config::default() };
        let pipeline = PIPELINE.init_with(|| Pipeline::new(&config).expect("a configuration"));
        // Reached through a pointer, as on the board: its address is no constant of the code.
        let pipeline = core::hint::black_box(pipeline);
        let empty = ticks(|| ());
        let mut index = 0;
        let mut bytes = [0; 4 * SAMPLES_A_READ];
        loop {
            let count = fill(&mut file, &mut bytes);
            for number in bytes[..count].as_chunks::<4>().0 {
                let force_n = f32::from_le_bytes(*number);
                let reading = if force_n.is_nan() {
                    Reading::Bad(Fault::Sentinel)
                } else {
                    Reading::Force(Newtons(force_n))
                };
                let raw = RawSample { index, reading };
                index += 1;
                let mut quiet = false;
                let mut told = 0;
                let spent = ticks(|| {
                    let step = pipeline.step(black_box(raw));
                    let silent = step.event.is_none() && step.provisional.is_none();
                    quiet = silent && step.phase == Phase::Stick;
                    told = u32::from(step.event.is_some());
                });
                tally.events += told;
                tally.add(instructions(spent.saturating_sub(empty)), quiet);
            }
            if count < bytes.len() {
                break;
            }
        }
        let Tally { samples, events, sum, worst, worst_at, .. } = *tally;
        let mean = sum / u64::from(samples.max(1));
        let (quiet, bytes) = (tally.quiet(), size_of::<Pipeline>());
        semihosting::println!(
            "budget {samples} {events} {quiet} {mean} {worst} {worst_at} {bytes}"
        );
        mps2::finish(0)
    }

    fn numbers(bytes: &[u8; 16]) -> [f32; 4] {
        core::array::from_fn(|i| f32::from_le_bytes(bytes.as_chunks::<4>().0[i]))
    }

    /// Reads until the buffer is full or the file ends.
    fn fill(file: &mut File, bytes: &mut [u8]) -> usize {
        let mut count = 0;
        while let Ok(read @ 1..) = file.read(&mut bytes[count..]) {
            count += read;
        }
        count
    }

    fn ticks<T>(job: impl FnOnce() -> T) -> u32 {
        let start = mps2::clock();
        black_box(job());
        mps2::clock().wrapping_sub(start)
    }

    fn instructions(ticks: u32) -> u32 {
        (u64::from(ticks) * 40).div_ceil(256) as u32
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
