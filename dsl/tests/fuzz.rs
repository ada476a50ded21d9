//! Whatever is done to a model, the checker answers.

use handc_dsl::format::format_text;
use handc_dsl::{check_text, diagnostic::render};

/// A small generator with a fixed seed: the same texts on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit.max(1) as u64) as usize
    }
}

const PIECES: [&str; 40] = [
    "{",
    "}",
    "(",
    ")",
    ";",
    ",",
    "=",
    "->",
    "@",
    "^",
    "-",
    "/",
    "*",
    "..",
    "1e999",
    "0",
    "mm",
    "in",
    "at",
    "rotate",
    "joint",
    "place",
    "base",
    "world",
    "t",
    "lambda.",
    "\"",
    "/*",
    "*/",
    "//",
    "\n",
    "é",
    "\u{0}",
    "if(",
    "const a = a;",
    "model",
    "scenario s {",
    "x",
    "import \"a\";",
    "9999999999",
];

#[track_caller]
fn survives(text: &str) {
    let checked = check_text("fuzz.hdl", text);
    let said = render(&checked.diagnostics, &checked.sources, false);
    assert_eq!(checked.model.is_none(), checked.diagnostics.iter().any(|d| d.is_error()), "{said}");
    if let Ok(once) = format_text(text) {
        assert_eq!(format_text(&once).as_ref(), Ok(&once), "{text}");
    }
}

/// Nearest place at or before an offset where a text may be cut.
fn cut(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[test]
fn mutated_models_never_panic() {
    let sources = [include_str!("good/language.hdl"), include_str!("good/everything.hdl")];
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for round in 0..1500 {
        let mut text = sources[round % sources.len()].to_string();
        for _ in 0..=random.below(4) {
            let a = cut(&text, random.below(text.len() + 1));
            let b = cut(&text, (a + random.below(40)).min(text.len()));
            match random.below(4) {
                0 => text.replace_range(a..b, ""),
                1 => text.insert_str(a, PIECES[random.below(PIECES.len())]),
                2 => text.replace_range(a..b, PIECES[random.below(PIECES.len())]),
                _ => {
                    let copy = text[a..b].to_string();
                    let at = cut(&text, random.below(text.len() + 1));
                    text.insert_str(at, &copy);
                }
            }
        }
        survives(&text);
    }
}

#[test]
fn large_and_odd_texts_are_answered() {
    let many = |piece: &str, bytes: usize| piece.repeat(bytes / piece.len());
    for text in [
        many("(", 1 << 17),
        many("{", 1 << 17),
        many("}", 1 << 17),
        many("-", 1 << 17),
        many("// c\n", 1 << 17),
        many("é\u{0}", 1 << 17),
        many(";", 1 << 17),
        many("a ", 1 << 17),
        many("joint ", 1 << 17),
        many("joint\n", 1 << 16),
        many("x =\n", 1 << 16),
        many("1,", 1 << 17),
        many("model m {", 1 << 17),
        format!("model m {{ {} }}", many("const a = b;\n", 1 << 16)),
        format!("model m {{ const a = (1{}); }}", many(",1", 1 << 16)),
        format!("model m {{ const a = 1{}; }}", many("^1", 1 << 16)),
        format!("model m {{ const a = {}1; }}", many("-", 390)),
        format!("model m {{ const a = 1{}; }}", many(" + 1", 1500)),
        format!("model m {{ joint a: revolute(z) in world {{ {} }} }}", many("q = 1\n", 1 << 16)),
        many("\"", 1 << 17),
        "x".repeat(10 << 20),
    ] {
        survives(&text);
    }
}

#[test]
fn chains_and_explosions_are_bounded() {
    // Each constant needs the next one.
    let chain: String = (0..5000).map(|i| format!("const c{i} = c{} + 1;\n", i + 1)).collect();
    survives(&format!("model m {{ {chain} const c5000 = 1; }}"));
    // Every frame stands in the next one.
    let frames: String = (0..5000).map(|i| format!("frame f{i} in f{};\n", i + 1)).collect();
    survives(&format!("model m {{ {frames} frame f5000 in world; }}"));
    // Every component places the next one twice.
    let twice: String = (0..40)
        .map(|i| {
            format!(
                "component C{i} {{ place C{0}() as a in base; place C{0}() as b in base; }}\n",
                i + 1
            )
        })
        .collect();
    survives(&format!("{twice} component C40 {{ }} model m {{ place C0() as a in world; }}"));
    // Every constant of an open argument doubles.
    let constants: String = (0..60).map(|i| format!("const c{} = c{i} + c{i};\n", i + 1)).collect();
    survives(&format!(
        "component C(x: Length) {{ const c0 = x; {constants} frame f in base at (c60, 0, 0); }} \
         model m {{ param p = 1 m; place C(x = p) as c in world; }}"
    ));
    // Every argument doubles.
    let doubled: String = (0..60)
        .map(|i| {
            format!("component D{i}(x: Length) {{ place D{}(x = x + x) as d in base; }}\n", i + 1)
        })
        .collect();
    survives(&format!(
        "{doubled} component D60(x: Length) {{ frame f in base at (x, 0, 0); }} \
         model m {{ param p = 1 m; place D0(x = p) as d in world; }}"
    ));
}
