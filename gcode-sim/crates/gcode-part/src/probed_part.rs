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
