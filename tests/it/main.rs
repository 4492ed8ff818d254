//! Integration tests: one binary.

mod architecture;
mod bad_input;
mod campaign;
mod distributed;
mod effects;
mod fit_groups;
mod folder;
mod formats_expected;
mod formats_fixtures;
mod formats_properties;
mod formats_real_files;
mod hidden_effects;
mod kill_loop;
mod lab_origin;
mod lumped_reference;
mod main_job;
mod methods;
mod models_reference;
mod mutations;
mod real_campaigns;
mod report_fixture;
mod report_goldens;
mod report_site;
mod report_thesis;
mod sidecars;
mod watch;
