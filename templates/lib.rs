//! Templates of the report's pages, in the language of Tera, and what stands beside them: each file of this folder.

/// What all pages have around them.
pub const LAYOUT: &str = include_str!("layout.html");
/// The column beside a page.
pub const ASIDE: &str = include_str!("aside.html");
/// What stands in the place of a page, or of a part of it, that could not be made.
pub const FAULT: &str = include_str!("fault.html");
/// The style of all pages.
pub const STYLE: &str = include_str!("style.css");
/// The script of all pages.
pub const SCRIPT: &str = include_str!("site.js");
/// A page that is a list of blocks.
pub const PAGE: &str = include_str!("page.html");
/// The page that leads to all others.
pub const INDEX: &str = include_str!("pages/index.html");
/// The page of the parameters.
pub const PARAMETERS: &str = include_str!("pages/parameters.html");
/// The page of the residuals of all runs.
pub const RESIDUALS: &str = include_str!("pages/residuals.html");
/// The page that every run has.
pub const RUN: &str = include_str!("pages/run.html");
/// The page that every diagnosed group has.
pub const FINDING: &str = include_str!("pages/finding.html");

/// The templates of the blocks, by the names under which pages include them.
pub const BLOCKS: [(&str, &str); 8] = [
    ("blocks/keys.html", include_str!("blocks/keys.html")),
    ("blocks/all.html", include_str!("blocks/all.html")),
    ("blocks/say.html", include_str!("blocks/say.html")),
    ("blocks/facts.html", include_str!("blocks/facts.html")),
    ("blocks/table.html", include_str!("blocks/table.html")),
    ("blocks/charts.html", include_str!("blocks/charts.html")),
    ("blocks/issues.html", include_str!("blocks/issues.html")),
    ("blocks/runs.html", include_str!("blocks/runs.html")),
];
