//! The printer: as much on a line as fits.

use super::Data;

/// Columns of a line.
const WIDTH: usize = 100;

impl Data {
    /// The text of the expression, on lines that begin at column `indent`; so many columns are taken
    /// `before` it on the first and `after` it on the last.
    pub fn print(&self, indent: usize, [before, after]: [usize; 2]) -> String {
        let mut text = String::new();
        self.flat(&mut text);
        let (open, children, close) = match self.children() {
            Some(parts) if indent + before + text.len() + after > WIDTH => parts,
            _ => return text,
        };
        text.clear();
        text.push_str(&open);
        let inner = " ".repeat(indent + 4);
        for (label, child) in children {
            let child = child.print(indent + 4, [label.len(), 1]);
            text.push_str(&format!("\n{inner}{label}{child},"));
        }
        text.push_str(&format!("\n{}{close}", " ".repeat(indent)));
        text
    }

    /// All on one line.
    fn flat(&self, text: &mut String) {
        match self {
            Data::Plain(plain) => text.push_str(plain),
            Data::Text(string) if string.is_empty() => text.push_str("String::new()"),
            Data::Text(string) => text.push_str(&format!("{string:?}.into()")),
            Data::Option(None) => text.push_str("None"),
            _ => {
                let (open, children, close) = self.children().unwrap_or_default();
                text.push_str(&open);
                let spaced = close.ends_with('}') && !children.is_empty();
                for (i, (label, child)) in children.iter().enumerate() {
                    text.push_str(if i > 0 { ", " } else { [" ", ""][usize::from(!spaced)] });
                    text.push_str(label);
                    child.flat(text);
                }
                text.push_str([" ", ""][usize::from(!spaced)]);
                text.push_str(close);
            }
        }
    }

    /// What opens it, its labelled children and what closes it; `None` for what has none.
    #[allow(clippy::type_complexity)]
    fn children(&self) -> Option<(String, Vec<(String, &Data)>, &'static str)> {
        fn plain(items: &[Data]) -> Vec<(String, &Data)> {
            items.iter().map(|item| (String::new(), item)).collect()
        }
        Some(match self {
            Data::Plain(_) | Data::Text(_) | Data::Option(None) => return None,
            Data::Option(Some(inner)) => ("Some(".into(), vec![(String::new(), &**inner)], ")"),
            Data::List(items) => ("vec![".into(), plain(items), "]"),
            Data::Tuple(items) if is_array(items) => ("[".into(), plain(items), "]"),
            Data::Tuple(items) => ("(".into(), plain(items), ")"),
            Data::Call(name, items) if items.is_empty() => (name.clone(), Vec::new(), ""),
            Data::Call(name, items) => (format!("{name}("), plain(items), ")"),
            Data::Fields(name, fields) => {
                let fields = fields.iter().map(|(field, data)| (format!("{field}: "), data));
                (format!("{name} {{"), fields.collect(), "}")
            }
        })
    }
}

/// Whether all items are of one kind.
fn is_array(items: &[Data]) -> bool {
    let kind = |data: &Data| match data {
        Data::Plain(_) => 0,
        Data::Text(_) => 1,
        Data::Option(_) => 2,
        Data::List(_) => 3,
        Data::Tuple(_) => 4,
        Data::Fields(..) => 5,
        // Variants of one type with values and without.
        Data::Call(..) => 6,
    };
    !items.is_empty() && items.iter().all(|item| kind(item) == kind(&items[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Serialize;

    #[derive(Serialize)]
    enum Kind {
        Bare,
        One(f64),
        Two(u32, i32),
        Named { axis: [f64; 3] },
    }

    #[derive(Serialize)]
    struct Thing {
        name: String,
        kinds: Vec<Kind>,
        pairs: Vec<(u32, Kind)>,
        parent: Option<u32>,
        flag: bool,
    }

    #[test]
    fn values_become_the_expressions_that_make_them() {
        let thing = Thing {
            name: "a \"b\"".into(),
            kinds: vec![Kind::Bare, Kind::One(-0.05), Kind::Two(3, -1)],
            pairs: vec![(7, Kind::Named { axis: [0.0, 1.0, 1e-30] })],
            parent: Some(2),
            flag: true,
        };
        let expected = "\
Thing {
    name: \"a \\\"b\\\"\".into(),
    kinds: vec![Kind::Bare, Kind::One(-0.05), Kind::Two(3, -1)],
    pairs: vec![(7, Kind::Named { axis: [0.0, 1.0, 1e-30] })],
    parent: Some(2),
    flag: true,
}";
        assert_eq!(Data::of(&thing).print(0, [0, 0]), expected);
        assert_eq!(
            Data::of(&Kind::Two(1, 2)).print(90, [0, 0]),
            "Kind::Two(\n".to_owned()
                + &format!("{0}1,\n{0}2,\n{1})", " ".repeat(94), " ".repeat(90))
        );
        assert_eq!(Data::of(&String::new()).print(0, [0, 0]), "String::new()");
    }
}
