//! Every parameter of a material against every covariate: what changes by how much, and what nobody can tell apart.

use super::covariate::Covariate;
use super::dependence::Dependence;
use super::design::rows;
use super::find::CampaignLaws;
use super::fitted::Interval;
use crate::false_discovery::CLAIMED_BELOW;
use ieap_domain::RunRecord;

/// Parameters against covariates.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Material.
    pub material: String,
    /// Sets of covariates, those that are one question together; single ones alone.
    pub sets: Vec<Vec<Covariate>>,
    /// Parameters with a cell for each set.
    pub rows: Vec<MatrixRow>,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixRow {
    /// Stored key.
    pub parameter: String,
    /// Answers in the order of the sets; none where nothing was asked.
    pub cells: Vec<Option<MatrixCell>>,
}

/// One answer.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixCell {
    /// The covariate by which the change is stated.
    pub covariate: Covariate,
    /// Whether the readings tell it apart from all that changed with it.
    pub is_told_apart: bool,
    /// Factor over the range (a difference where `is_factor` is false); none where no law was sought, or where its
    /// interval holds no change.
    pub change: Option<Interval>,
    /// Whether the change is a factor.
    pub is_factor: bool,
    /// Whether it has a direction: a jump between names has none.
    pub is_directed: bool,
    /// Strength from 0 to 3: how far a claimed factor lies from 1: up to 1.2, up to 2.5, and beyond.
    pub strength: u8,
    /// Whether the parameter rises with the covariate.
    pub rises: bool,
    /// Over all questions of the campaign.
    pub q: f64,
    /// Whether it may be claimed.
    pub is_claimed: bool,
}

/// The matrix of every material that anything was asked about.
pub fn matrices(laws: &CampaignLaws) -> Vec<Matrix> {
    let mut matrices: Vec<Matrix> = Vec::new();
    let asked = laws
        .dependences
        .iter()
        .filter(|found| found.covariate != Covariate::Sample);
    for found in asked {
        let place = matrices.iter().position(|one| one.material == found.material);
        let matrix = match place {
            Some(place) => &mut matrices[place],
            None => {
                matrices.push(Matrix {
                    material: found.material.clone(),
                    sets: Vec::new(),
                    rows: Vec::new(),
                });
                let last = matrices.len() - 1;
                &mut matrices[last]
            }
        };
        matrix.add(found);
    }
    matrices
}

impl Matrix {
    fn add(&mut self, found: &Dependence) {
        let mut set: Vec<Covariate> = found.tied_to().collect();
        set.push(found.covariate);
        set.sort();
        let column = match self.sets.iter().position(|known| *known == set) {
            Some(column) => column,
            None => {
                self.sets.push(set);
                self.rows.iter_mut().for_each(|row| row.cells.push(None));
                self.sets.len() - 1
            }
        };
        let place = self.rows.iter().position(|row| row.parameter == found.parameter);
        let place = place.unwrap_or_else(|| {
            self.rows.push(MatrixRow {
                parameter: found.parameter.clone(),
                cells: vec![None; self.sets.len()],
            });
            self.rows.len() - 1
        });
        self.rows[place].cells[column] = Some(cell(found));
    }
}

fn cell(found: &Dependence) -> MatrixCell {
    // A claim whose interval holds no change follows no law that is known here: by how much it changes is not said.
    let is_told = |change: &Interval| {
        change.low_95.is_some_and(|low| low > 0.0) || change.high_95.is_some_and(|high| high < 0.0)
    };
    let change = found.change().filter(is_told);
    let is_claimed = found.q <= CLAIMED_BELOW;
    let size = change.map_or(0.0, |change| change.value.abs());
    let strength = match () {
        () if !is_claimed || change.is_none() => 0,
        // A difference on a plain scale has no factor: it is drawn as a weak one.
        () if !found.is_log || size < 1.2_f64.ln() => 1,
        () if size < 2.5_f64.ln() => 2,
        () => 3,
    };
    MatrixCell {
        covariate: found.covariate,
        is_told_apart: found.confounded_with.is_empty() && !found.told_apart.ruled_out.is_empty(),
        change: if found.is_log {
            change.map(|change| change.map(f64::exp))
        } else {
            change
        },
        is_factor: found.is_log,
        is_directed: found.jump.is_none(),
        strength,
        rises: change.is_none_or(|change| change.value >= 0.0),
        q: found.q,
        is_claimed,
    }
}

/// How far each covariate of a material leaves each other unclear.
#[derive(Debug, Clone, PartialEq)]
pub struct ConfoundingMap {
    /// Material.
    pub material: String,
    /// Covariates that differ within samples, then those that differ between samples.
    pub covariates: Vec<Covariate>,
    /// How many of them differ within samples.
    pub within: usize,
    /// Variance inflation of each pair, the larger of both directions; infinite where nothing is left; none where the
    /// two are compared at different levels, which keeps them apart.
    pub inflation: Vec<Vec<Option<f64>>>,
    /// Sets that are tied, as indices of covariates; two covariates together may tie a third that neither ties alone.
    pub sets: Vec<Vec<usize>>,
}

/// The map of every material in which covariates differ.
pub fn confounding_maps(laws: &CampaignLaws, runs: &[RunRecord]) -> Vec<ConfoundingMap> {
    let of_material = |material: &String| {
        let places: Vec<usize> = (0..laws.facts.len())
            .filter(|&place| {
                let fact = &laws.facts[place];
                let fit = runs[fact.run].fit.as_ref();
                fact.material == *material && fit.is_some_and(|fit| fit.converged)
            })
            .collect();
        let levels = rows(&laws.facts, &places);
        let names: Vec<(usize, Covariate)> = levels
            .iter()
            .enumerate()
            .flat_map(|(level, rows)| rows.columns.keys().map(move |&covariate| (level, covariate)))
            .collect();
        let pair = |&(level, one): &(usize, Covariate), &(other_level, other): &(usize, Covariate)| {
            (level == other_level && one != other).then(|| {
                let rows = &levels[level];
                f64::max(rows.inflation(one, &[other]), rows.inflation(other, &[one]))
            })
        };
        let covariates: Vec<Covariate> = names.iter().map(|(_, covariate)| *covariate).collect();
        let several = levels
            .iter()
            .flat_map(|rows| rows.sets.iter().filter(|set| set.len() > 1));
        let place_of = |one: &Covariate| covariates.iter().position(|known| known == one);
        ConfoundingMap {
            material: material.clone(),
            within: levels[0].columns.len(),
            inflation: names
                .iter()
                .map(|one| names.iter().map(|other| pair(one, other)).collect())
                .collect(),
            sets: several
                .map(|set| set.iter().filter_map(place_of).collect())
                .collect(),
            covariates,
        }
    };
    let maps = laws.asked.keys().map(of_material);
    maps.filter(|map| map.covariates.len() > 1).collect()
}
