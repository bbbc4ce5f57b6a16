//! Days with random commands and cards that are pulled, exchanged, and fail for a moment: what is in
//! use when the power goes comes back with the card, and no card gets a second log.

use std::io::Cursor;

use floe::card;
use floe_firmware::card::CardLog;
use floe_firmware::line::Line;
use floe_firmware::settings::Settings;
use floe_firmware::store::CardState;
use floe_tests::board::{Board, lines, with_board};
use floe_tests::fat::{Rest, SimCard, formatted};
use floe_tests::fuzz::Dice;
use floe_tests::number;
use floe_tests::records::stick_slip;

const LOG_SECTORS: u32 = 1024;
/// Sampling periods until a card in the slot is found, and until its log is complete.
const FOUND: u32 = 40;
const COMPLETE: u32 = 120;

type Logger<'q, 'c> = Board<'q, 'c, CardLog<SimCard>>;

/// What a logger must know again after a power cut: number of the last test, settings, and whether
/// the test is running.
type Known = (u32, Settings, bool);

struct Day<'a> {
    card: &'a SimCard,
    /// Cards that are not in the slot.
    others: &'a mut [Vec<u8>],
    dice: &'a mut Dice,
    /// What was done, for the message.
    done: &'a mut Vec<String>,
    is_testing: bool,
}

impl Day<'_> {
    /// Does something; returns its description.
    fn act(&mut self, board: &mut Logger<'_, '_>) -> String {
        let any = self.dice.below(900) + 1;
        let mut type_in = |keys: String| {
            board.type_in(keys.as_bytes());
            keys
        };
        match self.dice.below(10) {
            0 => type_in(format!("set weight {any}\n")),
            1 => type_in(format!("set name n{any}\n")),
            2 => type_in("set tare 5\nset snow 3\n".to_string()),
            3 => type_in("start\n".to_string()),
            4 => type_in("stop\n".to_string()),
            5 => type_in("note hello\n".to_string()),
            6 => {
                self.card.cut_after(0, Rest::Old);
                "pull".to_string()
            }
            7 => {
                self.card.revive();
                "insert".to_string()
            }
            8 => {
                self.card.fail_once_after(any as u32 % 80);
                format!("fail {}", any % 80)
            }
            _ => {
                let other = &mut self.others[any % 2];
                *other = self.card.exchange(std::mem::take(other));
                format!("exchange {}", any % 2)
            }
        }
    }

    /// Lets some time pass, and looks at the output whether a test runs.
    fn wait(&mut self, board: &mut Logger<'_, '_>, ticks: u32) {
        (0..ticks).for_each(|_| board.tick());
        for line in lines(&board.said()) {
            self.is_testing |= line == Line::Info("the test goes on: stop ends it");
            self.is_testing &= !matches!(line, Line::End { .. });
        }
        self.is_testing |= board.view().report.is_some();
    }

    fn run(&mut self, board: &mut Logger<'_, '_>, before: Option<&Known>) -> Known {
        self.wait(board, FOUND);
        if let Some(before) = before.filter(|_| !self.card.is_dead()) {
            assert_eq!(&known(board), before, "{:?}", self.done);
        }
        for _ in 0..self.dice.below(12) {
            let act = self.act(board);
            let ticks = self.dice.below(60) as u32;
            self.done.push(format!("{}, wait {ticks}", act.trim_end()));
            self.wait(board, ticks);
        }
        self.card.fail_once_after(u32::MAX);
        self.card.revive();
        self.wait(board, COMPLETE);
        let known = known(board);
        assert_eq!(board.view().card, CardState::Ready, "{:?}", self.done);
        assert_eq!(known.2, self.is_testing, "{:?}", self.done);
        self.done.push("power off".to_string());
        known
    }
}

fn known(board: &mut Logger<'_, '_>) -> Known {
    board.type_in(b"status\n");
    let said = board.said();
    let start = |line| {
        if let Line::Start { run, settings } = line { Some((run, settings)) } else { None }
    };
    let (run, settings) = lines(&said).find_map(start).expect("settings");
    (run, settings, board.view().report.is_some())
}

/// No card has a second log, damaged or lost sectors, or a test that had to be taken apart; returns
/// the number of its tests.
fn check(content: Vec<u8>, done: &[String]) -> usize {
    let logs = content.chunks_exact(32).filter(|entry| entry.starts_with(b"FLOE    LOG"));
    assert!(logs.count() <= 1, "{done:?}");
    let Ok((tests, found)) = card::tests(Cursor::new(content)) else { return 0 };
    assert_eq!((found.damaged, found.unsound, found.lost), (0, 0, 0), "{done:?}");
    assert!(tests.iter().all(|test| test.split.is_none()), "{done:?}");
    tests.len()
}

#[test]
fn what_is_in_use_comes_back() {
    let count = number("FLOE_RANDOM_DAYS", 200.0) as u64;
    let (mut compared, mut kept) = (0, 0);
    for seed in 0..count {
        let (mut dice, mut done) = (Dice::new(seed), vec![format!("seed {seed}")]);
        let (card, mut others) = (SimCard::new(formatted()), vec![formatted(), formatted()]);
        let mut before = None;
        for _ in 0..4 {
            if dice.below(4) == 0 {
                card.cut_after(0, Rest::Old);
                done.push("no card at power-up".to_string());
            }
            let log = CardLog::new(card.clone(), LOG_SECTORS).in_steps_of(64);
            before = Some(with_board(log, &stick_slip(3200), |board| {
                let (dice, done, others) = (&mut dice, &mut done, &mut others[..]);
                let mut day = Day { card: &card, others, dice, done, is_testing: false };
                compared += usize::from(before.is_some() && !card.is_dead());
                day.run(board, before.as_ref())
            }));
        }
        let cards = others.into_iter().chain([card.content()]);
        kept += cards.map(|content| check(content, &done)).sum::<usize>();
    }
    println!("{count} days: {compared} times compared after a power cut, {kept} tests on cards");
    assert!(compared as u64 > count && kept as u64 > count, "{compared} {kept} of {count}");
}
