//! Integration tests.

mod report_fixture;
mod report_goldens;
mod report_site;
mod report_thesis;
