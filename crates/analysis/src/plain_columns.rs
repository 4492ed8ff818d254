//! The columns of a table for other programs, without the library that it is made with.

use polars::prelude::{Column, DataFrame, DataType, IntoColumn, NamedFrom, Series};

use super::export::{ExportError, frame};

/// One column; an empty cell is none.
#[derive(Debug, Clone, PartialEq)]
pub struct PlainColumn {
    /// Its name, with the unit in it.
    pub name: String,
    /// Its cells.
    pub cells: PlainCells,
}

/// The cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum PlainCells {
    /// Numbers.
    Numbers(Vec<Option<f64>>),
    /// Whole numbers.
    Counts(Vec<Option<i64>>),
    /// Yes or no.
    Flags(Vec<Option<bool>>),
    /// Words; times stand in RFC 3339.
    Texts(Vec<Option<String>>),
}

/// The columns of a table in its order.
pub fn plain_columns(table: &DataFrame) -> Vec<PlainColumn> {
    let plain = |column: &Column| PlainColumn {
        name: column.name().to_string(),
        cells: cells(column),
    };
    table.columns().iter().map(plain).collect()
}

/// The table of such columns.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn frame_of(columns: Vec<PlainColumn>) -> Result<DataFrame, ExportError> {
    let series = |column: PlainColumn| {
        let name = column.name.as_str().into();
        match column.cells {
            PlainCells::Numbers(cells) => Series::new(name, cells),
            PlainCells::Counts(cells) => {
                // As counts of every other table.
                let counts = cells.into_iter().map(|cell| u32::try_from(cell?).ok());
                Series::new(name, counts.collect::<Vec<_>>())
            }
            PlainCells::Flags(cells) => Series::new(name, cells),
            PlainCells::Texts(cells) => Series::new(name, cells),
        }
    };
    let columns = columns.into_iter().map(|column| series(column).into_column());
    frame("plain columns", columns.collect())
}

fn cells(column: &Column) -> PlainCells {
    if let Ok(numbers) = column.f64() {
        return PlainCells::Numbers(numbers.iter().collect());
    }
    if let Ok(flags) = column.bool() {
        return PlainCells::Flags(flags.iter().collect());
    }
    if column.dtype().is_integer()
        && let Ok(whole) = column.cast(&DataType::Int64)
        && let Ok(whole) = whole.i64()
    {
        return PlainCells::Counts(whole.iter().collect());
    }
    let texts = column.cast(&DataType::String);
    let texts = texts.ok().and_then(|texts| {
        let texts = texts.str().ok()?;
        Some(texts.iter().map(|text| text.map(str::to_owned)).collect())
    });
    PlainCells::Texts(texts.unwrap_or_else(|| vec![None; column.len()]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_cell_keeps_its_kind_and_its_empty_cells() {
        let columns = vec![
            Series::new("a_v".into(), vec![Some(1.5), None]).into_column(),
            Series::new("runs".into(), vec![3_u32, 4]).into_column(),
            Series::new("converged".into(), vec![Some(true), None]).into_column(),
            Series::new("run".into(), vec![Some("a.csv"), None]).into_column(),
        ];
        let table = DataFrame::new(2, columns).unwrap();
        let found = plain_columns(&table);
        assert_eq!(found[0].cells, PlainCells::Numbers(vec![Some(1.5), None]));
        assert_eq!(found[1].cells, PlainCells::Counts(vec![Some(3), Some(4)]));
        assert_eq!(found[2].cells, PlainCells::Flags(vec![Some(true), None]));
        assert_eq!(
            found[3].cells,
            PlainCells::Texts(vec![Some("a.csv".into()), None])
        );
        assert_eq!(found[3].name, "run");
    }
}
