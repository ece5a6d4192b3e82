//! Likely causes of a verdict: unset work offsets, and what a check of the program's text finds; and of an endless loop: a
//! counter that its assignment does not change.
use super::{Request, Run, Simulation};
use gcode_control::{Control, Outcome, UnsetWorkOffset, Value};
use gcode_inspect::findings::{MAIN_PROGRAM, WORK_OFFSET};
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::{Answer, AnyVerdict, Verdict};
use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::Backtrace;
use gcode_lang::program::modes::WorkSystem;
use gcode_lang::program::{Memory, NoLibrary};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Block, Expr, ExprKind, Item, Statement};
use gcode_lang::syntax::parse;
use gcode_lint::{
    ControlKnowledge, check_loaded, is_common, main_programs, programs_called_by_others, reachable_programs,
    rules, variables_read,
};

/// Rules about what a run does not show, or shows better: it finds the programs that it calls, and alarms at their end.
const LEFT_OUT: [&str; 2] = ["missing-program", "missing-end"];

/// Returns what a check of the programs that the run can reach finds: everything from a warning on if the verdict `fails`,
/// otherwise numbers without a decimal point. The block of an alarm is left out: the alarm says more.
pub(super) fn text_findings(run: &Run, fails: bool) -> Vec<Diagnostic> {
    let (memory, settings) = (run.control.memory().reload(), run.control.settings());
    let mut checked = check_loaded(memory, settings, ControlKnowledge::Stated, &mut NoLibrary);
    let reached = reachable_programs(&mut checked.memory, settings);
    let programs = checked.memory.programs();
    let spans: Vec<Span> = checked
        .memory
        .ids()
        .zip(programs)
        .filter(|(id, _)| !reached.contains(id))
        .map(|(_, program)| program.span)
        .collect();
    let is_beyond = |block: Span| {
        spans.iter().any(|span| span.source == block.source && (span.start..span.end).contains(&block.start))
    };
    let stopped = match &run.outcome {
        Outcome::Alarm(stop) => Some(stop.backtrace.block),
        Outcome::End | Outcome::Limit => None,
    };
    let is_cause = |finding: &Diagnostic| {
        let block = finding.backtrace.as_ref().map(|place| place.block);
        let is_chosen = finding.kind == rules::MISSING_POINT
            || fails && Severity::Warning <= finding.severity && !LEFT_OUT.contains(&finding.kind.code);
        is_chosen && (stopped.is_none() || block != stopped) && !block.is_some_and(is_beyond)
    };
    let mut found: Vec<Diagnostic> = checked.findings.into_iter().filter(is_cause).collect();
    for finding in found.iter_mut().filter(|finding| finding.kind == rules::MISSING_POINT) {
        finding.message = finding.message.replacen(" is ", " without a decimal point is ", 1);
    }
    found
}

/// Letters of lengths and angles.
const MEASURED_LETTERS: &[u8] = b"XYZABCUVWEIJKRQ";

/// Returns true if a program of the run has a length or an angle without a decimal point, besides 0.
pub(super) fn may_lack_points(run: &Run) -> bool {
    let sources = run.control.memory().sources();
    !run.control.settings().uses_calculator_input
        && sources.iter().any(|(_, source)| lacks_point(&source.bytes))
}

/// Returns true if a text has a length or an angle without a decimal point, besides 0, outside its comments.
fn lacks_point(text: &[u8]) -> bool {
    let mut rest = text;
    while let Some((first, after)) = rest.split_first() {
        rest = after;
        if *first == b'(' {
            let end = rest.iter().position(|byte| matches!(byte, b')' | b'\n')).unwrap_or(rest.len());
            rest = &rest[end..];
        } else if MEASURED_LETTERS.contains(&first.to_ascii_uppercase()) {
            let number = rest.trim_ascii_start();
            let number = number.strip_prefix(b"-").or(number.strip_prefix(b"+")).unwrap_or(number);
            let digits = number.iter().take_while(|byte| byte.is_ascii_digit()).count();
            let is_nonzero = number[..digits].iter().any(|digit| *digit != b'0');
            if is_nonzero && number.get(digits) != Some(&b'.') {
                return true;
            }
        }
    }
    false
}

/// Chooses the main program of a file with several programs and returns the note that names the choice, if there is one: the
/// first program, or the first main program if that one is called by another.
pub(super) fn choose_main(memory: &mut Memory, request: &Request) -> Option<Diagnostic> {
    const NAMED: usize = 5;
    let called = programs_called_by_others(memory, &request.settings);
    let (first, mains) = (memory.main(), main_programs(memory, &called));
    let (main, reason) = match mains[..] {
        [main, ref others @ ..] if main != first && called.contains(&first) => {
            let reason = match others {
                [] => "the only program that no other calls",
                _ => "the first program that no other calls",
            };
            (main, reason)
        }
        _ => (first, "the first program"),
    };
    memory.set_main(main);
    let others: Vec<_> = mains.into_iter().filter(|id| *id != main).collect();
    let (shown, rest) = others.split_at(others.len().min(NAMED));
    let paths = shown.iter().map(|id| memory.get(*id).path());
    let others: Vec<_> = paths.chain((!rest.is_empty()).then(|| format!("{} more", rest.len()))).collect();
    let program = memory.get(main);
    let (path, name) = (program.path(), &request.name);
    let message = match others.first() {
        None if main == first => return None,
        None => format!("{path} is executed, {reason} of {name}"),
        Some(_) => format!("{path} is executed, {reason} of {name}, not {}", others.join(", ")),
    };
    let finding = Diagnostic::new(&MAIN_PROGRAM, message);
    let finding = finding.with_backtrace(Backtrace { block: program.span, calls: None });
    Some(finding.help("choose another program with --program"))
}

