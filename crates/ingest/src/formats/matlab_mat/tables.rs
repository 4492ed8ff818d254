//! Which variables are the columns of one table: vectors of one length in the same struct, or a matrix beside its names.

use std::collections::BTreeMap;

use super::variables::{Content, Variable};
use crate::formats::error::quoted;
use crate::text::header::Header;
use ieap_domain::Issue;

/// Columns that belong together.
pub struct Columns<'a> {
    /// Where they stand in the file: a struct or a matrix; empty for variables of their own.
    pub name: String,
    /// What each means.
    pub headers: Vec<Header>,
    /// The numbers of each.
    pub numbers: Vec<&'a [f64]>,
}

/// Every table among the variables, in their order; what is in none becomes an issue.
pub fn tables<'a>(variables: &'a [Variable], issues: &mut Vec<Issue>) -> Vec<Columns<'a>> {
    let mut tables = Vec::new();
    let mut owners: Vec<&str> = Vec::new();
    for variable in variables {
        if !owners.contains(&variable.owner.as_str()) {
            owners.push(&variable.owner);
        }
    }
    for owner in owners {
        let own: Vec<&Variable> = variables
            .iter()
            .filter(|variable| variable.owner == owner)
            .collect();
        tables.extend(of_vectors(owner, &own, issues));
        tables.extend(
            own.iter()
                .filter_map(|variable| of_matrix(variable, &own, issues)),
        );
    }
    for variable in variables {
        if let Content::NotRead(what) = &variable.content {
            issues.push(left_out(variable, what));
        }
    }
    tables
}

/// The vectors of most of one length; of two lengths with as many the longer.
fn of_vectors<'a>(owner: &str, own: &[&'a Variable], issues: &mut Vec<Issue>) -> Option<Columns<'a>> {
    let vectors = own
        .iter()
        .filter_map(|variable| Some((*variable, variable.vector()?)));
    let mut of_length: BTreeMap<usize, Vec<(&Variable, &[f64])>> = BTreeMap::new();
    for (variable, numbers) in vectors {
        of_length
            .entry(numbers.len())
            .or_default()
            .push((variable, numbers));
    }
    let (&length, _) = of_length
        .iter()
        .max_by_key(|(length, found)| (found.len(), **length))?;
    let found = of_length.remove(&length)?;
    for (variable, numbers) in of_length.into_values().flatten() {
        let what = format!("{} numbers where the others have {length}", numbers.len());
        issues.push(left_out(variable, &what));
    }
    Some(Columns {
        name: owner.to_owned(),
        headers: found.iter().map(|(variable, _)| header(&variable.name)).collect(),
        numbers: found.into_iter().map(|(_, numbers)| numbers).collect(),
    })
}

/// A matrix whose columns are named by the only list of as many texts beside it.
fn of_matrix<'a>(matrix: &'a Variable, own: &[&'a Variable], issues: &mut Vec<Issue>) -> Option<Columns<'a>> {
    let numbers = matrix.matrix()?;
    let lists = own.iter().filter_map(|variable| match &variable.content {
        Content::Texts(texts) if texts.len() == numbers.len() => Some(texts),
        _ => None,
    });
    let lists: Vec<&Vec<String>> = lists.collect();
    let [names] = lists.as_slice() else {
        let what = format!(
            "a table of {} and {} that could name its columns; save each column as a variable of its own, or one cell \
             array of names beside it",
            matrix.shape(),
            match lists.len() {
                0 => "no list of texts".to_owned(),
                several => format!("{several} lists of texts"),
            },
        );
        issues.push(left_out(matrix, &what));
        return None;
    };
    Some(Columns {
        name: matrix.path(),
        headers: names.iter().map(|name| header(name)).collect(),
        numbers,
    })
}

fn left_out(variable: &Variable, what: &str) -> Issue {
    let message = format!(
        "variable {} holds {what}; it is left out",
        quoted(&variable.path())
    );
    Issue::note("variable-left-out", message)
}

/// What a name means. MATLAB makes `Time_s_` of `Time (s)` and `curvature_1_cm_` of `curvature (1/cm)` where it reads a
/// table: these are read as what they were made from.
fn header(name: &str) -> Header {
    let plain = Header::parse(name);
    let trimmed = name.trim_end_matches('_');
    let made_from = [trimmed.to_owned(), trimmed.replace("_1_", "_per_")];
    let mut known = made_from.iter().map(|name| Header::parse(name));
    match plain.meaning.quantity() {
        Some(_) => plain,
        None => known
            .find(|header| header.meaning.quantity().is_some())
            .map_or(plain, |header| Header {
                raw_name: name.to_owned(),
                ..header
            }),
    }
}
