//! Power of planned studies against what is known without simulating.

use super::power::{Chance, Planned, Question, Seen, Sizes};

const SIZES: Sizes = Sizes {
    strips: 0.2,
    in_surroundings: 0.05,
    runs: 0.05,
    fits: 0.02,
};

fn seen(question: Question, strips: usize, change: f64) -> Seen {
    seen_with(&Chance::known(SIZES), question, strips, change)
}

fn seen_with(chance: &Chance, question: Question, strips: usize, change: f64) -> Seen {
    let planned = Planned {
        question,
        strips,
        voltages: 2,
        repeats: 2,
        change,
        questions: 7,
    };
    planned.seen(chance, (60, 5))
}

#[test]
fn more_strips_see_more_and_nothing_is_seen_where_nothing_is() {
    let two = seen(Question::Environment, 2, 0.26);
    let four = seen(Question::Environment, 4, 0.26);
    assert!(
        two.of_material < 30 && four.of_material > two.of_material + 20,
        "{two:?} {four:?}"
    );
    assert!(two.of_strips >= 55, "{two:?}");
    let nothing = seen(Question::Environment, 4, 0.0);
    assert!(nothing.of_material <= 2, "{nothing:?}");
    let levels = Question::Humidity(vec![20.0, 40.0, 60.0, 80.0]);
    let law = seen(levels.clone(), 2, 0.26);
    assert!(
        law.of_strips > two.of_material && law.of_strips >= law.of_material,
        "{law:?}"
    );
    let nothing = seen(levels, 2, 0.0);
    assert!(nothing.of_strips <= 2, "{nothing:?}");
}

#[test]
fn scatters_that_a_pilot_leaves_open_are_drawn_and_not_taken_for_known() {
    let far = |times: f64| Sizes {
        in_surroundings: times * SIZES.in_surroundings,
        runs: times * SIZES.runs,
        ..SIZES
    };
    let open = Chance {
        may_be: vec![(0.5, far(0.2)), (0.5, far(5.0))],
        ..Chance::known(SIZES)
    };
    let of = |chance: &Chance| seen_with(chance, Question::Environment, 6, 0.26).of_material;
    let [small, large] = [0.2, 5.0].map(|times| of(&Chance::known(far(times))));
    let (known, open) = (of(&Chance::known(SIZES)), of(&open));
    assert!(small > 55 && known > 50 && large < 20, "{small} {known} {large}");
    assert!((20..48).contains(&open), "{open}");
}

#[test]
fn of_one_strip_nothing_is_seen_of_its_material_and_a_seed_gives_the_same_again() {
    let one = seen(Question::Environment, 1, 0.26);
    assert!(one.of_material == 0 && one.of_strips > 40, "{one:?}");
    assert_eq!(one, seen(Question::Environment, 1, 0.26));
}
