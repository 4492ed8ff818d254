//! What every format answers, and what it is asked.

use std::borrow::Cow;
use std::cell::OnceCell;

use super::error::ReadError;
use super::unpacking;
use crate::Reading;
use crate::table::shape::Shape;
use crate::table::{Answers, layout};
use crate::text::decode;
use crate::text::lines::lines_of;
use crate::text::policy::HEAD_BYTES;
use crate::text::units_in_cells::lifted;
use ieap_domain::{Campaign, DateOrder};

/// How a file begins.
#[derive(Debug, Clone)]
pub struct FileHead<'a> {
    /// File name without its folder.
    pub name: &'a str,
    /// First bytes, at most [`HEAD_BYTES`].
    pub bytes: &'a [u8],
    /// Size of the whole file, bytes.
    pub size: u64,
    /// Its text, once a format asked for it.
    text: OnceCell<Option<Cow<'a, str>>>,
    /// Where its table stands, once a format asked for it.
    shape: OnceCell<Result<Shape, ReadError>>,
}

impl<'a> FileHead<'a> {
    /// Head of a file that is held in memory.
    pub fn of(name: &'a str, bytes: &'a [u8]) -> FileHead<'a> {
        FileHead {
            name,
            bytes: &bytes[..bytes.len().min(HEAD_BYTES)],
            size: bytes.len() as u64,
            text: OnceCell::new(),
            shape: OnceCell::new(),
        }
    }

    /// Extension in lower case; empty where there is none.
    pub fn extension(&self) -> String {
        match self.name.rsplit_once('.') {
            Some((_, extension)) => extension.to_lowercase(),
            None => String::new(),
        }
    }

    /// The head as text; none where it holds NUL bytes and no UTF-16 mark, as binary files do. Nothing but NUL behind a text is
    /// what a disk leaves that lost its power.
    pub fn text(&self) -> Option<&str> {
        let found = self.text.get_or_init(|| {
            let text = decode(self.bytes).text;
            let text = lifted(&text).map_or(text, Cow::Owned);
            match text.find('\0') {
                None => Some(text),
                Some(at) => {
                    let is_tail = at > 0 && text[at..].bytes().all(|byte| byte == 0);
                    is_tail.then(|| Cow::Owned(text[..at].to_owned()))
                }
            }
        });
        found.as_deref()
    }

    /// Where the table of its text stands.
    ///
    /// # Errors
    /// As [`layout::best_shape`].
    pub fn shape(&self) -> Result<&Shape, &ReadError> {
        let lines = || lines_of(self.text().unwrap_or_default());
        let found = self.shape.get_or_init(|| layout::best_shape(&lines()));
        found.as_ref()
    }
}

/// How well a format fits.
#[derive(Debug, Clone, PartialEq)]
pub enum Match {
    /// A mark of the format that nothing else has.
    Certain(&'static str),
    /// Readable as this format, with a score between 0 and 1.
    Possible {
        /// How well, below 1.
        score: f64,
        /// What speaks for it.
        reason: &'static str,
    },
    /// Not this format.
    No,
}

impl Match {
    /// Certain where the mark is there, for the reason that it is.
    pub fn certain_if(has_mark: bool, reason: &'static str) -> Match {
        if has_mark {
            Match::Certain(reason)
        } else {
            Match::No
        }
    }
}

/// What a reader may need to know beside the bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadContext {
    /// Most bytes that a packed file may unpack to; a small one may to fewer: see [`unpacking::allowance`].
    pub max_unpacked_bytes: u64,
    /// Whether a plain table must hold a response or a modulus, as a run does; a part of a run that is joined
    /// from several files, such as the humidity of a modulus log, need not.
    pub needs_response: bool,
    /// The order of day, month and year that counts where dates leave several.
    pub date_order: Option<DateOrder>,
    /// What people answered to questions that files leave open.
    pub answers: Answers,
}

impl ReadContext {
    /// What campaign.toml says of files.
    pub fn of(campaign: &Campaign) -> ReadContext {
        ReadContext {
            date_order: campaign.date_order,
            answers: Answers::of_campaign(campaign),
            ..ReadContext::default()
        }
    }

    /// The same for what lay packed in a file of that size: it may unpack to no more than the file itself.
    pub fn within(&self, packed: usize) -> ReadContext {
        ReadContext {
            max_unpacked_bytes: self.max_unpacked_bytes.min(unpacking::allowance(packed)),
            ..self.clone()
        }
    }
}

impl Default for ReadContext {
    fn default() -> ReadContext {
        ReadContext {
            max_unpacked_bytes: unpacking::MOST,
            needs_response: true,
            date_order: None,
            answers: Answers::default(),
        }
    }
}

/// What a format is.
#[derive(Debug, Clone, Copy)]
pub struct About {
    /// Stable id, `gamry-dta`; stored with every run.
    pub id: &'static str,
    /// What it is, in words, for `ieap list formats`.
    pub title: &'static str,
    /// Usual extensions, lower case without the dot; they break ties only.
    pub extensions: &'static [&'static str],
    /// Version of the reader: raised when the same bytes would read differently.
    pub version: u32,
}

/// One instrument format.
pub trait Format: Sync {
    /// What it is.
    fn about(&self) -> About;
    /// Its id.
    fn id(&self) -> &'static str {
        self.about().id
    }
    /// Id and version of the reader, with nothing read yet.
    fn reading(&self) -> Reading {
        Reading::of(self.about().id, self.about().version)
    }
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
