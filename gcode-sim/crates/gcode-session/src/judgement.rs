//! Judgement of a program: the one sequence from its run to its verdict, which every command, page, editor and test calls.
//!
//! **In:** a [`Request`] and a library of called programs; the nominal part with the tolerances to apply; a further event sink
//! and an observer of the blocks, both `&mut ()` where nothing else is recorded. **Out:** the run with what it makes, and the
//! verdict on it. Without a reference a run has no verdict: its findings are those of the run alone.
//!
//! The reference decides more than the comparison: the metal round its holes, the limits of its process and the axes by which
//! passes belong to one hole. Thus the same program without a reference may have other findings.
use super::{
    GrindingError, GrindingRun, Request, SessionError, Simulation, grind, simulate, simulate_observed,
};
use gcode_control::Observer;
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_inspect::verify::{Tolerances, Verdict, verify};
use gcode_lang::motion::EventSink;
use gcode_lang::program::Library;
use gcode_part::{Flutes, Metal, Reference};

impl Request {
    /// Returns the request with the limits of the process that a reference specifies.
    #[must_use]
    pub fn for_reference(&self, reference: &Reference) -> Self {
        Self { process_limits: reference.process_limits.clone(), ..self.clone() }
    }

    /// Returns true if the machine file states the length offset H of a number.
    pub(super) fn states_length(&self, h: u32) -> bool {
        self.machine.tools.iter().any(|tool| tool.number == h && tool.stated_length_offset().is_some())
    }

    /// Returns true if the machine file states the stock, so that the motion can be judged without a reference.
    pub fn can_judge_motion(&self) -> bool {
        self.machine.stock.as_ref().is_some_and(|stock| stock.body(None).is_some())
    }

    /// Returns what is known to be metal of a reference: its stock overrides that of the machine.
    pub fn metal(&self, reference: &Reference) -> Metal {
        reference.metal(self.machine.stock.as_ref())
    }
}

/// Returns the reference of a picture, a page or a sheet of a program for which none is named: that without holes, by which the
/// motion alone is judged. `None` if the machine file states no stock with a pocket, so that all milling would be an error, or if the
/// program makes holes: only a reference can judge them.
///
/// # Errors
/// [`SessionError`] if the run cannot begin.
pub fn motion_reference(
    request: &Request,
    library: &mut impl Library,
) -> Result<Option<Reference>, SessionError> {
    let has_pockets = request.machine.stock.as_ref().is_some_and(|stock| !stock.pockets().is_empty());
    if !has_pockets || !request.can_judge_motion() {
        return Ok(None);
    }
    let reference = Reference::without_holes();
    let simulation = simulate(request, library, request.metal(&reference))?;
    let (tolerances, memory) = (Tolerances::of(&reference, None), simulation.run.control.memory());
    let locate = |span| memory.locate(span);
    let verdict = verify(&simulation.extracted, &reference, tolerances, &request.machine, &locate);
    Ok(verdict.extra.is_empty().then_some(reference))
}

/// What the holes of a program are judged by.
#[derive(Clone, Copy, Debug)]
pub struct Criteria<'r> {
    /// The nominal holes.
    pub reference: &'r Reference,
    /// The tolerances to apply; by [`Criteria::of`] those of the reference.
    pub tolerances: Tolerances,
}

impl<'r> Criteria<'r> {
    /// Returns the criteria of a reference with its own tolerances.
    pub fn of(reference: &'r Reference) -> Self {
        Self { reference, tolerances: Tolerances::of(reference, None) }
    }
}

/// A run with its holes, and the verdict on them if there is a reference.
#[derive(Debug)]
pub struct HoleJudgement {
    /// The run and its holes.
    pub simulation: Simulation,
    /// The verdict; `None` without criteria.
    pub verdict: Option<Verdict>,
}

/// Runs a program and judges its holes; `sink` and `observer` record what else the caller shows.
///
/// # Errors
/// [`SessionError`] if the run cannot begin.
pub fn judge_holes<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    Criteria { reference, tolerances }: Criteria<'_>,
    sink: &mut S,
    observer: &mut impl Observer,
) -> Result<(Simulation, Verdict), SessionError> {
    let request = &request.for_reference(reference);
    let simulation = simulate_observed(request, library, request.metal(reference), sink, observer)?;
    let verdict = simulation.verify(reference, tolerances, request);
    Ok((simulation, verdict))
}

/// Runs a program, and judges its holes like [`judge_holes`] if there are criteria.
///
/// # Errors
/// [`SessionError`] if the run cannot begin.
pub fn simulate_judged<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    criteria: Option<Criteria<'_>>,
    sink: &mut S,
    observer: &mut impl Observer,
) -> Result<HoleJudgement, SessionError> {
    Ok(match criteria {
        Some(criteria) => {
            let (simulation, verdict) = judge_holes(request, library, criteria, sink, observer)?;
            HoleJudgement { simulation, verdict: Some(verdict) }
        }
        None => {
            let simulation = simulate_observed(request, library, None, sink, observer)?;
            HoleJudgement { simulation, verdict: None }
        }
    })
}

/// Runs a program and judges the flutes that it grinds.
///
/// # Errors
/// [`GrindingError`] if the machine is not a grinder for this burr or the run cannot begin.
pub fn judge_flutes(
    request: &Request,
    library: &mut impl Library,
    nominal: &Flutes,
) -> Result<(GrindingRun, FluteVerdict), GrindingError> {
    let grinding = grind(request, library, nominal)?;
    let verdict = grinding.verify(request);
    Ok((grinding, verdict))
}
