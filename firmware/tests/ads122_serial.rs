//! The driver of the ADS122U04 on its serial line, checked byte by byte.

use std::collections::VecDeque;
use std::convert::Infallible;

use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc};
use floe_firmware::ads122::{Ads122, SerialBus};

/// Bytes that the driver must write, with the bytes that it reads afterwards.
#[derive(Default)]
struct Script {
    steps: VecDeque<(Vec<u8>, Vec<u8>)>,
    readable: VecDeque<u8>,
    written: Vec<u8>,
}

impl Script {
    fn step(mut self, written: &[u8], answer: &[u8]) -> Self {
        self.steps.push_back((written.to_vec(), answer.to_vec()));
        self
    }

    /// Reset, four writes, and four reads back of the registers for the bridge.
    fn set_up(self) -> Self {
        self.step(&[0x55, 0x06], &[])
            .step(&[0x55, 0x44, 0b0101_0000], &[])
            .step(&[0x55, 0x40, 0b0000_1110], &[])
            .step(&[0x55, 0x42, 0b0011_0010], &[])
            .step(&[0x55, 0x46, 0], &[])
            .registers()
    }

    /// Four reads back of the registers for the bridge.
    fn registers(self) -> Self {
        self.step(&[0x55, 0x20], &[0b0000_1110, 0b1111_0001])
            .step(&[0x55, 0x22], &[0b0011_0010, 0b1100_1101])
            .step(&[0x55, 0x24], &[0b0101_0000, 0b1010_1111])
            .step(&[0x55, 0x26], &[0, 0xFF])
    }

    /// Query of the data-ready bit, made for the first conversion after a set-up.
    fn ready(self) -> Self {
        self.step(&[0x55, 0x24], &[0b1101_0000, 0b0010_1111])
    }

    fn start(self) -> Self {
        self.step(&[0x55, 0x08], &[])
    }
}

impl ErrorType for Script {
    type Error = Infallible;
}

impl ReadReady for Script {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.readable.is_empty())
    }
}

impl Read for Script {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        buffer[0] = self.readable.pop_front().expect("read without data");
        Ok(1)
    }
}

impl Write for Script {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.written.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        let (expected, answer) = self.steps.pop_front().expect("nothing more was expected");
        assert_eq!(std::mem::take(&mut self.written), expected);
        self.readable.extend(answer);
        Ok(())
    }
}

fn adc(script: Script) -> Ads122<SerialBus<Script, NoopDelay>, NoopDelay> {
    Ads122::new(SerialBus::new(script, NoopDelay::new()), NoopDelay::new())
}

/// The data come least significant byte first.
const ANSWER: [u8; 8] = [1, 0x56, 0x34, 0x92, !1, !0x56, !0x34, !0x92];

#[test]
fn bytes_of_a_tick() {
    let script =
        Script::default().set_up().start().ready().step(&[0x55, 0x10], &ANSWER).registers().start();
    let mut adc = adc(script);
    assert_eq!(adc.tick(), Ok(None));
    assert_eq!(adc.tick(), Ok(Some(Counts(0x0092_3456 - (1 << 24)))));
}

#[test]
fn bytes_of_a_frozen_code() {
    let again = [2, 0x56, 0x34, 0x92, !2, !0x56, !0x34, !0x92];
    let monitor = [3, 0x56, 0x34, 0x92, !3, !0x56, !0x34, !0x92];
    let script = Script::default()
        .set_up()
        .start()
        .ready()
        .step(&[0x55, 0x10], &ANSWER)
        .registers()
        .start()
        .step(&[0x55, 0x10], &again)
        .registers()
        .step(&[0x55, 0x40, 0b1100_0001], &[])
        .step(&[0x55, 0x42, 0b1101_0010], &[])
        .start()
        .step(&[0x55, 0x10], &monitor)
        .step(&[0x55, 0x40, 0b0000_1110], &[])
        .step(&[0x55, 0x42, 0b0011_0010], &[])
        .set_up()
        .start();
    let mut adc = adc(script);
    assert_eq!(adc.tick(), Ok(None));
    assert_eq!(adc.tick(), Ok(Some(Counts(0x0092_3456 - (1 << 24)))));
    assert_eq!(adc.tick(), Err(AdcFault::Stuck));
}

#[test]
fn an_answer_cut_short_is_silence() {
    let script = Script::default().set_up().start().ready().step(&[0x55, 0x10], &ANSWER[..3]);
    let mut adc = adc(script.set_up().start());
    assert_eq!(adc.tick(), Ok(None));
    assert_eq!(adc.tick(), Err(AdcFault::Silent));
}

#[test]
fn stale_bytes_are_thrown_away() {
    // Three extra bytes after the start must not be taken for data.
    let script = Script::default()
        .set_up()
        .step(&[0x55, 0x08], &[9, 9, 9])
        .ready()
        .step(&[0x55, 0x10], &ANSWER)
        .registers()
        .start();
    let mut adc = adc(script);
    assert_eq!(adc.tick(), Ok(None));
    assert_eq!(adc.tick(), Ok(Some(Counts(0x0092_3456 - (1 << 24)))));
}

#[test]
fn babble_is_garbled() {
    let script = Script::default().set_up().step(&[0x55, 0x08], &[9; 100]);
    // The drain gives up; the reset goes out, and the first read back gives up too.
    let script = script
        .step(&[0x55, 0x06], &[9; 100])
        .step(&[0x55, 0x44, 0b0101_0000], &[])
        .step(&[0x55, 0x40, 0b0000_1110], &[])
        .step(&[0x55, 0x42, 0b0011_0010], &[])
        .step(&[0x55, 0x46, 0], &[]);
    let mut adc = adc(script);
    assert_eq!(adc.tick(), Ok(None));
    assert_eq!(adc.tick(), Err(AdcFault::Garbled));
}
