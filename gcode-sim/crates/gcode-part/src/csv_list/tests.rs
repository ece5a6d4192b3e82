//! Lists as spreadsheets write them, and lists that are refused.
use super::columns::{column_name, example, separator};
use super::*;

fn read(text: &str) -> CsvList {
    csv(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refused(text: &str) -> String {
    csv(text).unwrap_err().to_string()
}

#[test]
fn x_and_y_suffice_for_a_plate() {
    let list = read("x,y\n30,10\n-30.5,10\n");
    let holes = &list.holes.holes;
    assert_eq!([holes[0].entry, holes[1].entry], [[30.0, 10.0, 0.0], [-30.5, 10.0, 0.0]]);
    assert_eq!((holes[0].axis, holes[0].id.clone()), ([0.0, 0.0, 1.0], None));
    assert_eq!(list.open_depths, [0, 1]);
    let note = "z is 0: no column z; the axis is 0, 0, 1: no columns i, j, k; depths that are left out are not compared";
    assert_eq!(list.note.as_deref(), Some(note));
}

/// The same two holes as spreadsheets of several countries write them.
#[test]
fn separators_decimal_commas_case_units_and_a_line_with_the_separator_are_read() {
    let plain = read("id,x,y,z,depth,diameter\nA,30.5,10,0,15.25,6\nB,-30,10,0,15,6\n");
    for text in [
        "ID;X;Y;Z;Depth;Diameter\r\nA;30,5;10;0;15,25;6\r\nB;-30;10;0;15;6\r\n;;;;;\r\n",
        "Hole\tX [mm]\tY [mm]\tZ (mm)\tDepth\tDia\nA\t30,5\t10\t0\t15,25\t6\nB\t-30\t10\t0\t15\t6\n",
        "Hole\tX\tY\tZ\tDepth\tØ\nA\t30.5\t10\t0\t15.25\t6\nB\t-30\t10\t0\t15\t6\n",
        "sep=;\n\"Nr\";\"x\";\"y\";\"z\";\"depth\";\"d\"\n\"A\";\"30,5\";10;0;\"15,25\";6\nB;-30;10;0;15;6\n",
        "depth,diameter,remark,y,x,z,id\n15.25,6,\"left, top\",10,30.5,0,A\n15,6,,10,-30,0,B\n",
    ] {
        assert!(is_csv(text), "{text}");
        assert_eq!(read(text).holes, plain.holes, "{text}");
    }
    let list = read("x;y;z;i;j;k;depth;remark\n1,5;2;0;0;0;1;5;top\n");
    assert_eq!(list.note.as_deref(), Some("commas in numbers are decimal commas; unused: remark"));
}

/// The words of drawings: a column `thru`, `c'sink` and `csk` for a countersink.
#[test]
fn columns_have_the_words_of_drawings() {
    let plain = read("x,y,depth,countersink,countersink angle,through\n1,2,20,10,90,yes\n");
    for header in [
        "X,Y,DEPTH,C'SINK,C'SINK ANGLE,THRU",
        "x,y,depth,csk,csk angle,thru hole",
        "X Location,Y Location,depth,csk,csk angle,durchgehend",
    ] {
        for yes in ["YES", "x", "ja", "THRU", "1"] {
            let list = read(&format!("{header}\n1,2,20,10,90,{yes}\n"));
            assert_eq!(list.holes, plain.holes, "{header}, {yes}");
        }
        let blind = read(&format!("{header}\n1,2,20,10,90,\n1,3,20,10,90,nein\n1,4,20,10,90,0\n"));
        assert!(blind.holes.holes.iter().all(|hole| !hole.through), "{header}");
    }
    assert!(plain.holes.holes[0].through);
    assert!(
        refused("x,y,depth,thru\n1,2,20,20\n").contains("column 'through' is '20': yes or no is required")
    );
    for name in ["#", "Hole #", "Hole#", "Hole No.", "Pos."] {
        let text = format!("{name},X,Y,DEPTH\n7,1,2,20\n");
        assert!(is_csv(&text), "{name}");
        assert_eq!(read(&text).holes.holes[0].id.as_deref(), Some("7"), "{name}");
    }
    assert!(!is_csv("# holes, of the drawing\nfamily = \"pattern\"\n"));
}

/// A shaft's drawing has x and an angle: 0 degrees is on top, 90 towards y; the sine of 30 degrees is 0.5.
#[test]
fn holes_round_x_have_an_angle_and_a_radius() {
    let list = read("Hole,X,Angle [°],Radius,Depth\n1,10,0,20,5\n2,10,90,20,5\n3,-4,-30,20,5\n");
    let sixty = 0.75_f64.sqrt();
    let expected = [
        ([10.0, 0.0, 20.0], [0.0, 0.0, 1.0]),
        ([10.0, 20.0, 0.0], [0.0, 1.0, 0.0]),
        ([-4.0, -10.0, 20.0 * sixty], [0.0, -0.5, sixty]),
    ];
    for (hole, (entry, axis)) in list.holes.holes.iter().zip(expected) {
        for (found, expected) in hole.entry.iter().chain(&hole.axis).zip(entry.iter().chain(&axis)) {
            assert!((found - expected).abs() < 1e-12, "{hole:?}");
        }
    }
    assert_eq!(list.note.unwrap(), "angle counts about x, from z towards y, and the axis is along radius");
    let inches = read("x [inch],angle,radius,depth\n1,90,1,0.5\n");
    assert_eq!(inches.holes.holes[0].entry[1], 25.4);
    for (text, expected) in [
        (
            "x,angle,depth\n1,2,3\n",
            "column 'radius' is missing among x, angle, depth: x, angle and radius are the place",
        ),
        ("x,angle,radius,z,depth\n1,2,3,4,5\n", "column 'z' is there: it follows from angle and radius"),
        ("x,angle,radius,depth\n1,2,0,4\n", "column 'radius' is '0': a number above 0 is required"),
    ] {
        assert!(refused(text).contains(expected), "{}", refused(text));
    }
    let beside_y = read("x,y,angle,depth\n1,2,30,5\n");
    assert!(beside_y.note.unwrap().ends_with("unused: angle"));
}

#[test]
fn names_with_a_word_for_the_diameter_are_those_of_features() {
    let plain =
        read("id,x,y,depth,drill,drill depth,counterbore,counterbore depth\n1,30,10,20,6.8,20,11,5\n");
    let text = "Hole,X,Y,Hole Depth,Drill Dia,Drill Depth,C'Bore Dia.,C'Bore Depth\n1,30,10,20,6.8,20,11,5\n";
    assert_eq!(read(text).holes, plain.holes);
    assert_eq!(read("x,y,depth,Hole Dia\n1,2,3,8\n").holes.holes[0].diameter, Some(8.0));
}

/// Columns of a German drawing, beside them the same in English.
#[test]
fn columns_have_the_german_words_of_drawings() {
    let plain = read("id,x,y,depth,drill,tap,tap depth\n1,20,20,28,8.5,M10,18\n2,80,20,28,8.5,M10,18\n");
    for text in [
        "Nr;X;Y;Kernloch;Tiefe;Gewinde;Gewindetiefe\n1;20;20;8,5;28;M10;18\n2;80;20;8,5;28;M10;18\n",
        "Pos.;X-Maß;Y-Maß;Bohrung;Bohrtiefe;Gewinde;Gewindetiefe\n1;20;20;8,5;28;M10;18\n2;80;20;8,5;28;M10;18\n",
    ] {
        assert_eq!(read(text).holes, plain.holes, "{text}");
        assert_eq!(read(text).unread, Vec::<String>::new(), "{text}");
    }
    // Where nothing else names the holes, Bohrung does; beside Tiefe the depth of a bore is that of the drill.
    assert_eq!(read("Bohrung;X;Y;Bohrtiefe\nA;1;2;5\n").holes, read("id;x;y;depth\nA;1;2;5\n").holes);
    let own = read("x;y;Tiefe;Bohrung;Nr;Bohrtiefe\n1;2;20;8;1;15\n");
    assert_eq!(own.holes, read("x;y;depth;drill;id;drill depth\n1;2;20;8;1;15\n").holes);
    let fine =
        read("x;y;Tiefe;Kernloch;Gewinde;Gewindetiefe;Steigung;Senkung;Senkwinkel\n1;2;20;9;10;12;1;11;90\n");
    let same =
        "x;y;depth;drill;tap;tap depth;tap pitch;countersink;countersink angle\n1;2;20;9;10;12;1;11;90\n";
    assert_eq!(fine.holes, read(same).holes);
}

/// 21/64 inch is 8.334 mm, Q 0.332 inch 8.433; fractions are inches in a list in mm too, as 1/4-20 is.
#[test]
fn diameters_may_be_sizes_of_drills() {
    for (cell, diameter) in
        [("21/64", 0.328_125 * 25.4), ("Q", 0.332 * 25.4), ("#7", 0.201 * 25.4), ("Ø8.5", 8.5)]
    {
        let holes = read(&format!("x,y,depth,dia\n1,2,20,{cell}\n")).holes.holes;
        assert_eq!(holes[0].diameter, Some(diameter), "{cell}");
    }
    let inches = read("x [inch],y,dia\n1,2,1 1/8\n").holes.holes;
    assert_eq!(inches[0].diameter, Some(1.125 * 25.4));
}

/// A table of a CAD program has SIZE and no depth; a table of drills alone states diameters.
#[test]
fn a_size_or_a_drill_alone_is_the_diameter() {
    let plain = read("id,x,y,diameter\nA1,20,20,8.5\n");
    for header in [
        "TAG,X LOC,Y LOC,SIZE",
        "Hole,X Position,Y Position,Drill Size",
        "No,X mm,Y mm,Dia mm",
        "#,x,y,drill",
    ] {
        let list = read(&format!("{header}\nA1,20,20,8.50\n"));
        assert_eq!((list.holes, list.open_depths), (plain.holes.clone(), vec![0]), "{header}");
    }
    // Beside another diameter SIZE says something else, and a column behind a unit is one that is known.
    assert_eq!(read("x,y,dia,size\n1,2,3,L\n").unread, ["size"]);
    assert_eq!(read("x,y,built in\n1,2,3\n").holes.unit, Unit::Mm);
    assert_eq!(read("X in,Y in\n1,2\n").holes.holes[0].entry[0], 25.4);
}

/// 11 H7 THRU: the reamed diameter goes through; in a blind hole it has a depth of its own.
#[test]
fn reaming_of_a_through_hole_is_as_deep_as_the_hole() {
    let list = read("x,y,depth,drill,ream,thru\n1,2,20,10.8,11,yes\n");
    assert_eq!(list.holes, read("x,y,depth,drill,ream,ream depth,thru\n1,2,20,10.8,11,20,yes\n").holes);
    assert!(list.note.unwrap().contains("reaming or boring of a through hole without a depth"));
    assert!(refused("x,y,depth,drill,ream,thru\n1,2,20,10.8,11,no\n").contains("ream 11 needs a depth"));
    assert!(refused("x,y,depth,drill,tap,thru\n1,2,20,8.5,M10,yes\n").contains("tap M10 needs a depth"));
}

/// A tolerance and a kind of thread are statements of the drawing, a remark isn't.
#[test]
fn columns_that_state_something_and_are_not_read_are_known() {
    let list = read("x,y,depth,tolerance,remark,Qty\n1,2,3,0.02,top,2\n");
    assert_eq!(list.unread, ["tolerance"]);
    assert!(list.note.unwrap().ends_with("unused: tolerance, remark, qty"));
}

#[test]
fn a_title_above_the_columns_is_named() {
    for text in
        ["Hole table part 4711;;;\nHole;X;Y;Dia\n1;20;20;8,5\n", "# from drawing 4711\nHole,X,Y\n1,2,3\n"]
    {
        let (line, message) = wrong_header(text).unwrap();
        assert_eq!(line, 1, "{text}");
        assert_eq!(message, "line 2 names the columns, and has to be the first: remove what stands above it");
    }
    assert_eq!(wrong_header("x,y\n1,2\nx,y\n"), None);
    assert_eq!(wrong_header("# x, y\nfamily = \"pattern\"\nx = 1\n"), None);
}

#[test]
fn columns_with_spaces_between_them_are_refused_with_a_right_line() {
    let (line, message) = wrong_header("\nid x y depth\n1 30 10 15\n").unwrap();
    assert!(line == 2 && message.starts_with("columns are separated by spaces: "), "{message}");
    assert!(message.ends_with("id,x,y,depth,diameter, and below them: 1,30,10,15,6"), "{message}");
    assert_eq!(wrong_header("id,x y,y\n1,2,3\n"), None);
}

/// 1.5 inch is 38.1 mm, 0.25 inch 6.35; an axis and an angle have no length, and M10x1.5 is metric everywhere.
#[test]
fn a_header_with_inch_makes_all_lengths_inches() {
    let csv = "id,x [inch],y,depth,tap,tap depth,countersink,countersink angle,features\n\
               1,1.5,-2,.5,M10x1.5,.5,.75,90,drill .25 .5\n";
    let json = r#"{"unit": "inch", "holes": [{"id": "1", "entry": [1.5, -2, 0], "axis": [0, 0, 1], "depth": 0.5,
        "features": [{"kind": "drill", "diameter": 0.25, "depth": 0.5},
        {"kind": "countersink", "diameter": 0.75, "angle": 90}]}]}"#;
    let list = read(csv);
    let hole = &list.holes.holes[0];
    let near =
        |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    near(hole.entry[0], 38.1);
    near(hole.entry[1], -50.8);
    near(hole.depth, 12.7);
    let of = |kind: FeatureKind| hole.features.iter().find(|one| one.kind == kind).unwrap();
    assert_eq!((of(FeatureKind::Tap).diameter, of(FeatureKind::Tap).pitch), (10.0, Some(1.5)));
    near(of(FeatureKind::Tap).depth.unwrap(), 12.7);
    near(of(FeatureKind::Drill).diameter, 6.35);
    near(of(FeatureKind::Countersink).diameter, 19.05);
    assert_eq!((of(FeatureKind::Countersink).angle, hole.axis), (Some(90.0), [0.0, 0.0, 1.0]));
    assert!(list.note.unwrap().starts_with("lengths are in inches; "));

    let reference = crate::NominalPart::parse(json).unwrap().into_holes().unwrap();
    near(reference.holes[0].entry[0], 38.1);
    near(reference.holes[0].features[1].diameter, 19.05);
    assert_eq!(reference.list().unit, Unit::Mm);
}

