//! What an extended model is made of: the places where an effect may act.

use crate::LumpedModel;
use ieap_domain::{Channel, ClimateQuantity, Drive};

/// Place of a run among the values of a tag, for the effect that follows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TagAt {
    /// Id of the effect: `follows:pre_charge_s` of numbers, `follows:operator=Ann` of a word.
    pub id: &'static str,
    /// Of a number its distance from the mean of the group in parts of the group's span; of a word 1 where the run has it.
    /// 0 where nothing is stated.
    pub at: f64,
}

/// What an effect knows of the run it acts in.
#[derive(Debug, Clone, Copy)]
pub struct RunContext<'a> {
    /// Place of the run in its group, from 0.
    pub index: usize,
    /// What drives it.
    pub drive: &'a Drive,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Free length, cm; none where it is not known.
    pub length_cm: Option<f64>,
    /// Time of the last reading, s.
    pub duration_s: f64,
    /// Shortest time that steps resolve, s: held while parameters are searched, so that the steps do not jump with
    /// them; none for the model's own.
    pub resolved_s: Option<f64>,
    /// Where the run lies among the values of tags that differ in its group.
    pub tags: &'a [TagAt],
    /// What was read beside its response: of the air, where a sensor logged it.
    pub channels: &'a [Channel],
}

impl<'a> RunContext<'a> {
    /// What a sensor read of the air while the run went on, on its clock.
    pub fn logged(&self, quantity: ClimateQuantity) -> Option<&'a Channel> {
        let is_it = |own: &&Channel| {
            ClimateQuantity::measured(own.quantity) == Some(quantity) && own.is_whole(own.quantity)
        };
        self.channels.iter().find(is_it)
    }

    /// Start of the first segment: the origin of the run's clock, s.
    pub fn start_s(&self) -> f64 {
        self.drive
            .segments
            .first()
            .map_or(0.0, |segment| segment.start_s())
    }

    /// Voltage of the first segment, V; 0 for an open circuit. Of a voltage that moves all the time its nominal one, for it
    /// begins at none.
    pub fn first_voltage_v(&self) -> f64 {
        if self.drive.moves() {
            return self.drive.nominal_step_v();
        }
        let first = self.drive.segments.first();
        first.and_then(|segment| segment.level.volts()).unwrap_or(0.0)
    }

    /// Largest voltage that the source holds, the baseline's among them, whatever its sign, V.
    pub fn largest_voltage_v(&self) -> f64 {
        self.drive.largest_v().max(self.drive.baseline_v.abs())
    }
}

/// One R-C branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchLaw {
    /// Which branch of the base it is, or is a share of, from 0; none for a branch that an effect adds.
    pub of_base: Option<usize>,
    /// Areal resistance, Ohm cm2.
    pub resistance_ohm_cm2: f64,
    /// Areal capacitance, F/cm2.
    pub capacitance_f_per_cm2: f64,
    /// Part of the coupling with which its charge bends the strip; 1 for the thesis's model.
    pub bends: f64,
    /// Conductance across its capacitor, S/cm2.
    pub internal_conductance_s_per_cm2: f64,
    /// Voltage of its capacitor before the drive beside the baseline's, V.
    pub residual_v: f64,
}

impl BranchLaw {
    /// A branch that the base does not have.
    pub fn added(capacitance_f_per_cm2: f64, time_constant_s: f64) -> BranchLaw {
        BranchLaw {
            of_base: None,
            resistance_ohm_cm2: time_constant_s / capacitance_f_per_cm2,
            capacitance_f_per_cm2,
            bends: 1.0,
            internal_conductance_s_per_cm2: 0.0,
            residual_v: 0.0,
        }
    }

    /// Time constant, s.
    pub fn time_constant_s(&self) -> f64 {
        self.resistance_ohm_cm2 * self.capacitance_f_per_cm2
    }

    /// A share of it that charges `slower` times as slowly.
    pub fn share(&self, part: f64, slower: f64) -> BranchLaw {
        BranchLaw {
            resistance_ohm_cm2: self.resistance_ohm_cm2 * slower / part,
            capacitance_f_per_cm2: self.capacitance_f_per_cm2 * part,
            internal_conductance_s_per_cm2: self.internal_conductance_s_per_cm2 * part,
            ..*self
        }
    }
}

/// One rate of back-relaxation: the strain of charge x passes through s/(s + rate).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxationMode {
    /// Rate, 1/s; 0 for strain that stays.
    pub rate_per_s: f64,
    /// Share of the strain.
    pub weight: f64,
}

/// How curvature readings are taken.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CameraClock {
    /// A reading shows what was this long ago, s.
    pub delay_s: f64,
    /// Relative error of the clock's rate.
    pub rate_error: f64,
    /// Time over which a reading is the mean, s.
    pub exposure_s: f64,
}

