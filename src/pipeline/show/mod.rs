//! What people look at: the report, tables, figures, exports, the state of a campaign.

pub(super) mod along;
mod columns;
pub mod explain;
pub mod export;
pub mod figures;
pub(super) mod left;
mod own_templates;
pub mod partitioned;
pub mod plain_tables;
pub(super) mod report;
pub mod research_crate;
pub mod shown_rows;
pub(super) mod simulated_figures;
pub mod tables;
