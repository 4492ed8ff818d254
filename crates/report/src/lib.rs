//! Static site: pages, tables and figures. Pages show what analysis computed and curves that fits stored;
//! nothing is fitted here.

pub mod aside;
pub mod blocks;
mod condemned;
mod drawn_runs;
pub mod error;
mod fault;
pub mod figures;
pub mod input;
pub mod kept;
mod lookup;
pub mod pages;
mod press;
pub mod prints;
mod readings_file;
mod render;
pub mod run_index;
pub mod run_pages;
mod run_press;
pub mod site;
pub mod slug;
pub mod sparkline;
pub mod tables;
pub mod visible;
pub mod zone;

pub use error::ReportError;
pub use input::{EffectParameterText, EffectText, Findings, Input, Origin};
pub use render::{Rendered, render, render_site};
pub use site::Site;
