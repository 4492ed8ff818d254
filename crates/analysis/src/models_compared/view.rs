//! Models held against each other as they are shown: the table, the picture of a run, the page.

use ieap_domain::number::fixed;
use ieap_domain::{Campaign, ComparedCurve, RunComparison, RunRecord};
use ieap_show::quantities::{ENVIRONMENT, MATERIAL, Quantity};
use ieap_show::{Block, Chart, Ink, Layer, Mark, Panel, Range, Sheet, Source, SourceOrigin, Table, Value};

use super::{ComparedCondition, ComparedModel, models_compared, outdated};

/// Digits of a multiple of the noise, and of a time.
const DIGITS: i32 = 2;
/// Residuals are shown within this multiple of the noise at least, and at most.
const RESIDUALS: (f64, f64) = (4.0, 40.0);

/// Comparisons that speak, with what they are of.
#[derive(Clone, Copy)]
pub struct Compared<'a> {
    /// Comparisons of models on single runs.
    pub comparisons: &'a [RunComparison],
    /// Number of those that are not among them, since what they were made from has changed.
    pub outdated: usize,
    /// Every run.
    pub runs: &'a [RunRecord],
    /// The campaign.
    pub campaign: &'a Campaign,
}

impl Compared<'_> {
    /// By material and surroundings.
    pub fn conditions(&self) -> Vec<ComparedCondition> {
        models_compared(self.comparisons, self.runs, self.campaign)
    }
}

/// One row a material, surroundings and model: table `models`.
pub fn table(found: Compared) -> Table {
    let conditions = found.conditions();
    let rough = |number: Option<f64>| number.map_or(Value::Missing, |number| Value::Rough(number, DIGITS));
    type Of<'a> = (&'a ComparedCondition, &'a ComparedModel);
    let sources = |row: &Of| {
        let of_run = |&place: &usize| {
            let name = &found.comparisons[place].run;
            let run = found.runs.iter().find(|run| run.path == *name)?;
            Some(Source::of(SourceOrigin::Comparison(run.id), name))
        };
        row.0.comparisons.iter().filter_map(of_run).collect()
    };
    let seconds = Quantity::new("seconds", "Time", "time that its fits took together", "s");
    let table = Sheet::<Of>::new("models", "Models compared", 3)
        .made_from(sources)
        .column(MATERIAL, |(of, _)| of.material.clone())
        .column(Quantity { key: "surroundings", ..ENVIRONMENT.called(ENVIRONMENT.symbol, "surroundings") }, |(of, _)| {
            of.surroundings.clone()
        })
        .column(Quantity::plain("model", "Model", "model, the best first"), |(_, own)| own.model.clone())
        .column(Quantity::plain("runs", "Runs", "number of runs that it describes in all responses"), |(_, own)| {
            own.runs
        })
        .column(Quantity::plain("parameters", "Parameters", "number of parameters that are searched"), |(_, own)| {
            own.parameters
        })
        .column(
            Quantity::plain("leaves_current", "Current", "what it leaves of the current, in units of the noise, root mean square, median over the runs"),
            move |(_, own)| rough(own.leaves_current),
        )
        .column(
            Quantity::plain("leaves_curvature", "Curvature", "what it leaves of the curvature, in units of the noise, root mean square, median over the runs"),
            move |(_, own)| rough(own.leaves_curvature),
        )
        .column(
            Quantity::plain("later", "Later times", "what it leaves of later times, in units of the noise, root mean square, median over the runs"),
            move |(_, own)| rough(own.later),
        )
        .column(
            Quantity::plain("other_voltages", "Other voltages", "what it leaves at other voltages, in units of the noise, root mean square, median over the runs"),
            move |(_, own)| rough(own.other_voltages),
        )
        .column(Quantity::plain("bic_beyond_best", "BIC", "Bayesian information criterion less that of the best"), |(_, own)| {
            own.bic_beyond_best.map(f64::round)
        })
        .column(seconds, move |(_, own)| rough(Some(own.seconds)))
        .over(conditions.iter().flat_map(|of| of.models.iter().map(move |model| (of, model))));
    let outdated = outdated(found.outdated);
    let remark = match (conditions.is_empty(), outdated.is_empty()) {
        (true, true) => "No models were compared yet: `ieap compare` does it.",
        (true, false) => "",
        (false, _) => {
            "Every model has the same circuit step and the same noise, found without the models; what differs is how the charge bends the strip. BIC is summed over the runs, less that of the best; models that do not describe all runs have none. Later times: the last 30 % of a run, predicted by a fit to what came before. Other voltages: predicted with the parameters of the runs at the nearest lower and higher voltage."
        }
    };
    let sentences = conditions.into_iter().map(|of| of.sentence);
    let further = [outdated, remark.to_owned()]
        .into_iter()
        .filter(|text| !text.is_empty());
    Table {
        remarks: sentences.chain(further).collect(),
        ..table
    }
}

