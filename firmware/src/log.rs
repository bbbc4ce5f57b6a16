//! Logging macros: defmt with that feature, otherwise no code.

macro_rules! debug {
    ($($argument:tt)*) => { crate::log::relay!(debug, $($argument)*) };
}
macro_rules! info {
    ($($argument:tt)*) => { crate::log::relay!(info, $($argument)*) };
}
macro_rules! warn_ {
    ($($argument:tt)*) => { crate::log::relay!(warn, $($argument)*) };
}
macro_rules! relay {
    ($level:ident, $format:literal $(, $argument:expr)*) => {{
        #[cfg(feature = "defmt")]
        defmt::$level!($format $(, $argument)*);
        #[cfg(not(feature = "defmt"))]
        { $(let _ = &$argument;)* }
    }};
}
pub(crate) use {debug, info, relay, warn_ as warn};
