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

    /// Both address pins of the converter at ground.
    const CONVERTER: u8 = 0x40;
    /// 96 MiB: 27 hours of tests.
    const LOG_SECTORS: u32 = 196_608;
    /// Samples between two pictures on the display.
    const PICTURE_SAMPLES: u32 = 8;
    /// Samples between two words about the stack.
    const MINUTE_SAMPLES: u32 = 960;
    /// A whole picture takes 28 ms of the bus; later than this it would meet the tick.
    const PICTURE_LATEST_US: u32 = 30_000;
    /// The log's file is made longer by so many sectors at a time: 100 to 120 ms, emulated.
    const STEP_SECTORS: u32 = 16;

    /// The crystal gets so long to start, us; cold ones are slow.
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
        // What the time is ahead of the board's own, ms, if it was set before the crystal ran.
        let mut early = None;
        let (mut samples, mut minute, mut pulse) = (0, 0, Pulse::default());
        loop {
            if let Some(sampler) = waiting.take() {
                waiting = begin(app, sampler, early);
            }
            // A board that does not sample is as bad as one that hangs.
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
                // The card waits for a picture that is due, else the picture would wait for the card.
                if samples < PICTURE_SAMPLES {
                    app.tend();
                } else if screen.show(app) {
                    samples = 0;
                }
            }
            sleep_unless(|| app.has_samples());
        }
    }

    /// Once a minute, where the firmware logs.
    fn log_stack() {
        #[cfg(feature = "defmt")]
        {
            let (used, size) = floe_firmware::board::stack::used();
            defmt::info!("stack: {} of {} bytes", used, size);
        }
    }

    /// The display and what it shows.
    struct Screen {
        display: Display,
        picture: Picture,
    }

    impl Screen {
        /// Draws a picture, and sends what is new if the tick leaves the time for it: else the
        /// picture after the next sample is sent.
        #[inline(never)]
        fn show(&mut self, app: &Logger) -> bool {
            let _ = self.picture.draw(&mut self.display, &app.view());
            let in_time = clock::since_tick() < PICTURE_LATEST_US;
            // Without a display there is nothing to see; with one, what did not arrive
            // comes with the next picture.
            if in_time && self.display.flush().is_err() {
                self.forget();
            }
            in_time
        }

        /// The next picture is drawn and sent as a whole: what the bus has garbled goes.
        fn forget(&mut self) {
            self.display.clear_buffer();
            self.picture = Picture::default();
        }
    }

    /// Starts the sampling when its clock is there; gives the sampler back while not.
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

    /// Puts everything in its place; a function of its own, so that its frame goes.
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

    /// Only wakes.
    #[cortex_m_rt::exception]
    fn SysTick() {}

    /// What `cortex-m-rt` has in the table of vectors. Where the stack has run over there is no
    /// room for anything more, and one fault more would be the last: the stack begins anew.
    // SAFETY: it never returns; nothing below the stack's beginning is needed any more but
    // what the processor has put there last, which is handed on.
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
        // Not where: the places of all panics would be 5 kB of the program.
        crash::die(&"a panic")
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
