//! What the emitted macros cost a control: blocks executed for each hole or flute of the examples.
use std::collections::BTreeMap;
use std::fmt::Write;

use gcode_control::{Control, Outcome};
use gcode_gen::check::Programs;
use gcode_gen::package::file_name;
use gcode_lang::program::Memory;
use gcode_part::NominalPart;
use gcode_tests::bench::Bench;

/// Blocks executed of each program, by the name of its file.
fn blocks(bench: &Bench) -> BTreeMap<String, u64> {
    let request = bench.request(bench.package.mains[0]);
    let mut memory = Memory::default();
    memory.load(request.name, request.bytes);
    let mut control = Control::new(memory, request.settings);
    let mut library = Programs(&bench.package);
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
fn the_macros_head_states_the_blocks_for_each_hole_or_flute() {
    let mut shown = String::new();
    for example in ["melon-mould", "honeycomb", "burr"] {
        let bench = Bench::example(example, &[]);
        let (count, what) = match NominalPart::from_job(&bench.job).unwrap() {
            NominalPart::Holes(holes) => (holes.holes.len(), "hole"),
            NominalPart::Flutes(flutes) => (flutes.count as usize, "flute"),
        };
        let package = &bench.package;
        for (name, blocks) in blocks(&bench) {
            let each = blocks as f64 / count as f64;
            let program = package.programs.iter().find(|program| file_name(program.number) == name).unwrap();
            if !package.mains.contains(&program.number) {
                let head = format!("BLOCKS A {}: {each:.0})", what.to_uppercase());
                assert!(program.text.contains(&head), "the head of {name} must state {head}");
            }
            writeln!(shown, "{example} {name}: {each:.1} blocks a {what}, {blocks} in all").unwrap();
        }
    }
    insta::assert_snapshot!(shown);
}
