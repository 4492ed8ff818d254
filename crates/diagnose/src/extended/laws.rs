//! The laws of a fit that was made with them, read back from what is stored of it.

use ieap_domain::Fit;
use ieap_model::ModelChoice;
use ieap_model::effects::{About, Applied, Effect};

/// Word for the form that an effect took, where it has several: without it its parameters are not known.
pub(super) fn form_words(about: &About, variant: usize) -> Option<String> {
    let form = about.variants.get(variant)?;
    Some(format!("; {} as {form}", about.id))
}

/// The laws that a fit has beside its base model, with their parameters; none of a fit of the base alone.
///
/// # Errors
/// In words which law cannot be read back: its model is not known here, its form is not stated, or a parameter of it is not
/// determined.
pub fn laws_of(fit: &Fit) -> Result<Vec<Applied>, String> {
    let choice = ModelChoice::parse(&fit.model).map_err(|error| error.to_string())?;
    choice.effects.iter().map(|effect| law_of(fit, *effect)).collect()
}

fn law_of(fit: &Fit, effect: &'static dyn Effect) -> Result<Applied, String> {
    let about = effect.about();
    let is_of = |variant: &usize| form_words(about, *variant).is_some_and(|words| stated(&fit.method, &words));
    let variant = match about.variants.len() {
        0 => Some(0),
        forms => (0..forms).find(is_of),
    };
    let variant = variant.ok_or_else(|| format!("its fit does not say which form of {} it has", about.id))?;
    let value = |key: &str| {
        let known = fit.parameter(&format!("{}.{key}", about.id));
        let value = known.and_then(|estimate| estimate.value);
        value.ok_or_else(|| format!("its fit does not determine {key} of {}", about.id))
    };
    let parameters = about.parameters.iter().map(|own| value(own.key));
    Ok(Applied {
        effect,
        variant,
        parameters: parameters.collect::<Result<_, _>>()?,
    })
}

/// Whether the words stand in a text to their end: one form's name may begin another's.
fn stated(text: &str, words: &str) -> bool {
    let mut after = text.match_indices(words).map(|(at, _)| &text[at + words.len()..]);
    after.any(|rest| rest.is_empty() || rest.starts_with(';'))
}
