//! The logger on the emulated board.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use cortex_m_rt::entry;
    #[cfg(feature = "defmt")]
    use defmt_semihosting as _;
    use floe_core::Pipeline;
    use floe_firmware::ads122::{Ads122, SerialBus};
    use floe_firmware::app::App;
    use floe_firmware::board::mps2::files::{AdcLine, CardFile, ConsoleFiles};
    use floe_firmware::board::mps2::{self, CLOCK_HZ, Delay};
    use floe_firmware::board::sleep_unless;
    use floe_firmware::card::CardLog;
    use floe_firmware::sample::{SampleQueue, Shared};
    use floe_firmware::sampler::Sampler;
    use semihosting::process::exit;
    use static_cell::StaticCell;

    /// 4 MiB: an hour and eight minutes.
    const LOG_SECTORS: u32 = 8192;

    type Adc = Ads122<SerialBus<AdcLine, Delay>, Delay>;

    type Logger = App<'static, ConsoleFiles, CardLog<CardFile>>;

    #[entry]
    fn main() -> ! {
        mps2::start();
        let (app, sampler) = build();
        app.power_up(None);
        app.turn();
        app.tend();
        mps2::start_tick(sampler);
        loop {
            if app.turn() > 0 {
                app.tend();
            }
            sleep_unless(|| app.has_samples());
        }
    }

    /// Creates all parts in static memory; a separate function, so that its stack frame is
    /// released.
    #[inline(never)]
    fn build() -> (&'static mut Logger, &'static mut Sampler<'static, Adc>) {
        static SHARED: Shared = Shared::new();
        static QUEUE: StaticCell<SampleQueue> = StaticCell::new();
        static APP: StaticCell<Logger> = StaticCell::new();
        static PIPELINE: StaticCell<Option<Pipeline>> = StaticCell::new();
        static SAMPLER: StaticCell<Sampler<'static, Adc>> = StaticCell::new();

        let (Some(console), Some(line)) = (ConsoleFiles::open(), AdcLine::open()) else {
            // The host has not made the files.
            exit(3)
        };
        let (producer, consumer) = QUEUE.init_with(SampleQueue::new).split();
        let adc = Ads122::new(SerialBus::new(line, Delay), Delay);
        let sampler = SAMPLER.init_with(|| Sampler::new(adc, producer, &SHARED));
        let pipeline = PIPELINE.init_with(|| None);
        let card = CardLog::new(CardFile::open(), LOG_SECTORS);
        (APP.init_with(|| App::new(consumer, &SHARED, pipeline, console, card, CLOCK_HZ)), sampler)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
