//! Outlines of nominal holes and of tools: radius by the depth below the nominal entry.
use gcode_lang::units::Deg;
use gcode_part::{Feature, FeatureKind, Hole, NOISE, exceeds};

use crate::machine::PointShape;

/// Nominal outline of a hole.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// Radius and depth of each cylinder, mm.
    cylinders: Vec<(f64, f64)>,
    /// Radius at the entry and loss of radius per mm of each cone.
    cones: Vec<(f64, f64)>,
}

/// Outline of what one pass of a tool removes.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutShape {
    /// Radius of the tool.
    pub radius: f64,
    /// Radius of the circle that its axis describes, mm; 0 of a stroke.
    pub path: f64,
    /// Depth at which the feed starts; negative above the entry.
    pub start: f64,
    /// Depth of the tip.
    pub tip: f64,
    /// End of the tool; an unknown one counts as flat.
    pub point: PointShape,
}

impl Outline {
    /// Returns the outline of a hole, its depths increased by `slack`; `None` if its diameter is unknown.
    pub(super) fn of(hole: &Hole, slack: f64) -> Option<Self> {
        let depth = |depth: f64| match hole.through && hole.depth <= depth + NOISE {
            true => f64::INFINITY,
            false => depth + slack,
        };
        if hole.features.is_empty() {
            let cylinders = vec![(hole.diameter? / 2.0, depth(hole.depth))];
            return Some(Self { cylinders, cones: Vec::new() });
        }
        let (mut cylinders, mut cones) = (Vec::new(), Vec::new());
        for feature in &hole.features {
            let radius = feature.diameter / 2.0;
            match (feature.kind, feature.angle) {
                (FeatureKind::Countersink, Some(angle)) => cones.push((radius, Deg(angle / 2.0).tan())),
                _ => cylinders.push((radius, depth(feature.bottom()))),
            }
        }
        Some(Self { cylinders, cones })
    }

    /// Returns the outline of a hole without its threads, of known diameter, pitch and depth. A thread without a hole of its own
    /// leaves the diameter less half its pitch, which a forming tap needs.
    pub(super) fn of_core(hole: &Hole, threads: &[(f64, f64, f64)], slack: f64) -> Option<Self> {
        let others = hole.features.iter().filter(|feature| feature.kind != FeatureKind::Tap);
        let mut features: Vec<Feature> = others.copied().collect();
        for (diameter, pitch, bottom) in threads {
            let is_core = |feature: &Feature| {
                let is_cylinder = feature.kind != FeatureKind::Countersink;
                is_cylinder && feature.diameter < *diameter && !exceeds(bottom - feature.bottom(), slack)
            };
            if !features.iter().any(is_core) {
                let (diameter, depth) = (diameter - pitch / 2.0, Some(*bottom));
                features.push(Feature { depth, diameter, ..Feature::of(FeatureKind::Bore) });
            }
        }
        let mut core = Self::of(&Hole { features, ..hole.clone() }, slack)?;
        // The edge of a countersink has the tolerance of its depth.
        core.cones.iter_mut().for_each(|(radius, slope)| *radius += slack * *slope);
        Some(core)
    }

    /// Returns the outline below the far side of a through hole, of the diameters that go through; `None` if they are unknown.
    pub(super) fn of_far_side(hole: &Hole) -> Option<Self> {
        let cylinders = match hole.features[..] {
            [] => vec![(hole.diameter? / 2.0, f64::INFINITY)],
            _ => {
                let through = hole.features.iter().filter(|feature| !exceeds(hole.depth, feature.bottom()));
                through.map(|feature| (feature.diameter / 2.0, f64::INFINITY)).collect()
            }
        };
        (!cylinders.is_empty()).then_some(Self { cylinders, cones: Vec::new() })
    }

    /// Returns the radius at a depth, the cylinders being those at the depth `within`.
    fn radius_at(&self, depth: f64, within: f64) -> f64 {
        let cylinders =
            self.cylinders.iter().filter(|(_, bottom)| within < *bottom).map(|(radius, _)| *radius);
        let cones = self.cones.iter().map(|(radius, slope)| radius - depth * slope);
        cylinders.chain(cones).fold(0.0, f64::max)
    }

    /// Returns the depth at which the outline ends.
    fn bottom(&self) -> f64 {
        let cones = self.cones.iter().map(|(radius, slope)| radius / slope);
        self.cylinders.iter().map(|(_, depth)| *depth).chain(cones).fold(0.0, f64::max)
    }

