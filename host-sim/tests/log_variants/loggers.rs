//! Formats of the software of loggers, testing machines and statistics.

use floe::log::stamp::TimeUnit;

use super::Expected::{Noted, Refused, Same};
use super::{Form, clock, form, plain, table, toa5};

fn in_kn(header: &str) -> String {
    table(header, |t, f| format!("{t},{}", f / 1000.0))
}

fn in_blanks(header: &str) -> String {
    table(header, |t, f| format!("{t:9.4} {:10.6}", f / 1000.0))
}

/// Lines above the rows.
pub fn above() -> Vec<Form> {
    let long: String = (0..400).map(|i| format!("Channel {i}: idle\n")).collect();
    vec![
        form(
            "Y_Unit_Label in the preamble",
            table("Samples\t200\t\nY_Unit_Label\tkN\t\nX_Value\tForce\tComment\n", |t, f| {
                format!("{t}\t{}", f / 1000.0)
            }),
            Refused(&["column 'Force' has no unit, and line 2 holds 'kN': give the unit, --unit"]),
        ),
        form(
            "Force in kN as a title",
            in_kn("Force in kN\ntime,force\n"),
            Refused(&["and line 1 holds 'kN'"]),
        ),
        form(
            "names between semicolons, rows between commas",
            in_kn("time_s;force_kn\n"),
            Refused(&["line 2: the force has no unit, and line 1 holds 'kn'"]),
        ),
        form(
            "Load cell: 5 kN in the preamble",
            format!("Load cell: 5 kN\n{}", plain().replace("_n", "")),
            Noted("column 'force' has no unit: taken as N"),
        ),
        form(
            "a first row with one cell more",
            in_kn("time_s,force_kn\n").replacen(",0.1\n", ",0.1,start\n", 1),
            Refused(&["line 2: the names are in line 1", "not understood: correct it"]),
        ),
        form(
            "a title below the names",
            in_kn("time_s,force_kn\nrun 3\n"),
            Refused(&["line 2: the names are in line 1", "take it out"]),
        ),
        form(
            "a section below the names",
            in_blanks("time_s force_kn\n[data]\n"),
            Refused(&["line 2: the names are in line 1", "take it out"]),
        ),
        form("a ruler of bars below the names", bars("time_s|force_kn\n------+--------\n"), Same),
        form(
            "bars on both sides",
            table("| time_s | force_n |\n|---|---|\n", |t, f| format!("| {t} | {f} |")),
            Same,
        ),
        form("400 lines of preamble", long + &plain(), Same),
        form(
            "another table above",
            format!("load,mV\n0,0.01\n100,1.01\n200,2.01\n300,3.01\n{}", plain()),
            Refused(&["line 6: time and force are named here", "give --skip-lines 5, else take"]),
        ),
    ]
}

fn bars(header: &str) -> String {
    table(header, |t, f| format!("{t:7.4} | {:9.6}", f / 1000.0))
}

/// Column names, and cells without a name.
pub fn names() -> Vec<Form> {
    let named = |names: &str| plain().replace("time_s,force_n", names);
    vec![
        form("Time (s)  Force (kN) between blanks", in_blanks("Time (s)  Force (kN)\n"), Same),
        form(
            "a name too many",
            in_kn("time_s,force_raw_kn,force_n\n"),
            Refused(&["line 1: the header has 3 cells, and line 2 has 2"]),
        ),
        form(
            "R, rows with a number",
            table("\"time_s\" \"force_n\"\n", |t, f| format!("\"{}\" {t} {f}", 16.0 * t + 1.0)),
            Same,
        ),
        form("Force (N) Run #1", named("Time (s) Run #1,Force (N) Run #1"), Noted("is read")),
        form(
            "Force, N (LGR S/N: 1234)",
            table("Date Time,\"Force, N (LGR S/N: 1234)\"\n", |t, f| {
                format!("2012-02-29 {},{f}", clock(t))
            }),
            Noted("'Force, N (LGR S/N: 1234)' is the only column of force"),
        ),
        form(
            "Tempo; Forza (pounds)",
            {
                table("Tempo;Forza (pounds)\n", |t, f| {
                    format!("{t};{:.6}", f / 4.448_221_615_260_5)
                })
            },
            Same,
        ),
    ]
}

