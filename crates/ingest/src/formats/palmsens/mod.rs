//! PalmSens: text export of PSTrace (.csv) and its session file (.pssession). A method (.psmethod) is a sidecar.

pub mod pstrace_csv;
pub mod session;
pub mod session_json;

pub use pstrace_csv::PstraceCsv;
pub use session::PalmsensSession;
