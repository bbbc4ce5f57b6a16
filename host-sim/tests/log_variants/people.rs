//! Formats of people, of spreadsheets and of other makes of data loggers.

use super::Expected::{Noted, Refused, Same};
use super::{Form, SAMPLES, clock, force_n, form, iso, plain, seconds, table};

fn stamped(stamp: fn(f64) -> String) -> String {
    table("Time,Force (N)\n", |t, f| format!("{},{f}", stamp(t)))
}

/// A time of day: `t` seconds after five seconds before midnight.
fn late(t: f64) -> String {
    let t = t - 5.0;
    if t < 0.0 { format!("23:59:{:07.4}", 60.0 + t) } else { format!("00:00:{t:07.4}") }
}

fn summer_time(t: f64) -> String {
    let (hour, zone) = if t < 5.0 { ("12", "+01:00") } else { ("13", "+02:00") };
    format!("2012-02-29T{hour}:00:{t:07.4}{zone}")
}

/// Times of day and dates.
pub fn dates() -> Vec<Form> {
    let newest_first = (0..SAMPLES).rev().map(|i| format!("{},{}\n", seconds(i), force_n(i)));
    vec![
        form("12:00:00.0625 PM", stamped(|t| clock(t) + " PM"), Same),
        form("2012-02-29 12:00:00 pm", stamped(|t| format!("2012-02-29 {} pm", clock(t))), Same),
        form("29-Feb-2012", stamped(|t| format!("29-Feb-2012 {}", clock(t))), Same),
        form(
            "29. Februar 2012",
            stamped(|t| format!("29. Februar 2012 {}", clock(t))),
            Refused(&["line 2", "'29. Februar 2012 12:00:00.0000'; write 2012-02-29 12:00:00 or"]),
        ),
        form(
            "02/29/2012 12:00:00 PM",
            stamped(|t| format!("02/29/2012 {} PM", clock(t))),
            Refused(&["no time can be read from '02/29/2012", "write 2012-02-29"]),
        ),
        form(
            "02/29/2012 12:00:00 PM, forces of three decimals",
            table("Time,Force (N)\n", |t, f| {
                format!("02/29/2012 {} PM,{:.3}", clock(t), f / 100.0)
            }),
            Refused(&["no time can be read from '02/29/2012"]),
        ),
        form(
            "29.02.12",
            stamped(|t| format!("29.02.12 {}", clock(t))),
            Refused(&["no time can be read from '29.02.12", "write 2012-02-29"]),
        ),
        form(
            "a zone with a minus sign of its own",
            stamped(|t| format!("2012-02-29T{}\u{2212}01:00", clock(t))),
            Refused(&["write the minus of its zone as -"]),
        ),
        form("times of day over midnight", stamped(late), Same),
        form("a zone that changes on the way", stamped(summer_time), Same),
        form("negative times", table("time_s,force_n\n", |t, f| format!("{},{f}", t - 5.0)), Same),
        form(
            "newest first",
            "time_s,force_n\n".to_string() + &newest_first.collect::<String>(),
            Refused(&["line 3", "time goes back"]),
        ),
        form(
            "hours, minutes, seconds apart",
            table("hour,minute,second,force_n\n", |t, f| format!("12,0,{t},{f}")),
            Refused(&["hour, minute, second", "--time-column"]),
        ),
        form(
            "hours and minutes only",
            table("hour,minute,force_n\n", |t, f| format!("12,{},{f}", (t / 5.0).floor())),
            Refused(&["hour, minute", "--time-column"]),
        ),
        form(
            "16 Hz, then 10 Hz",
            table("time_s,force_n\n", |t, f| {
                format!("{},{f}", if t < 6.25 { t } else { 6.25 + 1.6 * (t - 6.25) })
            }),
            Refused(&["line 102:", "every 0.100000 s", "cut the log"]),
        ),
        form(
            "elapsed time beside a date",
            table("timestamp,elapsed_s,force_n\n", |t, f| format!("{},{t},{f}", iso(t))),
            Same,
        ),
        form("since 1970, us", since_1970(1e6), Same),
    ]
}

fn since_1970(per_s: f64) -> String {
    table("time,force_n\n", |t, f| format!("{:.0},{f}", (super::NOON + t) * per_s))
}

/// Words and marks in the cells of the force.
pub fn cells() -> Vec<Form> {
    const GROUPED: &str = "without marks between the thousands";
    let held = |text: &str| plain().replacen(",100\n", &format!(",{text}\n"), 1);
    let thousands = |mark: &str| table("time_s;force_n\n", |t, f| format!("{t};1{mark}{f:06.2}"));
    vec![
        form("N/A", held("N/A"), Noted("")),
        form("#DIV/0!", held("#DIV/0!"), Noted("")),
        form("null", held("null"), Noted("")),
        form("-1.#IND", held("-1.#IND"), Noted("")),
        form("OL", held("OL"), Refused(&["line 2", "'OL'", "NaN marks a bad reading"])),
        form("thousands with apostrophes", thousands("'"), Refused(&["line 2", GROUPED])),
        form("thousands with blanks", thousands(" "), Refused(&["line 2", GROUPED])),
        form("thousands with narrow blanks", thousands("\u{202f}"), Refused(&["line 2", GROUPED])),
        form(
            "thousands with points, decimal commas",
            thousands("~").replace('.', ",").replace('~', "."),
            Refused(&["line 2: force cell 2 holds '1.100,00'", GROUPED]),
        ),
        form(
            "another decimal mark on the way",
            table("time_s;force_n\n", |t, f| format!("{t:.4};{f:.2}")).replacen('.', ",", 200),
            Refused(&["line 102", "have another decimal mark"]),
        ),
        form(
            "units in the cells",
            table("time_s;force_n\n", |t, f| format!("{t};{f} N")),
            Refused(&["line 2", "'100 N', not a number", "write the number alone"]),
        ),
        form(
            "hexadecimal counts",
            table("time_s,counts\n", |t, f| format!("{t},0x{:X}", f as i32)),
            Refused(&["line 2", "'0x64', not a whole number of counts"]),
        ),
        form("exponents", table("time_s,force_n\n", |t, f| format!("{t:.9E},{f:.9E}")), Same),
        form(
            "leading zeros",
            table("time_s,force_n\n", |t, f| format!("{t:010.4},{f:09.3}")),
            Same,
        ),
        form("plus signs", table("time_s,force_n\n", |t, f| format!("+{t},+{f}")), Same),
    ]
}

