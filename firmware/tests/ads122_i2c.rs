//! The driver of the ADS122C04 on I²C, checked transaction by transaction.

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

/// Reading of the data: counter, code with its most significant byte first, and all inverted.
fn data(counter: u8, code: [u8; 3]) -> Transaction {
    let [a, b, c] = code;
    ask(0x10, &[counter, a, b, c, !counter, !a, !b, !c])
}

/// Reset, four writes, and four reads back of the registers for the bridge.
fn set_up() -> Vec<Transaction> {
    let writes = vec![
        write(&[0x06]),
        write(&[0x48, 0b0101_0000]),
        write(&[0x40, 0b0000_1110]),
        write(&[0x44, 0b0011_0010]),
        write(&[0x4C, 0]),
    ];
    [writes, registers()].concat()
}

/// Four reads back of the registers for the bridge.
fn registers() -> Vec<Transaction> {
    vec![
        ask(0x20, &[0b0000_1110, 0b1111_0001]),
        ask(0x24, &[0b0011_0010, 0b1100_1101]),
        ask(0x28, &[0b0101_0000, 0b1010_1111]),
        ask(0x2C, &[0, 0xFF]),
    ]
}

/// A conversion without a fault, after which the next one starts.
fn sample(counter: u8, code: [u8; 3]) -> Vec<Transaction> {
    [vec![data(counter, code)], registers(), vec![start()]].concat()
}

/// Conversion of the reference at 2000 a second with gain 1, with its result.
fn monitor(counter: u8, code: [u8; 3]) -> Vec<Transaction> {
    vec![
        write(&[0x40, 0b1100_0001]),
        write(&[0x44, 0b1101_0010]),
        start(),
        data(counter, code),
        write(&[0x40, 0b0000_1110]),
        write(&[0x44, 0b0011_0010]),
    ]
}

/// Query of the data-ready bit, made for the first conversion after a set-up.
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
fn each_tick_reads_checks_every_register_and_starts() {
    let mut ticks =
        vec![vec![ready()], sample(1, [0x12, 0x34, 0x56]), sample(2, [0xFF, 0xFF, 0xFE])];
    let mut last = sample(3, [0x80, 0, 0]);
    // The driver does not set the data-ready bit.
    last[3] = ask(0x28, &[0b1101_0000, 0b0010_1111]);
    ticks.push(last);
    run(script(&[set_up(), vec![start()], ticks.concat()]), |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x0012_3456))));
        assert_eq!(adc.tick(), Ok(Some(Counts(-2))));
        assert_eq!(adc.tick(), Ok(Some(Counts(-0x0080_0000))));
    });
}

/// Two equal codes, with the answer of the reference in between.
fn repeated(answer: Transaction, after: Vec<Transaction>) -> Vec<Transaction> {
    let mut monitor = monitor(3, [0, 0, 0]);
    monitor[3] = answer;
    let first = [vec![ready()], sample(1, [0, 1, 2])].concat();
    let second = [vec![data(2, [0, 1, 2])], registers(), monitor].concat();
    script(&[set_up(), vec![start()], first, second, after])
}

#[test]
fn a_code_that_comes_twice_is_good_if_the_reference_gives_another() {
    let third = [vec![start()], sample(4, [0, 1, 3])].concat();
    run(repeated(data(3, [0x1F, 0xFF, 0xF7]), third), |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x102))));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x102))));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x103))));
    });
}

#[test]
fn a_code_that_comes_of_the_reference_too_is_stuck() {
    let again = [vec![ready(), data(1, [0, 1, 2])], registers()].concat();
    let restart = || [set_up(), vec![start()]].concat();
    let free = [vec![ready()], sample(1, [0, 1, 3])].concat();
    let after = script(&[restart(), again, restart(), free]);
    run(repeated(data(3, [0, 1, 2]), after), |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x102))));
        assert_eq!(adc.tick(), Err(AdcFault::Stuck));
        assert_eq!(adc.tick(), Err(AdcFault::Stuck), "known to be, set up again or not");
        assert_eq!(adc.tick(), Ok(Some(Counts(0x103))));
    });
}

#[test]
fn full_scale_twice_is_full_scale() {
    let full = [0x7F, 0xFF, 0xFF];
    let ticks = [vec![ready()], sample(1, full), sample(2, full)].concat();
    run(script(&[set_up(), vec![start()], ticks]), |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x007F_FFFF))));
        assert_eq!(adc.tick(), Ok(Some(Counts(0x007F_FFFF))));
    });
}

/// Checks that after a fault the chip is set up again and the next conversion started.
fn one_fault(bad: Vec<Transaction>, fault: AdcFault) {
    let after = [vec![ready()], sample(1, [0, 0, 7])].concat();
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
    for register in 0..4 {
        let mut reads: Vec<Transaction> = registers()[..=register].to_vec();
        let right = [0b0000_1110, 0b0011_0010, 0b0101_0000, 0][register];
        let (command, wrong) = (0x20 | (register as u8) << 2, right ^ 0b100);
        reads[register] = ask(command, &[wrong, !wrong]);
        one_fault([vec![ready(), data(1, [0, 0, 9])], reads].concat(), AdcFault::Registers);
    }
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

/// The conversion before was read and checked: it is not lost too.
#[test]
fn a_start_that_fails_costs_the_conversion_that_it_should_start() {
    let nack = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
    let mut first = [vec![ready()], sample(1, [0, 0, 7])].concat();
    if let Some(start) = first.last_mut() {
        *start = write(&[0x08]).with_error(nack);
    }
    let again = [vec![data(1, [0, 0, 7])], set_up(), vec![start()]].concat();
    let after = [vec![ready()], sample(1, [0, 0, 9])].concat();
    run(script(&[set_up(), vec![start()], first, again, after]), |adc| {
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(7))));
        assert_eq!(adc.tick(), Err(AdcFault::NotReady));
        assert_eq!(adc.tick(), Ok(Some(Counts(9))));
    });
}

#[test]
fn a_conversion_that_is_not_there_is_not_ready() {
    one_fault(vec![ask(0x28, &[0b0101_0000, 0b1010_1111])], AdcFault::NotReady);
}

#[test]
fn the_same_conversion_twice_is_not_ready() {
    let once = [vec![ready()], sample(1, [0, 0, 7])].concat();
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
    let registers = || {
        vec![
            ask(0x20, &[0b0000_1110, 0b1111_0001]),
            ask(0x24, &[0b0011_0001, 0b1100_1110]),
            ask(0x28, &[0b0101_0000, 0b1010_1111]),
            ask(0x2C, &[0, 0xFF]),
        ]
    };
    let writes = vec![
        write(&[0x06]),
        write(&[0x48, 0b0101_0000]),
        write(&[0x40, 0b0000_1110]),
        write(&[0x44, 0b0011_0001]),
        write(&[0x4C, 0]),
    ];
    // -12 °C: -384 in 14 bits at the top.
    let taken = vec![start(), ready(), data(1, [0xFA, 0x00, 0x00])];
    let temperature = script(&[writes, registers(), taken, registers(), vec![start()]]);
    run(temperature, |adc| {
        assert!(adc.select(Input::Temperature));
        assert_eq!(adc.tick(), Ok(None));
        assert_eq!(adc.tick(), Ok(Some(Counts(-12 * 256))));
    });
}
