//! Controls before their first block: the programs of a request, its settings, and what the machine file states.
use super::{Request, SessionError, causes, error};
use gcode_control::Control;
use gcode_inspect::machine::Machine;
use gcode_lang::control::{SettingError, Settings};
use gcode_lang::diag::Diagnostic;
use gcode_lang::program::Memory;

impl Request {
    /// Returns the request with settings, by keys and values, in place of its own.
    ///
    /// # Errors
    /// An unknown key, or a value that it does not take.
    pub fn with_settings(&self, settings: &[(String, String)]) -> Result<Self, SettingError> {
        let mut request = self.clone();
        for (key, value) in settings {
            request.settings.set(key, value)?;
        }
        Ok(request)
    }
}

/// Returns a control before its first block, set up as [`crate::run`] does; `call` is a block to run instead of the program, which it
/// can call.
///
/// # Errors
/// See [`crate::run`].
pub fn set_up(request: &Request, call: Option<&str>) -> Result<Control, SessionError> {
    let (mut memory, _) = load(request)?;
    if let Some(call) = call {
        memory.load("--call", format!("{call}\nM30\n").into_bytes());
        if let Some(main) = memory.ids().last() {
            memory.set_main(main);
        }
    }
    set_up_control(request, memory)
}

/// Loads the programs of a request; returns the note that the file has further main programs.
pub(super) fn load(request: &Request) -> Result<(Memory, Option<Diagnostic>), SessionError> {
    let mut memory = Memory::default();
    memory.load(request.name.clone(), request.bytes.clone());
    if memory.programs().is_empty() {
        return Err(SessionError::NoProgram { name: request.name.clone() });
    }
    if let Some(path) = &request.main {
        let main = memory.find_path(path).ok_or_else(|| error::no_such_program(request, &memory, path))?;
        memory.set_main(main);
    }
    if let Some(second) = memory.duplicates().next() {
        let (line, program) = (memory.sources().line_column(second.span).line, second.label());
        return Err(SessionError::DuplicateProgram { name: request.name.clone(), line, program });
    }
    let is_choice_open = request.main.is_none() && memory.programs().len() > 1;
    let main_note = is_choice_open.then(|| causes::choose_main(&mut memory, request)).flatten();
    Ok((memory, main_note))
}

/// Returns a control with these programs, set up as the request states.
pub(super) fn set_up_control(request: &Request, memory: Memory) -> Result<Control, SessionError> {
    set_up_control_behind(request, memory, None)
}

/// Returns a control set up like [`set_up_control`], with the offsets and modes that the run before has left.
pub(super) fn set_up_control_behind(
    request: &Request,
    memory: Memory,
    left: Option<&Control>,
) -> Result<Control, SessionError> {
    let mut control = Control::new(memory, request.settings.clone());
    let presets = presets(&request.machine, &request.settings);
    let refused = |number| move |alarm| SessionError::Variable { number, alarm };
    for (number, value) in presets {
        control.set_metric_variable(number, value).map_err(refused(number))?;
    }
    for (number, value) in request.variables.iter().copied() {
        control.set_variable(number, value).map_err(refused(number))?;
    }
    if let Some(left) = left {
        control.take_left_state(left);
    }
    for (axis, position) in &request.machine.start {
        control.set_start(*axis, *position);
    }
    Ok(control)
}

/// Returns the variables of a machine that is set up: work offsets (#5221…, #14001…), and the length offsets and cutter radii as
/// geometry offsets H and D (#11001…, #13001…, or #2001…, #2401… on a Haas).
fn presets<'a>(machine: &'a Machine, settings: &'a Settings) -> impl Iterator<Item = (u32, f64)> + 'a {
    let work = machine.offsets.iter().flat_map(|offset| {
        let first = offset.system.first_variable();
        (0..machine.axes.len()).map(move |axis| {
            let stated = offset.values.iter().find(|(stated, _)| *stated == axis);
            (first + axis as u32, stated.map_or(0.0, |(_, value)| *value))
        })
    });
    let tools =
        machine.tools.iter().filter(|tool| (1..=settings.tool_offsets).contains(&(tool.number as usize)));
    let offsets = tools.flat_map(move |tool| {
        let unit = if settings.has_diameter_offsets() { 2.0 } else { 1.0 };
        let length = settings.length_variable(tool.number).zip(tool.stated_length_offset());
        let radius =
            settings.radius_variable(tool.number).zip(tool.radius_offset.map(|radius| radius * unit));
        length.into_iter().chain(radius)
    });
    work.chain(offsets)
}
