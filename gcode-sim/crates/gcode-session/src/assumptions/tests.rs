//! Assumptions of programs, worked out by hand.
use super::*;
use crate::simulate;
use gcode_control::Progress;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::{Answer, AnyVerdict, Tolerances};
use gcode_part::NominalPart;
use std::sync::atomic::Ordering;

/// Returns the assumptions of a program as `#510=2.5@3: 1 2`, and its number of holes.
fn assumptions_with(blocks: &str, variables: &[(u32, f64)]) -> (Vec<String>, usize) {
    let text = format!("O1\nG90 G54 G17 G21 G98 S1000 M03\nG0 X0. Y0. Z50.\n{blocks}\nG80 Z50.\nM30\n");
    assumptions_on("", &text, variables)
}

/// Returns the assumptions of a whole program on a machine.
fn assumptions_on(machine: &str, text: &str, variables: &[(u32, f64)]) -> (Vec<String>, usize) {
    let mut request = Request::new("O1.nc", text.as_bytes(), Machine::parse(machine).unwrap());
    request.variables = variables.to_vec();
    let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
    assert!(simulation.run.stop_finding().is_none(), "{text}");
    let holes = simulation.extracted.holes.len();
    let found = simulation.dependencies(&request);
    // The holes of the first run have the values of those that a second extraction finds.
    let extracted = of_holes(&request, &simulation.run, &simulation.metal);
    assert_eq!(found.marks, extracted.marks, "{text}");
    let all = found.assumptions(&simulation.run, |hole| Some((hole + 1).to_string()));
    let shown = all.into_iter().map(|(Assumption { what, value, place, decides }, _)| {
        let value = value.map_or_else(|| "vacant".to_owned(), |value| value.to_string());
        format!("{what}={value}@{}: {}", place.line, decides.join(" "))
    });
    (shown.collect(), holes)
}

/// Asserts the assumptions of a program with this number of holes.
fn assert_assumptions(blocks: &str, holes: usize, expected: &[&str]) {
    assert_eq!(
        assumptions_with(blocks, &[]),
        (expected.iter().map(|one| (*one).to_owned()).collect(), holes),
        "{blocks}"
    );
}

#[test]
fn a_common_decides_the_holes_whose_words_it_reaches() {
    // Line 4 is the first of these blocks.
    assert_assumptions("G81 X10. Y10. Z-5. R2. F100.\nX20. Y#510\nX30. Y10.", 3, &["#510=vacant@5: 2"]);
    assert_assumptions(
        "#100=#510+1.\nG81 X10. Y10. Z-5. R2. F100.\nX20. Y#100\nX30. Y10.",
        3,
        &["#510=vacant@4: 2"],
    );
    // Y stays where the hole before has left it.
    assert_assumptions("G81 X10. Y#510 Z-5. R2. F100.\nX20.\nX30. Y10.", 3, &["#510=vacant@4: 1 2"]);
    // The depth of a cycle stays until it is cancelled.
    let cancelled = "G81 X10. Y10. Z-[5.+#510] R2. F100.\nX20.\nG80 Z50.\nG81 X30. Z-5. R2.";
    assert_assumptions(cancelled, 3, &["#510=vacant@4: 1 2"]);
}

#[test]
fn a_value_that_the_program_sets_is_no_assumption() {
    assert_assumptions("#510=5.\nG81 X10. Y#510 Z-5. R2. F100.", 1, &[]);
    assert_assumptions("#510=#0\nG81 X10. Y#510 Z-5. R2. F100.", 1, &[]);
    assert_assumptions("#510=#510+1.\nG81 X10. Y#510 Z-5. R2. F100.", 1, &["#510=vacant@4: 1"]);
    assert_assumptions("#511=#510\nG81 X10. Y10. Z-5. R2. F100.", 1, &[]);
}

