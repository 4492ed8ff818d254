//! Sizes of strips that a laboratory's sheet states, in a tab of their own or beside the runs: a column of samples, and columns of
//! lengths and widths with their unit.

use super::laboratory::{Laid, grids_of, laid};
use super::policy::MOST_TITLES;
use crate::name_pattern::number_of_name;
use crate::text::header::Header;
use crate::text::names::{sheet_column, size_column};
use ieap_domain::Quantity;
use ieap_domain::tag::keys;
use ieap_domain::unit::{self, Conversion};

/// What a sheet states of a strip: keys of a `[[sample]]` with their values, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleSize {
    /// The strip, as the sheet writes it.
    pub sample: String,
    /// `length_mm`, `width_mm`, `thickness_mm`, as far as they are stated.
    pub sizes_mm: Vec<(&'static str, f64)>,
}

/// The sizes that a workbook or a text states.
pub fn sizes_of(bytes: &[u8]) -> Vec<SampleSize> {
    let grids = grids_of(bytes).unwrap_or_default();
    grids.iter().find_map(|grid| of_grid(grid)).unwrap_or_default()
}

fn of_grid(grid: &[Vec<String>]) -> Option<Vec<SampleSize>> {
    let mut tables = (0..grid.len().min(MOST_TITLES)).flat_map(|at| laid(grid, at));
    tables.find_map(|laid| of_table(&laid))
}

fn of_table(laid: &Laid<'_>) -> Option<Vec<SampleSize>> {
    let names: Vec<String> = laid.names.iter().map(|name| name.shown()).collect();
    let sample = names
        .iter()
        .position(|name| sheet_column(name) == Some(keys::SAMPLE))?;
    let of_name = |(at, name): (usize, &String)| {
        let (key, conversion) = size(name)?;
        Some((at, key, conversion))
    };
    let found: Vec<(usize, &str, Conversion)> = names.iter().enumerate().filter_map(of_name).collect();
    // Of a free and a whole length nobody knows which is meant.
    let is_only = |key: &str| found.iter().filter(|(_, other, _)| *other == key).count() == 1;
    let columns: Vec<_> = found.iter().filter(|(_, key, _)| is_only(key)).collect();
    let of_row = |row: &Vec<String>| {
        let cell = |at: usize| row.get(at).map_or("", |cell| cell.trim());
        let value = |(at, key, conversion): &&(usize, &'static str, Conversion)| {
            let (number, own) = with_unit(cell(*at))?;
            let mm = own.unwrap_or(*conversion).apply(number);
            (mm > 0.0).then_some((*key, mm))
        };
        let sizes_mm: Vec<_> = columns.iter().filter_map(value).collect();
        let sample = cell(sample).to_owned();
        (!sample.is_empty() && !sizes_mm.is_empty()).then_some(SampleSize { sample, sizes_mm })
    };
    let sizes: Vec<SampleSize> = laid.rows.iter().filter_map(of_row).collect();
    (!sizes.is_empty()).then_some(sizes)
}

/// The number of a cell, and what brings it to mm where the cell has a unit of its own: `1.3 cm`.
fn with_unit(cell: &str) -> Option<(f64, Option<Conversion>)> {
    let end = cell.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | ',')));
    let (number, unit) = cell.split_at(end.unwrap_or(cell.len()));
    let own = match unit.trim() {
        "" => None,
        unit => Some(unit::conversion(Quantity::TipDisplacement, unit).ok()?),
    };
    Some((number_of_name("", number)?, own))
}

/// The size that a column with a unit of length states, and what brings it to mm.
fn size(name: &str) -> Option<(&'static str, Conversion)> {
    let unit = Header::parse(name).raw_unit;
    let conversion = unit::conversion(Quantity::TipDisplacement, &unit).ok()?;
    Some((size_column(name)?, conversion))
}
