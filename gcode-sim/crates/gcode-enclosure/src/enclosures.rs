//! The enclosures of nodes over one box, on one path through a program.
use std::cmp::Ordering;
use std::collections::VecDeque;
use std::sync::Arc;

use crate::algebra;
use crate::arena::Arena;
use crate::basis::{Basis, MAX_VARIABLES};
use crate::domain::Domain;
use crate::form::{Form, Modeller};
use crate::hull;
use crate::interval::{Interval, mul_up};
use crate::model::Model;
use crate::node::{Binary, Condition, Node, NodeId, Unary};
use crate::real_values::SINES;

/// Enclosures of nodes over a box, given the conditions of a path.
///
/// An enclosure has every double that the interpreter can compute at a point of the box that keeps the conditions and at
/// which no operation of the node raises an alarm. A clone is the same place with a future of its own: where a condition
/// isn't decided, each clone assumes one side.
#[derive(Clone, Debug)]
pub struct Enclosures {
    domain: Domain,
    pub(crate) conditions: Vec<Condition>,
    pub(crate) forms: Vec<Option<Arc<Form>>>,
    pub(crate) basis: Basis,
    /// Variable of each input; none for an input with one value.
    variables: Vec<Option<usize>>,
    pub(crate) next_variable: usize,
    /// Nodes whose own variables follow those of the inputs.
    pub(crate) sources: Vec<NodeId>,
    /// Variables that stand for what the polynomial of a node leaves out, the oldest first.
    pub(crate) rests: VecDeque<usize>,
    /// Inputs that are another input and a difference: by input, the other and the range of the difference.
    differences: Vec<(usize, usize, Interval)>,
}

/// Largest number of inputs with a variable; the others are ranges only.
const MAX_INPUTS: usize = 10;

impl Enclosures {
    /// Returns the enclosures over a box, with polynomials of a degree that suits its number of inputs.
    pub fn new(domain: Domain) -> Self {
        let inputs = domain.ranges().iter().filter(|range| range.lo() < range.hi()).count();
        let degree = match inputs {
            0 | 1 => 8,
            2 => 6,
            3 => 5,
            4 => 4,
            5 | 6 => 3,
            _ => 2,
        };
        Self::with_degree(domain, degree)
    }

    /// Returns the enclosures over a box with polynomials of a total degree up to 9; of degree 0, ranges alone.
    pub fn with_degree(domain: Domain, degree: u32) -> Self {
        let mut next_variable = 0;
        let variables = domain.ranges().iter().map(|range| {
            let is_variable = degree > 0 && range.lo() < range.hi() && next_variable < MAX_INPUTS;
            is_variable.then(|| {
                next_variable += 1;
                next_variable - 1
            })
        });
        let variables = variables.collect();
        let basis = Basis::new(next_variable, degree);
        Self {
            domain,
            conditions: Vec::new(),
            forms: Vec::new(),
            basis,
            variables,
            next_variable,
            sources: Vec::new(),
            rests: VecDeque::new(),
            differences: Vec::new(),
        }
    }

    /// Assumes that an input is another one and a real number of a range, before anything is enclosed.
    ///
    /// The other input must not be given by a difference from this one.
    pub fn relate(&mut self, input: usize, other: usize, difference: Interval) {
        self.differences.push((input, other, difference));
    }

    /// Returns the box.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns the conditions assumed so far.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// Returns a range that has every double the node can have; empty if it never has a value.
    pub fn enclose(&mut self, arena: &Arena, node: NodeId) -> Interval {
        if self.forms.len() < arena.len() {
            self.forms.resize(arena.len(), None);
        }
        let mut pending = vec![node];
        while let Some(&next) = pending.last() {
            let before = pending.len();
            if self.forms[next.index()].is_none() {
                pending.extend(arena.operands(next).filter(|operand| self.forms[operand.index()].is_none()));
            }
            if pending.len() == before {
                pending.pop();
                if self.forms[next.index()].is_none() {
                    self.forms[next.index()] = Some(Arc::new(self.compute(arena, next)));
                }
            }
        }
        self.hull(node)
    }

