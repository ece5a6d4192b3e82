//! Builds the request for a session from the command-line arguments.
use std::path::Path;

use clap::Args;

use super::conditions::ProgramArguments;
use super::library::Folders;
use super::{UsageError, common, input, output, overwrite_guard, page, unused_machine};
use gcode_control::Limits;
use gcode_inspect::machine::{Machine, Probe};
use gcode_lang::motion::{Axes, AxisIndex};
use gcode_lang::program::Library;
use gcode_lang::syntax::ast::ProgramPath;
use gcode_part::NominalPart;
use gcode_part::ProbedPart;
use gcode_part::Reference;
use gcode_part::job::{Rotary, control_file};
use gcode_session::Request;

/// Largest position of --start, mm or degrees, as in [start] of a machine file.
const MAX_START: f64 = 100_000.0;

/// Reads the program and the machine, and applies every setting in order.
pub(super) fn request(program: &ProgramArguments) -> Result<(Request, Folders), UsageError> {
    let ProgramArguments { program, conditions: arguments } = program;
    let machine = match &arguments.machine {
        Some(path) => read_machine(path)?,
        None => Machine::default(),
    };
    let folders = Folders::new(program, &arguments.libraries)?;
    let piped = program == Path::new("-");
    let name = if piped { "standard input".to_owned() } else { program.display().to_string() };
    let mut request = Request::new(name, input::program(program)?, machine);
    if let Some(text) = &arguments.main_program {
        let path = ProgramPath::parse(text);
        let path = path.ok_or_else(|| UsageError::new("--program: write an O number or a name, O1234"))?;
        request.main = Some(path);
    }
    // The dialect comes first: the control file and `--control` change its defaults.
    if let Some(name) = &arguments.dialect {
        let taken = request.settings.set("DIALECT", name);
        taken.map_err(|error| UsageError::new(format!("--dialect: {error}")))?;
    }
    if let Some(path) = &arguments.control_file {
        refuse_other_kind("--control-file", "a file with settings of the control", path)?;
        control_file::apply(&input::text(path)?, &mut request.settings, arguments.dialect.is_none())
            .map_err(|error| UsageError::in_toml(path, &error))?;
    }
    let settings = [
        ("--control", arguments.control.clone()),
        ("--input", arguments.input.clone()),
        ("--code", arguments.code.clone()),
        ("--cycles", arguments.cycles.iter().map(|count| format!("CYCLES={count}")).collect()),
        ("--skip", arguments.skip.iter().map(|part| format!("SKIP={part}")).collect::<Vec<_>>()),
    ];
    for (flag, text) in settings.iter().flat_map(|(flag, texts)| texts.iter().map(move |text| (flag, text))) {
        let Some((key, value)) = text.split_once('=') else {
            return Err(UsageError::new(format!("{flag} {text}: write KEY=VALUE, for example NAT=1")));
        };
        let taken = request.settings.set(key.trim(), value.trim());
        taken.map_err(|error| UsageError::new(format!("{flag}: {error}")))?;
    }
    for text in &arguments.set {
        // An item of a parameter, #30057.25, is a value of the machine.
        if let Some((key, value)) = text.split_once('=').filter(|(key, _)| key.contains('.')) {
            let taken = request.settings.set(key.trim(), value);
            taken.map_err(|error| UsageError::new(format!("--set: {error}")))?;
            continue;
        }
        request.variables.push(assignment(text)?);
    }
    for text in &arguments.start {
        let (axis, position) = start_position(text, &request.settings.axes)?;
        request.machine.start.retain(|(other, _)| *other != axis);
        request.machine.start.push((axis, position));
    }
    request.limits = Limits { blocks: arguments.max_blocks };
    if let Some(path) = &arguments.part {
        apply_part(&mut request, path, arguments.machine.as_deref())?;
    }
    Ok((request, folders))
}

/// Refuses a second use of standard input, a result or page that would overwrite an input, and a page that is not an
/// HTML file.
pub(super) fn check_files(
    inputs: &[&Path],
    result: Option<&Path>,
    page: Option<&Path>,
) -> Result<(), UsageError> {
    overwrite_guard::one_pipe(inputs)?;
    for result in [result, page].into_iter().flatten() {
        overwrite_guard::check_not_input(result, inputs)?;
    }
    page.map_or(Ok(()), page::check_is_html)
}

