//! The methods that `--method` names: those that only solve, and those that simulate the planned motions as well.

use std::str::FromStr;

use dynid_runtime::estimation::Method;

/// How parameters are identified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Identification {
    /// From the recording alone.
    Solved(Method),
    /// Instrumental variables: the columns along simulated motions are the instruments of the measured ones.
    InstrumentalVariables,
    /// DIDIM: the columns are those along simulated motions.
    Didim,
}

impl Identification {
    /// What is solved, or what comes before a simulation.
    pub fn method(self) -> Method {
        match self {
            Identification::Solved(method) => method,
            Identification::InstrumentalVariables | Identification::Didim => Method::IdimWls,
        }
    }

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Identification::Solved(method) => method.name(),
            Identification::InstrumentalVariables => "idim-iv",
            Identification::Didim => "idim-didim",
        }
    }

    /// What simulates the planned motions, in words.
    pub fn simulates(self) -> Option<&'static str> {
        match self {
            Identification::Solved(_) => None,
            Identification::InstrumentalVariables => Some("the method of instrumental variables"),
            Identification::Didim => Some("DIDIM"),
        }
    }
}

impl FromStr for Identification {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "iv" | "idim-iv" => Ok(Identification::InstrumentalVariables),
            "didim" | "idim-didim" => Ok(Identification::Didim),
            other => other
                .parse()
                .map(Identification::Solved)
                .map_err(|said| format!("{said}, idim-iv, idim-didim")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_read_by_its_name_and_another_one_is_told_all_names() {
        let solved = Method::ALL.map(Identification::Solved);
        for method in solved.into_iter().chain([Identification::InstrumentalVariables, Identification::Didim])
        {
            assert_eq!(method.name().parse(), Ok(method));
        }
        let said = "magic".parse::<Identification>().expect_err("no method");
        assert!(["magic", "idim-wls", "pim-tls", "idim-iv", "idim-didim"].iter().all(|w| said.contains(w)));
    }
}
