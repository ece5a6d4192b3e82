//! The answer to a request: a verdict on each claim, and the bounds of variables.
use std::num::NonZeroUsize;
use std::sync::Arc;

use gcode_control::Control;
use gcode_control::symbolic::{SymbolicRun, Term};
use gcode_enclosure::Domain;
use gcode_lang::program::Library;
use schemars::JsonSchema;
use serde::Serialize;

use crate::points::Points;
use crate::region::ClaimSet;
use crate::request::{Claim, Range, RequestError, condition, parse_variable};
use crate::search::{Prober, spread_point};
use crate::shared::{Pending, Rest, Shared};
use crate::simplify::simplified;
use crate::tree::{Question, Tree};
use crate::variable_bounds::{Bound, Side, bound};
use crate::watch::{NO_TIME, Watch};
use crate::witness::Witness;
use crate::worker::{pending_box, starting_boxes};

/// Source of controls, one for every thread.
pub trait Setup: Sync {
    /// Library of called programs.
    type Library: Library;

    /// Returns a control before its first block, with further settings, key and value, or why there is none.
    fn control(&self, settings: &[(String, String)]) -> Result<Control, String>;

    /// Returns the library of called programs.
    fn library(&self) -> Self::Library;
}

/// Request as written.
#[derive(Clone, Debug)]
pub struct Ask {
    /// `#1=0.1..9.9`.
    pub ranges: Vec<String>,
    /// Conditions on the ranges, `#3 LE #1`.
    pub conditions: Vec<String>,
    /// Claims.
    pub claims: Vec<String>,
    /// Variables whose bounds are wanted, `#100`.
    pub bounds: Vec<String>,
    /// Limit of blocks of a run.
    pub max_blocks: u64,
    /// Number of threads.
    pub threads: NonZeroUsize,
    /// Part of each result by which the arithmetic of a control may be off from that of doubles, 0 to 0.001.
    pub widening: f64,
}

impl Default for Ask {
    fn default() -> Self {
        Self {
            ranges: Vec::new(),
            conditions: Vec::new(),
            claims: Vec::new(),
            bounds: Vec::new(),
            max_blocks: 10_000_000,
            threads: NonZeroUsize::MIN,
            widening: 0.0,
        }
    }
}

/// Error of a request that can't be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProveError {
    /// A text is unreadable.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// There is no control.
    #[error("{0}")]
    Setup(String),
}

/// Verdict on a claim, or on all of them; the greatest is the worst.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ClaimVerdict {
    /// It holds for all values of the ranges.
    Proved,
    /// Neither is known.
    #[default]
    Undecided,
    /// It fails at a point that the control has run.
    Refuted,
}

/// Answer to one claim.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimAnswer {
    /// Claim as written.
    pub claim: String,
    /// Verdict.
    pub verdict: ClaimVerdict,
    /// Values of the ranges' variables at which the claim fails.
    pub counterexample: Option<Vec<(u32, f64)>>,
}

/// Bounds of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariableBounds {
    /// Number of the variable.
    pub variable: u32,
    /// Bounds of every value at the end of a run; `None` if there is none, or something isn't followed.
    pub range: Option<(f64, f64)>,
}

/// Answer to a request.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofAnswer {
    /// Verdict on all claims.
    pub verdict: ClaimVerdict,
    /// Answers in the order of the claims.
    pub claims: Vec<ClaimAnswer>,
    /// Bounds in the order asked.
    pub bounds: Vec<VariableBounds>,
    /// Part of the volume in which a claim isn't decided.
    pub undecided_share: f64,
    /// Number of boxes examined.
    pub boxes: u64,
    /// Number of single runs.
    pub runs: u64,
    /// What depends on the ranges and isn't followed.
    pub unfollowed: Vec<String>,
    /// No run ends without an alarm, as far as is known: a condition at the end says nothing then.
    pub never_ends: bool,
    /// Variables of ranges on which nothing depends, if every claim is proved.
    pub unread: Vec<u32>,
}