/// Names of columns in other languages and of other makes.
pub fn names() -> Vec<Form> {
    let named = |header: &str| table(&format!("{header}\n"), |t, f| format!("{t};{f}"));
    vec![
        form("Messzeit [s]; Zugkraft [N]", named("Messzeit [s];Zugkraft [N]"), Same),
        form("Tid (s); Trekkraft (N)", named("Tid (s);Trekkraft (N)"), Same),
        form("Temps (s); Effort (N)", named("Temps (s);Effort (N)"), Same),
        form("Cyrillic names", named("Время [s];Сила [N]"), Same),
        form("t; F", named("t;F"), Refused(&["give --column NAME; there are: t, F"])),
        form("Elapsed Time (s); Dev1/ai0 (N)", named("Elapsed Time (s);Dev1/ai0 (N)"), Same),
        form(
            "quoted names with units and commas",
            format!(
                "\u{FEFF}{}",
                table("\"Time [s]\",\"Force, pull [N]\"\n", |t, f| { format!("{t},{f}") })
            ),
            Same,
        ),
        form(
            "daN",
            table("time_s;Force (daN)\n", |t, f| format!("{t};{}", f / 10.0)),
            Refused(&["'daN', which is not read", "turn it into N"]),
        ),
        form(
            "one column for both",
            plain(),
            Refused(&["line 1", "column 1 cannot be the time and the force", "--column"]),
        )
        .with(|options| {
            options.time_column = Some("1".to_string());
            options.column = Some("1".to_string());
            options.unit = Some(floe::log::Unit::Newton);
        }),
        form("sep=;", "sep=;\n".to_string() + &named("time_s;force_n"), Same),
        form(
            "an index before the time",
            table(",time_s,force_n\n", |t, f| format!("{},{t},{f}", 16.0 * t)),
            Same,
        ),
    ]
}

/// Misplaced rows, and files that are no tables.
pub fn wholes() -> Vec<Form> {
    let twice = plain().replace("\n5,", "\n5,1\n5,");
    let json: Vec<String> = (0..SAMPLES)
        .map(|i| format!("{{\"time_s\": {}, \"force_n\": {}}}", seconds(i), force_n(i)))
        .collect();
    vec![
        form("byte order mark, CR", format!("\u{FEFF}{}", plain()).replace('\n', "\r"), Same),
        form("empty lines between all rows", plain().replace('\n', "\n\n"), Same),
        form("a comment in the middle", plain().replacen("\n5,", "\n# tea, 5 min\n5,", 1), Same),
        form("a comment of % in the middle", plain().replacen("\n5,", "\n% tea\n5,", 1), Same),
        form("a row there twice", twice, Noted("")),
        form(
            "the header again",
            plain().replacen("\n5,", "\ntime_s,force_n\n5,", 1),
            Refused(&["line 82", "'force_n', not a number", "take it out", "else cut the log"]),
        ),
        form(
            "a comma, then semicolons",
            plain().replacen("5,", "5;", 30),
            Refused(&["line 18", "1 cell instead of 2"]),
        ),
        form(
            "words at the end",
            plain() + "End of data\n",
            Refused(&["line 202", "1 cell instead of 2", "take it out"]),
        ),
        form(
            "a line break in quotes",
            table("time_s,force_n,note\n", |t, f| format!("{t},{f},\"{}\"", "ok")).replacen(
                "\"ok\"\n5,",
                "\"two\nlines\"\n5,",
                1,
            ),
            Refused(&["line 81", "a quote is not closed", "into one"]),
        ),
        form(
            "5000 columns",
            format!("time_s,force_n{}\n", ",other".repeat(4998))
                + &table("", |t, f| format!("{t},{f}{}", ",1".repeat(4998))),
            Same,
        ),
        form("bzip2", b"BZh91AY&SY\0\0\0\x01".to_vec(), Refused(&["bunzip2 -c FILE"])),
        form("zeros at the end", [plain().into_bytes(), vec![0; 300]].concat(), Noted("cut off")),
        form("JSON, lines", json.join("\n"), Refused(&["is JSON", "as CSV"])),
        form("JSON, an array", format!("[{}]", json.join(",\n")), Refused(&["is JSON", "as CSV"])),
        form("HTML", format!("<html><table><tr><td>{}", plain()), Refused(&["is HTML or XML"])),
        form("comma and blank", plain().replace(',', ", "), Same),
    ]
}
