//! Sites of findings on flutes, by pass and by place on the burr.
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::PartPoint;
use gcode_lang::program::NoLibrary;
use gcode_part::NominalPart;
use gcode_session::{GrindingRun, Request, grind};
use gcode_tests::root;
use gcode_tests::verify::{machine_of, reference_of};
use nalgebra::Vector3;

/// The sites of the finding of that code.
fn sites((request, grinding): &(Request, GrindingRun), code: &str) -> Vec<PartPoint> {
    let verdict = grinding.verify(request);
    let finding = verdict.findings.iter().find(|finding| finding.code == code);
    finding.unwrap_or_else(|| panic!("no {code} in {:?}", verdict.findings)).sites.clone()
}

fn run(program: &str, machine: &str, reference: &str) -> (Request, GrindingRun) {
    let machine = Machine::parse(machine).unwrap();
    let NominalPart::Flutes(nominal) = NominalPart::parse(reference).unwrap() else { panic!("a burr") };
    let request = Request::new("case.nc", program.as_bytes(), machine);
    let grinding = grind(&request, &mut NoLibrary, &nominal).unwrap();
    (request, grinding)
}

/// Program, machine and reference of a case of kind `verify`.
fn case(name: &str) -> [String; 3] {
    let folder = root().join("verify").join(name);
    let program = std::fs::read_to_string(folder.join("case.nc")).unwrap();
    [program, machine_of(&folder).unwrap(), reference_of(&folder).unwrap()]
}

/// Of four flutes a quarter apart the fourth is missing: its place is across from the second.
#[test]
fn the_site_of_a_missing_flute_is_its_nominal_place() {
    let [program, machine, reference] = &case("a_missing_flute_is_counted");
    let grinding = run(program, machine, reference);
    let [site] = sites(&grinding, "flute-missing")[..] else { panic!("one is missing") };
    assert_eq!(site.pass, None);
    let [x, y, z] = site.at;
    // Halfway from 4 to −6·cos 30° it is the ball: r² = 36 − x² but for the foot's own place.
    assert!((x + 0.598).abs() < 0.01 && (Vector3::new(x, y, z).norm() - 6.0).abs() < 1e-9, "{site:?}");
    let across = grinding.1.result.passes[1].trace.angle_at(x).unwrap();
    let radius = Vector3::new(0.0, y, z).norm();
    let (there, here) = ([radius * across.cos(), -radius * across.sin()], [y, z]);
    assert!((there[0] + here[0]).abs() < 0.01 && (there[1] + here[1]).abs() < 0.01, "{there:?} {here:?}");
}

/// Of four flutes two neighbours: half the burr is bare, with room for the other two.
#[test]
fn each_of_several_missing_flutes_has_its_site() {
    let [program, machine, reference] = &case("a_missing_flute_is_counted");
    let found = sites(&run(&program.replace("LT 3]", "LT 2]"), machine, reference), "flute-missing");
    let [one, other] = found[..] else { panic!("{found:?}") };
    let across = one.at[1] * other.at[1] + one.at[2] * other.at[2];
    assert!(across.abs() < 0.01, "a quarter apart: {found:?}");
}

/// Each flute of the other hand is wrong, and the sites name every one.
#[test]
fn a_fault_of_all_passes_has_a_site_on_each() {
    let [program, machine, reference] = &case("a_left_hand_burr_is_not_a_right_hand_one");
    let grinding = run(program, machine, reference);
    let mut passes: Vec<_> = sites(&grinding, "flute-helix").iter().map(|site| site.pass).collect();
    passes.sort_unstable();
    let all: Vec<_> = (1..=grinding.1.result.passes.len()).map(Some).collect();
    assert_eq!(passes, all);
}

/// A rapid a millimetre into the cylinder, where its first flute is to begin.
#[test]
fn the_site_of_a_collision_is_its_deepest_point() {
    let [program, machine, reference] = &case("four_flutes_of_a_burr_pass");
    let into = program.replacen("WHILE[", "G00 Y3.\nX-4. A0 B20. C0\nY-1.\nY3.\nWHILE[", 1);
    let [site] = sites(&run(&into, machine, reference), "wheel-into-burr")[..] else { panic!("one block") };
    assert_eq!(site.pass, None);
    let off = site.at.iter().zip([4.0, -5.0, 0.0]).map(|(at, by_hand)| (at - by_hand).abs());
    assert!(off.fold(0.0, f64::max) < 1e-9, "{site:?}");
}

/// The third flute goes 15° astray in one block, at C30: on a ball of radius 6 that is x = −6·sin 30°.
#[test]
fn one_wrong_block_has_a_site_on_its_pass_alone() {
    let [program, machine, reference] = &case("one_block_off_its_flute_is_named");
    let [site] = sites(&run(program, machine, reference), "flute-index")[..] else { panic!("one place") };
    assert_eq!(site.pass, Some(3));
    assert!((site.at[0] + 3.0).abs() < 1e-3, "{site:?}");
}
