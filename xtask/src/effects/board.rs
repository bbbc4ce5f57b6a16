//! Costs of each effect: the core on the emulated board with and without it.

use std::fs;

use floe_core::Effect;

use crate::arm::Route;
use crate::budgets::{self, Counted, Record};
use crate::shell::root;
use crate::size::Image;
use crate::{Result, qemu};

/// The scene in which every effect is counted.
const REFERENCE: &str = "dff8-13";

/// A scene with the phenomenon that an effect models.
fn own(effect: Effect) -> &'static str {
    match effect {
        Effect::Corner => "hard/creep",
        Effect::Sag => "hard/sag_flop",
        Effect::Stiffening => "hard/shortening",
        Effect::Mass | Effect::Level => "hard/breaking",
        Effect::Drift => "hard/drift",
        Effect::Flop => "hard/flop",
        Effect::Ripple => "hard/ripple",
        Effect::Damping => "honesty/damping_2",
        Effect::Onset => "honesty/falling",
        Effect::Scatter => "honesty/jitter_10",
    }
}

/// Source files that belong to one effect only.
fn files(effect: Effect) -> &'static [&'static str] {
    match effect {
        Effect::Corner => &["effects/corner/mod.rs", "effects/corner/score.rs", "model/corner.rs"],
        Effect::Sag => &["effects/sag.rs", "model/elongation.rs"],
        Effect::Stiffening => &["effects/stiffening.rs"],
        Effect::Mass => &[
            "effects/mass_change/mod.rs",
            "effects/mass_change/swings.rs",
            "effects/mass_change/trial.rs",
        ],
        Effect::Level => &["effects/level_shift.rs"],
        Effect::Drift => &["effects/zero_drift.rs"],
        Effect::Flop => &["noise/flop.rs"],
        Effect::Ripple => &[
            "noise/ripple/mod.rs",
            "noise/ripple/colored.rs",
            "noise/ripple/sums.rs",
            "effects/oscillation.rs",
        ],
        Effect::Damping => &["effects/damping.rs"],
        Effect::Onset => &["effects/onset.rs"],
        Effect::Scatter => &["effects/scatter.rs", "fit/slip_residuals.rs"],
    }
}

/// Size and instruction counts of the core on the board, with a set of effects.
pub(super) struct Board {
    /// Flash of the image that runs the core, and of the core's symbols, bytes.
    pub(super) flash: u64,
    pub(super) core: u64,
    /// Counts in [`REFERENCE`], then in the own scenes of effects, if counted.
    pub(super) counted: Vec<Counted>,
}

impl Board {
    fn with(route: Route, effects: &[Effect], records: &[Record]) -> Result<Self> {
        let features = effects.iter().map(|effect| format!(",floe-core/{effect}"));
        let features = "mps2-an386".to_owned() + &features.collect::<String>();
        let program = route.build_with("mps2-budget", &features, &["--no-default-features"])?;
        let Image { flash, crates, .. } = Image::read(&program)?;
        let core = crates.get("floe_core").copied().unwrap_or(0);
        let qemu = qemu::find()?;
        let counted = records.iter().map(|record| budgets::count(qemu, &program, record));
        Ok(Self { flash, core, counted: counted.collect::<Result<_>>()? })
    }
}

/// Costs of one effect.
pub(super) struct Cost {
    pub(super) effect: Effect,
    pub(super) lines: usize,
    /// Added mean instructions per step, in the reference and in the effect's own scene.
    pub(super) mean: i64,
    pub(super) own_mean: i64,
    /// Name of the effect's own scene.
    pub(super) own: &'static str,
    pub(super) flash: i64,
    pub(super) state: i64,
}

/// Results of all builds.
pub(super) struct Costs {
    pub(super) all: Board,
    pub(super) none: Board,
    pub(super) each: Vec<Cost>,
}

/// Builds the core with all effects, with none and without each one, and counts instructions.
///
/// # Errors
/// A build or a run fails.
pub(super) fn costs(route: Route) -> Result<Costs> {
    let scene =
        |name: &str| budgets::scene_record(&root().join(format!("host-sim/scenes/{name}.toml")));
    let mut records = vec![scene(REFERENCE)?];
    for effect in Effect::ALL {
        records.push(scene(own(effect))?);
    }
    let all = Board::with(route, &Effect::ALL, &records)?;
    let none = Board::with(route, &[], &records[..1])?;
    let mut each = Vec::new();
    for (place, effect) in Effect::ALL.into_iter().enumerate() {
        let others: Vec<Effect> = Effect::ALL.into_iter().filter(|it| *it != effect).collect();
        let asked = [scene(REFERENCE)?, scene(own(effect))?];
        let without = Board::with(route, &others, &asked)?;
        let [reference, its_own] = without.counted.as_slice() else { continue };
        let more =
            |with: &Counted, without: &Counted| with.cost.mean as i64 - without.cost.mean as i64;
        let (with_reference, with_own) = (&all.counted[0], &all.counted[place + 1]);
        each.push(Cost {
            effect,
            lines: lines(files(effect))?,
            mean: more(with_reference, reference),
            own_mean: more(with_own, its_own),
            own: own(effect).rsplit('/').next().unwrap_or_default(),
            flash: all.flash as i64 - without.flash as i64,
            state: with_reference.state_bytes as i64 - reference.state_bytes as i64,
        });
    }
    Ok(Costs { all, none, each })
}

/// Number of source lines that are not empty, comment or test.
fn lines(files: &[&str]) -> Result<usize> {
    let mut count = 0;
    for file in files {
        let place = root().join("core/src").join(file);
        let text = fs::read_to_string(&place).map_err(|e| format!("{}: {e}", place.display()))?;
        let product = text.split("#[cfg(test)]").next().unwrap_or_default();
        let counts = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
        count += product.lines().filter(counts).count();
    }
    Ok(count)
}
