//! Words for what surrounds a strip, in the languages that laboratories write.

/// Words with the built-in environment that they stand for, in small letters. A gas keeps its name: `argon` is an
/// environment of that name that holds no water, as `inert` is.
const WORDS: [(&str, &str); 3] = [
    (
        "air",
        "air;ambient;luft;raumluft;laborluft;aire;aria;õhk;ohk;воздух;\
         空気;空气;空氣;大気;大气;powietrze;vzduch;levegő;공기;대기;ambiant",
    ),
    (
        "vacuum",
        "vacuum;vac;vakuum;vide;sousvide;vacío;vacio;vuoto;vácuo;vacuo;vaakum;вакуум;\
         próżnia;vákuum;真空;진공",
    ),
    (
        "inert",
        "inert;inerte;inertgas;inertne;glovebox;schutzgas;グローブボックス;不活性;手套箱;글로브박스",
    ),
];
/// Gases that hold no water and take no part.
const GASES: &str = "argon;ar;argón;argoon;nitrogen;n2;stickstoff;azote;nitrógeno;nitrogeno;azoto;\
                     lämmastik;lammastik;аргон;азот;helium;heelium;\
                     hélium;xenon;krypton;窒素;氮气;氮氣;アルゴン;氩气;氬氣;ヘリウム;氦气;질소;아르곤;dusík;dusik;azot;nitrogén";

/// The word of `words` that a name in small letters is, or that stands in it where words are written without blanks between
/// them: `窒素雰囲気`.
fn word_in<'w>(words: &'w str, lower: &str) -> Option<&'w str> {
    let is_part = |word: &str| word.chars().all(|c| c > '\u{2e80}') && lower.contains(word);
    words.split(';').find(|word| *word == lower || is_part(word))
}

/// The built-in environment whose kind a name is: `vide` of `vacuum`, `argon` of `inert`; none of a name that says nothing.
pub fn kind_of(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let is_among = |words: &str| word_in(words, &lower).is_some();
    let built_in = WORDS.iter().find(|(_, words)| is_among(words));
    built_in
        .map(|(id, _)| *id)
        .or_else(|| is_among(GASES).then_some("inert"))
}

/// The id of the environment that a word stands for, where campaign.toml names none of that id: that of its kind, and of a
/// gas its own name in small letters.
pub fn id_of_word(word: &str) -> Option<String> {
    let lower = word.to_lowercase();
    if let Some(gas) = word_in(GASES, &lower) {
        return Some(gas.to_owned());
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

/// Surroundings as they read in a sentence, `inert gas at 28–38 % RH`; a label that is no word for any, in quotes.
pub fn in_words(said: &str) -> String {
    let end = said.find(" at ").unwrap_or(said.len());
    let (name, rest) = said.split_at(end);
    match (name, kind_of(name)) {
        ("inert", _) => format!("inert gas{rest}"),
        ("dry", _) | (_, Some(_)) => said.to_owned(),
        (name, None) => format!("“{name}”{rest}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surroundings_read_well_in_a_sentence() {
        let of = [
            "inert",
            "inert at 2–4 % RH",
            "vacuum",
            "dry",
            "argon",
            "wet_air at 80 % RH",
        ];
        let said = [
            "inert gas",
            "inert gas at 2–4 % RH",
            "vacuum",
            "dry",
            "argon",
            "“wet_air” at 80 % RH",
        ];
        assert_eq!(of.map(in_words), said);
    }

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
            ("窒素雰囲気", Some("窒素")),
            ("空気中", Some("air")),
            ("fog", None),
        ] {
            assert_eq!(id_of_word(word).as_deref(), id, "{word}");
        }
        assert!(
            is_waterless("argon") && is_waterless("vide") && !is_waterless("air") && !is_waterless("fog")
        );
    }
}
