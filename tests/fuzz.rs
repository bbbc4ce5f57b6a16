//! Fuzz tests of every parser and of `step`, two seconds each. `FLOE_FUZZ_S=600` sets the time,
//! `FLOE_FUZZ_CASE=N` runs one case again.

use std::io::Cursor;
use std::path::Path;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use floe::campaign::manifest;
use floe::card;
use floe::log::{Format, Log, LogOptions, Unit};
use floe::sim::{Run, Scene};
use floe_core::{Config, Counts, Fault, Newtons, Pipeline, RawSample, Reading};
use floe_firmware::adc::{BridgeAdc, Input};
use floe_firmware::ads122::{Ads122, SerialBus};
use floe_firmware::command::Command;
use floe_firmware::line::Line;
use floe_firmware::record::{Part, Record, SECTOR_LEN};
use floe_tests::fuzz::{Dice, WORDS, run};
use floe_tests::records::{bytes, sealed, settings, test};

/// The first lines of a bundled log.
fn head(name: &str, lines: usize) -> Vec<u8> {
    let path = format!("{}/../host-sim/logs/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read(path).expect("a bundled log");
    text.split_inclusive(|&byte| byte == b'\n').take(lines).flatten().copied().collect()
}

/// Asserts that a log without damage is read, or every case would end at its first line.
fn assert_log(seed: &[u8], options: &LogOptions) {
    let mut log = Log::from_reader(Box::new(Cursor::new(seed.to_vec())), options).expect("a log");
    assert!(log.next_sample().expect("readable").is_some());
}

fn read_log(text: Vec<u8>, options: &LogOptions) {
    let Ok(mut log) = Log::from_reader(Box::new(Cursor::new(text)), options) else { return };
    let _ = (log.metadata().clone(), log.rate_hz(), log.unit());
    while let Ok(Some(sample)) = log.next_sample() {
        assert!(sample.time_s.is_finite());
    }
    let _ = log.warnings();
}

fn fuzz_log(name: &str, seed: Vec<u8>, format: Format) {
    assert_log(&seed, &LogOptions { format: Some(format), ..LogOptions::default() });
    run(name, |dice| {
        let mut text = if dice.below(50) == 0 { dice.bytes(300) } else { seed.clone() };
        dice.damage(&mut text, WORDS);
        let options = LogOptions {
            format: (dice.below(2) == 0).then_some(format),
            rate_hz: (dice.below(8) == 0).then_some(16.0),
            unit: (dice.below(8) == 0).then_some(Unit::Counts),
            array_id: (dice.below(8) == 0).then_some(1),
            ..LogOptions::default()
        };
        read_log(text, &options);
    });
}

#[test]
fn csv() {
    fuzz_log("csv", head("dff8-13.csv", 60), Format::Csv);
}

#[test]
fn cr10() {
    fuzz_log("cr10", head("dff8-13.dat", 60), Format::Cr10);
}

#[test]
fn toa5() {
    let mut text = b"\"TOA5\",\"x\",\"CR1000\",\"1\",\"1\",\"p\",\"1\",\"pull\"\n\
        \"TIMESTAMP\",\"RECORD\",\"force_n\"\n\"TS\",\"RN\",\"N\"\n\"\",\"\",\"Smp\"\n"
        .to_vec();
    for i in 0..50 {
        let seconds = f64::from(i) / 16.0;
        let line = format!("\"2000-02-29 23:59:{:07.4}\",{i},{}\n", 56.0 + seconds, i * 20);
        text.extend(line.bytes());
    }
    fuzz_log("toa5", text, Format::Toa5);
}

fn log_of_a_card() -> Vec<u8> {
    let part = Part { id: Some(7), run: 1, ..Part::default() };
    let mut records = test(part, &settings(630.0, "A"), 0, 0, 64);
    records[3].text = "E,1,2*0000\n".try_into().expect("room");
    bytes(&records)
}

/// Cards with right checksums, so that cases pass the check of the checksum.
#[test]
fn card() {
    let log = log_of_a_card();
    assert_log(&log, &LogOptions::default());
    run("card", |dice| {
        let mut log = log.clone();
        for _ in 0..dice.below(30) {
            let at = dice.below(log.len());
            log[at] = dice.bits() as u8;
        }
        if dice.below(4) == 0 {
            dice.damage(&mut log, WORDS);
        }
        for sector in log.chunks_exact_mut(SECTOR_LEN) {
            if dice.below(8) > 0 {
                let whole = sealed(sector.try_into().expect("a sector"));
                sector.copy_from_slice(&whole);
            }
        }
        if let Ok((tests, _)) = card::tests(Cursor::new(log.clone())) {
            for test in &tests {
                let is_plain = |b: u8| b.is_ascii_alphanumeric() || b"-_.".contains(&b);
                assert!(test.stem.bytes().all(is_plain));
                let _ = (card::csv(test), card::toa5(test), test.missing());
            }
        }
        read_log(log, &LogOptions::default());
    });
}

#[test]
fn sector() {
    let log = log_of_a_card();
    let is_sound = |it: &[u8]| Record::decode(it.try_into().expect("a sector")).is_ok();
    assert!(log.chunks(SECTOR_LEN).all(is_sound));
    run("sector", |dice| {
        let at = dice.below(log.len() / SECTOR_LEN) * SECTOR_LEN;
        let mut sector: [u8; SECTOR_LEN] = log[at..at + SECTOR_LEN].try_into().expect("a sector");
        for _ in 0..dice.below(20) {
            sector[dice.below(SECTOR_LEN)] = dice.bits() as u8;
        }
        if let Ok(record) = Record::decode(&sealed(sector)) {
            assert!(record.settings.is_sound());
            let _ = record.encode();
        }
    });
}

#[test]
fn console() {
    let seeds = [
        "set weight 630",
        "calibrate 98.1",
        "set name A-1",
        "live on",
        "start test",
        "set tare -5",
    ];
    seeds.iter().for_each(|seed| assert!(Command::parse(seed).is_ok(), "{seed}"));
    run("console", |dice| {
        let mut text = dice.pick(&seeds).as_bytes().to_vec();
        dice.damage(&mut text, WORDS);
        let _ = Command::parse(&String::from_utf8_lossy(&text));
    });
}

/// Live lines with right checksums.
#[test]
fn live_line() {
    let seeds = [
        "T,3,A,16,630,0.03,0.016,,0,429.5,-8388608,8388607,,,,,,,,,,,,,,,,,,",
        "S,12,630.5,good,stick,0",
        "A,964,1.24,0.01,0.78,0.01",
        "E,1,22,0.5,25,0.5,780,490,781,200,1.24,0.001,0.78,0.001,1.6,0.17,361,18.9,0,good,",
        "C,33,964,0.4,mass,0.65,0.02",
        "R,640,0,0,0,0,33,1.24,0.001,0.001,33,0.78,0.001,0.001,33,2,361,18.9,23000,1.78,,0.1",
        "H,640,0,1,0,0,0.0625,0.0001,80,0",
        "M,bridge,32,0,12345.5,11.5,20",
        "G,40,630.02,0.05,2.01,0.0873,1.2,",
        "F,,3,0.5,60,0.25,0.4,0.0037,",
        "K,16,-31.25,3.7",
        "Y,16,1803982500123",
        "W,16,moving",
        "N,a note",
    ];
    let crc = crc::Crc::<u16>::new(&crc::CRC_16_XMODEM);
    let whole = |text: &str| format!("{text}*{:04X}", crc.checksum(text.as_bytes()));
    seeds.iter().for_each(|seed| assert!(Line::parse(&whole(seed)).is_ok(), "{seed}"));
    run("live line", |dice| {
        let mut text = dice.pick(&seeds).as_bytes().to_vec();
        dice.damage(&mut text, WORDS);
        let text = String::from_utf8_lossy(&text);
        let text = if dice.below(8) > 0 { whole(&text) } else { text.into_owned() };
        if let Ok(line) = Line::parse(&text) {
            let _ = line.to_text();
        }
    });
}

#[test]
fn scene() {
    let names = ["dff8-13.toml", "hard/slack.toml", "hard/breaking.toml", "hard/all.toml"];
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../host-sim/scenes/");
    let seeds = names.map(|name| std::fs::read(format!("{folder}{name}")).expect("a scene"));
    for seed in &seeds {
        Scene::from_toml(&String::from_utf8_lossy(seed)).expect("a scene");
    }
    run("scene", |dice| {
        let mut text = dice.pick(&seeds).clone();
        dice.damage(&mut text, WORDS);
        let Ok(scene) = Scene::from_toml(&String::from_utf8_lossy(&text)) else { return };
        let Ok(mut run) = Run::new(&scene, 1) else { return };
        for sample in run.by_ref().take(50) {
            assert!(sample.index <= RawSample::LAST_INDEX);
        }
    });
}

/// Tables of a campaign.
#[test]
fn manifest() {
    let seed = b"# a comment\nfile,array_id,column,unit,weight_n,mass_kg,slope_deg,winch_m_per_s,\
        snow_mm,kind,track,cable_length_m,test_id\n\
        day3.dat,118,5,N,630,,0,0.016,10,sliding,fresh,15,DFF8-13\n\
        a.csv,,force_n,,,64.2,-2.5,,,over-riding,repeated,,\"two, words\"\n";
    let text = String::from_utf8_lossy(seed);
    let entries = manifest::read(&text, Path::new("folder")).expect("a table");
    assert!(manifest::is_manifest(&text) && entries.len() == 2);
    run("manifest", |dice| {
        let mut text = seed.to_vec();
        dice.damage(&mut text, WORDS);
        let text = String::from_utf8_lossy(&text);
        if !manifest::is_manifest(&text) {
            return;
        }
        let Ok(entries) = manifest::read(&text, Path::new("folder")) else { return };
        assert!(entries.len() <= text.lines().count());
    });
}

/// A serial port with random behaviour.
struct Noise<'a>(&'a mut Dice);

