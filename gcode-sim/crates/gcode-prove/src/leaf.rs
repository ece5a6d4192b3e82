//! End of a way through a program, and what the claims and bounds are there.
use gcode_control::symbolic::Formula;
use gcode_control::{Control, Outcome};
use gcode_enclosure::{Condition, NodeId};
use gcode_lang::syntax::ast::BinaryOp;

use crate::nodes::Nodes;
use crate::request::Claim;

/// End of a way.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    pub(crate) end: End,
    pub(crate) blocks: u64,
    /// States of the claims, in their order.
    pub(crate) claims: Vec<ClaimState>,
    pub(crate) bounds: Vec<BoundState>,
}

/// How a run ends.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum End {
    /// The conditions exclude the values of this way.
    Excluded,
    /// M02, M30 or M99.
    Program,
    Alarm(String),
    /// A loop provably never ends.
    Endless,
    /// Something isn't followed, or a limit has cut off the run.
    Unfollowed(String),
}

impl End {
    /// Returns the end of a control's run.
    pub(crate) fn of(outcome: &Outcome, control: &Control) -> Self {
        match outcome {
            Outcome::End => Self::Program,
            Outcome::Alarm(stop) => Self::Alarm(stop.alarm.code().to_string()),
            Outcome::Limit if control.endless_loop().is_some() => Self::Endless,
            Outcome::Limit => Self::cut_off(control.blocks()),
        }
    }

    /// Returns the end of a run that a limit has cut off after some blocks: what it would have done isn't known.
    pub(crate) fn cut_off(blocks: u64) -> Self {
        Self::Unfollowed(format!("a run of more than {blocks} blocks"))
    }
}

/// State of a claim at the end of a way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ClaimState {
    Holds,
    Fails,
    Depends(NodeFormula),
    Unfollowed(String),
}

/// Condition over nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NodeFormula {
    Known(bool),
    Condition(Condition),
    Logic(BinaryOp, Box<Self>, Box<Self>),
}

/// Returns a formula over nodes.
pub(crate) fn node_formula(nodes: &mut Nodes, formula: &Formula) -> NodeFormula {
    match formula {
        Formula::Known(known) => NodeFormula::Known(*known),
        Formula::Compare(relation, left, right) => {
            NodeFormula::Condition(nodes.condition(*relation, *left, *right))
        }
        Formula::Logic(op, left, right) => {
            let (left, right) = (node_formula(nodes, left), node_formula(nodes, right));
            match (op, &left, &right) {
                (BinaryOp::And, NodeFormula::Known(true), _)
                | (BinaryOp::Or, NodeFormula::Known(false), _) => right,
                (BinaryOp::And, _, NodeFormula::Known(true))
                | (BinaryOp::Or, _, NodeFormula::Known(false)) => left,
                (BinaryOp::And, NodeFormula::Known(false), _)
                | (BinaryOp::And, _, NodeFormula::Known(false)) => NodeFormula::Known(false),
                (BinaryOp::Or, NodeFormula::Known(true), _) | (BinaryOp::Or, _, NodeFormula::Known(true)) => {
                    NodeFormula::Known(true)
                }
                _ => NodeFormula::Logic(*op, Box::new(left), Box::new(right)),
            }
        }
    }
}

/// State of a variable at the end of a way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BoundState {
    /// Vacant, or the run doesn't end.
    None,
    Node(NodeId),
    Unfollowed(String),
}

/// Returns the state of a claim that the end of a run decides.
pub(crate) fn state_at(claim: &Claim, end: &End, blocks: u64) -> ClaimState {
    let holds = match (claim, end) {
        (_, End::Excluded) => true,
        (Claim::Blocks(limit), End::Unfollowed(_)) if blocks > *limit => false,
        (_, End::Unfollowed(what)) => return ClaimState::Unfollowed(what.clone()),
        (Claim::Condition(_), End::Program) => return ClaimState::Unfollowed("a condition".to_owned()),
        (Claim::Condition(_), End::Alarm(_) | End::Endless) => true,
        (Claim::NoAlarm, end) => !matches!(end, End::Alarm(_)),
        (Claim::OnlyAlarms(codes), End::Alarm(code)) => codes.contains(code),
        (Claim::OnlyAlarms(_), End::Program | End::Endless) => true,
        (Claim::Blocks(_), End::Endless) => false,
        (Claim::Blocks(limit), End::Program | End::Alarm(_)) => blocks <= *limit,
        (Claim::Travel(_), End::Alarm(code)) => !code.starts_with("OT"),
        (Claim::Travel(_), End::Program | End::Endless) => true,
    };
    if holds { ClaimState::Holds } else { ClaimState::Fails }
}
