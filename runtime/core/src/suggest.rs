//! The nearest known name to one that is not known.

/// The nearest of the known names, if a third of its letters or fewer differ.
pub(crate) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (word.chars().count() / 3).max(1);
    known
        .map(|name| (edits(word, name), name))
        .filter(|&(edits, name)| edits <= limit && edits < name.chars().count())
        .min_by_key(|&(edits, _)| edits)
        .map(|(_, name)| name)
}

/// Letters to insert, delete or replace, whatever their case.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for letter in a.to_lowercase().chars() {
        let mut diagonal = row[0];
        row[0] += 1;
        for j in 1..=b.len() {
            let replaced = diagonal + usize::from(letter != b[j - 1]);
            diagonal = row[j];
            row[j] = replaced.min(row[j] + 1).min(row[j - 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_was_meant() {
        let known = || ["k_flexor", "k_extensor", "c"].into_iter();
        assert_eq!(nearest("k_flexr", known()), Some("k_flexor"));
        assert_eq!(nearest("K_Extensor", known()), Some("k_extensor"));
        assert_eq!(nearest("mass", known()), None);
        assert_eq!(nearest("x", known()), None);
        assert_eq!(nearest("", known()), None);
    }
}
