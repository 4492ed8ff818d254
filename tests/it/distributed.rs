//! Voltages and curvatures along the strip, as a file, to the distributed model's parameters.

use ieap::model::Branch;
use ieap::model::coupling::{ActiveArea, CurvaturePerTotalCharge};
use ieap::model::distributed::Laminate;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder};

/// CNaf of table 3 of the thesis: 28 mm x 5 mm.
fn table() -> String {
    let of = ActiveArea {
        length_cm: 2.8,
        width_cm: 0.5,
    };
    let model = Laminate {
        electrode_resistance_ohm_per_sq: 2.5,
        branch: Branch {
            resistance_ohm_cm2: 4.5,
            capacitance_f_per_cm2: 0.131,
        },
        steady_state_resistance_ohm_cm2: 22.7,
        coupling: CurvaturePerTotalCharge(2.1).areal(&of),
        relaxation_rate_per_s: 0.0029,
    }
    .strip(&of);
    let places_mm = [4.0, 12.0, 24.0];
    let mut text = String::from("time_s,current_a");
    places_mm
        .iter()
        .for_each(|mm| text += &format!(",voltage_v@{mm},curvature_per_cm@{mm}"));
    text += "\n";
    for step in 0..240u32 {
        let t = [200.0 * (f64::from(step) / 239.0).powi(2)];
        // A little noise that no seed is needed for.
        let wobble = |k: u32| 1.0 + 1e-3 * (f64::from((step * 7919 + k * 104_729) % 1009) / 504.5 - 1.0);
        text += &format!(
            "{:.6},{:.6e}",
            t[0],
            model.clamp_current_a(1.5, &t)[0] * wobble(0)
        );
        for (k, mm) in (1u32..).step_by(2).zip(places_mm) {
            let place = [mm / 10.0];
            let voltage = model.voltage_v(1.5, &place, &t).values[0] * wobble(k);
            let curvature = model.curvature_per_cm(1.5, &place, &t).values[0] * wobble(k + 1);
            text += &format!(",{voltage:.6},{curvature:.6}");
        }
        text += "\n";
    }
    text
}

#[test]
fn a_sample_of_table_3_comes_back_from_its_file() {
    let folder = CampaignFolder::new();
    let strip = "length_mm = 28.0\nwidth_mm = 5.0\nelectrode_resistance_ohm_per_sq = 2.5\n";
    folder.write(
        "campaign.toml",
        CAMPAIGN_TOML.replace("length_mm = 5.0\nwidth_mm = 2.0\n", strip),
    );
    folder.write("runs/a.csv", table());
    folder.write("runs/a.csv.toml", "voltage_v = 1.5\n");
    let document = folder
        .ieap(&["fit", "--json", "--model", "distributed"])
        .expect(0)
        .json();
    let fit = &document["fits"][0];
    assert_eq!(fit["model"], "distributed", "{document:#}");
    for (key, truth) in [
        ("re_ohm_per_sq", 2.5),
        ("rc_ohm_cm2", 4.5),
        ("c_f_per_cm2", 0.131),
        ("rss_ohm_cm2", 22.7),
        ("lambda_per_s", 0.0029),
        ("alpha_per_c_cm", 2.1),
    ] {
        let value = fit["parameters"][key]["value"]
            .as_f64()
            .unwrap_or_else(|| panic!("{key}: {fit:#}"));
        assert!((value / truth - 1.0).abs() < 0.01, "{key}: {value} for {truth}");
    }
    assert!(fit["issues"].to_string().contains("lumped-or-distributed"));
    // The lumped model takes the mean curvature.
    let lumped = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert!(
        lumped["fits"][0]["parameters"]["alpha_per_c_cm"]["value"].is_number(),
        "{lumped:#}"
    );
    let report = folder
        .ieap(&["run", "--no-diagnose", "--model", "distributed"])
        .expect(0);
    assert!(report.stdout.contains("Report:"), "{report:?}");
}

#[test]
fn a_run_without_anything_along_the_strip_says_so() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", "time_s,voltage_v,curvature_per_cm\n0,1,0\n1,1,0.1\n2,1,0.2\n3,1,0.2\n4,1,0.2\n5,1,0.2\n6,1,0.2\n7,1,0.2\n");
    let document = folder
        .ieap(&["fit", "--json", "--model", "distributed"])
        .expect(0)
        .json();
    assert_eq!(
        document["not_fitted"][0]["issues"][1]["code"], "not-fitted",
        "{document:#}"
    );
    // A run whose fit failed does not wait for one.
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let issues = status["status"]["not_fitted"][0]["issues"].to_string();
    assert!(
        issues.contains("\"not-fitted\"") && !issues.contains("not-fitted-yet"),
        "{issues}"
    );
}
