//! Conditions compared: a table a material, parameters down, what is compared across, a factor in each cell.

use crate::pages::policy::CONTRAST_SHADES;
use std::collections::BTreeMap;

use serde::Serialize;

use ieap_analysis::ParameterInfo;
use ieap_analysis::laws::contrast::{Contrast, Over, Ratio, in_short};
use ieap_analysis::laws::words;

/// A table of a material.
#[derive(Debug, Serialize)]
pub struct ContrastTable {
    material: String,
    heads: Vec<Head>,
    rows: Vec<Row>,
    /// Whether one sample stands behind all of it.
    is_of_one_sample: bool,
}

/// What is compared, over the places in which it is.
#[derive(Debug, Serialize)]
struct Head {
    what: String,
    places: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Row {
    symbol: String,
    name: &'static str,
    cells: Vec<Cell>,
}

#[derive(Debug, Default, Serialize)]
struct Cell {
    /// `× 4.2`, or a dash.
    factor: String,
    interval: String,
    /// As in the matrix of laws: `rise-2`, `fall-1`, `open`.
    class: String,
    /// The same in words, for those who hear the page.
    spoken: String,
}

/// The tables of all materials.
pub fn contrast_tables(contrasts: &[Contrast]) -> Vec<ContrastTable> {
    let materials = contrasts.chunk_by(|a, b| a.material == b.material);
    materials.map(table).collect()
}

/// Cells of a row by head and column.
type Cells = BTreeMap<(usize, usize), Cell>;

fn table(contrasts: &[Contrast]) -> ContrastTable {
    let mut heads: Vec<Head> = Vec::new();
    let mut rows: Vec<(&str, Cells)> = Vec::new();
    for contrast in contrasts {
        let what = what(&contrast.over);
        let group = heads
            .iter()
            .position(|head| head.what == what)
            .unwrap_or_else(|| {
                heads.push(Head {
                    what,
                    places: Vec::new(),
                });
                heads.len() - 1
            });
        if rows.iter().all(|(parameter, _)| *parameter != contrast.parameter) {
            rows.push((&contrast.parameter, BTreeMap::new()));
        }
        for ratio in &contrast.ratios {
            let place = place(ratio, &contrast.over);
            let places = &mut heads[group].places;
            let column = places
                .iter()
                .position(|known| *known == place)
                .unwrap_or_else(|| {
                    places.push(place.clone());
                    places.len() - 1
                });
            let row = rows
                .iter_mut()
                .find(|(parameter, _)| *parameter == contrast.parameter);
            if let Some((_, cells)) = row {
                cells.insert((group, column), cell(ratio, contrast, &place));
            }
        }
    }
    let row = |(parameter, mut cells): (&str, BTreeMap<(usize, usize), Cell>)| Row {
        symbol: words::symbol(parameter).to_owned(),
        name: ParameterInfo::of(parameter).map_or("", |info| info.name),
        cells: heads
            .iter()
            .enumerate()
            .flat_map(|(group, head)| (0..head.places.len()).map(move |column| (group, column)))
            .map(|at| cells.remove(&at).unwrap_or_else(|| none(parameter)))
            .collect(),
    };
    ContrastTable {
        material: contrasts[0].material.clone(),
        rows: rows.into_iter().map(row).collect(),
        heads,
        is_of_one_sample: contrasts
            .iter()
            .flat_map(|one| &one.ratios)
            .all(|ratio| ratio.samples == 1),
    }
}

fn what(over: &Over) -> String {
    match over {
        Over::Environment {
            environment,
            reference,
        } => format!("{environment} / {reference}"),
        Over::Voltage { high, low } => format!("{high} V / {low} V"),
    }
}

fn place(ratio: &Ratio, over: &Over) -> String {
    match over {
        Over::Environment { .. } => format!("{} V", ratio.place),
        Over::Voltage { .. } => ratio.place.clone(),
    }
}

fn cell(ratio: &Ratio, contrast: &Contrast, place: &str) -> Cell {
    let short = in_short(ratio);
    let sign = if short.factor == "?" { "" } else { "× " };
    let class = short.log.map_or_else(
        || "open".to_owned(),
        |log| {
            let strength = 1 + CONTRAST_SHADES
                .iter()
                .filter(|from| log.abs() >= from.ln())
                .count();
            format!("{}-{strength}", if log > 0.0 { "rise" } else { "fall" })
        },
    );
    let unsure = if short.log.is_none() {
        ", no difference is shown"
    } else {
        ""
    };
    Cell {
        spoken: format!(
            "{}, {}, {place}: factor {}{unsure}",
            words::symbol(&contrast.parameter),
            what(&contrast.over),
            short.factor
        ),
        factor: format!("{sign}{}", short.factor),
        interval: short.interval,
        class,
    }
}

fn none(parameter: &str) -> Cell {
    Cell {
        factor: "–".to_owned(),
        class: "none".to_owned(),
        spoken: format!("{}: not measured in both", words::symbol(parameter)),
        ..Cell::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_analysis::laws::fitted::Interval;

    fn contrast(parameter: &str, place: &str, factor: f64) -> Contrast {
        let log = factor.ln();
        Contrast {
            material: "CNaf".to_owned(),
            parameter: parameter.to_owned(),
            over: Over::Environment {
                environment: "air".to_owned(),
                reference: "vacuum".to_owned(),
            },
            ratios: vec![Ratio {
                place: place.to_owned(),
                log: Some(Interval {
                    value: log,
                    low_95: Some(log - 0.1),
                    high_95: Some(log + 0.1),
                }),
                at_least: None,
                samples: 1,
                runs: Vec::new(),
            }],
        }
    }

    #[test]
    fn what_is_not_measured_in_both_is_a_dash_in_a_table_of_even_rows() {
        let all = [
            contrast("alpha_per_c_cm", "1.20", 0.3),
            contrast("lambda_per_s", "2.00", 1.05),
        ];
        let tables = contrast_tables(&all);
        let table = &tables[0];
        assert_eq!(table.heads[0].places, ["1.20 V", "2.00 V"]);
        let classes = |row: usize| -> Vec<&str> {
            table.rows[row]
                .cells
                .iter()
                .map(|cell| cell.class.as_str())
                .collect()
        };
        assert_eq!(classes(0), ["fall-3", "none"]);
        assert_eq!(classes(1), ["none", "open"]);
        assert_eq!(table.rows[0].cells[0].factor, "× 0.30");
        assert!(table.is_of_one_sample);
    }
}
