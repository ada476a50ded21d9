//! Writing a figure: the same drawing as SVG and as PNG.

use crate::canvas::{Canvas, Place};
use crate::png::Png;
use crate::svg::Svg;
use std::path::{Path, PathBuf};

/// A figure that can be drawn on any canvas.
pub trait Picture {
    /// Width and height (pt).
    fn size(&self) -> Place;
    /// Title of the document.
    fn title(&self) -> String;
    /// Draws it.
    fn draw(&self, canvas: &mut dyn Canvas);

    /// The figure as SVG.
    fn svg(&self) -> String {
        let mut svg = Svg::new(self.size(), &self.title());
        self.draw(&mut svg);
        svg.finish()
    }
    /// The figure as the bytes of a PNG file.
    fn png(&self) -> Result<Vec<u8>, String> {
        let mut png = Png::new(self.size()).ok_or("the picture is too large")?;
        self.draw(&mut png);
        png.finish()
    }
}

/// Writes `STEM.svg` and `STEM.png` and returns their paths. The message of an error says which
/// file could not be written.
pub fn save(picture: &dyn Picture, stem: &Path) -> Result<[PathBuf; 2], String> {
    let with = |extension: &str| {
        let mut name = stem.file_name().unwrap_or_default().to_os_string();
        name.push(extension);
        stem.with_file_name(name)
    };
    let paths = [with(".svg"), with(".png")];
    let fail = |path: &Path, error: String| format!("cannot write `{}`: {error}", path.display());
    let png = picture.png().map_err(|error| fail(&paths[1], error))?;
    let contents = [picture.svg().into_bytes(), png];
    for (path, bytes) in paths.iter().zip(contents) {
        std::fs::write(path, bytes).map_err(|error| fail(path, error.to_string()))?;
    }
    Ok(paths)
}