impl ErrorType for Noise<'_> {
    type Error = core::convert::Infallible;
}

impl ReadReady for Noise<'_> {
    fn read_ready(&mut self) -> Result<bool, Self::Error> {
        Ok(self.0.below(8) > 0)
    }
}

impl Read for Noise<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
        let count = self.0.below(buffer.len() + 1).max(1).min(buffer.len());
        buffer[..count].fill_with(|| *self.0.pick(&[0, 0x55, 0x80, 0xFF, 1, 2]));
        Ok(count)
    }
}

impl Write for Noise<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

#[test]
fn adc_answers() {
    run("adc answers", |dice| {
        let clock = floe::chip::Clock::default();
        let inputs = [Input::Bridge, Input::Temperature, Input::Shorted, Input::BurnOut];
        let wanted = *dice.pick(&inputs);
        let mut adc = Ads122::new(SerialBus::new(Noise(dice), clock.clone()), clock);
        let _ = adc.select(wanted);
        for _ in 0..20 {
            let _ = adc.tick();
        }
    });
}

fn any_f32(dice: &mut Dice) -> f32 {
    match dice.below(4) {
        0 => f32::from_bits(dice.bits() as u32),
        1 => *dice.pick(&[0.0, -0.0, f32::MAX, f32::MIN_POSITIVE, f32::NAN, f32::INFINITY]),
        _ => (dice.below(2_000_000) as f32 - 1_000_000.0) / 100.0,
    }
}

