//! Lists of a program's own holes where the program mills first, spots, sinks and speaks inches: each passes on its program.
use std::path::Path;

use gcode_tests::programs::run_line;
use tempfile::TempDir;

/// A block of 20 thick, with a floor 5 below its top that the program may mill.
const STOCK: &str = "[stock]\nkind = \"box\"\nmin = [0, 0, -20]\nmax = [60, 40, 0]\n\n[[stock.pocket]]\nkind = \"box\"\n\
                     min = [0, 0, -5]\nmax = [30, 40, 0]\n";

const TOOLS: [(u32, &str, f64); 6] = [
    (1, "spot-drill", 12.0),
    (2, "drill", 8.0),
    (3, "end-mill", 10.0),
    (4, "drill", 5.0),
    (5, "countersink", 16.0),
    (6, "counterbore", 15.0),
];

/// Writes a machine file with a stock, if there is one, and the tools; of the tool `without` it leaves the kind out.
fn write_machine(dir: &Path, stock: &str, without: u32) {
    let mut text = format!("[head]\nkind = \"fixed\"\ndirection = [0, 0, 1]\n\n{stock}");
    for (number, kind, diameter) in TOOLS {
        let kind = if number == without { String::new() } else { format!("kind = \"{kind}\"\n") };
        text += &format!("\n[[tool]]\nnumber = {number}\n{kind}diameter = {diameter}\n");
    }
    std::fs::write(dir.join("machine.toml"), text).unwrap();
}

/// Returns a new folder with such a machine file.
fn with_machine(stock: &str, without: u32) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_machine(folder.path(), stock, without);
    folder
}

/// Returns two drilling cycles at x = 45, y = 20, each by a tool down to a depth.
fn two_cycles(cycles: [(u32, &str); 2]) -> [String; 2] {
    cycles.map(|(tool, depth)| with_tool(tool, &format!("G98 G81 X45. Y20. Z-{depth} R2. F90.")))
}

/// Returns a use of a tool.
fn with_tool(tool: u32, blocks: &str) -> String {
    format!("T{tool} M6\nS900 M3\nG43 H{tool} Z50.\n{blocks}\nG80\nG0 Z50.\n")
}

/// Writes the list of a program; returns its lines behind the header, and the messages.
fn list(dir: &Path, uses: &[String], flags: &str) -> (Vec<String>, String) {
    std::fs::write(dir.join("O1.nc"), format!("O1\nG21 G90 G54 G0 X0 Y0\n{}M30\n", uses.concat())).unwrap();
    let done = run_line(&format!("gcode-sim new reference --from O1.nc -o O1.csv --force {flags}"), dir);
    let messages = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(0), "{messages}");
    let csv = std::fs::read_to_string(dir.join("O1.csv")).unwrap();
    (csv.lines().skip(1).map(str::to_owned).collect(), messages)
}

/// Verifies the program against its own list, and returns the exit code with the printed text.
fn verify(dir: &Path) -> (i32, String) {
    let done = run_line("gcode-sim verify O1.nc --reference O1.csv", dir);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (done.status.code().unwrap(), text(&done.stdout) + &text(&done.stderr))
}

/// Drills at 15, 20 on the floor and at 45, 20 on the top, each to Z-15.: 10 deep below the floor of 5, 15 below the top.
const DRILL: &str = "G99 G81 X15. Y20. Z-15. R2. F90.\nX45.";
/// Mills the floor: rows 8 apart with a mill of 10 from y = 4 to y = 36, over all of x = 0 to 25.
const FLOOR: &str =
    "G0 X-10. Y4.\nZ-5.\nG1 X25. F300.\nY12.\nX-10.\nY20.\nX25.\nY28.\nX-10.\nY36.\nX25.\nG0 Z50.";

