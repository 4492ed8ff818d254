//! Power of planned studies against what is known without simulating.

use super::power::{Chance, Planned, Question, Seen};

const CHANCE: Chance = Chance {
    strips: 0.2,
    in_surroundings: 0.05,
    runs: 0.05,
    fits: 0.02,
    told_by: 1,
};

fn seen(question: Question, strips: usize, change: f64) -> Seen {
    let planned = Planned {
        question,
        strips,
        voltages: 2,
        repeats: 2,
        change,
        questions: 7,
    };
    planned.seen(&CHANCE, (60, 5))
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
fn of_one_strip_nothing_is_seen_of_its_material_and_a_seed_gives_the_same_again() {
    let one = seen(Question::Environment, 1, 0.26);
    assert!(one.of_material == 0 && one.of_strips > 40, "{one:?}");
    assert_eq!(one, seen(Question::Environment, 1, 0.26));
}
