//! Diagnoses: which are current, and which runs they found to be wrong.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::new_run::RunRow;
use super::results::{ResultDocument, ResultKind, ResultOrigin};
use super::{Store, StoreError};
use ieap_domain::{CondemnedRun, GroupDiagnosis, RunComparison, RunKind};

impl ResultDocument for RunComparison {}

/// A diagnosis as it is stored, of a group or of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Diagnosed {
    /// The runs that it was made from, those that it condemns among them, with their revisions.
    pub members: Vec<(String, u32)>,
    /// Hash of the library of effects.
    pub library: String,
    /// Seed of the draws.
    pub seed: u64,
    /// Number of draws.
    pub draws: usize,
    /// What was found.
    #[serde(flatten)]
    pub found: GroupDiagnosis,
}

impl ResultDocument for Diagnosed {}

/// A current diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredDiagnosis {
    /// What it is about: a group, or one run alone.
    pub kind: ResultKind,
    /// What it was made from.
    pub origin: ResultOrigin,
    /// What was found, and how it was asked.
    pub diagnosed: Diagnosed,
}

/// What of a diagnosis tells which runs it condemns.
#[derive(Serialize, Deserialize)]
struct Condemning {
    members: Vec<(String, u32)>,
    #[serde(default)]
    condemned: Vec<CondemnedRun>,
}

impl ResultDocument for Condemning {}

impl Store {
    /// Current diagnoses by kind and name; those of a run that has a newer revision are left out.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn diagnoses(&self) -> Result<Vec<StoredDiagnosis>, StoreError> {
        let _moment = self.snapshot()?;
        let runs = self.current_revisions()?;
        let mut all = Vec::new();
        for (name, kind) in [
            ("diagnoses of groups", ResultKind::Group),
            ("diagnoses of runs", ResultKind::Run),
        ] {
            for stored in self.all_results::<Diagnosed>(name, kind)?.iter() {
                let Ok(mut diagnosed) = stored.found.clone() else {
                    continue;
                };
                diagnosed.found.draws = diagnosed.draws;
                let is_current =
                    |(run, revision): &(String, u32)| runs.get(run).is_some_and(|(_, now)| now == revision);
                if diagnosed.members.iter().all(is_current) {
                    all.push(StoredDiagnosis {
                        kind,
                        origin: stored.origin.clone(),
                        diagnosed,
                    });
                }
            }
        }
        Ok(all)
    }

    /// Current runs whose readings the current diagnosis of their group found to be wrong: row id and reason. A diagnosis
    /// of which another run was read anew still holds for this one.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn condemned_by_diagnosis(&self) -> Result<BTreeMap<i64, String>, StoreError> {
        let _moment = self.snapshot()?;
        let runs = self.current_revisions()?;
        let mut all = BTreeMap::new();
        for (name, kind) in [
            ("condemned in groups", ResultKind::Group),
            ("condemned alone", ResultKind::Run),
        ] {
            let found = self.all_results::<Condemning>(name, kind)?;
            for diagnosis in found.iter().filter_map(|stored| stored.found.as_ref().ok()) {
                for odd in &diagnosis.condemned {
                    let then = diagnosis.members.iter().find(|(run, _)| *run == odd.run);
                    let now = runs.get(&odd.run);
                    if let (Some((_, then)), Some((id, now))) = (then, now)
                        && then == now
                    {
                        all.insert(*id, odd.reason.clone());
                    }
                }
            }
        }
        Ok(all)
    }

    /// Row id and revision of every current run, by name.
    fn current_revisions(&self) -> Result<BTreeMap<String, (i64, u32)>, StoreError> {
        let runs = self.current_rows(RunKind::Actuation)?;
        let of = |run: &Arc<RunRow>| (run.path.clone(), (run.id, run.revision));
        Ok(runs.iter().map(of).collect())
    }
}
