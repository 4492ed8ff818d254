//! `ieap run --only fit --group`: runs of one sample in one condition fitted at once; `--profile` and `--bootstrap` without it: the
//! same intervals for every run by itself.

use clap::Args;

use super::exit::CliError;
use super::output::Output;
use crate::domain::Estimate;
use crate::domain::number::estimates::{ends, in_words, interval_in_words, spread as in_two_digits};
use crate::domain::number::{fixed, significant, upper_bound};
use crate::domain::words::counted;
use crate::pipeline::documents::groups::{GroupEntry, GroupRunEntry};
use crate::pipeline::{FitChoice, FitGroups, FitTogether, Sharing};

/// Refits below which a bootstrap tells nothing of the ends of a 95 % interval.
const FEWEST_REFITS: usize = 40;

/// How groups of runs are fitted.
#[derive(Debug, Args)]
pub struct GroupArgs {
    /// Fit the runs of each group (one sample, one environment and humidity; group_by in campaign.toml) at once with
    /// shared parameters, and print these fits; the fits of single runs are made as always
    #[arg(long)]
    group: bool,
    /// Parameters that the runs of a group share; the others are free in every run [default: all]
    #[arg(
        long,
        value_name = "KEYS",
        value_delimiter = ',',
        requires = "group",
        conflicts_with = "free"
    )]
    shared: Option<Vec<String>>,
    /// Parameters that are free in every run; the others are shared
    #[arg(long, value_name = "KEYS", value_delimiter = ',', requires = "group")]
    free: Option<Vec<String>>,
    /// Find every interval by profile likelihood, not only where the covariance would mislead; printed for every run by
    /// itself, or for groups with --group
    #[arg(long)]
    profile: bool,
    /// Add the spread of N fits to readings whose residuals were drawn again in blocks, for every run or, with --group,
    /// every group
    #[arg(long, value_name = "N")]
    bootstrap: Option<usize>,
}

impl GroupArgs {
    /// The fits asked for beside those that are stored; none without `--group`, `--profile` or `--bootstrap`.
    pub fn groups(&self, choice: FitChoice) -> Result<Option<FitGroups>, CliError> {
        if !self.group && !self.profile && self.bootstrap.is_none() {
            return Ok(None);
        }
        if !choice.known.is_empty() {
            return Err(CliError::usage(
                "--set goes with fits of runs by themselves; leave --group, --profile and --bootstrap out",
            ));
        }
        if let Some(found) = self.bootstrap.filter(|&n| n < FEWEST_REFITS) {
            return Err(CliError::usage(&format!(
                "--bootstrap: found {found}, needed {FEWEST_REFITS} or more (200 tell a standard error to 5 %)"
            )));
        }
        let sharing = match (&self.shared, &self.free) {
            (Some(keys), _) => Sharing::Only(keys.clone()),
            (None, Some(keys)) => Sharing::AllBut(keys.clone()),
            (None, None) => Sharing::All,
        };
        Ok(Some(FitGroups {
            choice,
            of: if self.group {
                FitTogether::Groups
            } else {
                FitTogether::SingleRuns
            },
            sharing,
            profile: self.profile,
            bootstrap: self.bootstrap,
        }))
    }
}

/// Prints a group: what its runs share, then what each has for itself.
pub fn print(group: &GroupEntry, output: &Output) {
    output.result(&format!(
        "{}  {}  {}",
        group.group, group.model, group.why_stopped
    ));
    if let (Some(square), Some(freedom)) = (group.chi_square, group.degrees_of_freedom) {
        output.result(&format!(
            "    {}, weighted sum of squares {} for {} degrees of freedom",
            counted(group.runs.len(), "run"),
            fixed(square, 1),
            fixed(freedom, 0)
        ));
    }
    if let Some(sharing) = &group.sharing {
        output.result(&format!(
            "    sharing costs {} for {} parameters fewer, chance {}",
            fixed(sharing.chi_square_rise, 1),
            sharing.parameters_saved,
            chance(sharing.p)
        ));
    }
    let is_common = |key: &str| group.parameters.iter().any(|(common, _)| common == key);
    let first = group.fits.first();
    for (key, parameter) in &group.parameters {
        output.result(&line(key, parameter, first));
    }
    for run in &group.fits {
        output.result(&format!("  {}", run.run));
        for (key, parameter) in run.parameters.iter().filter(|(key, _)| !is_common(key)) {
            output.result(&line(key, parameter, Some(run)));
        }
        for noise in &run.noise {
            output.result(&format!(
                "    {:<22} {} x noise",
                format!("residual {}", noise.quantity.column()),
                fixed(noise.residual_rms / noise.standard_deviation, 2)
            ));
        }
    }
    for left_out in &group.left_out {
        output.issue(&left_out.run, &left_out.issue);
    }
    for issue in &group.issues {
        output.issue(&group.group, issue);
    }
}

fn chance(p: f64) -> String {
    if p < 1e-9 {
        upper_bound(1e-9)
    } else {
        significant(p, 3)
    }
}

fn line(key: &str, parameter: &Estimate, run: Option<&GroupRunEntry>) -> String {
    let bootstrap = run.and_then(|run| run.bootstrap.iter().find(|(own, _)| own == key));
    let spread = bootstrap.map_or_else(String::new, |(_, of)| {
        format!(
            "; bootstrap ± {}, {}",
            in_two_digits(of.standard_deviation),
            ends(of.low_95, of.high_95)
        )
    });
    let interval = interval_in_words(parameter);
    format!("    {key:<22} {}{interval}{spread}", in_words(parameter))
}
