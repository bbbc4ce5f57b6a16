//! Cards that are inserted, removed, exchanged, full or unreadable for a moment, with the real file
//! system code: no data on any card are overwritten, and the board reports the true state.

use std::io::Cursor;

use floe::card;
use floe_firmware::card::CardLog;
use floe_firmware::settings::Settings;
use floe_firmware::store::CardState;
use floe_tests::board::{last_settings, with_board};
use floe_tests::fat::{Rest, SimCard, formatted, picture, with_picture};
use floe_tests::records::{settings, stick_slip};

/// Length of the log, sectors: 512 KiB, eight minutes.
const LOG_SECTORS: u32 = 1024;
const BEGIN: &[u8] = b"set weight 630\nset span 5000\nlive off\nstart\n";
/// Samples in a test, and the latest sample of a detection: a card is checked every 16 samples.
const TICKS: u32 = 401;
const LATEST: u32 = 33;

/// Number of samples of each test on a card.
fn lengths(content: Vec<u8>) -> Vec<usize> {
    let tests = card::tests(Cursor::new(content)).map(|(tests, _)| tests).unwrap_or_default();
    tests.iter().map(|test| test.samples.len()).collect()
}

/// Runs a logger for one test; returns its output.
fn one_test(card: &SimCard, log_sectors: u32) -> String {
    with_board(CardLog::new(card.clone(), log_sectors), &stick_slip(TICKS), |board| {
        board.type_in(BEGIN);
        (0..TICKS).for_each(|_| board.tick());
        board.type_in(b"stop\n");
        board.said()
    })
}

/// The card is exchanged between two tests, the second of which starts at once.
#[test]
fn an_exchanged_card_keeps_what_is_on_it() {
    let card = SimCard::new(formatted());
    let (first, said) =
        with_board(CardLog::new(card.clone(), LOG_SECTORS), &stick_slip(TICKS), |board| {
            board.type_in(BEGIN);
            (0..TICKS).for_each(|_| board.tick());
            board.type_in(b"stop\n");
            let first = card.exchange(with_picture());
            board.type_in(b"start\n");
            (0..TICKS).for_each(|_| board.tick());
            board.type_in(b"stop\n");
            (first, board.said())
        });
    let second = card.content();
    assert_eq!(picture(&second), picture(&with_picture()), "somebody's picture");
    assert_eq!(lengths(first), [400]);
    let kept = lengths(second);
    assert!(matches!(kept[..], [samples] if samples >= (TICKS - LATEST) as usize), "{kept:?}");
    assert!(said.contains("nothing is kept") && said.contains("card ready"), "{said}");
}

#[test]
fn a_card_that_is_taken_out_between_tests_is_missed() {
    let card = SimCard::new(formatted());
    with_board(CardLog::new(card.clone(), LOG_SECTORS), &[0], |board| {
        board.tick();
        assert_eq!(board.view().card, CardState::Ready);
        card.cut_after(0, Rest::Old);
        (0..LATEST).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::NoCard);
        card.revive();
        (0..LATEST).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::Ready);
    });
}

/// The card's settings are taken, so a running measurement with other settings is ended.
#[test]
fn a_card_that_is_put_in_ends_what_is_being_measured() {
    let card = SimCard::new(formatted());
    one_test(&card, LOG_SECTORS);
    card.cut_after(0, Rest::Old);
    with_board(CardLog::new(card.clone(), LOG_SECTORS), &stick_slip(TICKS), |board| {
        board.type_in(b"weigh\n");
        (0..TICKS / 2).for_each(|_| board.tick());
        assert!(board.view().weighed.is_some());
        card.revive();
        (0..LATEST).for_each(|_| board.tick());
        assert!(board.view().weighed.is_none());
        board.type_in(b"accept\n");
        let said = board.said();
        assert!(said.contains("aborted") && said.contains("nothing to accept"), "{said}");
    });
}

