//! BioLogic EC-Lab and BT-Lab: text export (.mpt) and binary file (.mpr). Their logs, settings, states and display
//! settings (.mpl, .mps, .sta, .mgr) are sidecars.

pub mod mpr;
pub mod mpr_columns;
pub mod mpt;
pub mod mpt_header;

pub use mpr::BiologicMpr;
pub use mpt::BiologicMpt;
