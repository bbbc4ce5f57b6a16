//! The logger on a NUCLEO-L476RG.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    #[cfg(feature = "defmt")]
    use defmt_rtt as _;

    use floe_core::Pipeline;
    use floe_firmware::ads122::{Ads122, I2cBus};
    use floe_firmware::app::App;
    use floe_firmware::board::nucleo::bus::Bus;
    use floe_firmware::board::nucleo::calendar;
    use floe_firmware::board::nucleo::card::CardSlot;
    use floe_firmware::board::nucleo::clock::{self, CLOCK_HZ, Delay};
    use floe_firmware::board::nucleo::console::Console;
    use floe_firmware::board::nucleo::{Board, Watchdog, crash};
    use floe_firmware::board::sleep_unless;
    use floe_firmware::card::CardLog;
    use floe_firmware::display::Picture;
    use floe_firmware::sample::{SampleQueue, Shared};
    use floe_firmware::sampler::{Pulse, Sampler};
    use ssd1306::mode::DisplayConfig;
    use ssd1306::prelude::{DisplayRotation, DisplaySize128x64};
    use ssd1306::{I2CDisplayInterface, Ssd1306};
    use static_cell::StaticCell;

    #[cfg(feature = "defmt")]
    defmt::timestamp!("{=u32:us}", clock::clock());

    type Adc = Ads122<I2cBus<Bus>, Delay>;
    type Logger = App<'static, Console, CardLog<CardSlot>>;

    static SHARED: Shared = Shared::new();

    /// I²C address of the converter with both address pins at ground.
    const CONVERTER: u8 = 0x40;
    /// 96 MiB: 27 hours of tests.
    const LOG_SECTORS: u32 = 196_608;
    /// Samples between two pictures on the display.
    const PICTURE_SAMPLES: u32 = 8;
    /// Samples between two log lines about the stack: one minute.
    const MINUTE_SAMPLES: u32 = 960;
    /// Latest start of a transfer, us after the tick: a picture takes 28 ms of the bus and must be
    /// complete before the next tick.
    const PICTURE_LATEST_US: u32 = 30_000;
    /// Sectors by which the log's file grows in one step: 100 to 120 ms, emulated.
    const STEP_SECTORS: u32 = 16;

    /// Time limit for the crystal to start, us; a cold crystal starts slowly.
    const CRYSTAL_US: u32 = 5_000_000;
    const NO_CRYSTAL: &str = "the crystal does not run: samples by the internal oscillator, \
        whose rate is off by up to 2 %; the coefficients do not depend on it";

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let words = crash::last_words();
        let Parts { app, sampler, screen, mut watchdog } = build();
        watchdog.unleash();
        app.power_up(words.as_deref());
        let mut waiting = Some(sampler);
        // Offset of the time of day from the clock, ms, if it was set before the crystal ran.
        let mut early = None;
        let (mut samples, mut minute, mut pulse) = (0, 0, Pulse::default());
        loop {
            if let Some(sampler) = waiting.take() {
                waiting = begin(app, sampler, early);
            }
            // A board that does not sample is as bad as a board that hangs.
            if waiting.is_some() || pulse.beats(&SHARED) {
                watchdog.pet();
            }
            let before_ms = clock::clock() / 1000;
            let taken = app.turn();
            if let Some(unix_ms) = app.new_time() {
                if waiting.is_some() {
                    early = Some(unix_ms.wrapping_sub(before_ms.into()));
                } else {
                    calendar::set(unix_ms.wrapping_add((clock::since_tick() / 1000).into()));
                }
            }
            if taken > 0 {
                samples += taken;
                minute += taken;
                if minute >= MINUTE_SAMPLES {
                    minute = 0;
                    log_stack();
                    screen.forget();
                }
                // When a picture is due it goes first, because the card would delay it.
                if samples < PICTURE_SAMPLES {
                    app.tend();
                } else if screen.show(app) {
                    samples = 0;
                }
            }
            sleep_unless(|| app.has_samples());
        }
    }

    /// Logs the use of the stack, in a build with logging.
    fn log_stack() {
        #[cfg(feature = "defmt")]
        {
            let (used, size) = floe_firmware::board::stack::used();
            defmt::info!("stack: {} of {} bytes", used, size);
        }
    }

    /// The display and its contents.
    struct Screen {
        display: Display,
        picture: Picture,
    }

    impl Screen {
        /// Draws a picture and sends the changes if enough time is left before the tick; otherwise
        /// the picture after the next sample is sent.
        #[inline(never)]
        fn show(&mut self, app: &Logger) -> bool {
            let _ = self.picture.draw(&mut self.display, &app.view());
            let in_time = clock::since_tick() < PICTURE_LATEST_US;
            // A missing display is no error; after a failed transfer the next picture is sent
            // whole.
            if in_time && self.display.flush().is_err() {
                self.forget();
            }
            in_time
        }

        /// Forces the next picture to be drawn and sent whole, which replaces garbled pixels.
        fn forget(&mut self) {
            self.display.clear_buffer();
            self.picture = Picture::default();
        }
    }

    /// Starts the sampling once its clock runs; returns the sampler until then.
    fn begin(
        app: &mut Logger,
        sampler: &'static mut Sampler<'static, Adc>,
        early: Option<u64>,
    ) -> Option<&'static mut Sampler<'static, Adc>> {
        let said_ms = early.map(|ahead_ms| ahead_ms.wrapping_add((clock::clock() / 1000).into()));
        if clock::crystal_runs() {
            #[cfg(feature = "defmt")]
            defmt::info!("tick by the crystal, 16 MHz in step with it");
            clock::start_tick(sampler, clock::Source::Crystal);
            if let Some(unix_ms) = said_ms {
                calendar::set(unix_ms);
            }
            app.begin_at(calendar::now());
        } else if clock::clock() > CRYSTAL_US {
            #[cfg(feature = "defmt")]
            defmt::warn!("tick by the internal oscillator: the crystal does not start");
            app.warn(NO_CRYSTAL);
            clock::start_tick(sampler, clock::Source::Internal);
            app.begin_at(said_ms);
        } else {
            return Some(sampler);
        }
        None
    }

    struct Parts {
        app: &'static mut Logger,
        sampler: &'static mut Sampler<'static, Adc>,
        screen: &'static mut Screen,
        watchdog: Watchdog,
    }

    /// Creates all parts in static memory; a separate function, so that its stack frame is
    /// released.
    #[inline(never)]
    fn build() -> Parts {
        static QUEUE: StaticCell<SampleQueue> = StaticCell::new();
        static SAMPLER: StaticCell<Sampler<'static, Adc>> = StaticCell::new();
        static APP: StaticCell<Logger> = StaticCell::new();
        static PIPELINE: StaticCell<Option<Pipeline>> = StaticCell::new();
        static SCREEN: StaticCell<Screen> = StaticCell::new();

        let board = Board::init();
        let (producer, consumer) = QUEUE.init_with(SampleQueue::new).split();
        let bus = I2cBus::new(board.bus, CONVERTER);
        let adc = Ads122::new(bus, Delay);
        let sampler = SAMPLER.init_with(|| Sampler::new(adc, producer, &SHARED));
        let pipeline = PIPELINE.init_with(|| None);
        let card = CardLog::new(board.card, LOG_SECTORS).in_steps_of(STEP_SECTORS);
        let app =
            APP.init_with(|| App::new(consumer, &SHARED, pipeline, board.console, card, CLOCK_HZ));
        let screen = SCREEN.init_with(|| screen(board.bus));
        let _ = screen.display.init();
        Parts { app, sampler, screen, watchdog: board.watchdog }
    }

    type Display = Ssd1306<
        ssd1306::prelude::I2CInterface<Bus>,
        DisplaySize128x64,
        ssd1306::mode::BufferedGraphicsMode<DisplaySize128x64>,
    >;

    fn screen(bus: Bus) -> Screen {
        let interface = I2CDisplayInterface::new(bus);
        let display = Ssd1306::new(interface, DisplaySize128x64, DisplayRotation::Rotate0);
        let display = display.into_buffered_graphics_mode();
        Screen { display, picture: Picture::default() }
    }

    /// The interrupt has no work except waking the processor.
    #[cortex_m_rt::exception]
    fn SysTick() {}

    /// Entry of the vector table under the name that `cortex-m-rt` expects. After a stack overflow
    /// there is no room left, and a second fault would lock up the processor: the stack pointer is
    /// reset.
    // SAFETY: it never returns; below the stack's beginning only the exception frame, which the
    // processor pushed last and which is passed on, is still needed.
    #[allow(unsafe_code)]
    #[unsafe(no_mangle)]
    #[unsafe(naked)]
    unsafe extern "C" fn HardFault() -> ! {
        core::arch::naked_asm!(
            "mrs r0, msp",
            "movw r1, #:lower16:_stack_start",
            "movt r1, #:upper16:_stack_start",
            "msr msp, r1",
            "b {died}",
            died = sym crash::fault,
        )
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        // Without the location: the locations of all panics would take 5 kB of flash.
        crash::die(&"a panic")
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
