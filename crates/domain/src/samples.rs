//! The samples of a campaign, in the file's order, and found by their ids: every run asks for its own, and a search
//! through all of them for each would take as long as the runs times the samples.

use std::collections::HashMap;
use std::fmt;
use std::ops::Deref;

use serde::{Deserialize, Serialize};

use super::Sample;

/// Samples in the file's order; of several with one id the first is found.
#[derive(Clone, Default, PartialEq, Deserialize)]
#[serde(from = "Vec<Sample>")]
pub struct Samples {
    all: Vec<Sample>,
    place_of: HashMap<String, usize>,
}

impl Samples {
    /// The sample of that id.
    pub fn find(&self, id: &str) -> Option<&Sample> {
        self.place_of.get(id).map(|&place| &self.all[place])
    }

    /// Adds one behind the others.
    pub fn push(&mut self, sample: Sample) {
        self.place_of.entry(sample.id.clone()).or_insert(self.all.len());
        self.all.push(sample);
    }
}

// What is made from a campaign is hashed in this form and in that of serde: both are those of a list, always in its order.
impl fmt::Debug for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.all.fmt(f)
    }
}

impl Serialize for Samples {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.all.serialize(serializer)
    }
}

impl Deref for Samples {
    type Target = [Sample];

    fn deref(&self) -> &[Sample] {
        &self.all
    }
}

impl FromIterator<Sample> for Samples {
    fn from_iter<I: IntoIterator<Item = Sample>>(given: I) -> Samples {
        let mut samples = Samples::default();
        given.into_iter().for_each(|sample| samples.push(sample));
        samples
    }
}

impl From<Vec<Sample>> for Samples {
    fn from(given: Vec<Sample>) -> Samples {
        given.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::sample;

    #[test]
    fn samples_are_found_by_their_ids_and_stay_in_order() {
        let again = Sample {
            material: "CPvf".to_owned(),
            ..sample("B", "CNaf")
        };
        let samples: Samples = vec![sample("B", "CNaf"), sample("A", "CNaf"), again].into();
        let ids: Vec<&str> = samples.iter().map(|sample| sample.id.as_str()).collect();
        assert_eq!(ids, ["B", "A", "B"]);
        assert_eq!(samples.find("B").unwrap().material, "CNaf");
        assert!(samples.find("C").is_none());
        assert_eq!(format!("{samples:?}"), format!("{:?}", samples.to_vec()));
        let text = serde_json::to_string(&samples).unwrap();
        assert_eq!(serde_json::from_str::<Samples>(&text).unwrap(), samples);
    }
}
