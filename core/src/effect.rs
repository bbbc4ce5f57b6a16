//! The effects that a test may look for: what makes an event depart from the plain model of stick
//! line, ellipse, stick line.
//!
//! An effect is in the image if its cargo feature, of the same name, is on; it is in a test if it
//! is enabled in [`crate::Config`]. An enabled effect changes a number only if the data show it.
//! Sharing between events, the first answer and slack are no effects: the model has them always.

use core::fmt;

/// One effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[repr(u8)]
pub enum Effect {
    /// Creep before the onset, and a converter that averages over part of a period, round off the
    /// corners between stick line and slip.
    Corner,
    /// A sagging cable is softer at small forces. It is looked for only where `ripple` is compiled
    /// in, whose statistics tell that all rests bend the same way.
    Sag,
    /// A cable that gets shorter gets stiffer while the block slides.
    Stiffening,
    /// The block breaks: another mass.
    Mass,
    /// Friction goes to another level.
    Level,
    /// The zero of the cell drifts.
    Drift,
    /// The cable flops after a re-stick: the first samples of a rest scatter more.
    Flop,
    /// The force strays from its stick lines in a way that is not white noise.
    Ripple,
    /// Losses in the cable or the air: they widen the intervals and shift no value. Bit 8 belonged
    /// to an effect that was taken out; it stays free, so that the masks in old logs keep their
    /// meaning.
    Damping = 9,
    /// Slips whose force departs from the ellipse along the way: they widen the intervals and shift
    /// no value.
    Onset,
    /// The samples of a slip scatter more than those of its lines: jitter, a rocking block, a
    /// cogging winch, friction that varies along the way. It widens the intervals.
    Scatter,
}

impl Effect {
    /// All of them, in the order of their bits.
    pub const ALL: [Self; 11] = [
        Self::Corner,
        Self::Sag,
        Self::Stiffening,
        Self::Mass,
        Self::Level,
        Self::Drift,
        Self::Flop,
        Self::Ripple,
        Self::Damping,
        Self::Onset,
        Self::Scatter,
    ];

    /// Its name in `--effects`, JSON and `docs/effects.md`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corner => "corner",
            Self::Sag => "sag",
            Self::Stiffening => "stiffening",
            Self::Mass => "mass",
            Self::Level => "level",
            Self::Drift => "drift",
            Self::Flop => "flop",
            Self::Ripple => "ripple",
            Self::Damping => "damping",
            Self::Onset => "onset",
            Self::Scatter => "scatter",
        }
    }

    /// The effect with a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|effect| effect.name() == name)
    }

    /// Length of the array in its [`Kept`]: 1 where it is compiled in, 0 where it is not.
    pub(crate) const fn room(self) -> usize {
        (Effects::COMPILED.0 >> self as u8 & 1) as usize
    }

    const fn bit(self) -> u32 {
        1 << self as u8
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// State that an effect keeps between samples or events. Where the effect is not compiled in there
/// is none, in no bytes. `ROOM` is its [`Effect::room`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kept<T, const ROOM: usize>([T; ROOM]);

impl<T, const ROOM: usize> Kept<T, ROOM> {
    /// The state, if the effect is compiled in.
    pub(crate) fn get(&self) -> Option<&T> {
        self.0.first()
    }

    /// Result of reading the state; the default where there is none.
    pub(crate) fn read<R: Default>(&self, function: impl FnOnce(&T) -> R) -> R {
        self.get().map_or_else(R::default, function)
    }

    /// The state itself; the default where there is none.
    pub(crate) fn value(&self) -> T
    where
        T: Copy + Default,
    {
        self.read(|state| *state)
    }

    /// Result of changing the state; the default where there is none.
    pub(crate) fn update<R: Default>(&mut self, function: impl FnOnce(&mut T) -> R) -> R {
        self.0.first_mut().map_or_else(R::default, function)
    }
}

impl<T: Clone, const ROOM: usize> From<T> for Kept<T, ROOM> {
    fn from(value: T) -> Self {
        Self(core::array::from_fn(|_| value.clone()))
    }
}

impl<T: Default, const ROOM: usize> Default for Kept<T, ROOM> {
    fn default() -> Self {
        Self(core::array::from_fn(|_| T::default()))
    }
}

/// A set of effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Effects(u32);

impl Effects {
    /// Line, ellipse, line: nothing else.
    pub const NONE: Self = Self(0);

    /// The effects that this build has, by its cargo features.
    pub const COMPILED: Self = Self::NONE
        .with(Effect::Corner, cfg!(feature = "corner"))
        .with(Effect::Sag, cfg!(feature = "sag"))
        .with(Effect::Stiffening, cfg!(feature = "stiffening"))
        .with(Effect::Mass, cfg!(feature = "mass"))
        .with(Effect::Level, cfg!(feature = "level"))
        .with(Effect::Drift, cfg!(feature = "drift"))
        .with(Effect::Flop, cfg!(feature = "flop"))
        .with(Effect::Ripple, cfg!(feature = "ripple"))
        .with(Effect::Damping, cfg!(feature = "damping"))
        .with(Effect::Onset, cfg!(feature = "onset"))
        .with(Effect::Scatter, cfg!(feature = "scatter"));

    /// Every effect there is.
    const ALL: Self = {
        let (mut all, mut place) = (Self::NONE, 0);
        while place < Effect::ALL.len() {
            all = all.with(Effect::ALL[place], true);
            place += 1;
        }
        all
    };

    /// From the mask that a log holds: for each effect the bit of its number, see [`Effect`]. Bits
    /// of other versions are dropped.
    #[must_use]
    pub const fn from_mask(bits: u32) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// The mask that a log holds, one bit an effect.
    #[must_use]
    pub const fn mask(self) -> u32 {
        self.0
    }

    /// The set with an effect in it, or without.
    #[must_use]
    pub const fn with(self, effect: Effect, wanted: bool) -> Self {
        let others = self.0 & !effect.bit();
        Self(if wanted { others | effect.bit() } else { others })
    }

    /// Is an effect in the set, and compiled in? Of one that is not compiled in this is known at
    /// compile time, and its code is left out.
    #[must_use]
    #[inline]
    pub const fn has(self, effect: Effect) -> bool {
        effect.room() > 0 && self.0 & effect.bit() != 0
    }

    /// The effects in the set that are compiled in, in the order of [`Effect::ALL`].
    #[inline]
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().filter(move |effect| self.has(*effect))
    }
}

