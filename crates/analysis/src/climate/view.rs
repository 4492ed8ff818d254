//! What the page of the climate shows, and the page of a run of its own.

use ieap_domain::number::fixed;
use ieap_domain::tag::keys;
use ieap_domain::words::counted;
use ieap_domain::{Campaign, ClimateAssessment, ClimateCurve, ClimateQuantity, Issue, RunRecord};
use ieap_show::{Block, Table};

use super::{charts, sheet};
use crate::zone::Zone;

/// Issues of runs that are listed.
const RUN_ISSUES: [&str; 4] = [
    "climate-left-tolerance",
    "climate-above-limit",
    "climate-sensors-differ",
    "tag-disagreement",
];

/// The logs of a campaign, its runs, and start and end of those whose start is known, s since 1970 UTC.
pub fn view(
    climate: &ClimateAssessment,
    campaign: &Campaign,
    runs: &[RunRecord],
    runs_s: &[(f64, f64)],
) -> Vec<Block> {
    let zone = Zone::of(campaign);
    let mut blocks: Vec<Block> = summary(climate, runs).into_iter().map(Block::Say).collect();
    blocks.push(Block::Say(rules(climate, campaign, &zone)));
    blocks.extend(charts::over_time(climate, runs_s).map(Block::Chart));
    let flagged: Vec<Issue> = runs.iter().flat_map(flagged).collect();
    let lists = [
        ("Runs to look at", Block::issues(&flagged)),
        ("Problems found", Block::issues(&climate.issues)),
    ];
    let lists = lists
        .into_iter()
        .filter_map(|(title, issues)| Some((title, issues?)));
    blocks.extend(lists.map(|(title, issues)| Block::part(title, vec![issues])));
    let tables = [
        sheet::sensors(climate, &zone),
        sheet::pairs(climate),
        sheet::exposures(climate, &zone),
    ];
    let is_shown = |table: &Table| !table.rows.is_empty();
    blocks.extend(tables.into_iter().filter(is_shown).map(Block::Table));
    blocks
}

/// The climate of a run and around it; nothing where no log says anything of it.
pub fn of_run(run: &RunRecord, curves: &[ClimateCurve]) -> Vec<Block> {
    if run.climate.is_empty() {
        return Vec::new();
    }
    let firsts = run.channels.iter().filter_map(|channel| channel.first_time_s);
    let lasts = run.channels.iter().filter_map(|channel| channel.last_time_s);
    let length_s = lasts.fold(0.0, f64::max) - firsts.fold(0.0, f64::min);
    let chart = charts::around_run(curves, length_s).map(Block::Chart);
    let table = Block::Table(sheet::of_run(&run.climate));
    chart.into_iter().chain([table]).collect()
}

fn summary(climate: &ClimateAssessment, runs: &[RunRecord]) -> Vec<String> {
    if climate.sensors.is_empty() {
        return vec![
            "No climate log was found. Copy the files of humidity and temperature loggers, gauges and gas analysers into \
             ambient/."
                .to_owned(),
        ];
    }
    let count = |is: &dyn Fn(&RunRecord) -> bool| runs.iter().filter(|run| is(run)).count();
    let flagged = |code: &str| count(&|run| run.issues.iter().any(|issue| issue.code == code));
    let covered = count(&RunRecord::is_covered_by_log);
    let clocks = climate.pairs.iter().filter(|pair| pair.clock_ahead_h.is_some());
    let said = [
        (
            flagged("climate-left-tolerance"),
            "run",
            "the climate left the tolerance while the run went on",
        ),
        (
            flagged("climate-above-limit"),
            "run",
            "oxygen or water rose above the stated limit",
        ),
        (
            count(&RunRecord::climate_label_differs),
            "run",
            "the label and the measured climate differ",
        ),
        (
            clocks.count(),
            "pair",
            "of sensors clocks differ by hours; nothing was corrected",
        ),
    ];
    let said = said.into_iter().filter(|(count, ..)| *count > 0);
    let said = said.map(|(count, thing, what)| format!("In {} {what}.", counted(count, thing)));
    let lead = format!("The logs cover {covered} of {}.", counted(runs.len(), "run"));
    [lead].into_iter().chain(said).collect()
}

/// The rules that runs are held against, and those of chambers where anything is measured there.
fn rules(climate: &ClimateAssessment, campaign: &Campaign, zone: &Zone) -> String {
    let rules = &campaign.climate;
    let measured = |quantity| climate.sensors.iter().any(|one| one.quantity == quantity);
    let mut said = format!(
        "A run is flagged where a reading lies more than {} % of humidity or {} °C from its mean; a run has a value only \
         where no two neighbouring readings lie more than {} min apart; hours above {} % count as exposure.",
        rules.relative_humidity_tolerance_percent,
        rules.temperature_tolerance_c,
        fixed(rules.longest_gap_s / 60.0, 0),
        rules.exposure_above_percent
    );
    if measured(ClimateQuantity::Pressure) {
        said += &format!(
            " Of a pressure {} % of its mean are allowed.",
            rules.pressure_tolerance_percent
        );
    }
    for (quantity, limit) in [
        (ClimateQuantity::Oxygen, rules.oxygen_limit_ppm),
        (ClimateQuantity::Water, rules.water_limit_ppm),
    ] {
        if measured(quantity) {
            said += &match limit {
                Some(limit) => format!(" {} may not rise above {limit} ppm.", quantity.label()),
                None => format!(" No limit of {} is stated.", quantity.label().to_lowercase()),
            };
        }
    }
    format!("{said} Times are those of {}.", zone.name())
}

/// What a run has to be looked at for, each led to the run.
fn flagged(run: &RunRecord) -> impl Iterator<Item = Issue> {
    let is_climate = |place: &str| {
        place == keys::RELATIVE_HUMIDITY_PERCENT
            || ClimateQuantity::MEASURED
                .iter()
                .any(|quantity| quantity.key() == place)
    };
    let issues = run.issues.iter();
    let own =
        issues.filter(move |issue| RUN_ISSUES.contains(&issue.code.as_str()) && is_climate(&issue.place));
    own.map(|issue| issue.clone().at(&run.path))
}
