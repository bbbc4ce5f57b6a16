//! Where a report comes from: enough to make it again.

use super::svg::escape;

/// What a reviewer needs to make the same report.
#[derive(Clone, Debug, Default)]
pub struct Provenance {
    /// The command as it was given.
    pub command: String,
    /// The commit that the program was built from, where the build knew it.
    pub commit: Option<&'static str>,
    /// SHA-256 of the log, where it was read to its end.
    pub sha256: Option<String>,
    /// When the report was made, ISO 8601.
    pub made_at: Option<String>,
}

impl Provenance {
    /// The lines of the page's foot.
    pub(super) fn html(&self) -> String {
        let line = |name: &str, value: Option<&str>| {
            let value = value.filter(|value| !value.is_empty());
            value.map_or_else(String::new, |value| {
                format!("<div><dt>{name}</dt><dd class=\"path\">{}</dd></div>", escape(value))
            })
        };
        let lines = [
            line("Command", Some(&self.command)),
            line("Commit", self.commit),
            line("SHA-256 of the log", self.sha256.as_deref()),
            line("Made at", self.made_at.as_deref()),
        ];
        format!("<dl class=\"provenance\">{}</dl>", lines.concat())
    }
}
