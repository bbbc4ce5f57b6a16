//! Weight of a finding by its significance.

use crate::num::math::smaller;

/// Standard deviations beyond which a finding is significant: a normal variable exceeds them once in
/// 370.
pub(crate) const SIGNIFICANT: f32 = 3.0;
/// Standard deviations beyond which it is sure: one in 16 000.
pub(crate) const SURE: f32 = 4.0;

/// Weight of a finding by its size: 0 up to the limit, rising linearly to 1 at twice that.
#[inline(never)]
pub(crate) fn surely(size: f32, limit: f32) -> f32 {
    if size > limit { smaller(size / limit - 1.0, 1.0) } else { 0.0 }
}
