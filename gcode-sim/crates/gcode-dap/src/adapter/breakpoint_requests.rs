//! Requests that set breakpoints.
use super::typed_values::target;
use super::{Adapter, Answer, Host, RequestedLines, body};
use crate::debuggee::{
    BAD_HOLE, BlockPlace, Breakpoint, Conditions, FILTERS, Filters, HitCondition, LogMessage, ProgramPlace,
    VariablePlace, values,
};
use crate::protocol::arguments::{
    BreakpointConditions, DataBreakpoint, DataBreakpointInfo, FunctionBreakpoint, SetBreakpoints,
    SetDataBreakpoints, SetExceptionBreakpoints, SetFunctionBreakpoints, SourceBreakpoint,
};
use crate::protocol::bodies::{self, BreakpointChange, Breakpoints, FilterAnswer, FilterAnswers};
use gcode_control::static_eval::VariableTable;
use gcode_lang::control::Settings;
use gcode_lang::program::Expression;
use gcode_lang::syntax::ast::{ProgramName, ProgramPath};

/// Largest number of a local.
const LAST_LOCAL: u32 = 33;

impl<H: Host> Adapter<H> {
    pub(super) fn set_breakpoints(&mut self, arguments: &SetBreakpoints) -> Answer {
        let (path, canonical) = self.paths_of(&arguments.source)?;
        self.files.name(&canonical, &path);
        let by_line = |line: &i64| SourceBreakpoint { line: *line, ..SourceBreakpoint::default() };
        let requested = match &arguments.breakpoints {
            Some(requested) => requested.clone(),
            None => arguments.lines.iter().map(by_line).collect(),
        };
        let with_id = |one| (self.breakpoints.next_id(), one);
        let requested = RequestedLines {
            source: arguments.source.clone(),
            breakpoints: requested.into_iter().map(with_id).collect(),
            answers: Vec::new(),
        };
        let answers = self.set_lines(&canonical, requested);
        body(Breakpoints { breakpoints: answers })
    }

    /// Sets the breakpoints of a file at their blocks, and keeps the request for the next run.
    fn set_lines(&mut self, canonical: &str, mut requested: RequestedLines) -> Vec<bodies::Breakpoint> {
        let (mut answers, mut set) = (Vec::new(), Vec::new());
        for (id, one) in &requested.breakpoints {
            let source =
                self.files.client_path(canonical).map(str::to_owned).map(|path| self.named_source(&path));
            let conditions = conditions(&one.conditions);
            let found = conditions.and_then(|conditions| {
                let (_, site) = self.block_at(&requested.source, one.line, one.column)?;
                Ok((conditions, site))
            });
            answers.push(match found {
                Ok((conditions, site)) => {
                    let place = BlockPlace { path: canonical.to_owned(), start: site.start };
                    set.push(Breakpoint::new(*id, place, conditions));
                    let (line, column) = (self.client_line(site.line), self.client_column(site.column));
                    let (line, column) = (Some(line), Some(column));
                    bodies::Breakpoint { id: *id, verified: true, message: None, source, line, column }
                }
                Err(message) => bodies::Breakpoint {
                    id: *id,
                    message: Some(message),
                    source,
                    line: Some(one.line),
                    ..bodies::Breakpoint::default()
                },
            });
        }
        if let Some(session) = &mut self.session {
            session.debuggee.breakpoints_mut().replace_lines(canonical, set);
        }
        requested.answers.clone_from(&answers);
        self.breakpoints.lines.insert(canonical.to_owned(), requested);
        answers
    }

    /// Finds the blocks of all breakpoints on lines in the texts of a new run, and reports the changed ones.
    pub(super) fn set_lines_again(&mut self) {
        for (canonical, requested) in std::mem::take(&mut self.breakpoints.lines) {
            let before = requested.answers.clone();
            let answers = self.set_lines(&canonical, requested);
            for (breakpoint, _) in answers.into_iter().zip(before).filter(|(now, before)| now != before) {
                self.outbox.event("breakpoint", BreakpointChange { reason: "changed", breakpoint });
            }
        }
    }

