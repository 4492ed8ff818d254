//! The distributed model against values that were computed to high precision elsewhere.

use std::collections::HashMap;
use std::path::Path;

use ieap::model::DistributedModel;
use ieap::model::coupling::CurvaturePerLineCharge;

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

#[test]
fn one_branch_along_the_strip() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/reference/distributed_one_branch.csv");
    if !path.exists() {
        println!("skipped: distributed_one_branch.csv is not here");
        return;
    }
    let mut reader = csv::Reader::from_path(path).unwrap();
    let mut rows = 0;
    for row in reader.deserialize() {
        let row: HashMap<String, String> = row.unwrap();
        let model = DistributedModel {
            electrode_resistance_ohm_per_cm: number(&row, "re_ohm_per_cm"),
            branch_resistance_ohm_cm: number(&row, "rc_ohm_cm"),
            capacitance_f_per_cm: number(&row, "c_f_per_cm"),
            steady_state_resistance_ohm_cm: number(&row, "rss_ohm_cm"),
            length_cm: number(&row, "length_cm"),
            coupling: CurvaturePerLineCharge(number(&row, "mu")),
            relaxation_rate_per_s: number(&row, "lambda_per_s"),
        };
        let (step_v, s, t) = (number(&row, "v0_v"), number(&row, "s_cm"), number(&row, "t_s"));
        let full_c = step_v * model.capacitance_f_per_cm;
        for (field, column, full) in [
            (model.voltage_v(step_v, &[s], &[t]), "v_v", step_v),
            (model.charge_c_per_cm(step_v, &[s], &[t]), "q_c_per_cm", full_c),
            (
                model.curvature_per_cm(step_v, &[s], &[t]),
                "curvature_per_cm",
                full_c * model.coupling.0,
            ),
        ] {
            let expected = number(&row, column);
            let miss = (field.at(0, 0) - expected).abs();
            let allowed = (1e-6 * expected.abs()).max(field.truncation_bound.unwrap() + 1e-14 * full);
            assert!(
                miss <= allowed,
                "{column} at {s} cm, {t} s: {} instead of {expected}",
                field.at(0, 0)
            );
        }
        rows += 1;
    }
    assert!(rows > 180, "{rows}");
}
