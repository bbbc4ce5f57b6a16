//! Random cases: well-formed input with a few errors.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

/// Words that parsers tend to stumble on.
pub const WORDS: &[&[u8]] = &[
    b"1e308",
    b"-1e308",
    b"1e-320",
    b"NaN",
    b"inf",
    b"-6999",
    b"-99999",
    b"\"",
    b"\"\"",
    b",",
    b",,",
    b"\n",
    b"\r",
    b"\r\n",
    b"\0",
    b"#",
    b"# weight_n: 1e300\n",
    b"# rate_hz: 2000\n",
    b"\xFF\xFE",
    b"\xEF\xBB\xBF",
    b"2000-02-30 25:61:61",
    b"\"1994-04-09 23:59:59.9375\"",
    b"366",
    b"2400",
    b"-",
    b".",
    b"e",
    b"99999999999999999999999999999999",
    b"0.0000000000000000000000000000001",
    b"\x1b[2J",
    b" ",
    b"\t",
    b";",
    b"[[",
    b"]",
    b"= ",
    b"true",
    b"1979-05-27T07:32:00Z",
    b"'''",
    b"*FFFF",
];

/// A small generator with equal numbers on every machine (splitmix64).
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    /// A generator whose numbers depend on the seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below a limit; 0 for a limit of 0.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.bits() % limit.max(1) as u64) as usize
    }

    /// One of several.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    /// `count` random bytes.
    pub fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.bits() as u8).collect()
    }

    /// Makes one to eight changes; some insert one of `words`.
    pub fn damage(&mut self, text: &mut Vec<u8>, words: &[&[u8]]) {
        for _ in 0..=self.below(8) {
            let at = self.below(text.len() + 1);
            let end = (at + self.below(20)).min(text.len());
            match self.below(7) {
                0 if at < text.len() => text[at] ^= 1 << self.below(8),
                1 if at < text.len() => text[at] = self.bits() as u8,
                2 => drop(text.drain(at..end)),
                3 => {
                    let again = text[at..end].to_vec();
                    text.splice(at..at, again);
                }
                4 => text.truncate(at),
                _ => {
                    let word: Vec<u8> = self.pick(words).to_vec();
                    text.splice(at..end, word);
                }
            }
        }
    }
}

/// Longest time of a case before it counts as hung.
const LONGEST: Duration = Duration::from_secs(20);

/// Runs cases for `FLOE_FUZZ_S` seconds (default 2), and prints their number. A case depends only
/// on its number, so that it can be repeated.
///
/// # Panics
/// A case panicked or took too long; its number is printed.
pub fn run(name: &str, mut case: impl FnMut(&mut Dice)) {
    let seconds = crate::number("FLOE_FUZZ_S", 2.0);
    let first = std::env::var("FLOE_FUZZ_CASE").ok().map(|s| s.parse().expect("a case's number"));
    let limit = Duration::from_secs_f64(if first.is_some() { 0.0 } else { seconds });
    let (start, mut number) = (Instant::now(), first.unwrap_or(0_u64));
    loop {
        let began = Instant::now();
        let mut dice = Dice::new(number.wrapping_mul(0xD134_2543_DE82_EF95));
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| case(&mut dice))) {
            eprintln!("{name}: case {number}: FLOE_FUZZ_CASE={number} runs it alone");
            resume_unwind(panic);
        }
        assert!(began.elapsed() < LONGEST, "{name}: case {number} took {:?}", began.elapsed());
        number += 1;
        if start.elapsed() >= limit {
            break;
        }
    }
    println!("{name}: {number} cases in {:.1} s", start.elapsed().as_secs_f64());
}
