//! What is wrong with the readings, and what is not.

use super::*;

impl Runs {
    /// The same with one channel (current 0, bending 1) of a run times `factor`.
    fn scaled(mut self, run: usize, channel: usize, factor: f64) -> Runs {
        let values = &mut self.channels[run][channel].values;
        *values = values.iter().map(|v| factor * v).collect();
        self
    }
}

#[test]
fn a_wrong_unit_and_a_turned_sign_are_faults_of_the_readings() {
    for (run, channel, factor, said) in [
        (1, 0, 1000.0, "its current is 1000 times"),
        (2, 1, 0.01, "its bending is 0.01 times"),
        (1, 1, -1.0, "its bending has the sign opposite"),
        (3, 0, -1.0, "its current has the sign opposite"),
    ] {
        let runs = Runs::with(None, FOUR, 7).scaled(run, channel, factor);
        let inputs = runs.inputs();
        let group = group::RunGroup::new(&inputs);
        let odd = odd_scale::odd_runs(&group, DiagnoseOptions::default().model);
        assert_eq!(odd.len(), 1, "{odd:?}");
        assert!(
            odd[0].run == inputs[run].name && odd[0].reason.starts_with(said),
            "{odd:?}"
        );
    }
}

#[test]
fn a_diagnosis_leaves_out_the_readings_that_a_fit_does_and_says_which() {
    let mut runs = Runs::with(None, &[STEP], 7);
    let clean = runs.diagnosed();
    for (channel, factor) in runs.channels[0].iter_mut().zip([40.0, -3.0]) {
        let peak = channel.values.iter().fold(0.0_f64, |peak, v| peak.max(v.abs()));
        let glitch = |(k, v): (usize, &f64)| if k == 200 { factor * peak } else { *v };
        channel.values = channel.values.iter().enumerate().map(glitch).collect();
    }
    let time_s = runs.channels[0][0].time_s[200];
    let inputs = runs.inputs();
    let cleaned = ieap_fit::without_outliers(inputs[0].input.channels, inputs[0].input.drive);
    assert_eq!(cleaned.left_out_s, vec![vec![time_s]; 2]);
    let group = group::RunGroup::new(&inputs);
    assert_eq!(group.runs[0].left_out_s.to_vec(), cleaned.left_out_s);
    let found = runs.diagnosed();
    assert_eq!(found.verdict, clean.verdict);
    for (remark, name) in found.remarks.iter().zip(["current", "curvature"]) {
        let words = ieap_fit::left_out_in_words(name, &[time_s]);
        assert_eq!(*remark, format!("{}: {words}", inputs[0].name));
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn the_others_are_diagnosed_as_if_a_condemned_run_were_not_there() {
    let runs = Runs::with(None, FOUR, 7).scaled(1, 0, 1000.0);
    let mut found = runs.diagnosed();
    let mut rest = runs.inputs();
    rest.remove(1);
    let expected = diagnose_group("group", &rest, &every_misfit());
    assert!(found.remarks[0].starts_with("second is set aside: its current is 1000 times"));
    assert_eq!(found.condemned.len(), 1);
    found.remarks.remove(0);
    found.condemned.clear();
    // In words, where a number that is none equals itself.
    assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    // On a person's word it takes part.
    let mut all = runs.inputs();
    all[1].is_right = true;
    let group = group::RunGroup::new(&all);
    assert_eq!(odd_scale::odd_runs(&group, DiagnoseOptions::default().model), []);
}

#[test]
fn what_a_strip_can_do_is_no_fault_of_the_readings() {
    let odd = |runs: &Runs| {
        let inputs = runs.inputs();
        let group = group::RunGroup::new(&inputs);
        odd_scale::odd_runs(&group, DiagnoseOptions::default().model)
    };
    // Twice as much is no unit; and the only run to the other side may bend as a strip does that bends one way only.
    for (run, channel, factor) in [(1, 0, 2.0), (1, 1, 0.5), (2, 1, -1.0)] {
        assert_eq!(odd(&Runs::with(None, FOUR, 7).scaled(run, channel, factor)), []);
    }
    let one_way: Hidden = ("quadratic-coupling", None, &[("quadratic_cm_per_c2", 2000.0)]);
    assert_eq!(odd(&Runs::with(Some(one_way), FOUR, 7)), []);
    // Two runs cannot say which of them is the odd one.
    assert_eq!(odd(&Runs::with(None, &[STEP, HALF], 7).scaled(1, 0, 1000.0)), []);
}
