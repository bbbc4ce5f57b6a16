//! The ADS122C04 on I²C, transaction by transaction.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc, Input};
use floe_firmware::ads122::{Ads122, I2cBus};

const CHIP: u8 = 0x40;

fn write(bytes: &[u8]) -> Transaction {
    Transaction::write(CHIP, bytes.to_vec())
}

fn ask(command: u8, answer: &[u8]) -> Transaction {
    Transaction::write_read(CHIP, vec![command], answer.to_vec())
}

/// Counter, code most significant byte first, all inverted.
fn data(counter: u8, code: [u8; 3]) -> Transaction {
    let [a, b, c] = code;
    ask(0x10, &[counter, a, b, c, !counter, !a, !b, !c])
}

/// Reset, four writes, four reads back, with the values for the bridge.
fn set_up() -> Vec<Transaction> {
    vec![
        write(&[0x06]),
        write(&[0x48, 0b0101_0000]),
        write(&[0x40, 0b0000_1110]),
        write(&[0x44, 0b0011_0010]),
        write(&[0x4C, 0]),
        ask(0x20, &[0b0000_1110, 0b1111_0001]),
        ask(0x24, &[0b0011_0010, 0b1100_1101]),
        ask(0x28, &[0b0101_0000, 0b1010_1111]),
        ask(0x2C, &[0, 0xFF]),
    ]
}

/// The first conversion after a set-up is asked for its data-ready bit.
fn ready() -> Transaction {
    ask(0x28, &[0b1101_0000, 0b0010_1111])
}

fn start() -> Transaction {
    write(&[0x08])
}

fn run(transactions: Vec<Transaction>, job: impl FnOnce(&mut Ads122<I2cBus<Mock>, NoopDelay>)) {
    let mut bus = Mock::new(&transactions);
    let mut adc = Ads122::new(I2cBus::new(bus.clone(), CHIP), NoopDelay::new());
    job(&mut adc);
    bus.done();
}

fn script(parts: &[Vec<Transaction>]) -> Vec<Transaction> {
    parts.concat()
}

#[test]
fn first_tick_sets_up_and_starts() {
    run(script(&[set_up(), vec![start()]]), |adc| assert_eq!(adc.tick(), Ok(None)));
}

#[test]
fn each_tick_reads_checks_one_register_and_starts() {
    let ticks = vec![
        ready(),
        data(1, [0x12, 0x34, 0x56]),
        ask(0x20, &[0b0000_1110, 0b1111_0001]),
        start(),
        data(2, [0xFF, 0xFF, 0xFE]),
        // The data-ready bit is not ours.
        ask(0x24, &[0b0011_0010, 0b1100_1101]),
        start(),
        data(3, [0x80, 0, 0]),
        ask(0x28, &[0b1101_0000, 0b0010_1111]),
        start(),
    ];
    run(script(&[set_up(), vec![start()], ticks]), |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x0012_3456))));
        assert_eq!(adc.tick(), Ok(Some(Counts(-2))));
        assert_eq!(adc.tick(), Ok(Some(Counts(-0x0080_0000))));
    });
}

/// After a fault the chip is set up again and the next conversion started.
fn one_fault(bad: Vec<Transaction>, fault: AdcFault) {
    let after = vec![ready(), data(1, [0, 0, 7]), ask(0x20, &[0b0000_1110, 0b1111_0001]), start()];
    let all = script(&[set_up(), vec![start()], bad, set_up(), vec![start()], after]);
    run(all, |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Err(fault));
        assert_eq!(adc.tick(), Ok(Some(Counts(7))));
    });
}

#[test]
fn an_answer_that_contradicts_itself_is_garbled() {
    one_fault(vec![ready(), ask(0x10, &[1, 0, 0, 9, 0xFE, 0xFF, 0xFF, 0xFF])], AdcFault::Garbled);
}

#[test]
fn registers_at_their_defaults_give_away_a_brown_out() {
    one_fault(
        vec![ready(), ask(0x10, &[0, 0, 9, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF])],
        AdcFault::Garbled,
    );
}

#[test]
fn a_register_that_changed_by_itself_is_found() {
    let bad = vec![ready(), data(1, [0, 0, 9]), ask(0x20, &[0b0000_1100, 0b1111_0011])];
    one_fault(bad, AdcFault::Registers);
}

#[test]
fn no_acknowledge_is_silence_and_is_tried_again() {
    let nack = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
    let dead = write(&[0x06]).with_error(nack);
    run(script(&[vec![dead], set_up(), vec![start()]]), |adc| {
        assert_eq!(adc.tick(), Err(AdcFault::Silent));
        assert_eq!(adc.tick(), Ok(None));
    });
}

#[test]
fn a_conversion_that_is_not_there_is_not_ready() {
    one_fault(vec![ask(0x28, &[0b0101_0000, 0b1010_1111])], AdcFault::NotReady);
}

#[test]
fn the_same_conversion_twice_is_not_ready() {
    let once = vec![ready(), data(1, [0, 0, 7]), ask(0x20, &[0b0000_1110, 0b1111_0001]), start()];
    let all =
        script(&[set_up(), vec![start()], once, vec![data(1, [0, 0, 7])], set_up(), vec![start()]]);
    run(all, |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(7))));
        assert_eq!(adc.tick(), Err(AdcFault::NotReady));
    });
}

#[test]
fn another_input_is_another_set_up() {
    let temperature = vec![
        write(&[0x06]),
        write(&[0x48, 0b0101_0000]),
        write(&[0x40, 0b0000_1110]),
        write(&[0x44, 0b0011_0001]),
        write(&[0x4C, 0]),
        ask(0x20, &[0b0000_1110, 0b1111_0001]),
        ask(0x24, &[0b0011_0001, 0b1100_1110]),
        ask(0x28, &[0b0101_0000, 0b1010_1111]),
        ask(0x2C, &[0, 0xFF]),
        start(),
        ready(),
        // -12 °C: -384 in 14 bits at the top.
        data(1, [0xFA, 0x00, 0x00]),
        ask(0x20, &[0b0000_1110, 0b1111_0001]),
        start(),
    ];
    run(temperature, |adc| {
        assert!(adc.select(Input::Temperature));
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(-12 * 256))));
    });
}