    pub(super) fn set_function_breakpoints(&mut self, arguments: &SetFunctionBreakpoints) -> Answer {
        let (mut answers, mut set) = (Vec::new(), Vec::new());
        for one in &arguments.breakpoints {
            let id = self.breakpoints.next_id();
            let found = program_place(one).and_then(|place| Ok((place, conditions(&one.conditions)?)));
            let missing = found.as_ref().ok().and_then(|(place, _)| self.missing_program(place));
            answers.push(answer(id, found.as_ref().err().or(missing.as_ref())));
            set.extend(found.ok().map(|(place, conditions)| Breakpoint::new(id, place, conditions)));
        }
        if let Some(session) = &mut self.session {
            session.debuggee.breakpoints_mut().replace_programs(set.clone());
        }
        self.breakpoints.programs = set;
        body(Breakpoints { breakpoints: answers })
    }

    /// Returns why a breakpoint on a program can't be hit; `None` before the launch, when nothing is known of it.
    fn missing_program(&mut self, place: &ProgramPlace) -> Option<String> {
        let debuggee = &mut self.session.as_mut()?.debuggee;
        let name = place.name.as_ref();
        if let Some(name) = name.filter(|name| !debuggee.has_program(name)) {
            return Some(format!("{} is not in the program's file, its folder or the library", name.label()));
        }
        let number = place.number.filter(|number| !debuggee.has_number(name, *number))?;
        let program = name.map_or_else(|| "the main program".to_owned(), ProgramName::label);
        Some(format!("{program} has no block N{number}"))
    }

    /// Reports the breakpoints on programs, set before the launch, that can't be hit.
    pub(super) fn report_missing_programs(&mut self) {
        for one in self.breakpoints.programs.clone() {
            if let Some(reason) = self.missing_program(&one.place) {
                let breakpoint = answer(one.id, Some(&reason));
                self.outbox.event("breakpoint", BreakpointChange { reason: "changed", breakpoint });
            }
        }
    }

    pub(super) fn data_breakpoint_info(&mut self, arguments: &DataBreakpointInfo) -> Answer {
        let common = literal_number(&arguments.name).filter(|number| *number > LAST_LOCAL);
        let level = match (common, arguments.variables_reference.filter(|reference| *reference > 0)) {
            (Some(_), _) => 0,
            (None, Some(reference)) => self.level_of_scope(reference)?,
            (None, None) => self.level_of_frame(arguments.frame_id)?,
        };
        let refused = |description: String| bodies::DataBreakpointInfo {
            data_id: None,
            description,
            access_types: Vec::new(),
            can_persist: false,
        };
        let number = match common {
            Some(number) => Ok(number),
            None => target(self.standing()?.debuggee.control(), &arguments.name, level),
        };
        let settings = self.settings();
        body(match number {
            Ok(number @ (0 | 3000 | 3006)) => refused(format!("#{number} keeps no value")),
            Ok(number) if !is_variable(number, &settings) => {
                refused(format!("#{number} is no variable of this control"))
            }
            Ok(number) => {
                let is_local = (1..=LAST_LOCAL).contains(&number);
                let data_id = if is_local { format!("#{number}@{level}") } else { format!("#{number}") };
                bodies::DataBreakpointInfo {
                    data_id: Some(data_id),
                    description: format!("#{number}"),
                    access_types: match is_written(number, &settings) {
                        true => vec!["read", "write", "readWrite"],
                        false => vec!["read"],
                    },
                    can_persist: !is_local,
                }
            }
            Err(_) => refused(format!("{} is no variable", arguments.name)),
        })
    }

    /// Returns the settings of the launched control, before the launch those of a control without options.
    fn settings(&self) -> Settings {
        self.session.as_ref().map(|session| session.request.settings.clone()).unwrap_or_default()
    }

    pub(super) fn set_data_breakpoints(&mut self, arguments: &SetDataBreakpoints) -> Answer {
        let settings = self.settings();
        let (mut answers, mut set) = (Vec::new(), Vec::new());
        for one in &arguments.breakpoints {
            let id = self.breakpoints.next_id();
            let found = variable_place(one).and_then(|place| {
                let is_never_written = !place.on_read && !is_written(place.number, &settings);
                let refused = || format!("#{} is written by no program: break on its read", place.number);
                (!is_never_written).then_some(place).ok_or_else(refused)
            });
            let found = found.and_then(|place| Ok((place, conditions(&one.conditions)?)));
            answers.push(answer(id, found.as_ref().err()));
            set.extend(found.ok().map(|(place, conditions)| Breakpoint::new(id, place, conditions)));
        }
        if let Some(session) = &mut self.session {
            session.debuggee.breakpoints_mut().replace_variables(set.clone());
        }
        self.breakpoints.variables = set;
        body(Breakpoints { breakpoints: answers })
    }

