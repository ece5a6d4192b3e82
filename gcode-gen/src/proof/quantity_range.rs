//! Ranges of a job's quantities: `hole.radius=0..1100`.
use gcode_part::job::{HoleSpec, PinHoles};

/// Quantity of a pin-hole job that a proof can leave open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Radius,
    Azimuth,
    Depth,
    EquatorialRadius,
    PolarRadius,
}

impl Quantity {
    pub(crate) const ALL: [Self; 5] =
        [Self::Radius, Self::Azimuth, Self::Depth, Self::EquatorialRadius, Self::PolarRadius];

    /// Returns the key in a job file.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Radius => "hole.radius",
            Self::Azimuth => "hole.azimuth",
            Self::Depth => "hole.depth",
            Self::EquatorialRadius => "surface.a",
            Self::PolarRadius => "surface.b",
        }
    }

    /// Returns the letter of the macro's argument.
    pub(crate) fn letter(self) -> char {
        match self {
            Self::Radius => 'R',
            Self::Azimuth => 'W',
            Self::Depth => 'D',
            Self::EquatorialRadius => 'A',
            Self::PolarRadius => 'B',
        }
    }

    /// Returns the job's own value.
    pub(crate) fn of(self, job: &PinHoles, hole: &HoleSpec) -> f64 {
        match self {
            Self::Radius => hole.radius,
            Self::Azimuth => hole.azimuth,
            Self::Depth => hole.depth,
            Self::EquatorialRadius => job.surface.a,
            Self::PolarRadius => job.surface.b,
        }
    }

    /// Sets the job's value.
    pub(crate) fn set(self, job: &mut PinHoles, hole: &mut HoleSpec, value: f64) {
        match self {
            Self::Radius => hole.radius = value,
            Self::Azimuth => hole.azimuth = value,
            Self::Depth => hole.depth = value,
            Self::EquatorialRadius => job.surface.a = value,
            Self::PolarRadius => job.surface.b = value,
        }
    }
}

/// A quantity with its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuantityRange {
    pub(crate) quantity: Quantity,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl QuantityRange {
    /// Parses ranges, each of another quantity; the message of one that can't be used.
    pub(crate) fn parse_all(texts: &[String]) -> Result<Vec<Self>, String> {
        let mut all: Vec<Self> = Vec::new();
        for text in texts {
            let over = Self::parse(text)?;
            if all.iter().any(|other| other.quantity == over.quantity) {
                return Err(format!("--over {text}: this quantity already has a range: keep one of them"));
            }
            all.push(over);
        }
        Ok(all)
    }

    fn parse(text: &str) -> Result<Self, String> {
        let (key, limits) = text.split_once('=').ok_or_else(|| {
            format!("--over {text}: write a key of the job and its limits, 'hole.radius=0..1100'")
        })?;
        let quantity = Quantity::ALL.into_iter().find(|quantity| quantity.key() == key.trim());
        let quantity = quantity.ok_or_else(|| {
            let keys = Quantity::ALL.map(Quantity::key).join(", ");
            format!("--over {text}: '{}' is none of {keys}", key.trim())
        })?;
        let [low, high] = parse_limits(limits)
            .ok_or_else(|| format!("--over {text}: write two numbers up to 100000, '{key}=0..1100'"))?;
        check_order(text, [low, high])?;
        let least = match quantity {
            Quantity::Azimuth => f64::NEG_INFINITY,
            Quantity::Radius => 0.0,
            Quantity::Depth | Quantity::EquatorialRadius | Quantity::PolarRadius => 0.001,
        };
        if low < least {
            return Err(format!(
                "--over {text}: the lower limit is below {least}: no job file has that value"
            ));
        }
        Ok(Self { quantity, low, high })
    }
}

/// Parses the limits of a range, `0..1100`; `None` for others than two numbers up to 100000. −0 becomes 0.
pub(super) fn parse_limits(text: &str) -> Option<[f64; 2]> {
    let limit = |limit: &str| limit.trim().parse::<f64>().ok().filter(|limit| limit.abs() <= 1e5);
    let (low, high) = text.split_once("..")?;
    Some([limit(low)? + 0.0, limit(high)? + 0.0])
}

/// Refuses a range whose lower limit is above the upper one; `text` is the range as written.
pub(super) fn check_order(text: &str, [low, high]: [f64; 2]) -> Result<(), String> {
    match low <= high {
        true => Ok(()),
        false => Err(format!("--over {text}: the lower limit is above the upper one: exchange them")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_names_a_key_of_the_job() {
        let texts = ["hole.radius=0..1100", "hole.azimuth = -180 .. 180"].map(str::to_owned);
        let all = QuantityRange::parse_all(&texts).unwrap();
        assert_eq!(all[1], QuantityRange { quantity: Quantity::Azimuth, low: -180.0, high: 180.0 });
        for (text, why) in [
            ("hole.radius", "write a key"),
            ("hole.colour=0..1", "is none of"),
            ("hole.radius=0", "write two numbers"),
            ("hole.radius=0..inf", "write two numbers"),
            ("hole.radius=2..1", "exchange"),
            ("hole.radius=-1..1", "below 0"),
            ("surface.a=0..1", "below 0.001"),
        ] {
            let error = QuantityRange::parse_all(&[text.to_owned()]).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
        assert!(
            QuantityRange::parse_all(&[texts[0].clone(), texts[0].clone()]).unwrap_err().contains("already")
        );
    }
}
