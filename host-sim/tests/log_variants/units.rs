//! Units in names, in the rows and above them, and what stands beside time and force.

use super::Expected::{Noted, Refused, Same};
use super::{Form, clock, comma, form, plain, table};

fn named(names: &str) -> String {
    plain().replace("time_s,force_n", names)
}

/// Units of the force.
pub fn forces() -> Vec<Form> {
    let second = |o: &mut floe::log::LogOptions| o.column = Some("2".to_string());
    let in_kn = |names: &str| table(names, |t, f| format!("{t},{}", f * 1e-3));
    let volts = "LabVIEW Measurement\nY_Unit_Label\tVolts\n***End_of_Header***\nX_Value\tForce\n";
    vec![
        form(
            "a column Unit that changes late",
            table("time_s,Load,Unit\n", |t, f| {
                if t < 9.0 { format!("{t},{},kN", f * 1e-3) } else { format!("{t},{f},N") }
            }),
            Refused(&[
                "line 146",
                "cell 3 says 'N', and the rows before kN: write all forces in one unit",
            ]),
        ),
        form(
            "a column Unit that goes over to g",
            table("time_s,Load,Unit\n", |t, f| {
                format!("{t},{f},{}", if t < 9.0 { "kg" } else { "g" })
            }),
            Refused(&["line 146", "cell 3 says 'g', and the rows before kgf"]),
        ),
        form(
            "a column Unit that is empty late",
            table("time_s,Load,Unit\n", |t, f| {
                format!("{t},{f},{}", if t < 9.0 { "N" } else { "" })
            }),
            Same,
        ),
        form(
            "N for north beside a force in kN",
            table("time_s,lat,hemi,force_kn\n", |t, f| format!("{t},78.2,N,{}", f * 1e-3)),
            Same,
        ),
        form("Force_kN_ of MATLAB", in_kn("Time_s_,Force_kN_\n"), Same),
        form("Force..kN. of R", in_kn("Time..s.,Force..kN.\n"), Same),
        form("Time [sec.]; Load [N.]", named("Time [sec.],Load [N.]"), Same),
        form(
            "force_min beside its mean",
            table("time_s,force_mean,force_min\n", |t, f| format!("{t},{f},{}", f - 1.0)),
            Refused(&["no column force_n or force_kn: give --column NAME"]),
        ),
        form(
            "Force (N) kN",
            named("time_s,Force (N) kN"),
            Refused(&["'Force (N) kN' is in N and in kN: correct its name, or give --unit"]),
        ),
        form("force_klbf", named("time_s,force_klbf"), Refused(&["'klbf', which is not read"])),
        form("Load_t", named("time_s,Load_t"), Refused(&["holds 't': give the unit"])).with(second),
        form(
            "Volts in the preamble",
            table(volts, |t, f| format!("{t}\t{f}")),
            Refused(&[
                "line 4: column 'Force' has no unit, and line 2 holds 'Volts': give the unit",
            ]),
        ),
        form(
            "Force in g in the preamble",
            named("Force in g\ntime,force"),
            Refused(&["line 1 holds 'g': give the unit"]),
        ),
        form(
            "mV/V of the cell in the preamble",
            named("Load cell sensitivity (mV/V),2\ntime,force"),
            Noted("has no unit: taken as N"),
        ),
    ]
}

/// Names of times, and cells beside time and force.
pub fn times() -> Vec<Form> {
    let tenths =
        |name: &str| table(&format!("{name},Force (N)\n"), |t, f| format!("{},{f}", t * 10.0));
    let factor = || Refused(&["holds a factor: write the times themselves, or give --time-column"]);
    vec![
        form(
            "spreadsheet's days of six decimals, 10 Hz",
            table("Time,Force (N)\n", |t, f| format!("{:.6},{f}", 40968.5 + t * 1.6 / 86_400.0)),
            Noted(""),
        ),
        form("Time x 0.1 (s)", tenths("Time x 0.1 (s)"), factor()),
        form("10*t [s]", tenths("10*t [s]"), factor()),
        form(
            "Time-min",
            table("Time-min,Force (N)\n", |t, f| format!("{:.9},{f}", t / 60.0)),
            Refused(&["the name of column 'Time-min' holds 'min': give the unit, --time-unit"]),
        )
        .with(|o| o.time_column = Some("1".to_string())),
        form(
            "a remark behind the first row",
            table("Time (min),Force (daN),Note\n", |t, f| {
                format!("{:.9},{f}{}", t / 60.0, if t > 0.0 { "" } else { ",start" })
            }),
            Refused(&[
                "line 2: the names are in line 1, and this row below them is not understood",
            ]),
        ),
        form(
            "numbers of the rows, one lost, --rate-hz",
            table("t,force_n\n", |t, f| format!("{},{f}", 16.0 * t)).replace("\n170,", "\n#170,"),
            Noted("column 't' numbers the rows, and the rate is as given"),
        )
        .with(|o| o.rate_hz = Some(16.0)),
        form(
            "a time of day, an arrow, a force",
            table("", |t, f| format!("{} -> {f}", clock(t))),
            Refused(&["no header line over 3 columns", "--time-column 1 --column 3"]),
        ),
        form(
            "a balance's lines",
            table("", |_, f| format!("S S {f:10.2} kg")),
            Refused(&["line 1: no rows of numbers are found from here on"]),
        )
        .with(|o| o.rate_hz = Some(16.0)),
        form(
            "words behind dates",
            table("Time,State,Force (N)\n", |t, f| format!("2012-02-29 {},ok,{f}", clock(t))),
            Same,
        ),
        form(
            "words behind dates, decimal commas",
            table("Zeit;Status;Kraft (N)\n", |t, f| {
                format!("2012-02-29 {};ok;{}", clock(t), comma(f))
            }),
            Same,
        ),
    ]
}