/// Message of a thread that has panicked.
const FAULT: &str = "the proof has stopped with a fault of the program: report it";

/// Largest number of claims that are proved together.
const MAX_CLAIMS: usize = 60;

/// Largest part of a result by which it may be off.
const MAX_WIDENING: f64 = 1e-3;

/// Proves or refutes what is asked.
///
/// # Errors
/// [`ProveError`] if the request can't be used.
pub fn prove<S: Setup>(setup: &S, ask: &Ask, watch: &Watch<'_>) -> Result<ProofAnswer, ProveError> {
    let (question, claims) = read(setup, ask)?;
    let mut prover =
        Prover { setup, watch, threads: ask.threads.get(), question, read_inputs: 0, answer: empty(ask) };
    // Claims that aren't decided leave time for the bounds.
    watch.allow(if prover.question.bounds.is_empty() { 1000 } else { 600 });
    prover.prove_claims(&claims)?;
    watch.allow(1000);
    prover.prove_bounds()?;
    Ok(prover.conclude())
}

/// Reads a request: the question without its claims, and these.
fn read<S: Setup>(setup: &S, ask: &Ask) -> Result<(Question, Vec<Claim>), ProveError> {
    let ranges = read_ranges(setup, &ask.ranges)?;
    let refused = |text: &String| condition(text).map_err(|why| RequestError::Condition(text.clone(), why));
    let conditions = ask.conditions.iter().map(refused).collect::<Result<Vec<_>, _>>()?;
    let claims = ask.claims.iter().map(|text| Claim::parse(text)).collect::<Result<Vec<_>, _>>()?;
    let bounds = ask.bounds.iter().map(|text| parse_variable(text)).collect::<Result<Vec<_>, _>>()?;
    if claims.is_empty() && bounds.is_empty() {
        return Err(RequestError::NoQuestion.into());
    }
    check_bounds(setup, &bounds)?;
    if !(0.0..=MAX_WIDENING).contains(&ask.widening) {
        return Err(RequestError::Widening(ask.widening.to_string()).into());
    }
    let (max_blocks, widening) = (ask.max_blocks, ask.widening);
    let question = Question { ranges, conditions, claims: Vec::new(), bounds, max_blocks, widening };
    Ok((question, claims))
}

/// Reads ranges, each of another variable.
pub(crate) fn read_ranges<S: Setup>(setup: &S, texts: &[String]) -> Result<Vec<Range>, ProveError> {
    let ranges = texts.iter().map(|text| Range::parse(text)).collect::<Result<Vec<_>, _>>()?;
    for (index, range) in ranges.iter().enumerate() {
        if ranges[..index].iter().any(|other| other.variable == range.variable) {
            return Err(RequestError::RangeTwice(texts[index].clone()).into());
        }
    }
    check_ranges(setup, &ranges)?;
    Ok(ranges)
}

fn empty(ask: &Ask) -> ProofAnswer {
    let claim = |claim: &String| ClaimAnswer {
        claim: claim.clone(),
        verdict: ClaimVerdict::Proved,
        counterexample: None,
    };
    ProofAnswer {
        verdict: ClaimVerdict::Proved,
        claims: ask.claims.iter().map(claim).collect(),
        bounds: Vec::new(),
        undecided_share: 0.0,
        boxes: 0,
        runs: 0,
        unfollowed: Vec::new(),
        never_ends: false,
        unread: Vec::new(),
    }
}

/// Refuses ranges of variables that are neither local nor common.
fn check_ranges<S: Setup>(setup: &S, ranges: &[Range]) -> Result<(), ProveError> {
    let mut run = SymbolicRun::new(setup.control(&[]).map_err(ProveError::Setup)?);
    for range in ranges {
        let set = run.set_term(range.variable, Term::Number(range.low));
        set.map_err(|alarm| RequestError::Variable(range.variable, alarm.code().to_string()))?;
    }
    Ok(())
}

