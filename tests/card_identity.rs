//! Tests on a card that must not be confused with each other.

use std::io::Cursor;

use floe::card::{self, Found, Test};
use floe::log::{Log, LogOptions};
use floe::replay::replay;
use floe::replay::result::ReplayResult;
use floe::replay::test::{TestOptions, configure};
use floe_firmware::notebook::{Kind, Notes, Track, WeightFrom};
use floe_firmware::record::{Part, Record, RecordError, SECTOR_LEN};
use floe_firmware::settings::{Effects, Settings, Stds, Zero};
use floe_tests::records::{bytes, sealed, settings, test, version_1, with_header};

const ONE: Part =
    Part { id: Some(1), run: 7, number: 0, gap: Some(0), first_index: 0, start_ms: None };
const OTHER: Part = Part { id: Some(2), ..ONE };

fn recover(log: Vec<u8>) -> (Vec<Test>, Found) {
    card::tests(Cursor::new(log)).expect("readable")
}

fn replayed(log: Vec<u8>) -> ReplayResult {
    let mut log = Log::from_reader(Box::new(Cursor::new(log)), &LogOptions::default()).unwrap();
    let config = configure(&log, &TestOptions::default()).unwrap();
    replay("FLOE.LOG", &mut log, &config, |_, _| {}).unwrap()
}

fn estimate(result: &ReplayResult) -> String {
    serde_json::to_string(&result.estimate).expect("numbers")
}

fn lengths(tests: &[Test]) -> Vec<usize> {
    tests.iter().map(|test| test.samples.len()).collect()
}

/// 50 new sectors, followed by 150 of an older test with the same number.
fn reused(encode: impl Fn(&Record) -> [u8; SECTOR_LEN], older: &Settings) -> (Vec<u8>, Vec<u8>) {
    let new = test(ONE, &settings(630.0, "NEW"), 0, 1000, 400);
    let older = test(Part { first_index: 400, ..OTHER }, older, 50, 900_000, 1200);
    let new: Vec<u8> = new.iter().flat_map(&encode).collect();
    let both = [new.clone(), older.iter().flat_map(&encode).collect()].concat();
    (new, both)
}

#[test]
fn what_an_older_test_left_behind_is_not_merged() {
    let light = settings(287.0, "OLD");
    let (new, both) = reused(Record::encode, &light);
    let (tests, found) = recover(both.clone());
    assert_eq!((lengths(&tests), found.lost, found.damaged), (vec![400, 1200], 0, 0));
    assert_eq!(tests[0].settings.name, "NEW");
    assert_eq!(tests[1].settings.config.weight_n.to_bits(), 287.0_f32.to_bits());
    let (alone, mixed) = (replayed(new), replayed(both));
    assert_eq!((mixed.log.samples, estimate(&mixed)), (400, estimate(&alone)));
    assert!(mixed.log.warnings.iter().any(|w| w.contains("floe recover")), "{mixed:?}");
}

#[test]
fn version_1_is_told_apart_by_settings_and_clock() {
    for older in [settings(287.0, "OLD"), settings(630.0, "NEW")] {
        let (new, both) = reused(version_1, &older);
        let (tests, _) = recover(both.clone());
        assert_eq!(lengths(&tests), [400, 1200], "{older:?}");
        assert_ne!(tests[0].stem.to_lowercase(), tests[1].stem.to_lowercase());
        let (alone, mixed) = (replayed(new), replayed(both));
        assert_eq!((mixed.log.samples, estimate(&mixed)), (400, estimate(&alone)));
    }
    // Number and settings are equal and the index continues; only the clock differs.
    let older = test(Part { first_index: 0, ..ONE }, &settings(630.0, "NEW"), 0, 1000, 400);
    let mut later = test(ONE, &settings(630.0, "NEW"), 50, 20_000_000, 1600);
    later.drain(..50);
    let log: Vec<u8> = older.iter().chain(&later).flat_map(version_1).collect();
    let (tests, _) = recover(log.clone());
    assert_eq!(lengths(&tests), [400, 1200]);
    assert_eq!(tests[1].split, Some("its clock is another"));
    assert_eq!(replayed(log).log.samples, 400);
}

