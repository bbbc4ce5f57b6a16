//! Logs that look like another format.

use super::Expected::{Noted, Refused, Same};
use super::{Form, NOON, clock, form, iso, plain, table};

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
            "two channels without a name",
            table("", |t, _| format!("{t},{}\n{t},7", 300.0 + t)),
            Refused(&["the force goes to and fro between as many values: keep the rows of one"]),
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

/// Times and forces that are whole or rounded numbers.
pub fn numbers() -> Vec<Form> {
    let since = |origin_s: f64| {
        table("timestamp,force_n\n", move |t, f| format!("{:.4},{f}", origin_s + t))
    };
    let thousands = |f: f64| match (10.0 * f) as u32 {
        n if n < 1000 => n.to_string(),
        n => format!("{}.{:03}", n / 1000, n % 1000),
    };
    let in_pairs = || table("time_s,force_n\n", |t, f| format!("{},{f}", (8.0 * t).floor() / 8.0));
    let grouped = |t: f64, f: f64| format!("{t};{}", thousands(f - 50.0));
    vec![
        form(
            "thousands in some rows",
            table("time_ms;force_n\n", |t, f| grouped((1e3 * t).floor(), f)),
            Refused(&["among numbers without a mark", "without marks between the thousands"]),
        ),
        form(
            "three decimals beside whole numbers, times with more",
            table("time_s;force_n\n", |t, f| {
                let coarse = (200.0 * f).round() / 200.0;
                let exact = format!("{coarse:.3}");
                format!("{t:.5};{}", exact.strip_suffix(".000").unwrap_or(&exact))
            }),
            Same,
        ),
        form(
            "thousands in late rows",
            table("time_ms;force_n\n", |t, f| {
                let late = if t < 10.0 { 50.0 } else { f };
                grouped((1e3 * t).floor(), late)
            }),
            Refused(&["line 162: '3.135' is", "without marks between the thousands"]),
        ),
        form("seconds since 1904", since(NOON + 2_082_844_800.0), Refused(&["begin in 2078 if"])),
        form(
            "ticks of 100 ns",
            table("Timestamp,force_n\n", |t, f| {
                format!("{},{f}", 638_452_367_100_000_000_u64 + (t * 1e7) as u64)
            }),
            Refused(&["begin in 1990 if they count from 1970: give --time-unit"]),
        ),
        form(
            "a time that numbers the rows",
            table("Time,force_n\n", |t, f| format!("{},{f}", 16.0 * t)),
            Refused(&["of column 'Time' go up by 1 from row to row and have no unit"]),
        ),
        form(
            "hours and minutes of ten seconds",
            table("time,force_n\n", |t, f| format!("12:{:02},{f}", (t / 60.0 + 0.9) as u32)),
            Refused(&["do not tell the rate: give --rate-hz"]),
        ),
        form(
            "whole seconds without a unit",
            table("time,force_n\n", |t, f| format!("{},{f}", t.floor())),
            Noted("column 'time' have no unit: taken as s"),
        ),
        form(
            "minutes of three decimals",
            table("Time (min),force_n\n", |t, f| format!("{:.3},{f}", t / 60.0)),
            Noted(""),
        ),
        form(
            "a counter that begins anew",
            table("time_ms,force_n\n", |t, f| {
                format!("{},{f}", (60_000 + (1e3 * t) as u32) % 65_536)
            }),
            Refused(&["line 91: time goes back by 65.", "begins anew there; let the times run on"]),
        ),
        form(
            "a time far ahead in one line",
            plain().replacen("\n5,", "\n1000000,", 1),
            Refused(&[
                "line 83: time goes back",
                "would not without line 82",
                "take that line out",
            ]),
        ),
        form(
            "two rows a stamp, # rate_hz: 12",
            format!("# rate_hz: 12\n{}", in_pairs()),
            Refused(&["line 1: '# rate_hz: 12', and the times", "16.000 times a second"]),
        ),
        form("two rows a stamp, --rate-hz 12", in_pairs(), Refused(&["would be lost"]))
            .with(|o| o.rate_hz = Some(12.0)),
        form("two rows a stamp, --rate-hz 20", in_pairs(), Noted("is --rate-hz right?"))
            .with(|o| o.rate_hz = Some(20.0)),
        form(
            "a force that is held",
            table("time_s,force_n\n", |t, _| format!("{t},{}", (4.0 * t).floor())),
            Noted("over 4 samples each time"),
        ),
    ]
}