/// The contacts bounce while the end of the log is searched.
#[test]
fn tests_that_cannot_be_read_for_a_moment_are_not_written_over() {
    let card = SimCard::new(formatted());
    one_test(&card, LOG_SECTORS);
    with_board(CardLog::new(card.clone(), LOG_SECTORS), &stick_slip(TICKS), |board| {
        (0..LATEST).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::Ready);
        card.exchange(card.content());
        card.set_readable(false);
        (0..LATEST).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::Unreadable);
        card.set_readable(true);
        (0..LATEST).for_each(|_| board.tick());
        board.type_in(BEGIN);
        (0..TICKS).for_each(|_| board.tick());
        board.type_in(b"stop\n");
    });
    assert_eq!(lengths(card.content()), [400, 401]);
}

#[test]
fn a_full_log_is_said_and_another_card_taken() {
    let card = SimCard::new(formatted());
    with_board(CardLog::new(card.clone(), 32), &stick_slip(TICKS), |board| {
        board.type_in(BEGIN);
        (0..TICKS).for_each(|_| board.tick());
        let said = board.said();
        assert!(said.contains("FLOE.LOG is full"), "{said}");
        assert_eq!(board.view().card, CardState::Full);
        let full = card.exchange(formatted());
        assert!(lengths(full).iter().sum::<usize>() > 200);
        (0..TICKS / 4).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::Ready);
        board.type_in(b"stop\n");
    });
    assert!(lengths(card.content()).iter().sum::<usize>() > 50);
}

/// Output of a logger switched on with this card.
fn at_power_up(card: &SimCard, log_sectors: u32) -> String {
    with_board(CardLog::new(card.clone(), log_sectors), &[0], |board| {
        (0..LATEST).for_each(|_| board.tick());
        board.said()
    })
}

#[test]
fn a_test_that_ended_while_the_card_was_away_does_not_go_on() {
    let card = SimCard::new(formatted());
    with_board(CardLog::new(card.clone(), LOG_SECTORS), &stick_slip(TICKS), |board| {
        board.type_in(BEGIN);
        (0..TICKS / 2).for_each(|_| board.tick());
        card.cut_after(0, Rest::Old);
        board.type_in(b"stop\n");
        (0..LATEST).for_each(|_| board.tick());
        card.revive();
        (0..LATEST).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::Ready);
    });
    let said = at_power_up(&card, LOG_SECTORS);
    assert!(!said.contains("the test goes on"), "{said}");
    let kept = lengths(card.content());
    assert!(matches!(kept[..], [samples] if samples >= (TICKS / 2 - LATEST) as usize), "{kept:?}");
}

#[test]
fn a_test_that_has_filled_the_log_does_not_go_on() {
    const SECTORS: u32 = 32;
    let card = SimCard::new(formatted());
    one_test(&card, SECTORS);
    let said = at_power_up(&card, SECTORS);
    assert!(said.contains("FLOE.LOG is full") && !said.contains("the test goes on"), "{said}");
}

/// The state is polled repeatedly: a full card must never be reported as unformatted, or the user
/// would format it.
#[test]
fn a_card_without_room_is_named_as_that() {
    let card = SimCard::new(with_picture());
    let said = one_test(&card, 9000);
    assert!(said.contains("no room for FLOE.LOG"), "{said}");
    assert!(!said.contains("format it"), "{said}");
    assert_eq!(picture(&card.content()), picture(&with_picture()));
}

/// Settings of a logger switched on with this card.
fn settings_at_power_up(card: &SimCard) -> Settings {
    with_board(CardLog::new(card.clone(), LOG_SECTORS), &[0], |board| {
        board.tick();
        board.type_in(b"status\n");
        last_settings(&board.said())
    })
}