/// The state that a law sees.
#[derive(Debug, Clone, Copy)]
pub struct Now<'a> {
    /// Time since the start of the drive, s; negative before it.
    pub clock_s: f64,
    /// Time since the last change of the drive, s.
    pub since_edge_s: f64,
    /// Voltage of the source, V.
    pub source_v: f64,
    /// Voltage across the strip, V.
    pub terminal_v: f64,
    /// Current through the strip, A/cm2.
    pub current_a_per_cm2: f64,
    /// Current through R_ss, A/cm2.
    pub steady_a_per_cm2: f64,
    /// Branches as they are without laws.
    pub branches: &'a [BranchLaw],
    /// Voltages of the capacitors, V.
    pub capacitor_v: &'a [f64],
    /// Charge that bends the strip, C/cm2.
    pub charge_c_per_cm2: f64,
    /// Curvature, 1/cm.
    pub curvature_per_cm: f64,
    /// Rate of the curvature, 1/(cm s).
    pub curvature_rate_per_cm_s: f64,
    /// How the rate of the curvature grows with the voltage across the strip, 1/(cm s V).
    pub curvature_rate_per_cm_s_v: f64,
    /// Voltage in series with the source with which all this came about, V.
    pub emf_v: f64,
}

/// What a law may change at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Coefficients {
    /// Resistance of every branch, Ohm cm2.
    pub resistance_ohm_cm2: Vec<f64>,
    /// Differential capacitance of every branch, F/cm2.
    pub capacitance_f_per_cm2: Vec<f64>,
    /// Factor on the charge that every branch stores at a voltage, q = C e: where it changes the charge stays, so that a held
    /// voltage draws V dC/dt. 1 where the capacitance is that of its own voltage alone, dq = C de.
    pub storage: Vec<f64>,
    /// Conductance 1/R_ss, S/cm2.
    pub steady_s_per_cm2: f64,
    /// Further current between the terminals that does not bend, A/cm2.
    pub leak_a_per_cm2: f64,
    /// Further conductance between the terminals whose current does not bend, S/cm2.
    pub leak_s_per_cm2: f64,
    /// Factor on every rate of relaxation.
    pub relaxation_factor: f64,
    /// Factor on the coupling.
    pub coupling_factor: f64,
    /// Voltage in series with the source, V.
    pub emf_v: f64,
    /// What is read beside the current, A.
    pub added_current_a: f64,
    /// Curvature beside that of the charge, 1/cm.
    pub added_curvature_per_cm: f64,
}

impl Coefficients {
    /// Takes over those of another instant of the same model: no room is asked for.
    pub(super) fn copy_from(&mut self, other: &Coefficients) {
        self.resistance_ohm_cm2.copy_from_slice(&other.resistance_ohm_cm2);
        self.capacitance_f_per_cm2
            .copy_from_slice(&other.capacitance_f_per_cm2);
        self.storage.copy_from_slice(&other.storage);
        self.steady_s_per_cm2 = other.steady_s_per_cm2;
        self.leak_a_per_cm2 = other.leak_a_per_cm2;
        self.leak_s_per_cm2 = other.leak_s_per_cm2;
        self.relaxation_factor = other.relaxation_factor;
        self.coupling_factor = other.coupling_factor;
        self.emf_v = other.emf_v;
        self.added_current_a = other.added_current_a;
        self.added_curvature_per_cm = other.added_curvature_per_cm;
    }
}

/// Something that changes coefficients while the run goes on.
pub trait Law {
    /// Decay time of a quantity that the law remembers, s (infinite: an integral); none where it remembers nothing.
    fn memory_time_s(&self) -> Option<f64> {
        None
    }
    /// Rate at which the remembered quantity grows.
    fn memory_input(&self, _now: &Now) -> f64 {
        0.0
    }
    /// Changes the coefficients; `memory` is the remembered quantity.
    fn act(&self, now: &Now, memory: f64, coefficients: &mut Coefficients);
    /// How many times finer than for other effects steps must be.
    fn finer(&self) -> f64 {
        1.0
    }
    /// Clock time at which it changes a coefficient at once, s; none where it does not.
    fn jumps_at_s(&self) -> Option<f64> {
        None
    }
}

/// Something between the curvature of the model and the one that is read.
pub trait Observation {
    /// Changes curvatures at clock times (s since the start of the drive, increasing) in place.
    fn observe(&self, clock_s: &[f64], curvature_per_cm: &mut [f64]);
    /// Time scale that the times must resolve, s; infinite where each reading stands for itself.
    fn resolves_s(&self) -> f64 {
        f64::INFINITY
    }
    /// How many times finer than for other effects steps must be.
    fn finer(&self) -> f64 {
        1.0
    }
}

