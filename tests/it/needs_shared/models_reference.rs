//! The models against what stands elsewhere: high-precision values of the distributed model, the reader's own
//! copy of equation [3], the laminates of table 3.

use std::collections::HashMap;

use ieap::model::DistributedModel;
use ieap::model::coupling::CurvaturePerLineCharge;

use super::shared;

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

#[test]
fn one_branch_along_the_strip() {
    let Some(path) = shared("reference/distributed_one_branch.csv") else {
        return;
    };
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

#[test]
fn laminates_of_table_3_need_the_distributed_model_and_bend_as_identified() {
    use ieap::model::coupling::{ActiveArea, CurvaturePerTotalCharge};
    use ieap::model::{Branch, Laminate};
    let Some(path) = shared("reference/thesis_table3.csv") else {
        return;
    };
    let mut reader = csv::Reader::from_path(path).unwrap();
    let rows: Vec<HashMap<String, String>> = reader.deserialize().map(|row| row.unwrap()).collect();
    assert_eq!(rows.len(), 2);
    for row in rows {
        let strip = ActiveArea {
            length_cm: number(&row, "length_mm") / 10.0,
            width_cm: number(&row, "width_mm") / 10.0,
        };
        let laminate = Laminate {
            electrode_resistance_ohm_per_sq: number(&row, "re_ohm_per_sq"),
            branch: Branch {
                resistance_ohm_cm2: number(&row, "rc_ohm_cm2"),
                capacitance_f_per_cm2: number(&row, "c_mf_per_cm2") / 1000.0,
            },
            steady_state_resistance_ohm_cm2: number(&row, "rss_ohm_cm2"),
            coupling: CurvaturePerTotalCharge(number(&row, "alpha_per_c_cm")).areal(&strip),
            relaxation_rate_per_s: number(&row, "lambda_per_s"),
        };
        let model = laminate.strip(&strip);
        let error = model.lumped_error();
        assert!(error.first_displacement > 0.4, "{row:?}: {error:?}");
        // A curvature is alpha times the total charge where nothing has relaxed: at the mean over the strip.
        let slow = ieap::model::DistributedModel {
            relaxation_rate_per_s: 0.0,
            ..model
        };
        let mean_curvature = slow.tip_angle_rad(1.0, &[2.0])[0] / strip.length_cm;
        let total_c = slow.total_charge_c(1.0, &[2.0])[0];
        let alpha = mean_curvature / total_c;
        assert!(
            (alpha / number(&row, "alpha_per_c_cm") - 1.0).abs() < 1e-12,
            "{alpha}"
        );
    }
}

#[test]
fn every_row_of_table_5_charges_faster_than_it_relaxes() {
    let Some(path) = shared("reference/thesis_table5.csv") else {
        return;
    };
    let mut reader = csv::Reader::from_path(path).unwrap();
    let rows: Vec<HashMap<String, String>> = reader.deserialize().map(|row| row.unwrap()).collect();
    assert_eq!(rows.len(), 18);
    for row in rows {
        let tau_s = number(&row, "r2_ohm_cm2") * number(&row, "c2_f_per_cm2");
        assert!(tau_s * number(&row, "lambda_per_s") < 1.0, "{row:?}");
    }
}
