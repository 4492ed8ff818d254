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
        (1, 0, 1000.0, "The current of second is 1000 times"),
        (2, 1, 0.01, "The bending of third is 0.01 times"),
        (1, 1, -1.0, "The bending of second has the sign opposite"),
        (3, 0, -1.0, "The current of fourth has the sign opposite"),
    ] {
        let found = Runs::with(None, FOUR, 7).scaled(run, channel, factor).diagnosed();
        assert_eq!(found.verdict, Verdict::DataProblem, "{}", found.sentence);
        assert!(found.sentence.starts_with(said), "{}", found.sentence);
        assert!(found.set.is_empty() && found.p_misfit.is_none());
    }
}

#[test]
fn what_a_strip_can_do_is_no_fault_of_the_readings() {
    let odd = |runs: &Runs| {
        let inputs = runs.inputs();
        let group = group::Group::new(&inputs);
        odd_scale::found("group", &group, DiagnoseOptions::default().model).map(|found| found.sentence)
    };
    // Twice as much is no unit; and the only run to the other side may bend as a strip does that bends one way only.
    for (run, channel, factor) in [(1, 0, 2.0), (1, 1, 0.5), (2, 1, -1.0)] {
        assert_eq!(odd(&Runs::with(None, FOUR, 7).scaled(run, channel, factor)), None);
    }
    let one_way: Hidden = ("quadratic-coupling", None, &[("quadratic_cm_per_c2", 2000.0)]);
    assert_eq!(odd(&Runs::with(Some(one_way), FOUR, 7)), None);
    // Two runs cannot say which of them is the odd one.
    assert_eq!(
        odd(&Runs::with(None, &[STEP, HALF], 7).scaled(1, 0, 1000.0)),
        None
    );
}
