//! The verb `plan`.

use super::asked::Preflight;
use super::changes::tried;
use super::document::PlanDocument;
use super::judged::judged;
use super::words;
use crate::pipeline::{Observer, PipelineError};

impl Preflight {
    /// Judges the run, and changes of it until each parameter that stays open is determined by one.
    ///
    /// # Errors
    /// A time, a voltage, a noise or the number of draws makes no sense.
    pub fn run(&self, observer: &dyn Observer) -> Result<PlanDocument, PipelineError> {
        self.check()?;
        observer.begin("judging the run as planned", self.draws as u64);
        let parameters = judged(&self.subject, &self.trial, (self.draws, self.seed), observer);
        observer.end();
        let changes = tried(self, &parameters, observer);
        let subject = &self.subject;
        Ok(PlanDocument {
            schema: "ieap/plan/1",
            answer: words::answer(self, &parameters, &changes),
            told_by: subject.told_by.clone(),
            model: subject.options.model.id,
            area_cm2: subject.area_cm2,
            trial: self.trial.clone(),
            current_noise_a: subject.current_noise.standard_deviation,
            curvature_noise_per_cm: subject.curvature_noise.map(|noise| noise.standard_deviation),
            draws: self.draws,
            seed: self.seed,
            parameters,
            changes,
            remarks: words::remarks(self),
        })
    }
}
