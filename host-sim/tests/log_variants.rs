//! One log in sixty forms, as loggers, spreadsheets and people write it: recognised and
//! read like the plain one, or refused with the remedy. The table is `docs/logs.md`;
//! `FLOE_TABLE=write cargo test -p floe --test log_variants` writes it.

use std::fmt::Write;

use floe::log::inspection::{Inspection, inspect};
use floe::log::stamp::TimeUnit;
use floe::log::{Decimal, Log, LogOptions, Sample, Unit};
use floe_core::Reading;

/// Samples of the plain log, 16 a second.
const SAMPLES: u32 = 200;
/// Spring day on which the log with dates was recorded, seconds since 1970.
const NOON: f64 = 1_330_516_800.0;

fn seconds(i: u32) -> f64 {
    f64::from(i) / 16.0
}

fn force_n(i: u32) -> f64 {
    100.0 + f64::from(i * 37 % 101) * 4.25
}

/// A header, and a row from the time and the force of every sample.
fn table(header: &str, row: impl Fn(f64, f64) -> String) -> String {
    let rows = (0..SAMPLES).map(|i| row(seconds(i), force_n(i)) + "\n");
    header.to_string() + &rows.collect::<String>()
}

fn plain() -> String {
    table("time_s,force_n\n", |t, f| format!("{t},{f}"))
}

fn comma(value: f64) -> String {
    value.to_string().replace('.', ",")
}

/// `12:00:00.0625` at noon plus `t`.
fn clock(t: f64) -> String {
    let whole = t.floor();
    format!("12:{:02}:{:07.4}", (whole / 60.0) as u32, t - (whole / 60.0).floor() * 60.0)
}

fn iso(t: f64) -> String {
    format!("2012-02-29T{}Z", clock(t))
}

/// What should become of a form.
enum Expected {
    /// Read like the plain log.
    Same,
    /// Read, with these words in a warning.
    Noted(&'static str),
    /// Refused with all these words.
    Refused(&'static [&'static str]),
}
use Expected::{Noted, Refused, Same};

struct Form {
    name: &'static str,
    content: Vec<u8>,
    options: LogOptions,
    expected: Expected,
}

fn form(name: &'static str, content: impl Into<Vec<u8>>, expected: Expected) -> Form {
    Form { name, content: content.into(), options: LogOptions::default(), expected }
}

impl Form {
    fn with(mut self, set: impl FnOnce(&mut LogOptions)) -> Self {
        set(&mut self.options);
        self
    }
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    std::iter::once('\u{FEFF}')
        .chain(text.chars())
        .collect::<String>()
        .encode_utf16()
        .flat_map(bytes)
        .collect()
}

fn text_forms() -> Vec<Form> {
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
    ]
}

fn time_forms() -> Vec<Form> {
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
        form("elapsed_us", table("elapsed_us,force_n\n", |t, f| format!("{},{f}", t * 1e6)), Same)
            .with(|o| o.time_column = Some("elapsed_us".to_string())),
        form("Time (min)", named("Time (min)", 1.0 / 60.0), Same),
        form("milliseconds, --time-unit", named("tick", 1e3), Same).with(|o| {
            o.time_column = Some("tick".to_string());
            o.time_unit = Some(TimeUnit::Millisecond);
        }),
        form("milliseconds, unsaid", named("time", 1e3), Refused(&["--time-unit"])),
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
            Refused(&["no time column", "--time-column", "begun, seen"]),
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
            Refused(&["line 2:", "every 0.062500 s", "every 0.125000 s", "cut the log"]),
        ),
        form("time goes back", plain().replacen("\n5,", "\n1,", 1), Refused(&["time goes back"])),
    ]
}

