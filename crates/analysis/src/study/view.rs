//! What the study asked, as a page and as table `contrasts`.

use std::collections::{BTreeMap, BTreeSet};

use ieap_domain::Factor;
use ieap_domain::number::significant;
use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::words::{capital, in_a_row};
use ieap_show::quantities::{MATERIAL, Quantity};
use ieap_show::{Block, Chart, Column, Ink, Layer, Mark, Panel, Range, Sheet, Table, Value};

use super::answer::{Answer, InScope, Kind, Point, Scale, Verdict};
use super::grammar::{Standing, UNTOLD, adverb, in_short, in_strips, untold};
use super::made::Study;
use super::measures::BENDING_PER_VOLT;
use super::odd::odd_runs;
use super::said::{first, lead};
use super::words::{basis, by_fits, family, left_out, sentence, symbol, told_alone, voltages};
use crate::conditions::volts;
use crate::tables::laws;
use ieap_domain::ParameterInfo;

const KIND: Quantity = Quantity::plain("question", "Question", "what is compared");
const PARAMETER: Quantity = Quantity::plain("parameter", "Parameter", "parameter");
const UPPER: Quantity = Quantity::plain("over", "Condition", "what stands above");
const LOWER: Quantity = Quantity::plain("under", "against", "what it is held against");
const VOLTAGES: Quantity = Quantity::new("voltages_v", "at", "voltages over which it is a mean", "V");
const SAMPLES: Quantity = Quantity::plain("samples", "Samples", "samples behind it");
const RUNS: Quantity = Quantity::plain("runs", "Runs", "runs above and below");
const ALSO: Quantity = Quantity::plain(
    "also_changed",
    "changed with it",
    "what else changed with it, so that it may be the cause",
);
const NUMBER: Quantity = Quantity::plain(
    "ratio",
    "Change",
    "ratio with its 95 % interval; points of bending lost; relative change per unit; percent of the range of a curve",
);
const UNIT: Quantity = Quantity::plain("unit", "in", "what the change is counted in");
const INTERVAL: Quantity = Quantity::plain(
    "interval_95",
    "95 %",
    "its 95 % interval, with the scatter from run to run and between samples",
);
const FITS_INTERVAL: Quantity = Quantity::plain(
    "interval_95_by_fits",
    "95 %, fits alone",
    "its 95 % interval by the errors of the fits alone",
);
const MOST_AT: Quantity = Quantity::new(
    "most_at_s",
    "largest at",
    "time after the step at which curves differ most",
    "s",
);
const MOST: Quantity = Quantity::plain(
    "no_more_than_percent",
    "no more than",
    "an effect is no larger than this, percent or points (95 %)",
);
const UNDONE: Quantity = Quantity::plain(
    "undone_by_scatter_percent",
    "a scatter that would undo it",
    "scatter from run to run that would undo it, percent or points; of one run a condition",
);
const Q: Quantity = Quantity::plain("q", "q", "false-discovery rate at which it would be claimed");
const VERDICT: Quantity = Quantity::plain("verdict", "shown", "what is shown");
const SCOPE: Quantity = Quantity::plain("scope", "of", "of whom it is told");
const OF_STRIPS: Quantity = Quantity::plain(
    "of_strips_95",
    "of the strips",
    "95 % interval of the same told of the strips as they were measured, where it is told of the material",
);
const OF_MATERIAL: Quantity = Quantity::plain(
    "of_material_95",
    "of the material",
    "95 % interval of the same told of the material, where it is told of the strips: strips differ by chance",
);
const BASIS: Quantity = Quantity::plain(
    "scatter_from",
    "scatter from",
    "where the scatter from run to run is known from",
);

/// A bar is drawn as far as this factor from its mark; one that goes on ends at the edge.
const WIDEST: f64 = 30.0;
/// Places at which a law is drawn.
const DRAWN: usize = 40;
/// Digits of a chance, and of a percentage.
const FEW: i32 = 2;

/// Table `contrasts`: every answer, or those of the study alone.
pub fn table<'a>(answers: impl IntoIterator<Item = &'a Answer>) -> Table {
    table_with(answers, |own| in_short(own).to_owned())
}

