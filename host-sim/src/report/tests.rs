//! Tests of the whole page: well-formed, self-contained, bounded, and meaningful with little data.

use std::collections::HashSet;
use std::time::Instant;

use roxmltree::{Document, Node};

use super::sample_log::SampleLog;
use super::{Provenance, Recorder};

/// Pages for all kinds of logs.
fn pages() -> Vec<(&'static str, String)> {
    let mut single = SampleLog::dff8_13(6.0);
    single.keep_events(1);
    let pages = [
        ("usual", SampleLog::dff8_13(120.0)),
        ("hour", SampleLog::dff8_13(3600.0)),
        ("troubled", SampleLog::troubled(40.0)),
        ("tiny", SampleLog::troubled(40.0).scaled(4e-4)),
        ("single", single),
        ("none", SampleLog::dff8_13(40.0).without_events()),
    ];
    pages.into_iter().map(|(name, log)| (name, log.page())).collect()
}

/// The page is XML apart from its first line.
fn parsed(page: &str) -> Document<'_> {
    let body = page.strip_prefix("<!DOCTYPE html>\n").unwrap();
    Document::parse(body).unwrap_or_else(|error| panic!("{error}"))
}

/// The page without the script.
fn without_program(page: &str) -> String {
    assert!(page.contains(include_str!("script.js")));
    page.replace(include_str!("script.js"), "")
}

fn elements<'a>(document: &'a Document<'a>, name: &'a str) -> Vec<Node<'a, 'a>> {
    document.descendants().filter(|node| node.has_tag_name(name)).collect()
}

fn all_text(node: Node<'_, '_>) -> String {
    node.descendants().filter_map(|n| n.text().filter(|_| n.is_text())).collect()
}

/// Pages to look at, in `target/report-preview/`.
#[test]
#[ignore = "writes pages for the eye"]
fn previews() {
    let folder = std::path::Path::new("../target/report-preview");
    std::fs::create_dir_all(folder).unwrap();
    for (name, page) in pages() {
        std::fs::write(folder.join(format!("{name}.html")), page).unwrap();
    }
}

#[test]
fn every_page_is_well_formed_and_self_contained() {
    for (name, page) in pages() {
        let document = parsed(&page);
        for foreign in ["http:", "https:", "//www", "@import", "src=", "NaN", "inf\"", "infinity"] {
            assert!(!without_program(&page).contains(foreign), "{name}: {foreign}");
        }
        let ids: Vec<&str> =
            document.descendants().filter_map(|node| node.attribute("id")).collect();
        assert_eq!(ids.len(), ids.iter().collect::<HashSet<_>>().len(), "{name}: an id twice");
        let plots = elements(&document, "svg").into_iter().filter(|svg| svg.has_attribute("role"));
        for plot in plots {
            let named = plot.attribute("aria-labelledby").unwrap();
            assert!(named.split(' ').all(|id| ids.contains(&id)), "{name}: {named}");
        }
    }
}

/// The figures of two logs equal the stored ones, which a person has looked at: `FLOE_GOLDEN=write`
/// stores new ones, to be looked at and committed with the reason.
#[test]
fn the_figures_are_those_that_were_looked_at() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/figures");
    let write = std::env::var("FLOE_GOLDEN").is_ok_and(|value| value == "write");
    let logs = [("usual", SampleLog::dff8_13(40.0)), ("troubled", SampleLog::troubled(40.0))];
    for (log_name, log) in logs {
        let figures = super::figures(&log.result, &log.recorder());
        assert!(figures.len() >= 6, "{log_name}: {} figures", figures.len());
        for (name, svg) in figures {
            let path = folder.join(format!("{log_name}-{name}"));
            // Without the style, and without the script's data, which have every digit.
            let svg = svg.replace(include_str!("style.css"), "").replace("><", ">\n<");
            let (before, rest) = svg.split_once(" data-x=").unwrap();
            let svg = before.to_owned() + rest.split_once(">\n").unwrap().1;
            if write {
                std::fs::create_dir_all(&folder).unwrap();
                std::fs::write(&path, &svg).unwrap();
            }
            let stored = std::fs::read_to_string(&path).unwrap_or_default();
            let differs = svg.lines().zip(stored.lines()).find(|(new, old)| new != old);
            let differs = differs.map(|(new, _)| new.chars().take(200).collect::<String>());
            assert_eq!(differs, None, "{} is another picture now", path.display());
            assert_eq!(svg.lines().count(), stored.lines().count(), "{}", path.display());
        }
    }
}

#[test]
fn labels_stay_on_the_paper() {
    for (name, page) in pages() {
        let document = parsed(&page);
        for svg in elements(&document, "svg").into_iter().filter(|svg| svg.has_attribute("role")) {
            let size: Vec<f64> =
                svg.attribute("viewBox").unwrap().split(' ').map(|x| x.parse().unwrap()).collect();
            for text in svg.descendants().filter(|node| node.has_tag_name("text")) {
                let place = |axis| text.attribute(axis).unwrap().parse::<f64>().unwrap();
                let width = 8.0 * all_text(text).chars().count() as f64;
                let left = match text.attribute("class").unwrap_or("") {
                    class if class.contains("mid") => place("x") - width / 2.0,
                    class if class.contains("end") => place("x") - width,
                    _ => place("x"),
                };
                let fits = left > -8.0 && left + width < size[2] + 8.0;
                let fits = fits && place("y") > 8.0 && place("y") < size[3];
                assert!(fits, "{name}: '{}' at {left}", all_text(text));
            }
        }
    }
}

