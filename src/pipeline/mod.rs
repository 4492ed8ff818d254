//! The verbs as values.
