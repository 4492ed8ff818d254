//! Both responses of one run or many at once, weighted by their noise: simultaneous fits, groups of runs with
//! shared parameters, intervals by profile likelihood.

pub(super) mod bootstrap;
pub(super) mod branch_evidence;
mod compressed;
pub(super) mod feature;
pub(super) mod kinds;
pub(super) mod layout;
pub(super) mod minimum;
mod nodes;
pub(super) mod noise;
pub(super) mod policy;
pub(super) mod problem;
pub(super) mod profile;
pub(super) mod readings;
pub(super) mod single;
pub(super) mod spectrum_rows;
pub(super) mod spring;
pub(super) mod start;
pub(super) mod whitening;
