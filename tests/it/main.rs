//! Integration tests.

mod lumped_reference;
mod real_campaigns;
