//! Terms of a symbolic run as nodes of an arena, with what holds over all ranges.
use std::collections::{BTreeSet, HashMap, VecDeque};

use gcode_control::symbolic::{Term, TermOperation, Terms, Test};
use gcode_enclosure::{
    AlarmKind, Arena, Binary, Condition, Domain, Enclosures, Node, NodeId, Relation, Semantics, Unary,
};
use gcode_lang::control::Settings;
use gcode_lang::syntax::ast;

/// Largest number of constants that are kept for the search.
const MAX_CONSTANTS: usize = 200;

/// Magnitude below which some units in the last place are far less than a half.
const LARGEST_MULTIPLE: f64 = 1e11;

/// Largest depth of a sum of multiples.
const MAX_SUM: u32 = 8;

/// Nodes of all ways of a program.
#[derive(Debug)]
pub(crate) struct Nodes {
    arena: Arena,
    /// Nodes that are terms, by index.
    ids: HashMap<u32, NodeId>,
    /// Enclosures over all ranges.
    root: Enclosures,
    /// Numbers of the program that meet a node, by their bits.
    constants: BTreeSet<u64>,
    /// Answers of the way that is followed.
    answers: HashMap<TestKey, bool>,
    /// What the ranges answer to each test that has been asked, once and for all: a later node could decide it.
    decisions: HashMap<TestKey, Option<bool>>,
    /// Tests whose answers are taken next, in their order.
    repeated: VecDeque<TestKey>,
    /// An answer has been taken for another test than its own.
    has_mismatch: bool,
    /// Inputs that something is computed of, or that are compared, as bits.
    read_inputs: u64,
}

/// Test as a key: what is asked, and the bits of its terms.
pub(crate) type TestKey = (u8, u64, u64);

/// Returns a test as a key.
pub(crate) fn key(test: &Test) -> TestKey {
    let bits = |term: Term| match term {
        Term::Number(number) => number.to_bits(),
        // No number has the bits of a NaN.
        Term::Node(node) => f64::NAN.to_bits() | u64::from(node),
    };
    match *test {
        Test::Compare(relation, left, right) => (relation as u8, bits(left), bits(right)),
        Test::Finite(term) => (u8::MAX, bits(term), 0),
    }
}

/// Returns the settings that decide what functions compute.
pub(crate) fn semantics(settings: &Settings) -> Semantics {
    Semantics {
        returns_signed_angles: settings.returns_signed_angles,
        zeroes_residues: settings.zeroes_residues,
        tan_90_alarms: settings.undocumented.tan_90_alarms,
        atan_of_zeros_alarms: settings.undocumented.atan_of_zeros_alarms,
        negative_bits_alarm: settings.undocumented.negative_bits_alarm,
    }
}

impl Nodes {
    pub(crate) fn new(semantics: Semantics, domain: Domain, widening: f64) -> Self {
        Self {
            arena: Arena::new(semantics).with_widening(widening),
            ids: HashMap::new(),
            constants: BTreeSet::new(),
            root: Enclosures::with_degree(domain, 0),
            answers: HashMap::new(),
            decisions: HashMap::new(),
            repeated: VecDeque::new(),
            has_mismatch: false,
            read_inputs: 0,
        }
    }

    pub(crate) fn arena(&self) -> &Arena {
        &self.arena
    }

    pub(crate) fn arena_mut(&mut self) -> &mut Arena {
        &mut self.arena
    }

    /// Returns the term of an input.
    pub(crate) fn input(&mut self, index: usize) -> Term {
        let id = self.arena.input(index);
        self.term(id)
    }

    /// Returns the inputs that something is computed of, or that are compared, as bits.
    pub(crate) fn read_inputs(&self) -> u64 {
        self.read_inputs
    }

    /// Returns numbers of the program that meet a node.
    pub(crate) fn constants(&self) -> Vec<f64> {
        self.constants.iter().map(|bits| f64::from_bits(*bits)).filter(|number| number.is_finite()).collect()
    }

    /// Sets the answers of the way that is followed.
    pub(crate) fn set_answers(&mut self, answers: impl Iterator<Item = (Test, bool)>) {
        self.answers = answers.map(|(test, answer)| (key(&test), answer)).collect();
    }