#[test]
fn features_have_columns_of_their_own() {
    let cell = read(
        "id,x,y,depth,features\n1,30,10,30,drill 8.5 30 to=full; countersink 12 angle=90; tap 10 22 pitch=1.5\n",
    );
    for text in [
        "id,x,y,depth,drill,drill depth,drill to,tap,tap depth,tap pitch,countersink,countersink angle\n\
         1,30,10,30,8.5,30,full,10,22,1.5,12,90\n",
        "id;x;y;depth;Drill;Drill_depth;Drill-to;Tap;Tap depth;Countersink;Countersink angle\n\
         1;30;10;30;8,5;30;full;M10x1,5;22;12;90\n",
        "nr,x,y,depth,tap drill,tap drill depth,tap drill to,thread,thread depth,csink,csink angle\n\
         1,30,10,30,8.5,30,full,M10,22,12,90\n",
    ] {
        assert_eq!(read(text).holes, cell.holes, "{text}");
    }
    // A line without a feature of the column has none.
    let list = read("x,y,depth,drill,drill depth,tap,tap depth\n1,2,20,8.5,20,M10x1.5,15\n5,2,20,8.5,20,,\n");
    assert_eq!(list.holes.holes.iter().map(|hole| hole.features.len()).collect::<Vec<_>>(), [2, 1]);
}

