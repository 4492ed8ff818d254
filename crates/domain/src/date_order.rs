//! The order of day, month and year in dates as files write them.

use crate::string_enum;

string_enum! {
    /// Order of the parts of a date.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum DateOrder {
        /// `2024-10-14`
        YearFirst = "year-first",
        /// `10/14/2024`, `Oct. 14, 2024`
        MonthFirst = "month-first",
        /// `14.10.2024`
        DayFirst = "day-first",
    }
}

impl DateOrder {
    /// In sentences.
    pub fn words(self) -> &'static str {
        match self {
            DateOrder::YearFirst => "year first",
            DateOrder::MonthFirst => "month first",
            DateOrder::DayFirst => "day first",
        }
    }
}
