//! The closed form against values that were computed to high precision elsewhere.

use ieap::domain::Drive;
use ieap::model::{Branch, LumpedModel};

use super::shared;

/// Rows of a reference table under their column names; none where the shared folder is absent.
fn reference_rows(name: &str) -> Option<Vec<std::collections::HashMap<String, String>>> {
    let path = shared(&format!("reference/{name}"))?;
    let mut reader = csv::Reader::from_path(path).unwrap();
    Some(reader.deserialize().map(|row| row.unwrap()).collect())
}

fn number(row: &std::collections::HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

#[track_caller]
fn assert_close(found: f64, expected: f64) {
    let allowed = 1e-10 * expected.abs() + if expected.abs() < 1e-290 { 1e-10 } else { 0.0 };
    assert!(
        (found - expected).abs() <= allowed,
        "{found:e} instead of {expected:e}"
    );
}

#[test]
fn two_branches_of_table_5() {
    let Some(rows) = reference_rows("lumped_two_branch.csv") else {
        return;
    };
    let Some(table) = reference_rows("thesis_table5.csv") else {
        return;
    };
    assert!(rows.len() > 200);
    for row in &rows {
        let of_condition = |line: &&std::collections::HashMap<String, String>| {
            ["material", "environment", "v0_v"]
                .iter()
                .all(|key| line[*key] == row[*key])
        };
        let line = table.iter().find(of_condition).unwrap();
        let branch = |r: &str, c: &str| Branch {
            resistance_ohm_cm2: number(line, r),
            capacitance_f_per_cm2: number(line, c),
        };
        let model = LumpedModel {
            branches: vec![
                branch("r1_ohm_cm2", "c1_f_per_cm2"),
                branch("r2_ohm_cm2", "c2_f_per_cm2"),
            ],
            steady_state_resistance_ohm_cm2: 1000.0 * number(line, "rss_kohm_cm2"),
            charge_to_curvature_per_c_cm: number(line, "alpha_per_c_cm"),
            relaxation_rate_per_s: number(line, "lambda_per_s"),
        };
        let (drive, area_cm2, t) = (
            Drive::step(number(row, "v0_v")),
            number(row, "area_cm2"),
            [number(row, "t_s")],
        );
        let charge_c = model.charge_c(&drive, area_cm2, &t)[0];
        assert_close(
            model.current_a(&drive, area_cm2, &t)[0] / area_cm2,
            number(row, "current_a_per_cm2"),
        );
        assert_close(charge_c / area_cm2, number(row, "charge_c_per_cm2"));
        assert_close(charge_c, number(row, "charge_c"));
        assert_close(
            model.curvature_per_cm(&drive, area_cm2, &t)[0],
            number(row, "curvature_per_cm"),
        );
    }
}

#[test]
fn one_branch_at_and_near_the_removable_singularity() {
    let Some(rows) = reference_rows("lumped_one_branch_degenerate.csv") else {
        return;
    };
    assert!(rows.len() > 70);
    for row in &rows {
        let branch = Branch {
            resistance_ohm_cm2: number(row, "r_ohm"),
            capacitance_f_per_cm2: number(row, "c_f"),
        };
        let model = LumpedModel {
            branches: vec![branch],
            steady_state_resistance_ohm_cm2: f64::INFINITY,
            charge_to_curvature_per_c_cm: number(row, "alpha"),
            relaxation_rate_per_s: number(row, "lambda_tau") / branch.time_constant_s(),
        };
        let drive = Drive::step(number(row, "v0_v"));
        let found = model.curvature_per_cm(&drive, 1.0, &[number(row, "t_s")])[0];
        assert_close(found, number(row, "curvature_per_cm"));
    }
}