/// Reads the program of a command with its conditions, checks its files, and warns of an unused machine file.
pub(super) fn checked_request(
    program: &ProgramArguments,
    reference: Option<&Path>,
    result: Option<&Path>,
    page: Option<&Path>,
) -> Result<(Request, Folders), UsageError> {
    let files = std::iter::once(program.program.as_path()).chain(program.conditions.files());
    check_files(&files.chain(reference).collect::<Vec<_>>(), result, page)?;
    let (request, folders) = request(program)?;
    unused_machine::warn_unused_machine(program, &request);
    Ok((request, folders))
}

/// Adds a part for probing to the request; `file` is the machine file, for messages.
fn apply_part(request: &mut Request, path: &Path, file: Option<&Path>) -> Result<(), UsageError> {
    let refused = |why: &dyn std::fmt::Display| UsageError::in_file(path, why);
    if request.settings.skip_signal.is_some() {
        return Err(UsageError::new(
            "--part: --control SKIP=… or --skip already sets the skip signal: omit one of them",
        ));
    }
    refuse_program("--part", "a job file or a list of holes", path)?;
    let stock = request.machine.stock.as_ref();
    let part = ProbedPart::parse(&input::table(path)?, stock);
    let part = part.map_err(|error| UsageError::in_toml(path, &error))?;
    match (&request.machine.probe, part.radius) {
        (None, Some(radius)) => request.machine.probe = Some(Probe::new(radius)),
        (None, None) => {
            let message = "--part: the radius of the stylus ball is missing: give [probe] with its radius \
                           in the machine file";
            return Err(UsageError::new(message));
        }
        (Some(probe), Some(radius)) if probe.radius != radius => {
            return Err(refused(&format!(
                "key 'probe.radius' is {radius}, and {} in the machine file: make them equal",
                probe.radius
            )));
        }
        (Some(_), _) => {}
    }
    if let Some(rotary) = part.rotary {
        let machine = file.map_or("the default machine".to_owned(), |file| file.display().to_string());
        same_rotary(rotary, &request.machine, &machine).map_err(|why| refused(&why))?;
    }
    request.part = Some(part.solid);
    Ok(())
}

/// Checks that the machine rotates the part as the job specifies. With different signs a fit cannot
/// determine which is right.
fn same_rotary(rotary: Rotary, machine: &Machine, file: &str) -> Result<(), String> {
    let letter = rotary.letter;
    let sign = machine.axes.find(letter as u8).and_then(|axis| machine.table.rotary_sign(axis));
    let Some(sign) = sign else {
        return Err(format!(
            "key 'machine.rotary.letter' is {letter}, and {file} has no [[table]] with this letter that \
             rotates the part: give the job's machine file"
        ));
    };
    if sign == f64::from(rotary.sign) {
        return Ok(());
    }
    Err(format!(
        "key 'machine.rotary.sign' is {}, and {file} has sign = {sign} in [[table]] {letter}: command \
         {letter} 10 at the machine, observe the direction of the part and correct the wrong sign",
        rotary.sign
    ))
}

/// Reads a machine file.
pub(super) fn read_machine(path: &Path) -> Result<Machine, UsageError> {
    refuse_other_kind("--machine", "a machine file (machine.toml)", path)?;
    Machine::parse(&input::text(path)?).map_err(|error| UsageError::in_toml(path, &error))
}

/// Refuses a list of holes or a program where a TOML file is required.
fn refuse_other_kind(flag: &str, required: &str, path: &Path) -> Result<(), UsageError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if !matches!(ending.as_deref(), Some("csv" | "json")) {
        return refuse_program(flag, required, path);
    }
    let found = "a list of holes: it goes behind --reference";
    Err(UsageError::new(format!("{flag} {}: {required} is required, and this is {found}", path.display())))
}

/// Refuses a program where another file is required.
fn refuse_program(flag: &str, required: &str, path: &Path) -> Result<(), UsageError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if matches!(ending.as_deref(), Some("toml" | "csv" | "json")) || input::program(path).is_err() {
        return Ok(());
    }
    let found = "a program: it is given alone";
    Err(UsageError::new(format!("{flag} {}: {required} is required, and this is {found}", path.display())))
}

/// Reads a hole list or a job file, and says what a list leaves out. Depths that it leaves out are those of the program's holes.
pub(super) fn read_nominal(
    path: &Path,
    request: &Request,
    library: &mut impl Library,
) -> Result<NominalPart, UsageError> {
    let text = input::table(path)?;
    let mut nominal = NominalPart::parse(&text).map_err(|error| UsageError::in_toml(path, &error))?;
    if let NominalPart::Holes(reference) = &mut nominal {
        if let Some(note) = &reference.note {
            output::print_message(&format!("note: {}: {note}\n", path.display()));
        }
        gcode_session::complete_depths(request, library, reference)?;
    }
    Ok(nominal)
}