    /// Returns a range of the node from the best bounds of its polynomial.
    pub fn enclose_tightly(&mut self, arena: &Arena, node: NodeId) -> Interval {
        let hull = self.enclose(arena, node);
        if let Some(form) = &self.forms[node.index()]
            && let Some(model) = &form.model
        {
            let tighter = hull.intersect(model.range(&self.basis));
            if tighter != hull {
                self.set_hull(node, tighter);
            }
        }
        self.hull(node)
    }

    /// Returns the range of a node that has a form.
    pub(crate) fn hull(&self, node: NodeId) -> Interval {
        self.forms[node.index()].as_ref().map_or(Interval::ALL, |form| form.hull)
    }

    pub(crate) fn set_hull(&mut self, node: NodeId, hull: Interval) {
        if let Some(form) = &mut self.forms[node.index()] {
            Arc::make_mut(form).hull = hull;
        }
    }

    /// Returns the form of a node whose operands have theirs.
    fn compute(&mut self, arena: &Arena, node: NodeId) -> Form {
        let content = arena.node(node);
        // Where the operands touch the edge of the domain, a better range of theirs decides.
        if self.is_critical(content) {
            for operand in arena.operands(node) {
                self.enclose_tightly(arena, operand);
            }
        }
        let semantics = arena.semantics();
        let (natural, operands) = match content {
            Node::Constant(value) => return Form { hull: Interval::point(value), model: None },
            Node::Input(input) => return self.input(input),
            Node::Unary(function, x) => {
                let Some(x) = self.forms[x.index()].clone() else { return Form::UNKNOWN };
                (hull::unary(function, x.hull, semantics), [Some(x), None])
            }
            Node::Binary(operator, left, right) => {
                let (Some(a), Some(b)) =
                    (self.forms[left.index()].clone(), self.forms[right.index()].clone())
                else {
                    return Form::UNKNOWN;
                };
                let range = match operator {
                    _ if a.hull.is_empty() => Interval::EMPTY,
                    Binary::Mul if left == right => {
                        let (least, most) = (a.hull.mignitude(), a.hull.magnitude());
                        Interval::new(least * least, most * most)
                    }
                    Binary::Div if left == right => Interval::point(1.0),
                    Binary::Add if arena.doubled_positive_part(node).is_some() => {
                        // Of z and |z| the sum is 2·z or 0.
                        let z = if matches!(arena.node(right), Node::Unary(Unary::Abs, _)) {
                            a.hull
                        } else {
                            b.hull
                        };
                        Interval::new(2.0 * z.lo().max(0.0), 2.0 * z.hi().max(0.0))
                    }
                    Binary::Div if b.hull.contains(0.0) => self.quotient_hull(arena, left, right),
                    _ => hull::binary(operator, a.hull, b.hull, semantics),
                };
                (range, [Some(a), Some(b)])
            }
        };
        let natural = self.with_identity(arena, node, arena.widened(node, natural));
        let natural = self.with_ratio(arena, node, natural);
        let fraction = arena.fraction_range(node, &|operand| self.hull(operand));
        let natural = fraction.map_or(natural, |fraction| natural.intersect(fraction));
        let is_product = matches!(content, Node::Binary(Binary::Mul, left, right) if left != right);
        let natural = match is_product && arena.widening() == 0.0 {
            true => arena
                .factors(node)
                .range(|factor| self.hull(factor))
                .map_or(natural, |range| natural.intersect(range)),
            false => natural,
        };
        if natural.lo() >= natural.hi() || self.basis.degree() == 0 {
            return Form { hull: natural, model: None };
        }
        let mut modeller = Modeller { basis: &mut self.basis, semantics };
        let model = match (content, &operands) {
            (Node::Unary(function @ (Unary::Fix | Unary::Fup | Unary::Round), _), [Some(x), _]) => {
                let is_free = self.next_variable < MAX_VARIABLES && x.model.is_some();
                let variable = is_free.then(|| {
                    self.sources.push(node);
                    self.next_variable += 1;
                    self.next_variable - 1
                });
                modeller.whole(function, x, variable)
            }
            (Node::Unary(Unary::Atan, quotient), [Some(x), _]) => {
                let sides = match arena.node(quotient) {
                    Node::Binary(Binary::Div, a, b) => {
                        self.forms[a.index()].clone().zip(self.forms[b.index()].clone())
                    }
                    _ => None,
                };
                let angle = sides.and_then(|(y, x)| modeller.angle_of_quotient(&y, &x));
                angle.or_else(|| modeller.unary(Unary::Atan, x, natural))
            }
            (Node::Unary(function, _), [Some(x), _]) => modeller.unary(function, x, natural),
            (Node::Binary(operator, ..), [Some(a), Some(b)]) => modeller.binary(operator, a, b, natural),
            _ => None,
        };
        let mut model = self.best_model(arena, node, natural, model);
        if let Some(model) = &mut model
            && arena.widening() > 0.0
            && arena.is_widened(node)
        {
            model.widen(mul_up(natural.magnitude(), arena.widening()));
        }
        let Some(model) = model.filter(Model::is_finite) else {
            return self.free_form(node, natural);
        };
        let hull = natural.intersect(model.bound(&self.basis));
        if hull.lo() >= hull.hi() {
            return Form { hull, model: None };
        }
        // A polynomial within its own rest says nothing.
        let is_useful = model.rest < hull.width() * 0.4999 && !model.is_constant();
        if !is_useful {
            return self.free_form(node, hull);
        }
        Form { hull, model: Some(self.with_own_rest(arena, node, model, hull)) }
    }

