//! Ambiguous logs, and lines that hide a part of the log.

use super::Expected::{Noted, Refused, Same};
use super::{Form, NOON, comma, form, plain, table};

/// Further columns of forces.
pub fn forces() -> Vec<Form> {
    let beside = |other: &str, per_n: f64| {
        table(&format!("time_s,force_n,{other}\n"), move |t, f| format!("{t},{f},{}", f * per_n))
    };
    vec![
        form(
            "force_n beside force_kn",
            beside("force_kn", 1e-3),
            Noted("are the same in the first"),
        ),
        form(
            "force_kn beside force_n, few digits",
            table("time_s,force_kn,force_n\n", |t, f| format!("{t},{:.2},{f}", f * 1e-3)),
            Noted("'force_n' is read"),
        ),
        form(
            "force_n beside force_lbf, rounded",
            beside("force_lbf", 0.225),
            Noted("are the same"),
        ),
        form(
            "force_n against force_kn",
            beside("force_kn", 2e-3),
            Refused(&["say 257.2 N and 514.5 N in row 2", "--column NAME of the one"]),
        ),
        form("force_n against force_kn, --column", beside("force_kn", 2e-3), Same)
            .with(|options| options.column = Some("force_n".to_string())),
        form("force_n beside load_n", beside("load_n", 0.5), Noted("not 'load_n'")),
        form(
            "one name twice",
            table("Force [N];Time [s];Force [N]\n", |t, f| format!("{f};{t};7")),
            Refused(&["give --column 1 or --column 3;"]),
        ),
        form("force_n beside force_raw_n", beside("force_raw_n", 0.5), Noted("not 'force_raw_n'")),
        form(
            "a deviation alone",
            table("time_s,force_std_n\n", |t, f| format!("{t},{f}")),
            Noted("'force_std_n' is the only column of force, and is read"),
        ),
        form(
            "a setpoint alone",
            table("time_s,Force setpoint [N]\n", |t, f| format!("{t},{f}")),
            Noted("is the only column of force"),
        ),
        form(
            "time_s against time_ms",
            table("time_s,time_ms,force_n\n", |t, f| format!("{t},{},{f}", 2e3 * t)),
            Refused(&["'time_s' and 'time_ms' say 0.06250 s and 0.1250 s", "--time-column NAME"]),
        ),
        form(
            "time_s beside time_ms, whole",
            table("time_s,time_ms,force_n\n", |t, f| format!("{t},{:.0},{f}", 7e5 + 1e3 * t)),
            Same,
        ),
        form(
            "two times of one name",
            table("time,time,force_n\n", |t, f| format!("{t},{t},{f}")),
            Refused(&["columns 1 and 2 are both called 'time'", "e.g. --time-column 2"]),
        ),
        form(
            "forces under a name of their own",
            table("F/N\n", |_, f| f.to_string()),
            Refused(&["no time column (time_s, t_s, t or time): give --rate-hz R"]),
        ),
    ]
}

/// Lines that are no rows, or rows of several lines.
pub fn lines() -> Vec<Form> {
    let long = |note: usize| {
        table("time_s,force_n,note\n", |t, f| {
            format!(
                "{t},{f},{}",
                if (t - 5.0).abs() < 0.01 { "x".repeat(note) } else { String::new() }
            )
        })
    };
    let count = |text: &str| text.replacen("\n108.5\n", "\n\n108.5\n", 1);
    let forces = count(&table("force_n\n", |_, f| f.to_string()));
    vec![
        form(
            "an index that begins with #",
            table("#,time_s,force_n\n", |t, f| format!("#{},{t},{f}", 16.0 * t)),
            Refused(&["the rows from line 2 on begin with '#'", "take it away"]),
        ),
        form(
            "such an index, names without #",
            table("index time_s force_n\n", |t, f| format!("#{} {t} {f}", 16.0 * t)),
            Refused(&["the rows from line 2 on begin with '#'"]),
        ),
        form("a name that is #", table("#,time_s,force_n\n", |t, f| format!("7,{t},{f}")), Same),
        form(
            "a line of 70 KB",
            long(70_000),
            Refused(&["line 82: longer than 64 KiB", "shorten it, or take it out"]),
        ),
        form("a line of 60 KB", long(60_000), Same),
        form(
            "a first line of 70 KB",
            format!("# {}\n{}", "x".repeat(70_000), plain()),
            Refused(&["line 1: longer than 64 KiB", "shorten it"]),
        ),
        form(
            "comments of 70 KB",
            format!("{}{}", "# nothing to say\n".repeat(4200), plain()),
            Refused(&["the first 64 KiB hold no table", "shorten what is above it"]),
        ),
        form("empty rows of a spreadsheet", plain() + &",\n".repeat(20), Same),
        form("such rows between", plain().replacen("\n5,", "\n\"\",\n5,", 1), Same),
        form(
            "forces with an empty line",
            forces,
            Noted("1 empty line between rows without a time"),
        )
        .with(|options| options.rate_hz = Some(16.0)),
        form(
            "forces with empty lines at the end",
            table("force_n\n", |_, f| f.to_string()) + "\n\n",
            Same,
        )
        .with(|options| options.rate_hz = Some(16.0)),
        form(
            "exponents with D",
            table("time_s force_n\n", |t, f| format!("{t:.6E} {f:.6E}").replace('E', "D")),
            Same,
        ),
        form(
            "UTF-32",
            plain().chars().flat_map(|letter| u32::from(letter).to_le_bytes()).collect::<Vec<u8>>(),
            Refused(&["UTF-32", "save it as UTF-8"]),
        ),
        form(
            "blanks that do not break",
            table("time_s;force_n\n", |t, f| format!("{t}\u{a0};\u{202f}{}", comma(f))),
            Refused(&["both", "--decimal"]),
        )
        .with(|options| options.decimal = None),
        form(
            "blanks that do not break, one decimal mark",
            table("time_s;force_n\n", |t, f| format!("{t}\u{a0};\u{202f}{f}")),
            Same,
        ),
    ]
}

