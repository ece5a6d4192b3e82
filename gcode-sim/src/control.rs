//! The settings of a control that a program's meaning depends on, in one struct: never an `if` in the reader.
use crate::units::MmPerMin;

/// The least input increment (parameter 1013).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Increment {
    /// 0.01 mm and degrees.
    IsA,
    /// 0.001 mm and degrees.
    #[default]
    IsB,
    /// 0.0001 mm and degrees.
    IsC,
}

impl Increment {
    pub const ALL: [(&'static str, Self); 3] =
        [("IS-A", Self::IsA), ("IS-B", Self::IsB), ("IS-C", Self::IsC)];

    /// How many increments make a millimetre or a degree.
    pub fn per_unit(self) -> f64 {
        match self {
            Self::IsA => 100.0,
            Self::IsB => 1_000.0,
            Self::IsC => 10_000.0,
        }
    }

    /// The multiple of the increment nearest to `value`, half away from zero.
    pub fn round(self, value: f64) -> f64 {
        (value * self.per_unit()).round() / self.per_unit()
    }

    /// The increment itself in mm or degrees.
    pub fn size(self) -> f64 {
        1.0 / self.per_unit()
    }
}

/// Which family of controls; its limits and differences are data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    #[default]
    Fanuc31i,
    Fanuc0iF,
    HaasNgc,
}

impl Dialect {
    pub const ALL: [(&'static str, Self); 3] =
        [("fanuc-31i", Self::Fanuc31i), ("fanuc-0i-f", Self::Fanuc0iF), ("haas-ngc", Self::HaasNgc)];
}

/// Everything a run depends on besides the programs. `Default` is the control of the conformance set.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    pub dialect: Dialect,
    pub increment: Increment,
    /// DPI 3401#0: a number without a point is mm, degrees, seconds instead of increments.
    pub calculator_input: bool,
    /// NAT 6004#0: ASIN and ATAN answer −90…90 and −180…180 instead of 270…90 and 0…360.
    pub signed_angles: bool,
    /// Block-skip switches that are on, by number 1 to 9.
    pub skip_switches: [bool; 9],
    /// M01 stops.
    pub optional_stop: bool,
    /// 1420: rapid rate of the axes that slide.
    pub rapid: MmPerMin,
    /// 1420: rapid rate of the axes that turn, degrees a minute.
    pub rapid_rotary: f64,
    /// 3410: how far an arc's end may be off its radius, mm.
    pub arc_tolerance: f64,
    /// 5114: the retract of G73, mm.
    pub g73_retract: f64,
    /// 5115: the clearance of G83 above the last depth, mm.
    pub g83_clearance: f64,
    /// Macro calls inside one another.
    pub macro_levels: usize,
    /// Calls of all kinds inside one another.
    pub call_levels: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            dialect: Dialect::default(),
            increment: Increment::default(),
            calculator_input: false,
            signed_angles: false,
            skip_switches: [false; 9],
            optional_stop: true,
            rapid: MmPerMin(24_000.0),
            rapid_rotary: 3_600.0,
            arc_tolerance: 0.02,
            g73_retract: 1.0,
            g83_clearance: 0.5,
            macro_levels: 5,
            call_levels: 15,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_half_away_from_zero() {
        assert_eq!(Increment::IsB.round(-1.0005), -1.001);
        assert_eq!(Increment::IsB.round(12.3456), 12.346);
        assert_eq!(Increment::IsA.round(0.005), 0.01);
    }
}
