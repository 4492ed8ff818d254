//! Identification of a run with a model.
