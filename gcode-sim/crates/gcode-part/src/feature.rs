//! Features of a hole: the diameters, cones and threads on one axis, each down to its own depth.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::hand::Hand;
use super::limits::exceeds;
use super::thread_size;
use gcode_lang::units::Deg;

/// Kind of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FeatureKind {
    /// A drilled diameter.
    Drill,
    /// A reamed diameter.
    Ream,
    /// A bored diameter.
    Bore,
    /// A wider diameter at the entry with a flat bottom.
    Counterbore,
    /// A cone at the entry; `diameter` is its diameter at the entry.
    Countersink,
    /// A thread; `diameter` is its nominal diameter.
    Tap,
}

/// Point to which a depth counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum DepthTo {
    /// The deepest point of the tool.
    #[default]
    Point,
    /// The end of the full diameter.
    Full,
}

/// A feature of a hole; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Feature {
    /// Kind of the feature.
    pub kind: FeatureKind,
    /// Diameter.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub diameter: f64,
    /// From the hole's entry, along the axis; `None` for a countersink whose diameter and angle give it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub depth: Option<f64>,
    /// Point to which the depth counts.
    #[serde(default)]
    pub to: DepthTo,
    /// Full angle of a countersink, or of a drill's point, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle: Option<f64>,
    /// Pitch of a thread.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub pitch: Option<f64>,
    /// Hand of a thread.
    #[serde(default, skip_serializing_if = "Hand::is_right")]
    pub hand: Hand,
}

/// Largest difference between the stated depth of a countersink and that of its cone, mm.
const CONE_TOLERANCE: f64 = 0.1;

impl FeatureKind {
    /// All kinds.
    pub(crate) const ALL: [Self; 6] =
        [Self::Drill, Self::Ream, Self::Bore, Self::Counterbore, Self::Countersink, Self::Tap];

    /// Returns the name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drill => "drill",
            Self::Ream => "ream",
            Self::Bore => "bore",
            Self::Counterbore => "counterbore",
            Self::Countersink => "countersink",
            Self::Tap => "tap",
        }
    }
}

impl Feature {
    /// Returns a feature without sizes.
    pub fn of(kind: FeatureKind) -> Self {
        Self {
            kind,
            diameter: 0.0,
            depth: None,
            to: DepthTo::Point,
            angle: None,
            pitch: None,
            hand: Hand::Right,
        }
    }

    /// Returns the depth of the feature, for a countersink that of its cone's point, mm.
    pub fn bottom(&self) -> f64 {
        match (self.kind, self.angle) {
            (FeatureKind::Countersink, Some(angle)) => self.diameter / 2.0 / Deg(angle / 2.0).tan(),
            _ => self.depth.unwrap_or(0.0),
        }
    }

    /// Returns the name with the sizes: `counterbore Φ10×5`, `tap M10×1.5, 22 deep`.
    pub fn describe(&self) -> String {
        // Lengths of a list in inches have sixteen digits.
        let short = |mm: f64| (mm * 1e4).round() / 1e4;
        let (kind, diameter, bottom) = (self.kind, short(self.diameter), short(self.bottom()));
        match (kind, self.pitch.map(short), self.angle) {
            (FeatureKind::Tap, Some(pitch), _) => {
                let hand = if self.hand == Hand::Left { "left-hand " } else { "" };
                format!("{hand}thread {diameter}×{pitch}, {bottom} deep")
            }
            (FeatureKind::Countersink, _, Some(angle)) => format!("countersink Φ{diameter}, {angle}°"),
            _ => format!("{} Φ{diameter}×{bottom}", kind.name()),
        }
    }

    /// Returns the notation of a CSV cell, as the column `features` has it.
    pub fn cell(&self) -> String {
        let depth = self.depth.map(|depth| format!(" {depth}"));
        let to = (self.to == DepthTo::Full).then(|| " to=full".to_owned());
        let angle = self.angle.map(|angle| format!(" angle={angle}"));
        let pitch = self.pitch.map(|pitch| format!(" pitch={pitch}"));
        let hand = (self.hand == Hand::Left).then(|| " hand=left".to_owned());
        let words = [depth, to, angle, pitch, hand].into_iter().flatten().collect::<String>();
        format!("{} {}{words}", self.kind.name(), self.diameter)
    }