/// One run: what was measured with every model's curve, and what each leaves in units of the noise. None where nothing is
/// drawn of it.
pub fn chart(title: &str, one: &RunComparison) -> Option<Chart> {
    let deciding = one.deciding()?;
    let curve = one.curves.iter().find(|curve| curve.quantity == deciding)?;
    let readings = Layer::over(
        "Readings",
        Mark::Readings,
        Ink::Readings,
        &curve.time_s,
        &curve.measured,
    );
    let response = Panel {
        x: Range::linear("Time", "s"),
        y: Range::linear(deciding.label(), deciding.unit()),
        layers: [readings]
            .into_iter()
            .chain(lines(one, curve, |_, fitted| fitted))
            .collect(),
    };
    let mut left = lines(one, curve, |k, fitted| (curve.measured[k] - fitted) / curve.noise);
    let points = || left.iter().flat_map(|line| &line.points);
    let largest = points().fold(0.0_f64, |most, point| most.max(point.1.abs()));
    let half = largest.clamp(RESIDUALS.0, RESIDUALS.1);
    for point in left.iter_mut().flat_map(|line| &mut line.points) {
        point.1 = point.1.clamp(-half, half);
    }
    let residuals = Panel {
        x: Range::linear("Time", "s"),
        y: Range::linear("Residual / noise", "").with(-half).with(half),
        layers: left,
    };
    let beyond = format!(
        "Residuals beyond {} times the noise lie at the edge.",
        fixed(half, 0)
    );
    Some(
        Chart::new(title, vec![response, residuals]).told(if largest > half {
            beyond
        } else {
            String::new()
        }),
    )
}

fn lines(one: &RunComparison, curve: &ComparedCurve, value: impl Fn(usize, f64) -> f64) -> Vec<Layer> {
    let fitted = one.models.iter().zip(&curve.fitted).enumerate();
    fitted
        .filter(|(_, (_, fitted))| !fitted.is_empty())
        .map(|(at, (score, fitted))| {
            let values: Vec<f64> = fitted.iter().enumerate().map(|(k, own)| value(k, *own)).collect();
            Layer::over(
                score.model.as_str(),
                Mark::Line,
                Ink::Series(at),
                &curve.time_s,
                &values,
            )
        })
        .collect()
}

/// One run of every material and environment, that of the highest voltage, or the run that is asked for: its picture, and
/// its path.
pub fn charts(found: Compared, run: Option<&str>) -> Vec<(Chart, String)> {
    let of = |of: &ComparedCondition| {
        let mut all = of.comparisons.iter().map(|&place| &found.comparisons[place]);
        let one = match run {
            Some(path) => all.find(|one| one.run == path),
            None => all.next_back(),
        }?;
        let title = format!("{} in {}, {}", of.material, of.surroundings, one.run);
        Some((chart(&title, one)?, one.run.clone()))
    };
    found.conditions().iter().filter_map(of).collect()
}

/// The page.
pub fn view(found: Compared) -> Vec<Block> {
    let sentences = found.conditions().len();
    let mut table = table(found).without(&["seconds"]);
    let said: Vec<String> = table.remarks.drain(..sentences).collect();
    let mut blocks: Vec<Block> = said.into_iter().map(Block::Say).collect();
    blocks.push(Block::Table(table));
    for (chart, run) in charts(found, None) {
        blocks.push(Block::Chart(chart));
        blocks.push(Block::Runs("The run at the highest voltage", vec![run]));
    }
    blocks
}
