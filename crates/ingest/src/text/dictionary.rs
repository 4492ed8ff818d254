//! The one dictionary: names of quantities, times, roles of columns and columns of run sheets in the languages that
//! laboratories write. Units stand in `ieap_domain::unit`, environments in `ieap_domain::surroundings`.
//!
//! In small letters, blanks for `_` and `-`, half-width letters for full-width ones; semicolons between the words. How a name is
//! held against them is said in [`super::names`].

use ieap_domain::Quantity;
use ieap_domain::tag::keys;

/// Names with the quantities that they may stand for, the likeliest first: English, German, French, Spanish, Italian,
/// Portuguese, Polish, Estonian, Russian, Japanese, Chinese, Korean.
pub(super) const QUANTITIES: [(&[Quantity], &str); 24] = [
    (&[Quantity::Time, Quantity::Temperature], "t"),
    (
        &[Quantity::Time],
        "time;test time;elapsed time;time elapsed;corrected time;total time;run time;epoch time;elapsed;zeit;messzeit;\
         laufzeit;versuchszeit;temps;temps écoulé;tiempo;tiempo transcurrido;tempo;tempo trascorso;tempo decorrido;czas;aeg;\
         время;時間;経過時間;時刻;时间;時间;测试时间;시간;x axis",
    ),
    (
        &[Quantity::Voltage],
        "voltage;volt;v;u;e;potential;we(1).potential;cell voltage;cell potential;working electrode;ewe;ecell;vf;spannung;\
         zellspannung;potenzial;tension;potentiel;voltaje;tensión;potencial;tensione;potenziale;tensão;napięcie;pinge;\
         напряжение;電圧;電位;電壓;电压;电位;전압",
    ),
    (
        &[Quantity::Current, Quantity::CurrentDensity],
        "current;curr;i;im;we(1).current;cell current;strom;stromstärke;stromstaerke;zellstrom;courant;intensité;corriente;\
         intensidad;corrente;prąd;natężenie prądu;vool;voolutugevus;ток;сила тока;電流;电流;전류",
    ),
    (
        &[Quantity::CurrentDensity],
        "current density;j;stromdichte;densité de courant;電流密度;电流密度",
    ),
    (
        &[Quantity::Curvature],
        "curvature;bending curvature;kappa;κ;krümmung;kruemmung;courbure;curvatura;krzywizna;kõverus;кривизна;曲率;곡률",
    ),
    (
        &[Quantity::TipDisplacement],
        "displacement;tip displacement;deflection;tip deflection;auslenkung;durchbiegung;verschiebung;déplacement;\
         flèche;desplazamiento;spostamento;deslocamento;przemieszczenie;ugięcie;siire;nihe;смещение;перемещение;変位;たわみ;位移;변위",
    ),
    (
        &[Quantity::BlockingForce],
        "blocking force;force;blocked force;kraft;blockierkraft;force de blocage",
    ),
    (&[Quantity::OpenCircuit], "open circuit"),
    (
        &[Quantity::Temperature],
        "temperature;temp;temp.;ambient temperature;air temperature;temperatur;lufttemperatur;température;temperatura;\
         temperatuur;температура;温度;溫度;気温;온도",
    ),
    (
        &[Quantity::RelativeHumidity],
        "relative humidity;rel. humidity;humidity;humi;humi.;rh;r.h.;feuchte;luftfeuchte;luftfeuchtigkeit;relative feuchte;\
         relative luftfeuchte;rel. feuchte;rel. luftfeuchte;r.f.;rf;humidité;humidite;humidité relative;hr;humedad;\
         humedad relativa;umidità;umidità relativa;ur;umidade;umidade relativa;wilgotność;wilgotność względna;niiskus;\
         suhteline niiskus;õhuniiskus;влажность;относительная влажность;湿度;相対湿度;相对湿度;濕度;습도",
    ),
    (
        &[Quantity::Pressure],
        "pressure;p;ambient pressure;air pressure;druck;luftdruck;pression;presión;pressione;pressão;ciśnienie;rõhk;õhurõhk;\
         давление;気圧;气压;圧力;压力;압력",
    ),
    (&[Quantity::Oxygen], "oxygen;o2"),
    (&[Quantity::Water], "water;h2o;moisture"),
    (
        &[Quantity::StorageModulus],
        "storage modulus;modulus';e';e′;speichermodul;module de conservation;módulo de almacenamiento;modulo conservativo;\
         módulo de armazenamento;moduł zachowawczy;salvestusmoodul;модуль накопления;貯蔵弾性率;储能模量;儲能模量;저장탄성률",
    ),
    (
        &[Quantity::LossModulus],
        "loss modulus;modulus\";modulus'';e'';e\";e″;verlustmodul;module de perte;módulo de pérdida;modulo dissipativo;\
         módulo de perda;moduł stratności;kaomoodul;модуль потерь;損失弾性率;损耗模量;損耗模量;손실탄성률",
    ),
    (
        &[Quantity::ComplexModulus],
        "complex modulus;|e*|;e*;複素弾性率;复数模量",
    ),
    (
        &[Quantity::LossFactor],
        "loss factor;tan delta;tan(delta);tan δ;tan(δ);tanδ;tandelta;verlustfaktor;facteur de perte;損失正接;损耗因子",
    ),
    (
        &[Quantity::Frequency],
        "frequency;frequenz;freq;f;fréquence;frecuencia;frequenza;frequência;częstotliwość;sagedus;частота;周波数;频率;頻率;주파수",
    ),
    (
        &[Quantity::ImpedanceReal],
        "impedance real;z';z′;re(z);zre;zreal;z real;z re;rs",
    ),
    (
        &[Quantity::ImpedanceImaginary],
        "impedance imaginary;z'';z\";z″;im(z);zim;zimag;z imag;z im;z imaginary;xs",
    ),
    (&[Quantity::ImpedanceMagnitude], "impedance magnitude;|z|;zmod;z"),
    (&[Quantity::ImpedancePhase], "impedance phase;phase(z);zphz;phase"),
    (
        &[Quantity::ControlVoltage],
        "control voltage;control potential;applied voltage;applied potential;potential applied;e applied;set voltage;\
         set potential;voltage setpoint;potential setpoint;setpoint voltage;command voltage;commanded voltage",
    ),
];

