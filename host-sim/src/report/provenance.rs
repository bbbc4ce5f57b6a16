//! Origin of a report, for reproducing it.

use super::svg::escape;
use crate::replay::result::ReplayResult;
use crate::replay::table::effect;

/// The facts needed to reproduce a report.
#[derive(Clone, Debug, Default)]
pub struct Provenance {
    /// The command as it was given.
    pub command: String,
    /// The commit that the program was built from, where the build knew it.
    pub commit: Option<&'static str>,
    /// SHA-256 of the log, if it was read to its end.
    pub sha256: Option<String>,
    /// When the report was made, ISO 8601.
    pub made_at: Option<String>,
}

impl Provenance {
    /// The lines of the page's foot, with the effects looked for and found beyond the linear model.
    pub(super) fn html(&self, result: &ReplayResult) -> String {
        let line = |name: &str, value: Option<&str>| {
            let value = value.filter(|value| !value.is_empty());
            value.map_or_else(String::new, |value| {
                format!("<div><dt>{name}</dt><dd class=\"path\">{}</dd></div>", escape(value))
            })
        };
        let listed = |all: Vec<String>| match all.is_empty() {
            true => "none".to_string(),
            false => all.join(", "),
        };
        let sought = result.effects.iter().filter(|it| it.enabled);
        let sought = listed(sought.map(|it| it.name.to_string()).collect());
        let found = listed(result.effects_found().map(effect).collect());
        let lines = [
            line("Command", Some(&self.command)),
            line("Effects looked for", Some(&sought)),
            line("Effects found", Some(&found)),
            line("Commit", self.commit),
            line("SHA-256 of the log", self.sha256.as_deref()),
            line("Made at", self.made_at.as_deref()),
        ];
        format!("<dl class=\"provenance\">{}</dl>", lines.concat())
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;
    use crate::replay::result::{EffectSummary, ParameterSummary};

    #[test]
    fn what_was_looked_for_and_found_is_said() {
        let effect = |name, found| EffectSummary { name, enabled: true, found, parameters: vec![] };
        let missing = ParameterSummary { name: "missing_n", value: 20.696, std: 0.578 };
        let corner = EffectSummary { parameters: vec![missing], ..effect("corner", true) };
        let mut result = SampleLog::dff8_13(20.0).result;
        result.effects = vec![corner, effect("sag", false)];
        let html = Provenance::default().html(&result);
        assert!(html.contains("<dt>Effects looked for</dt><dd class=\"path\">corner, sag</dd>"));
        assert!(html.contains("<dd class=\"path\">corner missing_n 20.70 ± 0.58</dd>"), "{html}");
        result.estimate.events = 0;
        let html = Provenance::default().html(&result);
        assert!(html.contains("<dt>Effects found</dt><dd class=\"path\">none</dd>"), "{html}");
    }
}
