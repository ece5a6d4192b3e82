//! `gcode-sim page`: one program as a page: its path to rotate and to play, its blocks and the values of its variables.
use std::path::PathBuf;

use clap::Args;

use super::conditions::ProgramArguments;
use super::{ExitStatus, UsageError, options, output, page, reference_file};
use gcode_part::NominalPart;
use gcode_session::Criteria;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The page to write
    #[arg(short, long, value_name = "PAGE.html", display_order = 0)]
    output: PathBuf,

    /// The reference, whose holes the page compares: a hole list (JSON or CSV) or a job file (TOML) [default: that of the
    /// program in gcode.toml, or reference.csv beside it]
    #[arg(long, value_name = "REF")]
    reference: Option<PathBuf>,

    #[command(flatten)]
    program: ProgramArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, reference) = reference_file::completed(&arguments.program, arguments.reference.as_deref())?;
    let (mut request, mut folders) =
        options::checked_request(&program, reference.as_deref(), None, Some(&arguments.output))?;
    let nominal = options::nominal_or_motion(reference.as_deref(), &request, &mut folders)?;
    if let (Some(NominalPart::Flutes(_)), Some(path)) = (&nominal, &reference) {
        if arguments.reference.is_some() {
            return Err(UsageError::new(
                "a page shows holes, and the reference is a burr: omit the reference",
            ));
        }
        let note = "the reference of the program is a burr: the page has no verdict";
        output::print_message(&format!("note: {}: {note}\n", path.display()));
    }
    let nominal = nominal.and_then(NominalPart::into_holes);
    let traced = page::judge_traced(&mut request, &mut folders, nominal.as_ref().map(Criteria::of))?;
    page::check_has_moves("page", &traced.0.simulation)?;
    let judged = nominal.as_ref().map(|nominal| (reference.as_deref(), nominal));
    page::write_alone(&request, &traced, judged, &program.conditions, &arguments.output)?;
    output::written("page", &arguments.output, true)?;
    Ok(super::judged(&traced.0.simulation, traced.0.verdict.as_ref()))
}