/// What is written down for a value at a time since the start of the drive, s (negative before it).
pub type Written = Box<dyn Fn(f64, f64) -> f64>;

/// The model of one run with every place where an effect may act.
pub struct System {
    /// Branches in parallel with R_ss; the base's first, in its order.
    pub branches: Vec<BranchLaw>,
    /// Conductance 1/R_ss, S/cm2.
    pub steady_s_per_cm2: f64,
    /// Part of the current through R_ss that bends the strip.
    pub steady_bends: f64,
    /// Resistance in series with the strip, Ohm cm2.
    pub series_resistance_ohm_cm2: f64,
    /// Resistance of both electrodes along the strip, Ohm per square; 0 for the lumped model.
    pub electrode_resistance_ohm_per_sq: f64,
    /// Coupling alpha, 1/(C cm).
    pub charge_to_curvature_per_c_cm: f64,
    /// Modes of relaxation, the base's first.
    pub relaxation: Vec<RelaxationMode>,
    /// Charge (C, of the whole sample) to the charge that strains; identity where none.
    pub bending_charge: Option<Box<dyn Fn(f64) -> f64>>,
    /// Curvature added straight from the charge (C) of the whole sample, 1/cm.
    pub direct_bending: Option<Box<dyn Fn(f64) -> f64>>,
    /// Time constant of the source, s.
    pub source_rise_s: f64,
    /// Whether the source goes on a straight line, within twice that time, and not exponentially.
    pub source_ramps: bool,
    /// Largest current that the source gives, A.
    pub current_limit_a: f64,
    /// Constant in the measured current, A.
    pub current_offset_a: f64,
    /// Laws, in order.
    pub laws: Vec<Box<dyn Law>>,
    /// Observations, in order.
    pub observations: Vec<Box<dyn Observation>>,
    /// How curvature readings are taken.
    pub camera: CameraClock,
    /// What is written down of a current (A) and of a curvature (1/cm): the last that happens to a reading, in order.
    pub written_current: Vec<Written>,
    /// See `written_current`.
    pub written_curvature: Vec<Written>,
}

impl System {
    /// The base model without effects.
    pub fn of(base: &LumpedModel) -> System {
        let branch = |(place, branch): (usize, &crate::Branch)| BranchLaw {
            of_base: Some(place),
            resistance_ohm_cm2: branch.resistance_ohm_cm2,
            capacitance_f_per_cm2: branch.capacitance_f_per_cm2,
            bends: 1.0,
            internal_conductance_s_per_cm2: 0.0,
            residual_v: 0.0,
        };
        System {
            branches: base.branches.iter().enumerate().map(branch).collect(),
            steady_s_per_cm2: base.steady_state_resistance_ohm_cm2.recip(),
            steady_bends: 0.0,
            series_resistance_ohm_cm2: 0.0,
            electrode_resistance_ohm_per_sq: 0.0,
            charge_to_curvature_per_c_cm: base.charge_to_curvature_per_c_cm,
            relaxation: vec![RelaxationMode {
                rate_per_s: base.relaxation_rate_per_s,
                weight: 1.0,
            }],
            bending_charge: None,
            direct_bending: None,
            source_rise_s: 0.0,
            source_ramps: false,
            current_limit_a: f64::INFINITY,
            current_offset_a: 0.0,
            laws: Vec::new(),
            observations: Vec::new(),
            camera: CameraClock::default(),
            written_current: Vec::new(),
            written_curvature: Vec::new(),
        }
    }

    /// Place of the base's slowest branch in the base: branch 2, or the only one.
    pub fn slowest_of_base(&self) -> Option<usize> {
        self.branches.iter().filter_map(|branch| branch.of_base).max()
    }

    /// Current at rest under a held voltage, S/cm2: through R_ss and through leaks inside branches.
    pub(super) fn rest_s_per_cm2(&self) -> f64 {
        let inside = self.branches.iter().map(|b| {
            let g = b.internal_conductance_s_per_cm2;
            g / (1.0 + g * b.resistance_ohm_cm2)
        });
        self.steady_s_per_cm2 + inside.sum::<f64>()
    }

    /// Whether answers are smooth between edges of the drive and jumps of the laws. Observations look at neighbouring
    /// readings, and are shown all of them.
    pub(super) fn is_smooth(&self) -> bool {
        self.observations.is_empty() && self.current_limit_a.is_infinite()
    }

    /// Whether every step can be exact: nothing depends on the state or on time.
    pub(super) fn is_linear(&self) -> bool {
        self.laws.is_empty()
            && self.bending_charge.is_none()
            && self.series_resistance_ohm_cm2 == 0.0
            && self.electrode_resistance_ohm_per_sq == 0.0
            && self.source_rise_s == 0.0
            && self.current_limit_a.is_infinite()
    }
}
