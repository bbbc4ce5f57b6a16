//! The report of a campaign: coefficients against weight, pull rate and snow.

use crate::campaign::TestRecord;
use crate::campaign::summary::{
    GroupMeans, NamedTrend, Summary, of_group, of_test, published, systematic,
};
use crate::campaign::trend::{Against, Coefficient, Group, points};
use crate::rounding::{counted, decimals, plus_minus};

use super::figure::{Figure, both, dot_key, line_key};
use super::number::fixed;
use super::page::{document, simulated};
use super::plot::{Axis, Layout, Plot, Spec};
use super::scale::{Steps, extent};
use super::svg::{self, Path, escape};

const TREND_STYLE: &str = ".trend { stroke: var(--tone); stroke-width: 2; }\n\
    .rist { stroke: var(--ink); stroke-width: 1.5; stroke-dasharray: 5 4; }\n\
    main td:last-child, main th:last-child { text-align: right; white-space: nowrap; min-width: 0; }\n";

/// Largest number of points in a plot.
const MOST_POINTS: usize = 2000;

/// Groups that are drawn, each with its CSS class.
const DRAWN: [(Group, &str); 2] = [(Group::NoSnow, "dynamic"), (Group::Snow, "static")];

/// The page for the tests and the summary of a campaign.
#[must_use]
pub fn render_campaign(summary: &Summary, tests: &[TestRecord]) -> String {
    let figures: String =
        figures(summary, tests).iter().enumerate().map(|(i, f)| f.html(i + 1)).collect();
    let body = format!(
        "<header><p class=\"kind\">Campaign</p><h1>{}, {}</h1>{}</header>\n\
         <main><section>{}{}</section><section class=\"figures\">\n{figures}</section>{}</main>\n\
         <footer><p>Lines by least squares with the band of one standard error, from the \
         scatter between tests. Made by <b>floe {}</b>{}.</p></footer>\n",
        counted(summary.tests as u64, "test"),
        counted(summary.events, "event"),
        simulated(summary.simulated().as_deref()),
        groups(&summary.groups),
        notices(summary),
        list(&summary.records),
        env!("CARGO_PKG_VERSION"),
        summary.seed.map(|seed| format!(", seed {seed}")).unwrap_or_default(),
    );
    document("Campaign", TREND_STYLE, &body)
}

/// The text with a typographic minus sign; a dash for no value.
fn minus(text: &str) -> String {
    if text == "-" { "–".to_owned() } else { text.replace('-', "\u{2212}") }
}

fn groups(groups: &[GroupMeans]) -> String {
    let row = |g: &GroupMeans| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{}</td></tr>",
            g.group.name(),
            g.tests(),
            minus(&of_group(g.mu_s)),
            minus(&systematic(g.mu_s_systematic_std)),
            minus(&published(g.published_mu_s)),
            minus(&of_group(g.mu)),
            minus(&systematic(g.mu_systematic_std)),
            minus(&published(g.published_mu)),
        )
    };
    let rows: String = groups.iter().map(row).collect();
    format!(
        "<h2>Means of the groups</h2><div class=\"scroll\"><table><thead><tr><th>group</th>\
         <th>tests</th><th><i>μ</i><sub>s</sub></th><th>systematic</th><th>published</th>\
         <th><i>μ</i></th><th>systematic</th><th>published</th></tr></thead>\
         <tbody>{rows}</tbody></table></div><p>±: standard error from the scatter between tests \
         alone. Systematic: the mean of the tests' systematic parts, which tests with one instrument \
         may have in common and no number of them averages out.</p>"
    )
}

/// Logs that were left out, and what is doubtful about the others.
fn notices(summary: &Summary) -> String {
    let left_out = summary.left_out.iter().map(|log| format!("left out: {log}"));
    let all = left_out.chain(summary.records.iter().flat_map(TestRecord::doubts));
    let items: String = all.map(|it| format!("<li>{}</li>", escape(&it))).collect();
    if items.is_empty() { items } else { format!("<ul class=\"notice\">{items}</ul>") }
}

fn list(tests: &[TestRecord]) -> String {
    if tests.is_empty() {
        return String::new();
    }
    let known = |x: Option<f64>, decimals| x.map_or("–".to_owned(), |x| fixed(x, decimals));
    let row = |t: &TestRecord| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{}</td></tr>",
            escape(&t.test_id),
            fixed(t.weight_n, decimals(t.weight_n)),
            known(t.winch_m_per_s.map(|w| w * 1e3), 1),
            known(t.snow_mm, 1),
            t.event_count,
            minus(&of_test(&t.mu_s)),
            minus(&of_test(&t.mu)),
        )
    };
    let rows: String = tests.iter().map(row).collect();
    format!(
        "<section><h2>Tests</h2><p>±: one standard deviation, all that is \
         known of it.</p><div class=\"scroll\"><table><thead><tr><th>test</th>\
         <th>weight<small>N</small></th><th>pull<small>mm/s</small></th>\
         <th>snow<small>mm</small></th><th>events</th>\
         <th><i>μ</i><sub>s</sub></th><th><i>μ</i></th></tr></thead>\
         <tbody>{rows}</tbody></table></div></section>"
    )
}