#[test]
fn an_error_shows_a_line_that_is_right() {
    for (text, expected) in [
        ("x,y,dept\n1,2,3\n", "line 1: column 'dept' is unknown (did you mean 'depth'?); a list begins with"),
        ("x,y,x\n1,2,3\n", "line 1: column 'x' is there twice; "),
        (
            "id,x\n1,2\n",
            "line 1: column 'y' is missing among id, x; a list begins with its columns, for example: id,x,y,depth",
        ),
        (
            "x;z;depth\n1;2;3\n",
            "line 1: column 'y' is missing among x, z, depth; a list begins with its columns, for example: id;x;y;depth",
        ),
        (
            "x [cm],y,depth\n1,2,3\n",
            "line 1: column 'x [cm]': lengths are in mm, or in inches: [mm] or [inch]; ",
        ),
        (
            "x [in],y [mm],depth\n1,2,3\n",
            "line 1: columns are in mm and in inches: give all lengths in one unit; ",
        ),
        ("x,y,i,j,depth\n1,2,0,0,5\n", "line 1: column 'k' is missing: i, j and k together are the axis; "),
        ("id,x,y,depth\n1,2\n", "line 2: 2 columns, the header has 4; a right line: 1,30.5,10,15"),
        (
            "id,x,y,depth\n1,2,3,4,5\n",
            "line 2: 5 columns, the header has 4: decimal commas need semicolons between the columns; a right line: 1,30.5,10,15",
        ),
        (
            "\nid;x;y;depth\n\n1;2.5;3,5;4\n",
            "line 4: column 'y' is '3,5': the list has commas and points in its numbers; a right line: 1;30,5;10;15",
        ),
        ("x;y;depth\n3,5;1.250;4\n", "line 2: column 'y' is '1.250': the list has commas and points"),
        (
            "x,y,depth\n\"3,5\",1,4\n",
            "line 2: column 'x' is '3,5': a number with a point is required, because commas are separators; a right line: 30.5,10,15",
        ),
        (
            "x,y,depth\n3.5,left,4\n",
            "line 2: column 'y' is 'left': a number is required; a right line: 30.5,10,15",
        ),
        ("x,y,depth\n3.5,,4\n", "line 2: column 'y' is empty: a number is required; "),
        ("x,y,z,depth\n3.5,1,,4\n", "line 2: column 'z' is empty: a number is required; "),
        ("x,y,depth,tap depth\n1,2,20,15\n", "line 2: column 'tap depth' is '15': 'tap' is empty; "),
        (
            "x,y,depth,tap,tap depth\n1,2,20,M9.5,15\n",
            "line 2: M9.5 has no coarse pitch in ISO 261: give one, such as M9.5x1; ",
        ),
        (
            "x,y,depth,tap,tap depth\n1,2,20,Rc1/4,15\n",
            "line 2: column 'tap' is 'rc1/4': a number is required, or a thread such as M8, M8x1, 1/4-20 or G1/4; a right \
             line: 30.5,10,15,M8,12",
        ),
        (
            "x,y,tap\n1,2,M8\n",
            "line 2: column 'tap depth' is missing: tap M8 needs a depth of its own; right columns: x,y,tap,tap depth, \
             and a right line: 30.5,10,M8,12",
        ),
        (
            "x;y;tap;tap depth\n1;2;M8;\n",
            "line 2: column 'tap depth' is empty: tap M8 needs a depth of its own; a right line: 30,5;10;M8;12",
        ),
        (
            "x,y,countersink\n1,2,10\n",
            "line 2: column 'depth' is missing: a hole of countersinks alone needs it; right columns: \
             x,y,countersink,countersink angle,depth, and a right line: 30.5,10,12,90,15",
        ),
        ("x,y,depth,tap,thread\n1,2,20,M10,M10\n", "line 1: column 'tap' is there twice; "),
        (
            "id,x,y,drill,tap,tap depth\n1,2,3,6.8,M8,12\n",
            "line 2: column 'drill depth' is missing: drill 6.8 needs a depth of its own; right columns: \
             id,x,y,drill,drill depth,tap,tap depth, and a right line: 1,30.5,10,6.8,15,M8,12",
        ),
        (
            "x,y,dia,thru\n1,2,6.8,yes\n",
            "line 2: column 'depth' is '': a through hole needs the thickness of the part; right columns: \
             x,y,diameter,through,depth, and a right line: 30.5,10,6,false,15",
        ),
        (
            "x,y,depth\n3.5,−1,4\n",
            "line 2: column 'y' is '−1': a minus is the sign - of the keyboard; a right line: 30.5,10,15",
        ),
        (
            "x,y,depth\n1/4,1,4\n",
            "line 2: column 'x' is '1/4': a number is required; a right line: 30.5,10,15",
        ),
        ("x,y,drill,depth\n1,1,X,4\n", "line 2: column 'drill' is 'x': a number is required; "),
        (
            "x,y,depth,ream,ream depth\n1,2,20,11,\n",
            "line 2: column 'ream depth' is empty: ream 11 needs a depth of its own; ",
        ),
        (
            "id,x,y,dia,depth,tap,tap depth\n1,2,3,6.8,18,M8,14\n",
            "line 2: hole 1 (id '1'): the diameter is 6.8, which no feature has: if it is drilled, it is a feature too, drill, \
             and its column in a list is 'drill'; right columns: id,x,y,drill,depth,tap,tap depth, and a right line: \
             1,30.5,10,6.8,15,M8,12",
        ),
        (
            "x,y,drill,depth\n1,2,6.8,THRU\n",
            "line 2: column 'depth' is 'THRU': the thickness of the part is required, and true in a column 'through'",
        ),
        (
            "hole,x,y,z,dia\n1,15,15,-18,6.8\n2,20,15,-20,8.5\n",
            "column 'z' is below 0 in all holes, -18 in the first, and no depth is given: z is where a hole begins, 0 on most \
             plates, and its depth is a number above 0 in a column 'depth'; right columns: id,x,y,depth,diameter, and a right \
             line: 1,30.5,10,15,6",
        ),
        ("x,y,tap,tap depth\n1,2,10,15\n", "line 2: hole 1: its tap has no pitch: give it in mm; "),
        ("x,y,depth\n", "no hole after the header: one line for each; a right line: 30.5,10,15"),
    ] {
        let found = refused(text);
        assert!(found.starts_with(expected), "{text}\n  says {found:?}\n  not  {expected:?}");
    }
}