    /// Returns the range of a node that is a constant but for roundings, as far as a range allows.
    fn with_identity(&self, arena: &Arena, node: NodeId, range: Interval) -> Interval {
        let is_sum = matches!(arena.node(node), Node::Binary(Binary::Add | Binary::Sub, ..));
        if !is_sum
            || !range.contains(0.0)
            || range.as_point().is_some()
            || !arena.identities().contains(node, || algebra::is_identity(arena, node))
        {
            return range;
        }
        let mut range = range;
        // The last rounding is a part of the result: the second pass knows it better.
        for _ in 0..2 {
            let hull = |other: NodeId| match self.forms.get(other.index()) {
                _ if other == node => range,
                Some(Some(form)) => form.hull,
                // A function of a part of the angle, which the node itself isn't computed of.
                _ if matches!(arena.node(other), Node::Unary(Unary::Sin | Unary::Cos, _)) => SINES,
                _ => Interval::ALL,
            };
            range = algebra::range_of(arena, node, &hull).map_or(range, |identity| range.intersect(identity));
        }
        range
    }

    /// Returns the range of a quotient whose divisor's range has 0.
    pub(crate) fn quotient_hull(&self, arena: &Arena, a: NodeId, b: NodeId) -> Interval {
        let least = self.least_magnitude(arena, b).max(f64::from_bits(1));
        hull::quotient(self.hull(a), self.hull(b), least)
    }

