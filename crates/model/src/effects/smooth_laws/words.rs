//! Laws in words.

use ieap_domain::finding_words::variable_words;

use super::law::Place;

impl Place {
    /// What is so, as a clause: "the resistance of the slow branch changes with time".
    pub fn words(&self) -> String {
        let with = variable_words(self.variable);
        let of = match self.of {
            "" | "silent" => String::new(),
            "leak" => " of what leaks".to_owned(),
            branch => format!(" of the {}", branch.replace('-', " ")),
        };
        match (self.law, self.variable) {
            ("time-scales", _) => "the current relaxes over more time scales than two".to_owned(),
            ("first-charge", _) => "the strip is charged before the first voltage".to_owned(),
            ("delay", "time_s") => "the clock of the bending runs at another rate".to_owned(),
            ("delay", _) => "the bending comes late".to_owned(),
            ("play", _) => "the bending has a play".to_owned(),
            ("relaxation", "time_constant_s") => "the bending relaxes over several time scales".to_owned(),
            ("coupling", "") => format!("the bending per charge{of} is another"),
            ("resistance", _) => format!("the resistance{of} changes with {with}"),
            ("capacitance", _) => format!("the capacitance{of} changes with {with}"),
            ("leak", _) => format!("a current leaks that changes with {with}"),
            ("source", _) => format!("the voltage that drives the strip changes with {with}"),
            ("current-reading", _) => format!("the current is misread, by an error that changes with {with}"),
            ("coupling", _) => format!("the bending per charge{of} changes with {with}"),
            ("relaxation", _) => format!("the rate at which the bending relaxes changes with {with}"),
            ("added-bending", _) => {
                format!("the strip bends by itself, by a curvature that changes with {with}")
            }
            (law, _) => format!("{law} changes with {with}"),
        }
    }
}