#[test]
fn a_condition_decides_what_is_executed_until_both_ways_meet() {
    let program = |condition: &str| {
        format!(
            "#100=10.\nIF[{condition}]GOTO 5\n#100=20.\nN5 G81 X10. Y10. Z-5. R2. F100.\nX20. Y#100\nX30. Y10."
        )
    };
    assert_assumptions(&program("#510EQ1"), 3, &["#510=vacant@5: 2"]);
    assert_assumptions(&program("#510NE1"), 3, &["#510=vacant@5: 2"]);
    assert_assumptions(&program("#100EQ1"), 3, &[]);
    let then = "#100=10.\nIF[#510EQ1]THEN #100=20.\nG81 X10. Y10. Z-5. R2. F100.\nX20. Y#100\nX30. Y10.";
    assert_assumptions(then, 3, &["#510=vacant@5: 2"]);
    // One way leads to an alarm: no hole is cut elsewhere.
    let hole = "G81 X10. Y10. Z-5. R2. F100.";
    assert_assumptions(&format!("IF[#510EQ1]THEN #3000=1(NO)\n{hole}"), 1, &[]);
    assert_assumptions(&format!("IF[#510NE1]GOTO5\n#3000=1(NO)\nN5 {hole}"), 1, &[]);
    // A jump to the reasons of an alarm.
    let guard =
        format!("IF[#510EQ1]GOTO900\n{hole}\nG80 Z50.\nM30\nN900 IF[#510EQ2]THEN #3000=2(TWO)\n#3000=1(ONE)");
    assert_assumptions(&guard, 1, &[]);
    let not_all = guard.replace("#3000=1(ONE)", "#1=1");
    assert_assumptions(&not_all, 1, &["#510=vacant@4: 1"]);
    // The end of the program is no alarm.
    assert_assumptions(&format!("IF[#510NE1]GOTO5\nM30\nN5 {hole}"), 1, &["#510=vacant@4: 1"]);
}

/// By #510 = 1 the block would move X, and Y would stay at 0.
#[test]
fn the_number_of_an_axis_decides_all_axes() {
    let blocks = "AX[#510]=40.\nX60.\nG81 Z-5. R2. F100.";
    assert_eq!(assumptions_with(blocks, &[(510, 2.0)]), (vec!["#510=2@4: 1".to_owned()], 1));
    assert_assumptions("#510=2\nAX[#510]=40.\nX60.\nG81 Z-5. R2. F100.", 1, &[]);
}

/// Only a rapid cuts nothing, by the mode in force behind the blocks that are skipped with it.
#[test]
fn a_skipped_feed_is_a_cut_and_a_skipped_rapid_is_none() {
    let around = |skipped: &str| {
        format!(
            "IF[#510NE1]GOTO10\n{skipped}\nN10 G90 G0 X0. Y0. Z50.\nG98 G81 X10. Y10. Z-5. R2. F100.\nX20."
        )
    };
    let cut = ["#510=vacant@4: "].as_slice();
    for (skipped, expected) in [
        ("X20.", [].as_slice()),
        ("G90 G0 X20.", &[]),
        ("G1\nX20. F100.", cut),
        ("G1\nG0 X20.", &[]),
        ("G1\nG0\nX20.", &[]),
        ("G99 G81 Z-5. R2. L0\nX30. L1\nG80", cut),
        ("G80\nX20.", &[]),
        ("/G1\nX20. F100.", cut),
        ("G1\n/G0\nX20. F100.", cut),
        ("G1\nIF[#2EQ1]GOTO9\nG0\nN9 X20. F100.", cut),
        ("G0\nIF[#2EQ1]GOTO9\nG0\nN9 X20.", &[]),
    ] {
        assert_assumptions(&around(skipped), 2, expected);
    }
}

