//! The emitted pin-hole programs on the control: edited by hand, with the printed equation, blocks counted.
use gcode_gen::check::{Programs, check};
use gcode_inspect::machine::{Machine, Placement};
use gcode_inspect::verify::{Answer, Tolerances, Verdict};
use gcode_lang::motion::Position;
use gcode_part::NominalPart;
use gcode_session::simulate;
use gcode_tests::bench::{Bench, alarm, example};
use gcode_tests::expect::Recorder;

/// The job of the main example.
fn melon() -> String {
    example("melon-mould")
}

/// Replaces a text in the lines of a program with a mark.
fn edited(mut bench: Bench, number: u32, mark: &str, from: &str, to: &str) -> Bench {
    let program = bench.package.programs.iter_mut().find(|program| program.number == number).unwrap();
    let mut found = false;
    let lines = program.text.lines().map(|line| {
        let is_meant = line.contains(mark) && line.contains(from);
        found |= is_meant;
        if is_meant { line.replace(from, to) } else { line.to_owned() }
    });
    program.text = lines.map(|line| line + "\n").collect();
    assert!(found, "no line with {mark} and {from} in O{number}");
    bench
}

fn verdict(bench: &Bench, reference: &str) -> Verdict {
    check(&Bench::of(reference).job, &bench.package).unwrap().verdict.into_holes().unwrap()
}

#[test]
fn r_changed_by_hand_moves_the_hole_to_its_right_new_place() {
    for (from, to) in [("1100.", "987.654"), ("420.", "0."), ("760.", "1124.")] {
        let bench = edited(Bench::of(&melon()), 8100, "G65", &format!("R{from}"), &format!("R{to}"));
        let moved = melon().replace(&format!("radius = {from}0"), &format!("radius = {to}0"));
        assert_ne!(moved, melon());
        let verdict = verdict(&bench, &moved);
        assert_eq!(verdict.verdict, Answer::Pass, "R{to}: {:?}", verdict.findings);
        assert_eq!(self::verdict(&bench, &melon()).verdict, Answer::Fail, "the old places are wrong now");
    }
}

/// Without a change of the head's call the head is set once more, and no hole is at a wrong angle.
#[test]
fn r_changed_in_the_holes_calls_alone_sets_the_head_again() {
    let bench = edited(Bench::of(&melon()), 8100, "(HOLE 5)", "R1100.", "R900.");
    let melon = melon();
    let (before, last) = melon.rsplit_once("radius = 1100.0").unwrap();
    let verdict = verdict(&bench, &format!("{before}radius = 900.0{last}"));
    assert_eq!(verdict.verdict, Answer::Pass, "{:?}", verdict.findings);

    let stops = |bench: &Bench| bench.run_to(8100, &mut ()).control.stops().len();
    assert_eq!(stops(&Bench::of(&melon)), 6, "three radii with two tools");
    assert_eq!(stops(&bench), 8, "and the changed hole with each tool");
}

/// Equation (8) as printed has √(1 − r²/a²)/b, a number in 1/mm: every hole lies far too low.
#[test]
fn the_printed_equation_8_fails() {
    let right = "#2*SQRT[[#1-#18]*[#1+#18]]/#1";
    let printed = "SQRT[1-#18*#18/[#1*#1]]/#2";
    let bench = [8101, 8102]
        .into_iter()
        .fold(Bench::of(&melon()), |bench, number| edited(bench, number, "#24=", right, printed));
    // The height under the tool's edge is computed by the same equation.
    let [right, printed] = [right, printed].map(|equation| equation.replace("#18", "#26"));
    let bench = edited(bench, 8101, "#27=", &right, &printed);
    let checked = check(&bench.job, &bench.package).unwrap();
    assert!(checked.refusals.concat().contains("rapid through the part"), "{}", checked.refusals.concat());
    let verdict = checked.verdict.into_holes().unwrap();
    assert_eq!(verdict.verdict, Answer::Fail);
    assert_eq!(verdict.missing, ["1", "2", "3", "4", "5"], "no hole is anywhere near its place");
}

#[test]
fn a_table_that_turns_the_other_way_fails() {
    let mut bench = Bench::of(&melon());
    bench.package.machine = bench.package.machine.replace("sign = 1", "sign = -1");
    assert_eq!(verdict(&bench, &melon()).verdict, Answer::Fail);
}

