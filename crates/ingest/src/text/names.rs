//! Names of columns in the languages that laboratories write: the one table of synonyms.
//!
//! In small letters, blanks for `_` and `-`. A name that is not here is a column of its own; a profile says what it is
//! (`ieap profile FILE --column NAME=QUANTITY`).

use ieap_domain::Quantity;

/// What PalmSens writes before the name of a negated column.
pub(super) const NEGATED: &str = "neg. ";

/// Names with the quantities that they may stand for, the likeliest first: English, German, French, Spanish, Italian,
/// Portuguese, Estonian, Russian, Japanese, Chinese, with semicolons between them.
const NAMES: [(&[Quantity], &str); 24] = [
    (&[Quantity::Time, Quantity::Temperature], "t"),
    (
        &[Quantity::Time],
        "time;test time;elapsed time;time elapsed;corrected time;total time;run time;epoch time;elapsed;zeit;messzeit;\
         laufzeit;versuchszeit;temps;temps écoulé;tiempo;tiempo transcurrido;tempo;tempo trascorso;tempo decorrido;aeg;\
         время;時間;経過時間;时间;x axis",
    ),
    (
        &[Quantity::Voltage],
        "voltage;v;u;e;potential;we(1).potential;cell voltage;cell potential;working electrode;ewe;ecell;vf;spannung;\
         zellspannung;potenzial;tension;potentiel;voltaje;tensión;potencial;tensione;potenziale;tensão;pinge;\
         напряжение;電圧;電位;电压;电位",
    ),
    (
        &[Quantity::Current, Quantity::CurrentDensity],
        "current;i;im;we(1).current;cell current;strom;stromstärke;stromstaerke;zellstrom;courant;intensité;corriente;\
         intensidad;corrente;vool;voolutugevus;ток;сила тока;電流;电流",
    ),
    (
        &[Quantity::CurrentDensity],
        "current density;j;stromdichte;densité de courant",
    ),
    (
        &[Quantity::Curvature],
        "curvature;bending curvature;kappa;κ;krümmung;kruemmung;courbure;curvatura;kõverus;кривизна;曲率",
    ),
    (
        &[Quantity::TipDisplacement],
        "displacement;tip displacement;deflection;tip deflection;auslenkung;durchbiegung;verschiebung;déplacement;\
         flèche;desplazamiento;spostamento;deslocamento;siire;смещение;перемещение;変位;位移",
    ),
    (
        &[Quantity::BlockingForce],
        "blocking force;force;blocked force;kraft;blockierkraft",
    ),
    (&[Quantity::OpenCircuit], "open circuit"),
    (
        &[Quantity::Temperature],
        "temperature;temp;temp.;ambient temperature;air temperature;temperatur;lufttemperatur;température;temperatura;\
         temperatuur;температура;温度",
    ),
    (
        &[Quantity::RelativeHumidity],
        "relative humidity;rel. humidity;humidity;rh;r.h.;feuchte;luftfeuchte;luftfeuchtigkeit;relative feuchte;\
         relative luftfeuchte;rel. feuchte;rel. luftfeuchte;r.f.;rf;humidité;humidite;humidité relative;hr;humedad;\
         humedad relativa;umidità;umidità relativa;ur;umidade;umidade relativa;niiskus;suhteline niiskus;õhuniiskus;\
         влажность;относительная влажность;湿度;相対湿度;相对湿度",
    ),
    (
        &[Quantity::Pressure],
        "pressure;p;ambient pressure;air pressure;druck;luftdruck;pression;presión;pressione;pressão;rõhk;õhurõhk;\
         давление;気圧;气压",
    ),
    (&[Quantity::Oxygen], "oxygen;o2"),
    (&[Quantity::Water], "water;h2o;moisture"),
    (&[Quantity::StorageModulus], "storage modulus;e';e′;speichermodul"),
    (&[Quantity::LossModulus], "loss modulus;e'';e\";e″;verlustmodul"),
    (&[Quantity::ComplexModulus], "complex modulus;|e*|;e*"),
    (
        &[Quantity::LossFactor],
        "loss factor;tan delta;tan(delta);tan δ;tan(δ);verlustfaktor",
    ),
    (&[Quantity::Frequency], "frequency;frequenz;freq;f"),
    (
        &[Quantity::ImpedanceReal],
        "impedance real;z';z′;re(z);zre;zreal;z real;z re",
    ),
    (
        &[Quantity::ImpedanceImaginary],
        "impedance imaginary;z'';z\";z″;im(z);zim;zimag;z imag;z im;z imaginary",
    ),
    (&[Quantity::ImpedanceMagnitude], "impedance magnitude;|z|;zmod;z"),
    (&[Quantity::ImpedancePhase], "impedance phase;phase(z);zphz;phase"),
    (
        &[Quantity::ControlVoltage],
        "control voltage;control potential;applied voltage;applied potential;potential applied;e applied;set voltage;\
         set potential;voltage setpoint;potential setpoint;setpoint voltage;command voltage;commanded voltage",
    ),
];

/// Every known name of a column.
pub(super) fn known_names() -> impl Iterator<Item = &'static str> {
    NAMES.iter().flat_map(|(_, names)| names.split(';'))
}

/// Names of one quantity.
pub fn names_of(quantity: Quantity) -> impl Iterator<Item = &'static str> {
    let own = NAMES
        .iter()
        .filter(move |(quantities, _)| quantities[0] == quantity);
    own.flat_map(|(_, names)| names.split(';'))
}

/// `102 <current>` without the number of the input, as data loggers of Keysight name their columns.
fn without_channel(name: &str) -> &str {
    let label = name
        .trim()
        .trim_start_matches(|c: char| c.is_ascii_digit())
        .trim_start();
    if label.starts_with('<') && label.ends_with('>') {
        label
    } else {
        name.trim()
    }
}

/// Quantities that a name may stand for, the likeliest first; none for names that are not known.
pub(super) fn candidates(name: &str) -> &'static [Quantity] {
    let plain: String = without_channel(name)
        .trim_start_matches('<')
        .trim_end_matches('>')
        .chars()
        .map(|c| if matches!(c, '_' | '-') { ' ' } else { c })
        .flat_map(char::to_lowercase)
        .collect();
    // Quotes for primes, doubled where the cell was quoted.
    let plain = plain
        .replace("\"\"", "\"")
        .replace('\u{201d}', "\"")
        .replace('\u{2019}', "'")
        .replace('\u{2212}', "");
    let plain = plain.strip_prefix(NEGATED).unwrap_or(&plain);
    let words: Vec<&str> = plain.split_whitespace().collect();
    let name = words.join(" ");
    let known = NAMES
        .iter()
        .find(|(_, names)| names.split(';').any(|known| known == name));
    known.map_or(&[], |(quantities, _)| quantities)
}