/// Behind the place where both ways meet a mode of one of them is in force.
#[test]
fn a_rapid_that_would_cut_by_the_mode_of_another_way_is_a_cut() {
    let cycle = "G81 X10. Y10. Z-5. R2. F100.\n";
    for (blocks, holes, expected) in [
        (format!("{cycle}IF[#510EQ1]GOTO10\nG80\nN10 X20."), 1, ["#510=vacant@5: "].as_slice()),
        (format!("{cycle}IF[#510EQ1]GOTO10\nG80\nN10 G0 X20."), 1, &[]),
        (format!("{cycle}G80\nIF[#510EQ1]GOTO10\nG80\nN10 X20."), 1, &[]),
        (format!("{cycle}G80\nIF[#510NE1]GOTO10\nG1\nN10 X20."), 1, &["#510=vacant@6: "]),
        (format!("{cycle}G80\nIF[#510NE1]GOTO10\nG1\nN10 G0 X20."), 1, &[]),
    ] {
        assert_assumptions(&blocks, holes, expected);
    }
}

#[test]
fn a_loop_count_decides_the_holes_of_the_loop() {
    let text = "G81 X5. Y5. Z-5. R2. F100.\n#1=0\nWHILE[#1LT#510]DO1\n#1=#1+1\nX[10.*#1] Y10.\nEND1\nG80\nG0 X0. Y50. Z50.\nG81 X50. Y50. Z-5. R2. F100.";
    let (found, holes) = assumptions_with(text, &[(510, 2.0)]);
    assert_eq!((found, holes), (vec!["#510=2@6: 2 3".to_owned()], 4));
}

#[test]
fn arguments_of_a_call_carry_their_values() {
    let text = "G65 P2 X10. Y#510\nG65 P2 X20. Y10.\nG80\nM30\nO2\nG0 X#24 Y#25\nG81 Z-5. R2. F100.\nG80\nM99\nO3\nM30";
    assert_assumptions(text, 2, &["#510=vacant@4: 1"]);
}

#[test]
fn switches_signals_lengths_and_codes_of_the_builder_are_assumptions() {
    assert_assumptions("G81 X10. Y10. Z-5. R2. F100.\n/X20.\nX30.", 3, &["/=0@5: 2"]);
    assert_assumptions("#100=#1005*10.\nG81 X10. Y#100 Z-5. R2. F100.\nX20. Y10.", 2, &["#1005=0@4: 1"]);
    assert_assumptions("G43 H1 Z50.\nG81 X10. Y10. Z-5. R2. F100.", 1, &["H1=0@4: 1"]);
    assert_assumptions("G81 X10. Y10. Z-5. R2. F100.\nM21\nX20.", 2, &["M21=vacant@5: 2"]);
    // Whether the spindle goes on behind a stop.
    assert_assumptions("G81 X10. Y10. Z-5. R2. F100.\nM00\nX20.", 2, &["M00=vacant@5: 2"]);
    assert_assumptions("G81 X10. Y10. Z-5. R2. F100.\nM01\nM03\nX20.", 2, &[]);
    // A stop that the operator switches off stops nothing that stands, and at most a spindle that turns.
    assert_assumptions("M05\n/M00\nM03\nG81 X10. Y10. Z-5. R2. F100.", 1, &[]);
    assert_assumptions("/M00\nG81 X10. Y10. Z-5. R2. F100.", 1, &["/=0@4: 1", "M00=vacant@4: 1"]);
    // Rigid tapping turns the spindle itself; one that stands still before the stop stands still behind it.
    let tapped =
        |stop| format!("G81 X10. Y10. Z-5. R2. F100.\nG80\n{stop}\nM29 S500\nG84 X20. Z-5. R2. F500.");
    assert_assumptions(&tapped("M05\nM01"), 2, &[]);
    assert_assumptions(&tapped("M09\nM01"), 2, &["M01=vacant@7: 2"]);
    let restarted = "G81 X10. Y10. Z-5. R2. F100.\nG80\nM05\nM03 M01\nG81 X20. Z-5. R2.";
    assert_assumptions(restarted, 2, &["M01=vacant@7: 2"]);
    // The length counts behind G53 or not; G43 states it again, and X has none.
    let retracted = |by| {
        format!("#11001=0\n#10001=0\nG43 H1 Z50.\nG81 X10. Y10. Z-5. R2. F100.\nG80\n{by}\nG81 X20. Z-5. R2.")
    };
    assert_assumptions(&retracted("G53 Z0"), 2, &["EVO=1@9: 2"]);
    assert_assumptions(&retracted("G53 Z0\nG43 H1 Z50."), 2, &[]);
    assert_assumptions(&retracted("G53 X0"), 2, &[]);
    assert_assumptions(&retracted("G53 Z0\nT2 M06\nG0 X20. Y10.\nG43 H1 Z50."), 2, &[]);
    assert_assumptions(
        "G81 X10. Y10. Z-5. R2. F100.\nG80\nG55\nG81 X20. Y10. Z-5. R2.",
        2,
        &["G55=vacant@7: 2"],
    );
}