/// The smallest job on the machine of the paper, without a machine file, and on controls whose angles
/// count from −180 to 180.
#[test]
fn neither_the_machine_file_nor_the_range_of_atan_changes_the_verdict() {
    let bench = Bench::of(&melon());
    let reference = NominalPart::from_job(&bench.job).unwrap().into_holes().unwrap();
    for machine in [Machine::default(), bench.machine()] {
        for is_signed in [false, true] {
            let mut request = bench.request(8100);
            request.settings.returns_signed_angles = is_signed;
            request.machine = machine.clone();
            let done = simulate(&request, &mut Programs(&bench.package), reference.surface).unwrap();
            let verdict = done.verify(&reference, Tolerances::of(&reference, None), &request);
            assert_eq!(verdict.verdict, Answer::Pass, "{:?}", verdict.findings);
            assert_eq!(verdict.holes.len(), 5);
        }
    }
}

fn passes(text: &str) {
    let bench = Bench::of(text);
    assert_eq!(check(&bench.job, &bench.package).unwrap().refusals, Vec::<String>::new(), "{text}");
}

/// A tool that is longer than the one before by more than V must not stand in the part when it comes.
#[test]
fn a_longer_tool_comes_clear_of_the_part() {
    let longer = melon()
        .replace("radius = 420.0", "radius = 0.0")
        .replacen("length = 0.0", "length = 120.0", 1)
        .replacen("length = 0.0", "length = 180.0", 1);
    let upright = longer.replace("\"normal\"", "\"axial\"");
    assert!(upright.contains("length = 120.0") && upright.contains("length = 180.0"));
    // The first hole alone, at the pole, where the part is highest.
    passes(&upright[..upright.match_indices("[[hole]]").nth(1).unwrap().0]);
}

/// At the equator an axial hole leaves the part again on the other side of it.
#[test]
fn a_hole_through_a_steep_flank_passes() {
    passes(&melon().replace("radius = 420.0", "radius = 1158.7"));
}

/// A control manages about a thousand macro blocks a second and stands still meanwhile.
#[test]
fn one_more_hole_costs_23_blocks_of_arithmetic() {
    let bench = Bench::of(&melon());
    let main = &bench.package.program(8100).unwrap().text;
    let call = main.lines().rfind(|line| line.contains("(HOLE 5)")).unwrap();
    let another = format!("{call} => {call};{}", call.replace("W15.2885", "W30."));
    let longer = bench.clone().edited(8100, &another);
    let blocks = |bench: &Bench| bench.run_to(8100, &mut ()).control.blocks();
    let blocks = blocks(&longer) - blocks(&bench);
    let (call, title, moves_and_modes, back) = (1, 1, 8, 1);
    assert_eq!(blocks - call - title - moves_and_modes - back, 23, "25 are allowed");
}

/// Controls move each axis at its own rate, so that a rapid is anywhere in the rectangle between its ends. The tool first comes up from
/// where the simulator's machine begins, in the middle of the part.
#[test]
fn no_rapid_can_touch_the_part_on_any_path() {
    // Radii up and down, axial ones among them: the head stays at 90 degrees while the radius changes.
    for (a, b) in [(1158.8, 724.3), (300.0, 900.0), (500.0, 500.0)] {
        let mut text = melon();
        text = text[..text.find("[[hole]]").unwrap()]
            .replace("1158.8", &a.to_string())
            .replace("724.3", &b.to_string());
        for (id, radius) in [0.9, 0.1, 0.95, 0.0, 0.5].iter().enumerate() {
            for (axis, azimuth) in [("axial", 30.0), ("normal", -200.0)] {
                text.push_str(&format!(
                    "[[hole]]\nid = \"{id}{axis}\"\nradius = {}\nazimuth = {azimuth}\naxis = \"{axis}\"\ndiameter = 6\ndepth = 15\n",
                    radius * a
                ));
            }
        }
        let bench = Bench::of(&text);
        let main = &bench.package.program(8100).unwrap().text;
        let calls: Vec<&str> = main.lines().filter(|line| line.contains("P8101")).collect();
        let half = calls.len() / 2;
        // The same calls in another order.
        let blocks = (0..half).map(|index| calls[(index * 7) % half].split_once(' ').unwrap().1);
        let blocks = format!("G21\nG90 G94\n{}", blocks.collect::<Vec<_>>().join("\n"));
        let mut recorder = Recorder::default();
        assert_eq!(alarm(&bench.with_main(1, &blocks).run_to(1, &mut recorder)), None);
        let moves: Vec<(char, &Position)> = recorder.moves().collect();
        let rapids: Vec<_> = moves.windows(2).filter(|pair| pair[1].0 == 'R').collect();
        // Beside the part at x < 0 never, above it always.
        let reached = |at: usize, by: f64, [from, to]: [&Position; 2]| {
            let part = from[at].min(to[at]).max(0.0) / by;
            part * part
        };
        let lowest = rapids
            .iter()
            .map(|pair| [pair[0].1, pair[1].1])
            .map(|ends| reached(0, a, ends) + reached(1, b, ends));
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        assert!(rapids.len() > 40, "{} rapids", rapids.len());
        assert!(lowest > 1.0, "a rapid of a = {a}, b = {b} can reach {lowest} of the surface");
    }
}