impl Default for Effects {
    /// All that are compiled in: the data decide.
    fn default() -> Self {
        Self::COMPILED
    }
}

/// A parameter of an effect, estimated from the events of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Parameter {
    /// What it is, with its unit.
    pub name: &'static str,
    /// Its value.
    pub value: f32,
    /// One standard deviation.
    pub std: f32,
}

/// The result of a test on one effect.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Finding {
    /// The effect.
    pub effect: Effect,
    /// Whether it was looked for.
    pub enabled: bool,
    /// Whether the data show it.
    pub found: bool,
    /// Its parameters, where it has any.
    pub parameters: [Option<Parameter>; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_keeps_nothing_and_answers_the_default() {
        let (mut some, mut none) = (Kept::<u32, 1>::default(), Kept::<u32, 0>::default());
        let add = |sum: &mut u32| {
            *sum += 7;
            *sum
        };
        assert_eq!((some.update(add), none.update(add)), (7, 0));
        assert_eq!((some.read(|sum| 2 * sum), none.read(|sum| 2 * sum)), (14, 0));
        assert_eq!((some.get(), none.get()), (Some(&7), None));
        assert_eq!((size_of_val(&some), size_of_val(&none)), (4, 0));
    }

    #[test]
    fn names_and_bits_are_those_of_one_effect_each() {
        for effect in Effect::ALL {
            assert_eq!(Effect::named(effect.name()), Some(effect));
            let alone = Effects::NONE.with(effect, true);
            assert_eq!(alone.mask().count_ones(), 1);
            assert_eq!(Effects::from_mask(alone.mask()), alone);
            let others = Effect::ALL.into_iter().filter(|other| *other != effect);
            assert!(others.into_iter().all(|other| !alone.has(other)));
            let compiled = Effects::COMPILED.has(effect);
            assert_eq!(alone.iter().next(), compiled.then_some(effect));
            assert_eq!(alone.iter().count(), usize::from(compiled));
        }
        // The bits of logs that were written before: all but 8 of the first twelve.
        assert_eq!(Effects::from_mask(u32::MAX).mask(), 0b1110_1111_1111);
        assert_eq!(Effects::NONE.with(Effect::Damping, true).mask(), 1 << 9);
        assert_eq!(Effect::named("gravity"), None);
    }
}
