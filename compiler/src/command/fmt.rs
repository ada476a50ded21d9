//! `handc fmt`: one layout for all model files.

use handc_dsl::source::SourceMap;
use std::path::PathBuf;

/// Formats files in place, or only checks that they are formatted.
pub fn fmt(files: &[PathBuf], check: bool) -> u8 {
    let mut code = 0;
    for file in files {
        let text = match handc_dsl::read_text(file) {
            Ok(text) => text,
            Err(message) => {
                eprintln!("error: {message}");
                code = code.max(2);
                continue;
            }
        };
        match handc_dsl::format::format_text(&text) {
            Ok(formatted) if formatted == text => {}
            Ok(_) if check => {
                eprintln!("{} is not formatted", file.display());
                code = code.max(1);
            }
            Ok(formatted) => {
                if let Err(error) = std::fs::write(file, formatted) {
                    eprintln!("error: cannot write `{}`: {error}", file.display());
                    code = code.max(2);
                }
            }
            Err(diagnostics) => {
                let mut sources = SourceMap::default();
                sources.add(file.display().to_string(), text);
                eprint!("{}", handc_dsl::diagnostic::render(&diagnostics, &sources, false));
                code = code.max(1);
            }
        }
    }
    code
}
