//! The one reader of tables: delimited texts and sheets of workbooks, whatever they hold.
//!
//! A number is taken when the file says what it is, or when two witnesses agree on it: the digits of a column, an elapsed time
//! and a date, the range of a quantity. What can be read in two ways is asked ([`question`]), once for all files of a source;
//! a profile answers all of it ([`stated`]).
//!
//! - [`kind`]: what a cell can be; [`shape`]: where readings and names stand; [`numbers`]: decimal and thousands marks;
//! - [`columns`]: what names and units say of each column;
//! - [`layout`]: these together, for that delimiter under which most is known;
//! - [`times`]: elapsed time and wall clock; [`rows`]: their order.

pub mod answers;
pub mod columns;
pub mod dates_above;
pub mod duration;
pub mod epoch;
pub mod kind;
pub mod layout;
pub mod numbers;
pub mod order;
pub(crate) mod policy;
pub mod question;
pub mod read;
pub mod rows;
pub mod shape;
pub mod sheet;
pub mod start;
pub mod stated;
mod stated_times;
pub mod times;
pub mod zone;

pub use answers::Answers;
pub use question::Question;
pub use read::{Settled, Table, dates_go_on, joined, read, tables};
