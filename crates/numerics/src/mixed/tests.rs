//! Ten designs against lme4 and emmeans, and what must hold of any design.

use proptest::prelude::*;

use super::*;

const DESIGNS: &str = include_str!("../../../../docs/validation/study/designs.csv");
const ANSWERS: &str = include_str!("../../../../docs/validation/study/answers.csv");

/// Environment, voltage (numbers from 1) and value of a reading, by sample.
type Row = (usize, usize, usize, f64);

fn rows(design: &str) -> Vec<Row> {
    let all = DESIGNS
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>());
    all.filter(|row| row[0] == design)
        .map(|row| {
            let number = |k: usize| row[k].parse().unwrap();
            (number(1), number(2), number(3), row[4].parse().unwrap())
        })
        .collect()
}

/// Cells of environment and voltage, with samples and samples in environments by chance; and the number of voltages.
fn model(rows: &[Row], known: f64) -> (MixedModel, usize) {
    let most = |of: fn(&Row) -> usize| rows.iter().map(of).max().unwrap();
    let (environments, voltages) = (most(|row| row.1), most(|row| row.2));
    let unit = |&(sample, environment, voltage, value): &Row| {
        let mut fixed = vec![0.0; environments * voltages];
        fixed[(environment - 1) * voltages + voltage - 1] = 1.0;
        let mut random = vec![0.0; environments + 1];
        (random[0], random[environment]) = (1.0, 1.0);
        let variance = known;
        let readings = vec![Reading::new(value, variance)];
        Unit {
            block: sample - 1,
            fixed,
            random,
            readings,
        }
    };
    let mut component_of = vec![1; environments + 1];
    component_of[0] = 0;
    let units = rows.iter().map(unit).collect();
    (MixedModel { units, component_of }, voltages)
}

/// Factors of one environment less another, over all voltages alike.
fn contrast(columns: usize, voltages: usize, (upper, lower): (usize, usize)) -> Vec<f64> {
    let factor = |column: usize| match column / voltages + 1 {
        environment if environment == upper => 1.0 / voltages as f64,
        environment if environment == lower => -1.0 / voltages as f64,
        _ => 0.0,
    };
    (0..columns).map(factor).collect()
}

#[test]
fn ten_designs_are_answered_as_lme4_and_emmeans_do() {
    let mut asked = 0;
    for line in ANSWERS.lines().skip(1) {
        let answer: Vec<&str> = line.split(',').collect();
        let number = |k: usize| answer[k].parse::<f64>().unwrap();
        let (model, voltages) = model(&rows(answer[0]), 0.0);
        let found = model.estimated().unwrap();
        let (upper, lower) = answer[1].split_once(" - ").unwrap();
        let pair = (upper.parse().unwrap(), lower.parse().unwrap());
        let combined = found.combined(&contrast(found.coefficients.len(), voltages, pair));
        let near = |own: f64, theirs: f64, part: f64| {
            let size = theirs.abs().max(1e-3);
            assert!((own - theirs).abs() < part * size, "{line}: {own} for {theirs}");
        };
        near(combined.value, number(2), 1e-5);
        near(combined.variance.sqrt(), number(3), 2e-5);
        // Of design 1 emmeans itself says 1.992 for one and 2.000 for two of three contrasts that are alike.
        near(combined.freedom, number(4), 5e-3);
        for k in 0..3 {
            near(found.variances[k], number(5 + k), 1e-3);
        }
        asked += 1;
    }
    assert_eq!(asked, 25);
}

#[test]
fn known_errors_take_their_part_from_what_is_estimated() {
    let rows = rows("5");
    let (plain, voltages) = model(&rows, 0.0);
    let (known, _) = model(&rows, 0.01);
    let (plain, known) = (plain.estimated().unwrap(), known.estimated().unwrap());
    assert!((plain.variances[2] - known.variances[2] - 0.01).abs() < 1e-6);
    let factors = contrast(plain.coefficients.len(), voltages, (2, 1));
    let (a, b) = (plain.combined(&factors), known.combined(&factors));
    assert!((a.value - b.value).abs() < 1e-9 && (a.variance / b.variance - 1.0).abs() < 1e-6);
    assert!((a.freedom - b.freedom).abs() < 1e-3);
}

#[test]
fn what_the_design_does_not_tell_apart_is_held_at_zero() {
    // One run a sample and environment: the readings' variance is that of samples in environments.
    let rows: Vec<Row> = (rows("4").into_iter())
        .scan(std::collections::BTreeSet::new(), |seen, row| {
            Some(seen.insert((row.0, row.1)).then_some(row))
        })
        .flatten()
        .collect();
    let (model, _) = model(&rows, 0.0);
    let found = model.estimated().unwrap();
    assert_eq!(found.variances[1], 0.0);
    assert!(found.variances[2] > 0.0);
    // As many columns as readings leave nothing to tell a variance from.
    let single = MixedModel {
        units: model.units[..2].to_vec(),
        ..model.clone()
    };
    assert!(single.estimated().is_none());
}

