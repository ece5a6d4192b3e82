//! Patterns of holes on the control: every layout on every place with every operation, wrong twins of programs and macros, and
//! refused arguments.
use gcode_gen::check::check;
use gcode_inspect::machine::Placement;
use gcode_tests::bench::{Bench, alarm};

/// Sections of a job for each place.
const PLACES: [&str; 3] = [
    "",
    "machine = { rotary = { letter = \"A\", sign = -1 } }\ncylinder = { diameter = 150.0 }\n",
    "machine = { tilt = { letter = \"A\", sign = -1 }, rotary = { letter = \"C\", sign = -1 } }\n\
     face = { origin = [50.0, 20.0, -10.0], angles = [40.0, -25.0, 10.0] }\n",
];

/// Layouts with both senses, negative angles, one hole and holes left out.
const LAYOUTS: [&str; 8] = [
    "circle = { diameter = 80.0, holes = 5, angle = -90.0, clockwise = true }\nskip = [2]",
    "arc = { diameter = 100.0, holes = 3, angle = -30.0, step = -40.0 }",
    "circle = { diameter = 80.0, holes = 1, angle = 200.0 }",
    "grid = { columns = 3, rows = 4, pitch = [25.0, -30.0] }\nskip = [1, 5, 6, 12, 7]",
    "line = { holes = 3, pitch = 30.0 }",
    "points = [[0.0, 0.0], [40.0, -25.0]]",
    "circle = { diameter = 80.0, holes = 9, angle = 12.5 }\nskip = [1, 2, 3, 4, 6, 7, 8, 9]",
    "arc = { diameter = 100.0, holes = 1, angle = -200.0, step = 10.0 }",
];

/// Operations: the keys of the tool, and what a pattern makes with it. A bore, a tap and a thread mill follow a drill.
const OPERATIONS: [(&str, &str, f64); 8] = [
    ("operation = \"drill\"\ndiameter = 8.0\nfeed = 200.0", "depth = 20.0", 0.0),
    ("operation = \"peck\"\ndiameter = 8.0\nfeed = 200.0\npeck = 5.0", "depth = 20.0", 0.0),
    (
        "operation = \"mill-circle\"\ndiameter = 8.0\nfeed = 200.0\npeck = 1.0",
        "depth = 20.0, diameter = 12.0",
        0.0,
    ),
    ("operation = \"bore\"\ndiameter = 8.0\nfeed = 200.0", "depth = 15.0", 7.8),
    ("operation = \"tap\"\ndiameter = 8.0\npitch = 1.25", "depth = 15.0", 6.8),
    (
        "operation = \"thread-mill\"\ndiameter = 8.0\nfeed = 200.0\npitch = 1.5",
        "depth = 15.0, diameter = 12.0",
        10.4,
    ),
    ("operation = \"tap\"\ndiameter = 8.0\npitch = 1.25\nhand = \"left\"", "depth = 15.0", 6.8),
    (
        "operation = \"thread-mill\"\ndiameter = 8.0\nfeed = 200.0\npitch = 1.5\nhand = \"left\"",
        "depth = 15.0, diameter = 12.0",
        10.4,
    ),
];

fn job(place: &str, layout: &str, (tool, step, pilot): (&str, &str, f64)) -> String {
    let (drill, first) = match pilot {
        0.0 => (String::new(), ""),
        pilot => (
            format!(
                "[[tool]]\nnumber = 1\nspeed = 1000\noperation = \"drill\"\ndiameter = {pilot:?}\nfeed = 200.0\n"
            ),
            "{ tool = 1, depth = 22.0 }, ",
        ),
    };
    format!(
        "family = \"pattern\"\ncontrol = {{ dialect = \"fanuc-31i\", increment = \"IS-B\" }}\n\
         tolerance = {{ position = 0.05 }}\n{place}{drill}[[tool]]\nnumber = 2\nspeed = 1000\n{tool}\n\
         [[pattern]]\nid = \"A\"\nx = 5.0\ny = 7.0\n{layout}\nmake = [{first}{{ tool = 2, {step} }}]\n"
    )
}