    /// Returns the better of a model and that of the node's factors, if these are simpler.
    fn best_model(
        &mut self,
        arena: &Arena,
        node: NodeId,
        result: Interval,
        model: Option<Model>,
    ) -> Option<Model> {
        let factors = arena.factors(node);
        if !factors.is_simpler || arena.widening() > 0.0 || !matches!(arena.node(node), Node::Binary(..)) {
            return model;
        }
        // Within these magnitudes no operation on the factors overflows, and what underflows stays below 1e-60: a dozen
        // factors multiply it by 1e120 at most.
        let is_moderate = |&(factor, is_divisor): &(NodeId, bool)| {
            let hull = self.hull(factor);
            hull.magnitude() <= 1e10 && (!is_divisor || hull.mignitude() >= 1e-10)
        };
        if !factors.used.iter().all(is_moderate) {
            return model;
        }
        let forms = factors.powers.iter().map(|(factor, _)| self.forms[factor.index()].clone());
        let forms: Option<Vec<_>> = forms.collect();
        let mut modeller = Modeller { basis: &mut self.basis, semantics: arena.semantics() };
        let by_factors = forms.and_then(|forms| modeller.product_of_powers(factors, &forms, result));
        match (model, by_factors) {
            (Some(model), Some(by_factors)) if by_factors.rest >= model.rest => Some(model),
            (model, by_factors) => by_factors.or(model),
        }
    }

    /// Returns the form of a value without a relation to the inputs: a variable of its own, if there is one left.
    fn free_form(&mut self, node: NodeId, hull: Interval) -> Form {
        if self.next_variable >= MAX_VARIABLES || hull.magnitude() > 1e20 {
            return Form { hull, model: None };
        }
        self.sources.push(node);
        self.next_variable += 1;
        let model = Model::of_variable(&mut self.basis, self.next_variable - 1, hull);
        Form { hull, model: Some(model) }
    }

    /// Returns the form of an input.
    fn input(&mut self, input: usize) -> Form {
        let hull = self.domain.range(input);
        let model = self.input_model(input, hull);
        Form { hull, model: model.filter(Model::is_finite) }
    }

    fn input_model(&mut self, input: usize, hull: Interval) -> Option<Model> {
        let variable = self.variables.get(input).copied().flatten()?;
        let relation = self.differences.iter().find(|(of, ..)| *of == input).copied();
        if let Some((_, other, difference)) = relation {
            let range = self.domain.range(other);
            let base = match range.as_point() {
                Some(value) => Model::constant(value),
                None => self.input_model(other, range)?,
            };
            let difference = match difference.as_point() {
                Some(value) => Model::constant(value),
                None => Model::of_variable(&mut self.basis, variable, difference),
            };
            return Some(base.add(&difference));
        }
        Some(Model::of_variable(&mut self.basis, variable, hull))
    }

