//! Misfit: whether the base model is wrong, and where.
//!
//! In: a group, the base model fitted to it, and the effects of the library.
//! Out: the residuals' answers to every question asked of them, and the p with which chance gives as much
//! ([`null::Null`], read through [`calibration::Calibration`]); where they are off; runs whose readings are the fault.

pub(crate) mod calibration;
pub(crate) mod misfit_size;
pub(crate) mod mixture;
pub(crate) mod null;
pub(crate) mod odd_scale;
pub(crate) mod policy;
pub(crate) mod residual_bins;
pub(crate) mod signature;
pub(crate) mod visible;
pub(crate) mod whereabouts;
