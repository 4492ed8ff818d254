//! Tables in every format. A format is one file here and one row in [`FORMATS`].

mod csv;
mod html;
mod json;
mod latex;
mod latex_text;
mod markdown;
mod shown;
mod text;
mod typst;

pub use csv::write_with_decimal_comma;
pub use shown::{ShownCell, grid, note_letter, remarks, text_of};
pub(crate) use shown::{note_letters, repeated};
pub use text::write_within;

use ieap_analysis::tables::Table;

/// A format that tables are written in.
pub struct Format {
    /// Name by which it is asked for.
    pub name: &'static str,
    /// Ending of its files.
    pub ending: &'static str,
    /// Writes the table.
    pub write: fn(&Table) -> String,
}

/// Every format.
pub const FORMATS: [Format; 7] = [
    Format {
        name: "text",
        ending: "txt",
        write: text::write,
    },
    Format {
        name: "csv",
        ending: "csv",
        write: csv::write,
    },
    Format {
        name: "markdown",
        ending: "md",
        write: markdown::write,
    },
    Format {
        name: "latex",
        ending: "tex",
        write: latex::write,
    },
    Format {
        name: "typst",
        ending: "typ",
        write: typst::write,
    },
    Format {
        name: "html",
        ending: "html",
        write: html::write,
    },
    Format {
        name: "json",
        ending: "json",
        write: json::write,
    },
];

/// The format of that name or file ending.
pub fn format_named(name: &str) -> Option<&'static Format> {
    FORMATS
        .iter()
        .find(|format| format.name == name || format.ending == name)
}
