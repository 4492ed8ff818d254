//! Ten designs against lme4, what must hold of any design, and how often what is told is true.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::student::quantile_95;

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
    let widths = vec![Width::All, Width::Readings];
    let model = MixedModel {
        units,
        component_of,
        widths,
    };
    (model, voltages)
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
        let (upper, lower) = answer[1].split_once(" - ").unwrap();
        let pair = (upper.parse().unwrap(), lower.parse().unwrap());
        let factors = contrast(model.units[0].fixed.len(), voltages, pair);
        let (own, error, freedom) = (number(2), number(3), number(4));
        let there = model
            .at(&[number(5), number(6), number(7)])
            .unwrap()
            .combined(&factors);
        assert!(
            (there.mean() - own).abs() < 1e-5 * own.abs().max(1e-3),
            "{line}: {there:?}"
        );
        // Errors of Kenward and Roger are these with what variances leave open.
        assert!(
            there.error() < 1.00002 * error && there.error() > 0.8 * error,
            "{line}: {there:?}"
        );
        let integrated = model.estimated().unwrap().combined(&factors);
        let (low, high) = integrated.ends_95();
        let reach = quantile_95(freedom) * error;
        let ratio = 0.5 * (high - low) / reach;
        // Of four degrees of freedom and more both say the same of the error.
        let (least, most) = if freedom > 4.0 { (0.7, 1.3) } else { (0.3, 1.5) };
        assert!(
            (least..most).contains(&ratio),
            "{line}: {low} to {high}, {ratio} of {reach}"
        );
        assert!(
            (integrated.mean() - own).abs() < 0.2 * error,
            "{line}: {integrated:?}"
        );
        asked += 1;
    }
    assert_eq!(asked, 25);
}

#[test]
fn known_errors_take_their_part_from_what_is_integrated() {
    let rows = rows("5");
    let (plain, voltages) = model(&rows, 0.0);
    let (known, _) = model(&rows, 0.01);
    let (plain, known) = (plain.estimated().unwrap(), known.estimated().unwrap());
    // Halves of the weight are told to a place of the lattice.
    let ratio = plain.variances[2] / (known.variances[2] + 0.01);
    assert!((0.85..1.15).contains(&ratio), "{ratio}");
    let factors = contrast(plain.coefficients.len(), voltages, (2, 1));
    let (a, b) = (plain.combined(&factors), known.combined(&factors));
    assert!((a.mean() - b.mean()).abs() < 0.05 * a.error() && (a.error() / b.error() - 1.0).abs() < 0.1);
}

#[test]
fn what_the_design_does_not_tell_apart_is_open() {
    // One run a sample and environment: the readings' scatter is that of samples in environments.
    let rows: Vec<Row> = (rows("4").into_iter())
        .scan(std::collections::BTreeSet::new(), |seen, row| {
            Some(seen.insert((row.0, row.1)).then_some(row))
        })
        .flatten()
        .collect();
    let (whole, _) = model(&rows, 0.0);
    let mut plain = whole.clone();
    plain.component_of.retain(|of| *of == 0);
    plain.widths.truncate(1);
    plain.units.iter_mut().for_each(|unit| unit.random.truncate(1));
    let factors = contrast(whole.units[0].fixed.len(), 1, (2, 1));
    let [with, without] = [&whole, &plain].map(|of| of.estimated().unwrap().combined(&factors).ends_95());
    let ratio = (with.1 - with.0) / (without.1 - without.0);
    assert!((0.9..1.1).contains(&ratio), "{with:?} {without:?}");
    // As many columns as readings leave nothing to tell a variance from.
    let single = MixedModel {
        units: whole.units[..2].to_vec(),
        ..whole.clone()
    };
    assert!(single.estimated().is_none());
}