fn force_forms() -> Vec<Form> {
    let scaled =
        |header: &'static str, per_n: f64| table(header, move |t, f| format!("{t},{}", f * per_n));
    let kg = 1.0 / 9.80665;
    let lbf = 1.0 / 4.448_221_615_260_5;
    vec![
        form("force_kN", scaled("time_s,force_kN\n", 1e-3), Same),
        form("Force [kN]", scaled("time_s,Force [kN]\n", 1e-3), Same),
        form("Kraft in kN", scaled("time_s,Kraft in kN\n", 1e-3), Same),
        form("Load (lbf)", scaled("time_s,Load (lbf)\n", lbf), Same),
        form("pull_kg", scaled("time_s,pull_kg\n", kg), Same),
        form("kg", scaled("time_s,kg\n", kg), Same),
        form("--column kg", scaled("time_s,kg\n", kg), Same)
            .with(|o| o.column = Some("kg".to_string())),
        form("units row", scaled("Time,Force\n[s],[kN]\n", 1e-3), Same),
        form(
            "units row, bare",
            scaled("Time,Force\nms,lbf\n", lbf).replace("ms,lbf", "s,lbf"),
            Same,
        ),
        form(
            "unit against --unit",
            scaled("time_s,Force [kN]\n", 1e-3),
            Refused(&["'Force [kN]' is in kN", "--unit says N"]),
        )
        .with(|o| o.unit = Some(Unit::Newton)),
        form(
            "name against units row",
            scaled("time_s,force_n\n[s],[kN]\n", 1e-3),
            Refused(&["in N by its name and in kN"]),
        ),
        form(
            "a unit that is not one of force",
            scaled("time_s,Force [mV/V]\n", 1.0),
            Refused(&["'mV/V'", "--unit"]),
        ),
        form(
            "force_mN",
            table("time_s,force_mN\n", |t, f| format!("{t},{}", f * 1e3)),
            Refused(&["'force_mN' is 'mN'", "--unit"]),
        ),
        form("no unit", scaled("time_s,Force\n", 1.0), Noted("taken as N")),
        form("no unit, --unit", scaled("time_s,Force\n", 1e-3), Same)
            .with(|o| o.unit = Some(Unit::Kilonewton)),
        form(
            "two forces",
            table("time_s,load_n,pull_n\n", |t, f| format!("{t},1,{f}")),
            Refused(&["which column", "--column", "load_n, pull_n"]),
        ),
        form(
            "duplicate names",
            table("time_s,force_n,force_n\n", |t, f| format!("{t},1,{f}")),
            Refused(&["columns 2 and 3 are both called 'force_n'", "--column 3"]),
        ),
        form(
            "duplicate names, --column 3",
            table("time_s,force_n,force_n\n", |t, f| format!("{t},1,{f}")),
            Same,
        )
        .with(|o| o.column = Some("3".to_string())),
        form(
            "short units row",
            table("time_s,temp,force\n[s],[kN]\n", |t, f| format!("{t},7,{f}")),
            Refused(&["line 2: the units row has 2 cells, and line 3 has 3"]),
        ),
        form("bad readings", plain().replacen(",100\n", ",-6999\n", 1), Noted("")),
    ]
}

