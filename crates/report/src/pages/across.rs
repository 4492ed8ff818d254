//! Parts of the page "Across runs" that show a campaign's design: the matrix of parameters and covariates, the map of
//! what is confounded, the runs to make next.

use ieap_domain::words::counted;
use serde::Serialize;

use crate::pages::policy::INFLATION_SHADES;
use crate::site::Site;
use ieap_analysis::ParameterInfo;
use ieap_analysis::laws::covariate::Covariate;
use ieap_analysis::laws::matrix::{ConfoundingMap, Matrix, MatrixCell, matrices};
use ieap_analysis::laws::words as law_words;
use ieap_analysis::plan::{PlannedRun, words};
use ieap_domain::number::fixed;
use ieap_domain::number::probabilities::probability;

/// Parameters against covariates, as a table.
#[derive(Debug, Serialize)]
pub struct MatrixTable {
    material: String,
    /// Sets in the head: the names of each, and whether these cannot be told apart.
    heads: Vec<Head>,
    rows: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Head {
    names: Vec<&'static str>,
    is_tied: bool,
}

#[derive(Debug, Serialize)]
struct Row {
    symbol: String,
    name: &'static str,
    cells: Vec<Cell>,
}

#[derive(Debug, Serialize)]
struct Cell {
    /// Columns that it stands over: one for each name of its set.
    span: usize,
    /// `rise-2`, `fall-1`, `open`, `none`; `rise-0` where it changes by nobody knows how much.
    class: String,
    /// `× 1.8 ↑`.
    change: String,
    /// `1.5 to 2.2`.
    interval: String,
    /// q.
    q: String,
    /// The covariate that the readings tell apart from the others of the set; empty where there is none.
    by: &'static str,
    /// The same in words, for those who hear the page.
    spoken: String,
}

/// The matrices of all materials.
pub fn matrix_tables(site: &Site) -> Vec<MatrixTable> {
    matrices(&site.input.laws).iter().map(table).collect()
}

fn table(matrix: &Matrix) -> MatrixTable {
    let row = |row: &ieap_analysis::laws::matrix::MatrixRow| Row {
        symbol: law_words::symbol(&row.parameter).to_owned(),
        name: ParameterInfo::of(&row.parameter).map_or("", |info| info.name),
        cells: row
            .cells
            .iter()
            .zip(&matrix.sets)
            .map(|(cell, set)| cell_text(cell.as_ref(), set, &row.parameter))
            .collect(),
    };
    MatrixTable {
        material: matrix.material.clone(),
        heads: matrix
            .sets
            .iter()
            .map(|set| Head {
                names: set.iter().map(|covariate| covariate.label()).collect(),
                is_tied: set.len() > 1,
            })
            .collect(),
        rows: matrix.rows.iter().map(row).collect(),
    }
}

fn cell_text(cell: Option<&MatrixCell>, set: &[Covariate], parameter: &str) -> Cell {
    let Some(cell) = cell else {
        return Cell {
            span: set.len(),
            class: "none".to_owned(),
            change: "–".to_owned(),
            interval: String::new(),
            q: String::new(),
            by: "",
            spoken: "not asked".to_owned(),
        };
    };
    let q = probability(cell.q);
    let shown = cell.change.filter(|_| cell.is_claimed);
    let (change, interval) = match shown {
        Some(change) => {
            let ends = change.low_95.zip(change.high_95);
            let width = ends.map_or(change.value, |(low, high)| high - low);
            let sign = match (cell.is_factor, cell.is_directed) {
                (true, true) => "× ",
                (true, false) => "up to × ",
                (false, _) => "+ ",
            };
            (
                format!("{sign}{}", law_words::round(change.value, width)),
                ends.map_or_else(String::new, |(low, high)| {
                    format!(
                        "{} to {}",
                        law_words::round(low, width),
                        law_words::round(high, width)
                    )
                }),
            )
        }
        None if cell.is_claimed => ("changes".to_owned(), String::new()),
        None => ("open".to_owned(), String::new()),
    };
    let arrow = match (cell.is_claimed && cell.is_directed && shown.is_some(), cell.rises) {
        (false, _) => "",
        (true, true) => " ↑",
        (true, false) => " ↓",
    };
    let class = match (cell.is_claimed, cell.rises) {
        (false, _) => "open".to_owned(),
        (true, true) => format!("rise-{}", cell.strength),
        (true, false) => format!("fall-{}", cell.strength),
    };
    let by = if cell.is_told_apart {
        cell.covariate.label()
    } else {
        ""
    };
    let with = match by {
        "" => law_words::listed(set),
        by => by.to_owned(),
    };
    Cell {
        span: set.len(),
        class,
        spoken: format!("{} by {with}: {change}, q {q}", law_words::symbol(parameter)),
        change: format!("{change}{arrow}"),
        interval,
        q: format!("q {q}"),
        by,
    }
}

/// Which covariates leave each other unclear, as a table.
#[derive(Debug, Serialize)]
pub struct MapTable {
    material: String,
    /// Names of the columns.
    columns: Vec<MapName>,
    rows: Vec<MapRow>,
}

#[derive(Debug, Serialize)]
struct MapName {
    name: &'static str,
    /// Whether it belongs to a set that cannot be told apart.
    is_tied: bool,
}

#[derive(Debug, Serialize)]
struct MapRow {
    head: MapName,
    cells: Vec<MapCell>,
}

#[derive(Debug, Serialize)]
struct MapCell {
    text: String,
    /// 0 to 4.
    shade: usize,
    spoken: String,
}

/// The maps of all materials.
pub fn map_tables(site: &Site) -> Vec<MapTable> {
    site.input.confounding.iter().map(map_table).collect()
}

fn map_table(map: &ConfoundingMap) -> MapTable {
    let name = |place: usize| MapName {
        name: map.covariates[place].label(),
        is_tied: map.sets.iter().any(|set| set.contains(&place)),
    };
    let cell = |row: usize, column: usize| {
        let inflation = map.inflation[row][column];
        let said = inflation.map_or_else(|| "kept apart by samples".to_owned(), words::inflation);
        MapCell {
            text: inflation.map_or_else(|| "·".to_owned(), inflation_sign),
            shade: inflation.map_or(0, |value| {
                INFLATION_SHADES.iter().filter(|from| value >= **from).count()
            }),
            spoken: format!("{} and {}: {said}", name(row).name, name(column).name),
        }
    };
    // Each pair once: a triangle without its diagonal.
    let last = map.covariates.len().saturating_sub(1);
    MapTable {
        material: map.material.clone(),
        columns: (0..last).map(name).collect(),
        rows: (1..=last)
            .map(|row| MapRow {
                head: name(row),
                cells: (0..row).map(|column| cell(row, column)).collect(),
            })
            .collect(),
    }
}

fn inflation_sign(value: f64) -> String {
    match words::inflation(value).as_str() {
        "infinity" => "∞".to_owned(),
        number => number.to_owned(),
    }
}

/// What the design cannot tell apart, a sentence each; materials of which the same holds share one.
pub fn tied(site: &Site) -> Vec<String> {
    let laws = &site.input.laws;
    let mut said: Vec<(Vec<String>, String)> = Vec::new();
    for set in &laws.tied {
        let held = law_words::tied(set, laws);
        match said.iter_mut().find(|(_, known)| *known == held) {
            Some((materials, _)) => materials.push(set.material.clone()),
            None => said.push((vec![set.material.clone()], held)),
        }
    }
    said.into_iter()
        .map(|(materials, held)| law_words::in_runs_of(&materials, &held))
        .collect()
}

/// A run of the list.
#[derive(Debug, Serialize)]
pub struct NextRow {
    rank: usize,
    planned: String,
    place: String,
    drive: String,
    why: Vec<String>,
    file: String,
    sheet: String,
}

/// The runs to make next.
pub fn next_rows(site: &Site) -> Vec<NextRow> {
    let rows = site.input.next_runs.iter().enumerate();
    rows.map(|(place, planned)| next_row(place + 1, planned))
        .collect()
}

/// `CNaf-1, air, 33 % RH`: what is to be measured and where.
pub fn place_words(planned: &PlannedRun) -> String {
    let run = &planned.run;
    let mut place = vec![run.sample.clone()];
    place.extend(run.environment.clone());
    place.extend(
        run.relative_humidity_percent
            .map(|rh| format!("{} % RH", fixed(rh, 0))),
    );
    place.extend(run.temperature_c.map(|celsius| format!("{celsius} °C")));
    place.extend(run.rest_before_s.map(|rest| format!("{rest} s of rest before")));
    place.extend(
        run.names
            .iter()
            .map(|(covariate, name)| format!("{} {name}", covariate.label())),
    );
    place.join(", ")
}

fn next_row(rank: usize, planned: &PlannedRun) -> NextRow {
    NextRow {
        rank,
        planned: planned.planned.clone(),
        place: place_words(planned),
        drive: planned.run.drive.clone(),
        why: planned.run.why.clone(),
        file: planned.file.clone(),
        sheet: planned.on_sheet.clone().unwrap_or_default(),
    }
}

/// `3 runs to make next`; empty where there is none.
pub fn next_words(site: &Site) -> String {
    match site.input.next_runs.len() {
        0 => String::new(),
        count => format!("{} to make next", counted(count, "run")),
    }
}

/// What the plans reach, a sentence each.
pub fn untying(site: &Site) -> Vec<String> {
    site.input.deconfounding.iter().flat_map(words::reached).collect()
}