fn figures(summary: &Summary, tests: &[TestRecord]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for against in Against::ALL {
        for coefficient in Coefficient::ALL {
            let panel = Panel { summary, tests, against, coefficient };
            figures.extend(panel.figure());
        }
    }
    figures
}

/// One plot.
struct Panel<'a> {
    summary: &'a Summary,
    tests: &'a [TestRecord],
    against: Against,
    coefficient: Coefficient,
}

impl Panel<'_> {
    fn points(&self, group: Group) -> Vec<(f64, f64)> {
        points(self.tests, group, self.against, self.coefficient)
    }

    /// The points of the tests that do not say whether there was snow.
    fn untold(&self) -> Vec<(f64, f64)> {
        let untold = self.tests.iter().filter(|test| test.has_snow().is_none());
        untold
            .filter_map(|test| Some((self.against.of(test)?, self.coefficient.of(test)?)))
            .collect()
    }

    fn trend(&self, group: Group) -> Option<&NamedTrend> {
        self.summary.trends.iter().find(|t| {
            t.group == group && t.against == self.against && t.coefficient == self.coefficient
        })
    }

    /// The lines of both groups; one line through all tests against snow, and where the snow is not
    /// known.
    fn lines(&self) -> Vec<(&NamedTrend, &'static str)> {
        let own = DRAWN.iter().filter_map(|&(g, tone)| Some((self.trend(g)?, tone)));
        let own: Vec<_> = own.collect();
        if !own.is_empty() {
            return own;
        }
        self.trend(Group::All).map(|t| (t, "static")).into_iter().collect()
    }

    fn figure(&self) -> Option<Figure> {
        if self.points(Group::All).is_empty() {
            return None;
        }
        let mut keys: Vec<String> = DRAWN
            .iter()
            .filter(|(group, _)| !self.points(*group).is_empty())
            .map(|(group, tone)| dot_key(&format!("event {tone}"), group.name()))
            .collect();
        if !self.untold().is_empty() {
            keys.push(dot_key("event unknown", "snow not known"));
        }
        if !self.lines().is_empty() {
            keys.push(line_key("mean", "line by least squares, ± one standard error"));
        }
        if self.against == Against::WeightKn {
            keys.push(line_key("rist", "Rist (1997): proportional to weight^(-1/3)"));
        }
        Some(Figure {
            class: "trend-figure",
            drawings: vec![both(|layout| self.draw(layout))],
            keys,
            caption: self.caption(),
        })
    }

    fn caption(&self) -> String {
        let (_, unit) = self.against.name();
        let slope = |(t, _): &(&NamedTrend, &str)| {
            let slope = minus(&plus_minus(t.trend.slope, t.trend.slope_std_error));
            format!("{} {slope} per {unit}", t.group.name())
        };
        let slopes: Vec<String> = self.lines().iter().map(slope).collect();
        match slopes.as_slice() {
            [] => self.title(),
            some => format!("{} Slope: {}.", self.title(), some.join("; ")),
        }
    }

    fn title(&self) -> String {
        let kind = match self.coefficient {
            Coefficient::MuS => "Static",
            Coefficient::Mu => "Dynamic",
        };
        format!("{kind} coefficient against {}.", self.against.name().0)
    }

    fn draw(&self, layout: Layout) -> String {
        let (title, id) = (self.title(), self.id());
        let mut plot = Plot::new(&self.spec(layout, &title, &id));
        for (trend, tone) in self.lines() {
            let (low, high) = extent(self.points(trend.group).iter().map(|p| p.0), 0.02);
            let at = |i: i32| low + (high - low) * f64::from(i) / 40.0;
            let edge = |i: i32, side: f64| {
                let (value, error) = trend.trend.at(at(i));
                plot.at((at(i), value + side * error))
            };
            let outline =
                (0..=40).map(|i| edge(i, 1.0)).chain((0..=40).rev().map(|i| edge(i, -1.0)));
            let mut band = Path::line(outline);
            band.close();
            plot.draw(&band.element(&format!("band-1 {tone}")));
            let ends = [low, high].map(|x| (x, trend.trend.at(x).0));
            plot.line(&format!("trend {tone}"), ends);
        }
        if self.against == Against::WeightKn {
            self.draw_rist(&mut plot);
        }
        self.draw_points(&mut plot);
        plot.finish()
    }

    /// Rist (1997): shear force proportional to `N^(2/3)`, hence a coefficient proportional to
    /// `N^(-1/3)`, drawn through the mean of all tests.
    fn draw_rist(&self, plot: &mut Plot) {
        let points = self.points(Group::All);
        let sum: f64 = points.iter().map(|(weight, value)| value * weight.cbrt()).sum();
        let factor = sum / points.len().max(1) as f64;
        let (low, high) = extent(points.iter().map(|p| p.0), 0.02);
        if low > 0.0 && high > low {
            let at = |i: i32| low + (high - low) * f64::from(i) / 40.0;
            plot.line("rist", (0..=40).map(|i| (at(i), factor / at(i).cbrt())));
        }
    }

    fn draw_points(&self, plot: &mut Plot) {
        plot.dots("event unknown", self.untold().into_iter().take(MOST_POINTS));
        for (group, tone) in DRAWN {
            let points = self.points(group);
            plot.dots(&format!("event {tone}"), points.into_iter().take(MOST_POINTS));
        }
    }

    fn id(&self) -> String {
        let against = match self.against {
            Against::WeightKn => "weight",
            Against::PullMmPerS => "pull",
            Against::SnowMm => "snow",
            Against::HoldDecades => "hold",
        };
        format!("{against}-{}", self.coefficient.name().replace('_', "-"))
    }

    fn spec<'s>(&self, layout: Layout, title: &'s str, id: &'s str) -> Spec<'s> {
        let (name, unit) = self.against.name();
        let all = self.points(Group::All);
        let (symbol, subscript) = match self.coefficient {
            Coefficient::Mu => ("μ", ""),
            Coefficient::MuS => ("μs", "s"),
        };
        let (low, high) = extent(all.iter().map(|p| p.1), 0.08);
        // The margin does not reach below zero where no value does.
        let low = if all.iter().all(|p| p.1 >= 0.0) { low.max(0.0) } else { low };
        Spec {
            id,
            layout,
            size: layout.pick((570.0, 300.0), (360.0, 240.0)),
            title,
            description: "One point a test, with straight lines and their bands.",
            x: Axis {
                domain: extent(all.iter().map(|p| p.0), 0.06),
                steps: Steps::Decimal,
                label: format!("{name} ({unit})"),
                readout: (name, unit.to_owned()),
            },
            y: Axis {
                domain: (low, high),
                steps: Steps::Decimal,
                label: svg::symbol("μ", subscript),
                readout: (symbol, String::new()),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::programme;

    #[test]
    fn a_coefficient_below_zero_is_on_the_paper() {
        let mut tests: Vec<_> = (0..4).map(|i| programme::evaluate(1, 0, i).unwrap()).collect();
        tests.iter_mut().for_each(|test| test.mu.mean = test.mu.mean.map(|mean| mean - 0.7));
        let summary = Summary::new(&tests, 0, None);
        let (against, coefficient) = (Against::WeightKn, Coefficient::Mu);
        let panel = Panel { summary: &summary, tests: &tests, against, coefficient };
        let plot = Plot::new(&panel.spec(Layout::Wide, "", ""));
        assert!(panel.points(Group::All).into_iter().all(|point| plot.contains(point)));
    }

    /// A test on bare ice is drawn as one, whatever the others do not say.
    #[test]
    fn points_have_the_colour_of_their_key() {
        let mut tests: Vec<_> = (0..4).map(|i| programme::evaluate(1, 0, i).unwrap()).collect();
        tests[0].snow_mm = None;
        let summary = Summary::new(&tests, 0, None);
        let page = render_campaign(&summary, &tests);
        let (_, figure) = page.split_once("id=\"weight-mu-wide\"").unwrap();
        let (drawing, rest) = figure.split_once("</svg>").unwrap();
        let keys =
            rest.split_once("class=\"keys\"").unwrap().1.split_once("<figcaption").unwrap().0;
        for (class, name, dots) in [
            ("event dynamic", "no snow", 2),
            ("event static", "snow", 1),
            ("event unknown", "snow not known", 1),
        ] {
            let path = format!("<path class=\"{class}\" d=\"");
            let drawn = drawing.split_once(&path).unwrap().1.split_once('"').unwrap().0;
            assert_eq!(drawn.matches('M').count(), dots, "{name}");
            assert!(
                keys.contains(&path) && keys.contains(&format!("<span>{name}</span>")),
                "{keys}"
            );
        }
    }
}
