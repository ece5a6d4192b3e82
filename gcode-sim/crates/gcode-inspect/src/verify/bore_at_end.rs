//! Holes that end in the wall of a bore across them, such as oil holes.
use nalgebra::{Point3, Unit, Vector3};

use super::bottom;
use super::matching::Comparison;
use crate::holes::ring;
use crate::machine::COS_30;
use gcode_part::{EntryPlanes, Hole, Rod, Taper};

/// Number of points on the wall of a hole.
const RIM_POINTS: u32 = 16;

/// Bore in which a hole ends. Depths count from the entry of the hole, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bore {
    /// Index of its nominal hole.
    pub index: usize,
    /// Depth from which on the whole rim of the hole is in it.
    pub opens: f64,
    /// Depth at which it ends, on the axis of the hole.
    pub ends: f64,
}

impl Comparison<'_> {
    /// Returns the diameter of a nominal hole; where the list has none, that of its finishing tool.
    fn made_diameter(&self, index: usize) -> Option<f64> {
        self.nominal[index].widest_diameter().or_else(|| self.actual[self.pair_of(index)?.actual].diameter)
    }

    /// Returns the largest diameter that a hole without one in the list has, mm.
    fn widest_open(&self) -> f64 {
        let open = || self.pairs.iter().filter(|pair| self.nominal[pair.nominal].widest_diameter().is_none());
        let widest = || open().filter_map(|pair| self.actual[pair.actual].diameter).fold(0.0, f64::max);
        *self.widest_open.get_or_init(widest)
    }

    /// Returns the nominal bore, as a cylinder, in whose wall a hole ends: an oil hole.
    pub(super) fn bore_at_end(&self, own: usize) -> Option<Bore> {
        let hole = &self.nominal[own];
        let margin = Vector3::repeat(self.widest_open() / 2.0);
        let collars = self.collars.get_or_init(|| EntryPlanes::of(self.nominal, self.tolerances.depth));
        let (out, end) = (Vector3::from(hole.axis), bottom(hole));
        let mut found = None;
        collars.around(&(end - margin), &(end + margin), &mut |index| {
            let rod = collars.collar(index).rod;
            let is_across = out.dot(&rod.axis).abs() < COS_30;
            let Some(diameter) = self.made_diameter(index).filter(|_| is_across && found.is_none()) else {
                return;
            };
            let bore = Rod { radius: diameter / 2.0, ..rod };
            let radius = self.made_diameter(own).unwrap_or(0.0) / 2.0;
            found = Bore::of(hole, radius, (&bore, index), self.tolerances.depth);
        });
        found
    }
}

impl Bore {
    /// Returns the bore if a hole ends in it, all round: its depth is that of the bore's wall, to a tolerance, or deeper.
    fn of(hole: &Hole, radius: f64, (bore, index): (&Rod, usize), tolerance: f64) -> Option<Self> {
        let out = Unit::new_normalize(Vector3::from(hole.axis));
        let entry = Point3::from(hole.entry);
        let along = out.dot(&bore.axis);
        let length = hole.depth + 2.0 * bore.radius / (1.0 - along * along).sqrt();
        let within = |offset: &Vector3<f64>| {
            let from = entry + offset;
            let to = from - out.into_inner() * (length + tolerance);
            let shares = bore.piece(&from, &to, (0.0, bore.length), Taper::cylinder(bore.radius))?;
            Some(shares.map(|share| share * (length + tolerance)))
        };
        let [begins, ends] = within(&Vector3::zeros())?;
        if hole.depth < begins - tolerance || ends < hole.depth {
            return None;
        }
        let mut opens = begins;
        for offset in ring(&out, &Vector3::zeros(), radius, RIM_POINTS) {
            opens = opens.max(within(&offset)?[0]);
        }
        (opens < ends).then_some(Self { index, opens, ends })
    }
}
