//! Modulus logs with what was found in them.

use std::collections::BTreeMap;

use super::results::{ResultDocument, ResultKind};
use super::{Store, StoreError};
use ieap_domain::{ModulusAnalysis, ModulusLog, RunCurve};

impl ResultDocument for ModulusAnalysis {
    const DRAWN: &'static [&'static str] = &["curves"];
}

/// What pages draw of an analysis.
#[derive(Default, serde::Deserialize)]
struct Drawn {
    curves: Vec<RunCurve>,
}

impl Store {
    /// Every current modulus log with its current analysis, or with the reason why there is none among its issues, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn modulus_logs(&self) -> Result<Vec<ModulusLog>, StoreError> {
        let stored = self.results::<ModulusAnalysis>(ResultKind::Modulus)?.into_iter();
        let mut stored: BTreeMap<String, _> =
            stored.map(|stored| (stored.origin.name, stored.found)).collect();
        let logs = self.dma_logs()?.into_iter();
        logs.map(|mut run| {
            let analysis = match stored.remove(&run.path) {
                Some(Ok(mut analysis)) => {
                    let drawn: Option<Drawn> = self.drawn(ResultKind::Modulus, &run.path)?;
                    analysis.curves = drawn.unwrap_or_default().curves;
                    Some(analysis)
                }
                Some(Err(issue)) => {
                    run.issues.push(issue);
                    None
                }
                None => None,
            };
            Ok(ModulusLog { run, analysis })
        })
        .collect()
    }
}