#[test]
fn positions_and_words_that_no_block_has_commanded_are_assumptions() {
    let drill = |number: u32| format!("#100=#{number}\nG81 X10. Y#100 Z-5. R2. F100.\nX20. Y10.");
    // A is axis 4. Machine coordinates rest on the work offset, which nothing states.
    for (number, value) in [(5004, "0"), (5021, "0"), (4109, "0"), (4111, "0")] {
        assert_assumptions(&drill(number), 2, &[&format!("#{number}={value}@4: 1")]);
    }
    for number in [5001, 5042, 5083, 4003, 4006, 4014, 4119] {
        assert_assumptions(&drill(number), 2, &[]);
    }
    assert_assumptions(&drill(4011).replace("#100 ", "[#100/10.] "), 2, &["G50=vacant@4: 1"]);
    assert_assumptions(&format!("G28 Z0\n{}", drill(5023)), 2, &[]);
    assert_assumptions(&format!("G28 Z0\n{}", drill(5003)), 2, &["#5003=0@5: 1"]);
    let stated = "[offsets.G54]\nX = 5.0\nY = 0.0\nZ = 0.0\n";
    let text = format!("O1\nG90 G54 G17 G21 G98 S1000 M03\nG0 X0. Y0. Z50.\n{}\nM30\n", drill(5021));
    assert_eq!(assumptions_on(stated, &text, &[]).0, [""; 0]);
}

#[test]
fn modes_of_power_on_are_assumptions_where_a_hole_depends_on_them() {
    let drill = "G98 G81 X10. Y10. Z-5. R2. F100.\nX20.\nG80\nM30\n";
    let found = |machine: &str, header: &str| {
        let text = format!("O1\n{header}\nG0 X0. Y0. Z50. S1000 M03\n{drill}");
        assumptions_on(machine, &text, &[]).0
    };
    let all = |codes: &[(&str, u32)]| -> Vec<String> {
        codes.iter().map(|(code, line)| format!("{code}=vacant@{line}: 1 2")).collect()
    };
    assert_eq!(found("", ""), all(&[("G21", 3), ("G90", 3)]));
    assert_eq!(found("", "G90 G17"), all(&[("G21", 3)]));
    assert_eq!(found("", "G20 G90 G17"), [""; 0]);
    // The end of G28 depends on no mode, and a G90 before the holes makes up for none before it.
    assert_eq!(found("", "G28 Z0\nG17 G21 G90"), [""; 0]);
    assert_eq!(found("", "G0 X5.\nG17 G21 G90"), [""; 0]);
    // Cycles drill along Z in every plane; an arc needs one.
    assert_eq!(found("", "G21 G90"), [""; 0]);
    let arc =
        "O1\nG21 G90\nG0 X10. Y10. Z2. S1000 M03\nG1 Z-3. F100.\nX12.\nG3 I-2.\nG1 X10.\nG0 Z50.\nM30\n";
    assert_eq!(assumptions_on("", arc, &[]).0, ["G17=vacant@6: 1"]);
    // A macro that leaves a mode as it was decides nothing by it.
    let restored =
        format!("O1\nG21 G90 G17\nG0 X0. Y0. Z50. S1000 M03\n#5=#4010\n{}", drill.replace("G80", "G80 G#5"));
    assert_eq!(assumptions_on("", &restored, &[]).0, [""; 0]);
    // With work offsets another may be active; without any all are zero.
    let offsets = "[offsets]\nG54 = { X = 1.0, Y = 0.0, Z = 0.0 }\nG55 = { X = 2.0, Y = 0.0, Z = 0.0 }\n";
    assert_eq!(found(offsets, "G17 G21 G90"), all(&[("G54", 3)]));
    assert_eq!(found(offsets, "G17 G21 G90 G55"), [""; 0]);
    // G99 of the last job would keep the tool low between the holes.
    let low = format!("O1\nG21 G90\nG0 X0. Y0. Z50. S1000 M03\n{}", drill.replace("G98 ", ""));
    assert_eq!(assumptions_on("", &low, &[]).0, all(&[("G98", 4)]));
}

