//! Static site: pages, tables and figures. Pages show what analysis computed and curves that fits stored;
//! nothing is fitted here.

pub mod aside;
pub mod blocks;
mod drawn_runs;
pub mod error;
mod fault;
pub mod figures;
pub mod input;
pub mod kept;
mod lookup;
pub mod moved;
mod page_writer;
pub mod pages;
pub mod print_figures;
mod readings_file;
mod render;
pub mod run_index;
mod run_page_writer;
pub mod run_pages;
pub mod site;
pub mod slug;
pub mod sparkline;
pub mod tables;
pub mod visible;

pub use error::ReportError;
pub use input::{EffectParameterText, EffectText, Findings, Input, Origin};
pub use render::{Rendered, refused_template, render, render_site};
pub use site::Site;
