//! Kinds of tools and the shape of their ends.
use gcode_lang::units::Deg;
use gcode_part::FeatureKind;

use super::Tool;

/// Kind of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolKind {
    /// Twist drill.
    Drill,
    /// Spot drill or centre drill.
    SpotDrill,
    /// Countersink.
    Countersink,
    /// Counterbore with a flat end.
    Counterbore,
    /// End mill with a flat end.
    EndMill,
    /// Reamer.
    Reamer,
    /// Boring bar.
    BoringBar,
    /// Tap.
    Tap,
    /// Touch probe, which cuts nothing.
    Probe,
}

/// End of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PointShape {
    /// The full diameter reaches to the tip.
    Flat,
    /// A cone of this full angle.
    Pointed(Deg),
    /// The machine file gives neither kind nor angle.
    Unknown,
}

impl ToolKind {
    /// Kinds with their names in the machine file.
    pub(crate) const NAMES: [(&'static str, Self); 9] = [
        ("drill", Self::Drill),
        ("spot-drill", Self::SpotDrill),
        ("countersink", Self::Countersink),
        ("counterbore", Self::Counterbore),
        ("end-mill", Self::EndMill),
        ("reamer", Self::Reamer),
        ("boring-bar", Self::BoringBar),
        ("tap", Self::Tap),
        ("probe", Self::Probe),
    ];

    /// Returns the name in the machine file.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, kind)| *kind == self).map_or("tool", |(name, _)| name)
    }

    /// Returns true for a tool that cuts with its end alone.
    pub(crate) fn cuts_with_end(self) -> bool {
        matches!(self, Self::Drill | Self::Reamer | Self::BoringBar | Self::Tap)
    }

    /// Returns true for a tool that only widens or threads a hole.
    pub(crate) fn needs_hole(self) -> bool {
        matches!(self, Self::Reamer | Self::BoringBar | Self::Tap)
    }

    /// Returns true if a tool of this kind can make the feature.
    pub(crate) fn can_make(self, feature: FeatureKind) -> bool {
        match self {
            Self::Drill => feature == FeatureKind::Drill,
            Self::SpotDrill | Self::Countersink => feature == FeatureKind::Countersink,
            Self::Counterbore | Self::EndMill | Self::BoringBar => {
                matches!(feature, FeatureKind::Drill | FeatureKind::Bore | FeatureKind::Counterbore)
            }
            Self::Reamer => matches!(feature, FeatureKind::Drill | FeatureKind::Ream),
            Self::Tap => feature == FeatureKind::Tap,
            Self::Probe => false,
        }
    }
}

impl Tool {
    /// Returns the shape of the end: that of the file, or 90° of a spot drill or countersink.
    pub(crate) fn point(&self) -> PointShape {
        match (self.point_angle, self.kind) {
            (Some(angle), _) if angle.0 < 180.0 => PointShape::Pointed(angle),
            (Some(_), _) => PointShape::Flat,
            (None, Some(ToolKind::SpotDrill | ToolKind::Countersink)) => PointShape::SPOT_DRILL,
            (None, Some(ToolKind::Drill) | None) => PointShape::Unknown,
            (None, Some(_)) => PointShape::Flat,
        }
    }
}

/// Returns `T1`; `the tool` before the first tool change.
pub(crate) fn tool_name(tool: Option<u32>) -> String {
    tool.map_or("the tool".to_owned(), |number| format!("T{number}"))
}

impl PointShape {
    /// End of a drill for which the machine file has no angle: 118°.
    pub(crate) const DRILL: Self = Self::Pointed(Deg(118.0));

    /// End of a spot drill or countersink for which it has none: 90°.
    pub(crate) const SPOT_DRILL: Self = Self::Pointed(Deg(90.0));

    /// Returns the length of the end below the full diameter, mm; `None` if unknown.
    pub(crate) fn length(self, diameter: f64) -> Option<f64> {
        match self {
            Self::Flat => Some(0.0),
            Self::Pointed(angle) => Some(diameter / 2.0 / Deg(angle.0 / 2.0).tan()),
            Self::Unknown => None,
        }
    }
}