/// Refuses bounds of variables that no control has, or that aren't stored.
fn check_bounds<S: Setup>(setup: &S, bounds: &[u32]) -> Result<(), ProveError> {
    let mut run = SymbolicRun::new(setup.control(&[]).map_err(ProveError::Setup)?);
    for variable in bounds {
        let set = run.set_term(*variable, Term::Number(0.0));
        set.map_err(|alarm| RequestError::BoundsVariable(*variable, alarm.code().to_string()))?;
    }
    Ok(())
}

/// Runs points spread evenly over the ranges through the followed expressions, without any box; returns the number of those at
/// which a claim fails.
///
/// # Errors
/// [`ProveError`] if the request can't be used.
pub fn sample<S: Setup>(setup: &S, ask: &Ask, count: u32, watch: &Watch<'_>) -> Result<u32, ProveError> {
    let (question, claims) = read(setup, ask)?;
    let question = Arc::new(Question { claims, bounds: Vec::new(), ..question });
    let (domain, threads) = (question.domain(), ask.threads.get() as u32);
    let of_thread = |share: u32| -> Result<u32, ProveError> {
        let control = setup.control(&[]).map_err(ProveError::Setup)?;
        let mut tree = Tree::new(control, setup.library(), Arc::clone(&question));
        let (mut points, mut failed) = (Points::default(), 0);
        for index in (share..count).step_by(threads as usize) {
            let way = points.follow(&mut tree, &spread_point(&domain, index + 1), watch, |_, _| {});
            failed += u32::from(way.is_some_and(|way| way.failed != 0));
        }
        Ok(failed)
    };
    let of_thread = &of_thread;
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|share| scope.spawn(move || of_thread(share))).collect();
        let fault = |_| Err(ProveError::Setup(FAULT.to_owned()));
        workers.into_iter().map(|worker| worker.join().unwrap_or_else(fault)).sum()
    })
}

/// Work on a request.
struct Prover<'a, S> {
    setup: &'a S,
    watch: &'a Watch<'a>,
    threads: usize,
    /// Question without claims.
    question: Question,
    /// Inputs that some way reads, as bits.
    read_inputs: u64,
    answer: ProofAnswer,
}