/// The same, with these words for what is shown.
fn table_with<'a>(
    answers: impl IntoIterator<Item = &'a Answer>,
    shown: impl Fn(&Answer) -> String + 'static,
) -> Table {
    let material = |own: &&Answer| match (&own.against_material, own.kind) {
        (Some(other), kind) if kind.is_by_material() => format!("{} / {other}", own.material),
        _ => own.material.clone(),
    };
    let ends = |ends: (Option<f64>, Option<f64>)| {
        ends.0
            .zip(ends.1)
            .map(|(low, high)| format!("{} to {}", significant(low, 3), significant(high, 3)))
    };
    let beside = move |own: Option<&InScope>| own.and_then(|own| ends((Some(own.low_95), Some(own.high_95))));
    let rough = |number: Option<f64>| number.map(|number| Value::Rough(number, FEW));
    Sheet::<&Answer>::new("contrasts", "What environment, humidity, voltage and material do to each parameter", 6)
        .remarks(
            "A ratio of conditions at equal voltage, its mean over the voltages that both have. Points are of bending lost in an hour. A law is the relative change per unit. Of a curve it is the largest difference over the times after the step, percent of the range of both together; its interval holds at all times together, its bound at each. Where one side is a bound the ratio is one too.",
            "Nothing was varied that could be compared.",
        )
        .column(KIND, |own| own.kind.label())
        .column(MATERIAL, material)
        .column(PARAMETER, |own| symbol(own.parameter))
        .column(UPPER, |own| own.upper.clone())
        .column(LOWER, |own| (!own.lower.is_empty()).then(|| own.lower.clone()))
        .column(VOLTAGES, |own| voltages(&own.voltages_v))
        .column(NUMBER, |own| own.estimate())
        .column(UNIT, unit)
        .column(MOST_AT, move |own| rough(own.most_at_s))
        .column(INTERVAL, |own| ends((own.low_95, own.high_95)))
        .column(SCOPE, |own| own.scope.label())
        .column(OF_STRIPS, move |own| beside(own.of_strips.as_ref()))
        .column(OF_MATERIAL, move |own| beside(own.of_material.as_ref()))
        .column(FITS_INTERVAL, |own| ends((own.fits_low_95, own.fits_high_95)))
        .column(MOST, move |own| rough(own.no_more_than))
        .column(UNDONE, move |own| rough(own.undone_by_scatter))
        .column(Q, move |own| rough(own.q))
        .column(VERDICT, move |own| shown(own))
        .column(BASIS, |own| own.basis.label())
        .column(SAMPLES, |own| own.samples)
        .column(RUNS, |own| format!("{} and {}", own.runs.0, own.runs.1))
        .column(ALSO, |own| own.also_changed.join("; "))
        .over(answers)
}

/// What the number of an answer is counted in.
fn unit(own: &&Answer) -> String {
    match (own.scale, own.unit()) {
        (Scale::Ratio, _) => "times".to_owned(),
        (Scale::OfRange, _) => "% of range".to_owned(),
        (Scale::Points, _) if !own.kind.is_law() => "points".to_owned(),
        (Scale::Points, "") => "points for one more".to_owned(),
        (Scale::Points, unit) => format!("points per {unit}"),
        (Scale::PerUnit, "") => "of itself for one more".to_owned(),
        (Scale::PerUnit, unit) => format!("of itself per {unit}"),
    }
}

/// The same on the page, which says beside it what is compared, what intervals rest on and what changed with what.
fn on_page<'a>(answers: impl IntoIterator<Item = &'a Answer>) -> Table {
    let beside = [
        KIND,
        VOLTAGES,
        MOST,
        OF_STRIPS,
        OF_MATERIAL,
        SCOPE,
        BASIS,
        SAMPLES,
        RUNS,
        ALSO,
    ];
    let table = table_with(answers, shown_in_words).without(&beside.map(|own| own.key));
    table.without_empty()
}

/// What is shown, and what would tell it where that is open.
fn shown_in_words(answer: &Answer) -> String {
    match Standing::of(answer) {
        Standing::Sure | Standing::Probably | Standing::InStrips => {
            let text = format!("{}changes {}", adverb(answer), in_strips(answer));
            text.trim_end().to_owned()
        }
        Standing::Alike => "does not change".to_owned(),
        Standing::Bound => in_short(answer).to_owned(),
        // How many strips there are stands once, above.
        Standing::Open if answer.reason.is_none() => UNTOLD.to_owned(),
        Standing::Open => untold(answer),
    }
}

