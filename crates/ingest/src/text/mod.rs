//! Text of instrument files: encoding, lines, delimiter and decimal sign, numbers.

pub mod delimiter;
pub(crate) mod dictionary;
pub mod encoding;
pub mod grid;
pub mod header;
pub mod likely;
pub mod lines;
pub mod names;
pub mod number;
pub(crate) mod policy;
pub mod unit_row;
pub mod units_in_cells;
pub mod whole_line;

pub use delimiter::Delimiter;
pub use encoding::{Decoded, decode};
pub use lines::{Line, Lines};
pub use number::{Cell, Decimal, Group, NumberForm};
