//! One case of a proof: the call of the macro for one direction and one tool, with the quantities that are left open.
use std::time::Duration;

use gcode_control::Limits;
use gcode_inspect::machine::Machine;
use gcode_lang::control::Settings;
use gcode_lang::motion::MAX_AXES;
use gcode_part::job::{AxisDirection, HeadKind, HoleSpec, PinHoles, Tool};
use gcode_prove::{Ask, ClaimVerdict, Watch, prove, trace};
use gcode_session::Request;

use super::ProofRequest;
use super::boxes::CaseBounds;
use super::controls::Controls;
use super::hole_path::PinAxes;
use super::position::NominalHole;
use super::quantity_range::{Quantity, QuantityRange};
use super::report::{CaseReport, ClaimReport, Point, RangeReport, named, ranges_of};
use super::sample::{SampledHole, sampled};
use super::statements::Statements;
use crate::families::hole_arguments;
use crate::nc::number;

/// Case of a proof.
pub(super) struct Case<'a> {
    pub(super) request: &'a ProofRequest<'a>,
    pub(super) job: &'a PinHoles,
    pub(super) hole: &'a HoleSpec,
    pub(super) tool: &'a Tool,
    pub(super) overs: &'a [QuantityRange],
    pub(super) tolerances: &'a [f64],
    /// Time since the start at which the case ends.
    pub(super) limit: Duration,
}

/// Blocks of the request around those of the macro: the call and M30.
const OWN_BLOCKS: u64 = 2;

/// Largest coordinate of a start, mm.
const START: f64 = 10_000.0;

/// Largest number of blocks of a run.
const MAX_BLOCKS: u64 = 100_000;

