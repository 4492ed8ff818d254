//! A profile as serde sees it, before anything is checked. Unknown keys are refused: a misspelt one would change
//! what is read without a word.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub profile: Option<Head>,
    #[serde(default)]
    pub recognise: Recognise,
    pub layout: Option<Spanned<Layout>>,
    pub time: Option<Spanned<Time>>,
    pub start: Option<Spanned<Start>>,
    #[serde(default)]
    pub column: Vec<Spanned<Column>>,
    #[serde(default)]
    pub answers: BTreeMap<String, String>,
}

/// `[profile]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    pub version: Option<Spanned<i64>>,
    pub title: Option<String>,
    pub technique: Option<String>,
    pub step_response: Option<bool>,
}

/// `[recognise]`.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Recognise {
    pub name: Option<String>,
    #[serde(default)]
    pub contains: Vec<String>,
    #[serde(default)]
    pub over_vendor: bool,
}

/// `[layout]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Layout {
    pub kind: Option<Spanned<String>>,
    pub encoding: Option<Spanned<String>>,
    pub separator: Option<Spanned<String>>,
    pub decimal: Option<Spanned<String>>,
    pub comment: Option<String>,
    pub sheet: Option<String>,
    pub header_line: Option<Spanned<i64>>,
    pub header_contains: Option<String>,
    #[serde(default)]
    pub lines_after_header: u16,
}

/// A column by its name, or by its number from 1.
#[derive(Deserialize, Clone)]
#[serde(untagged)]
pub(super) enum ColumnRef {
    Number(i64),
    Name(String),
}

/// `[time]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    pub base: Option<Spanned<String>>,
    pub column: Option<Spanned<ColumnRef>>,
    pub date_column: Option<Spanned<ColumnRef>>,
    pub unit: Option<Spanned<String>>,
    pub order: Option<Spanned<String>>,
    pub zone: Option<Spanned<String>>,
    pub interval_s: Option<Spanned<f64>>,
    pub zero: Option<Spanned<String>>,
}

/// `[start]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Start {
    pub line_begins: Option<String>,
    pub order: Option<Spanned<String>>,
    pub kind: Option<Spanned<String>>,
}

/// `[[column]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Column {
    pub column: Option<Spanned<ColumnRef>>,
    pub quantity: Option<Spanned<String>>,
    pub unit: Option<Spanned<String>>,
    pub factor: Option<Spanned<f64>>,
    pub position_mm: Option<Spanned<f64>>,
}
