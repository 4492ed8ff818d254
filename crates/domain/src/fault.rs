//! Faults of the program that were stopped at a border: the part is missing and everything else was done.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A part of the work that a fault of the program stopped.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Fault {
    /// What is missing: a page of the report (`runs/a.html`), or a step in words.
    pub place: String,
    /// Paths of the runs it is about; empty where it is about the whole campaign.
    pub runs: Vec<String>,
    /// What stopped it.
    pub reason: String,
}

impl Fault {
    /// `runs/a.html (runs/a.csv): index out of bounds`
    pub fn sentence(&self) -> String {
        let runs = if self.runs.is_empty() {
            String::new()
        } else {
            format!(" ({})", self.runs.join(", "))
        };
        format!("{}{runs}: {}", self.place, self.reason)
    }
}

/// What unwinds where work is given up because somebody asked for its end (`numerics::interrupt`): no fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interrupted;

/// Does `work`; a panic in it is an error that says why. What `work` was changing must not be used after one. An interruption
/// is none and goes on to where the work was begun.
///
/// # Errors
/// The message of the panic.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        if payload.is::<Interrupted>() {
            resume_unwind(payload)
        } else {
            message(&*payload)
        }
    })
}

/// What a panic says.
fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "it stopped without saying why".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_its_message() {
        assert_eq!(caught(|| 7), Ok(7));
        assert_eq!(caught::<()>(|| panic!("at {}", 3)), Err("at 3".to_owned()));
        assert_eq!(caught::<()>(|| panic!("plain")), Err("plain".to_owned()));
    }
}
