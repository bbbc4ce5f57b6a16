//! The converter's driver with a model of the chip, over both buses, with every fault.

use std::cell::RefCell;
use std::rc::Rc;

use floe::chip::{
    Clock, Device, I2cChip, LoadCell, Schedule, SerialChip, SerialLine, Trouble, Variant,
};
use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc, Input};
use floe_firmware::ads122::{Ads122, I2cBus, SerialBus};

const PERIOD_NS: u64 = 62_500_000;
const SAMPLES: i32 = 64;

type Taken = Result<Option<Counts>, AdcFault>;

fn ramp() -> LoadCell {
    let codes: Vec<i32> = (0..SAMPLES).map(|i| 100_000 + 2_345 * i).collect();
    LoadCell::from_codes(&codes, 16.0)
}

fn expected(i: i32) -> Taken {
    Ok(Some(Counts(100_000 + 2_345 * i)))
}

/// Runs the driver for a number of periods; entry `i` of the result belongs to sample `i`.
fn run(adc: &mut dyn BridgeAdc, clock: &Clock) -> Vec<Taken> {
    let mut tick = |n: u64| {
        clock.wait_until(n * PERIOD_NS);
        adc.tick()
    };
    let first = tick(1);
    let rest: Vec<Taken> = (2..=SAMPLES as u64).map(&mut tick).collect();
    assert!(first.is_err() || first == Ok(None), "{first:?}");
    rest
}

fn serial(cell: LoadCell, trouble: Schedule) -> Vec<Taken> {
    let clock = Clock::default();
    let chip = Rc::new(RefCell::new(SerialChip::new(cell, trouble, 86_806)));
    let bus = SerialBus::new(SerialLine::new(chip, clock.clone()), clock.clone());
    run(&mut Ads122::new(bus, clock.clone()), &clock)
}

fn i2c(cell: LoadCell, trouble: Schedule) -> Vec<Taken> {
    let clock = Clock::default();
    let device = Rc::new(RefCell::new(Device::new(Variant::C04, cell, trouble)));
    let bus = I2cBus::new(I2cChip::new(device, clock.clone()), 0x40);
    run(&mut Ads122::new(bus, clock.clone()), &clock)
}

#[test]
fn every_code_arrives_over_both_buses() {
    for taken in [serial(ramp(), Schedule::default()), i2c(ramp(), Schedule::default())] {
        for (i, taken) in (0..).zip(&taken) {
            assert_eq!(*taken, expected(i), "sample {i}");
        }
    }
}

fn lost(taken: &Taken) -> bool {
    taken.is_err() || *taken == Ok(None)
}

/// Checks a fault in samples 20 to 29: it is reported within two samples and to its end, and has no
/// effect two samples after its end.
fn check(taken: &[Taken], faults: &[AdcFault], name: &str) {
    for (i, taken) in (0_i32..).zip(taken) {
        match i {
            0..19 => assert_eq!(*taken, expected(i), "{name}: sample {i}"),
            22..29 => assert!(
                taken.is_err_and(|fault| faults.contains(&fault)),
                "{name}: sample {i} {taken:?}"
            ),
            32.. => assert_eq!(*taken, expected(i), "{name}: sample {i}"),
            // A sample at the edges of the fault may be lost, but its number must not be wrong.
            _ => assert!(lost(taken) || *taken == expected(i), "{name}: {i} {taken:?}"),
        }
    }
}

#[test]
fn lasting_troubles_show_and_pass() {
    use AdcFault::{Garbled, NotReady, Silent};
    let cases: [(Trouble, &[AdcFault]); 5] = [
        (Trouble::Silent, &[Silent]),
        (Trouble::Late { ns: 10_000_000 }, &[Silent, Garbled]),
        (Trouble::Slow { ns: 80_000_000 }, &[NotReady, Garbled]),
        (Trouble::Stuck, &[NotReady]),
        (Trouble::Babbling, &[Garbled, Silent]),
    ];
    for (trouble, faults) in cases {
        let schedule = Schedule::default().with(20, 30, trouble);
        check(&serial(ramp(), schedule), faults, &format!("serial, {trouble:?}"));
    }
    for (trouble, faults) in [cases[0], cases[3], cases[4]] {
        let schedule = Schedule::default().with(20, 30, trouble);
        check(&i2c(ramp(), schedule), faults, &format!("I2C, {trouble:?}"));
    }
}