    /// Sets the tests whose answers are taken next.
    pub(crate) fn repeat<'t>(&mut self, tests: impl Iterator<Item = &'t Test>) {
        self.repeated = tests.map(key).collect();
        self.has_mismatch = false;
    }

    /// Returns true if an answer has been taken for another test than its own.
    pub(crate) fn has_mismatch(&self) -> bool {
        self.has_mismatch
    }

    /// Returns the number of answers that haven't been taken.
    pub(crate) fn answers_left(&self) -> usize {
        self.repeated.len()
    }

    /// Returns what the ranges answer to a test.
    fn decide(&mut self, test: &Test) -> Option<bool> {
        match *test {
            Test::Compare(relation, left, right) => {
                let condition = self.condition(relation, left, right);
                self.root.decide(&self.arena, condition)
            }
            Test::Finite(term) => {
                let id = self.id(term);
                is_finite(&self.arena, &mut self.root, id)
            }
        }
    }

    fn term(&mut self, id: NodeId) -> Term {
        match self.arena.as_constant(id) {
            Some(number) => Term::Number(number),
            None => {
                self.ids.insert(id.index() as u32, id);
                Term::Node(id.index() as u32)
            }
        }
    }

    /// Adds an answer of the way that is followed.
    pub(crate) fn add_answer(&mut self, test: &Test, answer: bool) {
        self.answers.insert(key(test), answer);
    }

    /// Returns the node of a term.
    pub(crate) fn id(&mut self, term: Term) -> NodeId {
        match term {
            Term::Number(number) => {
                if self.constants.len() < MAX_CONSTANTS {
                    self.constants.insert(number.to_bits());
                }
                self.arena.constant(number)
            }
            Term::Node(node) => {
                let id = self.known_id(node);
                if let Node::Input(input) = self.arena.node(id) {
                    self.read_inputs |= 1_u64.checked_shl(input as u32).unwrap_or(0);
                }
                id
            }
        }
    }

    /// Returns the whole number to which the product of a node and `scale` rounds, if the node is a sum of quotients of whole
    /// numbers and the product is off by far less than a half.
    ///
    /// Each quotient, sum and product, and the correction of halves, is off by some units in the last place.
    fn multiple(&mut self, node: NodeId, scale: f64, depth: u32) -> Option<NodeId> {
        let whole = match self.arena.node(node) {
            Node::Constant(value) => {
                let product = value * scale;
                let is_near = (product - product.round()).abs() < 1e-3 && product.abs() < LARGEST_MULTIPLE;
                return is_near.then(|| self.arena.constant(product.round()));
            }
            Node::Binary(Binary::Div, whole, divisor) if self.arena.is_whole(whole) => {
                let factor = scale / self.arena.as_constant(divisor)?;
                if factor < 1.0 || factor.fract() != 0.0 {
                    return None;
                }
                let factor = self.arena.constant(factor);
                self.arena.binary(Binary::Mul, whole, factor)
            }
            Node::Binary(operator @ (Binary::Add | Binary::Sub), a, b) if depth > 0 => {
                let (a, b) = (self.multiple(a, scale, depth - 1)?, self.multiple(b, scale, depth - 1)?);
                self.arena.binary(operator, a, b)
            }
            _ => return None,
        };
        (self.root.enclose(&self.arena, whole).magnitude() < self.largest_multiple()).then_some(whole)
    }

    /// Returns the magnitude below which the errors of some operations are far less than a half.
    fn largest_multiple(&self) -> f64 {
        LARGEST_MULTIPLE.min(0.01 / self.arena.widening().max(1e-300))
    }

    /// Returns the node of a quotient: a whole number × k by n × k is that number by n, the same double.
    fn quotient(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let (Node::Binary(Binary::Mul, left, right), Some(divisor)) =
            (self.arena.node(a), self.arena.as_constant(b))
        {
            for (whole, factor) in [(left, right), (right, left)] {
                if let Some(factor) = self.arena.as_constant(factor)
                    && self.arena.widening() == 0.0
                    && factor >= 1.0
                    && factor.fract() == 0.0
                    && (divisor / factor).fract() == 0.0
                    && divisor / factor * factor == divisor
                    && self.arena.is_whole(whole)
                    && self.root.enclose(&self.arena, a).magnitude() < LARGEST_MULTIPLE
                {
                    let divisor = self.arena.constant(divisor / factor);
                    return self.arena.binary(Binary::Div, whole, divisor);
                }
            }
        }
        self.arena.binary(Binary::Div, a, b)
    }

    /// Returns the node of ROUND.
    fn rounded(&mut self, node: NodeId) -> NodeId {
        if let Node::Binary(Binary::Mul, a, b) = self.arena.node(node) {
            for (factor, scale) in [(a, b), (b, a)] {
                if let Some(scale) = self.arena.as_constant(scale).filter(|scale| *scale >= 1.0)
                    && self.arena.as_constant(factor).is_none()
                    && let Some(whole) = self.multiple(factor, scale, MAX_SUM)
                {
                    return whole;
                }
            }
        }
        self.arena.unary(Unary::Round, node)
    }

    fn known_id(&self, node: u32) -> NodeId {
        // Every node of a run has been handed out by `term`.
        self.ids.get(&node).copied().unwrap_or(Arena::ZERO)
    }

    /// Returns the condition of a comparison.
    pub(crate) fn condition(&mut self, relation: Relation, left: Term, right: Term) -> Condition {
        Condition::new(relation, self.id(left), self.id(right))
    }
}

