//! From what campaign.toml holds to a campaign that can be: every statement checked once.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path};

use toml::Spanned;

use super::error::CampaignFileError as Error;
use super::lines::Lines;
use super::{raw, tags};
use crate::name_pattern::NamePattern;
use crate::scan::is_own_product;
use crate::table::Answers;
use ieap_domain::campaign::Adopted;
use ieap_domain::campaign::BUILT_IN_ENVIRONMENTS;
use ieap_domain::campaign::impedance_folder;
use ieap_domain::{AskedFit, Campaign, DateOrder, Environment, Issue, Material, RunKind, Sample};

/// The model that runs are fitted with where campaign.toml names none.
pub const DEFAULT_MODEL: &str = "lumped-2";

/// Absolute zero, degrees Celsius.
const ABSOLUTE_ZERO_C: f64 = -273.15;

/// The key that names the folder of runs.
const RUNS: &str = "[runs] folder";
/// The key that names the folder of modulus logs.
const MODULUS: &str = "[dma] folder";

/// Checks one file; `lines` gives the line of each entry.
pub(super) struct Checker<'a> {
    pub path: &'a Path,
    pub lines: &'a Lines<'a>,
}

impl Checker<'_> {
    /// The campaign.
    pub fn campaign(&self, file: raw::File, warnings: &mut Vec<Issue>) -> Result<Campaign, Error> {
        let head = file.campaign.ok_or_else(|| self.missing("[campaign]", "id"))?;
        let id = self.filled(head.id, "[campaign]", "id")?;
        let samples = self.samples(file.sample, warnings)?;
        let (name_pattern, dma_name_pattern) = (file.runs.name_pattern, file.dma.name_pattern);
        let impedance_name_pattern = file.impedance.name_pattern;
        for pattern in name_pattern
            .iter()
            .chain(&dma_name_pattern)
            .chain(&impedance_name_pattern)
        {
            NamePattern::compile(pattern).map_err(|source| Error::BadNamePattern {
                path: self.path.into(),
                source,
            })?;
        }
        let fit = AskedFit {
            model: head.model.clone(),
            method: file.fit.method,
            simultaneous: file.fit.simultaneous,
            seed: None,
            known: self.known(file.fit.known, &samples)?,
        };
        let campaign = Campaign {
            title: head.title.unwrap_or_else(|| id.clone()),
            id,
            timezone: self.timezone(head.timezone)?,
            date_order: self.date_order(head.date_order)?,
            answers: self.answers(file.answers)?,
            notice: head.notice,
            samples: samples.into(),
            materials: self.materials(file.material)?,
            environments: self.environments(file.environment)?,
            runs_folder: self.folder(RUNS, file.runs.folder, "runs")?,
            name_pattern,
            dma_folder: self.dma_folder(file.dma.folder)?,
            dma_name_pattern,
            impedance_folder: self.folder(
                "[impedance] folder",
                file.impedance.folder,
                &impedance_folder(),
            )?,
            impedance_name_pattern,
            impedance_circuits: file.impedance.circuits,
            templates_folder: (file.report.templates)
                .map(|folder| self.folder("[report] templates", Some(folder), ""))
                .transpose()?,
            fit,
            model: head.model.unwrap_or_else(|| DEFAULT_MODEL.to_owned()),
            group_by: self.group_by(head.group_by)?,
            tolerance_percent: self.tolerance(head.tolerance_percent)?,
            adopted: self.adopted(file.adopted)?,
            sensors: self.sensors(file.sensor)?,
            climate: self.climate(file.climate)?,
            monitoring: self.monitoring(file.monitoring)?,
            compare: self.compare(file.compare)?,
            study: self.study(file.study)?,
            extra_tags: self.extra_tags(file.tags.extra)?,
            pairs: self.pairs(file.runs.pair_by, file.pair)?,
        };
        warnings.extend(tags::undeclared_keys(&campaign));
        // A run below the folder of modulus logs would be taken for one.
        if campaign.kind_of(&format!("{}/", campaign.runs_folder)) == RunKind::Dma {
            return Err(Error::FolderOutside {
                path: self.path.into(),
                key: RUNS,
                found: campaign.runs_folder,
                reason: "it lies in the folder of modulus logs",
            });
        }
        Ok(campaign)
    }

    /// Group and model of each; whether they exist is known when runs are fitted.
    fn adopted(&self, entries: Vec<Spanned<raw::Adopted>>) -> Result<Vec<Adopted>, Error> {
        let of = |entry: Spanned<raw::Adopted>| {
            let (line, _) = self.lines.place(entry.span().start);
            let place = format!("line {line}, [[adopted]]");
            let entry = entry.into_inner();
            Ok(Adopted {
                group: self.filled(entry.group, &place, "group")?,
                model: self.filled(entry.model, &place, "model")?,
            })
        };
        entries.into_iter().map(of).collect()
    }

    /// Tag keys without blanks, each once.
    fn tolerance(&self, value: Option<f64>) -> Result<Option<f64>, Error> {
        let needed = "a number of percent, 0 or more";
        self.holds(value, "[campaign]", "tolerance_percent", needed, |v| {
            v.is_finite() && v >= 0.0
        })?;
        Ok(value)
    }

    fn group_by(&self, keys: Vec<String>) -> Result<Vec<String>, Error> {
        for (place, key) in keys.iter().enumerate() {
            let reason = match () {
                () if key.trim() != key || key.is_empty() => {
                    "a tag key is no empty text and has no blanks around it"
                }
                () if keys[..place].contains(key) => "it stands there twice",
                () => continue,
            };
            return Err(Error::BadGroupBy {
                path: self.path.into(),
                found: key.clone(),
                reason,
            });
        }
        Ok(keys)
    }

    fn samples(
        &self,
        entries: Vec<Spanned<Sample>>,
        warnings: &mut Vec<Issue>,
    ) -> Result<Vec<Sample>, Error> {
        if entries.is_empty() {
            let issue = Issue::warning(
                "no-samples",
                "campaign.toml names no [[sample]]: no run can be fitted",
            );
            warnings.push(issue.mend("add a [[sample]] with id, material, length_mm and width_mm"));
        }
        let mut ids = BTreeSet::new();
        let mut samples = Vec::with_capacity(entries.len());
        for entry in entries {
            let place = self.entry_place(&entry, "sample", &entry.get_ref().id, &mut ids)?;
            let sample = entry.into_inner();
            self.sample(&sample, &place)?;
            if sample.active_area_cm2().is_none() {
                let issue = Issue::warning(
                    "sample-without-area",
                    format!("sample \"{}\" has no area", sample.id),
                );
                warnings.push(issue.at(place).mend("add length_mm and width_mm, or area_cm2"));
            }
            samples.push(sample);
        }
        Ok(samples)
    }

    fn sample(&self, stated: &Sample, place: &str) -> Result<(), Error> {
        self.filled(Some(stated.material.clone()), place, "material")?;
        for (value, key) in [
            (stated.length_mm, "length_mm"),
            (stated.width_mm, "width_mm"),
            (stated.thickness_mm, "thickness_mm"),
            (stated.area_cm2, "area_cm2"),
            (
                stated.electrode_resistance_ohm_per_sq,
                "electrode_resistance_ohm_per_sq",
            ),
        ] {
            self.above_zero(value, place, key)?;
        }
        Ok(())
    }

    fn materials(&self, entries: Vec<Spanned<Material>>) -> Result<Vec<Material>, Error> {
        let mut ids = BTreeSet::new();
        let material = |entry: Spanned<Material>| {
            let place = self.entry_place(&entry, "material", &entry.get_ref().id, &mut ids)?;
            let stated = entry.into_inner();
            self.above_zero(stated.electrode_thickness_um, &place, "electrode_thickness_um")?;
            self.above_zero(stated.membrane_thickness_um, &place, "membrane_thickness_um")?;
            Ok(stated)
        };
        entries.into_iter().map(material).collect()
    }

    /// The built-in environments, with what the file says of them, then the file's own.
    fn environments(&self, entries: Vec<Spanned<Environment>>) -> Result<Vec<Environment>, Error> {
        let built_in = |id: &str| Environment {
            id: id.to_owned(),
            ..Environment::default()
        };
        let mut environments: Vec<Environment> = BUILT_IN_ENVIRONMENTS.into_iter().map(built_in).collect();
        let mut ids = BTreeSet::new();
        for entry in entries {
            let place = self.entry_place(&entry, "environment", &entry.get_ref().id, &mut ids)?;
            let stated = entry.into_inner();
            self.environment(&stated, &place)?;
            // The file states each once.
            let mut built_in = environments.iter_mut().take(BUILT_IN_ENVIRONMENTS.len());
            match built_in.find(|known| known.id == stated.id) {
                Some(known) => *known = stated,
                None => environments.push(stated),
            }
        }
        Ok(environments)
    }

    fn environment(&self, stated: &Environment, place: &str) -> Result<(), Error> {
        let humidity = stated.relative_humidity_percent;
        let (percent, kelvin) = ("a number from 0 to 100", "a number above -273.15");
        let in_percent = |value: f64| (0.0..=100.0).contains(&value);
        let above_zero_kelvin = |value: f64| value.is_finite() && value > ABSOLUTE_ZERO_C;
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        self.holds(humidity, place, "relative_humidity_percent", percent, in_percent)?;
        let temperature_c = stated.temperature_c;
        self.holds(temperature_c, place, "temperature_c", kelvin, above_zero_kelvin)?;
        let needed = "a number not below 0";
        self.holds(stated.pressure_pa, place, "pressure_pa", needed, not_negative)
    }

    fn timezone(&self, name: Option<String>) -> Result<Option<String>, Error> {
        match name {
            Some(found) if jiff::tz::TimeZone::get(&found).is_err() => Err(Error::UnknownTimezone {
                path: self.path.into(),
                found,
            }),
            name => Ok(name),
        }
    }

    fn date_order(&self, word: Option<String>) -> Result<Option<DateOrder>, Error> {
        let Some(found) = word else {
            return Ok(None);
        };
        match DateOrder::from_key(&found) {
            None => Err(Error::BadDateOrder {
                path: self.path.into(),
                found,
            }),
            order => Ok(order),
        }
    }

    fn answers(&self, stated: BTreeMap<String, String>) -> Result<BTreeMap<String, String>, Error> {
        let mut answers = Answers::default();
        for (key, answer) in &stated {
            answers.add(key, answer).map_err(|reason| Error::BadAnswer {
                path: self.path.into(),
                reason,
            })?;
        }
        Ok(stated)
    }

    /// The folder of modulus logs, which cannot be the whole campaign: it tells them from runs.
    fn dma_folder(&self, folder: Option<String>) -> Result<String, Error> {
        let folder = self.folder(MODULUS, folder, "dma")?;
        match folder.as_str() {
            "." => Err(Error::FolderOutside {
                path: self.path.into(),
                key: MODULUS,
                found: folder,
                reason: "modulus logs need a folder of their own",
            }),
            _ => Ok(folder),
        }
    }

    /// A folder in its plain form, `data/runs`, without `./` and `/` at the end; `usual` where none is stated.
    fn folder(&self, key: &'static str, folder: Option<String>, usual: &str) -> Result<String, Error> {
        let Some(found) = folder else {
            return Ok(usual.to_owned());
        };
        let refuse = |reason| {
            Err(Error::FolderOutside {
                path: self.path.into(),
                key,
                found: found.clone(),
                reason,
            })
        };
        let mut parts = Vec::new();
        // A backslash is a separator for those who write the file on Windows, and in no sane folder's name.
        for component in Path::new(&found.replace('\\', "/")).components() {
            match component {
                Component::Normal(part) => parts.push(part.to_string_lossy().into_owned()),
                Component::CurDir => {}
                Component::ParentDir => return refuse("it leads out of the campaign"),
                Component::RootDir | Component::Prefix(_) => {
                    return refuse("it is not relative to the campaign");
                }
            }
        }
        if found.trim().is_empty() || found.as_bytes().get(1) == Some(&b':') {
            return refuse("it is not relative to the campaign");
        }
        if is_own_product(&parts.iter().collect::<std::path::PathBuf>()) {
            return refuse("that name is used for what the program writes itself");
        }
        Ok(if parts.is_empty() {
            ".".to_owned()
        } else {
            parts.join("/")
        })
    }

    /// Id of an entry that no entry above has, and the entry's place in words.
    pub(super) fn entry_place<T>(
        &self,
        entry: &Spanned<T>,
        table: &str,
        id: &str,
        taken: &mut BTreeSet<String>,
    ) -> Result<String, Error> {
        let (line, _) = self.lines.place(entry.span().start);
        let place = format!("line {line}, [[{table}]]");
        let id = self.filled(Some(id.to_owned()), &place, "id")?;
        if !taken.insert(id.clone()) {
            return Err(Error::DuplicateId {
                path: self.path.into(),
                place,
                id,
            });
        }
        Ok(format!("{place} \"{id}\""))
    }

    pub(super) fn filled(
        &self,
        value: Option<String>,
        place: &str,
        key: &'static str,
    ) -> Result<String, Error> {
        value
            .filter(|text| !text.trim().is_empty())
            .ok_or_else(|| self.missing(place, key))
    }

    fn missing(&self, place: &str, key: &'static str) -> Error {
        Error::MissingKey {
            path: self.path.into(),
            place: place.to_owned(),
            key,
        }
    }

    pub(super) fn above_zero(
        &self,
        value: Option<f64>,
        place: &str,
        key: &'static str,
    ) -> Result<Option<f64>, Error> {
        let is_length = |value: f64| value.is_finite() && value > 0.0;
        self.holds(value, place, key, "a number above 0", is_length)?;
        Ok(value)
    }

    pub(super) fn holds(
        &self,
        value: Option<f64>,
        place: &str,
        key: &'static str,
        needed: &'static str,
        rule: impl Fn(f64) -> bool,
    ) -> Result<(), Error> {
        match value {
            Some(found) if !rule(found) => Err(Error::NumberOutOfRange {
                path: self.path.into(),
                place: place.to_owned(),
                key,
                found,
                needed,
            }),
            _ => Ok(()),
        }
    }
}

/// Refuses a runs folder that is a link to somewhere outside of the campaign. One that is not there yet is
/// no error here: the scan says so.
pub(super) fn runs_folder_stays_inside(campaign: &Path, runs_folder: &str, path: &Path) -> Result<(), Error> {
    let inside = match (campaign.canonicalize(), campaign.join(runs_folder).canonicalize()) {
        (Ok(campaign), Ok(runs)) => runs.starts_with(campaign),
        _ => true,
    };
    if inside {
        return Ok(());
    }
    Err(Error::FolderOutside {
        path: path.into(),
        key: RUNS,
        found: runs_folder.to_owned(),
        reason: "it is a link that leads out of the campaign",
    })
}
