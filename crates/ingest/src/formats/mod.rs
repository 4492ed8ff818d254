//! Reading instrument files. A new format is one file here and one row in [`ALL`].

use crate::Reading;

pub mod assemble;
pub mod autolab_nova;
pub mod biologic;
pub mod cells;
pub mod chi;
pub mod climate;
pub mod columns;
mod compound;
pub mod date;
pub mod delimited;
pub mod eplexor_xls;
pub mod error;
mod format;
pub mod gamry_dta;
pub mod gamry_objects;
pub mod ivium;
pub mod labview_lvm;
pub mod labview_tdms;
pub mod matlab_mat;
pub mod netzsch;
mod no_data;
pub mod no_reading;
pub mod overload;
pub mod palmsens;
pub mod parquet;
mod percent_cells;
pub mod plain_table;
pub mod plausible;
pub(crate) mod policy;
pub mod probe_table;
mod range_end;
pub mod recognition;
pub mod rivals;
pub mod sample_clock;
pub mod sheet_cells;
#[cfg(test)]
mod sheet_tests;
#[cfg(test)]
pub mod sheet_writer;
pub mod sidecar;
pub mod spreadsheet;
pub mod stamp;
pub mod ta_trios;
pub mod time_axis;
pub mod unpacking;
pub mod unread;
pub mod versastat_par;
mod workbook_parts;
mod xls_extent;
pub mod zplot;

pub use error::ReadError;
pub use format::{About, FileHead, Format, Match, ReadContext};
pub use recognition::{Candidate, recognise};

/// Every format.
pub static ALL: &[&dyn Format] = &[
    &gamry_dta::GamryDta,
    &autolab_nova::AutolabNova,
    &ivium::IviumIdf,
    &ivium::IviumText,
    &biologic::BiologicMpt,
    &biologic::BiologicMpr,
    &chi::Chi,
    &palmsens::PstraceCsv,
    &palmsens::PalmsensSession,
    &labview_lvm::LabviewLvm,
    &labview_tdms::LabviewTdms,
    &versastat_par::VersastatPar,
    &zplot::Zplot,
    &netzsch::Netzsch,
    &eplexor_xls::EplexorXls,
    &ta_trios::TaTrios,
    &probe_table::ProbeTable,
    &climate::Hobo,
    &climate::Toa5,
    &climate::Picolog,
    &climate::ClimateTable,
    &spreadsheet::Spreadsheet,
    &parquet::Parquet,
    &matlab_mat::MatlabMat,
    &plain_table::PlainTable,
];

/// The format of that id.
pub fn by_id(id: &str) -> Option<&'static dyn Format> {
    ALL.iter().copied().find(|format| format.id() == id)
}

/// Recognises and reads a file; `name` is its file name.
///
/// # Errors
/// The file is a sidecar of a run (see [`ReadError::is_sidecar`]), is empty or ends after its header (both wait:
/// see [`ReadError::is_pending`]), no format or more than one fits, or the one that fits cannot read it.
pub fn read(name: &str, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
    let (format, _) = recognise(&FileHead::of(name, bytes))?;
    format.read(bytes, &context.within(bytes.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_have_unique_ids_and_say_what_they_are() {
        for (index, format) in ALL.iter().enumerate() {
            let About {
                id,
                title,
                extensions,
                version,
            } = format.about();
            assert!(
                id.chars()
                    .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'),
                "{id}"
            );
            assert!(
                ALL[..index].iter().all(|other| other.id() != id),
                "{id} stands twice"
            );
            assert!(title.len() > 10 && version >= 1, "{id}");
            assert!(!extensions.is_empty(), "{id}");
            assert!(
                extensions
                    .iter()
                    .all(|e| e.to_ascii_lowercase() == **e && !e.starts_with('.'))
            );
            assert!(by_id(id).is_some());
        }
    }

    #[test]
    fn no_format_claims_or_reads_nothing() {
        for format in ALL {
            assert_eq!(
                format.recognise(&FileHead::of("x", b"")),
                Match::No,
                "{}",
                format.id()
            );
            assert_eq!(
                format.read(b"", &ReadContext::default()),
                Err(ReadError::Empty),
                "{}",
                format.id()
            );
        }
        assert_eq!(read("a.csv", b"", &ReadContext::default()), Err(ReadError::Empty));
    }
}