    /// Returns the least distance from a cut on the hole's axis to the outline, mm, negative if the cut is wider; infinite
    /// for a cut outside the depths of the hole.
    ///
    /// Both radii are linear between the ends of their pieces, so the least difference lies at one of these ends.
    pub(super) fn margin(&self, cut: &CutShape) -> f64 {
        let (top, bottom) = (cut.begin().max(0.0), cut.tip.min(self.bottom()));
        // A cone meets cylinders, and other cones: where both are as wide.
        let joints = self.cones.iter().enumerate().flat_map(|(index, (wide, slope))| {
            let cylinders = self.cylinders.iter().map(move |(radius, _)| (wide - radius) / slope);
            let others = self.cones[index + 1..].iter();
            cylinders.chain(others.map(move |(radius, other)| (wide - radius) / (slope - other)))
        });
        let ends = self.cylinders.iter().map(|(_, depth)| *depth).chain(joints).chain([cut.full_depth()]);
        let mut depths: Vec<f64> = ends.filter(|depth| top < *depth && *depth < bottom).collect();
        depths.extend([top, bottom]);
        depths.sort_by(f64::total_cmp);
        let pieces = depths.windows(2).filter(|piece| piece[0] < piece[1]);
        let margins = pieces.flat_map(|piece| {
            let within = f64::midpoint(piece[0], piece[1]);
            piece.iter().map(move |depth| self.radius_at(*depth, within) - cut.radius_at(*depth))
        });
        margins.fold(f64::INFINITY, f64::min)
    }
}

impl CutShape {
    /// Returns the depth of the full diameter.
    pub(super) fn full_depth(&self) -> f64 {
        self.tip - self.point.length(2.0 * self.radius).unwrap_or(0.0)
    }

    /// Returns the depth at which the feed begins to cut: a point also cuts above its tip, up to where it is as wide as the tool.
    fn begin(&self) -> f64 {
        self.start - self.point.length(2.0 * self.radius).unwrap_or(0.0)
    }

    /// Returns true if this cut removes all that another one on the same axis removes below the entry and above `floor`. An
    /// unknown end of this tool counts as that of a drill.
    pub(super) fn covers(&self, other: &Self, floor: f64) -> bool {
        let point = if self.point == PointShape::Unknown { PointShape::DRILL } else { self.point };
        let own = Self { point, ..*self };
        let (top, bottom) = (other.begin().max(0.0), other.tip.min(floor));
        let is_whole = own.path <= own.radius && own.begin() <= top && bottom <= own.tip + NOISE;
        let ends = [top, bottom, own.full_depth(), other.full_depth()];
        let mut depths = ends.into_iter().filter(|depth| top <= *depth && *depth <= bottom);
        is_whole && top < bottom && depths.all(|depth| other.radius_at(depth) <= own.radius_at(depth) + NOISE)
    }