#[test]
fn a_hole_begins_at_the_floor_that_the_program_mills_before_it() {
    let folder = with_machine(STOCK, 0);
    let dir = folder.path();
    let (floor, drill) = (with_tool(3, FLOOR), with_tool(2, DRILL));

    let (holes, messages) = list(dir, &[floor.clone(), drill.clone()], "");
    assert_eq!(holes, ["1,15,20,-5,0,0,1,10,8", "2,45,20,0,0,0,1,15,8"]);
    assert!(messages.contains("1 hole with the entry below the surface"), "{messages}");
    assert!(!messages.contains("feeds that are in no hole"), "{messages}");
    let (code, text) = verify(dir);
    assert_eq!(code, 0, "{text}");

    // Drilled before the floor is milled, both begin at the top.
    let (holes, messages) = list(dir, &[drill, floor], "");
    assert_eq!(holes, ["1,15,20,0,0,0,1,15,8", "2,45,20,0,0,0,1,15,8"]);
    assert!(!messages.contains("below the surface"), "{messages}");

    // A spot of 90° 3 below the floor is 6 wide there, inside the drill of 8; one of 5 is 10 wide and stays.
    for (depth, features) in [(3, ""), (5, "countersink 10 angle=90; drill 8 10")] {
        let spot = with_tool(1, &format!("G99 G81 X15. Y20. Z-{}. R-3. F90.", 5 + depth));
        let drill = with_tool(2, "G99 G81 X15. Y20. Z-15. R2. F90.");
        let (holes, _) = list(dir, &[with_tool(3, FLOOR), spot, drill], "");
        // The tip of the spot drill is no feature where its cone is inside the drill: the drill makes all of the hole.
        let expected = if features.is_empty() { ",drill 8 10".to_owned() } else { format!(",{features}") };
        assert_eq!(holes, [format!("1,15,20,-5,0,0,1,10,{expected}")], "{depth}");
        let (code, text) = verify(dir);
        assert_eq!(code, 0, "{depth}: {text}");
    }
}

/// A countersink of 90° whose tip goes round 5 off the axis at Z-2. opens 2·(5 + 2) = 14 at the top.
#[test]
fn a_chamfer_that_a_pointed_tool_mills_is_a_countersink() {
    let folder = with_machine(STOCK, 0);
    let dir = folder.path();
    let bore = with_tool(3, "G0 X45. Y20.\nZ2.\nG1 Z-20.5 F90.\nX46.\nG3 I-1.\nG1 X45.");
    for (radius, depth, diameter) in [(5, 2, 14), (6, 1, 14), (6, 2, 16)] {
        let chamfer =
            format!("G0 X45. Y20.\nZ2.\nG1 Z-{depth}. F90.\nX{}.\nG3 I-{radius}.\nG1 X45.", 45 + radius);
        let (holes, messages) = list(dir, &[bore.clone(), with_tool(5, &chamfer)], "");
        let features = format!("bore 12 20; countersink {diameter} angle=90");
        assert_eq!(holes, [format!("1,45,20,0,0,0,1,20,,{features},yes")], "{messages}");
        let (code, text) = verify(dir);
        assert_eq!(code, 0, "{radius}, {depth}: {text}");
        // A chamfer of another diameter is found.
        let csv = std::fs::read_to_string(dir.join("O1.csv")).unwrap();
        let other =
            csv.replace(&format!("countersink {diameter} "), &format!("countersink {} ", diameter + 1));
        std::fs::write(dir.join("O1.csv"), other).unwrap();
        assert_eq!(verify(dir).0, 1, "{radius}, {depth}");
    }
}

/// Of a pilot Φ5 to Z-10. under a drill Φ8 to Z-15. nothing is left. Both points have 118°: the drill is as wide as the pilot's edge
/// 2.5/tan 59° = 1.502 above its tip, as that edge is above the pilot's own: a pilot to Z-15. is gone too, one to Z-15.1 is not.
#[test]
fn a_pilot_that_nothing_remains_of_is_no_feature() {
    let folder = with_machine(STOCK, 0);
    let dir = folder.path();
    for (pilot, expected) in [("10.", "15,8"), ("15.", "15,8"), ("15.1", "15.1,,drill 5 15.1; drill 8 15")] {
        let uses = two_cycles([(4, pilot), (2, "15.")]);
        let (holes, _) = list(dir, &uses, "");
        assert_eq!(holes, [format!("1,45,20,0,0,0,1,{expected}")], "{pilot}");
        let (code, text) = verify(dir);
        assert_eq!(code, 0, "{pilot}: {text}");
    }
}