#[test]
fn a_card_that_is_put_in_later_gets_what_was_set_before() {
    let card = SimCard::new(formatted());
    card.cut_after(0, Rest::Old);
    with_board(CardLog::new(card.clone(), LOG_SECTORS), &[0], |board| {
        (0..LATEST).for_each(|_| board.tick());
        board.type_in(b"set weight 630\nset span 5000\n");
        card.revive();
        (0..LATEST).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::Ready);
    });
    has_what_was_set(&card);
}

/// The card has the weight and the span that were set, and nothing else.
fn has_what_was_set(card: &SimCard) {
    let kept = settings_at_power_up(card);
    let weight_from = kept.weight_from;
    assert_eq!(kept, Settings { weight_from, ..settings(630.0, "") });
}

#[test]
fn an_exchanged_card_gets_the_settings() {
    let card = SimCard::new(formatted());
    with_board(CardLog::new(card.clone(), LOG_SECTORS), &[0], |board| {
        board.type_in(b"set weight 630\nset span 5000\n");
        card.exchange(formatted());
        (0..3 * LATEST).for_each(|_| board.tick());
        assert_eq!(board.view().card, CardState::Ready);
    });
    has_what_was_set(&card);
}

/// The contacts bounce once, at any access to a card that is put in.
#[test]
fn a_card_that_fails_once_is_used_and_not_called_anything_else() {
    let used = SimCard::new(formatted());
    one_test(&used, LOG_SECTORS);
    for (content, tests) in [(formatted(), 1), (used.content(), 2)] {
        for count in 0..200 {
            let card = SimCard::new(content.clone());
            card.cut_after(0, Rest::Old);
            let log = CardLog::new(card.clone(), LOG_SECTORS);
            with_board(log, &stick_slip(TICKS), |board| {
                board.tick();
                card.revive();
                card.fail_once_after(count);
                (0..3 * LATEST).for_each(|_| board.tick());
                card.fail_once_after(u32::MAX);
                (0..LATEST).for_each(|_| board.tick());
                let said = board.said();
                assert_eq!(board.view().card, CardState::Ready, "{count}: {said}");
                assert!(!said.contains("format") && !said.contains("room"), "{count}: {said}");
                board.type_in(BEGIN);
                (0..16).for_each(|_| board.tick());
                board.type_in(b"stop\n");
            });
            let content = card.content();
            let logs = content.chunks_exact(32).filter(|entry| entry.starts_with(b"FLOE    LOG"));
            assert_eq!(logs.count(), 1, "{count}");
            assert_eq!(lengths(content).len(), tests, "{count}");
        }
    }
}

/// A full FAT16 has more entries in its table than clusters.
#[test]
fn nothing_is_written_behind_the_file_system() {
    let mut content = formatted();
    let end = content.len();
    content.resize(end + 512 * 200, 0xA5);
    let card = SimCard::new(content);
    let said = one_test(&card, 9000);
    assert!(said.contains("no room for FLOE.LOG"), "{said}");
    assert!(card.content()[end..].iter().all(|&byte| byte == 0xA5));
}

/// The newest sector holds the settings in use, whichever access at power-up fails.
#[test]
fn a_card_that_fails_once_at_power_up_gives_its_newest_settings() {
    let used = SimCard::new(formatted());
    with_board(CardLog::new(used.clone(), LOG_SECTORS), &stick_slip(TICKS), |board| {
        board.type_in(BEGIN);
        (0..TICKS).for_each(|_| board.tick());
        board.type_in(b"stop\nset name newest\n");
    });
    for count in 0..60 {
        let card = SimCard::new(used.content());
        card.fail_once_after(count);
        with_board(CardLog::new(card.clone(), LOG_SECTORS), &[0], |board| {
            (0..LATEST).for_each(|_| board.tick());
            card.fail_once_after(u32::MAX);
            (0..LATEST).for_each(|_| board.tick());
            board.type_in(b"status\n");
            let said = board.said();
            assert!(said.contains("T,1,newest,16,630,"), "{count}: {said}");
        });
    }
}