#[test]
fn a_file_copied_twice_counts_once() {
    let log = bytes(&test(ONE, &settings(630.0, "A"), 0, 0, 800));
    let (once, _) = recover(log.clone());
    let (twice, found) = recover([log.clone(), log.clone()].concat());
    assert_eq!((lengths(&twice), found.repeated, found.lost), (lengths(&once), 100, 0));
    let result = replayed([log.clone(), log.clone()].concat());
    assert_eq!((result.log.samples, result.log.duplicates), (800, 0));
    assert!(result.log.warnings.iter().any(|w| w.contains("100 records are there again")));
    assert_eq!(estimate(&result), estimate(&replayed(log)));
}

/// Two cards, each with a test of the same number, whose sectors are interleaved as on a disk with
/// both files in fragments.
#[test]
fn two_cards_in_one_image_stay_two() {
    let one = test(ONE, &settings(630.0, "A"), 0, 0, 400);
    let other = test(OTHER, &settings(630.0, "A"), 0, 0, 480);
    let mut image = Vec::new();
    for piece in 0..60 {
        image.extend(other.get(piece).map(Record::encode).into_iter().flatten());
        image.extend(one.get(piece).map(Record::encode).into_iter().flatten());
    }
    let (tests, found) = recover(image);
    assert_eq!((lengths(&tests), found.repeated), (vec![400, 480], 0));
    assert_eq!(
        tests.iter().map(|t| &*t.stem).collect::<Vec<_>>(),
        ["test-0007-A", "test-0007-A.2"]
    );
}

#[test]
fn parts_of_a_test_stay_apart_and_in_order() {
    let second = Part { number: 1, gap: None, ..ONE };
    let mut records = test(ONE, &settings(630.0, "A"), 0, 0, 400);
    records.extend(test(second, &settings(630.0, "A"), 50, 5, 200));
    let (tests, found) = recover(bytes(&records));
    assert_eq!((lengths(&tests), found.lost), (vec![400, 200], 0));
    assert_eq!(tests[1].stem, "test-0007-A.part2");
    let text = card::csv(&tests[1]);
    assert!(text.contains("# part: 2\n# samples_lost_before: unknown\n"), "{text}");
    assert!(text.contains("# identity: 0000000000000001\n"), "{text}");
}

fn full() -> Record {
    let notes = Notes {
        kind: Some(Kind::Rafting),
        track: Some(Track::Fresh),
        snow_mm: Some(30.0),
        length_m: Some(0.6),
        width_m: Some(0.5),
        height_m: Some(0.25),
        cable_length_m: Some(21.5),
        cable_ae_n: Some(4e5),
    };
    let settings = Settings {
        effects: Effects { enabled: Some(5), compiled: Some(0x8000_0007) },
        stds: Stds {
            weight_n: Some(3.0),
            slope_rad: Some(0.002),
            zero_n: Some(0.5),
            span: Some(0.001),
            damping: Some(0.01),
            winch_m_per_s: Some(0.0002),
        },
        weight_from: Some(WeightFrom::SameCell),
        zero: Zero { before_n: Some(-0.25), after_n: Some(0.125) },
        notes,
        ..settings(630.0, "FULL")
    };
    let part = Part {
        id: Some(0x0123_4567_89AB_CDEF),
        run: 3,
        number: 2,
        gap: Some(40),
        first_index: 77,
        start_ms: Some(1_803_982_500_123),
    };
    let mut record = test(part, &settings, 9, 4, 8).remove(0);
    record.text = "I,hello*0000\n".try_into().unwrap();
    record
}

#[test]
fn a_sector_returns_as_it_was() {
    let records = [full(), Record { running: false, ..full() }, Record::default()];
    for record in records {
        assert_eq!(Record::decode(&record.encode()).as_ref(), Ok(&record));
    }
}