fn reading(dice: &mut Dice, force_n: f32) -> Reading {
    match dice.below(40) {
        0 => Reading::Force(Newtons(any_f32(dice))),
        1 => Reading::Counts(Counts(dice.bits() as i32)),
        2 => Reading::Bad(*dice.pick(&[Fault::Timeout, Fault::Corrupt, Fault::Sentinel])),
        _ => Reading::Force(Newtons(force_n + dice.below(1000) as f32 / 250.0)),
    }
}

/// Stick and slip of arbitrary size at arbitrary rates, with arbitrary disturbances.
#[test]
fn step() {
    run("step", |dice| {
        let config = Config {
            rate_hz: *dice.pick(&[1.0, 4.0, 16.0, 16.0, 100.0, 2000.0]),
            weight_n: any_f32(dice).abs(),
            slope_rad: dice.below(200) as f32 / 100.0 - 1.0,
            winch_m_per_s: (dice.below(2) == 0).then(|| any_f32(dice).abs()),
            range_n: (dice.below(4) == 0).then(|| any_f32(dice).abs()),
            ..Config::default()
        };
        let Ok(mut pipeline) = Pipeline::new(&config) else { return };
        let (mut index, mut force_n) = ((dice.bits() >> dice.below(64)) as u32, 100.0);
        let (rise, slip) = (dice.below(60) + 1, dice.below(8));
        let size = 10.0_f32.powi(dice.below(12) as i32 - 4);
        for number in 0..400 {
            let phase = number % (rise + slip);
            force_n += if phase < rise { size } else { -size * rise as f32 / slip as f32 };
            let moved = match dice.below(100) {
                0 => (dice.bits() >> dice.below(64)) as u32,
                1 => 0,
                2 => dice.below(50) as u32,
                _ => 1,
            };
            index = index.wrapping_add(moved);
            let _ = pipeline.step(RawSample { index, reading: reading(dice, force_n) });
        }
        while pipeline.finish().is_some() {}
        let _ = pipeline.report();
    });
}
