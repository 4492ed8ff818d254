//! Names as laboratories write them.

use crate::truth::Meaning;

/// Languages, in the order of the tables below.
pub const LANGUAGES: [&str; 10] = [
    "English",
    "German",
    "French",
    "Spanish",
    "Italian",
    "Portuguese",
    "Estonian",
    "Russian",
    "Japanese",
    "Chinese",
];

type Names = [&'static [&'static str]; 10];

/// Elapsed time.
pub const ELAPSED: Names = [
    &["Time", "t", "Elapsed time", "Test time", "Elapsed Time"],
    &["Zeit", "t", "Messzeit"],
    &["Temps", "t", "Temps écoulé"],
    &["Tiempo", "t"],
    &["Tempo", "t"],
    &["Tempo", "t"],
    &["Aeg", "t"],
    &["Время", "t"],
    &["時間", "経過時間"],
    &["时间", "t"],
];
/// Those of them that no time of day has.
pub const IS_ELAPSED: [&str; 6] = [
    "Elapsed time",
    "Elapsed Time",
    "Test time",
    "Messzeit",
    "Temps écoulé",
    "経過時間",
];
/// Date and time in one column.
pub const MOMENT: Names = [
    &[
        "Date/Time",
        "DateTime",
        "Timestamp",
        "Date Time",
        "Time",
        "timestamp",
    ],
    &["Datum/Zeit", "Zeitstempel", "Datum Uhrzeit", "Zeit"],
    &["Date/Heure", "Date et heure", "Horodatage"],
    &["Fecha y hora", "Fecha/Hora"],
    &["Data e ora", "Data/Ora"],
    &["Data e hora", "Data/Hora"],
    &["Kuupäev/Kellaaeg", "Kuupäev ja kellaaeg", "Aeg"],
    &["Дата/Время", "Дата и время"],
    &["日時", "日付時刻"],
    &["日期时间", "时间"],
];
/// Date.
pub const DATE: Names = [
    &["Date", "DATE"],
    &["Datum"],
    &["Date"],
    &["Fecha"],
    &["Data"],
    &["Data"],
    &["Kuupäev"],
    &["Дата"],
    &["日付"],
    &["日期"],
];
/// Time of day.
pub const TIME_OF_DAY: Names = [
    &["Time", "TIME", "Time of day"],
    &["Uhrzeit", "Zeit"],
    &["Heure"],
    &["Hora"],
    &["Ora"],
    &["Hora"],
    &["Kellaaeg", "Aeg"],
    &["Время"],
    &["時刻"],
    &["时间"],
];
/// The column of words that names a sensor.
pub const SENSOR: Names = [
    &["Sensor", "TRANSMITTER", "Device", "Sensor name", "Location"],
    &["Messstelle", "Sensor", "Gerät"],
    &["Capteur"],
    &["Sensor", "Equipo"],
    &["Sensore"],
    &["Sensor"],
    &["Andur"],
    &["Датчик"],
    &["センサー"],
    &["传感器"],
];

/// Names of what a column holds.
pub fn of(meaning: Meaning) -> Names {
    match meaning {
        Meaning::Voltage => [
            &["Voltage", "Potential", "E", "U", "Ewe"],
            &["Spannung", "Potential", "U"],
            &["Tension", "Potentiel", "U"],
            &["Voltaje", "Tensión", "Potencial"],
            &["Tensione", "Potenziale"],
            &["Tensão", "Potencial"],
            &["Pinge", "U"],
            &["Напряжение", "U"],
            &["電圧", "電位"],
            &["电压", "电位"],
        ],
        Meaning::Current => [
            &["Current", "I", "Im"],
            &["Strom", "Stromstärke", "I"],
            &["Courant", "Intensité", "I"],
            &["Corriente", "Intensidad"],
            &["Corrente", "I"],
            &["Corrente", "I"],
            &["Vool", "Voolutugevus", "I"],
            &["Ток", "Сила тока", "I"],
            &["電流"],
            &["电流"],
        ],
        Meaning::Curvature => [
            &["Curvature", "kappa"],
            &["Krümmung"],
            &["Courbure"],
            &["Curvatura"],
            &["Curvatura"],
            &["Curvatura"],
            &["Kõverus"],
            &["Кривизна"],
            &["曲率"],
            &["曲率"],
        ],
        Meaning::TipDisplacement => [
            &["Tip displacement", "Displacement", "Deflection"],
            &["Auslenkung", "Verschiebung", "Weg"],
            &["Déplacement", "Flèche"],
            &["Desplazamiento"],
            &["Spostamento"],
            &["Deslocamento"],
            &["Siire"],
            &["Смещение", "Перемещение"],
            &["変位"],
            &["位移"],
        ],
        Meaning::Humidity => [
            &["RH", "Humidity", "Relative humidity", "Rel. humidity"],
            &[
                "Feuchte",
                "Rel. Feuchte",
                "Luftfeuchtigkeit",
                "relative Feuchte",
                "rF",
            ],
            &["Humidité", "Humidité relative", "HR"],
            &["Humedad", "Humedad relativa", "HR"],
            &["Umidità", "Umidità relativa", "UR"],
            &["Umidade", "Umidade relativa", "UR"],
            &["Niiskus", "Suhteline niiskus", "Õhuniiskus"],
            &["Влажность", "Относительная влажность"],
            &["湿度", "相対湿度"],
            &["湿度", "相对湿度"],
        ],
        Meaning::Temperature => [
            &["Temperature", "Temp", "T", "Temp."],
            &["Temperatur", "T", "Temp."],
            &["Température", "T"],
            &["Temperatura", "T"],
            &["Temperatura", "T"],
            &["Temperatura"],
            &["Temperatuur", "Temp"],
            &["Температура"],
            &["温度"],
            &["温度"],
        ],
        Meaning::Pressure => [
            &["Pressure", "Air pressure"],
            &["Luftdruck", "Druck"],
            &["Pression"],
            &["Presión"],
            &["Pressione"],
            &["Pressão"],
            &["Õhurõhk", "Rõhk"],
            &["Давление"],
            &["気圧"],
            &["气压"],
        ],
        Meaning::DewPoint => [
            &["Dew point", "Dewpoint"],
            &["Taupunkt"],
            &["Point de rosée"],
            &["Punto de rocío"],
            &["Punto di rugiada"],
            &["Ponto de orvalho"],
            &["Kastepunkt"],
            &["Точка росы"],
            &["露点"],
            &["露点"],
        ],
        Meaning::Constant => [
            &["Gain", "Cycle", "Channel"],
            &["Kanal", "Zyklus"],
            &["Canal", "Cycle"],
            &["Canal", "Ciclo"],
            &["Canale", "Ciclo"],
            &["Canal", "Ciclo"],
            &["Kanal", "Tsükkel"],
            &["Канал", "Цикл"],
            &["チャンネル"],
            &["通道"],
        ],
        Meaning::Remark => [
            &["Remark", "Comment", "Status"],
            &["Bemerkung", "Kommentar"],
            &["Remarque"],
            &["Observaciones"],
            &["Note"],
            &["Observações"],
            &["Märkus"],
            &["Примечание"],
            &["備考"],
            &["备注"],
        ],
    }
}
