//! Whether the readings tell covariates apart that the design ties together.
//!
//! A design ties two covariates where they mostly changed together. A parameter may still follow one of them so closely,
//! and the other so badly, that no doubt is left. Each rival is fitted alone, by the law that suits it best and with the
//! error of its measurement allowed for; it is ruled out where it describes the readings worse by far, adds nothing beside
//! the better covariate, and the readings would have shown an effect of it as large as that of the better one.

use super::chance_of::ask;
use super::covariate::Covariate;
use super::dependence::{Asking, Dependence};
use super::fitted::{self, Material, criterion};
use super::policy::{HUMIDITY_ERROR_PERCENT, LEAST_RELIABILITY, RULED_OUT, TEMPERATURE_ERROR_C};
use super::shape::Law;
use super::table::Table;
use crate::false_discovery::CLAIMED_BELOW;
use crate::policy::DIFFERS_BELOW;
use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::grouped::{Grouped, dot};

/// Part of the span over which a law's slope is taken.
const SLOPE_OVER: f64 = 0.01;

/// A covariate that changed together with another one and was ruled out by the readings.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RuledOut {
    /// The covariate.
    pub covariate: Covariate,
    /// Part of the variation that it leaves alone, by its best law.
    pub left: f64,
    /// Criterion above that of the better covariate: twice the logarithm of the odds.
    pub evidence: f64,
}

/// What the readings say of covariates that changed together.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct ToldApart {
    /// Part of the variation that the better covariate leaves alone.
    pub left: f64,
    /// Those that were ruled out, the nearest rival first.
    pub ruled_out: Vec<RuledOut>,
}

/// What one covariate alone leaves.
struct Alone {
    square: f64,
    paid_for: usize,
    /// What it describes, as columns to take out.
    columns: Vec<Vec<f64>>,
}

impl Asking<'_> {
    /// Which of the covariates that changed together with that of `found` the readings rule out. `variance` and `null`
    /// are those of the law.
    pub(super) fn told_apart(
        &self,
        found: &Dependence,
        table: &Table,
        variance: &[f64],
        null: &Grouped,
    ) -> ToldApart {
        let nothing = ToldApart::default();
        let is_blurred = found.reliability.is_some_and(|part| part < LEAST_RELIABILITY);
        if found.confounded_with.is_empty() || found.p > CLAIMED_BELOW || is_blurred {
            return nothing;
        }
        let ground = Ground {
            asking: self,
            table,
            variance,
            nuisance: table.columns_of(&found.adjusted_for),
            null,
            is_log: found.is_log,
        };
        let Some(own) = ground.alone(found.covariate, variance) else {
            return nothing;
        };
        let whole = square_left(null, &table.y);
        let mut ruled_out: Vec<RuledOut> = found
            .confounded_with
            .iter()
            .filter_map(|&rival| {
                let (left, evidence) = ground.against(&own, rival)?;
                let is_out = evidence > RULED_OUT && !ground.may_add(&own, found.covariate, rival);
                is_out.then_some(RuledOut {
                    covariate: rival,
                    left: left / whole,
                    evidence,
                })
            })
            .collect();
        // What no rival describes alone several may describe together.
        let all_out = ruled_out.len() == found.confounded_with.len();
        if all_out && ruled_out.len() > 1 && !ground.beats_all(&own, &found.confounded_with) {
            return nothing;
        }
        ruled_out.sort_by(|a, b| a.evidence.total_cmp(&b.evidence));
        ToldApart {
            left: own.square / whole,
            ruled_out,
        }
    }
}

/// What covariates are compared on.
struct Ground<'a> {
    asking: &'a Asking<'a>,
    table: &'a Table,
    variance: &'a [f64],
    nuisance: Vec<Vec<f64>>,
    null: &'a Grouped,
    is_log: bool,
}

