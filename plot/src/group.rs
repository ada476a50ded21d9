//! Groups of curves by the first part of their names, so that each digit gets its own panel.

use crate::palette::MOST;

/// Up to this many curves stay in one panel.
const FEW: usize = 6;

/// Curves of one panel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Group {
    /// First part of the names, or a range of numbers; empty for the only group.
    pub(crate) name: String,
    /// Index of the curve, and the rest of its name.
    pub(crate) curves: Vec<(usize, String)>,
}

/// Groups in order of first appearance.
pub(crate) fn groups(names: &[&str]) -> Vec<Group> {
    let whole = || names.iter().map(|n| n.to_string()).enumerate().collect::<Vec<_>>();
    if names.len() <= FEW {
        return vec![Group { name: String::new(), curves: whole() }];
    }
    let found = by_first_part(names);
    if found.len() < 2 || 2 * names.len() < 3 * found.len() {
        return pieces(Group { name: String::new(), curves: whole() });
    }
    found.into_iter().flat_map(pieces).collect()
}

fn by_first_part(names: &[&str]) -> Vec<Group> {
    let dotted = names.iter().any(|name| name.contains('.'));
    let separator = if dotted { '.' } else { '_' };
    // Names such as q_index_mcp share a first part that says nothing.
    let shared = names.first().and_then(|name| name.find('_')).map(|at| &names[0][..=at]);
    let shared = shared.filter(|s| !dotted && names.iter().all(|name| name.starts_with(*s)));
    let skip = shared.map_or(0, str::len);
    let mut found: Vec<Group> = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let (first, rest) = name[skip..].split_once(separator).unwrap_or(("", &name[skip..]));
        match found.iter_mut().find(|group| group.name == first) {
            Some(group) => group.curves.push((i, rest.to_string())),
            None => {
                found.push(Group { name: first.to_string(), curves: vec![(i, rest.to_string())] })
            }
        }
    }
    found
}

/// A group in pieces that one panel can show.
fn pieces(group: Group) -> Vec<Group> {
    if group.curves.len() <= MOST {
        return vec![group];
    }
    let count = group.curves.len().div_ceil(MOST);
    let each = group.curves.len().div_ceil(count);
    let piece = |(k, curves): (usize, &[(usize, String)])| Group {
        name: format!("{} ({}/{count})", group.name, k + 1).trim_start().to_string(),
        curves: curves.to_vec(),
    };
    group.curves.chunks(each).enumerate().map(piece).collect()
}

/// A line style per curve: curves of the same name look the same in all groups, and the curves of
/// one group differ.
pub(crate) fn styles(groups: &[Group], known: &mut Vec<(String, usize)>) -> Vec<Vec<usize>> {
    let style = |group: &Group, known: &mut Vec<(String, usize)>| {
        let known_style = |known: &[(String, usize)], name: &str| {
            known.iter().find(|(other, _)| other == name).map(|(_, style)| *style)
        };
        let mut taken: Vec<Option<usize>> = Vec::new();
        for (_, name) in &group.curves {
            let style = known_style(known, name).filter(|style| !taken.contains(&Some(*style)));
            taken.push(style);
        }
        for (k, (_, name)) in group.curves.iter().enumerate() {
            if taken[k].is_none() {
                let free = (0..).find(|style| !taken.contains(&Some(*style)));
                taken[k] = free;
                if let (Some(style), None) = (free, known_style(known, name)) {
                    known.push((name.clone(), style));
                }
            }
        }
        taken.into_iter().map(Option::unwrap_or_default).collect::<Vec<_>>()
    };
    groups.iter().map(|group| style(group, known)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(names: &[&str]) -> Vec<(String, usize)> {
        groups(names).into_iter().map(|g| (g.name, g.curves.len())).collect()
    }

    #[test]
    fn digits_become_groups() {
        let names =
            ["index.ab", "index.mcp", "index.pip", "thumb.ab", "thumb.cmc", "thumb.ip", "x"];
        assert_eq!(shape(&names), [("index".into(), 3), ("thumb".into(), 3), (String::new(), 1)]);
        assert_eq!(groups(&names)[1].curves[1], (4, "cmc".to_string()));
        let names = [
            "q_index_ab",
            "q_index_mcp",
            "q_index_pip",
            "q_thumb_ab",
            "q_thumb_b",
            "q_thumb_c",
            "q_thumb_d",
        ];
        assert_eq!(shape(&names), [("index".into(), 3), ("thumb".into(), 4)]);
    }

    #[test]
    fn few_curves_stay_together_and_many_are_split() {
        assert_eq!(shape(&["a.x", "b.x"]), [(String::new(), 2)]);
        let names: Vec<String> = (0..20).map(|i| format!("j{i}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        assert_eq!(shape(&names), [("(1/3)".into(), 7), ("(2/3)".into(), 7), ("(3/3)".into(), 6)]);
    }

    #[test]
    fn same_names_look_the_same() {
        let names = ["i.ab", "i.mcp", "i.pip", "i.dip", "t.ab", "t.cmc", "t.mcp", "t.ip"];
        let styles = styles(&groups(&names), &mut Vec::new());
        assert_eq!(styles, [vec![0, 1, 2, 3], vec![0, 2, 1, 3]]);
    }
}
