//! A page that the site has once, and what a page shows.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::error::ReportError;
use crate::input::Input;
use crate::site::Site;
use ieap_domain::Fault;

/// What a page shows: formatted text, and figures apart, so that goldens of the text stay readable.
#[derive(Debug, Clone, PartialEq)]
pub struct Content {
    /// Text, ready to print; templates never calculate.
    pub context: Value,
    /// SVG by the id under which the context names it.
    pub figures: BTreeMap<String, String>,
    /// Sections that could not be made, each with its run; a box stands in their place.
    pub faults: Vec<Fault>,
}

impl Content {
    /// The content of `page` from its context struct.
    ///
    /// # Errors
    /// [`ReportError::Context`]: a fault of the program.
    pub fn new(
        page: &str,
        context: &impl Serialize,
        figures: BTreeMap<String, String>,
    ) -> Result<Content, ReportError> {
        let context = serde_json::to_value(context).map_err(|source| ReportError::Context {
            page: page.to_owned(),
            source,
        })?;
        Ok(Content {
            context,
            figures,
            faults: Vec::new(),
        })
    }
}

/// A page that the site has once.
pub struct Page {
    /// File name; also the name of its template.
    pub file: &'static str,
    /// Title in the navigation.
    pub title: &'static str,
    /// File of the page that it stands under; the navigation of the whole site names only pages under none.
    pub under: Option<&'static str>,
    /// Template text.
    pub template: &'static str,
    /// Whether a report of that input has the page.
    pub is_shown: fn(&Input) -> bool,
    /// Makes the content.
    pub content: fn(&Site) -> Result<Content, ReportError>,
}