/// Words that columns of times have in their names.
pub(super) const TIMES: &str = "time;zeit;date;datum;timestamp;epoch;unix;uts;elapsed;clock;aeg;kell;kellaaeg;kuupäev;temps;heure;\
    horodatage;tiempo;fecha;hora;tempo;data/ora;ora;godzina;czas;duration;dauer;durée;время;дата;时间;日期;時間;日時;時刻;日付;\
    시간;날짜";
/// Parts of words by which a time counts from the start of something and not from midnight.
pub(super) const ELAPSED: &str = "elapsed;test;run;step;total;duration;lauf;mess;dauer;écoul;durée;transcurrid;trascors;decorrid;\
    relativ;since;経過;kulunud";

/// Parts of words that say of a date above a table that it is no start: of an end, an export, a calibration, a version.
pub(crate) const NO_STARTS: &str = "export;saved;print;calib;kalib;étalon;version;firmware;build;modif;expir;due;valid;report;install;end;finish;\
    stop;ende;fin ;fin:;koniec;lõpp;kalibr;exportiert;gespeichert;gedruckt;校准;校正;导出;保存;结束;終了;出力;更新;교정;저장;종료;내보내;конец;\
    оконч;экспорт;калибр;сохран";
/// Words that speak of time zones.
pub(crate) const ZONES: &str = "timezone;zone;tz;utc;gmt;dst;daylight;summertime;sommerzeit;zeitzone;fuseau;huso;fuso;strefa;časové;ajavöönd;\
    часовой пояс;时区;時區;タイムゾーン;시간대";
