//! The page around the figures.

use super::closer::data;
use super::context::Context;
use super::convergence::convergence;
use super::correlation::correlation;
use super::figure::Figure;
use super::history::history;
use super::number::{fixed, quantity};
use super::phase_plane::phase_plane;
use super::policy::policy;
use super::provenance::Provenance;
use super::residuals::residuals;
use super::summary::summary;
use super::svg::escape;
use super::table::table;
use super::zoom::zoom;
use crate::replay::result::ReplayResult;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// The whole document. It is well-formed XML too.
pub(super) fn page(context: &Context<'_>, provenance: &Provenance) -> String {
    let result = context.result;
    let name = escape(&name(result));
    let body = format!(
        "<header><p class=\"kind\">Sliding friction of a block pulled over ice</p>\
         <h1>{name}</h1>{}<p class=\"test\">{}</p></header>\n<main>{}{}{}</main>\n{}{}",
        simulated(result.log.synthetic.as_deref()),
        test_line(result),
        summary(result),
        figures(context),
        table(context),
        footer(result, provenance),
        data(context),
    );
    document(&name, "", &body)
}

/// An HTML page with the common style, additional style `more`, and the common script; name and
/// body are safe.
pub(super) fn document(name: &str, more: &str, body: &str) -> String {
    let script = format!("\n{SCRIPT}");
    let policy = policy(&script);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>{policy}\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <meta name=\"color-scheme\" content=\"light dark\"/>\
         <title>{name} – sliding friction</title>\n<style>\n{STYLE}{more}</style></head>\n\
         <body>{body}<script>{script}</script></body></html>\n"
    )
}

/// The notice above a result that was simulated.
pub(super) fn simulated(said: Option<&str>) -> String {
    said.map_or_else(String::new, |said| {
        format!("<p class=\"simulated\"><b>SIMULATED</b> {}</p>", escape(said))
    })
}

/// Name of the test, else of the file.
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
    let block = match result.test.mass_kg {
        Some(mass_kg) => {
            let mass = quantity(mass_kg, "kg");
            format!("under the ice: normal force {weight}, mass {mass}")
        }
        None => format!("block weight {weight} · {slope}"),
    };
    format!("{block} · <span class=\"path\">{}</span>", escape(&result.log.path))
}

/// The figures for which there are data.
fn drawn(context: &Context<'_>) -> Vec<Figure> {
    let focus = context.focus();
    let focus = focus.as_ref();
    let figures = [
        history(context, focus),
        focus.map(|focus| zoom(context, focus)),
        phase_plane(context, focus),
        convergence(context),
        residuals(context),
        correlation(context),
    ];
    figures.into_iter().flatten().collect()
}

fn figures(context: &Context<'_>) -> String {
    let figures = drawn(context);
    let drawn: String = figures.iter().enumerate().map(|(i, f)| f.html(i + 1)).collect();
    match drawn.is_empty() {
        true => "<p class=\"notice\">The log holds no usable sample: there is nothing to draw.</p>"
            .into(),
        false => format!("<section class=\"figures\">\n{drawn}</section>\n"),
    }
}

/// The drawings for a wide page, each a complete SVG file with its style.
pub(super) fn drawings(context: &Context<'_>) -> Vec<(String, String)> {
    let figures = drawn(context);
    let wide = figures.iter().flat_map(|figure| &figure.drawings).filter_map(|[svg, _]| {
        let name = svg.split_once("id=\"")?.1.split_once('"')?.0.trim_end_matches("-wide");
        let (head, body) = svg.split_once('>')?;
        let head = head.replacen("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ", 1);
        Some((format!("{name}.svg"), format!("{head}><style>{STYLE}</style>{body}\n")))
    });
    wide.collect()
}

fn footer(result: &ReplayResult, provenance: &Provenance) -> String {
    format!(
        "<footer><p>With <i>α</i> the slope and <i>Mg</i> the weight: <i>μ</i><sub>s</sub> = \
         (<i>F</i><sub>s</sub>/<i>Mg</i> − sin <i>α</i>)/cos <i>α</i>, and <i>μ</i> likewise from \
         <i>F</i><sub>p</sub>, the centre of the ellipse. Method: Pritchard, Knoke and Echert, \
         Cold Regions Science and Technology 76–77 (2012) 8–16.</p>\
         <p>Made by <b>floe {}</b> from <span class=\"path\">{}</span> (format {}).</p>{}</footer>\n",
        env!("CARGO_PKG_VERSION"),
        escape(&result.log.path),
        escape(&result.log.format),
        provenance.html(result),
    )
}
