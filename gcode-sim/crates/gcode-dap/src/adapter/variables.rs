//! Scopes of a frame and their variables.
use super::{Adapter, Answer, Host, body};
use crate::debuggee::values;
use crate::protocol::arguments;
use crate::protocol::bodies::{PresentationHint, Scope, Scopes, Variable, Variables};
use gcode_control::{Control, StackedProgram, Value, modal_code};
use gcode_inspect::machine::{Machine, Setup};
use gcode_lang::program::modes::GROUPS;

/// Scope of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ScopeKind {
    Locals,
    Common,
    Modal,
    Position,
    System,
}

/// Scopes in the order in which a client shows them.
const SCOPES: [(ScopeKind, &str); 5] = [
    (ScopeKind::Locals, "Locals"),
    (ScopeKind::Common, "Common"),
    (ScopeKind::Modal, "Modal"),
    (ScopeKind::Position, "Position"),
    (ScopeKind::System, "System"),
];

/// Number of scopes of a frame, with 0 unused. A reference is a frame's number times this, and the number of a scope.
const REFERENCES: i64 = 8;

/// Last local.
const LOCALS: u32 = 33;

/// System variables of every control that the scope shows, besides offsets.
const SYSTEM: [u32; 14] =
    [1032, 1132, 3001, 3002, 3003, 3004, 3005, 3007, 3008, 3011, 3012, 3901, 3902, 4130];

/// Offsets of H and D shown: those that aren't 0 of the first so many.
const TOOL_OFFSETS: u32 = 200;

/// Returns the frame and the kind of a scope by its reference.
fn scope_of(reference: i64) -> Result<(i64, ScopeKind), String> {
    let kind = usize::try_from(reference % REFERENCES - 1).ok().and_then(|index| SCOPES.get(index));
    match kind.filter(|_| reference > 0) {
        Some((kind, _)) => Ok((reference / REFERENCES, *kind)),
        None => Err(format!("there are no variables with the reference {reference}")),
    }
}

impl<H: Host> Adapter<H> {
    pub(super) fn scopes(&mut self, arguments: &arguments::Scopes) -> Answer {
        self.frame_index(Some(arguments.frame_id))?;
        let control = self.standing()?.debuggee.control();
        let commons = control.vars().common_numbers().count();
        let scopes = SCOPES.iter().zip(1..).map(|((kind, name), number)| Scope {
            name,
            presentation_hint: (*kind == ScopeKind::Locals).then_some("locals"),
            variables_reference: arguments.frame_id * REFERENCES + number,
            named_variables: (*kind == ScopeKind::Locals).then_some(LOCALS as usize),
            // A client shows these in groups of a hundred.
            indexed_variables: (*kind == ScopeKind::Common).then_some(commons),
            expensive: false,
        });
        body(Scopes { scopes: scopes.collect() })
    }

    pub(super) fn variables(&mut self, arguments: &arguments::Variables) -> Answer {
        let (frame, kind) = scope_of(arguments.variables_reference)?;
        let (stack, index) = self.frame_index(Some(frame))?;
        let is_indexed = kind == ScopeKind::Common;
        let is_wanted = match arguments.filter.as_deref() {
            Some("indexed") => is_indexed,
            Some("named") => !is_indexed,
            _ => true,
        };
        if !is_wanted {
            return body(Variables { variables: Vec::new() });
        }
        let start = usize::try_from(arguments.start.unwrap_or_default()).unwrap_or_default();
        // A count of 0 is all of them.
        let count = arguments.count.and_then(|count| usize::try_from(count).ok()).filter(|count| *count > 0);
        let count = count.unwrap_or(usize::MAX);
        let session = self.standing()?;
        let control = session.debuggee.control();
        let variables: Vec<Variable> = match kind {
            ScopeKind::Locals => locals(control, &stack, index).skip(start).take(count).collect(),
            ScopeKind::Common => {
                let numbers = control.vars().common_numbers().skip(start).take(count);
                numbers.map(|number| numbered(control, number, "common")).collect()
            }
            ScopeKind::Modal => modal(control).into_iter().skip(start).take(count).collect(),
            ScopeKind::Position => {
                let all = positions(control, &session.request.machine);
                all.into_iter().skip(start).take(count).collect()
            }
            ScopeKind::System => {
                let all = system_numbers(control);
                let shown = all.into_iter().skip(start).take(count);
                shown.map(|number| numbered(control, number, "system")).collect()
            }
        };
        body(Variables { variables })
    }

    /// Returns the macro level of a scope's frame.
    pub(super) fn level_of_scope(&mut self, reference: i64) -> Result<usize, String> {
        let (frame, _) = scope_of(reference)?;
        self.level_of_frame(Some(frame))
    }

    /// Returns the macro level of a scope whose variables can be set.
    pub(super) fn writable_scope(&mut self, reference: i64) -> Result<usize, String> {
        let (frame, kind) = scope_of(reference)?;
        if matches!(kind, ScopeKind::Modal | ScopeKind::Position) {
            return Err("only blocks change modes and positions".to_owned());
        }
        self.level_of_frame(Some(frame))
    }
}

