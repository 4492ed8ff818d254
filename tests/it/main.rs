//! Integration tests.

mod lumped_reference;