/// Reads the reference of a verdict; where none is named, that without holes if the machine file states the stock in which the
/// motion is judged.
pub(super) fn nominal_to_verify(
    path: Option<&Path>,
    request: &Request,
    library: &mut impl Library,
) -> Result<Option<NominalPart>, UsageError> {
    match path {
        Some(path) => read_nominal(path, request, library).map(Some),
        None => Ok(request.can_judge_motion().then(|| NominalPart::Holes(Reference::without_holes()))),
    }
}

/// Reads the reference; where none is named, that without holes of a program whose motion alone can be judged.
pub(super) fn nominal_or_motion(
    path: Option<&Path>,
    request: &Request,
    library: &mut impl Library,
) -> Result<Option<NominalPart>, UsageError> {
    match path {
        Some(path) => read_nominal(path, request, library).map(Some),
        None => Ok(gcode_session::motion_reference(request, library)?.map(NominalPart::Holes)),
    }
}

/// Returns the reference of a command that shows holes; a burr is refused with this sentence.
pub(super) fn holes_of(nominal: Option<NominalPart>, refusal: &str) -> Result<Option<Reference>, UsageError> {
    let refused = |nominal: NominalPart| nominal.into_holes().ok_or_else(|| UsageError::new(refusal));
    nominal.map(refused).transpose()
}

/// Reads the reference of a command that shows holes; a burr is refused with this sentence.
pub(super) fn read_holes(
    path: Option<&Path>,
    request: &Request,
    library: &mut impl Library,
    refusal: &str,
) -> Result<Option<Reference>, UsageError> {
    holes_of(path.map(|path| read_nominal(path, request, library)).transpose()?, refusal)
}

/// Tolerance of the commands that compare two runs.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct EqualityArguments {
    /// Tolerance for equality, mm or degrees
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 0.0001,
        allow_negative_numbers = true,
        value_parser = common::number
    )]
    tolerance: f64,
}

impl EqualityArguments {
    /// Returns the tolerance; an error unless it is a length above 0.
    pub(super) fn tolerance(self) -> Result<f64, UsageError> {
        Ok(tolerance("--tolerance", Some(self.tolerance))?.unwrap_or_default())
    }
}

/// Checks the value of a tolerance flag.
pub(super) fn tolerance(flag: &str, value: Option<f64>) -> Result<Option<f64>, UsageError> {
    match value {
        Some(mm) if !(mm.is_finite() && mm > 0.0) => {
            Err(UsageError::new(format!("{flag} {mm}: a length above 0 mm")))
        }
        value => Ok(value),
    }
}

/// Parses `#500=12.5`.
fn assignment(text: &str) -> Result<(u32, f64), UsageError> {
    let parsed = text.trim().strip_prefix('#').and_then(|rest| {
        let (number, value) = rest.split_once('=')?;
        let value = value.trim().parse::<f64>().ok().filter(|v| v.is_finite())?;
        Some((number.trim().parse().ok()?, value))
    });
    parsed.ok_or_else(|| UsageError::new(format!("--set {text}: write a variable and a number, '#500=12.5'")))
}

/// Parses `Z=250.`.
fn start_position(text: &str, axes: &Axes) -> Result<(AxisIndex, f64), UsageError> {
    let parsed = text.split_once('=').and_then(|(letter, value)| {
        let [letter] = letter.trim().as_bytes() else { return None };
        let value = value.trim().parse::<f64>().ok().filter(|value| value.abs() <= MAX_START)?;
        Some((axes.find(letter.to_ascii_uppercase())?, value))
    });
    parsed.ok_or_else(|| {
        let letters: String = axes.iter().map(|(_, letter)| letter).collect();
        UsageError::new(format!(
            "--start {text}: write one of the control's axes {letters} and a position of -{MAX_START} to \
             {MAX_START} (mm and degrees), Z=250."
        ))
    })
}

/// Parses `#5041`.
pub(super) fn variable(text: &str) -> Result<u32, UsageError> {
    let number = text.trim().strip_prefix('#').and_then(|digits| digits.parse().ok());
    number.ok_or_else(|| UsageError::new(format!("--show {text}: write a variable, '#5041'")))
}
