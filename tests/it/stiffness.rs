//! Stiffness or coupling: strips whose alpha is halved, one because it became twice as stiff, one because a charge pulls
//! half as hard; told by a modulus log, by a blocking force, and by both.

use std::fmt::Write as _;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

use crate::campaign::CampaignFolder;

/// R, C, R_ss of a strip of 5 mm x 2 mm, whole, and its relaxation.
const STRIP: [f64; 4] = [400.0, 5e-3, 4e4, 4e-3];
const VOLTS: f64 = 2.0;

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// Current, and what the charge moves: curvature of a free strip (alpha, 1/(C cm)) or force of a held one (mu, mN mm / C).
fn run(column: &str, per_charge: f64, noise: f64, seed: u64) -> String {
    let [r, c, leak, lambda] = STRIP;
    let tau = r * c;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut text = format!("time_s,current_a,{column}\n");
    for k in 0..400 {
        let t = 0.25 * f64::from(k);
        let current = VOLTS / leak + VOLTS / r * (-t / tau).exp() + 3e-6 * normal(&mut random);
        let charge = VOLTS * c * ((-t / tau).exp() - (-lambda * t).exp()) / (tau * lambda - 1.0);
        let moved = per_charge * charge + noise * normal(&mut random);
        writeln!(text, "{t},{current:.7e},{moved:.6e}").unwrap();
    }
    text
}

fn free(alpha_per_c_cm: f64, seed: u64) -> String {
    run("curvature_per_cm", alpha_per_c_cm, 2e-3, seed)
}

/// The force that a strip of that mu presses with at its free length of 5 mm, from the beam: F = 3 M / (2 L).
fn held(mu_mn_mm_per_c: f64, seed: u64) -> String {
    run("blocking_force_mn", 1.5 * mu_mn_mm_per_c / 5.0, 1e-3, seed)
}

/// |E*| of 100 MPa at 0 % and of `wet_mpa` at 40 % RH.
fn log(wet_mpa: f64, seed: u64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut text = "time_s,relative_humidity_percent,storage_modulus_mpa,loss_modulus_mpa\n".to_owned();
    for row in 0..240 {
        let t = 30.0 * f64::from(row);
        let lag = |tau: f64| {
            if t > 2400.0 {
                1.0 - (-(t - 2400.0) / tau).exp()
            } else {
                0.0
            }
        };
        let percent = 40.0 * lag(40.0) + 0.2 * normal(&mut random);
        let complex = 100.0 + (wet_mpa - 100.0) * lag(300.0) + 0.5 * normal(&mut random);
        writeln!(text, "{t},{percent:.2},{:.3},{:.3}", 0.8 * complex, 0.6 * complex).unwrap();
    }
    text
}

/// Alpha of all is 6 per C cm when dry and 3 in 40 % RH.
///
/// stiff-log: the modulus doubles. pull-log: it stays. stiff-force: the held strip's mu stays. pull-force: it halves.
/// both: modulus and force say that it is stiffness. odd: they contradict each other.
fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let mut toml = "[campaign]\nid = \"split\"\ntitle = \"Stiffness or coupling\"\n\n".to_owned();
    // With 100 MPa, 2 mm x 0.2 mm: E I is 133.3 mN mm2, so that alpha of 6 per C cm is a mu of 80 mN mm / C.
    let strips = [
        ("stiff-log", Some(200.0), None),
        ("pull-log", Some(100.0), None),
        ("stiff-force", None, Some((80.0, 80.0))),
        ("pull-force", None, Some((80.0, 40.0))),
        ("both", Some(200.0), Some((80.0, 80.0))),
        ("odd", Some(200.0), Some((80.0, 40.0))),
    ];
    let mut seed = 0;
    for (name, wet_mpa, mu) in strips {
        let sizes = "length_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.2";
        write!(
            toml,
            "[[sample]]\nid = \"{name}\"\nmaterial = \"M-{name}\"\n{sizes}\n\n"
        )
        .unwrap();
        for (percent, alpha) in [(0, 6.0), (40, 3.0)] {
            let tags = format!(
                "sample = \"{name}\"\nrelative_humidity_percent = {percent}\nvoltage_v = {VOLTS}\nenvironment = \"air\"\n"
            );
            let place = format!("runs/{name}/{percent}");
            folder.write(&format!("{place}/tags.toml"), tags);
            seed += 1;
            folder.write(&format!("{place}/free.csv"), free(alpha, seed));
            if let Some((dry, wet)) = mu {
                folder.write(
                    &format!("{place}/held.csv"),
                    held(if percent == 0 { dry } else { wet }, 100 + seed),
                );
            }
        }
        if let Some(wet_mpa) = wet_mpa {
            folder.write(&format!("dma/{name}/tags.toml"), format!("sample = \"{name}\"\n"));
            folder.write(&format!("dma/{name}/log.csv"), log(wet_mpa, 200 + seed));
        }
    }
    toml += "[fit]\nmodel = \"lumped-1\"\n";
    folder.write("campaign.toml", toml);
    folder
}

