//! A fault in the text of a scene, in words.

/// What the reader of the text calls a kind of value, and what it is called here.
const KINDS: [(&str, &str); 4] = [
    ("f64", "a number"),
    ("u32", "a whole number"),
    ("i32", "a whole number"),
    ("a boolean", "true or false"),
];

/// One line with the fault and its place.
pub(super) fn in_words(error: &toml::de::Error, text: &str) -> String {
    let message = error.message().replace('\n', " ");
    let Some(before) = error.span().filter(|span| span.end > 0).and_then(|it| text.get(..it.start))
    else {
        return message;
    };
    let number = before.matches('\n').count() + 1;
    let kinds = message.strip_prefix("invalid type: ").and_then(|it| it.split_once(", expected "));
    match (kinds, key(before)) {
        (Some((found, wanted)), Some(key)) => {
            format!("line {number}: {key} must be {}, not {found}", kind(wanted))
        }
        _ => format!("line {number}: {message}"),
    }
}

/// The key whose value follows this text.
fn key(before: &str) -> Option<&str> {
    let assigned = before.trim_end_matches([' ', '\t']).strip_suffix('=')?.trim_end();
    assigned.rsplit([' ', '\t', '\n', '{', ',']).next().filter(|key| !key.is_empty())
}

fn kind(wanted: &str) -> &str {
    let known = KINDS.iter().find(|(theirs, _)| *theirs == wanted);
    let table = wanted.starts_with("struct ").then_some("a table of its keys");
    known.map(|(_, ours)| *ours).or(table).unwrap_or(wanted)
}

#[cfg(test)]
mod tests {
    use super::super::Scene;

    fn refused(with: &str) -> String {
        let whole = "weight_n = 630\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000\n";
        Scene::from_toml(&(whole.to_owned() + with)).unwrap_err().to_string()
    }

    #[test]
    fn a_value_of_another_kind_is_named_with_its_key() {
        for (with, said) in [
            ("winch_m_per_s = \"fast\"", "winch_m_per_s must be a number, not string \"fast\""),
            ("post = 1", "post must be true or false, not integer `1`"),
            (
                "start = { year = 1994, day = 1.5 }",
                "day must be a whole number, not floating point `1.5`",
            ),
            (
                "measurement.flop.hz = true",
                "measurement.flop.hz must be a number, not boolean `true`",
            ),
            ("sag = 0.9", "sag must be a table of its keys, not floating point `0.9`"),
        ] {
            assert_eq!(refused(with), format!("line 5: {said}"));
        }
    }

    #[test]
    fn a_number_of_hundreds_of_digits_is_short() {
        assert_eq!(
            refused("winch_m_per_s = -1e-300"),
            "winch_m_per_s = -1e-300: must be a number above zero"
        );
    }
}
