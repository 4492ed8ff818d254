//! The order of day, month and year in dates as files write them.

use serde::{Deserialize, Serialize};

/// Order of the parts of a date.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DateOrder {
    /// `2024-10-14`
    YearFirst,
    /// `10/14/2024`, `Oct. 14, 2024`
    MonthFirst,
    /// `14.10.2024`
    DayFirst,
}

impl DateOrder {
    /// Every order.
    pub const ALL: [DateOrder; 3] = [DateOrder::YearFirst, DateOrder::MonthFirst, DateOrder::DayFirst];

    /// The word of campaign.toml and profiles.
    pub fn key(self) -> &'static str {
        match self {
            DateOrder::YearFirst => "year-first",
            DateOrder::MonthFirst => "month-first",
            DateOrder::DayFirst => "day-first",
        }
    }

    /// The order of that word.
    pub fn from_key(key: &str) -> Option<DateOrder> {
        DateOrder::ALL.into_iter().find(|order| order.key() == key)
    }

    /// In sentences.
    pub fn words(self) -> &'static str {
        match self {
            DateOrder::YearFirst => "year first",
            DateOrder::MonthFirst => "month first",
            DateOrder::DayFirst => "day first",
        }
    }
}