    pub(super) fn set_exception_breakpoints(&mut self, arguments: &SetExceptionBreakpoints) -> Answer {
        let lacks_reference = self.session.as_ref().is_some_and(|session| session.reference.is_none());
        let answer = |filter: &String| {
            let is_known = FILTERS.iter().any(|row| row.filter == filter);
            let message = match filter.as_str() {
                _ if !is_known => Some(format!("there is no filter '{filter}'")),
                BAD_HOLE if lacks_reference => Some("give 'reference' in the launch".to_owned()),
                _ => None,
            };
            FilterAnswer { verified: message.is_none(), message }
        };
        let breakpoints = arguments.filters.iter().map(answer).collect();
        self.breakpoints.filters = Filters::of(arguments.filters.iter().map(String::as_str));
        if let Some(session) = &mut self.session {
            session.debuggee.set_filters(self.breakpoints.filters.clone());
        }
        body(FilterAnswers { breakpoints })
    }
}

/// Returns true for a variable that a program of this control can read or write.
fn is_variable(number: u32, settings: &Settings) -> bool {
    VariableTable::new(settings).read(number).is_ok() || is_written(number, settings)
}

/// Returns true for a variable that a program can write.
fn is_written(number: u32, settings: &Settings) -> bool {
    VariableTable::new(settings).write(number).is_ok()
}

/// Returns the number of a variable written as `#100`.
fn literal_number(text: &str) -> Option<u32> {
    text.trim().strip_prefix('#')?.parse().ok()
}

/// Returns the answer to a breakpoint that has no line.
fn answer(id: i64, refusal: Option<&String>) -> bodies::Breakpoint {
    bodies::Breakpoint {
        id,
        verified: refusal.is_none(),
        message: refusal.cloned(),
        ..bodies::Breakpoint::default()
    }
}

/// Reads the conditions of a breakpoint; an empty text is none.
fn conditions(given: &BreakpointConditions) -> Result<Conditions, String> {
    let text = |text: &Option<String>| text.clone().filter(|text| !text.trim().is_empty());
    let condition = text(&given.condition).map(|text| {
        Expression::parse(&text).map_err(|alarm| format!("condition '{text}': {}", values::alarm(&alarm)))
    });
    Ok(Conditions {
        condition: condition.transpose()?,
        hits: text(&given.hit_condition).map(|text| HitCondition::parse(&text)).transpose()?,
        log: text(&given.log_message).map(|text| LogMessage::parse(&text)).transpose()?,
    })
}

/// Reads `O8101`, `O8101 N20`, or `N20` of the main program.
fn program_place(one: &FunctionBreakpoint) -> Result<ProgramPlace, String> {
    let refused = || format!("'{}': write a program, O8101, or a sequence number in it, O8101 N20", one.name);
    let mut words = one.name.split_whitespace();
    let first = words.next().ok_or_else(refused)?;
    let number = |word: &str| word.strip_prefix(['N', 'n'])?.parse::<u32>().ok();
    let (name, number) = match (number(first), words.next()) {
        (Some(number), None) => (None, Some(number)),
        (_, None) => (Some(first), None),
        (_, Some(second)) => (Some(first), Some(number(second).ok_or_else(refused)?)),
    };
    if words.next().is_some() {
        return Err(refused());
    }
    let name = name.map(|name| ProgramPath::parse(name).ok_or_else(refused)).transpose()?;
    Ok(ProgramPlace { name: name.map(|path| path.name), number })
}

/// Reads `#100`, or `#1@2`: #1 of macro level 2.
fn variable_place(one: &DataBreakpoint) -> Result<VariablePlace, String> {
    let refused = || format!("'{}' is no data id", one.data_id);
    let text = one.data_id.trim().strip_prefix('#').ok_or_else(refused)?;
    let (number, level) = match text.split_once('@') {
        Some((number, level)) => (number, Some(level.parse().map_err(|_| refused())?)),
        None => (text, None),
    };
    let number = number.parse().map_err(|_| refused())?;
    let (on_write, on_read) = match one.access_type.as_deref() {
        None | Some("write") => (true, false),
        Some("read") => (false, true),
        Some("readWrite") => (true, true),
        Some(other) => return Err(format!("'{other}' is no access type: read, write or readWrite")),
    };
    Ok(VariablePlace { number, level, on_write, on_read })
}
