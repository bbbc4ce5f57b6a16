//! Long lists of sentences, cut short so that a result that follows is still in view.

/// Sentences of a list that are printed.
const SHOWN: usize = 10;

/// The sentences about the first items, then one line with the number of the others.
pub fn abridged<T>(all: &[T], sentence: impl Fn(&T) -> String) -> impl Iterator<Item = String> {
    let more = all.len().saturating_sub(SHOWN);
    let rest = (more > 0).then(|| format!("and {more} more; floe replay --json lists them all"));
    all.iter().take(SHOWN).map(sentence).chain(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_list_ends_with_how_many_more_there_are() {
        let said = |count: usize| -> Vec<String> {
            abridged(&vec![2.5; count], |it| format!("{it} s")).collect()
        };
        assert_eq!(said(SHOWN), vec!["2.5 s"; SHOWN]);
        let long = said(SHOWN + 381);
        assert_eq!(long.len(), SHOWN + 1);
        assert_eq!(long[SHOWN], "and 381 more; floe replay --json lists them all");
    }
}
