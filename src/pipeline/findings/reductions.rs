//! Where simpler circuits would do: every run of steps is fitted with them whenever it is asked. Nothing of it is stored.

use std::collections::BTreeMap;

use crate::analysis::reductions::{ReducedCircuit, RunReductions};
use crate::domain::fault::caught;
use crate::domain::number::fixed;
use crate::domain::{Channel, RunRecord};
use crate::fit::{Circuit, FitInput, Reduction, Reductions, reductions};
use crate::pipeline::campaign::batch::compute;
use crate::pipeline::campaign::readings;
use crate::pipeline::{Context, PipelineError};
use crate::store::FitTask;

/// Every run that can be fitted, in the order of `runs`.
///
/// # Errors
/// The database cannot be read.
pub fn reductions_of(context: &Context, runs: &[RunRecord]) -> Result<Vec<RunReductions>, PipelineError> {
    let tasks = context.store.fit_tasks()?;
    let by_id: BTreeMap<i64, &FitTask> = tasks.iter().map(|task| (task.run_id, task)).collect();
    let ready: Vec<&FitTask> = runs
        .iter()
        .filter_map(|run| by_id.get(&run.id).copied())
        .filter(|task| !task.drive.moves())
        .collect();
    let load = |context: &Context, task: &&FitTask| readings::of_task(context, task);
    compute(context, &ready, load, |task, channels| of_run(task, &channels))
}

fn of_run(task: &FitTask, channels: &[Channel]) -> RunReductions {
    let drive = readings::placed(task, channels);
    let input = FitInput {
        channels,
        drive: &drive,
        area_cm2: task.area_cm2,
    };
    let fitted = caught(|| reductions(&input).map_err(|error| error.to_string()));
    RunReductions {
        run_id: task.run_id,
        path: task.path.clone(),
        found: fitted
            .unwrap_or_else(|reason| Err(format!("a fault of the program stopped the fit: {reason}")))
            .and_then(shown),
    }
}

/// Nothing where the full circuit misfits: then the readings are those of none of them.
fn shown(found: Reductions) -> Result<Vec<ReducedCircuit>, String> {
    if found.circuits.is_empty() {
        Err(format!(
            "two branches beside R_ss themselves leave {} times the noise: none of these circuits is that of the run",
            fixed(found.full_leaves, 0)
        ))
    } else {
        Ok(found.circuits.iter().map(as_shown).collect())
    }
}

fn as_shown(own: &Reduction) -> ReducedCircuit {
    ReducedCircuit {
        circuit: match own.circuit {
            Circuit::NoLeak => "two branches, no leak",
            Circuit::OneBranch => "one branch (7G, 7F)",
            Circuit::OneBranchNoLeak => "one branch, no leak (7B)",
        },
        parameters_saved: own.parameters_saved,
        chi_square_rise: own.chi_square_rise,
        p: own.p,
        current_differs_percent: own.current_differs_percent,
        curvature_differs_percent: own.curvature_differs_percent,
        elements: own.elements,
    }
}
