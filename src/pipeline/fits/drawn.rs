//! What is drawn of fits: as it is stored, or, of a fit that came from elsewhere, made again from the readings. A fit is a pure
//! function of these, so that numbers alone have to travel.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use super::instruments::Told;
use super::plan::{Planned, fit_plan};
use super::runs::FitReadings;
use crate::domain::{AskedFit, RunRecord};
use crate::pipeline::campaign::derived::Keyed;
use crate::pipeline::{Context, PipelineError};
use crate::store::{FitCurves, ResultKind};

/// Curves of fits of a campaign.
pub(crate) struct DrawnFits<'a> {
    context: &'a Context,
    /// How runs are fitted whose fit is up to date, by name; made where the first run asks for it.
    planned: OnceCell<BTreeMap<String, Keyed<Planned>>>,
    told: Told,
}

impl<'a> DrawnFits<'a> {
    pub(crate) fn new(context: &'a Context) -> DrawnFits<'a> {
        let planned = OnceCell::new();
        let told = Told::default();
        DrawnFits {
            context,
            planned,
            told,
        }
    }

    /// The curves of a run's fit; none where it has no fit, or one that came from elsewhere and is out of date.
    ///
    /// # Errors
    /// The database cannot be read, or the readings that a fit was made from elsewhere cannot be fitted here.
    pub(crate) fn of(&self, run: &RunRecord) -> Result<FitCurves, PipelineError> {
        let stored = self.context.store.fit_curves(&run.path)?;
        if run.fit.is_none() || !stored.curves.is_empty() || !stored.along.is_empty() {
            return Ok(stored);
        }
        let Some((_, run)) = self.planned()?.get(&run.path) else {
            return Ok(stored);
        };
        let made = FitReadings::load(self.context, run, &self.told)?.fit(run);
        let fit = made.map_err(|issue| PipelineError::Fault {
            step: format!("{}: curves of a fit that was made elsewhere", issue.place),
            reason: issue.message,
        })?;
        Ok(FitCurves {
            curves: fit.curves,
            along: fit.along,
        })
    }

    fn planned(&self) -> Result<&BTreeMap<String, Keyed<Planned>>, PipelineError> {
        if let Some(planned) = self.planned.get() {
            return Ok(planned);
        }
        let mut planned = fit_plan(self.context, &AskedFit::default())?.keyed();
        let keys = self.context.store.result_keys(ResultKind::Fit)?;
        planned.retain(|name, (key, _)| keys.get(name) == Some(key));
        Ok(self.planned.get_or_init(|| planned))
    }
}