fn whole_forms() -> Vec<Form> {
    let labview = "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n\
        Date\t2012/02/29\nTime\t12:00:00.0\n***End_of_Header***\n\nChannels\t1\nSamples\t200\n\
        X_Dimension\tTime\nX0\t0.0\nDelta_X\t0.0625\n***End_of_Header***\nX_Value\tForce (N)\tComment\n";
    let said = |keys: &str| format!("# weight_n: 630\n{keys}{}", plain());
    vec![
        form("headerless, two columns", table("", |t, f| format!("{t},{f}")), Noted("no header")),
        form(
            "headerless, three columns",
            table("", |t, f| format!("{t},7,{f}")),
            Refused(&["no header line", "--time-column 1"]),
        ),
        form("headerless, by numbers", table("", |t, f| format!("{t},7,{f}")), Noted("no header"))
            .with(|o| {
                o.time_column = Some("1".to_string());
                o.column = Some("3".to_string());
            }),
        form("forces alone, --rate-hz", table("force_n\n", |_, f| f.to_string()), Same)
            .with(|o| o.rate_hz = Some(16.0)),
        form("forces alone", table("force_n\n", |_, f| f.to_string()), Refused(&["--rate-hz"])),
        form("forces alone, no header", table("", |_, f| f.to_string()), Noted("no header"))
            .with(|o| o.rate_hz = Some(16.0)),
        form("LabVIEW", table(labview, |t, f| format!("{t:.6}\t{f:.6}\t")), Same),
        form("LabVIEW, no comments", table(labview, |t, f| format!("{t:.6}\t{f:.6}")), Same),
        form(
            "MATLAB",
            table("% pull of block 7\n% 29-Feb-2012\n", |t, f| format!("   {t:.7e}   {f:.7e}")),
            Noted("no header"),
        ),
        form("numpy", table("# time_s force_n\n", |t, f| format!("{t:.18e} {f:.18e}")), Same),
        form(
            "instrument's header",
            table("Load cell: S2M\nRange;2 kN\nDate;29.02.2012\n\nZeit [s];Kraft [N]\n", |t, f| {
                format!("{};{}", comma(t), comma(f))
            }),
            Same,
        ),
        form("--skip-lines", format!("1,2\n3,4\n5,6\n7,8\n{}", plain()), Same)
            .with(|o| o.skip_lines = 4),
        form(
            "--delimiter, --decimal",
            table("time_s:force_n\n", |t, f| format!("{}:{}", comma(t), comma(f))),
            Same,
        )
        .with(|o| {
            o.delimiter = Some(b':');
            o.decimal = Some(Decimal::Comma);
        }),
        form(
            "another column with text",
            table("time_s,state,force_n\n", |t, f| format!("{t},ok,{f}")),
            Same,
        ),
        form("an idle last column", plain().replace('\n', ",\n"), Same),
        form("metadata repeated", said("# weight_n: 630\n"), Same),
        form(
            "metadata contradicted",
            said("# weight_n: 700\n"),
            Refused(&["line 2", "'# weight_n:' says '700'", "line 1"]),
        ),
        form(
            "metadata changed on the way",
            said("").replacen("\n5,", "\n# weight_n: 500\n5,", 1),
            Refused(&["line 83", "line 1"]),
        ),
        form(
            "rate against the times",
            said("# rate_hz: 10\n"),
            Refused(&["line 2", "rate_hz: 10", "line 4", "16.000 times a second"]),
        ),
        form(
            "--rate-hz against the times",
            plain(),
            Refused(&["--rate-hz says 8", "16.000 times a second"]),
        )
        .with(|o| o.rate_hz = Some(8.0)),
        form("TOA5", toa5("\"TS\",\"kN\""), Same),
        form("TOA5, short units row", toa5("\"TS\""), Refused(&["2 names, but 1 units"])),
    ]
}

fn toa5(units: &str) -> String {
    let head =
        format!("\"TOA5\",\"CR3000\",\"1\"\n\"TIMESTAMP\",\"Pull\"\n{units}\n\"\",\"Smp\"\n");
    table(&head, |t, f| format!("\"2012-02-29 {}\",{}", clock(t), f * 1e-3))
}

fn forms() -> Vec<Form> {
    [text_forms(), time_forms(), force_forms(), whole_forms()].into_iter().flatten().collect()
}

fn read(form: &Form) -> Result<(Vec<Sample>, Inspection), String> {
    let open = || {
        let input = std::io::Cursor::new(form.content.clone());
        Log::from_reader(Box::new(input), &form.options).map_err(|e| e.to_string())
    };
    let found = inspect("a log", &mut open()?).map_err(|e| e.to_string())?;
    let mut log = open()?;
    let next = || log.next_sample().map_err(|e| e.to_string()).transpose();
    Ok((std::iter::from_fn(next).collect::<Result<_, String>>()?, found))
}

fn force(sample: &Sample) -> Option<f64> {
    match sample.raw.reading {
        Reading::Force(force) => Some(f64::from(force.0)),
        Reading::Counts(_) | Reading::Bad(_) => None,
    }
}