/// Scale factors, times of day without colons, text after the last row.
pub fn ends() -> Vec<Form> {
    let times = |name: &str, minute: u32, from_s: f64| {
        table(&format!("{name},force_n\n"), move |t, f| {
            let t = t + from_s;
            let minutes = (t / 60.0).floor();
            let hhmm =
                1200 + minute + minutes as u32 + if minute > 58 && minutes > 0.0 { 40 } else { 0 };
            format!("{:.4},{f}", f64::from(hhmm) * 100.0 + t - 60.0 * minutes)
        })
    };
    let behind = |line: &str| plain() + line;
    vec![
        form(
            "125959.9, the hour behind it",
            times("time", 59, 55.0),
            Refused(&["line 82: time goes from 125959.938 on to 130000.000", "--time-unit s"]),
        ),
        form(
            "121059.9, the minute behind it",
            times("time", 10, 55.0),
            Refused(&["line 82", "as a time of day without colons does: write 12:59:59.9"]),
        ),
        form("such steps in seconds, said", times("time_s", 10, 55.0), Noted("")),
        form(
            "Force x 10 N",
            table("time_s,Force x 10 N\n", |t, f| format!("{t},{}", f / 10.0)),
            Refused(&["'Force x 10 N' holds a factor: write the forces themselves"]),
        ),
        form(
            "Load cell 5 kN",
            table("time_s,Load cell 5 kN\n", |t, f| format!("{t},{f}")),
            Refused(&["give --column NAME; there are: time_s, Load cell 5 kN"]),
        ),
        form(
            "Load cell 5 kN, --column",
            table("time_s,Load cell 5 kN\n", |t, f| format!("{t},{f}")),
            Refused(&["'Load cell 5 kN' holds 'kN': give the unit, --unit"]),
        )
        .with(|o| o.column = Some("2".to_string())),
        form(
            "two channels of numbers without a time",
            table("Sample,Force (N),Temp (C)\n", |t, f| format!("{},{f},-12.1", 16.0 * t)),
            Refused(&["t or time): give --rate-hz R for rows without a time; there are"]),
        ),
        form(
            "LabVIEW, a second header",
            behind("\nChannels,2\nSamples,200\n"),
            Refused(&["line 203", "'Channels'; if a footer or another log begins there, cut"]),
        ),
        form("a footer", behind("Mean:,312.5\n"), Refused(&["line 202", "if a footer"])),
        form(
            "a footer, forces alone",
            table("force_n\n", |_, f| f.to_string()) + "Mean: 312.5\n",
            Refused(&["line 202: force cell 1 holds 'Mean: 312.5'", "if a footer"]),
        )
        .with(|o| o.rate_hz = Some(16.0)),
        form(
            "every row twice",
            table("time_s,force_n\n", |t, f| format!("{t},{f}\n{t},{f}")),
            Noted(""),
        ),
        form("<NA>", plain().replacen(",100\n", ",<NA>\n", 1), Noted("")),
        form("-9999", plain().replacen(",100\n", ",-9999\n", 1), Noted("")),
    ]
}

/// Metadata in other places than a line `# key: value`.
pub fn metadata() -> Vec<Form> {
    let said = |line: &str| format!("{line}\n{}", plain());
    vec![
        form(
            "a preamble without #",
            said("Kind: tension\nweight_n: 55"),
            Noted("line 2: 'weight_n: 55' is not read: write '# weight_n: 55'"),
        ),
        form("metadata in a skipped line", said("# weight_n: abc"), Same)
            .with(|o| o.skip_lines = 1),
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

/// Rows below the names, line ends, stamps.
pub fn lines() -> Vec<Form> {
    let below = |row: &str| plain().replacen("force_n\n", &format!("force_n\n{row}\n"), 1);
    let stamped =
        |stamp: fn(f64) -> String| table("time,force_n\n", move |t, f| format!("{},{f}", stamp(t)));
    vec![
        form(
            "types below the names",
            below("float,float"),
            Refused(&["line 2: the names are in line 1, and this row below them", "take it out"]),
        ),
        form("daN below the names", below("s,daN"), Refused(&["is in N and in daN"])),
        form(
            "CR line ends, the last LF",
            plain().trim_end().replace('\n', "\r") + "\n",
            Refused(&["line 1: some lines end with CR and some with LF"]),
        ),
        form(
            "12:00:00:0625",
            stamped(|t| clock(t).replace('.', ":")),
            Refused(&["behind a point"]),
        ),
        form(
            "30:00:00",
            stamped(|t| clock(t).replace("12:", "30:")),
            Refused(&["24:00:00; write"]),
        ),
        form(
            "24:30:00",
            stamped(|t| clock(t).replace("12:00", "24:30")),
            Refused(&["24:00:00; write"]),
        ),
        form("29-OCT-2012", stamped(|t| format!("29-OCT-2012 {}", clock(t))), Same),
        form(
            "#N/A, forces alone",
            table("force_n\n", |_, f| f.to_string()).replacen("\n108.5\n", "\n#N/A\n", 1),
            Noted(""),
        )
        .with(|o| o.rate_hz = Some(16.0)),
        form(
            "NA in the first row, forces alone",
            table("force_n\n", |_, f| f.to_string()).replacen("\n100\n", "\nNA\n", 1),
            Noted(""),
        )
        .with(|o| o.rate_hz = Some(16.0)),
        form(
            "#N/A in the first rows, no header",
            table("#N/A\n#N/A\n", |_, f| f.to_string()),
            Noted("no header: column 1 is the force"),
        )
        .with(|o| o.rate_hz = Some(16.0)),
        form("12:00:00 CET", stamped(|t| clock(t) + " CET"), Refused(&["its zone as an offset"])),
        form("12:00:00 p.m.", stamped(|t| clock(t) + " p.m."), Refused(&["AM or PM without"])),
    ]
}