#[test]
fn offsets_of_the_machine_file_are_stated_and_those_of_set_are_not() {
    let program = |words: &str| {
        format!(
            "O1\nG90 G17 G21 G98 S1000 M03\n{words}\nG0 X0. Y0. Z50.\nG81 X10. Y10. Z-5. R2. F100.\nG80 Z50.\nM30\n"
        )
    };
    let head = "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n";
    let machine = format!(
        "{head}[[tool]]\nnumber = 1\nlength = 80.0\nradius_offset = 3.0\n[offsets]\n\
         G54 = {{ X = 1.0, Y = 0.0, Z = 0.0 }}\n\"G54.1 P3\" = {{ X = 0.0, Y = 2.0, Z = 0.0 }}\n\
         G56 = {{ X = 0.0, Y = 0.0 }}\n"
    );
    let found =
        |words: &str, variables: &[(u32, f64)]| assumptions_on(&machine, &program(words), variables).0;
    for words in ["G54", "G54.1 P3", "G54 G43 H1 Z50.", "#100=#13001\nG54 G0 X#100"] {
        assert_eq!(found(words, &[]), [""; 0], "{words}");
    }
    assert_eq!(found("G54.1 P4", &[]), ["G54.1 P4=vacant@4: 1"]);
    assert_eq!(found("G55", &[]), ["G55=vacant@4: 1"]);
    // The file states two axes of G56; no block moves B.
    assert_eq!(found("G56", &[]), ["G56 Z=0@4: 1"]);
    assert_eq!(found("G10 L2 P3 Z0.\nG56", &[]), [""; 0]);
    // The file states no wear.
    let wear = "#100=#10001\nG54 G43 H1 Z50.\nG81 X20. Y#100 Z-5. R2. F100.\nG80";
    assert_eq!(found(wear, &[]), ["#10001=0@3: 1"]);
    assert_eq!(found(&wear.replace("10001", "11001"), &[]), [""; 0]);
    // A flag states neither what the program sets nor what the machine has.
    for (words, variable, expected) in [
        ("G54", 5221, "G54 X=7@4: 1"),
        ("G54.1 P3", 14_042, "G54.1 P3 Y=7@4: 1"),
        ("G55", 5241, "G55=vacant@4: 1"),
        ("G54", 5201, "EXT=vacant@4: 1"),
        ("G54 G43 H1 Z50.", 11_001, "H1=7@3: 1"),
    ] {
        assert_eq!(found(words, &[(variable, 7.0)]), [expected], "{words}");
    }
    assert_eq!(found("G10 L2 P1 X3.\nG54", &[(5221, 7.0)]), [""; 0]);
    assert_eq!(found("G10 L20 P3 Y3.\nG54.1 P3", &[(14_042, 7.0)]), [""; 0]);
    assert_eq!(found("G10 L20 P3 X3.\nG54.1 P3", &[(14_042, 7.0)]), ["G54.1 P3 Y=7@5: 1"]);
    // An offset is set axis by axis; B is not used.
    for (words, open) in [
        ("G10 L2 P2 X0. Y0. Z0.\nG55", [].as_slice()),
        ("G10 L2 P2 X0.\nG55", &["G55 Y", "G55 Z"]),
        ("G10 L2 P2 X0. Y0.\nG55", &["G55 Z"]),
        ("#5241=0.\n#5242=0.\n#5243=0.\nG55", &[]),
        ("#5241=0.\n#5242=0.\nG55", &["G55 Z"]),
        ("#2502=0.\n#2602=0.\n#2702=0.\nG55", &[]),
        ("G10 L2 P2 X0. Y0. Z0.\nG55 B90.", &["G55 B"]),
    ] {
        let mut found = found(words, &[]);
        found.sort();
        assert_eq!(found.len(), open.len(), "{words}: {found:?}");
        for (one, axis) in found.iter().zip(open) {
            assert!(one.starts_with(&format!("{axis}=0@")) && one.ends_with(": 1"), "{found:?}");
        }
    }
}

