//! Integration tests.

mod report_fixture;
mod report_site;