/// Spotted at x = 40, 45, 50 in this order; the middle hole is then milled, the outer ones plunged by a counterbore.
#[test]
fn holes_are_listed_in_the_order_of_their_first_cuts() {
    let folder = with_machine(STOCK, 0);
    let dir = folder.path();
    let spot = with_tool(1, "G99 G81 X8. Y20. Z-2. R2. F90.\nX30.\nX52.");
    let drill = with_tool(2, "G99 G81 X8. Y20. Z-15. R2. F90.\nX30.\nX52.");
    let mill = with_tool(3, "G0 X30. Y20.\nZ2.\nG1 Z-6. F90.\nX32.5\nG3 I-2.5\nG1 X30.");
    let bore = with_tool(6, "G99 G81 X8. Y20. Z-6. R2. F90.\nX52.");
    let (holes, _) = list(dir, &[spot, drill, mill, bore], "");
    let hole = |id: u32, x: u32| format!("{id},{x},20,0,0,0,1,15,,drill 8 15; counterbore 15 6");
    assert_eq!(holes, [hole(1, 8), hole(2, 30), hole(3, 52)]);
    let (code, text) = verify(dir);
    assert_eq!(code, 0, "{text}");
}

#[test]
fn the_tool_whose_kind_is_unknown_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let uses = two_cycles([(2, "15."), (6, "6.")]);
    write_machine(dir, STOCK, 6);
    let (holes, messages) = list(dir, &uses, "");
    assert_eq!(holes, ["1,45,20,0,0,0,1,15,8"]);
    let note = "1 hole with one diameter, though several tools cut: the machine file lacks the kind or the diameter of T6";
    assert!(messages.contains(note), "{messages}");
    write_machine(dir, STOCK, 0);
    let (holes, messages) = list(dir, &uses, "");
    assert_eq!(holes, ["1,45,20,0,0,0,1,15,,drill 8 15; counterbore 15 6"]);
    assert!(!messages.contains("though several tools cut"), "{messages}");
}

/// Without a surface nobody knows how wide a spot is there; 2 below the R point level one of Z-5. is 10 wide.
#[test]
fn no_cone_is_counted_from_the_r_point_level() {
    let folder = with_machine("", 0);
    let dir = folder.path();
    let uses = two_cycles([(1, "5."), (2, "15.")]);
    let (holes, _) = list(dir, &uses, "--clearance 2");
    assert_eq!(holes, ["1,45,20,0,0,0,1,15,,countersink 10 angle=90; drill 8 15"]);
    let (code, text) = verify(dir);
    assert_eq!(code, 0, "{text}");
    let done = run_line("gcode-sim new reference --from O1.nc -o O2.csv", dir);
    let messages = String::from_utf8(done.stderr).unwrap();
    assert_eq!((done.status.code(), dir.join("O2.csv").exists()), (Some(2), false), "{messages}");
    assert!(messages.contains("the countersink of hole 1 counts from the surface"), "{messages}");
    // Without cones the list needs no surface.
    let (holes, _) = list(dir, &uses[1..], "");
    assert_eq!(holes, ["1,45,20,2,0,0,1,17,8"]);
}