fn table(folder: &CampaignFolder) -> Value {
    folder
        .ieap(&["table", "stiffness", "--format", "json"])
        .expect(0)
        .json()
}

#[test]
fn a_halved_alpha_is_told_to_be_stiffness_or_coupling() {
    let folder = folder();
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let page = folder.report("stiffness.html");
    let said = |sample: &str, word: &str| {
        let begins = format!("{sample} in air at 40 % RH");
        let sentence = page.split("<p>").find(|text| text.starts_with(&begins));
        let sentence = sentence.unwrap_or_else(|| panic!("{sample}: {page}"));
        assert!(sentence.contains(word), "{sentence}");
    };
    said("stiff-log", "it is stiffness");
    said("pull-log", "it is coupling");
    said("stiff-force", "it is stiffness");
    said("pull-force", "it is coupling");
    said("both", "it is stiffness");
    said("both", "modulus and blocking force)");
    said("odd", "contradict each other");
    let answer = "A change of α is one of stiffness alone in 3, of coupling alone in 2; it is not told in 1";
    assert!(page.contains(answer), "{page}");
    let document = table(&folder);
    let rows = document["rows"].as_array().unwrap();
    let cell = |sample: &str, percent: &str, key: &str| {
        let is = |row: &&Value, key: &str, text: &str| row["cells"][key]["text"] == text;
        let mut own = rows.iter().filter(|row| is(row, "sample", sample));
        let own = own.find(|row| is(row, "relative_humidity_percent", percent));
        own.unwrap_or_else(|| panic!("{document:#}"))["cells"][key].clone()
    };
    for (sample, percent, mu) in [("stiff-force", "0", 8e-5), ("pull-force", "40", 4e-5)] {
        let found = cell(sample, percent, "mu_blocked_n_m_per_c");
        let held = |key: &str| found[key].as_f64().unwrap_or_else(|| panic!("{found:#}"));
        assert!(held("low_95") <= mu && held("high_95") >= mu, "{found:#}");
        assert!(held("high_95") - held("low_95") < 0.05 * mu, "{found:#}");
    }
}

#[test]
fn a_force_that_gives_no_moment_says_what_is_missing() {
    let folder = CampaignFolder::new();
    folder.write(
        "campaign.toml",
        "[campaign]\nid = \"t\"\ntitle = \"t\"\n\n[[sample]]\nid = \"S1\"\nmaterial = \"M\"\n",
    );
    folder.write(
        "runs/tags.toml",
        "sample = \"S1\"\nenvironment = \"air\"\nvoltage_v = 2\n",
    );
    folder.write("runs/held.csv", held(80.0, 1));
    folder.write(
        "runs/force-alone.csv",
        "time_s,blocking_force_mn\n0,0\n1,0.1\n2,0.2\n3,0.25\n",
    );
    folder.write("runs/both.csv", "time_s,current_a,curvature_per_cm,blocking_force_mn\n0,1e-3,0,0\n1,5e-4,1e-3,0.1\n2,2e-4,1e-3,0.2\n3,1e-4,1e-3,0.25\n");
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let page = folder.report("stiffness.html");
    assert!(
        page.contains("without the distance from the clamp to the sensor"),
        "{page}"
    );
    assert!(page.contains("force-alone"), "{page}");
    let both = folder.ieap(&["status"]);
    assert!(both.stdout.contains("does not bend freely"), "{}", both.stdout);
}