    /// Returns the radius at a depth above the tip.
    fn radius_at(&self, depth: f64) -> f64 {
        let own = match self.point {
            PointShape::Pointed(angle) => {
                ((self.tip - depth) * Deg(angle.0 / 2.0).tan()).clamp(0.0, self.radius)
            }
            PointShape::Flat | PointShape::Unknown => self.radius,
        };
        self.path + own
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_part::NominalPart;

    fn outline_of(features: &str) -> Outline {
        let text = format!("id,x,y,z,i,j,k,depth,diameter,features\n1,0,0,0,0,0,1,15,,{features}\n");
        Outline::of(&NominalPart::parse(&text).unwrap().into_holes().unwrap().holes[0], 0.0).unwrap()
    }

    fn cut(diameter: f64, tip: f64, point: PointShape) -> CutShape {
        CutShape { radius: diameter / 2.0, path: 0.0, start: -2.0, tip, point }
    }

    /// Φ10×5 over Φ6×15. A flat Φ10 to 5 fits with 0; to 7 it is 2 mm wider than Φ6. A 90° point of Φ10 with its tip at 4
    /// has a radius of 4 at the entry: 1 mm to spare. At 9 its full diameter ends at 4, and at 5 it has a radius of 4: 1 mm
    /// wider than Φ6.
    #[test]
    fn margins_over_a_counterbore_are_those_computed_by_hand() {
        let outline = outline_of("drill 6 15; counterbore 10 5");
        let pointed = PointShape::Pointed(Deg(90.0));
        for (cut, expected) in [
            (cut(10.0, 5.0, PointShape::Flat), 0.0),
            (cut(10.0, 7.0, PointShape::Flat), -2.0),
            (cut(10.0, 4.0, pointed), 1.0),
            (cut(10.0, 9.0, pointed), -1.0),
            (cut(5.0, 15.0, PointShape::Unknown), 0.5),
            (CutShape { start: 6.0, ..cut(5.0, 15.0, PointShape::Flat) }, 0.5),
            (CutShape { start: 6.0, ..cut(10.0, 9.0, pointed) }, -1.0),
        ] {
            let margin = outline.margin(&cut);
            assert!((margin - expected).abs() < 1e-12, "{cut:?}: {margin}");
        }
    }

    /// A point of 118° of Φ10 with its tip at 20 has its full diameter to 20 - 5/tan 59° = 16.996: it covers a flat Φ10 to 16.9, and
    /// not to 17.1. One of 90°, Φ12, with its tip at 4 has a radius of 4 at the entry. A drill of Φ8 covers it nowhere; one of Φ8.1
    /// and a deep tip does. Below the far side of a through hole nothing is cut.
    #[test]
    fn a_cut_covers_what_lies_within_it() {
        let drill = cut(10.0, 20.0, PointShape::Pointed(Deg(118.0)));
        assert!(drill.covers(&cut(10.0, 16.9, PointShape::Flat), f64::INFINITY));
        assert!(!drill.covers(&cut(10.0, 17.1, PointShape::Flat), f64::INFINITY));
        assert!(drill.covers(&cut(10.0, 30.0, PointShape::Flat), 16.9));
        assert!(!cut(10.0, 20.0, PointShape::Unknown).covers(&cut(10.0, 17.1, PointShape::Flat), 20.0));
        let spot = cut(12.0, 4.0, PointShape::Pointed(Deg(90.0)));
        assert!(cut(8.1, 20.0, PointShape::Flat).covers(&spot, f64::INFINITY));
        assert!(!cut(7.9, 20.0, PointShape::Flat).covers(&spot, f64::INFINITY));
        let ring = CutShape { path: 6.0, ..cut(10.0, 20.0, PointShape::Flat) };
        assert!(!ring.covers(&spot, f64::INFINITY), "a core is left on its axis");
        let below = CutShape { start: 5.0, ..cut(10.0, 20.0, PointShape::Flat) };
        assert!(!below.covers(&spot, f64::INFINITY), "it begins in the hole");
        let inside = CutShape { start: 3.5, ..spot };
        assert!(
            !cut(7.9, 20.0, PointShape::Flat).covers(&inside, f64::INFINITY),
            "its cone cuts above its tip"
        );
    }

    /// A cone of Φ12 at 90° meets Φ6 at 3. A 90° tool with its tip at 6 fits exactly; a 120° tool with its tip at 3 has a
    /// radius of 3·tan 60° = 5.196 at the entry, where 6 is allowed: 0.804 to spare.
    #[test]
    fn margins_over_a_countersink_are_those_computed_by_hand() {
        let outline = outline_of("drill 6 15; countersink 12 angle=90");
        let pointed = |angle| PointShape::Pointed(Deg(angle));
        assert!(outline.margin(&cut(20.0, 6.0, pointed(90.0))).abs() < 1e-12);
        let wide = outline.margin(&cut(20.0, 3.0, pointed(120.0)));
        assert!((wide - 0.803_847_577_293_368).abs() < 1e-12, "{wide}");
        assert!((outline.margin(&cut(20.0, 7.0, pointed(90.0))) + 1.0).abs() < 1e-12);
        // Φ12 at 90° and Φ8 at 60° meet where 6 - d = 4 - d tan 30°, at d = 4.732 with a radius of 1.268. There a point of 75° with
        // its tip at 7 has (7 - 4.732) tan 37.5° = 1.740, and above it is narrower than the wide cone.
        let cones = outline_of("drill 1 15; countersink 12 angle=90; countersink 8 angle=60");
        let margin = cones.margin(&cut(20.0, 7.0, pointed(75.0)));
        assert!((margin - -0.472309430286).abs() < 1e-9, "{margin}");
        // Flat, Φ8 to 2: the cone has a radius of 4 there.
        assert!(outline.margin(&cut(8.0, 2.0, PointShape::Flat)).abs() < 1e-12);
    }
}