/// Environments at each voltage, by the fits alone: a row a parameter and pair, a column a voltage.
fn at_each_voltage(study: &Study) -> Option<Table> {
    let single = |own: &&Answer| {
        own.kind == Kind::Environment && own.voltages_v.len() == 1 && own.scale == Scale::Ratio
    };
    let same = |a: &Answer, b: &Answer| {
        (&a.material, a.parameter, &a.upper, &a.lower) == (&b.material, b.parameter, &b.upper, &b.lower)
    };
    let all: Vec<&Answer> = study
        .answers
        .iter()
        .filter(single)
        .filter(|own| own.parameter != BENDING_PER_VOLT)
        .collect();
    let mut rows: Vec<Vec<&Answer>> = Vec::new();
    for own in &all {
        match rows.iter_mut().find(|row| same(row[0], own)) {
            Some(row) => row.push(own),
            None => rows.push(vec![own]),
        }
    }
    let mut voltages_v: Vec<f64> = all.iter().map(|own| own.voltages_v[0]).collect();
    voltages_v.sort_by(f64::total_cmp);
    voltages_v.dedup();
    let sheet = Sheet::<Vec<&Answer>>::new("at-each-voltage", "Environments at each voltage, by the errors of the fits alone", 4)
        .remarks("What would undo a difference, and the interval with the scatter from run to run, `ieap table contrasts` has.", "")
        .column(MATERIAL, |row| row[0].material.clone())
        .column(PARAMETER, |row| symbol(row[0].parameter))
        .column(UPPER, |row| row[0].upper.clone())
        .column(LOWER, |row| row[0].lower.clone());
    let sheet = voltages_v.iter().fold(sheet, |sheet, &voltage_v| {
        let head = Column::plain(
            &format!("at_{voltage_v}_v"),
            &volts(voltage_v),
            "at this step voltage",
        );
        sheet.column_under(head, move |row| {
            row.iter()
                .find(|own| own.voltages_v[0] == voltage_v)
                .map(|own| by_fits(own))
        })
    });
    (!rows.is_empty()).then(|| sheet.over(rows))
}

/// The page: the first answer of each material, their pictures, the other answers, then the tables.
pub fn view(study: &Study) -> Vec<Block> {
    let asked: Vec<&Answer> = study.asked().collect();
    let mut blocks = answers(study);
    blocks.push(Block::Say(design(study)));
    blocks.extend(causes(&asked));
    let table = Block::Table(on_page(asked.iter().copied()));
    blocks.push(Block::part("What the study asked", vec![table]));
    let laws: Table = laws::of(study);
    if !laws.rows.is_empty() {
        blocks.push(Block::part("Laws", vec![Block::Table(laws.without_empty())]));
    }
    if let Some(each) = at_each_voltage(study) {
        blocks.push(Block::part(
            "At each voltage",
            vec![Block::Table(each.without_empty())],
        ));
    }
    let mut how: Vec<Block> = basis(&asked).into_iter().map(Block::Say).collect();
    how.extend(left_out(study).into_iter().map(Block::Say));
    how.extend(odd_runs(&study.odd).into_iter().map(Block::Say));
    how.push(Block::Say(family(study)));
    how.push(Block::say(
        "Every answer, with voltages, materials and ratios of ratios, is in `ieap table contrasts`.",
    ));
    blocks.push(Block::part("How sure this is", how));
    blocks
}

/// What the intervals of what the study asked rest on, in sentences; none where it has no answer.
pub fn intervals(study: &Study) -> Vec<String> {
    basis(&study.asked().collect::<Vec<_>>())
}

/// What else changed with what was compared, once for all pairs and materials of which it holds; how it differed stands with each
/// answer in the table and in JSON.
fn causes(asked: &[&Answer]) -> Option<Block> {
    let name = |cause: &String| cause.split(" (").next().unwrap_or(cause).to_owned();
    let mut of_pairs: BTreeMap<(String, &str), BTreeSet<String>> = BTreeMap::new();
    for own in asked.iter().filter(|own| !own.kind.is_by_material()) {
        let pair = if own.lower.is_empty() {
            format!("by {}", own.upper)
        } else {
            format!("{} over {}", own.upper, own.lower)
        };
        let names = own.also_changed.iter().map(name);
        of_pairs.entry((pair, &own.material)).or_default().extend(names);
    }
    // Materials by what they share of a pair, then pairs by what they share of materials.
    let mut of_materials: BTreeMap<(String, BTreeSet<String>), Vec<&str>> = BTreeMap::new();
    for ((pair, material), names) in of_pairs.into_iter().filter(|(_, names)| !names.is_empty()) {
        of_materials.entry((pair, names)).or_default().push(material);
    }
    let mut causes: BTreeMap<(Vec<&str>, BTreeSet<String>), Vec<String>> = BTreeMap::new();
    for ((pair, names), of) in of_materials {
        causes.entry((of, names)).or_default().push(pair);
    }
    let said = causes.iter().map(|((of, names), pairs)| {
        let names: Vec<&String> = names.iter().collect();
        Block::Say(format!(
            "{}, {}: {}.",
            in_a_row(of),
            in_a_row(pairs),
            in_a_row(&names)
        ))
    });
    let head = Block::say(
        "What changed with it in this design may be the cause as well; only runs in another order tell which (`ieap plan`).",
    );
    (!causes.is_empty())
        .then(|| Block::part("What else changed", std::iter::once(head).chain(said).collect()))
}