/// Letters of clocks that are those of one zone alone, with their minutes from UTC.
pub(crate) const ZONE_LETTERS: [(&str, i64); 20] = [
    ("CET", 60),
    ("CEST", 120),
    ("MEZ", 60),
    ("MESZ", 120),
    ("WET", 0),
    ("WEST", 60),
    ("EET", 120),
    ("EEST", 180),
    ("MSK", 180),
    ("JST", 540),
    ("KST", 540),
    ("HKT", 480),
    ("SGT", 480),
    ("AEST", 600),
    ("EST", -300),
    ("EDT", -240),
    ("MST", -420),
    ("MDT", -360),
    ("PST", -480),
    ("PDT", -420),
];

/// What a column is of a quantity that its name speaks of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// It was measured.
    Measured,
    /// Somebody asked for it: a set-point.
    Commanded,
    /// A bound that readings are held against.
    Limit,
    /// Calculated from others, or another thing than the name's quantity of the air or the sample.
    Derived,
}

/// Words of names that say which role a column has; without any it is measured.
pub(super) const ROLES: [(Role, &str); 4] = [
    (
        Role::Commanded,
        "set;setpoint;sp;target;nominal;desired;programmed;program;command;commanded;demand;setting;soll;sollwert;vorgabe;\
         consigne;consigna;objetivo;impostata;zadana;zadane;seadeväärtus;уставка;заданная;設定;目標;指令;设定;設置;目标;설정",
    ),
    (
        Role::Limit,
        "alarm;limit;min;max;minimum;maximum;low;high;lo;hi;threshold;upper;lower;range;grenzwert;grenze;limite;предел;\
         警報;上限;下限;最大;最小;报警;限值",
    ),
    (
        Role::Derived,
        "dew;dewpt;dewpoint;td;taupunkt;frost;rosée;rocío;rugiada;orvalho;kastepunkt;росы;露点;露點;soil;panel;ptemp;wetbulb;\
         wet;batt;battery;surface;deficit;mixing;absolute;vapo;vapor;vapour;board;cpu;std;sd;sdev;tmn;tmx;wvc;tot;rate;error",
    ),
    (
        Role::Measured,
        "measured;actual;real;value;read;reading;pv;ist;istwert;gemessen;mesuré;mesurée;medido;medida;misurata;mõõdetud;\
         измеренная;実測;測定;实测;測量;현재",
    ),
];
/// Those of them that say it as parts of words, too: `Taupunkttemperatur`, `setpoint_c`.
pub(super) const ROLE_PARTS: &str = "dew;taupunkt;frost;setpoint;sollwert;soil;panel;ptemp;wetbulb;batt;surface;deficit;mixing;absolute;vapo;board;alarm";

/// Short forms of humidity and temperature in names of sensors' columns.
pub(crate) const HUMIDITY: &str = "hum;relhumidity;relh";
/// As [`HUMIDITY`].
pub(crate) const TEMPERATURE: &str = "ta;tair;airt;airtc;airtemp;t;celsius";
/// Words for what is measured in a chamber; a unit must stand beside them.
pub(crate) const CHAMBER: [(&str, Quantity); 3] = [
    ("o2;oxygen;sauerstoff;hapnik;酸素;氧气", Quantity::Oxygen),
    ("h2o;water;moisture;wasser;vesi;水分", Quantity::Water),
    ("press;barometer", Quantity::Pressure),
];
/// Words that say nothing of which sensor it is.
pub(crate) const PLAIN: &str = "air;relativa;suhteline;относительная;luft;humedad;rel;relative;ambient;avg;ave;average;mean;last;\
    smp;percent;degc;degf;c;f;pct;rf;lft;tc";
/// Words in the name of a column that names sensors.
pub(crate) const SENSORS: &str = "transmitter;sensor;device;logger;probe;station;node;location;serial;fühler;gerät;sonde;messstelle;\
    capteur;equipo;sensore;andur;датчик;センサ;传感器;感測器;sond;anturi;channel";
