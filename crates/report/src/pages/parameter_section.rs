//! A parameter with its figures, on the page of parameters.

use ieap_analysis::ParameterInfo;
use serde::Serialize;

/// A parameter with its figures.
#[derive(Debug, Serialize)]
pub struct Section {
    id: String,
    symbol: &'static str,
    name: &'static str,
    panels: Vec<Panel>,
}

/// A figure of a parameter.
#[derive(Debug, Serialize)]
pub struct Panel {
    /// Empty where all materials share the panel.
    pub material: String,
    /// Id of the figure; none where nothing is determined.
    pub figure: Option<String>,
    /// Why there is no figure, or which runs are missing from it and why.
    pub note: String,
    /// Runs set aside that lie beyond the axes.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub beyond: String,
}

impl Section {
    /// Of a parameter.
    pub fn of(id: String, info: &'static ParameterInfo, panels: Vec<Panel>) -> Section {
        Section {
            id,
            symbol: info.symbol,
            name: info.name,
            panels,
        }
    }
}
