//! The rows, and the inputs that they write.

use std::path::Path;

use super::house;
use crate::campaign::{CAMPAIGN_TOML, CampaignFolder};
use crate::samples::xlsx;

/// What shows that a code is told.
pub enum Shown {
    /// A campaign with these files: `ieap run --only ingest`, `fit` or `status` tells it, or it stands beside a run.
    Campaign(fn(&CampaignFolder)),
    /// A file of tests/formats: it stands in what is expected of it.
    Format(&'static str),
    /// A test that asserts it: file and name.
    By(&'static str, &'static str),
    /// Nothing yet: what it would need.
    Open(&'static str),
}
use Shown::{By, Campaign, Format, Open};

/// Rows of [`Shown::Open`]: there may be fewer, never more.
pub const OPEN: usize = 19;

#[rustfmt::skip]
pub const ROWS: &[(&str, Shown)] = &[
    ("ambiguous-dates", Format("hobo/refused.two_orders.csv")),
    ("alarm", By("crates/analysis/src/monitoring/view.rs", "an_alarm_leads_to_its_run_and_those_that_are_known_stand_last")),
    ("ambiguous-format", By("crates/ingest/src/profiles/tests.rs", "two_profiles_that_fit_are_named")),
    ("ambiguous-numbers", Format("plain-table/refused.two_readings.csv")),
    ("analysis-fault", Open("a fault of the program: none is known")),
    ("arrow-schema-unread", By("crates/ingest/src/formats/parquet/tests.rs", "a_schema_of_arrow_that_cannot_be_read_is_told")),
    ("bad-drive", By("src/pipeline/standalone/in_memory/tests.rs", "what_a_model_does_not_describe_is_said")),
    ("bad-effect", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("bad-encoding", Campaign(|to| to.write("runs/a.csv", with_half_a_pair()))),
    ("bad-value", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("base-parameter-was-wrong", By("tests/it/findings.rs", "an_adopted_model_is_fitted_to_its_group_and_says_how_wrong_the_base_was")),
    ("bending-alone", By("crates/fit/src/tests/bending.rs", "of_charging_and_relaxation_the_slower_is_taken_for_relaxation_and_it_is_said")),
    ("bending-clock", By("crates/fit/src/tests/edges.rs", "bending_on_a_clock_of_its_own_is_moved_by_what_the_clocks_differ")),
    ("bending-clock-open", By("crates/fit/src/tests/edges.rs", "bending_on_a_clock_of_its_own_that_nothing_tells_of_is_said")),
    ("blocks-side-by-side", By("crates/ingest/tests/reading_cases/names_and_blocks.rs", "blocks_of_columns_under_the_same_names_are_runs")),
    ("broken-container", By("crates/ingest/src/formats/workbook_parts.rs", "a_damaged_archive_is_named")),
    ("broken-structure", Format("biologic-mpr/refused.row_width.mpr")),
    ("campaign-file-not-read", By("crates/ingest/src/campaign_file/kept.rs", "a_file_that_cannot_be_read_is_told_and_the_last_one_stands_for_it")),
    ("circuit-notation", By("tests/it/impedance.rs", "a_circuit_of_ones_own_is_fitted_wherever_spectra_are_shown")),
    ("climate-above-limit", By("tests/it/chamber.rs", "pressure_oxygen_and_water_reach_the_runs_that_they_speak_for")),
    ("climate-left-tolerance", By("tests/it/climate.rs", "an_excursion_a_false_label_and_two_sensors_are_pointed_out")),
    ("climate-environment-stated", By("tests/it/pairs.rs", "what_an_environment_states_counts_more_than_the_room_and_a_sensor_without_a_log_is_said")),
    ("climate-no-start", By("tests/it/climate.rs", "a_run_gets_what_the_log_says_and_nothing_it_does_not")),
    ("climate-not-covered", By("tests/it/climate.rs", "a_run_gets_what_the_log_says_and_nothing_it_does_not")),
    ("climate-sensors-differ", By("tests/it/climate.rs", "an_excursion_a_false_label_and_two_sensors_are_pointed_out")),
    ("clock-ambiguous", By("crates/analysis/src/climate/clock.rs", "what_may_be_either_hour_is_left_out")),
    ("clock-offset", By("crates/analysis/src/climate/compare.rs", "a_clock_ahead_is_found_with_its_sign")),
    ("clock-offset-unused", By("crates/ingest/src/clocks/tests.rs", "an_offset_that_is_not_in_use_is_pointed_out")),
    ("clock-starts-anew", By("crates/ingest/tests/reading_cases/times.rs", "case_02_the_clock_starts_anew_at_the_step")),
    ("clock-without-summer-time", By("crates/analysis/src/climate/clock.rs", "a_clock_that_ran_through_keeps_its_first_offset")),
    ("column-not-measured", By("crates/ingest/tests/reading_cases/names_and_blocks.rs", "a_set_point_and_an_alarm_are_no_readings_of_the_air")),
    ("column-refused", By("crates/ingest/src/named_columns.rs", "a_tag_that_cannot_be_followed_changes_nothing_and_says_why")),
    ("column-taken", Campaign(|to| to.write("runs/a.csv", run("curvture_per_cm", "0.1")))),
    ("column-unread", Campaign(|to| to.write("runs/a.csv", run("bend (1/m)", "0.1")))),
    ("column-unusable", By("crates/ingest/src/formats/error.rs", "an_issue_says_where_and_how_to_mend")),
    ("contact-break", By("tests/it/lumped_or_distributed.rs", "a_cracked_foil_is_found_and_placed")),
    ("contradiction", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_stated_and_cannot_both_hold_names_both")),
    ("control-not-held", By("crates/ingest/src/drive/tests.rs", "what_is_stated_goes_before_what_was_measured")),
    ("counter-wrapped", By("crates/ingest/tests/reading_cases/times.rs", "case_18b_a_counter_of_32_bits_wraps")),
    ("current-against-voltage", By("crates/fit/src/tests/limits.rs", "a_current_of_the_wrong_sign_is_named")),
    ("current-jumps", By("crates/ingest/src/drive/jumps.rs", "an_edge_without_a_cause_is_told")),
    ("current-offset", By("crates/fit/src/tests/recovery.rs", "an_instrument_whose_zero_is_off_is_seen_on_a_discharge")),
    ("database-caught-up", Open("told on stderr only: tests/it/two_stores.rs asserts the sentence")),
    ("database-damaged", By("tests/it/verify.rs", "a_number_that_changed_is_found_and_a_rebuilding_mends_it")),
    ("database-lags", By("tests/it/two_stores.rs", "an_older_database_catches_up_whoever_works_on_it")),
    ("database-made-anew", By("tests/it/schema_17.rs", "words_and_numbers_are_those_of_before")),
    ("database-not-opened", By("tests/it/verify.rs", "a_number_that_changed_is_found_and_a_rebuilding_mends_it")),
    ("date-uncertain", Format("ivium-text/ca.comma_cut.txt")),
    ("decided-by-unit", By("crates/ingest/src/table/columns.rs", "what_a_unit_alone_decided_is_said_with_the_column_that_could_be_it_too")),
    ("decimal-marks-differ", By("crates/ingest/tests/reading_cases/names_and_blocks.rs", "a_column_has_its_own_decimal_mark")),
    ("displacement-zero", By("src/pipeline/intake/ingest/places.rs", "a_sensor_that_was_not_zeroed_is_told_with_what_a_bent_strip_would_be")),
    ("displacement-beyond-strip", By("src/pipeline/intake/ingest/places.rs", "a_tip_that_moves_further_than_the_strip_is_long_is_in_another_unit")),
    ("drive-contradicted", By("crates/ingest/src/drive/tests.rs", "readings_win_over_a_stated_drive_that_they_contradict")),
    ("duplicate-quantity", Format("plain-table/step.duplicate_current.csv")),
    ("open-zero", By("tests/it/derived_curvature.rs", "a_zero_that_nothing_tells_is_in_the_intervals")),
    ("edges-between-readings", Campaign(|to| to.write("runs/a.csv", late()))),
    ("edges-in-a-pause", By("crates/ingest/src/drive/tests.rs", "a_pause_in_which_edges_would_not_be_seen_is_told")),
    ("empty-column", Format("chi-text/dpv.column_without_values.txt")),
    ("empty-file", Format("plain-table/pending.empty.csv")),
    ("ended-program", By("tests/it/hostile.rs", "a_file_that_ends_the_program_is_refused_at_the_next_look_until_it_changes")),
    ("few-frequencies", By("crates/fit/src/impedance/tests.rs", "few_frequencies_are_refused")),
    ("file-cut", Format("picolog/log.cut.csv")),
    ("fit-fault", Open("a fault of the program: none is known")),
    ("fit-not-converged", Open("crates/fit/src/tests/stopped.rs makes such fits, no campaign does")),
    ("folder", By("tests/it/issue_codes/mod.rs", "what_inspect_says")),
    ("folder-too-deep", By("crates/ingest/src/scan/tests.rs", "limits_and_special_files_are_said")),
    ("folder-unreadable", By("tests/it/folder.rs", "folders_without_rights_are_issues_and_the_rest_goes_on")),
    ("formulas-without-values", By("crates/ingest/tests/reading_cases/workbooks.rs", "case_21b_formulas_without_values_are_said_to_be_that")),
    ("frame", By("tests/it/issue_codes/mod.rs", "what_inspect_says")),
    ("frames-not-traced", Campaign(|to| {
    to.write("runs/b.frames/frames.toml", "clamp = \"above\"\n");
    to.write("runs/b.frames/1.png", "no picture");
})),
    ("frames-refused", Open("a frame among others that cannot be traced")),
    ("frames-traced", By("tests/it/frame_folders.rs", "a_folder_of_frames_is_one_thing_that_is_taken_in_once")),
    ("frequency-sweep", By("crates/analysis/src/dma/tests.rs", "one_frequency_of_several_is_used_and_a_sweep_is_refused")),
    ("given-uncertainty", By("crates/fit/src/distributed/tests.rs", "the_error_of_a_given_resistance_is_in_the_intervals")),
    ("group-differs", By("tests/it/fit_groups.rs", "runs_that_differ_are_said_to_differ_and_group_by_keeps_them_apart")),
    ("group-not-fitted", By("tests/it/issue_codes/mod.rs", "what_a_group_leaves_out")),
    ("half-of-a-run", By("tests/it/pairs.rs", "a_half_says_whom_it_waits_for_and_parts_of_one_name_stay_what_they_were")),
    ("header-only", Format("hobo/pending.header_only.csv")),
    ("held-and-bent", Campaign(|to| to.write("runs/a.csv", run("curvature_per_cm,blocking_force_mn", "0.1,0.2")))),
    ("holdings", Open("every verb that opens such a campaign refuses it before verify asks")),
    ("humidity-drifts", By("crates/analysis/src/dma/humidity_steps_tests.rs", "drift_waves_doors_and_ramps_are_no_steps")),
    ("humidity-is-temperature", By("crates/analysis/src/climate/checks.rs", "each_fault_is_named_and_a_good_sensor_has_none")),
    ("humidity-out-of-range", By("crates/analysis/src/climate/checks.rs", "each_fault_is_named_and_a_good_sensor_has_none")),
    ("imaginary-part-turned", By("crates/ingest/src/formats/assemble.rs", "imaginary_parts_as_of_a_coil_are_turned_and_those_of_a_sample_are_not")),
    ("impossible-reading", By("crates/ingest/tests/reading_cases/numbers.rs", "case_09_an_overload_written_as_a_number_is_left_out")),
    ("initial-curvature", By("crates/fit/src/tests/recovery.rs", "a_strip_that_is_bent_before_the_step_is_fitted_with_an_offset")),
    ("joined-twice", By("src/pipeline/intake/ingest/prepare.rs", "of_what_two_files_of_a_run_give_the_first_counts_and_it_is_said")),
    ("journal-damaged", By("tests/it/verify.rs", "a_journal_that_is_gone_damaged_or_says_something_else_is_found")),
    ("journal-lags", By("tests/it/verify.rs", "a_journal_that_is_gone_damaged_or_says_something_else_is_found")),
    ("journal-lines-missing", By("tests/it/verify.rs", "a_journal_that_is_gone_damaged_or_says_something_else_is_found")),
    ("journal-parted", By("tests/it/two_stores.rs", "two_courses_are_refused_until_a_person_takes_one_away")),
    ("journal-torn", By("tests/it/issue_codes/mod.rs", "what_verify_notes")),
    ("journal-written", Open("told on stderr only: tests/it/two_stores.rs asserts the sentence")),
    ("known-contradicted", By("tests/it/known.rs", "what_is_known_by_hand_is_kept_and_a_contradiction_is_said")),
    ("known-not-used", By("tests/it/known.rs", "what_campaign_toml_knows_is_in_every_fit_of_the_sample_and_said")),
    ("known-parameter", By("tests/it/known.rs", "what_campaign_toml_knows_is_in_every_fit_of_the_sample_and_said")),
    ("kramers-kronig", By("crates/fit/src/impedance/tests.rs", "a_sample_that_changes_during_the_sweep_violates_kramers_kronig")),
    ("left-out", Open("told on stderr only: tests/it/backups.rs asserts the sentence")),
    ("left-out-by-tag", Campaign(|to| {
    to.write("runs/a.csv", run("note", "1"));
    to.write("runs/a.csv.toml", "leave_out = \"10-12\"\n");
})),
    ("length-differs", By("src/pipeline/intake/ingest/places.rs", "a_scale_that_is_wrong_is_pointed_out")),
    ("lines-between", By("crates/ingest/src/formats/plain_table.rs", "a_logger_that_was_started_anew_wrote_several_runs")),
    ("link-broken", By("crates/ingest/src/scan/tests.rs", "links_are_followed_inside_only_and_loops_end")),
    ("link-not-followed", By("crates/ingest/src/scan/tests.rs", "links_are_followed_inside_only_and_loops_end")),
    ("link-outside", By("crates/ingest/src/scan/tests.rs", "links_are_followed_inside_only_and_loops_end")),
    ("log-without-climate", By("crates/ingest/src/climate_log.rs", "tables_without_dates_or_climate_are_refused_with_a_reason")),
    ("log-without-dates", By("crates/ingest/src/climate_log.rs", "tables_without_dates_or_climate_are_refused_with_a_reason")),
    ("log-without-zone", By("tests/it/climate.rs", "clocks_of_every_kind_place_their_readings")),
    ("logger-restarted", By("crates/ingest/tests/reading_cases/cuts.rs", "case_18_a_restarted_logger_wrote_two_runs")),
    ("logs-contradict", By("tests/it/climate.rs", "logs_of_one_sensor_that_contradict_each_other_are_pointed_out_and_the_first_counts")),
    ("lumped-or-distributed", By("tests/it/distributed.rs", "a_sample_of_table_3_comes_back_from_its_file")),
    ("midnight-passed", By("crates/ingest/src/profiles/tests.rs", "times_of_day_pass_midnight_and_intervals_count")),
    ("misfit-left", Open("a group of runs with an effect beside the named one")),
    ("model-choice", By("crates/fit/src/tests/branches.rs", "intervals_of_three_branches_hold_the_truth_and_the_choice_says_why")),
    ("model-of-group", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("moduli-disagree", By("crates/analysis/src/dma/tests.rs", "what_a_log_lacks_is_said_and_nothing_is_made_up")),
    ("name-ambiguous", By("crates/ingest/src/tags/tests.rs", "a_name_that_a_pattern_cannot_split_in_one_way_gives_no_tag")),
    ("name-pattern-bad", By("crates/ingest/src/tags/tests.rs", "a_name_that_a_pattern_cannot_split_in_one_way_gives_no_tag")),
    ("name-twice", By("src/pipeline/standalone/in_memory/tests.rs", "a_diagnosis_is_that_of_a_campaign_of_one_group")),
    ("names-contradict", By("crates/ingest/src/tags/tests.rs", "tags_of_another_name_are_joined_and_what_contradicts_is_an_issue")),
    ("never-seen", Format("ivium-idf/refused.cyclic.idf")),
    ("newest-first", By("crates/ingest/tests/reading_cases/logs.rs", "case_19f_the_newest_row_comes_first")),
    ("no-area", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("no-circuit", Open("a spectrum that no circuit can be fitted to: none is known")),
    ("no-circuit-describes", By("crates/fit/src/impedance/tests.rs", "what_is_no_impedance_is_refused_and_what_no_circuit_describes_is_said")),
    ("no-complex-modulus", By("crates/analysis/src/dma/tests.rs", "what_a_log_lacks_is_said_and_nothing_is_made_up")),
    ("no-data", By("crates/ingest/src/formats/no_data.rs", "notes_programs_pictures_and_documents_are_no_data")),
    ("no-drive", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("no-header", Format("plain-table/refused.headerless.csv")),
    ("no-humidity", By("crates/analysis/src/dma/tests.rs", "what_a_log_lacks_is_said_and_nothing_is_made_up")),
    ("no-impedance", By("crates/fit/src/impedance/tests.rs", "what_is_no_impedance_is_refused_and_what_no_circuit_describes_is_said")),
    ("no-journal", By("tests/it/verify.rs", "a_journal_that_is_gone_damaged_or_says_something_else_is_found")),
    ("no-length", Campaign(|to| {
    to.write("campaign.toml", CAMPAIGN_TOML.replace(SIZE, "area_cm2 = 0.1\n"));
    to.write("runs/a.csv", run("tip_displacement_mm", "0.1"));
})),
    ("no-modulus", By("tests/it/dma.rs", "columns_that_were_never_seen_are_used_when_a_tag_says_what_they_are")),
    ("no-moment", Open("a held strip of a sample without a length")),
    ("no-response", Format("plain-table/refused.no_response.csv")),
    ("no-run-among-variables", Format("matlab-mat/refused.names_without_units.mat")),
    ("no-runs", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("no-samples", By("crates/ingest/src/campaign_file/tests.rs", "the_template_parses_also_with_its_comments_taken_away")),
    ("no-such-column", By("crates/ingest/src/named_columns.rs", "a_tag_that_cannot_be_followed_changes_nothing_and_says_why")),
    ("no-temperature-probe", Format("gamry-dta/chronoa.aborted.DTA")),
    ("no-train", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("no-voltage", By("crates/ingest/src/drive/tests.rs", "what_the_readings_do_not_carry_is_no_drive")),
    ("not-a-file", By("crates/ingest/src/scan/tests.rs", "limits_and_special_files_are_said")),
    ("not-converged", By("crates/fit/src/tests/stopped.rs", "assert_says")),
    ("not-finite", Format("campbell-toa5/log.complete.dat")),
    ("not-fitted", By("tests/it/distributed.rs", "a_run_without_anything_along_the_strip_says_so")),
    ("not-fitted-yet", By("tests/it/findings.rs", "status_says_which_findings_wait")),
    ("not-in-group", By("tests/it/issue_codes/mod.rs", "what_a_group_leaves_out")),
    ("not-known", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("not-piecewise-constant", By("crates/ingest/src/drive/tests.rs", "what_the_readings_do_not_carry_is_no_drive")),
    ("not-read", Campaign(|to| empty(&to.join("runs/a.csv"), 1_100_000_000))),
    ("not-read-kind", Format("matlab-mat/refused.version_7_3.mat")),
    ("not-read-now", Open("an error of the disk")),
    ("not-solved", Open("equations without a solution: no request is known that has none")),
    ("nul-bytes", By("crates/ingest/tests/reading_cases/cuts.rs", "case_17_nul_bytes_of_a_disk_that_lost_its_power")),
    ("one-spectrum", By("src/pipeline/standalone/in_memory/tests.rs", "what_is_missing_or_wrong_is_said_with_its_remedy")),
    ("old-database-not-read", By("tests/it/rebuild.rs", "an_old_database_that_cannot_be_read_is_a_loss_that_is_said")),
    ("one-frequency", By("crates/analysis/src/dma/tests.rs", "one_frequency_of_several_is_used_and_a_sweep_is_refused")),
    ("other-input", By("src/pipeline/standalone/in_memory/tests.rs", "a_row_of_a_campaign_is_fitted_as_that_fits_it_or_refused")),
    ("other-technique", Campaign(|to| to.write("runs/a.DTA", format_file("gamry-dta/cv.two_curves_and_rest.DTA")))),
    ("outliers-left-out", By("crates/fit/src/outliers/tests.rs", "glitches_go_and_are_told_with_their_times")),
    ("overload-excluded", Format("gamry-dta/chronoa.aborted.DTA")),
    ("parameter-bounded", Campaign(|to| to.write("runs/a.csv", cut(&run("note", "1"), 31)))),
    ("parameter-not-determined", Campaign(|to| to.write("runs/a.csv", run("note", "1")))),
    ("place-beyond-strip", By("src/pipeline/intake/ingest/places.rs", "places_beyond_the_end_are_pointed_out_and_others_are_not")),
    ("plateau-not-reached", By("crates/analysis/src/dma/tests.rs", "a_plateau_that_is_not_reached_is_said_and_its_time_is_a_bound")),
    ("potential-relative", Format("biologic-mpt/ca.no_last_line_end.mpt")),
    ("probe-contradicted", By("crates/fit/src/distributed/places_tests.rs", "a_probe_that_reads_wrong_is_no_crack")),
    ("probe-face-missing", By("crates/ingest/src/probe_log.rs", "the_faces_of_a_strip_add_up")),
    ("probe-not-covered", Campaign(|to| {
    to.write("runs/a.csv", run("note", "1"));
    to.write("runs/a.csv.toml", "started_at = \"2026-01-20T10:00:00+02:00\"\n");
    to.write("probe/p.csv", PROBED);
})),
    ("probe-rows-left-out", Format("probe-table/table.faces_unsorted.csv")),
    ("profile-not-read", By("tests/it/only_shown.rs", "a_profile_that_cannot_be_read_costs_the_files_that_it_may_be_for")),
    ("profile-refused", By("tests/it/only_shown.rs", "a_profile_that_cannot_be_read_costs_the_files_that_it_may_be_for")),
    ("ragged-rows", Format("plain-table/step.ragged.csv")),
    ("range-exceeded", By("crates/ingest/tests/reading_cases/numbers.rs", "case_34_readings_at_the_end_of_a_range_are_left_out_and_said")),
    ("raw-file-lost", By("tests/it/verify.rs", "a_raw_file_that_is_lost_or_changed_is_found_and_the_original_mends_it")),
    ("raw-file-of-no-run", By("tests/it/issue_codes/mod.rs", "what_verify_notes")),
    ("reader-fault", Open("a fault of the program: tests/it/any_runs.rs looks for one")),
    ("readings-differ", By("tests/it/verify.rs", "what_is_sealed_and_wrong_is_found_by_deriving_it_again")),
    ("report-fault", Open("a fault of the program: tests/it/report_site.rs has one outside of a campaign")),
    ("report-file-changed", By("tests/it/verify.rs", "a_page_of_the_report_that_is_gone_is_found")),
    ("report-file-missing", By("tests/it/verify.rs", "a_page_of_the_report_that_is_gone_is_found")),
    ("report-file-unreadable", Open("rights that the user of a test may not have")),
    ("report-foreign-file", By("tests/it/foreign_files.rs", "a_file_put_into_the_report_is_noticed_and_stays")),
    ("report-out-of-date", By("tests/it/issue_codes/mod.rs", "what_verify_notes")),
    ("response-missing", Campaign(|to| to.write("runs/a.csv", run("curvature (furlong)", "0.1")))),
    ("result-differs", By("tests/it/verify.rs", "what_is_sealed_and_wrong_is_found_by_deriving_it_again")),
    ("result-out-of-date", By("tests/it/issue_codes/mod.rs", "what_verify_notes")),
    ("run-sheet", By("tests/it/issue_codes/mod.rs", "what_inspect_says")),
    ("run-sheet-damaged", By("crates/ingest/src/run_sheet/tests.rs", "a_fault_has_its_place_and_its_mend")),
    ("same-bytes", By("tests/it/new_laboratory/french.rs", "a_french_laboratory_goes_from_its_folder_to_a_true_report")),
    ("same-readings", By("src/pipeline/standalone/in_memory/tests.rs", "a_diagnosis_is_that_of_a_campaign_of_one_group")),
    ("same-tags", By("tests/it/bad_input.rs", "runs_that_no_tag_tells_apart_are_named")),
    ("sample-clock", By("crates/ingest/src/formats/sample_clock.rs", "a_good_clock_and_another_interval_stay_as_they_are")),
    ("sample-without-area", Campaign(|to| to.write("campaign.toml", CAMPAIGN_TOML.replace(SIZE, "")))),
    ("section-fault", Open("a fault of the program: tests/it/report_site.rs looks at its sentence")),
    ("sensor-at-end", By("crates/analysis/src/climate/checks.rs", "each_fault_is_named_and_a_good_sensor_has_none")),
    ("sensor-stuck", By("crates/analysis/src/climate/checks.rs", "each_fault_is_named_and_a_good_sensor_has_none")),
    ("sensor-without-log", By("tests/it/pairs.rs", "what_an_environment_states_counts_more_than_the_room_and_a_sensor_without_a_log_is_said")),
    ("sensors-disagree", By("crates/analysis/src/climate/compare.rs", "sensors_that_agree_have_no_issue_and_a_bias_is_named")),
    ("series-broken", By("crates/analysis/src/groups.rs", "runs_of_another_date_are_set_apart_with_the_reason")),
    ("set-aside", By("tests/it/aside.rs", "a_chart_shows_the_newest_run_at_its_edge_where_it_is_condemned")),
    ("shared-parameters", By("tests/it/findings.rs", "an_adopted_model_is_fitted_to_its_group_and_says_how_wrong_the_base_was")),
    ("sidecar", Format("biologic-mpr/sidecar.wait.mpr")),
    ("start-state-assumed", By("crates/ingest/src/drive/tests.rs", "one_voltage_throughout_is_a_step_from_the_discharged_state")),
    ("starts-differ", Format("palmsens-csv/dpv.two_curves.csv")),
    ("statement-unread", By("tests/it/fates.rs", "a_statement_of_no_run_is_said_wherever_one_looks")),
    ("spectrum-columns", Format("plain-table/refused.frequency_alone.csv")),
    ("result-stray", By("tests/it/verify.rs", "a_result_of_no_run_is_found_and_runs_that_wait_for_results_are_told_and_no_damage")),
    ("result-waits", By("tests/it/verify.rs", "a_result_of_no_run_is_found_and_runs_that_wait_for_results_are_told_and_no_damage")),
    ("sheets-joined", By("crates/ingest/src/formats/sheet_tests.rs", "sheets_of_current_and_camera_are_one_run")),
    ("still-growing", Open("a file that grows between two looks")),
    ("suspicious-range", Format("labview-lvm/step.cut.lvm")),
    ("table-differs", By("tests/it/verify.rs", "what_is_sealed_and_wrong_is_found_by_deriving_it_again")),
    ("table-not-found", Open("a reader of an earlier version")),
    ("table-refused", Campaign(|to| to.write("runs/a.xlsx", xlsx(&[("Run", &WHOLE), ("Other", &[&["Time (s)", "Current (mA)"], &["1", "2"], &["1", "2"], &["1", "3"]])])))),
    ("tag-disagreement", By("crates/ingest/src/tags/tests.rs", "sources_are_chosen_in_the_order_of_the_contract_and_disagreements_are_said")),
    ("tag-file-not-toml", By("crates/ingest/src/tags/tests.rs", "a_sidecar_that_cannot_be_read_makes_its_run_wait")),
    ("tag-file-unreadable", Campaign(|to| {
    to.write("runs/a.csv", run("note", "1"));
    to.write("runs/a.csv.toml", b"note = \"\xff\"\n");
})),
    ("tag-key-misspelt", By("crates/ingest/src/tags/tests.rs", "keys_that_are_neither_known_nor_declared_are_said_and_kept")),
    ("tag-missing", By("crates/ingest/src/tags/tests.rs", "what_is_missing_is_named_with_its_mend")),
    ("tag-not-flat", By("crates/ingest/src/tags/tests.rs", "a_sidecar_that_cannot_be_read_makes_its_run_wait")),
    ("tag-too-long", By("crates/ingest/src/tags/length.rs", "keys_and_values_have_a_length_that_what_is_known_keeps")),
    ("tag-undeclared", By("crates/ingest/src/tags/tests.rs", "values_of_every_flat_type_are_kept")),
    ("tag-unusable", By("src/pipeline/intake/ingest/left_out.rs", "stretches_are_read_or_pointed_out")),
    ("tag-without-effect", By("src/pipeline/intake/ingest/left_out.rs", "a_tag_that_does_nothing_is_pointed_out")),
    ("temperature-out-of-range", Campaign(|to| {
    to.write("runs/a.csv", run("note", "1"));
    to.write("ambient/box.csv", hot());
})),
    ("text-column", Format("ta-trios/creep.two_steps.txt")),
    ("text-in-number-column", Format("plain-table/step.bad_cells.csv")),
    ("time-from-dates", Format("biologic-mpt/ca.dates_as_time.txt")),
    ("time-gap", By("crates/ingest/src/formats/time_axis.rs", "gaps_are_named_and_logarithmic_sampling_has_none")),
    ("time-missing", By("crates/ingest/src/formats/time_axis.rs", "a_few_repeated_times_are_left_out_and_counted")),
    ("time-not-increasing", Format("plain-table/step.repeated_time.csv")),
    ("time-not-used", By("crates/ingest/src/formats/plain_table.rs", "a_modulus_log_of_an_eplexor_as_text_has_its_units_in_the_second_row")),
    ("time-order", Format("plain-table/refused.clock_too_coarse.csv")),
    ("time-rebuilt", Format("chi-text/it.repeated_times.txt")),
    ("zone-not-understood", By("crates/ingest/tests/kinds/zones.rs", "a_zone_is_read_or_said_not_to_be_understood")),
    ("time-unit-shown", By("crates/ingest/src/formats/plain_table.rs", "dates_beside_a_time_show_its_unit")),
    ("too-large", By("crates/ingest/src/formats/workbook_parts.rs", "what_unpacks_to_too_much_is_refused")),
    ("two-steps-only", By("crates/fit/src/law/tests.rs", "what_a_rival_does_not_describe_is_said")),
    ("unit-told", Format("climate-table/log.several_sensors.csv")),
    ("unknown-column", Format("biologic-mpr/ca.unknown_column.mpr")),
    ("unknown-environment", By("crates/ingest/src/tags/tests.rs", "an_unknown_sample_leaves_the_run_untagged_and_an_unknown_environment_is_said")),
    ("unknown-format", Campaign(|to| to.write("runs/a.csv", "some words\nand more\n"))),
    ("unknown-key", By("tests/it/own_files.rs", "a_slip_in_campaign_toml_is_in_status_its_document_and_its_exit_status")),
    ("unknown-sample", By("crates/ingest/src/tags/tests.rs", "an_unknown_sample_leaves_the_run_untagged_and_an_unknown_environment_is_said")),
    ("variable-left-out", Format("matlab-mat/step.struct_of_integers.mat")),
    ("voltage-change-unanswered", By("crates/ingest/src/drive/tests.rs", "a_small_fall_of_a_held_voltage_is_an_edge_where_the_current_answers_or_it_is_stated")),
    ("voltage-moves", Campaign(|to| {
    to.write("runs/a.csv", sine());
    to.write("runs/a.csv.toml", "voltage_v = 1\n");
})),
    ("watch-events", By("crates/ingest/src/watch/tests.rs", "events_are_tried_again_with_each_full_scan")),
    ("watch-polling", By("crates/ingest/src/watch/tests.rs", "events_are_tried_again_with_each_full_scan")),
    ("words-may-be-lost", By("tests/it/two_stores.rs", "words_that_may_be_lost_are_told_until_a_person_answers")),
    ("words-of-no-run", By("tests/it/words_and_names.rs", "the_next_measurement_under_an_old_name_has_none_of_its_words")),
];

/// The size of the sample in [`CAMPAIGN_TOML`].
const SIZE: &str = "length_mm = 5.0\nwidth_mm = 2.0\n";

const PROBED: &str = "# keithley\nDate;Sample;R (mΩ/sq);SD (mΩ/sq);Flexings;RH (%)\n\
    2026-01-10 10:00:00;S1;1200;10;0;40\n2026-01-10 11:00:00;S1;1210;10;0;40\n";

const WHOLE: [&[&str]; 5] = [
    &["Time (s)", "Voltage (V)", "Current (mA)"],
    &["0", "2.5", "12.75"],
    &["1", "2.5", "3.25"],
    &["2", "2.5", "1.125"],
    &["3", "2.5", "1.0"],
];

/// A decaying current under a step at `step_s`, a reading a second, with further columns of one content each.
fn stepped(step_s: i32, columns: &str, cells: &str) -> String {
    let mut text = format!("time_s,voltage_v,current_a,{columns}\n");
    for time_s in -5..55 {
        let after_s = f64::from(time_s - step_s);
        let on = f64::from(u8::from(after_s >= 0.0));
        let current_a = on * (1e-3 * (-after_s / 20.0).exp() + 2e-5);
        text += &format!("{time_s},{},{current_a:.6e},{cells}\n", 2.0 * on);
    }
    text
}

fn run(columns: &str, cells: &str) -> String {
    stepped(0, columns, cells)
}

/// Its step is not where the plain table has time zero.
fn late() -> String {
    stepped(5, "note", "1")
}

/// The first lines.
pub fn cut(text: &str, lines: usize) -> String {
    text.lines().take(lines).map(|line| format!("{line}\n")).collect()
}

/// UTF-16 with half of a character in a comment.
fn with_half_a_pair() -> Vec<u8> {
    let text = format!("\u{feff}# operator: ?\n{}", run("note", "1"));
    let units = text.encode_utf16().map(|unit| match unit {
        0x3f => 0xd800,
        unit => unit,
    });
    units.flat_map(u16::to_le_bytes).collect()
}

/// A humidity logger with a temperature that no logger survives.
fn hot() -> String {
    let mut text = "Time,Temperature (°C),Relative Humidity (%)\n".to_owned();
    for hour in 0..8 {
        let temperature_c = if hour == 3 { 999 } else { 20 };
        text += &format!("2026-01-10 0{hour}:00:00,{temperature_c},45\n");
    }
    text
}

/// A file of so many bytes that takes no place on the disk.
fn empty(path: &Path, size_bytes: u64) {
    std::fs::File::create(path).unwrap().set_len(size_bytes).unwrap();
}

fn sine() -> String {
    let mut text = "time_s,voltage_v,current_a\n".to_owned();
    for k in 0..2000 {
        let phase = f64::from(k) / 30.0;
        text += &format!(
            "{:.1},{:.6},{:.6e}\n",
            f64::from(k) / 10.0,
            phase.sin(),
            1e-4 * (phase + 0.4).sin()
        );
    }
    text
}

pub fn format_file(name: &str) -> Vec<u8> {
    std::fs::read(house().join("tests/formats").join(name)).unwrap()
}