/// The refusals of the check before a file is written.
fn refusals(bench: &Bench) -> Vec<String> {
    check(&bench.job, &bench.package).unwrap().refusals
}

#[test]
fn every_layout_passes_on_every_place_with_every_operation() {
    for place in PLACES {
        for layout in LAYOUTS {
            for operation in OPERATIONS {
                let job = job(place, layout, operation);
                let found = refusals(&Bench::of(&job));
                assert!(found.is_empty(), "{job}\n{}", found.join("\n"));
            }
        }
    }
}

/// A drill of 10.2 mm and 118° to 32 mm is full to 32 − 5.1/tan 59° = 28.936 mm, one of 140° to 32 − 5.1/tan 70° = 30.144 mm.
#[test]
fn a_tap_that_goes_into_the_cone_of_its_drill_is_refused() {
    for (point, depth, is_refused) in [
        ("", 28.9, false),
        ("", 29.1, true),
        ("point_angle = 140.0", 30.1, false),
        ("point_angle = 140.0", 30.3, true),
    ] {
        let job = format!(
            "family = \"pattern\"\ncontrol = {{ dialect = \"fanuc-31i\", increment = \"IS-B\" }}\n\
             tolerance = {{ position = 0.05, depth = 0.1 }}\n\
             [[tool]]\nnumber = 1\noperation = \"drill\"\ndiameter = 10.2\nspeed = 1200\nfeed = 180.0\n{point}\n\
             [[tool]]\nnumber = 2\noperation = \"tap\"\ndiameter = 12.0\nspeed = 300\npitch = 1.75\n\
             [[pattern]]\nid = \"A\"\npoints = [[5.0, 7.0]]\n\
             make = [{{ tool = 1, depth = 32.0 }}, {{ tool = 2, depth = {depth:?} }}]\n"
        );
        let found = refusals(&Bench::of(&job)).join("\n");
        assert_eq!(!found.is_empty(), is_refused, "{point} {depth}: {found}");
        assert!(!is_refused || found.contains("tap-drill"), "{found}");
    }
}

/// A spot of 90° is twice as wide as deep: 7 mm at 3.5 mm in a hole of 8, 10 mm at 5 mm, which breaks the edge by 1 mm a side.
/// The list has the drilled hole alone.
#[test]
fn a_spot_drill_makes_no_feature_and_stays_inside_its_hole() {
    for (depth, is_refused) in [(3.5, false), (5.0, true)] {
        let job = format!(
            "family = \"pattern\"\ncontrol = {{ dialect = \"fanuc-31i\", increment = \"IS-B\" }}\n\
             tolerance = {{ position = 0.05 }}\n\
             [[tool]]\nnumber = 1\noperation = \"spot-drill\"\ndiameter = 12.0\nspeed = 1200\nfeed = 120.0\n\
             [[tool]]\nnumber = 2\noperation = \"drill\"\ndiameter = 8.0\nspeed = 1500\nfeed = 200.0\n\
             [[pattern]]\nid = \"A\"\npoints = [[5.0, 7.0], [40.0, 7.0]]\n\
             make = [{{ tool = 1, depth = {depth:?} }}, {{ tool = 2, depth = 20.0 }}]\n"
        );
        let found = refusals(&Bench::of(&job)).join("\n");
        assert_eq!(!found.is_empty(), is_refused, "{depth}: {found}");
        assert!(!is_refused || found.contains("feature-extra"), "{found}");
        let reference = gcode_part::NominalPart::parse(&job).unwrap().into_holes().unwrap();
        let holes: Vec<_> = reference.holes.iter().map(|hole| (hole.diameter, hole.features.len())).collect();
        assert_eq!(holes, [(Some(8.0), 0); 2]);
    }
}

