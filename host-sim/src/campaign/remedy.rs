//! What to do about a log in a campaign, which has a table `tests.csv` where a replay has options.

use crate::error::InputError;

use super::manifest::COLUMNS;

/// A problem with what helps here.
pub fn of_error(error: &InputError) -> InputError {
    InputError::new(of_text(&error.to_string()))
}

/// A sentence with what helps here: the column where it names an option that is one, and what to do
/// where it names another.
pub fn of_text(text: &str) -> String {
    let (mut said, mut columns, mut missing) = (String::new(), Vec::new(), Vec::new());
    for (place, part) in text.split("--").enumerate() {
        let end = part.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(part.len());
        let (option, rest) = part.split_at(end);
        let column = option.replace('-', "_");
        if place == 0 || option.is_empty() {
            said += if place == 0 { "" } else { "--" };
            said += part;
        } else if COLUMNS.contains(&column.as_str()) {
            said += &(column.clone() + rest);
            add(&mut columns, column);
        } else {
            said += &format!("--{part}");
            add(&mut missing, format!("--{option}"));
        }
    }
    if !columns.is_empty() {
        said += &format!(" ({} in tests.csv)", columns.join(", "));
    }
    if !missing.is_empty() {
        said += &format!(
            " (a campaign has no {}: correct the log; floe inspect shows what is recognised in it)",
            missing.join(", ")
        );
    }
    said
}

fn add(names: &mut Vec<String>, name: String) {
    if !names.contains(&name) {
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