/// What else changed with what was compared, for the first screen; none where nothing did.
pub fn confounded(study: &Study) -> Option<String> {
    let name = |said: &'_ String| {
        said.split_once(" (")
            .map_or(said.clone(), |(name, _)| name.to_owned())
    };
    let mut names: Vec<String> = study
        .asked()
        .flat_map(|own| &own.also_changed)
        .map(name)
        .collect();
    names.sort();
    names.dedup();
    (!names.is_empty()).then(|| {
        format!(
            "In this design {} changed as well, and may be the cause.",
            in_a_row(&names)
        )
    })
}

/// The picture of what is told first: a law over what it follows, a chart a material; none where no law is told first.
pub fn first_charts(study: &Study) -> Vec<Chart> {
    let Some(told) = first(study).filter(|own| own.kind.is_law()) else {
        return Vec::new();
    };
    let is_it = |own: &&Answer| own.is_of_study && (own.kind, own.parameter) == (told.kind, told.parameter);
    study.laws().filter(is_it).filter_map(law_chart).collect()
}

/// What is said of each material, then their pictures.
fn answers(study: &Study) -> Vec<Block> {
    let materials = study.materials();
    let said = materials.iter().flat_map(|material| lead(study, material));
    let charts = materials
        .iter()
        .filter_map(|material| chart(study, material))
        .chain(law_charts(study, |_| true));
    said.map(Block::Say).chain(charts.map(Block::Chart)).collect()
}

/// What was compared, and who said so.
fn design(study: &Study) -> String {
    let mut names: Vec<&str> = study.compared.iter().map(|factor| factor.key()).collect();
    names.extend(study.other_conditions());
    let all = in_a_row(&names);
    let text = match (study.is_declared, names.is_empty()) {
        (_, true) => "Nothing was varied that could be compared.".to_owned(),
        (true, _) => format!("The study compares {all}, as `[study]` in campaign.toml says."),
        (false, _) => format!("The campaign varies {all}; `[study]` in campaign.toml says what is asked."),
    };
    if study.has_one_strip_each() {
        text + " Each material is one strip: nothing is said of another."
    } else {
        text
    }
}

/// What surroundings do to each parameter of a material: a row a parameter, a mark a pair that the study asked.
fn chart(study: &Study, material: &str) -> Option<Chart> {
    let own: Vec<&Answer> = (study.asked())
        .filter(|own| own.material == material && own.kind == Kind::Environment && own.scale == Scale::Ratio)
        .collect();
    let mut keys: Vec<&str> = own
        .iter()
        .filter(|own| own.value.is_some())
        .map(|own| own.parameter)
        .collect();
    keys.dedup_by(|a, b| a == b);
    let mut rows: Vec<&str> = Vec::new();
    keys.into_iter().rev().for_each(|key| {
        if !rows.contains(&key) {
            rows.push(key)
        }
    });
    let mut pairs: Vec<(&str, &str)> = Vec::new();
    for own in &own {
        let pair = (own.upper.as_str(), own.lower.as_str());
        if !pairs.contains(&pair) && pairs.len() < Ink::COLOURS {
            pairs.push(pair);
        }
    }
    let mut seen = vec![0.5, 2.0];
    let mut layers = vec![Layer::guides(Mark::Upright, [1.0])];
    for (at, (upper, lower)) in pairs.iter().enumerate() {
        // Pairs stand beside each other in the row of their parameter, the first one above.
        let off = 0.5 * (0.5 - (at as f64 + 0.5) / pairs.len() as f64);
        let (mut points, mut bars) = (Vec::new(), Vec::new());
        for own in own
            .iter()
            .filter(|own| own.upper == *upper && own.lower == *lower)
        {
            let ends = own
                .low_95
                .zip(own.high_95)
                .or(own.fits_low_95.zip(own.fits_high_95));
            let row = rows.iter().position(|key| *key == own.parameter);
            if let (Some(value), Some((low, high)), Some(row)) = (own.value, ends, row) {
                seen.extend([low.max(value / WIDEST), high.min(value * WIDEST)]);
                points.push((value, row as f64 + off));
                bars.push((low, high));
            }
        }
        layers.push(
            Layer::new(
                format!("{upper} over {lower}"),
                Mark::Marks,
                Ink::Series(at),
                points,
            )
            .with_bars_across(bars),
        );
    }
    let mut x = Range::log("Ratio", "");
    x.always = seen;
    let names = rows.iter().map(|key| symbol(key).to_owned()).collect();
    let panel = Panel {
        x,
        y: Range::names(names),
        layers,
    };
    (!rows.is_empty()).then(|| {
        Chart::new(format!("{material}: what its surroundings do"), vec![panel])
            .told("Ratios at equal voltage, bars 95 %, with the scatter from run to run where the design tells it; a bar that reaches the edge goes on.")
    })
}