/// Choice of the force column.
pub fn forces() -> Vec<Form> {
    vec![
        form(
            "one unit behind three readings",
            table("Time (s),Tracking,Peak,Valley,Units\n", |t, f| format!("{t},{f},525,100,N")),
            Refused(&["which column is the force? give --column NAME; there are: Time (s), Tr"]),
        ),
        form(
            "a load beside the friction",
            table("Time (s),Load (N),Friction (N)\n", |t, f| format!("{t},{f},630")),
            Noted("'Load (N)' is read, not 'Friction (N)'"),
        ),
        form(
            "a mass beside a cell without a unit",
            table("Time (s),Mass (kg),Cell\n", |t, f| format!("{t},{},0.5", f / 9.80665)),
            Noted("'Mass (kg)' is the only column of force, and is read: --column takes another"),
        ),
        form(
            "two channels in turn",
            table("time_s,channel,force_n\n", |t, f| format!("{t},A,{f}\n{},B,7", t + 0.03)),
            Refused(&["column 'channel' goes round through 2 words", "keep the rows of one"]),
        ),
        form(
            "a light that goes on and off",
            table("time_s,force_n,led\n", |t, f| {
                format!("{t},{f},{}", if (16.0 * t) % 2.0 < 1.0 { "on" } else { "off" })
            }),
            Same,
        ),
        form(
            "channels in rows",
            {
                let cells = |cell: fn(u32) -> f64| {
                    (0..60).map(|i| cell(i).to_string()).collect::<Vec<String>>().join(",")
                };
                format!("{}\n{}\n", cells(super::seconds), cells(super::force_n))
            },
            Refused(&["line 1: 2 rows of 60 cells: write one row for each sample"]),
        ),
        form(
            "decimal commas between commas, forces alone",
            table("force_n\n", |_, f| format!("{f:.2}").replace('.', ",")),
            Refused(&["goes up and down as no time does", "give --delimiter ';'"]),
        ),
        form(
            "two sensors below each other",
            table("time_s,force_n,temp_c\n", |t, f| format!("{t},{f},\n{},,-12.1", t + 0.03)),
            Refused(&["column 'temp_c' holds numbers where, and only where, 'force_n' holds none"]),
        ),
        form(
            "units of 10 N below the names",
            table("Time,Force\ns,10 N\n", |t, f| format!("{t},{}", f / 10.0)),
            Refused(&["the name of column '10 N' holds a factor"]),
        ),
        form(
            "a column of units with a name of its own",
            table("Zeit [s];Kraft;Einh.\n", |t, f| format!("{t};{};kN", f / 1000.0)),
            Same,
        ),
    ]
}

/// Choice of the time column, and its unit.
pub fn times() -> Vec<Form> {
    let since = |name: &str, per_s: f64, from: f64| {
        table(&format!("{name},force_n\n"), move |t, f| format!("{:.10},{f}", from + t * per_s))
    };
    vec![
        form("minutes, unsaid", since("time", 1.0 / 60.0, 0.0), Noted("have no unit: taken as s")),
        form(
            "modified Julian days",
            since("time", 1.0 / 86_400.0, 55_986.4),
            Refused(&["begin in 2053 if they are a spreadsheet's days: give --time-unit excel if"]),
        ),
        form(
            "secs, nsecs",
            table("secs,nsecs,force_n\n", |t, f| {
                format!("{},{},{f}", super::NOON + t.floor(), t.fract() * 1e9)
            }),
            Noted("column 'nsecs' is read as the ns within the seconds of column 'secs'"),
        ),
        form(
            "a date in seconds, ms",
            table("Time;ms;Force (N)\n", |t, f| {
                format!("2012-02-29 12:00:{:02};{:.0};{f}", t.floor(), (t.fract() * 1e3).floor())
            }),
            Noted("is read as the ms within the seconds"),
        ),
        form("MATLAB's datenum", since("time", 1.0 / 86_400.0, 734_928.5), Same),
        form("MATLAB's datenum, said", since("when", 1.0 / 86_400.0, 734_928.5), Same).with(|o| {
            (o.time_column, o.time_unit) = (Some("when".to_string()), Some(TimeUnit::Excel));
        }),
        form(
            "LabVIEW without times",
            table("X_Value\tForce (N)\tComment\n", |_, f| format!("\t{f}")),
            Refused(&["line 1: no time column", "--rate-hz R for rows without a time"]),
        ),
        form(
            "LabVIEW without times, --rate-hz",
            table("X_Value\tForce (N)\tComment\n", |_, f| format!("\t{f}")),
            Same,
        )
        .with(|o| o.rate_hz = Some(16.0)),
        form(
            "year, doy, hhmm, sec",
            table("year,doy,hhmm,sec,force_n\n", |t, f| format!("2012,60,1200,{t},{f}")),
            Refused(&["line 1: the time is spread over the columns year, doy, hhmm, sec"]),
        ),
        form(
            "milliseconds without their zeros",
            table("time,force_n\n", |t, f| {
                format!("{}.{},{f}", t.floor(), (1000.0 * t.fract()).floor())
            }),
            Refused(&["go back unless 0.62 is 0.062: write zeros in front"]),
        ),
        form(
            "2/29/2012 AM between tabs",
            table("time\tforce_n\n", |t, f| format!("2/29/2012 {} AM\t{f}", clock(t))),
            Refused(&[
                "line 2: no time can be read from '2/29/2012 12:00:00.0000 AM'; write 2012-02",
            ]),
        ),
    ]
}

