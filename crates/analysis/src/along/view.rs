//! The page of all runs that are read along the strip: what each shows, and table 3. Maps, shapes and voltages of a run have
//! a page of their own, which this one leads to.

use ieap_domain::tag::keys;
use ieap_domain::words::counted;
use ieap_domain::{Issue, Quantity as Measured, RunRecord};
use ieap_show::quantities::{ENVIRONMENT, HUMIDITY, MATERIAL, Quantity, RUN, VOLTAGE};
use ieap_show::{Block, Sheet, Source, SourceOrigin, Table, rough};

use super::{decision_issue, residual_ratio};
use crate::conditions::{material, nominal_voltage_v};
use crate::tables::TableInput;

/// A parameter that only the distributed model has: its fits are told by it.
const MARK: &str = "re_ohm_per_sq";

const CURVATURE_PLACES: Quantity = Quantity::new(
    "curvature_places",
    "Curvature",
    "places where the curvature is read",
    "places",
);
const VOLTAGE_PLACES: Quantity = Quantity::new(
    "voltage_places",
    "Voltage",
    "places where the voltage is read",
    "places",
);
const CURVATURE_RESIDUAL: Quantity = Quantity::new(
    "curvature_residual",
    "Curvature",
    "residual of the curvature over its noise",
    "residual / noise",
);
const VOLTAGE_RESIDUAL: Quantity = Quantity::new(
    "voltage_residual",
    "Voltage",
    "residual of the voltage over its noise",
    "residual / noise",
);

/// The page, with table `table3`.
pub fn view(input: &TableInput, table3: Table) -> Vec<Block> {
    let along: Vec<&RunRecord> = input.runs.iter().filter(|run| run.is_along()).collect();
    let is_fitted = |run: &&&RunRecord| (run.fit.as_ref()).is_some_and(|fit| fit.parameter(MARK).is_some());
    let is = |count: usize| if count == 1 { "is" } else { "are" };
    let fitted = match along.iter().filter(is_fitted).count() {
        0 => "none is".to_owned(),
        some => format!("{some} {}", is(some)),
    };
    let mut blocks = vec![Block::say(format!(
        "{} {} read at several places along the strip; {fitted} fitted with the distributed model.",
        counted(along.len(), "run"),
        is(along.len()),
    ))];
    let decisions = along
        .iter()
        .filter_map(|run| Some(decision_issue(run)?.clone().at(&run.path)));
    let decisions: Vec<Issue> = decisions.collect();
    blocks.push(Block::Table(runs(input, along)));
    blocks.extend(Block::issues(&decisions));
    if !table3.rows.is_empty() {
        blocks.push(Block::Table(table3));
        blocks.push(Block::say(
            "The same table for a thesis: `ieap table table3 --format latex`",
        ));
    }
    blocks
}

fn runs(input: &TableInput, along: Vec<&RunRecord>) -> Table {
    let residual = |run: &RunRecord, quantity: Measured| {
        let fit = run.fit.as_ref().filter(|_| run.places(quantity) > 0);
        rough(fit.and_then(|fit| residual_ratio(fit, quantity)))
    };
    Sheet::<&RunRecord>::new("along", "Runs", 1)
        .made_from(|run| vec![Source::of(SourceOrigin::Strip, &run.path)])
        .column(RUN, |run| run.path.as_str())
        .column(MATERIAL, |run| material(run, input.campaign))
        .column(ENVIRONMENT, |run| run.tag(keys::ENVIRONMENT))
        .column(HUMIDITY, |run| run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT))
        .column(VOLTAGE, |run| nominal_voltage_v(run))
        .column(CURVATURE_PLACES, |run| run.places(Measured::Curvature))
        .column(VOLTAGE_PLACES, |run| run.places(Measured::Voltage))
        .column(Quantity::plain("model", "Model", "model"), |run| match &run.fit {
            Some(fit) => fit.model.clone(),
            None => run.state.why_unfitted().to_owned(),
        })
        .column(CURVATURE_RESIDUAL, |run| residual(run, Measured::Curvature))
        .column(VOLTAGE_RESIDUAL, |run| residual(run, Measured::Voltage))
        .over(along)
}
