//! A number that a room finds in readings, with its name and unit: one list of them serves tables, pages and exports.

/// How one number is named and shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// Key with the unit.
    pub key: &'static str,
    /// Symbol.
    pub symbol: &'static str,
    /// What it is.
    pub name: &'static str,
    /// Unit as printed.
    pub unit: &'static str,
}

impl Figure {
    /// A number of that name.
    pub const fn new(
        key: &'static str,
        symbol: &'static str,
        name: &'static str,
        unit: &'static str,
    ) -> Figure {
        Figure {
            key,
            symbol,
            name,
            unit,
        }
    }
}
