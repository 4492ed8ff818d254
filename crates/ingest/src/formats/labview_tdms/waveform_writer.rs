//! Writes small TDMS files of waveforms, for tests.

/// A channel of one group with its properties.
pub struct Wave {
    /// Name of the channel.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Seconds since 1904 at which its clock starts; 0 where nobody set it.
    pub start: i64,
    /// From there to its first reading, s.
    pub offset: f64,
    /// Between readings, s.
    pub increment: f64,
    /// Its readings.
    pub values: Vec<f64>,
}

/// The moment at which the tests' waveforms start, 2026-03-09 14:00:00 UTC.
pub const START: i64 = 3_855_909_600;

/// A channel that starts there.
pub fn wave(name: &'static str, unit: &'static str, increment: f64, values: &[f64]) -> Wave {
    Wave {
        name,
        unit,
        start: START,
        offset: 0.0,
        increment,
        values: values.to_vec(),
    }
}

fn text(to: &mut Vec<u8>, text: &str) {
    to.extend((text.len() as u32).to_le_bytes());
    to.extend(text.as_bytes());
}

/// A property: its name, the code of its type and its bytes.
fn property(to: &mut Vec<u8>, name: &str, code: u32, bytes: &[u8]) {
    text(to, name);
    to.extend(code.to_le_bytes());
    to.extend(bytes);
}

/// A file of one segment with the group `Run`.
pub fn written(waves: &[Wave]) -> Vec<u8> {
    let mut meta = (waves.len() as u32).to_le_bytes().to_vec();
    for wave in waves {
        text(&mut meta, &format!("/'Run'/'{}'", wave.name));
        meta.extend([20u32, 10, 1].map(u32::to_le_bytes).concat());
        meta.extend((wave.values.len() as u64).to_le_bytes());
        meta.extend(4u32.to_le_bytes());
        let moment = [[0; 8], wave.start.to_le_bytes()].concat();
        property(&mut meta, "wf_start_time", 0x44, &moment);
        property(&mut meta, "wf_start_offset", 10, &wave.offset.to_le_bytes());
        property(&mut meta, "wf_increment", 10, &wave.increment.to_le_bytes());
        let mut unit = Vec::new();
        text(&mut unit, wave.unit);
        property(&mut meta, "unit_string", 0x20, &unit);
    }
    let raw: Vec<u8> = waves
        .iter()
        .flat_map(|wave| &wave.values)
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let mut bytes = b"TDSm".to_vec();
    bytes.extend([0b1110u32, 4713].map(u32::to_le_bytes).concat());
    bytes.extend(((meta.len() + raw.len()) as u64).to_le_bytes());
    bytes.extend((meta.len() as u64).to_le_bytes());
    [bytes, meta, raw].concat()
}
