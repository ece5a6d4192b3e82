//! Files that `gcode-sim new` writes: the templates of machines make holes that are computed by hand, and a list of a program's own holes
//! is read back.
use std::path::Path;

use gcode_tests::programs::run_line;

/// Head of a program, before its first axis word.
const START: &str = "O1\nG21 G90 G17 G40 G49 G80 G98\nG54\nT1 M6\nM3 S1000\n";

/// Drills on two sides: `side` and `top` are the rotary positions, `first` and `second` the blocks of the cycle.
fn two_sides(side: &str, first: &str, top: &str, second: &str) -> String {
    format!("{START}G0 {side}\n{first}\nG80\nG0 Z100.\n{top}\n{second}\nG80\nG0 Z100.\nM5\nM30\n")
}

/// Drills 12 deep at 5, 7 of a plane through (50, 20, −10) that faces +x: G68.2's I90 turns its x to +y, J90 its y to +z. So the
/// hole enters at x = 50, y = 20 + 5, z = −10 + 7, with its axis along +x.
const TILTED: &str = "G68.2 X50. Y20. Z-10. I90. J90. K0.\nG53.1\nG0 X5. Y7.\nG43 H1 Z100.\nG81 Z-12. R2. F200.\nG80\n\
                      G0 Z100.\nG69\nG49\nM5\nM30\n";

const TILTED_HOLE: &str = "1,50,25,-3,1,0,0,12,\n";

/// A kind of machine, a program, and the holes that it makes there.
fn cases() -> Vec<(&'static str, String, &'static str)> {
    // A90. at sign −1 turns the part by −90° about x: a point (x, y, z) from the centre comes to (x, z, −y). On the 4th axis the
    // part's origin is the centre: the hole into the face y = −25 at x = 30, z = 10 is fed from Z = 25 at Y = 10.
    let fourth = two_sides(
        "A90.",
        "X30. Y10.\nG43 H1 Z100.\nG81 Z13. R27. F200.",
        "A0.",
        "X5. Y-8.\nG81 Z10. R27. F200.",
    );
    // On the trunnion the origin is 50 above the centre: (10, −30, −20) is (10, −30, 30) from it, comes to (10, 30, 30), and that is
    // X10. Y30. Z-20. in G54. C90. at sign −1 brings (20, 5) to (5, −20).
    let trunnion = two_sides(
        "A90. C0.",
        "X10. Y30.\nG43 H1 Z100.\nG81 Z-35. R-18. F200.",
        "A0. C90.",
        "X5. Y-20.\nG81 Z-10. R2. F200.",
    );
    let plate = format!("{START}G0 X30. Y10.\nG43 H1 Z100.\nG81 Z-12. R2. F200.\nG80\nG0 Z100.\nM5\nM30\n");
    let tilted = format!("{START}{TILTED}");
    vec![
        ("3-axis", plate, "1,30,10,0,0,0,1,12,\n"),
        ("4th-axis", fourth, "1,30,-25,10,0,-1,0,12,\n2,5,-8,25,0,0,1,15,\n"),
        ("trunnion", trunnion, "1,10,-30,-20,0,-1,0,15,\n2,20,5,0,0,0,1,10,\n"),
        ("trunnion", tilted.clone(), TILTED_HOLE),
        ("head-table", tilted.clone(), TILTED_HOLE),
        ("head-head", tilted, TILTED_HOLE),
    ]
}

const HEADER: &str = "id,x,y,z,i,j,k,depth,diameter\n";

/// Runs a line and returns its exit code, standard output and standard error.
fn run(line: &str, dir: &Path) -> (i32, String, String) {
    let done = run_line(line, dir);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (done.status.code().unwrap(), text(&done.stdout), text(&done.stderr))
}

