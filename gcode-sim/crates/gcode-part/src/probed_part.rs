//! The part that a touch probe touches, from a job file or a list of holes and the stock of the machine file.
use nalgebra::{Point3, Unit, Vector3};

use super::feature::{Feature, FeatureKind};
use super::hole::{Hole, SAME_LEVEL};
use super::nominal::NominalPart;
use super::part_solid::PartSolid;
use super::reference::Reference;
use super::solid::Rod;
use super::stock::Stock;
use super::surface::Surface;
use crate::job::{Honeycomb, Job, Rotary};
use crate::reader::FileError;

/// Depth of an internal thread, in pitches: the crests are on a diameter that is smaller by twice 5/8 of its height of √3/2.
const THREAD_DEPTH: f64 = 0.541_265_877_365_274_6;

/// Length by which a hole leads out of an endless body, mm.
const OUT: f64 = 1e4;

/// A part for touch probes.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbedPart {
    /// The part.
    pub solid: PartSolid,
    /// Radius of the stylus ball, mm; `None` if the job has none.
    pub radius: Option<f64>,
    /// Rotary axis of programs that measure while it rotates; `None` for other families.
    pub rotary: Option<Rotary>,
}

impl ProbedPart {
    /// Parses a job file or a list of holes; `of_machine` is the stock of the machine file.
    ///
    /// The part of an alignment is its ellipsoid. Other parts are the stock, or else the surface of the job; the holes of a list are
    /// in it, those of a job are what its program makes.
    ///
    /// # Errors
    /// An invalid file, a part without a surface and without stock, and holes without a diameter or a depth.
    pub fn parse(text: &str, of_machine: Option<&Stock>) -> Result<Self, FileError> {
        let job = NominalPart::job(text)?;
        if let Some(Job::Alignment(job)) = job {
            let solid = Surface::Ellipsoid { a: job.surface.a, b: job.surface.b }.into();
            return Ok(Self { solid, radius: Some(job.probe.radius), rotary: Some(job.machine.rotary) });
        }
        let (own, reference) = match &job {
            Some(Job::Honeycomb(job)) => (Some(tube(job)), None),
            Some(job) => (surface(job)?.map(PartSolid::from), None),
            None => (None, NominalPart::parse(text)?.into_holes()),
        };
        let refused = |message: String| FileError { line: None, message };
        let stock = reference.as_ref().and_then(|reference| reference.stock.as_ref()).or(of_machine);
        let solid = match stock {
            Some(stock) => of_stock(stock, own),
            None => own.ok_or_else(|| {
                "this part has no surface to probe: give [stock] in the machine file".to_owned()
            }),
        };
        let mut solid = solid.map_err(refused)?;
        if let Some(reference) = reference {
            let voids = hole_voids(&reference, &solid.body()).map_err(refused)?;
            let voids = solid.voids().iter().copied().chain(voids).collect();
            solid = PartSolid::new(solid.body(), voids).ok_or_else(|| refused(ELLIPSOID.to_owned()))?;
        }
        Ok(Self { solid, radius: None, rotary: None })
    }
}

const ELLIPSOID: &str = "a probe follows no void in an ellipsoid: state the stock as a box or a cylinder";

/// Returns the stock, where it has a body of its own, or the voids of the stock in the own body of a job.
fn of_stock(stock: &Stock, own: Option<PartSolid>) -> Result<PartSolid, String> {
    let Some(body) = stock.body(own.as_ref().map(PartSolid::body)) else {
        return Err(
            "the [stock] is the surface of the reference, and this part has none: give a box or a cylinder"
                .to_owned(),
        );
    };
    let of_own = own.filter(|own| own.body() == body);
    let voids = of_own.iter().flat_map(|own| own.voids().to_vec()).chain(stock.voids()).collect();
    PartSolid::new(body, voids).ok_or_else(|| ELLIPSOID.to_owned())
}