/// How a form differs from the plain log, if it does.
fn difference(samples: &[Sample]) -> Option<String> {
    if samples.len() != SAMPLES as usize {
        return Some(format!("{} samples", samples.len()));
    }
    let start = samples[0].time_s;
    (0..SAMPLES).zip(samples).find_map(|(i, sample)| {
        let force = force(sample)?;
        let right = sample.raw.index == u64::from(i)
            && (sample.time_s - start - seconds(i)).abs() < 1e-4
            && (force / force_n(i) - 1.0).abs() < 1e-6;
        (!right).then(|| format!("sample {i}: {sample:?}"))
    })
}

fn recognised(found: &Inspection) -> String {
    let separator = match found.delimiter {
        '\t' => "tab".to_string(),
        ' ' => "blanks".to_string(),
        '|' => "bar".to_string(),
        other => format!("`{other}`"),
    };
    let time = found.time_unit.map_or("none".to_string(), |unit| {
        let columns: Vec<String> = found.time_columns.iter().map(usize::to_string).collect();
        format!("{unit} ({})", columns.join(", "))
    });
    format!(
        "{} | {separator} | {} | {time} | {} ({})",
        found.format,
        found.first_row_line.map_or("-".to_string(), |line| line.to_string()),
        found.force_unit,
        found.force_column
    )
}

/// A form's row of the table, or what is wrong with it.
fn check(form: &Form) -> Result<String, String> {
    let name = form.name;
    let wrong = |what: String| Err(format!("{name}: {what}"));
    let row = match (&form.expected, read(form)) {
        (Same | Noted(_), Err(message)) => return wrong(message),
        (Refused(_), Ok((_, found))) => return wrong(format!("is read: {found:?}")),
        (Refused(parts), Err(message)) => {
            if message.contains('\n') || !parts.iter().all(|part| message.contains(part)) {
                return wrong(format!("{parts:?} are not in: {message}"));
            }
            format!("refused | | | | | {}", message.replace('|', "\\|"))
        }
        (Same, Ok((samples, found))) => {
            let noted = found.warnings.join("; ");
            if let Some(what) = difference(&samples).or(Some(noted).filter(|n| !n.is_empty())) {
                return wrong(what);
            }
            format!("{} | the same", recognised(&found))
        }
        (Noted(words), Ok((samples, found))) => {
            let noted = found.warnings.join("; ");
            if !noted.contains(words) || samples.len() as u32 + 1 < SAMPLES {
                return wrong(format!("'{words}' is not in: {noted}"));
            }
            let counts = format!("{} missing, {} bad", found.missing, found.bad);
            let what = if noted.is_empty() { counts } else { noted };
            format!("{} | {what}", recognised(&found))
        }
    };
    Ok(format!("| {name} | {row} |\n"))
}

#[test]
fn sixty_forms_of_one_log() {
    let forms = forms();
    assert!(forms.len() >= 60, "{}", forms.len());
    let mut page = String::from(
        "| the log | format | separator | rows from line | time (column) | force (column) | result |\n\
         |---|---|---|---|---|---|---|\n",
    );
    let rows: Vec<Result<String, String>> = forms.iter().map(check).collect();
    let wrong: Vec<&String> = rows.iter().filter_map(|row| row.as_ref().err()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    page.extend(rows.into_iter().flatten());
    let _ = writeln!(page, "\n{} forms.", forms.len());
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/logs.md");
    let old = std::fs::read_to_string(path).unwrap_or_default();
    let mark = "<!-- table -->\n";
    let (text, table) = old.split_once(mark).expect("the page has a place for the table");
    if std::env::var("FLOE_TABLE").is_ok_and(|what| what == "write") {
        std::fs::write(path, format!("{text}{mark}{page}")).unwrap();
    } else {
        assert_eq!(table, page, "docs/logs.md: FLOE_TABLE=write writes it anew");
    }
}