#[test]
fn a_wrong_digit_of_a_macro_or_a_call_is_refused() {
    for (layout, program, edit) in [
        (0, 8501, "#7/2*COS => #7/3*COS"),
        (0, 8501, "SIN[#27]*#28 => SIN[#27]*#29"),
        (0, 8501, "#2=#2/#11 => #2=#2/[#11+1]"),
        (0, 8500, "S2. => S3."),
        (0, 8500, "A-90. => A-91."),
        (0, 8500, "B-360. => B360."),
        (1, 8500, "B-40. => B40."),
        (3, 8502, "-#28*#5*SIN => +#27*#5*COS"),
        (3, 8502, "#33-1-#28*#11 => #33-#28*#11"),
        (3, 8500, "K7. => K0."),
        (3, 8500, "J-30. => J30."),
        (4, 8500, "I30. => I30.1"),
        (5, 8503, "Z-#26 R#3 F#9\nGOTO 80\nN40 => Z-#26-1 R#3 F#9\nGOTO 80\nN40"),
    ] {
        let bench = Bench::of(&job("", LAYOUTS[layout], OPERATIONS[0])).edited(program, edit);
        assert!(!refusals(&bench).is_empty(), "O{program}: {edit}");
    }
}

#[test]
fn wrong_arguments_are_refused_before_anything_moves() {
    let bench = Bench::of(&job("", LAYOUTS[0], OPERATIONS[0]));
    for (edit, number) in [
        ("H5. => H0.", 189),
        ("H5. => H2.5", 189),
        ("D80. => D0.", 188),
        ("A-90. => ", 186),
        ("B-360. => B0.", 187),
        ("R0. => R-1.", 190),
        ("R0. => R75.", 193),
        ("S2. => S6.", 194),
        ("S2. => S25.", 194),
        ("S2. => S200.", 194),
        ("U0. => U0.5", 193),
        ("M81. Z => M82. Z", 178),
        ("Z20. => Z0.", 176),
        ("V50. => V1.9", 177),
        ("F200. => F0.", 179),
    ] {
        let bench = bench.clone().edited(8500, edit);
        let run = bench.run(8500, &Placement::default(), &[]);
        assert_eq!(alarm(&run), Some(3000 + number), "{edit}");
    }
    let inches = bench.edited(8500, "M08 => G20");
    assert_eq!(alarm(&inches.run(8500, &Placement::default(), &[])), Some(3185));
}

/// A thread of the other hand, by the call, by the spindle or by the macro, is refused.
#[test]
fn a_thread_of_the_other_hand_is_refused() {
    for (operation, program, edit) in [
        (4, 8500, "M84. => M74."),
        (6, 8500, "M74. => M84."),
        (6, 8503, "G98 G74 => G98 G84"),
        (5, 8500, "M33. => M34."),
        (7, 8500, "M34. => M33."),
        (7, 8503, "THEN #5=2 => THEN #5=3"),
    ] {
        let bench = Bench::of(&job("", LAYOUTS[0], OPERATIONS[operation])).edited(program, edit);
        assert!(!refusals(&bench).is_empty(), "O{program}: {edit}");
    }
}

/// Z is home before each of two tools, before the table turns, and at the end.
#[test]
fn z_goes_home_before_a_tool_or_the_table_changes() {
    for (home, block) in [("G28", "G91 G28 Z0."), ("G53", "G53 G00 Z0."), ("none", "")] {
        let place = PLACES[2].replace("machine = {", &format!("machine = {{ home = \"{home}\","));
        let bench = Bench::of(&job(&place, LAYOUTS[0], OPERATIONS[4]));
        assert_eq!(refusals(&bench), Vec::<String>::new(), "{home}");
        let text = &bench.package.program(8500).unwrap().text;
        let homes: Vec<usize> = text.match_indices(block).map(|(place, _)| place).collect();
        if home == "none" {
            assert!(!text.contains("G28") && !text.contains("G53 "), "{text}");
            continue;
        }
        assert_eq!(homes.len(), 3, "{text}");
        for code in ["M06\n", "G53.1 ("] {
            let changes: Vec<usize> = text.match_indices(code).map(|(place, _)| place).collect();
            assert_eq!(changes.len(), 2, "{text}");
            // Between a return and its change nothing leaves home.
            for (home, change) in homes.iter().zip(&changes) {
                assert!(home < change && !text[*home..*change].contains("G43"), "{text}");
            }
        }
    }
}
