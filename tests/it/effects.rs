//! `ieap list effects`: what is known of the effects that a model may be missing.

use tempfile::TempDir;

use crate::campaign::ieap;

#[test]
fn effects_are_listed() {
    let folder = TempDir::new().unwrap();
    insta::assert_snapshot!(ieap(folder.path(), &["list", "effects"]).expect(0).stdout);
    let document = ieap(folder.path(), &["list", "effects", "--json"])
        .expect(0)
        .json();
    assert_eq!(document["schema"], "ieap/effects/2");
    let effects = document["effects"].as_array().unwrap();
    assert_eq!(effects.len(), ieap::model::effects::ALL.len());
    assert_eq!(effects[0]["parameters"][0]["unit"], "Ohm cm2");
}

#[test]
fn one_effect_is_told_in_full() {
    let folder = TempDir::new().unwrap();
    insta::assert_snapshot!(
        ieap(folder.path(), &["list", "effects", "faradaic-leak"])
            .expect(0)
            .stdout
    );
    let refused = ieap(folder.path(), &["list", "effects", "faradaic"]).expect(2);
    assert!(
        refused.stderr.contains("`ieap list effects` lists the ids"),
        "{refused:?}"
    );
}
