//! Advice for logs in a campaign, where the table `tests.csv` takes the place of a replay's
//! options.

use crate::error::InputError;

use super::manifest::COLUMNS;

/// A problem, with advice for a campaign.
pub fn of_error(error: &InputError) -> InputError {
    InputError::new(of_text(&error.to_string()))
}

/// A sentence with advice for a campaign: an option such as `--weight-n` is replaced by the column
/// if there is one, or by what to do instead.
pub fn of_text(text: &str) -> String {
    let mut pieces = text.split("--");
    let mut said = pieces.next().unwrap_or_default().to_string();
    let (mut columns, mut missing) = (Vec::new(), Vec::new());
    for piece in pieces {
        let end = piece.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(piece.len());
        let (option, rest) = piece.split_at(end);
        if let Some(column) = COLUMNS.into_iter().find(|it| it.replace('_', "-") == option) {
            said += &format!("{column}{rest}");
            add(&mut columns, column);
        } else {
            said += &format!("--{piece}");
            add(&mut missing, option);
        }
    }
    if !columns.is_empty() {
        said += &format!(" ({} in tests.csv)", columns.join(", "));
    }
    if !missing.is_empty() {
        said += &format!(
            " (a campaign has no --{}: correct the log; floe inspect shows what is recognised in it)",
            missing.join(", --")
        );
    }
    said
}

fn add<'a>(names: &mut Vec<&'a str>, name: &'a str) {
    if !name.is_empty() && !names.contains(&name) {
        names.push(name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remedy_is_one_that_a_campaign_has() {
        assert_eq!(of_text("is empty -- all of it"), "is empty -- all of it");
        assert_eq!(
            of_text("give --weight-n W or --mass-kg M, or put '# weight_n: W' into the log"),
            "give weight_n W or mass_kg M, or put '# weight_n: W' into the log \
             (weight_n, mass_kg in tests.csv)"
        );
        let said = of_text("give --time-column NAME, or --rate-hz R; name it, e.g. --column 3");
        assert_eq!(
            said,
            "give --time-column NAME, or --rate-hz R; name it, e.g. column 3 (column in tests.csv) \
             (a campaign has no --time-column, --rate-hz: correct the log; floe inspect shows what \
             is recognised in it)"
        );
    }
}
