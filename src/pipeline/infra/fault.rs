//! The border of a step: a fault of the program within it costs its result and nothing else.

use crate::domain::fault::{Fault, caught};
use crate::pipeline::PipelineError;

/// Does a step whose panic is an error of that step.
///
/// # Errors
/// What the step says, and [`PipelineError::Fault`] where it panics.
pub fn step<T>(
    what: &'static str,
    work: impl FnOnce() -> Result<T, PipelineError>,
) -> Result<T, PipelineError> {
    caught(work).unwrap_or_else(|reason| {
        Err(PipelineError::Fault {
            step: what.to_owned(),
            reason,
        })
    })
}

/// The step's result, or nothing and a note in `faults` where a fault of the program stopped it.
///
/// # Errors
/// Every other failure of the step.
pub fn or_nothing<T: Default>(
    made: Result<T, PipelineError>,
    faults: &mut Vec<Fault>,
) -> Result<T, PipelineError> {
    match made {
        Err(PipelineError::Fault { step, reason }) => {
            faults.push(Fault {
                place: step,
                runs: Vec::new(),
                reason,
            });
            Ok(T::default())
        }
        made => made,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_noted_and_other_failures_pass() {
        let mut faults = Vec::new();
        let stopped = step("laws across runs", || -> Result<usize, _> { panic!("overflow") });
        assert_eq!(or_nothing(stopped, &mut faults).unwrap(), 0);
        assert_eq!(faults[0].sentence(), "laws across runs: overflow");
        let refused = step("x", || -> Result<usize, _> { Err(PipelineError::NoScale) });
        assert!(or_nothing(refused, &mut faults).is_err() && faults.len() == 1);
    }
}
