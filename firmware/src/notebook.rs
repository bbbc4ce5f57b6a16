//! Notes on a test that do not enter the computation.

/// How the block is pulled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// On its ice, level or sloping.
    Sliding,
    /// Up a ramp of ice.
    Rafting,
    /// Over the edge of another ice sheet.
    OverRiding,
}

/// The ice under the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Track {
    /// No block has slid over it.
    Fresh,
    /// A block was pulled over it before.
    Repeated,
}

/// What weighed the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightFrom {
    /// The load cell that pulls the block: errors of its span cancel.
    SameCell,
    /// A separate balance.
    Other,
}

/// State of the winch, as seen by a person next to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winch {
    /// It winds the cable in.
    Moving,
    /// It holds the cable.
    Held,
}

impl Winch {
    /// All values with their words.
    pub const ALL: &'static [(Self, &'static str)] =
        &[(Self::Moving, "moving"), (Self::Held, "held")];
}

impl Kind {
    /// All values with their words, in the order of their numbers on the card.
    pub const ALL: &'static [(Self, &'static str)] = &[
        (Self::Sliding, "sliding"),
        (Self::Rafting, "rafting"),
        (Self::OverRiding, "over-riding"),
    ];
}

impl Track {
    /// All values with their words, in the order of their numbers on the card.
    pub const ALL: &'static [(Self, &'static str)] =
        &[(Self::Fresh, "fresh"), (Self::Repeated, "repeated")];
}

impl WeightFrom {
    /// All values with their words, in the order of their numbers on the card.
    pub const ALL: &'static [(Self, &'static str)] =
        &[(Self::SameCell, "same_cell"), (Self::Other, "other")];
}

/// Word of a value.
#[must_use]
pub fn word<T: PartialEq>(all: &'static [(T, &'static str)], one: &T) -> &'static str {
    all.iter().find(|(other, _)| other == one).map_or("", |(_, word)| word)
}

/// Value of a word.
#[must_use]
pub fn from_word<T: Copy>(all: &[(T, &str)], word: &str) -> Option<T> {
    all.iter().find(|(_, other)| *other == word).map(|&(one, _)| one)
}

/// Notes on one test; `None` where nothing was noted.
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