    /// Parses the notation of a CSV cell: kind, diameter and depth, then `to=full`, `angle=`, `pitch=` and
    /// `hand=`:
    /// `tap 10 22 pitch=1.5`, `tap M10 22`, `countersink 12 angle=90`.
    ///
    /// `unit` is the length of the numbers' unit, mm; a designation such as M10 has its own.
    ///
    /// # Errors
    /// The part that is not understood, in words.
    pub(crate) fn parse_in(unit: f64, text: &str) -> Result<Self, String> {
        let mut words = text.split_whitespace();
        let name = words.next().unwrap_or_default();
        let kind = FeatureKind::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| {
            let names = FeatureKind::ALL.map(FeatureKind::name).join(", ");
            format!("'{name}' is no kind of feature: one of {names}")
        })?;
        let number = |word: &str| word.parse::<f64>().map_err(|_| format!("'{word}' is not a number"));
        let length = |word: &str| number(word).map(|value| value * unit);
        let size = words.next().ok_or("a feature needs its diameter behind its kind")?;
        let thread = thread_size::parse(size).filter(|_| kind == FeatureKind::Tap).transpose()?;
        let mut feature = Self {
            diameter: thread.map_or_else(|| length(size), |thread| Ok(thread.diameter))?,
            pitch: thread.map(|thread| thread.pitch),
            hand: thread.and_then(|thread| thread.hand).unwrap_or_default(),
            ..Self::of(kind)
        };
        for word in words {
            match word.split_once('=') {
                None if feature.depth.is_none() => feature.depth = Some(length(word)?),
                Some(("angle", value)) => feature.angle = Some(number(value)?),
                Some(("pitch", value)) => feature.pitch = Some(length(value)?),
                Some(("hand", "right")) => feature.hand = Hand::Right,
                Some(("hand", "left")) => feature.hand = Hand::Left,
                Some(("to", "full")) => feature.to = DepthTo::Full,
                Some(("to", "point")) => feature.to = DepthTo::Point,
                _ => {
                    return Err(format!(
                        "'{word}' is not understood: a feature is its kind, diameter and depth, then to=full, \
                         angle=, pitch= or hand="
                    ));
                }
            }
        }
        Ok(feature)
    }

    /// Multiplies all lengths by a factor.
    pub(super) fn scale(&mut self, by: f64) {
        self.diameter *= by;
        self.depth = self.depth.map(|depth| depth * by);
        self.pitch = self.pitch.map(|pitch| pitch * by);
    }

    /// Parses the notation of a CSV cell in mm.
    #[cfg(test)]
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        Self::parse_in(1.0, text)
    }

    /// Checks the values; `walls` are the diameters below a countersink.
    pub(crate) fn check(&self, walls: &[f64]) -> Result<(), String> {
        let name = self.kind.name();
        let lengths = [
            Some(("diameter", self.diameter)),
            self.depth.map(|d| ("depth", d)),
            self.pitch.map(|p| ("pitch", p)),
        ];
        for (key, value) in lengths.into_iter().flatten() {
            if !(value.is_finite() && value > 0.0) {
                return Err(format!("the {key} of its {name} is {value}: a number above 0 is required"));
            }
        }
        if let Some(angle) = self.angle.filter(|angle| !(*angle > 0.0 && *angle < 180.0)) {
            return Err(format!("the angle of its {name} is {angle}: above 0 and below 180 degrees"));
        }
        let (is_cone, is_thread) = (self.kind == FeatureKind::Countersink, self.kind == FeatureKind::Tap);
        if is_cone && self.angle.is_none() {
            return Err("its countersink has no angle: give its full angle, such as 90".to_owned());
        }
        if self.angle.is_some() && !is_cone && self.kind != FeatureKind::Drill {
            return Err(format!("its {name} has an angle: only a countersink and a drill's point have one"));
        }
        if is_thread != self.pitch.is_some() {
            return Err(match is_thread {
                true => "its tap has no pitch: give it in mm".to_owned(),
                false => format!("its {name} has a pitch: only a tap has one"),
            });
        }
        if self.hand == Hand::Left && !is_thread {
            return Err(format!("its {name} has a hand: only a tap has one"));
        }
        match self.depth {
            None if !is_cone => Err(format!("its {name} has no depth")),
            Some(depth) if is_cone => self.check_cone(depth, walls),
            _ => Ok(()),
        }
    }

    /// Checks the stated depth of a cone: to its point, or to a wall of the hole below it.
    fn check_cone(&self, depth: f64, walls: &[f64]) -> Result<(), String> {
        let slope = Deg(self.angle.unwrap_or(90.0) / 2.0).tan();
        let to = |wall: f64| (self.diameter - wall) / 2.0 / slope;
        if walls.iter().chain(&[0.0]).any(|wall| !exceeds((to(*wall) - depth).abs(), CONE_TOLERANCE)) {
            return Ok(());
        }
        let (wall, point) = (to(walls.iter().copied().reduce(f64::min).unwrap_or(0.0)), to(0.0));
        Err(format!(
            "its countersink Φ{} of {}° is {wall:.3} mm deep to the wall and {point:.3} mm to its point, not {depth}: \
             correct one of them, or leave the depth out",
            self.diameter,
            self.angle.unwrap_or(90.0)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_of_a_list_has_kind_diameter_depth_and_keys() {
        let cells = ["tap 10 22 pitch=1.5", "tap 8 9.5 pitch=1.25 hand=left", "countersink 12 angle=90"];
        for cell in cells.into_iter().chain(["drill 8.5 30 to=full angle=118", "ream 9 20"]) {
            assert_eq!(Feature::parse(cell).unwrap().cell(), cell);
        }
        let feature = Feature::parse("tap 10 22 pitch=1.5").unwrap();
        assert_eq!((feature.kind, feature.diameter, feature.depth), (FeatureKind::Tap, 10.0, Some(22.0)));
        assert_eq!((feature.pitch, feature.hand), (Some(1.5), Hand::Right));
        assert_eq!(Feature::parse("tap M10 22").unwrap(), feature);
        assert_eq!(Feature::parse("tap 10 22 pitch=1.5 hand=left").unwrap().hand, Hand::Left);
        assert_eq!(Feature::parse("drill 8.5 30 to=full").unwrap().to, DepthTo::Full);
        for (text, expected) in [
            ("bored 8 3", "'bored' is no kind of feature"),
            ("drill", "a feature needs its diameter"),
            ("drill 8,5 30", "'8,5' is not a number"),
            ("drill 8.5 30 40", "'40' is not understood"),
            ("drill 8.5 30 to=tip", "'to=tip' is not understood"),
        ] {
            let found = Feature::parse(text).unwrap_err();
            assert!(found.starts_with(expected), "{text}: {found}");
        }
    }

    /// Φ12 at 90° over Φ6 and Φ8: to the walls (12 − 6)/2/tan 45° = 3 and 2, to the point 12/2/tan 45° = 6. At 82° over Φ6:
    /// 3/tan 41° = 3.451.
    #[test]
    fn a_countersinks_depth_is_that_of_its_cone() {
        let check = |text: &str| Feature::parse(text).unwrap().check(&[6.0, 8.0]);
        for right in [
            "countersink 12 angle=90",
            "countersink 12 3 angle=90",
            "countersink 12 2 angle=90",
            "countersink 12 6.1 angle=90",
        ] {
            assert_eq!(check(right), Ok(()), "{right}");
        }
        assert!((Feature::parse("countersink 12 angle=90").unwrap().bottom() - 6.0).abs() < 1e-12);
        assert_eq!(check("countersink 12 3.451 angle=82"), Ok(()));
        let wrong = check("countersink 12 3.2 angle=90").unwrap_err();
        assert!(wrong.contains("3.000 mm deep to the wall and 6.000 mm to its point, not 3.2"), "{wrong}");
    }

    #[test]
    fn a_feature_has_the_values_of_its_kind() {
        for (text, expected) in [
            ("tap 10 22", "its tap has no pitch"),
            ("drill 8 22 pitch=1", "its drill has a pitch"),
            ("drill 8 22 hand=left", "its drill has a hand"),
            ("drill 8", "its drill has no depth"),
            ("countersink 12 3", "its countersink has no angle"),
            ("ream 8 20 angle=90", "its ream has an angle"),
            ("drill 0 20", "the diameter of its drill is 0"),
            ("drill 8 20 angle=180", "the angle of its drill is 180"),
        ] {
            let found = Feature::parse(text).unwrap().check(&[]).unwrap_err();
            assert!(found.starts_with(expected), "{text}: {found}");
        }
    }
}