#[test]
fn headers_of_other_lengths_are_read() {
    let record = full();
    // A later version with more fields.
    assert_eq!(Record::decode(&with_header(&record, 200)).as_ref(), Ok(&record));
    // An earlier version without the standard deviation of the winch's speed.
    let stds = Stds { winch_m_per_s: None, ..record.settings.stds };
    let settings = Settings { stds, ..record.settings.clone() };
    let before = Record { settings, ..record.clone() };
    assert_eq!(Record::decode(&with_header(&record, 176)).as_ref(), Ok(&before));
    // An earlier version without notes.
    let earlier = Record::decode(&with_header(&record, 124)).expect("sound");
    assert_eq!(earlier.part, record.part);
    assert_eq!(
        (earlier.settings.stds, earlier.settings.effects.enabled),
        (Stds::default(), Some(5))
    );
    assert_eq!((&earlier.samples, &earlier.text), (&record.samples, &record.text));
    // Version 1.
    let first = Record::decode(&version_1(&record)).expect("sound");
    let Part { run, first_index, .. } = record.part;
    assert_eq!(first.part, Part { run, first_index, ..Part::default() });
    assert_eq!(first.settings.config, record.settings.config);
    assert_eq!((&first.samples, &first.text), (&record.samples, &record.text));
    assert!(!first.running);
}

#[test]
fn every_flipped_bit_is_noticed() {
    let settings_only = Record { samples: Default::default(), text: Default::default(), ..full() };
    let text_only = Record { samples: Default::default(), ..full() };
    let kinds = [full().encode(), settings_only.encode(), text_only.encode(), version_1(&full())];
    for sector in kinds {
        for bit in 0..8 * SECTOR_LEN {
            let mut flipped = sector;
            flipped[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(Record::decode(&flipped), Err(RecordError::Corrupt), "bit {bit}");
        }
    }
}

/// A sector with a right checksum and impossible values is rejected.
#[test]
fn what_no_logger_writes_is_refused() {
    let sector = full().encode();
    let broken = |at: usize, bytes: &[u8]| {
        let mut sector = sector;
        sector[at..at + bytes.len()].copy_from_slice(bytes);
        Record::decode(&sealed(sector))
    };
    let unsound = Err(RecordError::Unsound);
    assert_eq!(broken(0, b"FLOE"), Ok(full()));
    for name in [&b"a/b"[..], b"..\\x", b"a\nb", b"a\0b", b"\x1b[2J", b"a,b", b"\xFF\xFE"] {
        let mut padded = [0; 16];
        padded[..name.len()].copy_from_slice(name);
        assert_eq!(broken(68, &padded), unsound, "{name:?}");
    }
    // A name may contain spaces.
    let spaced = broken(68, b"a b\0\0\0\0\0\0\0\0\0\0\0\0\0").expect("sound");
    assert_eq!(spaced.settings.name.as_str(), "a b");
    for (at, number) in [
        (32, f32::NAN),
        (32, 0.0),
        (32, 1e9),
        (36, -1.0),
        (36, f32::INFINITY),
        (40, 2.0),
        (44, -0.1),
        (64, 0.0),
        (64, f32::NAN),
        (124, -1.0),
        (128, f32::INFINITY),
        (152, -3.0),
        (144, f32::NEG_INFINITY),
        (176, -1e-9),
    ] {
        assert_eq!(broken(at, &number.to_le_bytes()), unsound, "{number} at {at}");
    }
    // Nine samples, a text that is too long, a header that is too long or too short.
    assert_eq!(broken(5, &[9]), unsound);
    assert_eq!(broken(6, &500_u16.to_le_bytes()), unsound);
    for header in [0_u16, 83, 413, u16::MAX] {
        assert_eq!(broken(84, &header.to_le_bytes()), unsound, "{header}");
    }
    assert_eq!(broken(4, &[3]), Err(RecordError::Version(3)));
    let backwards = {
        let mut record = full();
        record.samples[3].index = 0;
        record.encode()
    };
    let (tests, found) = recover([sector, backwards].concat());
    assert_eq!((lengths(&tests), found.unsound), (vec![8], 1));
}
