//! Units and columns; headers of instruments, metadata.

use floe::log::stamp::TimeUnit;
use floe::log::{Decimal, Unit};

use super::Expected::{Noted, Refused, Same};
use super::{Form, comma, form, plain, table, toa5};

pub fn force_forms() -> Vec<Form> {
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

/// Units in the rows and in comments.
pub fn unit_forms() -> Vec<Form> {
    let beside = |unit: &'static str| {
        let row = move |t: f64, f: f64| format!("{t},{},{unit}", f * 1e-3);
        table("Time (s),Load,Unit\n", row)
    };
    let said = |unit: &str, column: &str| {
        let head = format!("# unit: {unit}\ntime_s,{column}\n");
        table(&head, |t, f| format!("{t},{}", f * 1e-3))
    };
    let mark_10 = |t: f64, f: f64| format!("{f},N,{t},{t},mm");
    let newton = Some(Unit::Newton);
    vec![
        form("a column Unit", beside("KN"), Same),
        form(
            "a force that only Units tell",
            beside("kN").replacen("Load", "Tracking Value", 1),
            Same,
        ),
        form("two columns of units", table("Load,Unit,Time,Travel,Units\n", mark_10), Same),
        form("a column Unit, unknown", beside("ozF"), Refused(&["'Load' is 'ozF'", "--unit"])),
        form(
            "a column Unit that changes",
            beside("kN").replacen(",kN\n5,", ",N\n5,", 1).replacen(",kN\n", ",N\n", 1),
            Refused(&["column 'Unit' says 'N' and 'kN'"]),
        ),
        form(
            "a column Unit against the name",
            beside("kN").replacen("Load", "Load [N]", 1),
            Refused(&["in N", "in kN"]),
        ),
        form("a column Unit against --unit", beside("kN"), Refused(&["in kN", "--unit says N"]))
            .with(|o| o.unit = newton),
        form("# unit: kN", said("kN", "force"), Same),
        form("# unit: ozf", said("ozf", "force"), Refused(&["'# unit: ozf' in line 1", "--unit"])),
        form(
            "# unit: N above force_kn",
            said("N", "force_kn"),
            Refused(&["line 1: '# unit: N'", "read in kN"]),
        ),
        form("# unit: kN, --unit N", said("kN", "force"), Refused(&["line 1", "--unit says N"]))
            .with(|o| o.unit = newton),
        form(
            "# unit: kN below the first row",
            said("N", "force").replacen("# unit: N\n", "", 1).replacen(
                "\n5,",
                "\n# unit: kN\n5,",
                1,
            ),
            Refused(&["line 82: '# unit: kN'", "above the rows"]),
        ),
    ]
}

pub fn whole_forms() -> Vec<Form> {
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
        form("TOA5, columns by number", toa5("\"TS\",\"kN\""), Same).with(|o| {
            o.time_column = Some("1".to_string());
            o.column = Some("2".to_string());
        }),
        form(
            "TOA5, --time-unit",
            toa5("\"TS\",\"kN\""),
            Refused(&["--time-unit is for a csv log, and this is toa5", "give --format csv"]),
        )
        .with(|o| o.time_unit = Some(TimeUnit::Iso)),
        form(
            "taken for a cr10, --time-column",
            table("", |t, f| format!("1,2,3,1200,{t},{f}")),
            Refused(&["--time-column is for a csv log, and this is cr10"]),
        )
        .with(|o| o.time_column = Some("5".to_string())),
        form("TOA5, short units row", toa5("\"TS\""), Refused(&["2 names, but 1 units"])),
    ]
}