#[test]
fn every_template_of_a_machine_makes_the_computed_holes() {
    for (kind, program, holes) in cases() {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path();
        assert_eq!(run(&format!("gcode-sim new machine --kind {kind} -o machine.toml"), dir).0, 0);
        std::fs::write(dir.join("O1.nc"), program).unwrap();
        std::fs::write(dir.join("holes.csv"), format!("{HEADER}{holes}")).unwrap();
        let verify = "gcode-sim verify O1.nc --reference holes.csv --tolerance 0.001";
        let (code, result, messages) = run(verify, dir);
        assert_eq!(code, 0, "{kind}\n{result}{messages}");
        assert_eq!(messages, "machine: machine.toml\n", "{kind}");

        // The program's own holes are those computed, where R is 2 above the surface.
        let (code, list, _) = run("gcode-sim new reference --from O1.nc --clearance 2", dir);
        assert_eq!((code, list), (0, format!("{HEADER}{holes}")), "{kind}");

        // The machine decides: with its rotary axes the other way round the holes are elsewhere.
        let text = std::fs::read_to_string(dir.join("machine.toml")).unwrap();
        if kind.ends_with("axis") || kind == "trunnion" {
            std::fs::write(dir.join("machine.toml"), text.replace("sign = -1 ", "sign = 1 ")).unwrap();
            let is_tilted = holes == TILTED_HOLE;
            // The control knows the sign in a tilted plane and turns the axes the other way.
            assert_eq!(run(verify, dir).0, i32::from(kind != "3-axis" && !is_tilted), "{kind}");
        }
    }
}

#[test]
fn a_list_of_a_programs_holes_is_written_as_its_ending_says() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let (_, program, _) = cases().swap_remove(0);
    std::fs::write(dir.join("O1.nc"), program).unwrap();
    for name in ["holes.csv", "holes.json"] {
        let (code, _, messages) = run(&format!("gcode-sim new reference --from O1.nc -o {name}"), dir);
        assert_eq!(code, 0, "{messages}");
        assert!(messages.contains("entries lie where the feed begins (R point level)"), "{messages}");
        assert_eq!(run(&format!("gcode-sim verify O1.nc --reference {name}"), dir).0, 0, "{name}");
    }
    let csv = std::fs::read_to_string(dir.join("holes.csv")).unwrap();
    assert_eq!(csv, format!("{HEADER}1,30,10,2,0,0,1,14,\n"), "from R2. to Z-12.");
    // A list that was corrected is kept.
    std::fs::write(dir.join("holes.csv"), format!("{HEADER}1,30,10,0,0,0,1,12,8\n")).unwrap();
    let (code, _, messages) = run("gcode-sim new reference --from O1.nc -o holes.csv", dir);
    assert_eq!(code, 2);
    assert!(messages.contains("error: holes.csv already exists"), "{messages}");
    assert_eq!(run("gcode-sim new reference --from O1.nc -o holes.csv --force", dir).0, 0);
    assert_eq!(std::fs::read_to_string(dir.join("holes.csv")).unwrap(), csv);
}

/// The full diameter of 8.5 with a point of 118° ends 8.5/2/tan 59° = 2.554 above the tip: 21.446 deep at Z-24, through the
/// stock of 20; 19.446 at Z-22, not through.
#[test]
fn a_hole_whose_full_diameter_leaves_the_stock_is_listed_as_through() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let machine = "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n[[tool]]\nnumber = 1\nkind = \"drill\"\ndiameter = 8.5\n\
                   point_angle = 118.0\nlength = 100.0\n[stock]\nkind = \"box\"\nmin = [0.0, 0.0, -20.0]\nmax = [60.0, 40.0, 0.0]\n";
    std::fs::write(dir.join("machine.toml"), machine).unwrap();
    let program = "O1\nG21 G90 G54 G40 G80\nT1 M6\nS800 M3\nG0 X15. Y20.\nG43 H1 Z50.\nG99 G83 Z-24. Q5. R2. F90.\nX45. Z-22.\n\
                   G80 G0 Z50.\nM30\n";
    std::fs::write(dir.join("O1.nc"), program).unwrap();
    let (code, list, messages) = run("gcode-sim new reference --from O1.nc", dir);
    let header = HEADER.replace("diameter\n", "diameter,through\n");
    let expected = format!("{header}1,15,20,0,0,0,1,20,8.5,yes\n2,45,20,0,0,0,1,22,8.5,\n");
    assert_eq!((code, list.as_str()), (0, expected.as_str()), "{messages}");
    assert!(messages.contains("note: 1 hole through the stock"), "{messages}");
    std::fs::write(dir.join("holes.csv"), &list).unwrap();
    let (code, text, messages) = run("gcode-sim verify O1.nc --reference holes.csv", dir);
    assert!(code == 0 && text.contains("PASS"), "{text}{messages}");

    // A list with the depth of the tip says what is wrong with it.
    std::fs::write(dir.join("holes.csv"), list.replace("1,20,8.5,yes", "1,24,8.5,yes")).unwrap();
    let (code, _, messages) = run("gcode-sim verify O1.nc --reference holes.csv", dir);
    assert!(code == 1 && messages.contains("the part is 20.000 mm thick there: write that"), "{messages}");
    // A drill that doesn't break out is no fault of the list.
    std::fs::write(dir.join("holes.csv"), list.replace("1,22,8.5,", "1,20,8.5,yes")).unwrap();
    let (code, _, messages) = run("gcode-sim verify O1.nc --reference holes.csv", dir);
    assert!(code == 1 && messages.contains("drill deeper: the full diameter"), "{messages}");
}