#[test]
fn an_hour_stays_below_two_megabytes_and_a_second() {
    let log = SampleLog::dff8_13(3600.0);
    assert!(log.result.events.len() > 2000 && log.steps.len() == 57_600);
    let recorder = log.recorder();
    let start = Instant::now();
    let page = super::render(&log.result, &recorder, &Provenance::default());
    let (size, time) = (page.len(), start.elapsed());
    assert!(size < 1_000_000, "{size} bytes");
    assert!(time.as_secs_f64() < 1.0, "{time:?}");
}

#[test]
fn ten_times_the_log_costs_little_more() {
    let hour = SampleLog::dff8_13(3600.0).page().len();
    let page = SampleLog::dff8_13(36_000.0).page().len();
    assert!(page < hour * 3 / 2, "{page} bytes after {hour}");
}

#[test]
fn text_from_outside_is_escaped() {
    let evil = "<script>alert('&\"')</script>\u{0}";
    let mut log = SampleLog::troubled(40.0);
    log.result.test.test_id = Some(evil.into());
    log.result.log.path = format!("a/{evil}.csv");
    log.result.log.format = evil.into();
    log.result.log.warnings.push(evil.into());
    log.result.events.kept[5].quality = evil.into();
    log.result.events.kept[6].reason = Some(evil.into());
    let page = log.page();
    let document = parsed(&page);
    let scripts = elements(&document, "script");
    let ids: Vec<_> = scripts.iter().map(|script| script.attribute("id")).collect();
    assert_eq!(ids, [Some("data"), None], "only the page's own");
    let seen = all_text(document.root());
    assert!(seen.matches("<script>alert('&\"')</script>").count() >= 6);
}

#[test]
fn the_result_and_the_health_of_the_log_are_there() {
    let log = SampleLog::troubled(40.0);
    let page = log.page();
    let document = parsed(&page);
    let seen = all_text(document.root());
    let estimate = &log.result.estimate;
    let mean = format!("{:.4}", estimate.mu_s.mean.unwrap());
    for needed in [
        &mean,
        "⚠ 12",
        "⚠ 3",
        "the last line is cut off",
        "clipped: a gap or saturated samples hide the slip",
        "unresolved",
        "Test DFF8-13 (synthetic)",
        "block weight 630.0 N",
        "logs/dff8-13.csv",
        concat!("floe ", env!("CARGO_PKG_VERSION")),
    ] {
        assert!(seen.contains(needed), "{needed}");
    }
    assert_eq!(elements(&document, "figure").len(), 6);
    let rows = elements(&document, "tr").len() - 1;
    assert_eq!(rows, log.result.events.len());
}

#[test]
fn little_to_show_is_shown_sensibly() {
    let none = SampleLog::dff8_13(40.0).without_events();
    let page = none.page();
    let document = parsed(&page);
    assert!(all_text(document.root()).contains("No stick-slip event was found"));
    assert_eq!(elements(&document, "figure").len(), 2, "history and phase plane");
    assert!(elements(&document, "table").is_empty());

    let empty = super::render(&none.result, &Recorder::new(16.0), &Provenance::default());
    let document = parsed(&empty);
    assert!(elements(&document, "figure").is_empty());
    assert!(all_text(document.root()).contains("no usable sample"));

    let mut valueless = SampleLog::dff8_13(6.0);
    valueless.keep_events(1);
    let event = &mut valueless.result.events.kept[0];
    (event.mu_s, event.mu_s_std, event.mu, event.mu_std) = (None, None, None, None);
    event.omega_rad_per_s = None;
    event.reason = Some("too few samples around the slip".into());
    valueless.result.estimate = crate::replay::result::EstimateSummary {
        mu_s: Default::default(),
        mu: Default::default(),
        events: 0,
    };
    let page = valueless.page();
    let document = parsed(&page);
    let seen = all_text(document.root());
    assert!(seen.contains("No event gives a coefficient") && seen.contains("too few samples"));
    assert!(seen.contains("not measured: no event gives a value") && !seen.contains("no ±"));
    assert_eq!(elements(&document, "figure").len(), 4, "no convergence");
}

#[test]
fn paper_parts_no_heading_from_its_text_and_no_row() {
    let (_, print) = include_str!("style.css").split_once("@media print").unwrap();
    for rule in [
        "\n  h2, h2 + p:has(+ .scroll), thead { break-after: avoid; }",
        "\n  tr, footer { break-inside: avoid; }",
    ] {
        assert!(print.contains(rule), "{rule}");
    }
}

#[test]
fn extreme_numbers_still_give_a_page() {
    for factor in [1e-9, 0.0, 1e9] {
        parsed(&SampleLog::troubled(40.0).scaled(factor).page());
    }
    let mut log = SampleLog::troubled(40.0);
    for event in &mut log.result.events.kept {
        event.loading_rate_n_per_s = 0.0;
        event.omega_rad_per_s = Some(1e-30);
        event.slip_s = 0.0;
        event.stop_s = event.onset_s;
        event.mu_std = Some(0.0);
        event.mu_s_std = None;
    }
    let page = log.page();
    parsed(&page);
    assert!(!without_program(&page).contains("NaN"));
    let mut far = Recorder::new(2000.0);
    let times = log.times_s.iter().zip(&log.steps);
    times.for_each(|(t, step)| far.push(1.7e9 + t / 125.0, step));
    parsed(&super::render(&log.result, &far, &Provenance::default()));
}
