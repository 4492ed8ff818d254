//! What a profile says, checked, and what it reads.

use super::glob::Glob;
use crate::Reading;
use crate::formats::error::{ReadError, quoted};
use crate::formats::plain_table::PlainTable;
use crate::formats::sheet_cells::is_workbook;
use crate::formats::spreadsheet::Spreadsheet;
use crate::formats::{self, Format, ReadContext, sheet_cells, unpacking};
use crate::table::Answers;
use crate::text::decode;
use crate::text::lines::lines_of;

/// How the files of one source are read.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Its id: the name of its file without `.toml`.
    pub id: String,
    /// Its version, for people; the digest decides.
    pub version: u32,
    /// What it reads, in words.
    pub title: String,
    /// BLAKE3 of its text, hexadecimal.
    pub digest: String,
    /// Its text.
    pub text: String,
    /// Technique of the files, as the profile names it.
    pub technique: Option<String>,
    /// Whether the files hold responses to a piecewise-constant voltage.
    pub step_response: bool,
    /// Name that the files have.
    pub(super) name: Option<Glob>,
    /// Texts that all stand in the first part of the file.
    pub(super) contains: Vec<String>,
    /// Whether it goes before a vendor's format that recognises the file for certain.
    pub over_vendor: bool,
    /// What it answers to what the reader of tables asks, or states in its place.
    pub(super) answers: Answers,
}

impl Profile {
    /// Version of the reader that obeys profiles: raised when the same bytes would read differently.
    pub const READER_VERSION: u32 = 3;

    /// How runs and files name it as their format: `profile:laser@1a2b3c4d5e6f`, the last part from the digest.
    pub fn format(&self) -> String {
        format!("profile:{}@{}", self.id, &self.digest[..12])
    }

    /// Whether the file is one that this profile reads; if not, why.
    ///
    /// A text is judged by its first bytes, a workbook as a whole.
    pub fn fits(&self, name: &str, bytes: &[u8]) -> Result<(), String> {
        /// Bytes that a text is judged by.
        const HEAD: usize = 64 << 10;
        if self.name.as_ref().is_some_and(|glob| !glob.fits(name)) {
            return Err("the file has another name".to_owned());
        }
        let head = &bytes[..bytes.len().min(HEAD)];
        let in_words = |error: ReadError| error.to_string();
        let Some(stated) = self.answers.table() else {
            return self.contains_all(&decode(head).text);
        };
        match (stated.is_sheet(), is_workbook(bytes)) {
            (true, true) => {
                let sheets = sheet_cells::read(bytes, unpacking::MOST).map_err(in_words)?;
                stated.sheet(&sheets).map(|_| ()).map_err(in_words)
            }
            (true, false) => Err("it is no workbook".to_owned()),
            (false, true) => Err("it is no text".to_owned()),
            (false, false) => {
                let decoded = stated.decoded(head);
                if decoded.text.contains('\0') {
                    return Err("it is no text".to_owned());
                }
                self.contains_all(&decoded.text)?;
                let mut lines = lines_of(&decoded.text);
                lines.pop_if(|line| !line.ended);
                stated.place(&lines).map(|_| ()).map_err(in_words)
            }
        }
    }

    fn contains_all(&self, text: &str) -> Result<(), String> {
        match self.contains.iter().find(|wanted| !text.contains(*wanted)) {
            Some(missing) => Err(format!("{} does not stand in it", quoted(missing))),
            None => Ok(()),
        }
    }

    /// Reads a whole file: by the reader of tables, with what the profile answers.
    ///
    /// # Errors
    /// No table can be had from the bytes; everything less is an issue of the reading.
    pub fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut context = context.clone();
        context.answers = context.answers.with(&self.answers);
        if self.answers.table().is_none() {
            return formats::read("table", bytes, &context);
        }
        context.needs_response = false;
        let reader: &dyn Format = if is_workbook(bytes) {
            &Spreadsheet
        } else {
            &PlainTable
        };
        Ok(Reading {
            format: "profile",
            reader_version: Profile::READER_VERSION,
            technique: self.technique.clone(),
            is_step_response: self.step_response,
            ..reader.read(bytes, &context)?
        })
    }
}