fn bits_of(op: ast::BinaryOp) -> Binary {
    match op {
        ast::BinaryOp::And => Binary::And,
        ast::BinaryOp::Or => Binary::Or,
        _ => Binary::Xor,
    }
}

/// Returns the function of a node; `None` for one that takes two values, or a variable.
fn unary_of(function: ast::Function) -> Option<Unary> {
    Some(match function {
        ast::Function::Sin => Unary::Sin,
        ast::Function::Cos => Unary::Cos,
        ast::Function::Tan => Unary::Tan,
        ast::Function::Asin => Unary::Asin,
        ast::Function::Acos => Unary::Acos,
        ast::Function::Atan => Unary::Atan,
        ast::Function::Sqrt => Unary::Sqrt,
        ast::Function::Abs => Unary::Abs,
        ast::Function::Round => Unary::Round,
        ast::Function::Fix => Unary::Fix,
        ast::Function::Fup => Unary::Fup,
        ast::Function::Ln => Unary::Ln,
        ast::Function::Exp => Unary::Exp,
        ast::Function::Bin => Unary::Bin,
        ast::Function::Bcd => Unary::Bcd,
        ast::Function::Pow | ast::Function::Adp => return None,
    })
}

/// Decides whether a node's own operation stays within the doubles.
pub(crate) fn is_finite(arena: &Arena, enclosures: &mut Enclosures, node: NodeId) -> Option<bool> {
    let kind = match arena.node(node) {
        Node::Binary(..) => AlarmKind::Overflow,
        Node::Unary(Unary::Exp | Unary::Tan, _) => AlarmKind::OutOfRange,
        Node::Unary(..) | Node::Constant(_) | Node::Input(_) => return Some(true),
    };
    let alarms = enclosures.alarms(arena, node);
    match alarms.iter().find(|alarm| alarm.kind == kind) {
        None => Some(true),
        Some(alarm) if alarm.is_certain => Some(false),
        Some(_) => None,
    }
}

impl Terms for Nodes {
    fn node(&mut self, operation: TermOperation, [left, right]: [Term; 2]) -> Term {
        let (a, b) = (self.id(left), self.id(right));
        let id = match operation {
            TermOperation::Add => self.arena.binary(Binary::Add, a, b),
            TermOperation::Subtract => self.arena.binary(Binary::Sub, a, b),
            TermOperation::Multiply => self.arena.binary(Binary::Mul, a, b),
            TermOperation::Divide => self.quotient(a, b),
            TermOperation::Bits(op) => self.arena.binary(bits_of(op), a, b),
            TermOperation::Remainder => self.arena.binary(Binary::Mod, a, b),
            TermOperation::Power => self.arena.binary(Binary::Pow, a, b),
            TermOperation::Direction => self.arena.binary(Binary::Atan, a, b),
            TermOperation::Negate => self.arena.unary(Unary::Neg, a),
            TermOperation::Function(function) => match unary_of(function) {
                Some(Unary::Round) => self.rounded(a),
                Some(function) => self.arena.unary(function, a),
                None => a,
            },
            TermOperation::Scaled(scale) => match self.multiple(a, scale, MAX_SUM) {
                Some(whole) => whole,
                None => self.arena.round_scaled(a, scale),
            },
        };
        self.term(id)
    }

    fn bounds(&mut self, term: Term) -> (f64, f64) {
        let id = self.id(term);
        let hull = self.root.enclose(&self.arena, id);
        (hull.lo(), hull.hi())
    }

    fn answer(&mut self, test: &Test) -> Option<bool> {
        let key = key(test);
        let decision = match self.decisions.get(&key) {
            Some(decision) => *decision,
            None => {
                let decision = self.decide(test);
                self.decisions.insert(key, decision);
                decision
            }
        };
        let known = decision.or_else(|| self.answers.get(&key).copied());
        if known.is_none() {
            // The next answer of the way is taken.
            self.has_mismatch |= self.repeated.pop_front().is_some_and(|expected| expected != key);
        }
        known
    }
}
