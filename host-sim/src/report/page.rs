//! The page around the figures.

use super::context::Context;
use super::convergence::convergence;
use super::history::history;
use super::number::{fixed, quantity};
use super::phase_plane::phase_plane;
use super::policy::policy;
use super::summary::summary;
use super::svg::escape;
use super::table::table;
use super::zoom::zoom;
use crate::replay::result::ReplayResult;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// The whole document. It is well-formed XML too.
pub(super) fn page(context: &Context<'_>) -> String {
    let result = context.result;
    let name = escape(&name(result));
    let script = format!("\n{SCRIPT}");
    let policy = policy(&script);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>{policy}\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <meta name=\"color-scheme\" content=\"light dark\"/>\
         <title>{name} – sliding friction</title>\n<style>\n{STYLE}</style></head>\n<body>\
         <header><p class=\"kind\">Sliding friction of a block pulled over ice</p>\
         <h1>{name}</h1><p class=\"test\">{}</p></header>\n<main>{}{}{}</main>\n{}\
         <script>{script}</script></body></html>\n",
        test_line(result),
        summary(result),
        figures(context),
        table(context),
        footer(result),
    )
}

/// The test, or the file.
fn name(result: &ReplayResult) -> String {
    let id = result.test.test_id.as_deref().filter(|id| !id.trim().is_empty());
    id.map_or_else(|| file_name(&result.log.path).to_owned(), |id| format!("Test {id}"))
}

fn file_name(path: &str) -> &str {
    let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
    if name == "-" { "standard input" } else { name }
}

fn test_line(result: &ReplayResult) -> String {
    let degrees = result.test.slope_rad.to_degrees();
    let slope =
        if degrees == 0.0 { "level ice".into() } else { format!("slope {}°", fixed(degrees, 2)) };
    let weight = quantity(result.test.weight_n, "N");
    format!(
        "block weight {weight} · {slope} · <span class=\"path\">{}</span>",
        escape(&result.log.path)
    )
}

fn figures(context: &Context<'_>) -> String {
    let focus = context.focus();
    let focus = focus.as_ref();
    let figures = [
        history(context, focus),
        focus.map(|focus| zoom(context, focus)),
        phase_plane(context, focus),
        convergence(context),
    ];
    let drawn = figures.iter().flatten().enumerate();
    let drawn: String = drawn.map(|(i, figure)| figure.html(i + 1)).collect();
    match drawn.is_empty() {
        true => "<p class=\"notice\">The log holds no usable sample: there is nothing to draw.</p>"
            .into(),
        false => format!("<section class=\"figures\">\n{drawn}</section>\n"),
    }
}

fn footer(result: &ReplayResult) -> String {
    format!(
        "<footer><p>With <i>α</i> the slope and <i>Mg</i> the weight: <i>μ</i><sub>s</sub> = \
         (<i>F</i><sub>s</sub>/<i>Mg</i> − sin <i>α</i>)/cos <i>α</i>, and <i>μ</i> likewise from \
         <i>F</i><sub>p</sub>, the centre of the ellipse. Method: Pritchard, Knoke and Echert, \
         Cold Regions Science and Technology 76–77 (2012) 8–16.</p>\
         <p>Made by <b>floe {}</b> from <span class=\"path\">{}</span> (format {}).</p></footer>\n",
        env!("CARGO_PKG_VERSION"),
        escape(&result.log.path),
        escape(&result.log.format),
    )
}