/// Names of columns of serial numbers.
pub(crate) const SERIALS: &str = "serial number;serial no;serial;s/n;seriennummer";
/// Names of a column of values whose quantity another column names.
pub(crate) const VALUE_LABELS: &str =
    "value;reading;wert;messwert;valeur;valor;valore;väärtus;значение;値;数值";

/// Columns of run sheets that are no quantities: the tag, or `file`, and the names of its column.
pub(crate) const SHEET_COLUMNS: [(&str, &str); 8] = [
    (
        "file",
        "file;filename;file name;fichier;nom du fichier;nom de fichier;datei;dateiname;fail;failinimi;faili nimi;archivo;\
         fichero;nombre de archivo;arquivo;plik;файл;имя файла;ファイル;文件;檔案;파일",
    ),
    (
        keys::SAMPLE,
        "sample;strip;specimen;échantillon;echantillon;éprouvette;eprouvette;probe;streifen;muster;proov;katsekeha;riba;\
         muestra;campione;amostra;próbka;образец;試料;サンプル;样品;樣品;시료",
    ),
    (
        keys::ENVIRONMENT,
        "environment;atmosphere;atmosphère;milieu;environnement;gaz;gas;umgebung;atmosphäre;keskkond;atmosfäär;ambiente;\
         atmósfera;atmosfera;среда;атмосфера;雰囲気;環境;环境;气氛",
    ),
    (
        keys::CYCLE,
        "cycle;zyklus;tsükkel;répétition;repetition;repeat;wiederholung;kordus;essai;ciclo;cykl;цикл;サイクル;繰り返し;循环",
    ),
    (
        keys::OPERATOR,
        "operator;opérateur;operateur;bediener;mõõtja;operaator;operador;operatore;оператор;測定者;担当者;操作者",
    ),
    (
        keys::INSTRUMENT,
        "instrument;appareil;gerät;geraet;seade;instrumento;strumento;przyrząd;прибор;装置;測定器;仪器",
    ),
    (
        keys::NOTE,
        "note;notes;remark;remarks;remarque;remarques;commentaire;commentaires;bemerkung;bemerkungen;kommentar;märkus;\
         märkused;nota;notas;osservazioni;uwagi;примечание;備考;备注;비고",
    ),
    (
        keys::REST_BEFORE_S,
        "rest_before_s;repos (s);rest (s);pause (s);ruhe (s);paus (s);reposo (s);riposo (s);休止 (s)",
    ),
];

/// Columns of tables of a four-point probe, by what their names begin with: the face of the strip, how often it was bent, when
/// it was measured.
pub(crate) const FACES: &str = "face;side;electrode";
/// As [`FACES`].
pub(crate) const FLEXED: &str = "flex;cycles;bends;number of flex;number of bend";
/// As [`FACES`].
pub(crate) const MEASURED: &str = "measured;started";
/// What stands in the name of an error of readings.
pub(crate) const ERRORS: &str = "error;sd;deviation;uncertainty;±;sem";
/// Spellings of "per square" behind a unit or in a name.
pub(crate) const PER_SQUARE: &str = "/sq;/□;/◻;per sq";

/// What the number is called in names of files that counts runs, beside a cycle's names in sheets; single letters are more often
/// those of samples.
pub(crate) const RUN_COUNTERS: &str =
    ";#;run;lauf;nr;no;n°;messung;rep;mesure;prova;medida;katse;tsukkel;versuch";
/// What stands before or behind a humidity in names of files.
pub(crate) const HUMIDITY_OF_NAMES: &str = "rh;rf;hr;%;%rh;rh%;%rf;%hr;percent;pct";
/// Parts of names of dew points, which are no temperatures of the air.
pub(super) const DEW_POINTS: &str = "dew;taupunkt;frost;rosée;rocío;rugiada;orvalho;kastepunkt;росы;露";

/// Whether a word is among words with semicolons between them.
pub(crate) fn is_among(words: &str, word: &str) -> bool {
    words.split(';').any(|known| known == word)
}
