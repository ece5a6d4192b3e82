//! Use of the axis words of a block: by one code in place of a move, or by two whose meaning together is known.
use gcode_lang::program::g_codes::OneShot;
use gcode_lang::program::modes::Distance;

/// Use of the axis words of a block by a code instead of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AxisWordUse {
    OneShot(OneShot),
    AdditionalWork,
    Scale,
    Mirror {
        is_on: bool,
    },
    Rotate,
    Tilt,
    PolarInterpolation {
        is_on: bool,
    },
    /// Limits of G22, which move nothing.
    Limits,
}

impl AxisWordUse {
    /// Returns true if two uses are these, in any order.
    pub(super) fn is_pair_with(self, other: Self, pair: [Self; 2]) -> bool {
        [self, other] == pair || [other, self] == pair
    }

    /// Returns true for a tilted plane, and a code that points the tool along it.
    pub(super) fn is_plane_and_tool_axis(self, other: Self) -> bool {
        let points = |other| matches!(other, Self::OneShot(OneShot::ToolAxis { .. }));
        self == Self::Tilt && points(other) || other == Self::Tilt && points(self)
    }

    /// Returns true if axis words in this mode are coordinates of the work coordinate system, and not of the machine or distances of
    /// the point through which an axis goes to a reference position.
    pub(super) fn takes_work_coordinates(self, distance: Distance) -> bool {
        match self {
            Self::OneShot(OneShot::MachineCoordinateSystem) => false,
            Self::OneShot(OneShot::Reference | OneShot::SecondReference) => distance == Distance::Absolute,
            _ => true,
        }
    }

    /// Returns true if the block's P can be that of a work coordinate system.
    pub(super) fn leaves_p(self) -> bool {
        match self {
            Self::Rotate | Self::Mirror { .. } => true,
            Self::OneShot(one) => matches!(
                one,
                OneShot::Skip
                    | OneShot::Measure(_)
                    | OneShot::MachineCoordinateSystem
                    | OneShot::Reference
                    | OneShot::CheckReference
                    | OneShot::FromReference
            ),
            Self::AdditionalWork
            | Self::Scale
            | Self::Tilt
            | Self::PolarInterpolation { .. }
            | Self::Limits => false,
        }
    }
}

/// Different uses that the codes of a block make of its axis words.
#[derive(Debug, Default)]
pub(super) struct AxisWordUses {
    pub(super) first: Option<AxisWordUse>,
    pub(super) second: Option<AxisWordUse>,
    pub(super) has_third: bool,
}

impl AxisWordUses {
    /// Adds the use of a further code.
    pub(super) fn add(&mut self, new: Option<AxisWordUse>) {
        let Some(new) = new else { return };
        match (self.first, self.second) {
            (None, _) => self.first = Some(new),
            (Some(first), None) if first != new => self.second = Some(new),
            (Some(first), Some(second)) => self.has_third |= first != new && second != new,
            (Some(_), None) => {}
        }
    }
}
