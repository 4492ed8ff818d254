//! What is shown, said once. A table is said as a [`Sheet`]: columns over rows of a kind. What a verb prints and a page shows is
//! a list of [`Block`]s. Nothing here is rounded, escaped or drawn: that is the work of the writers, one a medium, in
//! `ieap-report`.

pub mod block;
pub mod chart;
mod document;
pub mod frame;
pub mod quantities;
pub mod sheet;
pub mod table;

pub use block::Block;
pub use chart::{Chart, Form, Ink, Layer, Mark, Panel, Range, Scale};
pub use document::Document;
pub use frame::{Frame, FrameCells, FrameColumn, frame_of};
pub use quantities::Quantity;
pub use sheet::{Combined, Made, Printed, Rough, Sheet, Value, content_of, rough};
pub use table::{Cell, Column, Content, Measured, Notes, Pooled, Row, Source, SourceOrigin, Table};
