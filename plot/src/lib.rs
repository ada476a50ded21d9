//! Figures: curves over time and poses of a mechanism, as SVG and PNG.
//!
//! ```text
//! TimePlot (data) ─compose→ Sheet (panels in rows) ─draw→ Canvas ─→ SVG text | PNG pixels
//! PoseFigure (lines in space) ─view→ plane ─────────draw→ Canvas ─↗
//! ```
//!
//! Nothing here knows what a model is: quantities come with names, units and numbers. All sizes on
//! paper are points (1/72 inch); text is measured with the font that the PNG is drawn with.

pub mod canvas;
mod chart;
mod compose;
mod decimate;
mod font;
mod group;
mod legend;
pub mod map;
mod outline;
mod palette;
pub mod png;
pub mod polar;
pub mod pose;
mod pose_body;
mod pose_layout;
mod save;
mod summary;
pub mod svg;
pub mod sweep;
pub mod table;
mod ticks;
pub mod timeplot;
mod unit;
mod view;

pub use map::{MapAxis, MapPlot, MapRow};
pub use polar::{PolarCurve, PolarPlot};
pub use pose::PoseFigure;
pub use save::{Picture, save};
pub use sweep::{Sweep, SweepPlot, SweepRow};
pub use timeplot::{Curve, Quantity, TimePlot};
pub use unit::Unit;
