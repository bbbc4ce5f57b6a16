//! Line ends, separators, decimal marks; times.

use floe::log::stamp::TimeUnit;

use super::Expected::{Noted, Refused, Same};
use super::{Form, NOON, clock, comma, form, iso, plain, table, utf16};

pub fn text_forms() -> Vec<Form> {
    let plain = plain();
    vec![
        form("plain", plain.clone(), Same),
        form("CR LF line ends", plain.replace('\n', "\r\n"), Same),
        form("CR line ends", plain.replace('\n', "\r"), Same),
        form("UTF-8 mark", format!("\u{FEFF}{plain}"), Same),
        form("UTF-16, little end first", utf16(&plain, u16::to_le_bytes), Same),
        form("UTF-16, big end first", utf16(&plain, u16::to_be_bytes), Same),
        form(
            "UTF-16 without its mark",
            plain.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>(),
            Refused(&["UTF-16", "UTF-8"]),
        ),
        form(
            "Zeit [µs]; Prüfkraft [N] in Latin-1",
            table("Zeit [µs];T [°C];Prüfkraft [N];Weg [N]\n", |t, f| {
                format!("{};-2;{f};1", t * 1e6)
            })
            .chars()
            .map(|letter| letter as u8)
            .collect::<Vec<u8>>(),
            Same,
        )
        .with(|options| options.column = Some("Prüfkraft [N]".to_string())),
        form("tabs", plain.replace(',', "\t"), Same),
        form("bars", plain.replace(',', "|"), Same),
        form("blanks", plain.replace(',', "   "), Same),
        form("quotes", table("\"time_s\",\"force_n\"\n", |t, f| format!("\"{t}\",\"{f}\"")), Same),
        form(
            "decimal comma, semicolons",
            table("time_s;force_n\n", |t, f| format!("{};{}", comma(t), comma(f))),
            Same,
        ),
        form(
            "decimal comma in quotes",
            table("time_s,force_n\n", |t, f| format!("\"{}\",\"{}\"", comma(t), comma(f))),
            Same,
        ),
        form(
            "decimal comma, commas between cells",
            table("time_s,force_n\n", |t, f| format!("{t:.4},{f:.2}").replace('.', ",")),
            Refused(&["line 1", "2 cells", "line 2 has 4", "--delimiter"]),
        ),
        form(
            "thousands and decimals",
            table("time_s;force_n\n", |t, f| format!("{t};1,{f:06.2}")),
            Refused(&["force cell 2", "not a number"]),
        ),
        form(
            "comma and point",
            table("time_s;force_n\n", |t, f| {
                format!("{t:.4};{}", format!("{f:.2}").replace('.', ","))
            }),
            Refused(&["--decimal"]),
        ),
        form("comments and empty lines", plain.replace("\n1,", "\n# a comment\n\n1,"), Same),
        form("a last line cut off", format!("{plain}12.5,"), Noted("cut off")),
        form("a last line without an end", plain.trim_end(), Same),
        form(
            "such a line, its number cut short",
            format!("{plain}12.5,2"),
            Noted("may be cut short"),
        ),
    ]
}

