//! Faults of the program that cost a step, and nothing else.

use super::output::Output;
use crate::domain::Fault;

/// What a fault of the program left out.
pub fn say_faults(faults: &[Fault], output: &Output) {
    for fault in faults {
        output.message(&format!(
            "fault of the program, this is missing: {}",
            fault.sentence()
        ));
    }
}