/// Every law that is shown over numbers, the clearest first: the values behind it, brought to the mean strip, and its band.
pub fn law_charts<'a>(
    study: &'a Study,
    is_asked: impl Fn(&str) -> bool + 'a,
) -> impl Iterator<Item = Chart> + 'a {
    let is_drawn = |own: &&Answer| own.verdict == Verdict::Differs && own.from_to.is_some();
    let mut laws: Vec<&Answer> = study.laws().filter(is_drawn).collect();
    laws.sort_by(|a, b| {
        let rank = |own: &Answer| (!own.is_of_study, own.p.unwrap_or(1.0));
        rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    let laws = laws.into_iter().filter(move |own| is_asked(own.parameter));
    laws.filter_map(law_chart)
}

fn law_chart(answer: &Answer) -> Option<Chart> {
    let (drawn, (from, to)) = (answer.drawn.as_ref()?, answer.from_to?);
    let (value, low, high) = (answer.value?, answer.low_95?, answer.high_95?);
    let info = ParameterInfo::of(answer.parameter);
    let factor = info.map_or(1.0, |info| info.shown_factor());
    let on_scale = |y: f64| match answer.scale {
        Scale::Points => y,
        Scale::Ratio | Scale::PerUnit | Scale::OfRange => factor * y.exp(),
    };
    let place = |k: usize| from + (to - from) * k as f64 / (DRAWN - 1) as f64;
    let at = |slope: f64, x: f64| on_scale(drawn.middle.1 + slope * (x - drawn.middle.0));
    let line = (0..DRAWN).map(|k| (place(k), at(value, place(k))));
    let ends = |k: usize| [at(low, place(k)), at(high, place(k))];
    let band = (0..DRAWN).map(|k| (ends(k)[0].min(ends(k)[1]), ends(k)[0].max(ends(k)[1])));
    let mut layers = vec![Layer::new("Law", Mark::Line, Ink::Readings, line).with_bars(band.collect())];
    let mut samples: Vec<&str> = drawn.points.iter().map(|own| own.sample.as_str()).collect();
    samples.sort_unstable();
    samples.dedup();
    for (at, sample) in samples.into_iter().enumerate() {
        let own = || drawn.points.iter().filter(|own| own.sample == sample);
        let bar = |own: &Point| {
            let reach = NORMAL_95 * own.error;
            (on_scale(own.y - reach), on_scale(own.y + reach))
        };
        let points = own().map(|own| (own.x, on_scale(own.y)));
        let layer = Layer::new(sample, Mark::Marks, Ink::Series(at % Ink::COLOURS), points);
        layers.push(layer.with_bars(own().map(bar).collect()));
    }
    let name = match info {
        Some(info) => format!("{} ({})", info.symbol, info.shown_unit()),
        None => symbol(answer.parameter).to_owned(),
    };
    let x = match answer.unit() {
        "" => answer.upper.clone(),
        unit => format!("{} ({unit})", answer.upper),
    };
    let y = match answer.scale {
        Scale::Points => Range::linear(name, ""),
        Scale::Ratio | Scale::PerUnit | Scale::OfRange => Range::log(name, ""),
    };
    let panel = Panel {
        x: Range::linear(capital(&x), ""),
        y,
        layers,
    };
    let title = format!("{} of {}", symbol(answer.parameter), answer.material);
    Some(Chart::new(title, vec![panel]).told(sentence(answer)))
}

/// What a terminal shows: the answers, then each question of the study in a line.
pub fn lines(study: &Study) -> Vec<Block> {
    let mut blocks: Vec<Block> = study
        .materials()
        .iter()
        .flat_map(|material| lead(study, material))
        .map(Block::Say)
        .collect();
    blocks.push(Block::Say(design(study)));
    blocks.extend(left_out(study).into_iter().map(Block::Say));
    blocks.extend(odd_runs(&study.odd).into_iter().map(Block::Say));
    blocks.extend(study.asked().map(|own| Block::Say(told_alone(own) + ".")));
    blocks
}

/// Whether anything is asked.
pub fn is_told(study: &Study) -> bool {
    !study.compared.iter().all(|factor| *factor == Factor::Material) && !study.answers.is_empty()
}