/// Returns the likely causes of a verdict on holes besides the program's text: another program of the file, unset work offsets.
/// A finding that is one moves from the verdict.
pub(super) fn of_holes(simulation: &Simulation, verdict: &mut Verdict, machine: &Machine) -> Vec<Diagnostic> {
    let mut likely: Vec<Diagnostic> = Vec::new();
    if simulation.extracted.holes.is_empty() && verdict.answer() == Answer::Fail {
        // Another program makes the holes.
        likely.extend(verdict.take_findings(&MAIN_PROGRAM));
    }
    likely.extend(unset_work_offsets(&simulation.run, machine, "holes"));
    likely
}

/// Returns the work offsets used by the run that neither the machine file nor the program sets. Each counts
/// as 0 like G54, so that `made` (“holes” or “flutes”) does not depend on which one is active.
pub(super) fn unset_work_offsets<'r>(
    run: &'r Run,
    machine: &'r Machine,
    made: &'r str,
) -> impl Iterator<Item = Diagnostic> + 'r {
    let unset = run.control.unset_work_offsets().iter();
    unset.map(move |unset| offset_finding(unset, machine, made).with_backtrace(unset.selected.clone()))
}

fn offset_finding(unset: &UnsetWorkOffset, machine: &Machine, made: &str) -> Diagnostic {
    let name = |system: WorkSystem| system.name(machine.dialect);
    let known: Vec<_> = machine.offsets.iter().map(|offset| name(offset.system)).collect();
    let given = match known.as_slice() {
        [] => format!("no work offset; all count as zero here, and the {made} are computed as with G54"),
        known => format!("{} only; this one counts as zero here", known.join(", ")),
    };
    let (offset, axes) = (name(unset.system), machine.axes.names(unset.axes));
    let used = match unset.is_partly_set {
        false => format!("work offset {offset}, which is unknown"),
        true => format!("{axes} of work offset {offset}, of which the program sets other axes only"),
    };
    let message = format!("the program uses {used}: the machine file gives {given}");
    Diagnostic::new(&WORK_OFFSET, message)
        .help("check that it is the offset set up on the machine; its values there are not checked")
}

/// Returns `#8=#8+#7 adds nothing: #7 is 0` for the blocks from `first` to `last` of one file.
pub(super) fn unchanged_counter(control: &Control, first: Span, last: Span) -> Option<String> {
    let sources = control.memory().sources();
    looped_blocks(control, first, last).iter().flat_map(|block| &block.items).find_map(|item| {
        let Item::Statement(statement) = item else { return None };
        let Statement::Assign { target, value } = &statement.node else { return None };
        let ExprKind::Binary(BinaryOp::Add | BinaryOp::Sub, counter, step) = &value.kind else { return None };
        let (target, counter, step) = (number(target)?, number(counter)?, number(step)?);
        let value = match control.variable(step).ok()? {
            Value::Vacant => "vacant",
            Value::Number(0.0) => "0",
            Value::Number(_) => return None,
        };
        let written = sources.text(statement.span);
        (target == counter).then(|| format!("{} adds nothing: #{step} is {value}", written.trim()))
    })
}

/// Returns the help for blocks that repeat without change: how a variable that their conditions test gets another value.
pub(super) fn endless_help(control: &Control, first: Span, last: Span) -> String {
    let is_condition = |item: &Item| match item {
        Item::Statement(statement) => {
            matches!(
                statement.node,
                Statement::While { .. } | Statement::IfGoto { .. } | Statement::IfThen { .. }
            )
        }
        _ => false,
    };
    let mut looped = looped_blocks(control, first, last);
    looped.retain(|block| block.items.iter().any(is_condition));
    let tested: Vec<u32> = looped.iter().flat_map(variables_read).collect();
    let input = tested.iter().find(|number| Settings::is_input(**number));
    let common = || tested.iter().find(|number| is_common(**number));
    match (input, common()) {
        (Some(input), _) => {
            let is_on = control.variable(*input) == Ok(Value::Number(1.0));
            format!("end the wait with --input '#{input}={}'", u8::from(!is_on))
        }
        (None, Some(common)) => format!(
            "change #{common} in the loop, or count the iterations; where the machine's logic or another device changes it, leave the wait \
             out of the run"
        ),
        (None, None) => {
            "end a wait for an input with --input '#1005=1', a main program's M99 P with --cycles 1"
                .to_owned()
        }
    }
}

/// Returns the blocks of a loop in one text.
fn looped_blocks(control: &Control, first: Span, last: Span) -> Vec<Block> {
    if first.source != last.source {
        return Vec::new();
    }
    let programs = parse(first.source, &control.memory().sources().get(first.source).bytes);
    let blocks = programs.into_iter().flat_map(|program| program.blocks);
    blocks.filter(|block| first.start <= block.span.start && block.span.end <= last.end).collect()
}

/// Returns the number of a variable with a literal index.
fn number(expr: &Expr) -> Option<u32> {
    let ExprKind::Variable(index) = &expr.kind else { return None };
    let ExprKind::Literal(literal) = &index.kind else { return None };
    let number = literal.value();
    (number.fract() == 0.0 && (0.0..100_000.0).contains(&number)).then_some(number as u32)
}
