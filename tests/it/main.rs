//! Integration tests.

mod lumped_reference;
mod report_fixture;
mod report_site;
mod folder;
mod real_campaigns;
