//! `ieap`: an environment-campaign database and report pipeline for ionic electroactive polymer actuators.
//!
//! A measurement goes one way: [`ingest`] (recognise, read, convert units, tag, archive) -> [`store`] ->
//! [`fit`] (parameters with uncertainty) -> [`analysis`] (comparison across conditions) -> [`report`].
//! [`pipeline`] holds the verbs, [`cli`] the command line; see ARCHITECTURE.md.
//!
//! A campaign, from its files to parameters; [`fit::fit_run`] fits a run that no campaign holds:
//! ```
//! use ieap::pipeline::{Context, FitRuns, Ingest, Silent};
//!
//! let campaign = r#"
//!     [campaign]
//!     id = "humidity"
//!     title = "Humidity"
//!     [[sample]]
//!     id = "S1"
//!     material = "CNaf"
//!     length_mm = 5.0
//!     width_mm = 2.0
//!     [runs]
//!     folder = "runs"
//!     name_pattern = "{sample}_{environment}"
//! "#;
//! // 1 V on 30 Ohm cm2 in series with 0.1 F/cm2, as a potentiostat of 0.1 uA shows it.
//! let mut run = String::from("time_s,voltage_v,current_a\n");
//! for time_s in -5..60 {
//!     let (volts, amperes) = match time_s {
//!         ..0 => (0.0, 0.0),
//!         0.. => (1.0, 0.1 / 30.0 * (-f64::from(time_s) / 3.0).exp() + 1e-5),
//!     };
//!     run += &format!("{time_s},{volts},{amperes:.7}\n");
//! }
//! let folder = tempfile::tempdir()?;
//! std::fs::create_dir(folder.path().join("runs"))?;
//! std::fs::write(folder.path().join("campaign.toml"), campaign)?;
//! std::fs::write(folder.path().join("runs/S1_air.csv"), run)?;
//!
//! let mut context = Context::open(folder.path(), false)?;
//! let taken = Ingest { ready: &mut |_| true }.run(&mut context, &Silent)?;
//! assert_eq!(taken.new, ["runs/S1_air.csv"]);
//! FitRuns::default().run(&mut context, &Silent)?;
//! let run = &context.store.runs()?[0];
//! let fit = run.fit.as_ref().ok_or("the run is not fitted; its issues say why")?;
//! // Values stand in the unit that their key ends in; one that the readings leave open says why.
//! for parameter in &fit.parameters {
//!     println!("{}: {:?}", parameter.key, parameter.estimate);
//! }
//! let tau1_s = fit.parameter("tau1_s").and_then(|estimate| estimate.value);
//! assert!(tau1_s.is_some_and(|tau1_s| (tau1_s - 3.0).abs() < 0.01), "{fit:?}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cli;
pub mod pipeline;

pub use ieap_analysis as analysis;
pub use ieap_diagnose as diagnose;
pub use ieap_domain as domain;
pub use ieap_fit as fit;
pub use ieap_ingest as ingest;
pub use ieap_model as model;
pub use ieap_numerics as numerics;
pub use ieap_report as report;
pub use ieap_show as show;
pub use ieap_store as store;
pub use ieap_strip as strip;
pub use ieap_system as system;
pub use ieap_truth as truth;