#[test]
fn stated_variances_give_weighted_means_and_no_degrees_of_freedom() {
    let (mut model, _) = model(&[(1, 1, 1, 1.0), (1, 1, 1, 3.0)], 0.0);
    model.units[0].readings[0].variance = 1.0;
    model.units[1].readings[0].variance = 3.0;
    let found = model.at(&[0.0, 0.0, 0.0]).unwrap().combined(&[1.0]);
    assert!((found.value - 1.5).abs() < 1e-12 && (found.variance - 0.75).abs() < 1e-12);
    assert!(found.freedom.is_infinite());
}

/// The place of the reading of a model that holds this value.
fn place(model: &MixedModel, value: f64) -> (usize, usize) {
    let each = model.units.iter().enumerate();
    let mut all = each.flat_map(|(k, unit)| {
        unit.readings
            .iter()
            .enumerate()
            .map(move |(of, own)| ((k, of), own))
    });
    all.find(|(_, own)| own.value == value).unwrap().0
}

#[test]
fn a_reading_that_counts_twice_is_two() {
    let rows = rows("5");
    let (mut once, voltages) = model(&rows, 0.0);
    once.units[3].readings[0].weight = 2.0;
    let (twice, _) = model(&[&rows[..], &rows[3..4]].concat(), 0.0);
    let (once, twice) = (once.estimated().unwrap(), twice.estimated().unwrap());
    let factors = contrast(once.coefficients.len(), voltages, (2, 1));
    let (a, b) = (once.combined(&factors), twice.combined(&factors));
    assert!(
        (a.value - b.value).abs() < 1e-9 && (a.variance / b.variance - 1.0).abs() < 1e-7,
        "{a:?} {b:?}"
    );
    assert!((a.freedom / b.freedom - 1.0).abs() < 1e-5, "{a:?} {b:?}");
}

#[test]
fn how_far_a_reading_stands_off_is_the_shift_that_it_would_need() {
    for design in ["1", "5", "8"] {
        let (model, _) = model(&rows(design), 1e-4);
        let found = model.estimated().unwrap();
        for (of, off) in model.standings(&found).unwrap() {
            let shifted = model.with_shift(of).at(&found.variances);
            let Some(shifted) = shifted else {
                assert!(off < 1e-3, "{design} {of:?} {off}");
                continue;
            };
            let mut factors = vec![0.0; shifted.coefficients.len()];
            *factors.last_mut().unwrap() = 1.0;
            let own = shifted.combined(&factors);
            let expected = own.value.abs() / own.variance.sqrt();
            assert!(
                (off - expected).abs() < 1e-6 * expected.max(1.0),
                "{design} {of:?}: {off} {expected}"
            );
        }
    }
}

#[test]
fn a_reading_of_something_else_counts_for_nothing_and_moves_no_answer() {
    for design in ["5", "8", "10"] {
        let rows = rows(design);
        let (clean, voltages) = model(&rows, 0.0);
        let (clean, none) = clean.with_odd_weighed();
        assert!(none.iter().all(|own| own.weight > 0.5), "{design} {none:?}");
        let without = clean.estimated().unwrap();
        let mut wrong = rows.clone();
        wrong[4].3 += 3.0;
        let (model, _) = model(&wrong, 0.0);
        let at = place(&model, wrong[4].3);
        let (model, odd) = model.with_odd_weighed();
        let own = odd.iter().find(|own| own.place == at).unwrap();
        assert!(own.weight < 1e-3 && own.off > 5.0, "{design} {odd:?}");
        let with = model.estimated().unwrap();
        let factors = contrast(with.coefficients.len(), voltages, (2, 1));
        let (a, b) = (without.combined(&factors), with.combined(&factors));
        assert!(
            (a.value - b.value).abs() < a.variance.sqrt(),
            "{design} {a:?} {b:?}"
        );
        assert!(b.variance < 2.0 * a.variance, "{design} {a:?} {b:?}");
    }
}

#[test]
fn two_readings_of_a_condition_accuse_each_other_alike() {
    // Ten conditions of one strip, two runs each; of one the two lie apart.
    let row = |k: usize| -> Row { (1, k / 2 + 1, 1, 0.01 * ((7 * k) % 11) as f64) };
    let mut rows: Vec<Row> = (0..20).map(row).collect();
    (rows[6].3, rows[7].3) = (0.0, 2.0);
    let (model, _) = model(&rows, 0.0);
    let plain = MixedModel {
        units: model
            .units
            .iter()
            .map(|unit| Unit {
                random: Vec::new(),
                ..unit.clone()
            })
            .collect(),
        component_of: Vec::new(),
    };
    let (_, odd) = plain.with_odd_weighed();
    let (half, like): (Vec<&Odd>, Vec<&Odd>) = odd.iter().partition(|own| own.weight < 0.9);
    assert!(
        half.len() == 2 && half.iter().all(|own| (own.weight - 0.5).abs() < 1e-3),
        "{odd:?}"
    );
    assert!(like.iter().all(|own| own.weight > 0.99), "{odd:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_variance_near_the_ones_found_is_likelier(
        design in 1..=10_usize, part in 0.5..2.0_f64, component in 0..3_usize,
    ) {
        let (model, _) = model(&rows(&design.to_string()), 1e-4);
        let found = model.estimated().unwrap();
        let mut other = found.variances.clone();
        other[component] = other[component] * part + 1e-6;
        let likelihood = model.at(&other).unwrap().log_likelihood;
        prop_assert!(likelihood <= found.log_likelihood + 1e-7, "{likelihood} {found:?}");
    }
}