    /// Returns the input whose variation changes a node that has been enclosed most: the one to divide.
    ///
    /// `None` if no input has more than one double.
    pub fn widest_effect(&self, arena: &Arena, node: NodeId) -> Option<usize> {
        let effects = self.effects(arena, node);
        let relative_width = |range: &Interval| range.width() / (range.magnitude() + f64::MIN_POSITIVE);
        let ranges = self.domain.ranges().iter().enumerate().filter(|(_, range)| range.lo() < range.hi());
        let rated = ranges.map(|(input, range)| (effects[input], relative_width(range), input));
        let best = rated.max_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap_or(Ordering::Equal));
        best.map(|(_, _, input)| input)
    }

    /// Returns the share of each input in the variation of a node: by its polynomial, or by those of its operands.
    fn effects(&self, arena: &Arena, node: NodeId) -> Vec<f64> {
        let inputs = self.domain.ranges().len();
        let cone = arena.cone(&[node]);
        let mut weights = vec![0.0; node.index() + 1];
        weights[node.index()] = 1.0;
        let mut effects = vec![0.0; inputs];
        for &id in cone.iter().rev() {
            let weight = weights[id.index()];
            let Some(Some(form)) = self.forms.get(id.index()) else { continue };
            if weight == 0.0 || form.hull.as_point().is_some() {
                continue;
            }
            let first = self.next_variable - self.sources.len();
            let Some(model) = &form.model else {
                if let Node::Input(input) = arena.node(id) {
                    effects[input] += weight;
                }
                for operand in arena.operands(id) {
                    weights[operand.index()] += weight;
                }
                continue;
            };
            let of_sources = self
                .sources
                .iter()
                .enumerate()
                .map(|(place, source)| (*source, self.effect(model, Some(first + place))));
            let of_sources: Vec<_> = of_sources.filter(|(_, effect)| *effect > 0.0).collect();
            let of_inputs: Vec<f64> =
                self.variables.iter().map(|variable| self.effect(model, *variable)).collect();
            let all =
                of_inputs.iter().chain(of_sources.iter().map(|(_, effect)| effect)).sum::<f64>() + model.rest;
            if all <= 0.0 {
                continue;
            }
            for (effect, own) in effects.iter_mut().zip(of_inputs) {
                *effect += weight * own / all;
            }
            // What the polynomial leaves out comes of the operands.
            let mut left_out = model.rest;
            for (source, effect) in of_sources {
                if source == id {
                    left_out += effect;
                } else {
                    weights[source.index()] += weight * effect / all;
                }
            }
            for operand in arena.operands(id) {
                weights[operand.index()] += weight * left_out / all;
            }
        }
        effects
    }

    /// Returns true for a node that is a polynomial of inputs for its larger part.
    pub(crate) fn is_modelled(&self, node: NodeId) -> bool {
        let form = self.forms.get(node.index()).and_then(Option::as_ref);
        form.and_then(|form| form.model.as_ref()).is_some_and(|model| {
            let first = self.next_variable - self.sources.len();
            let inputs: f64 = self.variables.iter().map(|variable| self.effect(model, *variable)).sum();
            let others: f64 =
                (first..self.next_variable).map(|variable| self.effect(model, Some(variable))).sum();
            inputs > others + model.rest
        })
    }

    /// Returns how much a variable changes a polynomial.
    fn effect(&self, model: &Model, variable: Option<usize>) -> f64 {
        let Some(variable) = variable else { return 0.0 };
        let terms = model.terms.iter();
        terms.map(|(monomial, value)| value.abs() * f64::from(self.basis.exponent(*monomial, variable))).sum()
    }

    /// Returns the corner of the box where the node's linear part is largest, or least for a negative sign.
    pub(crate) fn corner(&self, node: NodeId, sign: f64) -> Vec<f64> {
        let model =
            self.forms.get(node.index()).and_then(Option::as_ref).and_then(|form| form.model.as_ref());
        let slope = |input: usize| {
            let variable = self.variables.get(input).copied().flatten()?;
            let is_linear = |monomial: u32| self.basis.is_variable(monomial, variable);
            model?.terms.iter().find(|(monomial, _)| is_linear(*monomial)).map(|(_, value)| *value)
        };
        let ranges = self.domain.ranges().iter().enumerate();
        let ends = ranges.map(|(input, range)| match slope(input) {
            Some(slope) if slope * sign > 0.0 => range.hi(),
            Some(_) => range.lo(),
            None => range.midpoint(),
        });
        ends.collect()
    }

    /// Returns true for an operation whose operands may be outside its domain or at its edge.
    fn is_critical(&self, content: Node) -> bool {
        if self.basis.degree() == 0 {
            return false;
        }
        match content {
            Node::Unary(Unary::Sqrt | Unary::Ln, x) => self.hull(x).lo() <= 0.0,
            Node::Unary(Unary::Asin | Unary::Acos, x) => self.hull(x).magnitude() >= 1.0,
            Node::Unary(Unary::Fix | Unary::Fup | Unary::Round | Unary::Abs, _) => true,
            Node::Binary(Binary::Div, _, b) => self.hull(b).contains(0.0),
            Node::Binary(Binary::Pow, a, _) => self.hull(a).lo() <= 0.0,
            Node::Binary(Binary::Atan, a, b) => self.hull(a).contains(0.0) || self.hull(b).contains(0.0),
            Node::Binary(Binary::Compare(_) | Binary::Mod, ..) => true,
            _ => false,
        }
    }
}