impl Case<'_> {
    /// Proves the claims of the case.
    pub(super) fn prove(&self) -> Result<CaseReport, String> {
        let machine = Machine::parse(&self.request.package.machine).map_err(|error| error.to_string())?;
        let request = Request::new("O9000.nc", *b"O9000\nM30\n", machine);
        let controls = Controls { request, call: Some(self.call()), programs: self.request.package };
        let mut claims = self.positions(&controls)?;
        claims.extend(self.statements(&controls)?);
        let axis = match self.hole.axis {
            AxisDirection::Normal => "normal",
            AxisDirection::Axial => "axial",
        };
        let tool = format!("T{} {}", self.tool.number, self.tool.name());
        Ok(CaseReport::new(format!("{axis} holes, {tool}"), self.call(), claims))
    }

    /// Returns the variable of a quantity; those of the macros' own are left alone.
    fn variable(&self, quantity: Quantity) -> u32 {
        let place = Quantity::ALL.iter().position(|one| *one == quantity).unwrap_or_default() as u32;
        let first = if (90..=120).contains(&self.job.macros.common) { 130 } else { 101 };
        first + place
    }

    /// Returns the variables of the start in X and Y.
    fn start_variables(&self) -> [u32; 2] {
        let last = self.variable(Quantity::ALL[Quantity::ALL.len() - 1]);
        [last + 1, last + 2]
    }

    /// Returns the macro's call with every quantity as a variable.
    fn call(&self) -> String {
        let word = |(letter, value): (char, f64)| match Quantity::ALL
            .into_iter()
            .find(|quantity| quantity.letter() == letter)
        {
            Some(quantity) => format!(" {letter}#{}", self.variable(quantity)),
            None => format!(" {letter}{}", number(value)),
        };
        let (program, arguments) = hole_arguments(self.job, self.tool, self.hole);
        format!("G65 P{program}{}", arguments.into_iter().map(word).collect::<String>())
    }

    /// Returns the limits of a quantity.
    fn limits(&self, quantity: Quantity) -> (f64, f64) {
        let over = self.overs.iter().find(|over| over.quantity == quantity);
        let value = quantity.of(self.job, self.hole);
        over.map_or((value, value), |over| (over.low, over.high))
    }

    fn is_over(&self) -> bool {
        (self.request.clock)() >= self.limit
    }

    /// Proves the position within each tolerance, its least bound, and the depth.
    fn positions(&self, controls: &Controls<'_>) -> Result<Vec<ClaimReport>, String> {
        let is_over = || self.is_over();
        let bounds = self.bounds(controls)?;
        let holes = sampled(self.job, self.hole, self.overs, self.request.package, &is_over);
        let worst_hole = holes.iter().max_by(|a, b| a.phi.total_cmp(&b.phi));
        if let (Some((_, bound)), Some(hole)) = (bounds.worst(), worst_hole)
            && hole.phi > bound.phi
        {
            return Err(format!(
                "the hole at {} is off by Φ{}, more than the bound Φ{}: report this fault",
                named(self.overs, &hole.values),
                hole.phi,
                bound.phi
            ));
        }
        let mut claims: Vec<_> =
            self.tolerances.iter().map(|tolerance| self.within(*tolerance, &bounds, &holes)).collect();
        if let Some((domain, bound)) = bounds.worst() {
            let least = rounded_up(bound.phi);
            claims.push(ClaimReport {
                claim: format!("position Φ{least}, the least bound"),
                verdict: ClaimVerdict::Proved,
                proved_share: 1.0,
                bound: Some(bound.phi),
                worst: Some(self.ranges(domain)),
                found: worst_hole.map(|hole| (hole.phi, self.point(&hole.values))),
                ..ClaimReport::default()
            });
            let depth = bounds.boxes.iter().filter_map(|(_, found)| found.map(|found| found.depth));
            let depth = depth.fold(0.0, f64::max);
            claims.push(ClaimReport {
                claim: format!("depth within {}", rounded_up(depth)),
                verdict: ClaimVerdict::Proved,
                proved_share: 1.0,
                bound: Some(depth),
                ..ClaimReport::default()
            });
        }
        claims.push(self.rapids(&bounds));
        Ok(claims)
    }

    /// Returns the claim on rapid moves.
    fn rapids(&self, bounds: &CaseBounds) -> ClaimReport {
        let (clearance, share) = bounds.clearance();
        let away = clearance.filter(|clearance| *clearance > 0.0);
        let words = away.map_or_else(
            || "rapids stay outside the part".to_owned(),
            |away| {
                format!(
                    "rapids go outwards first, then stay {} away from the part",
                    (away * 1e3).floor() / 1e3
                )
            },
        );
        let verdict = if away.is_some() { ClaimVerdict::Proved } else { ClaimVerdict::Undecided };
        let proved_share = if away.is_some() { 1.0 } else { share };
        ClaimReport { claim: words, verdict, proved_share, bound: away, ..ClaimReport::default() }
    }

    /// Bounds the position over all boxes.
    fn bounds(&self, controls: &Controls<'_>) -> Result<CaseBounds, String> {
        let watch = Watch::new(self.request.clock, self.limit);
        let mut request = controls.request.clone();
        // A rotary that rolls over ends whole turns away, in the same place.
        request.settings.rolls_over = [false; MAX_AXES];
        let axes = self.axes(&request.settings)?;
        let [x, y] = self.start_variables();
        let call = Some(format!("G90 G00 X#{x} Y#{y}\n{}", self.call()));
        let controls = Controls { request, call, programs: controls.programs };
        let range = |quantity: Quantity| {
            let (low, high) = self.limits(quantity);
            // A number is a range of two doubles, so that it stays a quantity of the formulas.
            let high = if low == high { high.next_up() } else { high };
            format!("#{}={low}..{high}", self.variable(quantity))
        };
        let mut ranges = Quantity::ALL.map(range).to_vec();
        // The tool starts anywhere.
        ranges.extend([x, y].map(|variable| format!("#{variable}=-{START}..{START}")));
        let limits = Limits { blocks: MAX_BLOCKS };
        let mut trace = trace(&controls, &ranges, limits, &watch).map_err(|error| error.to_string())?;
        let input = |quantity: Quantity| {
            let place = Quantity::ALL.iter().position(|one| *one == quantity);
            let node = place.and_then(|place| trace.inputs.get(place).copied().flatten());
            node.ok_or_else(|| format!("{} has no range", quantity.key()))
        };
        let nominal = NominalHole {
            a: input(Quantity::EquatorialRadius)?,
            b: input(Quantity::PolarRadius)?,
            radius: input(Quantity::Radius)?,
            azimuth: input(Quantity::Azimuth)?,
            depth: input(Quantity::Depth)?,
            axis: self.hole.axis,
            reach: self.job.machine.head.pivot + self.tool.length,
            tool_radius: self.tool.diameter / 2.0,
            heights: [self.job.machine.clearance(), self.job.machine.retract()],
            sign: f64::from(self.job.machine.rotary.sign),
        };
        let divided: Vec<usize> = (0..Quantity::ALL.len())
            .filter(|place| !matches!(Quantity::ALL[*place], Quantity::Azimuth))
            .collect();
        let tolerance = self.tolerances.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(CaseBounds::find(&mut trace, axes, &nominal, &divided, tolerance, &|| self.is_over()))
    }

    fn axes(&self, settings: &Settings) -> Result<PinAxes, String> {
        let find = |letter: char| {
            settings.axes.find(letter as u8).ok_or_else(|| format!("the control has no axis {letter}"))
        };
        let head = match self.job.machine.head.kind() {
            HeadKind::Manual => None,
            HeadKind::Axis(letter) => Some(find(letter)?),
        };
        let rotary = find(self.job.machine.rotary.letter)?;
        Ok(PinAxes { x: find('X')?, y: find('Y')?, z: find('Z')?, rotary, head })
    }

    /// Returns the claim of one tolerance.
    fn within(&self, tolerance: f64, bounds: &CaseBounds, holes: &[SampledHole]) -> ClaimReport {
        let broken = holes.iter().find(|hole| hole.phi > tolerance);
        let verdict = match broken {
            Some(_) => ClaimVerdict::Refuted,
            None if bounds.is_within(tolerance) => ClaimVerdict::Proved,
            None => ClaimVerdict::Undecided,
        };
        let is_undecided = verdict == ClaimVerdict::Undecided;
        ClaimReport {
            claim: format!("position Φ{tolerance}"),
            verdict,
            proved_share: bounds.share_within(tolerance),
            counterexample: broken.map(|hole| self.point(&hole.values)),
            found: broken.map(|hole| (hole.phi, self.point(&hole.values))),
            worst: bounds.largest_left(tolerance).filter(|_| is_undecided).map(|domain| self.ranges(domain)),
            reasons: if is_undecided { bounds.unfollowed.clone() } else { Vec::new() },
            ..ClaimReport::default()
        }
    }

    fn point(&self, values: &[f64]) -> Point {
        self.overs.iter().zip(values).map(|(over, value)| (over.quantity.key().to_owned(), *value)).collect()
    }

    /// Returns a box in the quantities that are left open.
    fn ranges(&self, domain: &gcode_enclosure::Domain) -> RangeReport {
        let range = |over: &QuantityRange| {
            let place = Quantity::ALL.iter().position(|one| *one == over.quantity)?;
            let range = domain.range(place);
            Some((over.quantity.key().to_owned(), [range.lo(), range.hi()]))
        };
        self.overs.iter().filter_map(range).collect()
    }

    /// Proves the alarms and the blocks that the macros state.
    fn statements(&self, controls: &Controls<'_>) -> Result<Vec<ClaimReport>, String> {
        let stated = Statements::of(self.request.package);
        // Pecks add blocks to those that the remarks state.
        let stated = Statements { blocks: stated.blocks.filter(|_| self.tool.peck.is_none()), ..stated };
        let alarms = stated.alarms.join("|");
        let mut texts =
            vec![if alarms.is_empty() { "no-alarm".to_owned() } else { format!("alarm {alarms}") }];
        texts.extend(stated.blocks.map(|blocks| format!("blocks LE {}", blocks + OWN_BLOCKS)));
        let range = |quantity: Quantity| {
            let (low, high) = self.limits(quantity);
            format!("#{}={low}..{high}", self.variable(quantity))
        };
        let ask = Ask {
            ranges: Quantity::ALL.map(range).to_vec(),
            claims: texts,
            max_blocks: MAX_BLOCKS,
            threads: self.request.threads,
            ..Ask::default()
        };
        let watch = Watch::new(self.request.clock, self.limit);
        let answer = prove(controls, &ask, &watch).map_err(|error| error.to_string())?;
        let shown = |index: usize| match (index, stated.blocks) {
            (1, Some(blocks)) => format!("at most {blocks} blocks a hole, as the remarks say"),
            _ => format!("no alarms but those of the remarks, {}", ranges_of(&stated.alarms)),
        };
        let quantity_of = |variable: u32| {
            let found = Quantity::ALL.into_iter().find(|quantity| self.variable(*quantity) == variable);
            found.map_or_else(|| format!("#{variable}"), |quantity| quantity.key().to_owned())
        };
        let claims = answer.claims.iter().enumerate().map(|(index, claim)| ClaimReport {
            claim: shown(index),
            verdict: claim.verdict,
            proved_share: if claim.verdict == ClaimVerdict::Proved {
                1.0
            } else {
                1.0 - answer.undecided_share
            },
            counterexample: claim.counterexample.as_ref().map(|values| {
                values.iter().map(|(variable, value)| (quantity_of(*variable), *value)).collect()
            }),
            reasons: if claim.verdict == ClaimVerdict::Undecided {
                answer.unfollowed.clone()
            } else {
                Vec::new()
            },
            ..ClaimReport::default()
        });
        Ok(claims.collect())
    }
}

/// Returns a bound with four digits, not below it.
fn rounded_up(bound: f64) -> f64 {
    let scaled = (bound * 1e5).ceil();
    // The quotient is the double next to a number of five decimals, which may lie below the bound by rounding alone.
    let value = scaled / 1e5;
    if value < bound { (scaled + 1.0) / 1e5 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_is_never_rounded_down() {
        assert_eq!(rounded_up(0.019_271), 0.01928);
        assert_eq!(rounded_up(0.019_27), 0.01927);
        assert!([1e-9, 0.1 + 1e-17, 0.034_91].into_iter().all(|bound| rounded_up(bound) >= bound));
    }
}
