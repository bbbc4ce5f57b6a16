//! What belongs to a test and is not computed with: the notebook of the day.

/// How the block is pulled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// On its ice, level or sloping.
    Sliding,
    /// Up a ramp of ice.
    Rafting,
    /// Over the edge of another sheet.
    OverRiding,
}

/// The ice under the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Track {
    /// Nothing has slid here.
    Fresh,
    /// Pulled over before.
    Repeated,
}

/// What weighed the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightFrom {
    /// The load cell that pulls it: its span cancels.
    SameCell,
    /// A balance of its own.
    Other,
}

/// What the winch does, by the eye of somebody beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winch {
    /// It takes the cable up.
    Moving,
    /// It holds it.
    Held,
}

impl Winch {
    /// Both with their words.
    pub const ALL: &'static [(Self, &'static str)] =
        &[(Self::Moving, "moving"), (Self::Held, "held")];
}

impl Kind {
    /// All of them with their words, in the order of their numbers on the card.
    pub const ALL: &'static [(Self, &'static str)] = &[
        (Self::Sliding, "sliding"),
        (Self::Rafting, "rafting"),
        (Self::OverRiding, "over-riding"),
    ];
}

impl Track {
    /// All of them with their words, in the order of their numbers on the card.
    pub const ALL: &'static [(Self, &'static str)] =
        &[(Self::Fresh, "fresh"), (Self::Repeated, "repeated")];
}

impl WeightFrom {
    /// All of them with their words, in the order of their numbers on the card.
    pub const ALL: &'static [(Self, &'static str)] =
        &[(Self::SameCell, "same_cell"), (Self::Other, "other")];
}

/// The word of one of a few.
#[must_use]
pub fn word<T: PartialEq>(all: &'static [(T, &'static str)], one: &T) -> &'static str {
    all.iter().find(|(other, _)| other == one).map_or("", |(_, word)| word)
}

/// What a word stands for.
#[must_use]
pub fn from_word<T: Copy>(all: &[(T, &str)], word: &str) -> Option<T> {
    all.iter().find(|(_, other)| *other == word).map(|&(one, _)| one)
}

/// One page of the notebook; `None` is what nobody wrote down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Notes {
    /// How the block is pulled.
    pub kind: Option<Kind>,
    /// The ice under the block.
    pub track: Option<Track>,
    /// Depth of the snow, mm.
    pub snow_mm: Option<f32>,
    /// Length of the block along the pull, m.
    pub length_m: Option<f32>,
    /// Width of the block, m.
    pub width_m: Option<f32>,
    /// Height of the block, m.
    pub height_m: Option<f32>,
    /// Length of the cable, m.
    pub cable_length_m: Option<f32>,
    /// Stiffness of the cable times its length, N.
    pub cable_ae_n: Option<f32>,
}

impl Notes {
    pub(crate) fn lengths(&self) -> [Option<f32>; 6] {
        let Self { snow_mm, length_m, width_m, height_m, cable_length_m, cable_ae_n, .. } = *self;
        [snow_mm, length_m, width_m, height_m, cable_length_m, cable_ae_n]
    }
}
