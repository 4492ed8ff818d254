//! Words for what surrounds a strip, in the languages that laboratories write.

/// Words with the built-in environment that they stand for, in small letters. A gas keeps its name: `argon` is an
/// environment of that name that holds no water, as `inert` is.
const WORDS: [(&str, &str); 3] = [
    (
        "air",
        "air;ambient;luft;raumluft;laborluft;aire;aria;õhk;ohk;воздух;\
         空気;空气;ambiant",
    ),
    (
        "vacuum",
        "vacuum;vac;vakuum;vide;sousvide;vacío;vacio;vuoto;vácuo;vacuo;vaakum;вакуум;\
         真空",
    ),
    ("inert", "inert;inerte;inertgas;inertne;glovebox;schutzgas"),
];
/// Gases that hold no water and take no part.
const GASES: &str = "argon;ar;argón;argoon;nitrogen;n2;stickstoff;azote;nitrógeno;nitrogeno;azoto;\
                     lämmastik;lammastik;аргон;азот;helium;heelium;\
                     hélium;xenon;krypton";

/// The built-in environment whose kind a name is: `vide` of `vacuum`, `argon` of `inert`; none of a name that says nothing.
pub fn kind_of(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let is_among = |words: &str| words.split(';').any(|word| word == lower);
    let built_in = WORDS.iter().find(|(_, words)| is_among(words));
    built_in
        .map(|(id, _)| *id)
        .or_else(|| is_among(GASES).then_some("inert"))
}

/// The id of the environment that a word stands for, where campaign.toml names none of that id: that of its kind, and of a
/// gas its own name in small letters.
pub fn id_of_word(word: &str) -> Option<String> {
    let lower = word.to_lowercase();
    if GASES.split(';').any(|gas| gas == lower) {
        return Some(lower);
    }
    kind_of(&lower).map(str::to_owned)
}

/// Every word that stands for an environment.
pub fn words() -> impl Iterator<Item = &'static str> {
    let built_in = WORDS.iter().flat_map(|(_, words)| words.split(';'));
    built_in.chain(GASES.split(';'))
}

/// Whether an environment holds no water unless somebody says so.
pub fn is_waterless(id: &str) -> bool {
    matches!(kind_of(id), Some("vacuum" | "inert"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lead_to_environments_and_a_gas_keeps_its_name() {
        for (word, id) in [
            ("Vide", Some("vacuum")),
            ("Vakuum", Some("vacuum")),
            ("vaakum", Some("vacuum")),
            ("Luft", Some("air")),
            ("Õhk", Some("air")),
            ("Argon", Some("argon")),
            ("Argoon", Some("argoon")),
            ("glovebox", Some("inert")),
            ("fog", None),
        ] {
            assert_eq!(id_of_word(word).as_deref(), id, "{word}");
        }
        assert!(
            is_waterless("argon") && is_waterless("vide") && !is_waterless("air") && !is_waterless("fog")
        );
    }
}
