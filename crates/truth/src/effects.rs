//! The effects of one run, checked against the catalogue.

use std::collections::BTreeMap;

use super::catalogue::{KNOWN, known};
use super::error::TruthError;

/// An effect hidden in the data.
#[derive(Debug, Clone, PartialEq)]
pub struct HiddenEffect {
    /// Id.
    pub id: String,
    /// Variant, and behind a slash a foreign form, such as `gain/tanh`, or `/tanh` of the first variant; none: the
    /// effect's first variant by its own law.
    pub variant: Option<String>,
    /// Parameters by key; the first of the catalogue is the strength.
    pub parameters: BTreeMap<String, f64>,
}

impl HiddenEffect {
    /// Checks id, variant, form, keys and values.
    ///
    /// # Errors
    /// See [`TruthError`]; each says what is known.
    pub fn check(&self) -> Result<(), TruthError> {
        let id = || self.id.clone();
        let entry = known(&self.id).ok_or_else(|| TruthError::UnknownEffect {
            found: id(),
            known: listed(KNOWN.iter().map(|effect| effect.id)),
        })?;
        if let Some(found) = self.given_variant()
            && !entry.variants.contains(&found)
        {
            return Err(TruthError::UnknownVariant {
                id: id(),
                found: found.to_owned(),
                known: match entry.variants {
                    [] => "none: the effect has no variants".into(),
                    variants => listed(variants.iter().copied()),
                },
            });
        }
        if let Some(found) = self.form()
            && !entry.forms.contains(&found)
        {
            return Err(TruthError::UnknownForm {
                id: id(),
                found: found.to_owned(),
                known: match entry.forms {
                    [] => "none: the effect has one law".into(),
                    forms => listed(forms.iter().copied()),
                },
            });
        }
        let keys = || entry.parameters.iter().map(|parameter| parameter.key);
        if let Some(found) = self
            .parameters
            .keys()
            .find(|key| keys().all(|known| known != *key))
        {
            return Err(TruthError::UnknownParameter {
                id: id(),
                found: found.clone(),
                known: listed(keys()),
            });
        }
        for parameter in entry.parameters {
            let given = self.parameters.get(parameter.key).copied();
            match given.or(parameter.default) {
                None => {
                    return Err(TruthError::MissingParameter {
                        id: id(),
                        key: parameter.key,
                        needed: parameter.bounds.to_string(),
                        example: parameter.example,
                    });
                }
                Some(value) if !parameter.bounds.hold(value) => {
                    return Err(TruthError::BadValue {
                        place: format!("effect {}: {}", self.id, parameter.key),
                        found: value.to_string(),
                        needed: parameter.bounds.to_string(),
                    });
                }
                Some(_) => {}
            }
        }
        Ok(())
    }

    /// The variant, or the effect's first where none is given; none where the effect has no variants.
    pub fn variant_or_first(&self) -> Option<&str> {
        let first = || known(&self.id).and_then(|entry| entry.variants.first().copied());
        self.given_variant().or_else(first)
    }

    /// The foreign form; none: the effect's own law.
    pub fn form(&self) -> Option<&str> {
        self.variant.as_deref()?.split_once('/').map(|(_, form)| form)
    }

    fn given_variant(&self) -> Option<&str> {
        let given = self.variant.as_deref()?;
        match given.split_once('/') {
            Some((own, _)) => (!own.is_empty()).then_some(own),
            None => Some(given),
        }
    }

    /// A parameter, or what stands for it where it is not given.
    pub(super) fn value(&self, key: &str) -> f64 {
        let default = || {
            let entry = known(&self.id)?;
            let parameter = entry.parameters.iter().find(|parameter| parameter.key == key)?;
            parameter.default
        };
        let given = self.parameters.get(key).copied();
        given.or_else(default).unwrap_or(0.0)
    }

    /// Whether the variant is this one.
    pub(super) fn is(&self, variant: &str) -> bool {
        self.variant_or_first() == Some(variant)
    }

    /// The foreign form; empty: the effect's own law.
    pub(super) fn law(&self) -> &'static str {
        let forms = known(&self.id).map_or(&[][..], |entry| entry.forms);
        let own = |form: &&&str| Some(**form) == self.form();
        forms.iter().find(own).copied().unwrap_or("")
    }

    fn strength(&self) -> f64 {
        known(&self.id).map_or(0.0, |entry| self.value(entry.parameters[0].key))
    }
}

fn listed(names: impl Iterator<Item = &'static str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

/// The effects that act in one run: those of another run and those of strength 0 are left out.
#[derive(Debug, Clone)]
pub(super) struct Effects<'a> {
    acting: Vec<&'a HiddenEffect>,
    /// The run's place in its group.
    pub run_index: usize,
}

impl<'a> Effects<'a> {
    pub(super) fn of_run(all: &'a [HiddenEffect], run_index: usize) -> Result<Effects<'a>, TruthError> {
        all.iter().try_for_each(HiddenEffect::check)?;
        let acts = |effect: &&HiddenEffect| {
            let run = effect.parameters.get("run").copied().filter(|run| *run >= 0.0);
            effect.strength() != 0.0 && run.is_none_or(|run| run == run_index as f64)
        };
        let acting: Vec<&HiddenEffect> = all.iter().filter(acts).collect();
        for (index, effect) in acting.iter().enumerate() {
            if acting[..index].iter().any(|earlier| earlier.id == effect.id) {
                return Err(TruthError::Twice {
                    id: effect.id.clone(),
                });
            }
        }
        Ok(Effects { acting, run_index })
    }

    pub(super) fn get(&self, id: &str) -> Option<&'a HiddenEffect> {
        self.acting.iter().copied().find(|effect| effect.id == id)
    }

    /// A parameter of an effect; 0 where the effect is absent.
    pub(super) fn value(&self, id: &str, key: &str) -> f64 {
        self.get(id).map_or(0.0, |effect| effect.value(key))
    }

    /// The foreign form of an effect; empty: its own law, or it is absent.
    pub(super) fn law(&self, id: &str) -> &'static str {
        self.get(id).map_or("", HiddenEffect::law)
    }
}