impl<S: Setup> Prover<'_, S> {
    /// Proves the claims: those on stroke limits each on a control with these limits, all others together.
    fn prove_claims(&mut self, claims: &[Claim]) -> Result<(), ProveError> {
        let is_travel = |index: &usize| matches!(claims[*index], Claim::Travel(_));
        let (travels, others): (Vec<usize>, Vec<usize>) = (0..claims.len()).partition(is_travel);
        let is_blocks = |index: &usize| matches!(claims[*index], Claim::Blocks(_));
        let blocks: Vec<usize> = others.iter().copied().filter(is_blocks).collect();
        let mut others = others;
        if blocks.len() < others.len() {
            // A run that is too long need not be followed to its end.
            for group in blocks.chunks(MAX_CLAIMS) {
                self.work_on(claims, group, &[], false)?;
            }
            others.retain(|index| self.answer.claims[*index].verdict != ClaimVerdict::Refuted);
        }
        for group in others.chunks(MAX_CLAIMS) {
            self.work_on(claims, group, &[], true)?;
        }
        for index in travels {
            if let Claim::Travel(settings) = &claims[index] {
                self.work_on(claims, &[index], settings, true)?;
            }
        }
        Ok(())
    }

    /// Refutes claims, and proves them where `proves`.
    fn work_on(
        &mut self,
        claims: &[Claim],
        group: &[usize],
        settings: &[(String, String)],
        proves: bool,
    ) -> Result<(), ProveError> {
        let asked = group.iter().map(|index| claims[*index].clone()).collect();
        let question = Arc::new(Question { claims: asked, bounds: Vec::new(), ..self.question.clone() });
        let all: ClaimSet = (1 << group.len()) - 1;
        let shared = Shared::new(all);
        let whole = question.domain();
        let starts = starting_boxes(&mut self.tree(&question, settings)?, &whole);
        let share = 1.0 / starts.len() as f64;
        let start = |domain| Pending { volume: share, ..pending_box(domain, &whole, all) };
        if proves {
            shared.push(starts.into_iter().map(start));
        }
        let shares = self.threads as u32;
        let results = std::thread::scope(|scope| {
            let work = |share: u32| {
                let (this, question, shared) = (&*self, &question, &shared);
                scope.spawn(move || -> Result<(), ProveError> {
                    let mut prober = this.prober(question, shared, settings)?;
                    prober.search(share, shares);
                    if proves {
                        prober.work();
                    }
                    shared.note_read(prober.tree.nodes.read_inputs());
                    Ok(())
                })
            };
            let workers: Vec<_> = (0..shares).map(work).collect();
            workers
                .into_iter()
                .map(|worker| worker.join().unwrap_or_else(|_| Err(ProveError::Setup(FAULT.to_owned()))))
                .collect::<Vec<_>>()
        });
        results.into_iter().collect::<Result<(), _>>()?;
        let rest = shared.into_rest();
        if proves
            && !question.conditions.is_empty()
            && !rest.is_included
            && rest.boxes_left == 0
            && rest.refuted == 0
        {
            return Err(RequestError::NothingLeft.into());
        }
        self.take(&rest, group, &question, settings)
    }

    fn prober<'s>(
        &'s self,
        question: &Arc<Question>,
        shared: &'s Shared,
        settings: &[(String, String)],
    ) -> Result<Prober<'s, S::Library>, ProveError> {
        let tree = self.tree(question, settings)?;
        let witness = self.witness(question, settings)?;
        Ok(Prober::new(tree, witness, Arc::clone(question), shared, self.watch))
    }

    fn tree(
        &self,
        question: &Arc<Question>,
        settings: &[(String, String)],
    ) -> Result<Tree<S::Library>, ProveError> {
        let control = self.setup.control(settings).map_err(ProveError::Setup)?;
        Ok(Tree::new(control, self.setup.library(), Arc::clone(question)))
    }

    fn witness(
        &self,
        question: &Arc<Question>,
        settings: &[(String, String)],
    ) -> Result<Witness<S::Library>, ProveError> {
        let control = self.setup.control(settings).map_err(ProveError::Setup)?;
        Ok(Witness::new(control, self.setup.library(), Arc::clone(question)))
    }

    /// Takes the verdicts of a group.
    fn take(
        &mut self,
        rest: &Rest,
        group: &[usize],
        question: &Arc<Question>,
        settings: &[(String, String)],
    ) -> Result<(), ProveError> {
        let mut witness = self.witness(question, settings)?;
        for (bit, index) in group.iter().enumerate() {
            let found = rest.counterexamples.iter().find(|(claim, _)| *claim == bit);
            let answer = &mut self.answer.claims[*index];
            if let Some((_, point)) = found {
                let point = simplified(&mut witness, question, bit, point.clone(), self.watch);
                let values = question.ranges.iter().zip(point);
                answer.counterexample = Some(values.map(|(range, value)| (range.variable, value)).collect());
                answer.verdict = ClaimVerdict::Refuted;
            } else if rest.undecided >> bit & 1 == 1 || rest.disagreement.is_some() {
                answer.verdict = ClaimVerdict::Undecided;
            }
        }
        self.read_inputs |= rest.read_inputs;
        let asks_at_end = question.claims.iter().any(|claim| matches!(claim, Claim::Condition(_)));
        self.answer.never_ends |= asks_at_end && !rest.has_end;
        debug_assert_eq!(rest.refuted.count_ones() as usize, rest.counterexamples.len());
        self.answer.undecided_share = self.answer.undecided_share.max(rest.share);
        if let Some(point) = &rest.disagreement {
            self.answer.unfollowed.push(format!("the run at {point:?} isn't the one that is followed"));
            self.answer.undecided_share = 1.0;
        }
        for what in &rest.unfollowed {
            if !self.answer.unfollowed.contains(what) {
                self.answer.unfollowed.push(what.clone());
            }
        }
        Ok(())
    }

    fn prove_bounds(&mut self) -> Result<(), ProveError> {
        if self.question.bounds.is_empty() {
            return Ok(());
        }
        let question = Arc::new(self.question.clone());
        let domain = question.domain();
        let watch = self.watch;
        let (this, asked, whole) = (&*self, &question, &domain);
        let of_side = |side| -> Result<Vec<Bound>, ProveError> {
            let mut tree = this.tree(asked, &[])?;
            let starts = starting_boxes(&mut tree, whole);
            Ok((0..asked.bounds.len()).map(|index| bound(&mut tree, &starts, index, side, watch)).collect())
        };
        let (lower, upper) = std::thread::scope(|scope| {
            let lower = scope.spawn(|| of_side(Side::Lower));
            let upper = of_side(Side::Upper);
            (lower.join().unwrap_or_else(|_| Err(ProveError::Setup(FAULT.to_owned()))), upper)
        });
        let (lower, upper) = (lower?, upper?);
        for ((variable, lower), upper) in question.bounds.iter().zip(lower).zip(upper) {
            let range = match (lower, upper) {
                (Bound::Excluded, _) | (_, Bound::Excluded) if !question.conditions.is_empty() => {
                    return Err(RequestError::NothingLeft.into());
                }
                (Bound::Value(low), Bound::Value(high)) if low <= -f64::MAX || high >= f64::MAX => {
                    self.answer.unfollowed.push(format!("bounds of #{variable}: no finite ones are found"));
                    None
                }
                (Bound::Value(low), Bound::Value(high)) => Some((low, high)),
                (Bound::Unfollowed(what), _) | (_, Bound::Unfollowed(what)) => {
                    if !self.answer.unfollowed.contains(&what) {
                        self.answer.unfollowed.push(what);
                    }
                    None
                }
                (Bound::None | Bound::Excluded, _) | (_, Bound::None | Bound::Excluded) => None,
            };
            self.answer.bounds.push(VariableBounds { variable: *variable, range });
        }
        check_values(&self.answer.bounds, &domain, self.witness(&question, &[])?, watch)
            .map_or(Ok(()), |disagreement| Err(ProveError::Setup(disagreement)))
    }

    fn conclude(mut self) -> ProofAnswer {
        let without_claims =
            if self.answer.unfollowed.is_empty() { ClaimVerdict::Proved } else { ClaimVerdict::Undecided };
        self.answer.verdict =
            self.answer.claims.iter().map(|claim| claim.verdict).max().unwrap_or(without_claims);
        // Every way of a proof has been followed.
        if self.answer.verdict == ClaimVerdict::Proved && !self.answer.claims.is_empty() {
            let ranges = self.question.ranges.iter().enumerate();
            let is_unread = |(index, range): &(usize, &Range)| {
                range.low < range.high && self.read_inputs.checked_shr(*index as u32).unwrap_or(1) & 1 == 0
            };
            self.answer.unread = ranges.filter(is_unread).map(|(_, range)| range.variable).collect();
        }
        let has_nothing = self.answer.verdict == ClaimVerdict::Undecided && self.watch.ended_before_a_box();
        self.answer.boxes = self.watch.boxes();
        self.answer.runs = self.watch.runs();
        let is_unexplained = has_nothing && self.answer.unfollowed.is_empty();
        self.answer.unfollowed.extend(is_unexplained.then(|| NO_TIME.to_owned()));
        self.answer
    }
}

/// Compares bounds with runs of the control; returns what is wrong, which nothing ever should be.
fn check_values<L: Library>(
    bounds: &[VariableBounds],
    domain: &Domain,
    mut witness: Witness<L>,
    watch: &Watch,
) -> Option<String> {
    let mut points = (1..40).map(|index| spread_point(domain, index));
    points.find_map(|point| {
        let values = witness.run(&point, watch).values;
        let outside = bounds.iter().zip(values).find(|(bounds, value)| {
            let Some((low, high)) = bounds.range else { return false };
            value.is_some_and(|value| !(low..=high).contains(&value))
        });
        outside.map(|(bounds, value)| {
            format!("--bounds #{}: the run at {point:?} gives {value:?}: report this fault", bounds.variable)
        })
    })
}