impl Ground<'_> {
    /// A covariate alone, at readings of that variance.
    fn alone(&self, covariate: Covariate, variance: &[f64]) -> Option<Alone> {
        let null = Grouped::new(variance, &self.table.group, &self.nuisance);
        let Some(x) = self.asking.numbers(self.table, covariate) else {
            let columns = self.table.columns.get(&covariate)?.clone();
            let mut model = null.clone();
            model.take_out_all(&columns);
            let paid_for = model.rank() - null.rank();
            return (model.freedom() > 0 && paid_for > 0).then(|| Alone {
                square: square_left(&model, &self.table.y),
                paid_for,
                columns,
            });
        };
        let line = Line::new(&x);
        let least = fitted::least(&line.material(self, variance, &null), Law::of(covariate))?;
        Some(Alone {
            square: least.square,
            paid_for: least.law.paid_for(),
            columns: vec![line.curve(&least, 0.0, self.is_log)],
        })
    }

    /// What a rival leaves alone, and its criterion above that of the better covariate `own`: errors of the rival's
    /// measurement count for it, those of the better one do not.
    fn against(&self, own: &Alone, rival: Covariate) -> Option<(f64, f64)> {
        let plain = self.alone(rival, self.variance)?;
        let allowed = match self.errors(rival) {
            Errors::None => plain.square,
            Errors::TooLarge => return None,
            Errors::Known(errors) => {
                let x = self.asking.numbers(self.table, rival)?;
                let line = Line::new(&x);
                let material = line.material(self, self.variance, self.null);
                let least = fitted::least(&material, Law::of(rival))?;
                let reach = SLOPE_OVER * line.span.length();
                let ends = [reach, -reach].map(|shift| line.curve(&least, shift, self.is_log));
                let slope = |k: usize| (ends[0][k] - ends[1][k]) / (2.0 * reach);
                let wider: Vec<f64> = (0..x.len())
                    .map(|k| self.variance[k] + (slope(k) * errors[k]).powi(2))
                    .collect();
                self.alone(rival, &wider)?.square
            }
        };
        let n = self.null.freedom() as f64;
        let evidence = match self.asking.numbers(self.table, rival) {
            Some(_) => criterion(allowed, n, plain.paid_for) - criterion(own.square, n, own.paid_for),
            // Names pay for each level, and would lose by that alone against a number that is a function of them.
            None => per_freedom(&plain, n, own),
        };
        Some((plain.square, evidence))
    }

    /// Whether a rival describes a part of what the better covariate, in any form, leaves; or may do so unseen.
    fn may_add(&self, own: &Alone, better: Covariate, rival: Covariate) -> bool {
        let mut beside = self.null.clone();
        beside.take_out_all(&own.columns);
        for (_, columns) in self.asking.shapes(self.table, better) {
            beside.take_out_all(&columns);
        }
        let more = |columns: &Vec<Vec<f64>>| {
            let mut model = beside.clone();
            model.take_out_all(columns);
            model
        };
        let shapes = self.asking.shapes(self.table, rival);
        // That nothing was seen of it is not enough where little could have been seen.
        let explained = square_left(self.null, &self.table.y) - own.square;
        let hidden = |column: &Vec<f64>| self.largest_part(&beside, column);
        let mut columns = shapes.iter().flat_map(|(_, columns)| columns);
        if columns.any(|column| hidden(column) > explained) {
            return true;
        }
        let alternatives: Vec<Grouped> = shapes.iter().map(|(_, columns)| more(columns)).collect();
        let group = &self.table.group;
        ask(
            &self.table.y,
            &beside,
            &alternatives,
            group,
            self.asking.seed.wrapping_add(1),
        )
        .is_some_and(|answer| answer.p <= DIFFERS_BELOW)
    }

    /// The largest square that a column may add to the readings beside what is taken out, by its 95 % interval.
    fn largest_part(&self, beside: &Grouped, column: &[f64]) -> f64 {
        let (left, y) = (beside.residual(column), beside.residual(&self.table.y));
        let (whole, square) = (square_left(self.null, column), dot(&left, &left));
        let freedom = beside.freedom();
        if freedom == 0 || square <= f64::EPSILON * whole {
            return f64::INFINITY;
        }
        let size = dot(&left, &y).abs() / square;
        let error = (dot(&y, &y) / freedom as f64 / square).sqrt();
        (size + NORMAL_95 * error).powi(2) * whole
    }

    /// Whether the better covariate describes the readings better by far than all rivals together do, each number
    /// that these have paid for by a degree of freedom only.
    fn beats_all(&self, own: &Alone, rivals: &[Covariate]) -> bool {
        let mut model = self.null.clone();
        for &rival in rivals {
            for (_, columns) in self.asking.shapes(self.table, rival) {
                model.take_out_all(&columns);
            }
        }
        let n = self.null.freedom();
        let together = Alone {
            square: square_left(&model, &self.table.y),
            paid_for: n.saturating_sub(model.freedom()),
            columns: Vec::new(),
        };
        per_freedom(&together, n as f64, own) > RULED_OUT
    }

    fn errors(&self, covariate: Covariate) -> Errors {
        let usual = match covariate {
            Covariate::RelativeHumidity => HUMIDITY_ERROR_PERCENT,
            Covariate::Temperature => TEMPERATURE_ERROR_C,
            _ => 0.0,
        };
        let own: Vec<f64> = self
            .table
            .members
            .iter()
            .map(|members| {
                let stated = self.asking.number_error(members, covariate);
                stated.unwrap_or(usual)
            })
            .collect();
        if own.iter().all(|error| *error == 0.0) {
            return Errors::None;
        }
        let Some(x) = self.asking.numbers(self.table, covariate) else {
            return Errors::None;
        };
        let plain = Grouped::new(&vec![1.0; x.len()], &self.table.group, &[]);
        let whole = square_left(&plain, &x) / plain.freedom().max(1) as f64;
        let error = dot(&own, &own) / own.len() as f64;
        if 1.0 - error / whole < LEAST_RELIABILITY {
            Errors::TooLarge
        } else {
            Errors::Known(own)
        }
    }
}

