//! Draws a burr's flutes as its job's programs grind them, or as the program `case.nc` does: cases of kind `picture` that have
//! a `job.toml`.
use gcode_draw::{Picture, helix_graph, side_view, tip_view};
use gcode_gen::families;
use gcode_inspect::machine::Machine;
use gcode_lang::program::NoLibrary;
use gcode_part::NominalPart;
use gcode_part::job::Job;
use gcode_session::{Request, grind};
use gcode_sim::report::flute_view;

/// Returns the picture of one view; the job's form must be `moves`, for there is no library here.
pub(super) fn picture(job: &str, program: Option<String>, view: &str) -> Picture {
    let job = Job::parse(job).unwrap();
    let package = families::emit(&job);
    let main = package.main().unwrap();
    let machine = Machine::parse(&package.machine).unwrap();
    let text = program.unwrap_or_else(|| main.text.clone());
    let request = Request::new("O8400.nc", text.as_bytes(), machine);
    let NominalPart::Flutes(flutes) = NominalPart::from_job(&job).unwrap() else {
        panic!("the job is no burr")
    };
    let grinding = grind(&request, &mut NoLibrary, &flutes).unwrap();
    let view_of = flute_view::of("O8400.nc", &grinding, &grinding.verify(&request));
    match view {
        "side" => side_view(&view_of),
        "tip" => tip_view(&view_of),
        "helix" => helix_graph(&view_of),
        other => panic!("a burr is seen from the side, the tip, or as its helix angle, not {other}"),
    }
}
