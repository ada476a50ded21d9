//! Prints the random model of a seed, as the tests draw it.

fn main() {
    let seed = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(0);
    match handc_tests::random::model(&format!("random_{seed}"), seed) {
        Some(text) => print!("{text}"),
        None => eprintln!("the loops of seed {seed} do not close"),
    }
}