/// Returns the surface of a job.
fn surface(job: &Job) -> Result<Option<Surface>, FileError> {
    Ok(NominalPart::from_job(job)?.into_holes().and_then(|reference| reference.surface))
}

/// Returns the cylinder of a honeycomb with its ends and its bore.
fn tube(job: &Honeycomb) -> PartSolid {
    let (base, axis, length) = (Point3::origin(), Vector3::x_axis(), job.cylinder.length);
    let along = |diameter: f64| Surface::Rod(Rod { base, axis, length, radius: diameter / 2.0 });
    let bore = (0.0 < job.cylinder.bore).then(|| along(job.cylinder.bore));
    let body = along(job.cylinder.outer());
    PartSolid::new(body, bore.into_iter().collect()).unwrap_or(body.into())
}

/// Returns the cylinders of the holes of a list, from their bottoms until they are out of the body: a tool comes from there.
fn hole_voids(reference: &Reference, body: &Surface) -> Result<Vec<Surface>, String> {
    let [low, high] = body.bounds();
    let extent = (high - low).norm();
    let out = if extent.is_finite() { extent } else { OUT };
    let mut voids = Vec::new();
    for (index, hole) in reference.holes.iter().enumerate() {
        let id = hole.id.as_deref().unwrap_or_default();
        if reference.open_depths.contains(&index) {
            return Err(format!("hole {id} has no depth: a hole to probe needs one"));
        }
        let sizes =
            sizes(hole).ok_or_else(|| format!("hole {id} has no diameter: a hole to probe needs one"))?;
        let axis = Unit::new_normalize(Vector3::from(hole.axis));
        voids.extend(sizes.into_iter().map(|(diameter, depth)| {
            let is_through = hole.through && hole.depth - SAME_LEVEL <= depth;
            let depth = depth + if is_through { SAME_LEVEL } else { 0.0 };
            let base = Point3::from(hole.entry) - axis.into_inner() * depth;
            Surface::Rod(Rod { base, axis, length: depth + out, radius: diameter / 2.0 })
        }));
    }
    Ok(voids)
}

