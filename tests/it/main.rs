//! Integration tests.

mod formats_fixtures;
mod formats_properties;
mod formats_real_files;