/// A length is the sum of its geometry and its wear, and G91 adds to what the operator has entered.
#[test]
fn an_offset_that_the_program_sets_in_part_is_an_assumption() {
    let with = |set: &str, expected: &[&str]| {
        assert_assumptions(&format!("{set}\nG90 G43 H1 Z50.\nG81 X10. Y10. Z-5. R2. F100."), 1, expected);
    };
    with("G10 L10 P1 R0\nG10 L11 P1 R0", &[]);
    with("G10 L10 P1 R0", &["#10001=0@5: 1"]);
    with("#11001=0", &["#10001=0@5: 1"]);
    with("#11001=0\n#10001=0", &[]);
    with("G10 L11 P1 R0", &["H1=0@5: 1"]);
    with("G91 G10 L10 P1 R0\nG10 L11 P1 R0", &["H1=0@6: 1"]);
    let g55 = |set: &str, expected: &[&str]| {
        let hole = "G90 G55 G81 X10. Y10. Z-5. R2. F100.";
        assert_assumptions(&format!("{set} G10 L2 P2 X0 Y0 Z0\n{hole}"), 1, expected);
    };
    g55("G90", &[]);
    g55("G91", &["G55=vacant@5: 1"]);
}

#[test]
fn setting_40_of_a_haas_is_an_assumption_where_the_program_sets_d() {
    let machine = |dialect: &str| {
        format!(
            "[control]\ndialect = \"{dialect}\"\n[[tool]]\nnumber = 1\ndiameter = 8.0\nkind = \"end-mill\"\n\
             radius_offset = 4.0\n"
        )
    };
    let found = |dialect: &str, set: &str, mill: &str| {
        let text = format!(
            "O1\nG90 G54 G17 G21 G98\nT1 M06\nS1000 M03\nG0 X20. Y20. Z2.\n{set}\nG1 Z-5. F100.\n{mill}\nG0 Z50.\nM30\n"
        );
        assumptions_on(&machine(dialect), &text, &[]).0
    };
    let contour = "G41 D1 G1 X26. Y20.\nG3 I-6. J0.\nG40 G1 X20.";
    for mill in ["G13 I10. D1 F100.", contour] {
        let line = 8;
        let haas = found("haas-ngc", "G10 L12 P1 R4.", mill);
        assert_eq!(haas, [format!("ODI=0@{line}: 1")], "{mill}");
        assert_eq!(found("haas-ngc", "#2401=4.", mill), haas);
        assert_eq!(found("haas-ngc", "Z3.", mill), [""; 0], "the machine file states the radius");
        assert_eq!(found("haas-ngc", "Z3.", &mill.replace("D1", "D2 Z-5.")).len(), 1, "D2 is the operator's");
    }
    assert_eq!(found("fanuc-31i", "G10 L12 P1 R4.", contour), [""; 0]);
}

#[test]
fn a_value_decides_a_milled_hole_by_any_of_its_feeds() {
    let text = "G0 X10. Y10. Z2.\nG1 Z-3. F100.\nX[12.+#510]\nG3 I-2.\nG1 X10.\nG0 Z50.\nX40.\nG81 Z-5. R2.";
    assert_assumptions(text, 2, &["#510=vacant@6: 1"]);
}