#[test]
fn stated_variances_give_weighted_means() {
    let (mut model, _) = model(&[(1, 1, 1, 1.0), (1, 1, 1, 3.0)], 0.0);
    model.units[0].readings[0].variance = 1.0;
    model.units[1].readings[0].variance = 3.0;
    let found = model.at(&[0.0, 0.0, 0.0]).unwrap().combined(&[1.0]);
    assert!((found.mean() - 1.5).abs() < 1e-12 && (found.error() - 0.75_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn of_one_scatter_it_is_the_law_of_student() {
    // Two that are left tell a scatter hardly at all.
    for (readings, part) in [(3, 0.03), (4, 0.01), (8, 0.01), (40, 0.01)] {
        let row = |k: usize| -> Row { (1, 1, 1, (0.7 * k as f64).sin()) };
        let rows: Vec<Row> = (0..readings).map(row).collect();
        let (model, _) = model(&rows, 0.0);
        let plain = without_chance(model);
        let own = plain.estimated().unwrap().combined(&[1.0]);
        let y: Vec<f64> = rows.iter().map(|row| row.3).collect();
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        let square: f64 = y.iter().map(|y| (y - mean).powi(2)).sum();
        let left = y.len() as f64 - 1.0;
        let reach = quantile_95(left) * (square / left / y.len() as f64).sqrt();
        let (low, high) = own.ends_95();
        assert!(
            (low - mean + reach).abs() < part * reach,
            "{readings}: {low} {mean} {reach}"
        );
        assert!(
            (high - mean - reach).abs() < part * reach,
            "{readings}: {high} {mean} {reach}"
        );
    }
}

/// Contrasts of designs with nothing hidden: strips as they are in three environments at three voltages.
fn nulls(campaigns: u64, seed: u64) -> (usize, [usize; 2]) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut asked, mut below) = (0, [0; 2]);
    for (strips, kept) in [(1, 1.0), (2, 0.55), (2, 1.0), (3, 0.8)] {
        for cell in [0.0, 0.03] {
            for _ in 0..campaigns {
                let Some(model) = null(strips, kept, cell, &mut random) else {
                    continue;
                };
                let Some(found) = model.estimated() else {
                    continue;
                };
                for column in [strips, strips + 2] {
                    let mut factors = vec![0.0; found.coefficients.len()];
                    factors[column] = 1.0;
                    let p = found.combined(&factors).chance_of_none();
                    asked += 1;
                    below[0] += usize::from(p < 0.05);
                    below[1] += usize::from(p < 0.001);
                }
            }
        }
    }
    (asked, below)
}

fn null(strips: usize, kept: f64, cell: f64, random: &mut ChaCha8Rng) -> Option<MixedModel> {
    let mut draw = |size: f64| -> f64 {
        let own: f64 = StandardNormal.sample(random);
        size * own
    };
    let mut units = Vec::new();
    for strip in 0..strips {
        for environment in 0..3 {
            let own = draw(cell);
            for voltage in 0..3 {
                let y = own + draw(0.015) + draw(0.003);
                let mut fixed = vec![0.0; strips + 3];
                fixed[strip] = 1.0;
                if environment > 0 {
                    fixed[strips + environment - 1] = 1.0;
                }
                fixed[strips + 2] = 0.5 * f64::from(voltage);
                let mut part = vec![0.0; 3];
                part[environment] = 1.0;
                units.push(Unit {
                    block: strip,
                    fixed,
                    random: part,
                    readings: vec![Reading::new(y, 9e-6)],
                });
            }
        }
    }
    units.retain(|_| random.random::<f64>() < kept);
    (units.len() > strips + 4).then_some(MixedModel {
        units,
        component_of: vec![0; 3],
        widths: vec![Width::Readings],
    })
}

#[test]
fn a_scatter_that_shows_as_nothing_makes_no_certainty() {
    let (asked, below) = nulls(60, 2);
    assert!(
        asked > 900 && below[0] * 20 <= asked * 6 / 5 && below[1] <= 2,
        "{below:?} of {asked}"
    );
}

/// The same without what is left to chance.
fn without_chance(model: MixedModel) -> MixedModel {
    let plain = |unit: &Unit| Unit {
        random: Vec::new(),
        ..unit.clone()
    };
    MixedModel {
        units: model.units.iter().map(plain).collect(),
        component_of: Vec::new(),
        widths: Vec::new(),
    }
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
    let near = (a.mean() - b.mean()).abs() < 1e-9 && (a.error() / b.error() - 1.0).abs() < 1e-7;
    assert!(near, "{a:?} {b:?}");
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
            let expected = own.mean().abs() / own.error();
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
        let (clean, none, _) = clean.with_odd_weighed();
        assert!(none.iter().all(|own| own.weight > 0.5), "{design} {none:?}");
        let without = clean.estimated().unwrap();
        let mut wrong = rows.clone();
        wrong[4].3 += 3.0;
        let (model, _) = model(&wrong, 0.0);
        let at = place(&model, wrong[4].3);
        let (model, odd, _) = model.with_odd_weighed();
        let own = odd.iter().find(|own| own.place == at).unwrap();
        assert!(own.weight < 1e-3 && own.off > 5.0, "{design} {odd:?}");
        let with = model.estimated().unwrap();
        let factors = contrast(with.coefficients.len(), voltages, (2, 1));
        let (a, b) = (without.combined(&factors), with.combined(&factors));
        assert!((a.mean() - b.mean()).abs() < a.error(), "{design} {a:?} {b:?}");
        assert!(b.error() < 1.4 * a.error(), "{design} {a:?} {b:?}");
    }
}

#[test]
fn two_readings_of_a_condition_accuse_each_other_alike() {
    // Ten conditions of one strip, two runs each; of one the two lie apart.
    let row = |k: usize| -> Row { (1, k / 2 + 1, 1, 0.01 * ((7 * k) % 11) as f64) };
    let mut rows: Vec<Row> = (0..20).map(row).collect();
    (rows[6].3, rows[7].3) = (0.0, 2.0);
    let (model, _) = model(&rows, 0.0);
    let plain = without_chance(model);
    let (_, odd, _) = plain.with_odd_weighed();
    let (half, like): (Vec<&Odd>, Vec<&Odd>) = odd.iter().partition(|own| own.weight < 0.9);
    assert!(
        half.len() == 2 && half.iter().all(|own| (own.weight - 0.5).abs() < 1e-3),
        "{odd:?}"
    );
    assert!(like.iter().all(|own| own.weight > 0.99), "{odd:?}");
}