/// Features by hand: T1's cone of 90° is 2·4 wide where it is 4 deep, 8 of which T2 leaves open below 8.5, so that it makes
/// none; T3's is 2·6 = 12 wide, T4 taps 750 / 500 = 1.5.
#[test]
fn a_hole_of_several_tools_is_listed_with_its_features() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let pass = |tool, cycle: &str| format!("T{tool} M6\nS500 M3\nG43 H{tool} Z50.\n{cycle}\nG80 G0 Z50.\n");
    let (spot, drill) = (pass(1, "G81 X9. Y8. Z-4. R2. F90."), pass(2, "G83 X9. Y8. Z-25. R1. Q4. F90."));
    let (sink, tap) = (pass(3, "G82 X9. Y8. Z-6. R2. P9 F90."), pass(4, "G84 X9. Y8. Z-18. R5. F750."));
    let program = format!("O1\nG90 G54 G0 X9. Y8.\n{spot}{drill}{sink}{tap}M30\n");
    std::fs::write(dir.join("O1.nc"), program).unwrap();
    let verify = "gcode-sim verify O1.nc --reference holes.csv";
    let list = "gcode-sim new reference --from O1.nc -o holes.csv";

    // No tool is known. The entry lies where the lowest feed begins; the program passes its own list.
    assert_eq!(run(list, dir).0, 0);
    let csv = std::fs::read_to_string(dir.join("holes.csv")).unwrap();
    assert_eq!(csv, format!("{HEADER}1,9,8,1,0,0,1,26,\n"), "from R1. to Z-25.");
    let (code, text, messages) = run(verify, dir);
    assert_eq!(code, 0, "{text}{messages}");
    assert!(text.contains("not checked: the thread that T4 cuts"), "{text}");

    let tools =
        ["spot-drill|12", "drill|8.5", "countersink|16", "tap|10"].map(|tool| tool.split_once('|').unwrap());
    let mut machine = "[head]\nkind = \"fixed\"\ndirection = [0, 0, 1]\n\n[stock]\nkind = \"box\"\nmin = [0.0, 0.0, -40.0]\n\
                       max = [20.0, 20.0, 0.0]\n"
        .to_owned();
    for (number, (kind, diameter)) in (1..).zip(tools) {
        machine += &format!("\n[[tool]]\nnumber = {number}\nkind = \"{kind}\"\ndiameter = {diameter}\n");
    }
    std::fs::write(dir.join("machine.toml"), machine).unwrap();
    assert_eq!(run(&format!("{list} --force"), dir).0, 0);
    let csv = std::fs::read_to_string(dir.join("holes.csv")).unwrap();
    let header = HEADER.replace("diameter", "diameter,features");
    let features = "drill 8.5 25; countersink 12 angle=90; tap 10 18 pitch=1.5";
    assert_eq!(csv, format!("{header}1,9,8,0,0,0,1,25,,{features}\n"));
    let (code, text, messages) = run(verify, dir);
    assert_eq!(code, 0, "{text}{messages}");
    // The list judges each of them.
    for (digit, other) in [("Z-25.", "Z-24."), ("Z-18.", "Z-17."), ("F750.", "F700."), ("Z-6.", "Z-5.5")] {
        let program = std::fs::read_to_string(dir.join("O1.nc")).unwrap();
        std::fs::write(dir.join("O1.nc"), program.replace(digit, other)).unwrap();
        assert_eq!(run(verify, dir).0, 1, "{other}");
        std::fs::write(dir.join("O1.nc"), program).unwrap();
    }
}

