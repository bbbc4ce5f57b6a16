//! What looks like another log than it is.

use super::Expected::{Noted, Refused, Same};
use super::{Form, form, iso, plain, table};

/// Channels, names and units.
pub fn columns() -> Vec<Form> {
    let named = |names: &str| plain().replace("time_s,force_n", names);
    let in_kgf = |names: &str| table(names, |t, f| format!("{t};{}", f / 9.80665));
    vec![
        form(
            "two channels below each other",
            table("time_s,channel,force_n\n", |t, f| format!("{t},A,{f}\n{t},B,7")),
            Refused(&["each time stands 2 times, and column 'channel' differs", "of one channel"]),
        ),
        form(
            "a temperature T beside dates",
            table("Stamp,T,force_n\n", |t, f| format!("{},{},{f}", iso(t), -2.0 + 0.01 * t)),
            Same,
        ),
        form(
            "T [°C] before the time",
            table("T [°C];Time [s];Force [N]\n", |t, f| format!("-2;{t};{f}")),
            Same,
        ),
        form(
            "Load_kgf_Avg",
            named("time_s,Load_kgf_Avg"),
            Refused(&["'Load_kgf_Avg' holds 'kgf': give the unit, --unit N"]),
        )
        .with(|options| options.column = Some("2".to_string())),
        form("Время, с; Сила, кгс", in_kgf("Время, с;Сила, кгс\n"), Same),
        form("units row above the names", in_kgf("s;kgf\ntime;force\n"), Same),
    ]
}

/// Metadata that is not in a line `# key: value` of its own.
pub fn metadata() -> Vec<Form> {
    let said = |line: &str| format!("{line}\n{}", plain());
    vec![
        form("a comment in quotes", said("\"# slope_deg: 5\","), Same),
        form("a comment with empty cells behind", said("# weight_n: 630,,"), Same),
        form("key and value in two cells", said("# slope_deg:,5"), Refused(&["has ',5': write"])),
        form(
            "a weight with a thousand",
            said("# weight_n: 1,890"),
            Refused(&["has '1,890': write"]),
        ),
        form("slope_deg,", said("# slope_deg,5"), Noted("'slope_deg,5' is not read")),
        form(
            "winch_m_per_s =",
            said("# winch_m_per_s=0.05"),
            Noted("write '# winch_m_per_s: 0.05'"),
        ),
    ]
}