/// A drill without a depth of its own goes to the depth of its hole, 18 here, and a tap has its own.
#[test]
fn a_drill_is_as_deep_as_its_hole() {
    let plain =
        read("id,x,y,depth,drill,drill depth,tap,tap depth\n1,15,10,18,6.8,18,M8,14\n2,5,10,20,8.5,20,,\n");
    for text in [
        "Hole,X,Y,Drill,Depth,Tap,Tap depth\n1,15,10,6.8,18,M8,14\n2,5,10,8.5,20,,\n",
        "Nr;X;Y;Bohrer;Bohrer depth;Tiefe;Tap;Tap depth\n1;15;10;6,8;;18;M8;14\n2;5;10;8,5;20;20;;\n",
    ] {
        let list = read(text);
        assert_eq!(list.holes, plain.holes, "{text}");
        assert!(
            list.note.unwrap().contains("a drill without a depth of its own is as deep as its hole"),
            "{text}"
        );
    }
    assert!(!plain.note.unwrap().contains("as deep as its hole"));
}

/// z is the level of the entries where a depth is given, where one hole begins at 0, or where the axis is given.
#[test]
fn holes_below_zero_with_a_depth_are_read() {
    for text in [
        "x,y,z,depth\n15,15,-18,5\n20,15,-18,\n",
        "x,y,z\n15,15,-18\n20,15,0\n",
        "x,y,z,i,j,k\n15,15,-18,0,0,1\n",
        "x,y,z,drill,drill depth\n15,15,-18,6.8,5\n",
    ] {
        assert!(read(text).holes.holes[0].entry[2] < 0.0, "{text}");
    }
}