#[test]
fn a_computed_number_of_a_variable_is_followed() {
    assert_assumptions("#1=510\nG81 X10. Y#[#1] Z-5. R2. F100.\nX20. Y10.", 2, &["#510=vacant@5: 1"]);
    // Another #510 would have set another variable.
    let text = "#101=10.\n#102=20.\n#[101+#510]=30.\nG81 X10. Y#102 Z-5. R2. F100.\nX20. Y10.";
    assert_assumptions(text, 2, &["#510=vacant@6: 1"]);
}

/// Without its assumptions a result is none.
#[test]
fn a_verdict_interrupted_behind_its_run_fails() {
    let text =
        "O1\nG90 G54 G17 G21 G98 S1000 M03\nG0 X10. Y0. Z50.\nG81 Y#510 Z-5. R2. F100.\nG80 Z50.\nM30\n";
    let reference = "id,x,y,z,i,j,k,depth\n1,10,0,0,0,0,1,5\n";
    let reference = NominalPart::parse(reference).unwrap().into_holes().unwrap();
    for is_interrupted in [false, true] {
        let progress = Arc::new(Progress::default());
        let mut request = Request::new("O1.nc", text.as_bytes(), Machine::default());
        request.progress = Some(Arc::clone(&progress));
        let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
        progress.cancel.store(is_interrupted, Ordering::Relaxed);
        let mut verdict = simulation.verify(&reference, Tolerances::of(&reference, None), &request);
        assert_eq!(verdict.answer() == Answer::Fail, is_interrupted);
    }
}

/// 127 values have a line each; from the 128th on they share one.
#[test]
fn values_beyond_the_last_index_are_one_assumption() {
    let hole = |count: u32| {
        let sum: Vec<String> = (500..500 + count).map(|number| format!("#100=#100+#{number}")).collect();
        let blocks = format!("#100=10.\n{}\nG81 X#100 Y10. Z-5. R2. F100.", sum.join("\n"));
        assumptions_with(&blocks, &[]).0
    };
    assert_eq!(hole(128)[126..], ["#626=vacant@131: 1", "#627=vacant@132: 1"]);
    assert_eq!(hole(400)[126..], ["#626=vacant@131: 1", "273 further values, first #627=vacant@132: 1"]);
}

/// The same block ends at the same place in both iterations; the second one depends on #510.
#[test]
fn feeds_that_are_alike_keep_their_own_values() {
    let hole = "G81 X10. Y[10.+#3] Z-5. R2. F100.\nG80 Z50.\nG0 X0.";
    assert_assumptions(
        &format!("#3=0\n#2=0\nWHILE[#2LT2]DO1\n{hole}\n#3=#510\n#2=#2+1\nEND1"),
        2,
        &["#510=vacant@10: 2"],
    );
}

/// A hole by G98 leaves Z at 50, one by G99 at 2: there the feed of a last block begins.
#[test]
fn what_a_conditional_block_of_a_cycle_leaves_decides_the_level_of_the_next_feed() {
    let after =
        |blocks: &str| format!("G99 G81 X10. Y10. Z-5. R2. F100.\n{blocks}\nG80\nX40.\nG1 Z-4. F100.");
    assert_assumptions(&after("G98\n/X20."), 3, &["/=0@6: 2 3"]);
    // The next hole of the cycle settles the level.
    assert_assumptions(&after("G98\n/X20.\nX30."), 4, &["/=0@6: 2"]);
    // Without the place of a hole nothing is drilled, and Z stays at 2.
    assert_assumptions(&after("G98\nX#510"), 2, &["#510=vacant@6: 2"]);
    assert_assumptions(&after("G98\nX#510 Y20."), 3, &["#510=vacant@6: 2"]);
    assert_assumptions(&after("/G98\nX20."), 3, &["/=0@5: 2 3"]);
    assert_assumptions(&after("/G80\nG98\nX20."), 2, &["/=0@5: 2"]);
    assert_assumptions(&after("G98\nIF[#510NE1]GOTO5\nX20.\nN5"), 2, &["#510=vacant@6: 2"]);
    // A rapid settles it too.
    assert_assumptions(&after("G98\n/X20.\nG80 Z50."), 3, &["/=0@6: 2"]);
}
