//! Numbers of different units below each other, a row each.

use super::wording::EstimateText;
use ieap_domain::Estimate;
use ieap_show::{Sheet, Table};

/// A number with what it is.
#[derive(Debug, Clone)]
pub struct Number {
    /// Symbol.
    pub symbol: String,
    /// What it is.
    pub name: String,
    /// Unit that it is shown in; empty for a pure number.
    pub unit: String,
    /// What is known of it, in that unit.
    pub estimate: Estimate,
}

impl Number {
    /// Why there is no value or only a bound, or that it lies at a limit; empty where all is well.
    pub fn remark(&self) -> String {
        self.text().reason
    }

    fn text(&self) -> EstimateText {
        EstimateText::of(&self.estimate, 1.0)
    }
}

/// The table of numbers whose column of symbols has that head.
pub fn table<'n>(head: &str, numbers: impl IntoIterator<Item = &'n Number>) -> Table {
    Sheet::<&Number>::new("numbers", "", 1)
        .plain(head, |own| own.symbol.as_str())
        .plain("What it is", |own| own.name.as_str())
        .plain("Value ± standard error", |own| {
            let text = own.text();
            (text.kind != "missing").then_some(text.text)
        })
        .plain("Unit", |own| own.unit.as_str())
        .plain("95 % interval", |own| own.text().interval)
        .plain("Remark", |own| own.remark())
        .over(numbers)
}