/// What the right line shows is right.
#[test]
fn the_right_line_is_read() {
    for header in [
        "x,y,depth,remark",
        "id;x;y;z;i;j;k;depth;diameter;through",
        "id\tx\ty\tfeatures",
        "x,y,depth,tap,tap depth,counterbore,counterbore depth",
        "nr;x;y;diameter;tap;tap depth;tap pitch",
        "nr;x;y;dia;cbore;countersink",
        "nr,x,y,csk",
        "nr,x,y,drill",
        "nr,x,y,drill,depth,ream,bore depth,bore",
        "nr,x,angle,radius,depth,dia",
    ] {
        let separator = separator(header);
        let names: Vec<String> = header.split(separator).map(column_name).collect();
        let columns = Columns::new(names, separator, Unit::Mm).unwrap().names;
        let line = example(&columns, separator);
        let text = match line
            .strip_prefix("right columns: ")
            .and_then(|rest| rest.split_once(", and a right line: "))
        {
            Some((header, line)) => format!("{header}\n{line}\n"),
            None => format!("{header}\n{}\n", line.strip_prefix("a right line: ").unwrap()),
        };
        assert_eq!(read(&text).holes.holes[0].entry[0], 30.5, "{text}");
    }
}

#[test]
fn a_job_file_is_no_list() {
    for text in ["family = \"pin-holes\"\n", "# x, y\nfamily = \"burr\"\n", "family = [1, 2]\n", "one\n"] {
        assert!(!is_csv(text), "{text}");
    }
}