/// Time stamps that cannot be read.
pub fn stamps() -> Vec<Form> {
    let since = |name: &str, per_s: f64, from: f64| {
        table(&format!("{name},force_n\n"), move |t, f| format!("{:.10},{f}", from + t * per_s))
    };
    let stamped = |stamp: fn(f64) -> String| {
        table("time\tforce_n\n", move |t, f| format!("{}\t{f}", stamp(t)))
    };
    vec![
        form("12:00:00 GMT", stamped(|t| format!("2012-02-29 {} GMT", clock(t))), Same),
        form(
            "12:00:00 UTC+1",
            stamped(|t| format!("2012-02-29 {} UTC+1", clock(t))),
            Refused(&["write its zone as an offset, such as +01:00"]),
        ),
        form(
            "AM 12:00:00",
            stamped(|t| format!("AM {}", clock(t))),
            Refused(&["write a time of day as 12:00:00.5, AM or PM may stand behind it"]),
        ),
        form(
            "0 days 00:00:00",
            stamped(|t| format!("0 days {}", clock(t))),
            Refused(&["write a time that runs on in seconds"]),
        ),
        form(
            "0 sec",
            stamped(|t| format!("{t} sec")),
            Refused(&["'0 sec'; write the number alone, and its unit into the name of the column"]),
        ),
        form(
            "12.00.00.0625",
            stamped(|t| clock(t).replace(':', ".")),
            Refused(&["'12.00.00.0000'; write 2012-02-29 12:00:00"]),
        ),
        form(
            "hours, unsaid",
            since("time", 1.0 / 3600.0, 0.0),
            Refused(&["in min they would be 960.000, in hours 16.000: turn these into seconds"]),
        ),
        form(
            "5000 samples a second",
            table("time_s,force_n\n", |t, f| format!("{},{f}", t * 16.0 / 5000.0)),
            Refused(&["say 5000.000000 samples per second", "in seconds? then thin the log, else"]),
        ),
        form(
            "years, unsaid",
            since("time", 1.0 / 31_622_400.0, 2012.0),
            Refused(&["else give --time-unit, or turn it into seconds"]),
        ),
        form(
            "the second of the minute",
            table("sec,force_n\n", |t, f| format!("{},{f}", (t + 55.0) % 60.0)),
            Refused(&["line 82: time goes back by 59.9", "its counter, or the day, begins anew"]),
        ),
    ]
}

/// Cells of forces, and lines that are no rows.
pub fn cells() -> Vec<Form> {
    vec![
        form("missing", plain().replacen(",100\n", ",missing\n", 1), Noted("")),
        form("-1.#IND00", plain().replacen(",100\n", ",-1.#IND00\n", 1), Noted("")),
        form("#ZAHL!", plain().replacen(",100\n", ",#ZAHL!\n", 1), Noted("")),
        form(
            "(100)",
            plain().replacen(",100\n", ",(100)\n", 1),
            Refused(&["line 2", "'(100)', not a number; write the number alone, such as -12.5"]),
        ),
        form(
            "100.125 # slip",
            plain().replacen(",100\n", ",100.125 # slip\n", 1),
            Refused(&["line 2", "write the number alone"]),
        ),
        form(
            "TOA5 between semicolons",
            toa5("\"TS\",\"kN\"").replace(',', ";"),
            Refused(&["no comma is between its names: save it with commas"]),
        ),
        form(
            "a count of the rows at the end",
            plain() + "(200 rows)\n",
            Refused(&["line 202: 1 cell instead of 2", "if a footer or another log begins there"]),
        ),
    ]
}

/// Lines that are no rows.
pub fn lines() -> Vec<Form> {
    vec![
        form(
            "an arrow between time and force",
            table("Time,Force\n", |t, f| format!("{} -> {f}", clock(t))),
            Refused(&["line 2: 1 cell instead of 2", "is the separator another? (--delimiter)"]),
        ),
        form(
            "$FORCE,0.0625,12.5*5A",
            table("", |t, f| format!("$FORCE,{t},{f}*5A")),
            Refused(&["line 1: no rows of numbers are found from here on: write time and force"]),
        ),
        form(
            "time_s/force_n",
            plain().replace(',', "/"),
            Refused(&["line 1: no rows of numbers are found", "--delimiter"]),
        ),
    ]
}
