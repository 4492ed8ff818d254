//! The modulus of a strip, from the modulus logs of its sample or of its material, and where it is from.

use crate::analysis::stiffness::sample_modulus;
use crate::domain::number::fixed;
use crate::domain::words::in_a_row;
use crate::domain::{Estimate, Sample};
use crate::pipeline::campaign::standing;
use crate::pipeline::{Context, PipelineError};

/// A modulus with where it is from.
#[derive(Debug, Clone, PartialEq)]
pub struct StripModulus {
    /// MPa; not determined, with the reason, where no log has it.
    pub modulus_mpa: Estimate,
    /// Where it is from, one sentence; empty where there is none.
    pub source: String,
}

/// The modulus |E*| that the logs of that sample, else of others of its material, have at the humidity.
///
/// # Errors
/// The database cannot be read.
pub fn strip_modulus(
    context: &Context,
    sample: &Sample,
    humidity_percent: Option<f64>,
) -> Result<StripModulus, PipelineError> {
    let (logs, _) = standing::modulus_logs(context)?;
    let (modulus_mpa, paths) = sample_modulus(&logs, &context.campaign, Some(sample), humidity_percent);
    let Some(reason) = modulus_mpa.reason else {
        let at = humidity_percent.unwrap_or_default();
        let paths = in_a_row(&paths);
        return Ok(StripModulus {
            source: format!(
                "modulus from {paths} at {} % RH, in oscillation; bending over minutes may meet a smaller one",
                fixed(at, 0)
            ),
            modulus_mpa,
        });
    };
    let mend = match humidity_percent {
        None if !paths.is_empty() => "--rh or --modulus",
        _ => "--modulus",
    };
    Ok(StripModulus {
        modulus_mpa: Estimate::not_determined(format!("{reason}; give {mend}")),
        source: String::new(),
    })
}
