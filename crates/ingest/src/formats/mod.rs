//! Reading instrument files. A new format is one file here and one row in [`ALL`].

use crate::Reading;
use ieap_domain::DateOrder;

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
pub mod gamry_dta;
pub mod gamry_objects;
pub mod ivium;
pub mod labview_lvm;
pub mod labview_tdms;
pub mod matlab_mat;
pub mod netzsch;
pub mod overload;
pub mod palmsens;
pub mod parquet;
pub mod plain_table;
pub mod plausible;
pub mod probe_table;
pub mod recognition;
pub mod sample_clock;
pub mod sheet_cells;
#[cfg(test)]
mod sheet_tests;
pub mod sidecar;
pub mod spreadsheet;
pub mod stamp;
pub mod ta_trios;
pub mod time_axis;
pub mod unpacking;
pub mod unread;
pub mod versastat_par;
mod xls_extent;

pub use error::ReadError;
pub use recognition::{Candidate, FileHead, Match, recognise};

/// What a reader may need to know beside the bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadContext {
    /// Most bytes that a zipped spreadsheet may unpack to.
    pub max_unpacked_bytes: u64,
    /// Whether a plain table must hold a response or a modulus, as a run does; a part of a run that is joined
    /// from several files, such as the humidity of a modulus log, need not.
    pub needs_response: bool,
    /// The order of day, month and year that counts where dates leave several.
    pub date_order: Option<DateOrder>,
}

impl Default for ReadContext {
    fn default() -> ReadContext {
        ReadContext {
            max_unpacked_bytes: 512 << 20,
            needs_response: true,
            date_order: None,
        }
    }
}

/// One instrument format.
pub trait Format: Sync {
    /// Stable id, `gamry-dta`; stored with every run.
    fn id(&self) -> &'static str;
    /// What it is, in words, for `ieap formats`.
    fn title(&self) -> &'static str;
    /// Usual extensions, lower case without the dot; they break ties only.
    fn extensions(&self) -> &'static [&'static str];
    /// Version of the reader: raised when the same bytes would read differently.
    fn version(&self) -> u32;
    /// Whether it reads tables of any source by the names of their columns: a saved profile goes before it.
    fn is_generic(&self) -> bool {
        false
    }
    /// Whether a file is of this format, judged by how it begins.
    fn recognise(&self, head: &FileHead<'_>) -> Match;
    /// Reads a whole file.
    ///
    /// # Errors
    /// No table can be had from the bytes; everything less is an issue of the reading.
    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError>;
}

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
    format.read(bytes, context)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_have_unique_ids_and_say_what_they_are() {
        for (index, format) in ALL.iter().enumerate() {
            let id = format.id();
            assert!(
                id.chars()
                    .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'),
                "{id}"
            );
            assert!(
                ALL[..index].iter().all(|other| other.id() != id),
                "{id} stands twice"
            );
            assert!(format.title().len() > 10 && format.version() >= 1, "{id}");
            assert!(!format.extensions().is_empty(), "{id}");
            assert!(
                format
                    .extensions()
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