/// Evidence for `own` against a rival where each number that they have paid for costs a degree of freedom of `n` only; none
/// where either leaves nothing free.
fn per_freedom(rival: &Alone, n: f64, own: &Alone) -> f64 {
    let mean = |alone: &Alone| {
        let left = n - alone.paid_for as f64;
        (left > 0.0).then(|| alone.square / left)
    };
    match mean(rival).zip(mean(own)) {
        Some((rival, own)) => n * (rival / own).ln(),
        None => 0.0,
    }
}

/// Errors of a covariate's measurement.
enum Errors {
    /// It is counted, or a name.
    None,
    /// Most of what was measured of it is error: it cannot be ruled out.
    TooLarge,
    /// Standard error of each row.
    Known(Vec<f64>),
}

/// Numbers of a covariate with what laws over it need.
struct Line<'a> {
    x: &'a [f64],
    levels: Vec<f64>,
    span: super::shape::Span,
}

impl<'a> Line<'a> {
    fn new(x: &'a [f64]) -> Line<'a> {
        let span = super::shape::Span::of(x);
        Line {
            x,
            levels: super::dependence::levels(x, span),
            span,
        }
    }

    fn material<'b>(&'b self, ground: &'b Ground, variance: &'b [f64], null: &'b Grouped) -> Material<'b> {
        Material {
            y: &ground.table.y,
            variance,
            sample: &ground.table.sample,
            nuisance: null,
            x: self.x,
            levels: &self.levels,
            span: self.span,
            is_log: ground.is_log,
            readings: null.freedom() as f64,
        }
    }

    /// The law at every row, its numbers shifted.
    fn curve(&self, least: &fitted::Least, shift: f64, is_log: bool) -> Vec<f64> {
        let at = |&x: &f64| fitted::value_at(least.law, least.size, x + shift, self.span, least.bend, is_log);
        self.x.iter().map(at).collect()
    }
}

fn square_left(model: &Grouped, y: &[f64]) -> f64 {
    let left = model.residual(y);
    dot(&left, &left)
}
