//! Integration tests.

mod folder;
mod lumped_reference;
mod real_campaigns;
mod report_fixture;
mod report_site;