/// Half an increment of 0.01 degrees over 150 mm is 0.013 mm: rounding, not another angle.
#[test]
fn the_rounded_angle_of_the_head_is_no_other_angle_for_a_deep_hole() {
    let text = melon().replace("IS-B", "IS-A").replace("depth = 15.0", "depth = 150.0");
    let done = Bench::of(&text).run(8100, &Placement::default(), &[]);
    assert_eq!(alarm(&done), None);
    assert_eq!(done.control.stops().len(), 6, "no setting of the head is repeated");
}

/// The simulation has the job's pivot, so that only a warning tells of one that was left out.
#[test]
fn tools_with_lengths_on_a_head_without_pivot_are_warned_of() {
    let warned = |edits: &[&str]| {
        let bench = Bench::example("melon-mould", edits);
        let checked = check(&bench.job, &bench.package).unwrap();
        checked.warnings.iter().any(|warning| warning.contains("'machine.head.pivot' is 0 and tool 1"))
    };
    let long = "length = 0.0                 # from => length = 120.0 # from";
    assert!(!warned(&[]));
    assert!(warned(&[long]));
}

/// A centre drill Φ3, 2.5 deep, and pecks of 4 mm of the drill.
fn centred(order: &str) -> String {
    let centre = "[[tool]]\nnumber = 7\nname = \"CENTRE DRILL\"\ndiameter = 3.0\nspeed = 2000\nfeed = 50.0\ndepth = 2.5\n\n";
    let (before, tools) = gcode_gen::families::ALL[0].new_job.split_once("# Tools in").unwrap();
    let tools = tools.replacen("retract_feed = 200.0", "retract_feed = 200.0\npeck = 4.0", 1);
    format!("{before}{centre}# Tools in{tools}").replace("order = \"tool\"", &format!("order = \"{order}\""))
}

/// Axial at radius 420, normal at 760 and 1100: three angles. Three tools make nine settings by tool, three by head. Where X and Y
/// are the tip, each of the two other tools at an angle stops too, for its tip; with a pivot and lengths none does.
#[test]
fn pecks_and_a_centre_drill_pass_in_both_orders() {
    for (order, settings, tips) in [("tool", 9, 0), ("head", 3, 6)] {
        let job = centred(order);
        let measured = job.replace("pivot = 0.0", "pivot = 180.0").replace("length = 0.0", "length = 95.0");
        for (job, tips) in [(job, tips), (measured, 0)] {
            passes(&job);
            let bench = Bench::of(&job);
            let text = &bench.package.program(8100).unwrap().text;
            assert_eq!(text.matches("M00 (SET THE TIP").count(), tips, "{order}");
            let run = bench.run_to(8100, &mut ());
            assert_eq!(run.control.stops().len(), settings + tips, "{order}");
        }
    }
}

/// Depths of 15 in pecks of 4 are 4, 8, 12, 15. The finished holes are the same in all of these programs.
#[test]
fn a_wrong_peck_or_depth_of_a_tool_is_refused() {
    for (program, mark, from, to, finding) in [
        (8100, "D2.5", "D2.5", "D15.", "T7 goes 15.0"),
        (8100, "D2.5", "D2.5", "D2.38", "T7 goes 2.3"),
        (8100, "D2.5", "D2.5", "D2.62", "T7 goes 2.6"),
        (8100, "K4.", " K4.", " K6.", "mm without retracting; the job specifies pecks of 4 mm"),
        (8100, "K4.", " K4.", "", "mm without retracting; the job specifies pecks of 4 mm"),
        (8101, "#10=#10+#6", "#10+#6", "#10+#6*2", "mm without retracting; the job specifies pecks of 4 mm"),
        (8101, "(TO THE DEPTH)", "#17-#7]", "#17-#7-1]", "T7 goes 3.5"),
        (8101, "(A PECK)", "F#9", "F#8", "feeds at 200 mm/min; the job specifies 10 mm/min"),
    ] {
        let bench = edited(Bench::of(&centred("head")), program, mark, from, to);
        let refusals = check(&bench.job, &bench.package).unwrap().refusals.concat();
        assert!(refusals.contains(finding), "{mark}: {from} -> {to}\n{refusals}");
    }
    // A tenth is the tolerance of a depth.
    for to in ["D2.59", "D2.41"] {
        let bench = edited(Bench::of(&centred("head")), 8100, "D2.5", "D2.5", to);
        assert_eq!(check(&bench.job, &bench.package).unwrap().refusals, Vec::<String>::new(), "{to}");
    }
}