pub fn time_forms() -> Vec<Form> {
    let ms = |t: f64, f: f64| format!("{},{f}", t * 1e3);
    let named = |name: &str, unit: f64| {
        table(&format!("{name},force_n\n"), move |t, f| format!("{},{f}", t * unit))
    };
    let iso_rows = |header: &str, stamp: &dyn Fn(f64) -> String| {
        table(header, |t, f| format!("{};{f}", stamp(t)))
    };
    vec![
        form("Time (s)", named("Time (s)", 1.0), Same),
        form("Zeit [s]", named("Zeit [s]", 1.0), Same),
        form("Time / s", named("Time / s", 1.0), Same),
        form("timestamp in s", named("timestamp", 1.0), Same),
        form("time_ms", table("time_ms,force_n\n", ms), Same),
        form("millis", table("millis,force_n\n", ms), Same),
        form("elapsed_us", table("elapsed_us,force_n\n", |t, f| format!("{},{f}", t * 1e6)), Same)
            .with(|o| o.time_column = Some("elapsed_us".to_string())),
        form("Time (min)", named("Time (min)", 1.0 / 60.0), Same),
        form("milliseconds, --time-unit", named("tick", 1e3), Same).with(|o| {
            o.time_column = Some("tick".to_string());
            o.time_unit = Some(TimeUnit::Millisecond);
        }),
        form("milliseconds, unsaid", named("time", 1e3), Refused(&["--time-unit"])),
        form(
            "Time [ms] in seconds",
            named("Time [ms]", 1.0),
            Refused(&[
                "time stamps in ms say 16000.",
                "in s they would be 16.000",
                "else correct the unit",
            ]),
        ),
        form("hours", named("Time [h]", 1.0 / 3600.0), Refused(&["'h'", "--time-unit"])),
        form(
            "unit against --time-unit",
            named("time_ms", 1e3),
            Refused(&["'time_ms' is in ms", "--time-unit says s"]),
        )
        .with(|o| o.time_unit = Some(TimeUnit::Second)),
        form("ISO 8601, UTC", iso_rows("time;force_n\n", &iso), Same),
        form(
            "ISO 8601, zone",
            iso_rows("time;force_n\n", &|t| format!("2012-02-29T{}+01:00", clock(t))),
            Same,
        ),
        form(
            "ISO 8601, blank, no zone",
            iso_rows("Timestamp;force_n\n", &|t| format!("2012-02-29 {}", clock(t))),
            Same,
        ),
        form(
            "29.02.2012 12:00:00,0625",
            table("Zeit;Kraft [N]\n", |t, f| {
                format!("29.02.2012 {};{}", clock(t).replace('.', ","), comma(f))
            }),
            Same,
        ),
        form(
            "a spreadsheet's Datum/Zeit, kN, decimal commas",
            table("Datum/Zeit;Kraft (kN);Notiz\n", |t, f| {
                let stamp = format!("2012-02-29T{}", clock(t)).replace('.', ",");
                format!("{stamp};{};", comma(f / 1e3))
            }),
            Same,
        ),
        form(
            "dates under any name",
            table("Block 7;;\nZeitpunkt;Kraft [kN];Bemerkung\n", |t, f| {
                let stamp = format!("2012-02-29T{}", clock(t)).replace('.', ",");
                format!("{stamp};{};", comma(f / 1e3))
            }),
            Same,
        ),
        form(
            "two columns of dates",
            table("begun;seen;Force [N]\n", |t, f| format!("{};{};{f}", iso(0.0), iso(t))),
            Refused(&["no time column", "--time-column NAME, such as 'seen'", "begun, seen"]),
        ),
        form(
            "02/29/2012",
            iso_rows("time;force_n\n", &|t| format!("02/29/2012 {}", clock(t))),
            Refused(&["no time can be read from '02/29/2012"]),
        ),
        form(
            "date and time apart",
            table("Date;Time;Force [N]\n", |t, f| format!("2012-02-29;{};{f}", clock(t))),
            Same,
        ),
        form("time of day", iso_rows("Time;force_n\n", &clock), Same),
        form("since 1970, s", table("time,force_n\n", |t, f| format!("{},{f}", NOON + t)), Same),
        form(
            "since 1970, ms",
            table("timestamp,force_n\n", |t, f| format!("{},{f}", (NOON + t) * 1e3)),
            Same,
        ),
        form(
            "spreadsheet's days",
            table("Time,force_n\n", |t, f| format!("{:.9},{f}", 25_569.0 + (NOON + t) / 86_400.0)),
            Same,
        ),
        form("a sample lost", plain().replacen("1.5,", "# 1.5,", 1), Noted("")),
        form(
            "another interval on the way",
            table("time_s,force_n\n", |t, f| {
                format!("{},{f}", if t < 5.0 { t } else { 2.0 * t - 5.0 })
            }),
            Refused(&[
                "line 82:",
                "every 0.125000 s",
                "before every 0.062500 s",
                "cut the log there",
            ]),
        ),
        form("time goes back", plain().replacen("\n5,", "\n1,", 1), Refused(&["time goes back"])),
    ]
}