/// T2 of 8 mills round 2 off the axis: 8 + 2·2 = 12, one turn of 1.75 up from Z-18. or eight; round 1 off it only 10 wide, which the drill of
/// 10.2 has left open.
#[test]
fn a_milled_thread_is_listed_with_its_pitch() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let head = "[head]\nkind = \"fixed\"\ndirection = [0, 0, 1]\n\n[stock]\nkind = \"box\"\n";
    let stock = "min = [0, 0, -40]\nmax = [20, 20, 0]\n";
    let tools = "\n[[tool]]\nnumber = 1\nkind = \"drill\"\ndiameter = 10.2\n\n[[tool]]\nnumber = 2\nkind = \"end-mill\"\ndiameter = 8\n";
    std::fs::write(dir.join("machine.toml"), format!("{head}{stock}{tools}")).unwrap();
    let drill = "T1 M6\nS900 M3\nG0 X9. Y8.\nG43 H1 Z50.\nG81 Z-25. R2. F90.\nG80 Z50.\n";
    let header = HEADER.replace("diameter", "diameter,features");
    let right_hand = "drill 10.2 25; tap 12 18 pitch=1.75";
    let left_hand = format!("{right_hand} hand=left");
    for (turns, code, offset, features) in [
        (1, "G3", 2, right_hand),
        (8, "G3", 2, right_hand),
        (8, "G2", 2, left_hand.as_str()),
        (8, "G3", 1, ""),
    ] {
        let turn = format!("{code} I-{offset}. Z1.75\n").repeat(turns);
        let mill = format!("G0 Z-18.\nG1 X{}. F200.\nG91 {turn}G90 G1 X9.\nG0 Z50.\n", 9 + offset);
        let program = format!("O1\nG90 G54\n{drill}T2 M6\nS900 M3\nG0 X9. Y8.\nG43 H2 Z50.\n{mill}M30\n");
        std::fs::write(dir.join("O1.nc"), program).unwrap();
        let (code, list, messages) = run("gcode-sim new reference --from O1.nc", dir);
        assert_eq!(code, 0, "{messages}");
        let expected = match features {
            "" => format!("{HEADER}1,9,8,0,0,0,1,25,10.2\n"),
            _ => format!("{header}1,9,8,0,0,0,1,25,,{features}\n"),
        };
        assert_eq!(list, expected, "{turns} turns, {offset}");
        assert_eq!(messages.contains("feed-no-hole"), features.is_empty(), "{messages}");
    }
}

#[test]
fn no_list_is_written_of_a_run_that_stops_or_makes_no_hole() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    std::fs::write(dir.join("O1.nc"), "O1\nG90 G0 X0. Y0. Z50.\nG81 Z-5. R2. F100.\n#1=1/0\nM30\n").unwrap();
    std::fs::write(dir.join("O2.nc"), "O2\nG90 G0 X0. Y0. Z50.\nM30\n").unwrap();
    for (program, code, reason) in [("O1", 3, "the run stopped"), ("O2", 1, "the program makes no hole")] {
        let done = run(&format!("gcode-sim new reference --from {program}.nc -o holes.csv"), dir);
        assert_eq!((done.0, dir.join("holes.csv").exists()), (code, false), "{program}");
        assert!(done.2.contains(&format!("nothing is written: {reason}")), "{}", done.2);
    }
    let done = run("gcode-sim new reference --from O2.nc -o holes.txt", dir);
    assert_eq!((done.0, done.2.as_str()), (2, "error: holes.txt: a list of holes ends with .csv or .json\n"));
}

#[test]
fn a_project_file_names_what_its_folder_holds() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let (_, program, _) = cases().swap_remove(0);
    std::fs::write(dir.join("O1.nc"), program).unwrap();
    std::fs::create_dir(dir.join("lib")).unwrap();
    assert_eq!(run("gcode-sim new machine --kind 3-axis --dialect fanuc-0i-f -o machine.toml", dir).0, 0);
    assert_eq!(run("gcode-sim new project -o gcode.toml", dir).0, 0);
    let (code, _, messages) = run("gcode-sim run O1.nc", dir);
    assert_eq!((code, messages.as_str()), (0, "machine: machine.toml; library: lib\n"));
}
