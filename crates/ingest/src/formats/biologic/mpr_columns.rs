//! Columns of EC-Lab binary files by their id. Only ids are listed whose name and width files have shown: the row
//! width they add up to, and the values beside those of the text export of the same run.

/// How a value is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// Bits of the one byte that all flags share.
    Flag {
        /// Place of the lowest bit.
        shift: u8,
        /// Bits behind it.
        mask: u8,
    },
    /// Unsigned, two bytes.
    U16,
    /// Unsigned, four bytes.
    U32,
    /// Floating, four bytes.
    F32,
    /// Floating, eight bytes.
    F64,
}

impl Stored {
    /// Bytes of one value; a flag has none of its own.
    pub fn size(self) -> usize {
        match self {
            Stored::Flag { .. } => 0,
            Stored::U16 => 2,
            Stored::U32 | Stored::F32 => 4,
            Stored::F64 => 8,
        }
    }

    /// The value at the start of `bytes`.
    pub fn value(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Stored::Flag { shift, mask } => f64::from((bytes.first()? >> shift) & mask),
            Stored::U16 => f64::from(u16::from_le_bytes(bytes.get(..2)?.try_into().ok()?)),
            Stored::U32 => f64::from(u32::from_le_bytes(bytes.get(..4)?.try_into().ok()?)),
            Stored::F32 => f64::from(f32::from_le_bytes(bytes.get(..4)?.try_into().ok()?)),
            Stored::F64 => f64::from_le_bytes(bytes.get(..8)?.try_into().ok()?),
        })
    }
}

/// Name (as the text export spells it) and storage of a column; none for ids that were never seen.
pub fn column(id: u16) -> Option<(&'static str, Stored)> {
    let flag = |shift, mask| Stored::Flag { shift, mask };
    Some(match id {
        1 => ("mode", flag(0, 3)),
        2 => ("ox/red", flag(2, 1)),
        3 => ("error", flag(3, 1)),
        21 => ("control changes", flag(4, 1)),
        31 => ("Ns changes", flag(5, 1)),
        65 => ("counter inc.", flag(7, 1)),
        131 => ("Ns", Stored::U16),
        4 => ("time/s", Stored::F64),
        5 => ("control/V/mA", Stored::F32),
        6 => ("Ewe/V", Stored::F32),
        7 => ("dq/mA.h", Stored::F64),
        8 => ("I/mA", Stored::F32),
        9 => ("Ece/V", Stored::F32),
        11 => ("<I>/mA", Stored::F64),
        13 => ("(Q-Qo)/mA.h", Stored::F64),
        16 => ("Analog IN 1/V", Stored::F32),
        17 => ("Analog IN 2/V", Stored::F32),
        19 => ("control/V", Stored::F32),
        20 => ("control/mA", Stored::F32),
        23 => ("dQ/mA.h", Stored::F64),
        24 => ("cycle number", Stored::F64),
        32 => ("freq/Hz", Stored::F32),
        33 => ("|Ewe|/V", Stored::F32),
        34 => ("|I|/A", Stored::F32),
        35 => ("Phase(Z)/deg", Stored::F32),
        36 => ("|Z|/Ohm", Stored::F32),
        37 => ("Re(Z)/Ohm", Stored::F32),
        38 => ("-Im(Z)/Ohm", Stored::F32),
        39 => ("I Range", Stored::U16),
        70 => ("P/W", Stored::F32),
        74 => ("|Energy|/W.h", Stored::F64),
        76 => ("<I>/mA", Stored::F32),
        77 => ("<Ewe>/V", Stored::F32),
        96 => ("|Ece|/V", Stored::F32),
        98 => ("Phase(Zce)/deg", Stored::F32),
        99 => ("|Zce|/Ohm", Stored::F32),
        100 => ("Re(Zce)/Ohm", Stored::F32),
        101 => ("-Im(Zce)/Ohm", Stored::F32),
        123 => ("Energy charge/W.h", Stored::F64),
        124 => ("Energy discharge/W.h", Stored::F64),
        125 => ("Capacitance charge/µF", Stored::F64),
        126 => ("Capacitance discharge/µF", Stored::F64),
        168 => ("Rcmp/Ohm", Stored::F32),
        169 => ("Cs/µF", Stored::F32),
        172 => ("Cp/µF", Stored::F32),
        174 => ("<Ewe>/V", Stored::F32),
        430 => ("Phase(Zwe-ce)/deg", Stored::F32),
        431 => ("|Zwe-ce|/Ohm", Stored::F32),
        432 => ("Re(Zwe-ce)/Ohm", Stored::F32),
        433 => ("-Im(Zwe-ce)/Ohm", Stored::F32),
        434 => ("(Q-Qo)/C", Stored::F32),
        435 => ("dQ/C", Stored::F32),
        438 => ("step time/s", Stored::F64),
        441 => ("<Ecv>/V", Stored::F32),
        467 => ("Q charge/discharge/mA.h", Stored::F64),
        468 => ("half cycle", Stored::U32),
        469 => ("z cycle", Stored::U32),
        471 => ("<Ece>/V", Stored::F32),
        473 => ("THD Ewe/%", Stored::F32),
        474 => ("THD I/%", Stored::F32),
        476 => ("NSD Ewe/%", Stored::F32),
        477 => ("NSD I/%", Stored::F32),
        479 => ("NSR Ewe/%", Stored::F32),
        480 => ("NSR I/%", Stored::F32),
        486 => ("|Ewe h2|/V", Stored::F32),
        487 => ("|Ewe h3|/V", Stored::F32),
        488 => ("|Ewe h4|/V", Stored::F32),
        489 => ("|Ewe h5|/V", Stored::F32),
        490 => ("|Ewe h6|/V", Stored::F32),
        491 => ("|Ewe h7|/V", Stored::F32),
        492 => ("|I h2|/A", Stored::F32),
        493 => ("|I h3|/A", Stored::F32),
        494 => ("|I h4|/A", Stored::F32),
        495 => ("|I h5|/A", Stored::F32),
        496 => ("|I h6|/A", Stored::F32),
        497 => ("|I h7|/A", Stored::F32),
        _ => return None,
    })
}

/// Technique of an id of the settings, as the text export names it; none for ids that were never seen.
pub fn technique(id: u8) -> Option<&'static str> {
    Some(match id {
        4 => "Galvanostatic Cycling with Potential Limitation",
        6 => "Cyclic Voltammetry",
        11 => "Open Circuit Voltage",
        24 => "Chronoamperometry / Chronocoulometry",
        25 => "Chronopotentiometry",
        28 => "Wait",
        29 => "Potentio Electrochemical Impedance Spectroscopy",
        30 => "Galvano Electrochemical Impedance Spectroscopy",
        50 => "IR compensation (PEIS)",
        51 => "Cyclic Voltammetry Advanced",
        108 => "Linear Sweep Voltammetry",
        117 => "Constant Voltage",
        118 => "Constant Current",
        127 => "Modulo Bat",
        136 => "Battery Capacity Determination",
        _ => return None,
    })
}