/// X1.5 is 38.1 mm, a drill of 8 mm is 8/25.4 = 0.31496 inch; --clearance .1 brings R.1 to 0.
#[test]
fn the_list_of_a_program_in_inches_is_in_inches() {
    let folder = with_machine("", 0);
    let dir = folder.path();
    let blocks = "G20\nG98 G81 X1.5 Y.75 Z-.5 R.1 F4.\nG80";
    let (holes, messages) = list(dir, &[with_tool(2, blocks)], "--clearance .1");
    assert_eq!(holes, ["1,1.5,0.75,0,0,0,1,0.5,0.31496"]);
    assert!(
        messages.contains("1 hole as the program makes them, in inches; entries lie 0.1 inch below"),
        "{messages}"
    );
    let csv = std::fs::read_to_string(dir.join("O1.csv")).unwrap();
    assert!(csv.starts_with("id,x [inch],y [inch],z [inch],i,j,k,depth [inch],diameter [inch]\n"), "{csv}");
    let (code, text) = verify(dir);
    assert_eq!(code, 0, "{text}");
    let done = run_line("gcode-sim new reference --from O1.nc -o O1.json --clearance .1", dir);
    assert_eq!(done.status.code(), Some(0));
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(dir.join("O1.json")).unwrap()).unwrap();
    assert_eq!((&json["unit"], &json["holes"][0]["depth"]), (&"inch".into(), &0.5.into()));
}

/// A helix of 2 a turn to Z-9. without a closing circle: full to its last but one turn at Z-7., and a ramp below. `verify` fails the
/// program with such a list, and the list says so; with the circle the hole is 9 deep, and nothing is said.
#[test]
fn a_list_says_where_its_own_program_fails() {
    let folder = with_machine(STOCK, 0);
    let dir = folder.path();
    let turns: String = [1, 3, 5, 7, 9].map(|depth| format!("G3 I-3. Z-{depth}. F200.\n")).concat();
    for (circle, depth, fails) in [("", 7, true), ("G3 I-3.\n", 9, false)] {
        let mill = with_tool(3, &format!("G17 G0 X45. Y20.\nZ1.\nG1 X48. F300.\n{turns}{circle}G1 X45."));
        let (holes, messages) = list(dir, &[mill], "");
        assert_eq!(holes, [format!("1,45,20,0,0,0,1,{depth},16")]);
        let note =
            "note: verify of the program against this list as it stands: FAIL: a feed cuts beside a hole";
        assert_eq!(messages.contains(note), fails, "{messages}");
        assert_eq!(verify(dir).0, i32::from(fails));
    }
}

/// A drill of 8 to 10 below the floor of a pocket, and a countersink of 90° 5 below it from 2 above: its feed is 7 of the hole's 12, and
/// the drill makes the hole all the same, as on the top beside it.
#[test]
fn a_countersink_on_a_milled_floor_is_not_the_diameter_of_the_hole() {
    let folder = with_machine(STOCK, 0);
    let dir = folder.path();
    let drill = with_tool(2, "G99 G81 X15. Y20. Z-15. R-3. F90.\nX45. R2.");
    let sink = with_tool(5, "G99 G81 X15. Y20. Z-10. R-3. F90.\nX45. Z-5. R2.");
    let sunk = "10,,drill 8 10; countersink 10 angle=90";
    let top = "15,,drill 8 15; countersink 10 angle=90";
    let (holes, _) = list(dir, &[with_tool(3, FLOOR), drill, sink], "");
    assert_eq!(holes, [format!("1,15,20,-5,0,0,1,{sunk}"), format!("2,45,20,0,0,0,1,{top}")]);
    let done = run_line("gcode-sim holes O1.nc --format json", dir);
    let json: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    let diameters = [&json["holes"][0]["diameter"], &json["holes"][1]["diameter"]];
    assert_eq!(diameters, [&serde_json::Value::from(8.0); 2]);
}

/// The block is 60 long: the cycle at x = 200 drills the next vise's part, and has no line in the list of this one.
#[test]
fn cycles_beside_the_stock_are_said_to_be_left_out() {
    let folder = with_machine(STOCK, 0);
    let cycle = |x: &str| with_tool(2, &format!("G98 G81 X{x} Y20. Z-10. R2. F90."));
    let (lines, messages) = list(folder.path(), &[cycle("45."), cycle("200.")], "");
    assert_eq!(lines.len(), 1);
    let note = "not in the list: 1 stroke of drilling cycles where the part has no metal";
    assert!(messages.contains(note), "{messages}");
    let (lines, messages) = list(folder.path(), &[cycle("45."), cycle("50.")], "");
    assert_eq!(lines.len(), 2);
    assert!(!messages.contains("not in the list"), "{messages}");
}
