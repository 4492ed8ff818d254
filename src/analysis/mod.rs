//! Comparison across conditions.
