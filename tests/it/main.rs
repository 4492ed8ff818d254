//! Integration tests.

mod folder;
