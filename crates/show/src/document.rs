//! A value for machines: itself, under the name of its schema.

use schemars::JsonSchema;
use serde::Serialize;

/// A value under its schema.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Document<T> {
    /// Its schema, such as `ieap/impedance/2`.
    pub schema: &'static str,
    /// The value.
    #[serde(flatten)]
    pub value: T,
}
