//! Names and symbols of what the axes show.

use crate::branch::EventType;

/// A quantity by its word and its symbol; either may be empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Word, such as `mismatch`.
    pub word: String,
    /// Symbol, such as `δ`.
    pub symbol: String,
}

impl Quantity {
    /// A quantity of this word and symbol.
    pub fn new(word: &str, symbol: &str) -> Self {
        Quantity {
            word: word.to_owned(),
            symbol: symbol.to_owned(),
        }
    }

    /// The quantity in a column of `branch.csv`.
    pub fn of_column(name: &str) -> Self {
        match name {
            "mismatch" => Quantity::new("mismatch", "δ"),
            "friction" => Quantity::new("friction", "f"),
            "mass_damping" => Quantity::new("mass damping", "α"),
            "stiffness_damping" => Quantity::new("stiffness damping", "β"),
            "gamma" => Quantity::new("", "γ"),
            "nu" => Quantity::new("Poisson's ratio", "ν"),
            "xi" => Quantity::new("radius ratio", "ξ"),
            "smoothing" => Quantity::new("smoothing", "ε"),
            "speed" => Quantity::new("speed", "c"),
            "switches" => Quantity::new("switching positions", "θ"),
            "min_pressure" => Quantity::new("least pressure", "min P"),
            "max_gap" => Quantity::new("largest gap", "max(U − δ)"),
            "amplitude" => Quantity::new("amplitude of", "V"),
            "unstable" => Quantity::new("unstable eigenvalues", ""),
            "lead_re" => Quantity::new("leading", "Re λ"),
            "lead_im" => Quantity::new("leading", "Im λ"),
            "lead_sector" => Quantity::new("sector of the leading eigenvalue", ""),
            "newton" => Quantity::new("Newton iterations", ""),
            other => Quantity::new(&other.replace('_', " "), ""),
        }
    }

    /// Word and symbol.
    pub fn caption(&self) -> String {
        self.around(&self.symbol)
    }

    /// The word followed by an expression instead of the symbol.
    pub fn around(&self, expression: &str) -> String {
        match (self.word.is_empty(), expression.is_empty()) {
            (false, false) => format!("{} {expression}", self.word),
            (true, _) => expression.to_owned(),
            (_, true) => self.word.clone(),
        }
    }

    /// The symbol, or the word where there is none.
    pub fn short(&self) -> &str {
        if self.symbol.is_empty() {
            &self.word
        } else {
            &self.symbol
        }
    }
}

/// What an event type stands for, as short as a legend needs it.
pub fn event_name(kind: EventType) -> &'static str {
    match kind {
        EventType::EP => "end",
        EventType::MX => "failure",
        EventType::UZ => "user point",
        EventType::LP => "fold",
        EventType::HB => "Hopf",
        EventType::BP => "real crossing",
        EventType::GR => "take-off",
        EventType::RV => "reverse slip",
        EventType::CO => "coalescence",
        EventType::ST => "stick vanishes",
    }
}

/// A signature of regimes shortened: `slip-reverse-stick` becomes `sl-rev-st`.
pub fn short_signature(regimes: &str) -> String {
    regimes
        .split('-')
        .map(short_regime)
        .collect::<Vec<_>>()
        .join("-")
}

/// The name of a regime shortened.
pub fn short_regime(name: &str) -> String {
    match name {
        "slip" => "sl".to_owned(),
        "stick" => "st".to_owned(),
        "separation" => "sep".to_owned(),
        "reverse" => "rev".to_owned(),
        other => other.chars().take(3).collect(),
    }
}
