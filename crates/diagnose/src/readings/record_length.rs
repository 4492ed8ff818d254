//! Time constants that grow with the length of the record: a sum of exponentials has none that do, a power law does.

use ieap_domain::Estimate;
use ieap_domain::seconds::seconds;
use ieap_fit::{FitOptions, fit_run};
use ieap_model::FitModel;

use crate::readings::group::RunGroup;

/// A record so many times as long as another is one of another length.
const LONGER: f64 = 2.0;
/// A time constant so many times as large has grown.
const GROWN: f64 = 1.5;

/// A sentence where the slowest determined time constant of every run alone grows with the length of its record.
pub(crate) fn remark(group: &RunGroup, model: &'static FitModel) -> Option<String> {
    let options = FitOptions {
        model,
        ..FitOptions::default()
    };
    let mut found: Vec<(f64, f64)> = Vec::new();
    for run in &group.runs {
        let fit = fit_run(&run.given.input, &options).ok();
        let value = |k: usize| {
            let estimate: Option<&Estimate> = fit.as_ref()?.parameter(&format!("tau{k}_s"));
            estimate?.value
        };
        if let Some(tau_s) = (1..=model.branches).rev().find_map(value) {
            found.push((run.duration_s, tau_s));
        }
    }
    grows(&found).then(|| {
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let said = |&(duration_s, tau_s): &(f64, f64)| format!("{} s in {} s", seconds(tau_s), seconds(duration_s));
        let ends = [found.first(), found.last()].into_iter().flatten().map(said);
        format!(
            "time constants grow with the length of the record ({}): that is a power law, such as diffusion, and no sum \
             of exponentials",
            ends.collect::<Vec<_>>().join(", ")
        )
    })
}

/// Whether every clearly longer record (duration, time constant) has a clearly larger time constant.
fn grows(found: &[(f64, f64)]) -> bool {
    let pairs = found.iter().flat_map(|a| found.iter().map(move |b| (a, b)));
    let mut longer = pairs.filter(|(a, b)| b.0 > LONGER * a.0).peekable();
    longer.peek().is_some() && longer.all(|(a, b)| b.1 > GROWN * a.1)
}

#[cfg(test)]
mod tests {
    use super::grows;

    #[test]
    fn growth_needs_records_of_different_lengths_that_all_agree() {
        assert!(grows(&[(2.0, 0.4), (50.0, 10.0), (200.0, 60.0), (200.0, 40.0)]));
        assert!(!grows(&[(200.0, 60.0), (200.0, 40.0)]), "one length");
        assert!(!grows(&[(2.0, 0.4), (50.0, 0.41)]), "none grows");
        assert!(!grows(&[(2.0, 0.4), (50.0, 10.0), (200.0, 9.0)]), "not all agree");
    }
}
