//! Formulas of the paper that need no simulation.

use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY_M_PER_S2;

/// Density of sea ice, kg/m³.
pub const ICE_DENSITY_KG_PER_M3: f64 = 910.0;

/// Stress resultant of rafting `sigma = mu rho g h l`, N per metre of the front:
/// the friction under a sheet of thickness `h` that lies with its full weight on
/// another over a length `l` (above the water; under it, buoyancy takes its place).
#[must_use]
pub fn rafting_resultant_n_per_m(mu: f64, thickness_m: f64, overlap_m: f64) -> f64 {
    mu * ICE_DENSITY_KG_PER_M3 * GRAVITY_M_PER_S2 * thickness_m * overlap_m
}

/// Rist (1997): shear force proportional to `N^(2/3)`. The coefficient at
/// `weight_n` when it is `mu` at `reference_n`: `mu (N/N0)^(-1/3)`.
#[must_use]
pub fn rist_coefficient(mu: f64, reference_n: f64, weight_n: f64) -> f64 {
    mu * (weight_n / reference_n).powf(-1.0 / 3.0)
}

/// Smallest block speed in a slip, (31): `w - sqrt((mu_s - mu)² g²/omega² + w²)`,
/// m/s. Never above zero: with constant coefficients the block always sticks.
#[must_use]
pub fn lowest_speed_m_per_s(difference: f64, omega_rad_per_s: f64, winch_m_per_s: f64) -> f64 {
    let drop = difference * GRAVITY_M_PER_S2 / omega_rad_per_s;
    winch_m_per_s - drop.hypot(winch_m_per_s)
}

/// Mean tension over the weight of a block that swings with an amplitude,
/// `1 + A²/4` for small `A`.
#[must_use]
pub fn swinging_mean(amplitude_rad: f64) -> f64 {
    1.0 + 0.25 * amplitude_rad * amplitude_rad
}