/// Returns the variable `#n`.
fn numbered(control: &Control, number: u32, kind: &str) -> Variable {
    variable(number, control.variable(number).unwrap_or(Value::Vacant), kind.to_owned())
}

fn variable(number: u32, value: Value, kind: String) -> Variable {
    let name = format!("#{number}");
    let (evaluate_name, value) = (Some(name.clone()), values::value(value));
    Variable { name, value, kind: Some(kind), presentation_hint: None, evaluate_name, variables_reference: 0 }
}

/// Returns a value that only blocks change.
fn shown(name: String, value: String, evaluate_name: Option<String>) -> Variable {
    let presentation_hint = Some(PresentationHint { attributes: vec!["readOnly"] });
    Variable { name, value, kind: None, presentation_hint, evaluate_name, variables_reference: 0 }
}

/// Iterates over the locals of a frame, each with the letter of the argument that it came from.
fn locals<'a>(
    control: &'a Control,
    stack: &[StackedProgram],
    index: usize,
) -> impl Iterator<Item = Variable> + 'a {
    let level = stack[index].level;
    // The block behind the outermost program of the level has called with the arguments.
    let caller = stack[index..].iter().find(|one| one.level < level);
    let letters = caller.map(|caller| control.argument_letters(caller.block)).unwrap_or_default();
    let values = control.vars().locals_of(level);
    (1..=LOCALS).map(move |number| {
        let letter = letters.iter().find(|(local, _)| *local == number as usize);
        let kind = letter.map_or_else(|| "local".to_owned(), |(_, letter)| format!("argument {letter}"));
        variable(number, values.get(number as usize), kind)
    })
}

fn modal(control: &Control) -> Vec<Variable> {
    let state = control.state();
    let mut all: Vec<Variable> = GROUPS
        .iter()
        .map(|group| {
            let code = modal_code(state.modal.code_in(*group));
            let name = format!("{:02} {}", group.number(), group.subject());
            shown(name, code, Some(format!("#{}", 4000 + group.number())))
        })
        .collect();
    let words = state.modal_words;
    let whole = |number: u32| values::number(f64::from(number));
    let named = [
        ("F", values::number(words.f), 4109),
        ("S", values::number(words.s), 4119),
        ("T", whole(words.t), 4120),
        ("D", whole(words.d), 4107),
        ("H", whole(words.h), 4111),
        ("M", whole(words.m), 4113),
        ("N", whole(words.n), 4114),
        ("O", whole(words.o), 4115),
    ];
    all.extend(named.map(|(name, value, number)| shown(name.to_owned(), value, Some(format!("#{number}")))));
    all.push(shown("tool in the spindle".to_owned(), whole(state.tool), None));
    all
}

/// Returns the positions: of the work coordinate system, of the machine, and of the tool's tip on the part.
fn positions(control: &Control, machine: &Machine) -> Vec<Variable> {
    let mut all = Vec::new();
    for (system, first) in [("work", 5041), ("machine", 5021)] {
        for (axis, letter) in control.settings().axes.iter() {
            let number = first + axis as u32;
            let value = control.variable(number).unwrap_or(Value::Vacant);
            all.push(shown(format!("{system} {letter}"), values::value(value), Some(format!("#{number}"))));
        }
    }
    let tool = Some(control.state().tool).filter(|tool| *tool > 0);
    let (offset, wear) = (control.length_offset(), control.length_wear());
    let setup = Setup { tool, offset, wear, ..Setup::default() };
    let pose = machine.forward(&control.machine_position(), &setup);
    for (name, value) in ["x", "y", "z"].into_iter().zip(pose.tip.coords.iter()) {
        all.push(shown(format!("part {name}"), values::number(*value), None));
    }
    let direction = pose.axis.map(|axis| axis.into_inner());
    for (index, name) in ["i", "j", "k"].into_iter().enumerate() {
        let value = direction.map_or_else(|| "unknown".to_owned(), |axis| values::number(axis[index]));
        all.push(shown(format!("part tool {name}"), value, None));
    }
    all
}

/// Returns the system variables that the scope shows: those that can be read, and offsets that aren't 0.
fn system_numbers(control: &Control) -> Vec<u32> {
    let is_readable = |number: &u32| control.variable(*number).is_ok();
    let is_set = |number: &u32| control.variable(*number).is_ok_and(|value| value.number() != 0.0);
    let axes = control.settings().axes.len() as u32;
    let mut all: Vec<u32> = SYSTEM.into_iter().filter(is_readable).collect();
    // The external work offset and G54.
    all.extend((5201..5201 + axes).chain(5221..5221 + axes).filter(is_readable));
    let further = (1..=5).flat_map(|system| 5221 + 20 * system..5221 + 20 * system + axes);
    all.extend(further.filter(is_set));
    let tools = [2001, 2201, 11_001, 13_001];
    all.extend(tools.into_iter().flat_map(|first| first..first + TOOL_OFFSETS).filter(is_set));
    all.sort_unstable();
    all.dedup();
    all
}
