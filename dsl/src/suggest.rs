//! The nearest known name to one that is not known.

/// The nearest of the known names, if one is near enough to be meant.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (word.chars().count() / 3).clamp(1, 3);
    let mut best: Option<(usize, &str)> = None;
    for candidate in known {
        let distance = distance(word, candidate, limit);
        if let Some(distance) = distance
            && best.is_none_or(|b| distance < b.0)
        {
            best = Some((distance, candidate));
        }
    }
    best.map(|b| b.1)
}

/// Edits (insert, delete, replace, swap neighbours) between two words, if at most `limit`.
/// A difference in case alone counts as less than one edit.
fn distance(a: &str, b: &str, limit: usize) -> Option<usize> {
    if a == b || a.eq_ignore_ascii_case(b) {
        return Some(0);
    }
    let a: Vec<char> = a.chars().take(64).collect();
    let b: Vec<char> = b.chars().take(64).collect();
    if a.len().abs_diff(b.len()) > limit {
        return None;
    }
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let same = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (last[j - 1] + same).min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = last;
        last = row;
    }
    last.last().copied().filter(|&d| d <= limit && d < a.len().max(b.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_was_meant() {
        let known = ["damping", "stiffness", "limits", "pip", "dip"];
        assert_eq!(nearest("dampign", known), Some("damping"));
        assert_eq!(nearest("pjp", known), Some("pip"));
        assert_eq!(nearest("PIP", known), Some("pip"));
        assert_eq!(nearest("elbow", known), None);
        assert_eq!(nearest("x", ["y"]), None);
    }
}