#[test]
fn a_brown_out_costs_one_sample() {
    let schedule = || Schedule::default().with(20, 21, Trouble::BrownOut);
    for taken in [serial(ramp(), schedule()), i2c(ramp(), schedule())] {
        let bad: Vec<_> = taken.iter().filter(|t| t.is_err()).collect();
        assert_eq!(bad.len(), 1, "{bad:?}");
    }
}

#[test]
fn an_upset_register_is_found_with_the_next_sample() {
    for register in 0..4 {
        let mask = if register == 3 { 0b100 } else { 0b10 };
        let schedule = Schedule::default().with(20, 21, Trouble::Upset { register, mask });
        let taken = i2c(ramp(), schedule);
        let found = taken.iter().position(Result::is_err).expect("never found");
        assert!((19..21).contains(&found), "register {register} at {found}");
        for i in 21..SAMPLES - 1 {
            assert_eq!(taken[i as usize], expected(i), "register {register}, sample {i}");
        }
    }
}

#[test]
fn full_scale_is_passed_on_as_full_scale() {
    let schedule = Schedule::default().with(20, 30, Trouble::Saturated);
    let taken = serial(ramp(), schedule);
    assert!(taken[20..30].iter().all(|t| *t == Ok(Some(Counts((1 << 23) - 1)))));
    assert_eq!(taken[30], expected(30));
}

#[test]
fn a_frozen_code_is_found_when_it_comes_again_and_lets_go() {
    let schedule = || Schedule::default().with(20, 40, Trouble::Frozen);
    for taken in [serial(ramp(), schedule()), i2c(ramp(), schedule())] {
        let found = taken.iter().position(Result::is_err).expect("never found");
        assert_eq!(found, 21, "sample 20 is the first with that code");
        let all = &taken[found..40];
        assert!(all.iter().all(|t| *t == Err(AdcFault::Stuck)), "{all:?}");
        assert_eq!(taken[41], expected(41));
    }
}

#[test]
fn a_force_that_stands_still_is_not_a_frozen_code() {
    // Codes that a hung converter could have, including a quarter of full scale.
    for code in [0, 5_000, -5_000, 123_457, (1 << 21) - 1, -(1 << 21)] {
        let still = || LoadCell::from_codes(&[code; 64], 16.0);
        for taken in [serial(still(), Schedule::default()), i2c(still(), Schedule::default())] {
            assert!(taken.iter().all(|t| *t == Ok(Some(Counts(code)))), "{code}: {taken:?}");
        }
    }
}

#[test]
fn a_tick_is_short() {
    let clock = Clock::default();
    let cell = LoadCell::from_codes(&[7, 8, 8], 16.0);
    let device = Rc::new(RefCell::new(Device::new(Variant::C04, cell, Schedule::default())));
    let bus = I2cBus::new(I2cChip::new(device, clock.clone()), 0x40);
    let mut adc = Ads122::new(bus, clock.clone());
    let mut tick_us = |n: u64, code: Option<i32>| {
        clock.wait_until(n * PERIOD_NS);
        assert_eq!(adc.tick(), Ok(code.map(Counts)));
        (clock.now_ns() - n * PERIOD_NS) / 1000
    };
    tick_us(1, None);
    tick_us(2, Some(7));
    assert_eq!(tick_us(3, Some(8)), 785, "bits of 2.5 µs: 102 data, 4 * 48 registers, 20 start");
    assert_eq!(tick_us(4, Some(8)), 785 + 1000 + 595, "with the reference");
}

#[test]
fn the_chips_noise_does_not_look_stuck() {
    for noise_codes in [0.3, 1.0, 12.0] {
        let cell = LoadCell::from_codes(&[5_000; 64], 16.0).with_noise(noise_codes, 7);
        assert!(serial(cell, Schedule::default()).iter().all(Result::is_ok));
    }
}

#[test]
fn other_inputs() {
    let measure = |cell: LoadCell, input: Input| {
        let clock = Clock::default();
        let device = Rc::new(RefCell::new(Device::new(Variant::C04, cell, Schedule::default())));
        let bus = I2cBus::new(I2cChip::new(device, clock.clone()), 0x40);
        let mut adc = Ads122::new(bus, clock.clone());
        adc.select(input);
        assert_eq!(adc.tick(), Ok(None));
        clock.wait_until(PERIOD_NS);
        adc.tick().expect("no fault").expect("a code").0
    };
    assert_eq!(measure(ramp(), Input::Temperature), -12 * 256);
    assert_eq!(measure(ramp(), Input::Shorted), 0);
    assert_eq!(measure(ramp(), Input::BurnOut), 100_000);
    assert_eq!(measure(ramp().disconnected(), Input::BurnOut), (1 << 23) - 1);
}