/// Returns diameters and depths of the cylinders of a hole, without its countersinks; `None` without any.
fn sizes(hole: &Hole) -> Option<Vec<(f64, f64)>> {
    let is_cylinder = |feature: &&Feature| feature.kind != FeatureKind::Countersink;
    let size = |feature: &Feature| {
        let crests = match feature.kind {
            FeatureKind::Tap => 2.0 * THREAD_DEPTH * feature.pitch.unwrap_or(0.0),
            _ => 0.0,
        };
        (feature.diameter - crests, feature.bottom())
    };
    let of_features: Vec<_> = hole.features.iter().filter(is_cylinder).map(size).collect();
    match of_features.is_empty() {
        false => Some(of_features),
        true => hole.diameter.map(|diameter| vec![(diameter, hole.depth)]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLATE: &str = r#"{"kind": "box", "min": [0, 0, -20], "max": [100, 50, 0]}"#;

    fn stock(text: &str) -> Stock {
        serde_json::from_str(text).unwrap()
    }

    fn distance(part: &ProbedPart, p: [f64; 3]) -> f64 {
        part.solid.nearest(&Point3::from(p)).distance
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
    }

    /// A bore Φ30 through the plate with a counterbore Φ40, 6 deep, and a blind M10×1.5, whose crests are on 10 − 1.0825·1.5 = 8.376.
    #[test]
    fn the_holes_of_a_list_are_open_in_the_stock() {
        let text = r#"{"unit": "mm", "holes": [
            {"entry": [30, 25, 0], "axis": [0, 0, 1], "depth": 20, "through": true,
             "features": [{"kind": "bore", "diameter": 30, "depth": 20}, {"kind": "counterbore", "diameter": 40, "depth": 6},
                          {"kind": "countersink", "diameter": 44, "angle": 90}]},
            {"entry": [80, 25, 0], "axis": [0, 0, 1], "features": [{"kind": "tap", "diameter": 10, "depth": 12, "pitch": 1.5}]}]}"#;
        let part = ProbedPart::parse(text, Some(&stock(PLATE))).unwrap();
        near(distance(&part, [30.0, 25.0, -12.0]), 15.0);
        near(distance(&part, [47.0, 25.0, -3.0]), 3.0);
        near(distance(&part, [47.0, 25.0, -5.5]), 0.5);
        near(distance(&part, [30.0, 25.0, -20.0]), 15.0);
        near(distance(&part, [80.0, 25.0, -4.0]), 5.0 - 0.625 * 3.0_f64.sqrt() / 2.0 * 1.5);
        near(distance(&part, [80.0, 25.0, -11.0]), 1.0);
        near(distance(&part, [80.0, 25.0, -14.0]), -2.0);
    }

    /// A hole whose axis leans to +x: above the plane through its entry the metal is away too. Its mouth in the top is 6/0.8 = 7.5 long to
    /// both sides. 5 to the left of its centre the rim is 2.5 away: the wall that is nearer, 6 − 5·0.8 = 2, is above the top. To
    /// the right that wall is below it.
    #[test]
    fn an_oblique_hole_is_open_up_to_the_surface() {
        let text = "id,x,y,z,i,j,k,depth,diameter\nA,50,25,0,0.6,0,0.8,10,12\n";
        let part = ProbedPart::parse(text, Some(&stock(PLATE))).unwrap();
        near(distance(&part, [45.0, 25.0, -1e-9]), 2.5);
        near(distance(&part, [55.0, 25.0, -1e-9]), 2.0);
    }

    #[test]
    fn a_list_without_diameters_or_without_stock_is_refused() {
        let list =
            |columns: &str, values: &str| format!("id,x,y,z,i,j,k{columns}\nA,50,25,0,0,0,1{values}\n");
        let refusal = |text: &str, stock: Option<&Stock>| ProbedPart::parse(text, stock).unwrap_err().message;
        let plate = stock(PLATE);
        assert_eq!(
            refusal(&list(",depth", ",5"), Some(&plate)),
            "hole A has no diameter: a hole to probe needs one"
        );
        assert_eq!(
            refusal(&list(",diameter", ",5"), Some(&plate)),
            "hole A has no depth: a hole to probe needs one"
        );
        let whole = list(",depth,diameter", ",5,4");
        let surface = stock(r#"{"kind": "surface"}"#);
        assert!(refusal(&whole, None).ends_with("give [stock] in the machine file"));
        assert!(refusal(&whole, Some(&surface)).ends_with("give a box or a cylinder"));
    }

    /// The tube of the job has its bore and its ends; a stock of the machine file overrides it.
    #[test]
    fn a_honeycomb_is_a_tube_with_ends() {
        let text = "family = \"honeycomb\"\ncontrol = { dialect = \"fanuc-31i\", increment = \"IS-B\" }\n\
                    machine = { rotary = { letter = \"A\", sign = 1 } }\n\
                    cylinder = { diameter = 120.0, bore = 100.0, length = 180.0 }\n\
                    pattern = { pitch = 10.0, metric = \"arc\" }\ndrill = { diameter = 5.0, depth = 12.0 }\n\
                    tolerance = { position = 0.1 }\n";
        let part = ProbedPart::parse(text, None).unwrap_or_else(|error| panic!("{error}"));
        near(distance(&part, [90.0, 0.0, 0.0]), 50.0);
        near(distance(&part, [-7.0, 55.0, 0.0]), 7.0);
        near(distance(&part, [184.0, 63.0, 0.0]), 5.0);
        let part = ProbedPart::parse(text, Some(&stock(PLATE))).unwrap();
        near(distance(&part, [50.0, 25.0, 4.0]), 4.0);
    }
}