/// Times and metadata.
pub fn said() -> Vec<Form> {
    let since = |name: &str, per_s: f64| {
        table(&format!("{name},force_n\n"), move |t, f| format!("{:.0},{f}", (NOON + t) * per_s))
    };
    let with = |line: &str| format!("{line}\n{}", plain());
    vec![
        form("timestamp_ms since 1970", since("timestamp_ms", 1e3), Same),
        form("timestamp_ns since 1970", since("timestamp_ns", 1e9), Same),
        form("time_ns", table("time_ns,force_n\n", |t, f| format!("{:.0},{f}", t * 1e9)), Same),
        form("ts in ms since 1970", since("ts", 1e3), Same),
        form(
            "minutes and seconds",
            table("Elapsed,Force (N)\n", |t, f| format!("00:{t:07.4},{f}")),
            Refused(&["line 2", "write hours, minutes and seconds: 00:12:34.5"]),
        ),
        form(
            "MATLAB, names and units apart",
            table("% block 7\n%  time (s)   F (kN)\n", |t, f| format!(" {t:e}  {:e}", f * 1e-3)),
            Same,
        ),
        form("metadata behind %", with("% weight_n: 630"), Same),
        form(
            "weight against mass",
            with("# weight_n: 630\n# mass_kg: 100"),
            Refused(&[
                "line 2: '# weight_n: 630' in line 1",
                "'# mass_kg: 100' in line 2, 980.7 N",
            ]),
        ),
        form("weight beside its mass", with("# weight_n: 630\n# mass_kg: 64.24"), Same),
        form(
            "a mass on the way that is not the weight",
            with("# weight_n: 630").replacen("\n5,", "\n# mass_kg: 50\n5,", 1),
            Refused(&["line 83", "in line 1", "in line 83"]),
        ),
        form("weight_kn", with("# weight_kn: 0.63"), Noted("write '# weight_n: 630'")),
        form("weight_n =", with("# weight_n = 630"), Noted("write '# weight_n: 630'")),
        form(
            "a weight with its unit",
            with("# weight_n: 630 N"),
            Refused(&["line 1: '# weight_n:' has '630 N': write the number alone"]),
        ),
        form(
            "TOA5, two forces",
            "\"TOA5\",\"CR3000\"\n\"TIMESTAMP\",\"force_n\",\"force_kn\"\n\"TS\",\"N\",\"kN\"\n\"\",\"\",\"\"\n\
             \"2012-02-29 12:00:00\",1,2\n",
            Refused(&["force_n and force_kn are both there", "--column NAME"]),
        ),
    ]
}

/// Times that run backwards, and other text formats.
pub fn more() -> Vec<Form> {
    let back = |hour: fn(f64) -> &'static str| {
        table("Time,Force (N)\n", move |t, f| {
            let (minute, second) = if t < 5.0 { (59, 55.0 + t) } else { (0, t - 5.0) };
            format!("2024-10-27 {}:{minute:02}:{second:07.4},{f}", hour(t))
        })
    };
    let noon = |t: f64| if t < 5.0 { "12" } else { "01" };
    let forth = |t: f64| if t < 5.0 { "01" } else { "03" };
    let days = |t: f64| t / 86_400.0 + 0.5;
    vec![
        form("the end of summer time", back(|_| "02"), Refused(&["set back by an hour?", "zone"])),
        form("the beginning of summer time", back(forth), Noted("jumps forward by one hour")),
        form("twelve o'clock, then one", back(noon), Refused(&["are AM and PM missing?"])),
        form(
            "parts of a day",
            table("Time,Force (N)\n", |t, f| format!("{:.12},{f}", days(t))),
            Refused(&["in excel they would be 16.000"]),
        ),
        form(
            "20120229T120000",
            table("Time,Force (N)\n", |t, f| {
                format!("20120229T{}Z,{f}", super::clock(t).replace(':', ""))
            }),
            Refused(&["write 2012-02-29 12:00:00"]),
        ),
        form(
            "names over two lines",
            table("\"Time\n(s)\",\"Force\n(kN)\"\n", |t, f| format!("{t},{f}")),
            Refused(&["line 3", "goes on over several lines"]),
        ),
        form(
            "lines in quotes",
            table("\"time_s,force_n\"\n", |t, f| format!("\"{t},{f}\"")),
            Refused(&["line 1: the whole line is in quotes"]),
        ),
        form("a force beyond all numbers", plain().replacen(",100\n", ",1e39\n", 1), Noted("")),
        form("PDF", b"%PDF-1.4\n1 0 obj\nendobj\n".repeat(20), Refused(&["is a PDF"])),
        form("--skip-lines beyond the end", plain(), Refused(&["after --skip-lines 9999"]))
            .with(|options| options.skip_lines = 9999),
        form("another --delimiter", plain(), Refused(&["is the separator another?"])).with(
            |options| {
                options.delimiter = Some(b';');
                options.rate_hz = Some(16.0);
                options.column = Some("1".to_string());
            },
        ),
    ]
}
