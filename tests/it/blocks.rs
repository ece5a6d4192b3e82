//! What the emitted macros cost a control: blocks executed for each hole or flute of the examples.
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use gcode_control::{Control, Outcome};
use gcode_gen::check::Programs;
use gcode_gen::families;
use gcode_gen::package::file_name;
use gcode_inspect::machine::Machine;
use gcode_lang::program::Memory;
use gcode_part::NominalPart;
use gcode_part::job::Job;
use gcode_session::Request;

/// Blocks executed of each program, by the name of its file.
fn blocks(job: &Job) -> BTreeMap<String, u64> {
    let package = families::emit(job);
    let main = package.program(package.mains[0]).unwrap();
    let name = file_name(main.number);
    let request = Request::new(name.clone(), main.text.as_bytes(), Machine::parse(&package.machine).unwrap());
    let mut memory = Memory::default();
    memory.load(name, request.bytes);
    let mut control = Control::new(memory, request.settings);
    let mut library = Programs(&package);
    let mut counted = BTreeMap::new();
    let outcome = loop {
        let outcome = control.step(&mut library, &mut ());
        let source = control.memory().sources().get(control.backtrace().block.source);
        *counted.entry(source.name.clone()).or_insert(0) += 1;
        if let Some(outcome) = outcome {
            break outcome;
        }
    };
    assert!(matches!(outcome, Outcome::End), "{outcome:?}");
    counted
}

#[test]
fn the_macros_cost_so_many_blocks_for_each_hole() {
    let mut shown = String::new();
    for example in ["melon-mould", "honeycomb", "burr"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("examples").join(example);
        let job = Job::parse(&std::fs::read_to_string(path.join("job.toml")).unwrap()).unwrap();
        let (wanted, what) = match NominalPart::from_job(&job).unwrap() {
            NominalPart::Holes(holes) => (holes.holes.len(), "hole"),
            NominalPart::Flutes(flutes) => (flutes.count as usize, "flute"),
        };
        let package = families::emit(&job);
        for (name, blocks) in blocks(&job) {
            let each = blocks as f64 / wanted as f64;
            let program = package.programs.iter().find(|program| file_name(program.number) == name).unwrap();
            if !package.mains.contains(&program.number) {
                let said = format!("BLOCKS A {}: {each:.0})", what.to_uppercase());
                assert!(program.text.contains(&said), "the header of {name} says {said}");
            }
            writeln!(shown, "{example} {name}: {each:.1} blocks a {what}, {blocks} in all").unwrap();
        }
    }
    insta::assert_snapshot!(shown);
}
