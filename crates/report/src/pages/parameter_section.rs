//! A parameter's section on pages that show all parameters one after another.

use ieap_analysis::ParameterInfo;
use serde::Serialize;

/// Its names and its figures, one a panel.
#[derive(Debug, Serialize)]
pub struct ParameterSection<P> {
    id: &'static str,
    symbol: &'static str,
    name: &'static str,
    panels: Vec<P>,
}

impl<P> ParameterSection<P> {
    /// The section; none where there is nothing to show.
    pub fn of(info: &ParameterInfo, panels: Vec<P>) -> Option<ParameterSection<P>> {
        (!panels.is_empty()).then_some(ParameterSection {
            id: info.key,
            symbol: info.symbol,
            name: info.name,
            panels,
        })
    }
}
