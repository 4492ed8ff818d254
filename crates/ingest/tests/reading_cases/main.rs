//! One test for each of the ways in which files were once misread, or refused though they can be read.
//!
//! The files are made here as programs and loggers write them, and what is read is held against the formula that they were
//! written from. A test bears the number of its case.

mod answers;
mod base_run;
mod cuts;
mod expected;
mod layouts;
mod log_expected;
mod logs;
mod moments;
mod names_and_blocks;
mod numbers;
mod reads;
#[allow(dead_code)]
#[path = "../../src/formats/sheet_writer.rs"]
mod sheet_writer;
mod times;
#[allow(dead_code)]
#[path = "../../src/formats/labview_tdms/waveform_writer.rs"]
mod waveform_writer;
mod waveforms;
mod workbooks;
