//! What an operator may have left in force when a main program is started, or a resident macro called by hand: the programs that
//! drill and grind refuse it before anything moves, and make the same moves where it was cancelled.
use gcode_gen::check::Programs;
use gcode_gen::families;
use gcode_gen::package::Package;
use gcode_inspect::machine::Machine;
use gcode_lang::motion::{Event, EventKind, EventSink};
use gcode_part::job::Job;
use gcode_session::{Request, Run, run};
use gcode_tests::alignment::{alarm, value};

/// A family with its main program, and its macros with their alarms; the main program has the first one's, and the next for shifts.
type Family = (&'static str, u32, &'static [(u32, u16)]);

const FAMILIES: [Family; 3] = [
    ("pin-holes", 8100, &[(8101, 3017), (8102, 3030)]),
    ("honeycomb", 8300, &[(8301, 3051)]),
    ("burr", 8400, &[(8401, 3097)]),
];

/// What changes coordinates, with what cancels it. Of a Haas the first alone is simulated.
const CHANGED: [(&str, &str); 4] =
    [("G68 X0 Y0 R10.", "G69"), ("G51 X0 Y0 P2000", "G50"), ("G16", "G15"), ("G51.1 X0", "G50.1 X0")];

/// A family's own job on a control, with fewer holes and flutes. A Haas has no LN, so that a burr has no macro there.
fn on(family: &str, dialect: &str) -> Package {
    let mut text = families::ALL.iter().find(|one| one.name == family).unwrap().new_job.to_owned();
    let mut changed = |from: &str, to: &str| {
        assert!(text.contains(from), "{from} isn't in the job");
        text = text.replacen(from, to, 1);
    };
    changed("fanuc-31i", dialect);
    match family {
        "honeycomb" => changed("pitch = 10.0", "pitch = 90.0"),
        "burr" => changed("flutes = 16", "flutes = 3"),
        _ => {}
    }
    if (family, dialect) == ("burr", "haas-ngc") {
        changed("form = \"loop\"", "form = \"moves\"");
    }
    families::emit(&Job::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// What a machine is told, without the places of the blocks.
#[derive(Default)]
struct Told(Vec<EventKind>);

impl EventSink for Told {
    fn event(&mut self, event: &Event) {
        self.0.push(event.kind.clone());
    }
}

/// These blocks, as in MDI, and then a main program or the call of a macro.
fn behind(package: &Package, blocks: &str, then: &str) -> (Run, Vec<EventKind>) {
    let text = format!("%\nO0001\n{blocks}\n{then}\nM30\n%\n");
    let request = Request::new("O0001.nc", text.into_bytes(), Machine::parse(&package.machine).unwrap());
    let mut told = Told::default();
    let run = run(&request, &mut Programs(package), &mut told).unwrap();
    (run, told.0)
}

/// The first call of a macro, as the main program has it.
fn call(package: &Package, main: u32, number: u32) -> String {
    let text = &package.program(main).unwrap().text;
    let at = text.find(&format!("G65 P{number} ")).unwrap();
    text[at..].lines().next().unwrap().to_owned()
}

/// A Haas shows 1000 + n where a Fanuc shows 3000 + n.
fn shown(number: u16, dialect: &str) -> u16 {
    if dialect == "haas-ngc" { number - 2000 } else { number }
}

#[test]
fn coordinates_that_are_changed_are_an_alarm_before_a_main_program_does_anything() {
    for (family, main, macros) in FAMILIES {
        let number = macros[0].1;
        for (dialect, seen) in [("fanuc-31i", 4), ("fanuc-0i-f", 4), ("haas-ngc", 1)] {
            let package = on(family, dialect);
            let start = format!("M98 P{main}");
            let (_, plain) = behind(&package, "", &start);
            assert!(plain.len() > 20, "O{main} does nothing");
            for (on, off) in &CHANGED[..seen] {
                let (refused, told) = behind(&package, on, &start);
                assert_eq!(alarm(&refused), Some(shown(number, dialect)), "O{main} behind {on}, {dialect}");
                assert_eq!(told, [], "O{main} behind {on}, {dialect}");
                let (cancelled, told) = behind(&package, &format!("{on}\n{off}"), &start);
                assert_eq!(alarm(&cancelled), None, "O{main} behind {on} and {off}, {dialect}");
                assert!(told == plain, "O{main} behind {on} and {off} makes other moves, {dialect}");
            }
        }
    }
}

/// A tilted plane is of the group of G68, as 68.2.
#[test]
fn a_tilted_plane_is_one_of_them() {
    for (family, main, _) in &FAMILIES[..2] {
        let (refused, told) =
            behind(&on(family, "fanuc-31i"), "G68.2 X0 Y0 Z0 I0 J90. K0", &format!("M98 P{main}"));
        assert!(alarm(&refused).is_some() && told.is_empty(), "O{main}");
    }
}

#[test]
fn a_macro_called_by_hand_refuses_them_too() {
    for (family, main, macros) in FAMILIES {
        for (dialect, seen) in [("fanuc-31i", 4), ("haas-ngc", 1)] {
            if (family, dialect) == ("burr", "haas-ngc") {
                continue;
            }
            let package = on(family, dialect);
            for (number, refusal) in macros {
                let call = call(&package, main, *number);
                for (on, off) in &CHANGED[..seen] {
                    let (refused, told) = behind(&package, on, &call);
                    assert_eq!(alarm(&refused), Some(shown(*refusal, dialect)), "O{number} behind {on}");
                    assert_eq!(told, [], "O{number} behind {on}");
                    let (cancelled, told) = behind(&package, &format!("{on}\n{off}"), &call);
                    assert_eq!(alarm(&cancelled), None, "O{number} behind {on} and {off}");
                    assert!(!told.is_empty(), "O{number} does nothing");
                }
            }
        }
    }
}

/// A grinder has no Z. G43 leaves the tip elsewhere, and that is no shift.
#[test]
fn a_shift_of_the_work_zero_is_an_alarm_before_a_main_program_does_anything() {
    for (family, main, macros) in FAMILIES {
        let number = macros[0].1;
        for dialect in ["fanuc-31i", "fanuc-0i-f", "haas-ngc"] {
            let package = on(family, dialect);
            let start = format!("M98 P{main}");
            let (_, plain) = behind(&package, "", &start);
            let in_z = ["G52 Z.5", "G92 X0 Y0 Z-0.001"];
            let shifts = ["G52 X0.001", "G52 Y-5.", "G52 X-300. Y300.", "G92 X1."];
            for shift in shifts.into_iter().chain(in_z.into_iter().filter(|_| family != "burr")) {
                let (refused, told) = behind(&package, shift, &start);
                assert_eq!(
                    alarm(&refused),
                    Some(shown(number + 1, dialect)),
                    "O{main} behind {shift}, {dialect}"
                );
                assert_eq!(told, [], "O{main} behind {shift}, {dialect}");
            }
            // Cancelled, of a rotary that the program's own G52 cancels, or in a work offset that isn't the program's.
            let rotary = if family == "honeycomb" { "G52 B5.\nG52 B0" } else { "G52 B5." };
            for none in ["G52 X1.\nG52 X0", rotary, "G10 L2 P2 X7.\nG55"] {
                let (run, told) = behind(&package, none, &start);
                assert_eq!(alarm(&run), None, "O{main} behind {none}, {dialect}");
                assert!(told == plain, "O{main} behind {none} makes other moves, {dialect}");
            }
        }
        let package = on(family, "fanuc-31i");
        if family != "burr" {
            let (run, _) = behind(&package, "G10 L10 P1 R50.\nG43 H1 Z100.", &format!("M98 P{main}"));
            assert_eq!(alarm(&run), None, "O{main} behind G43");
        }
    }
}

/// Whoever wants the holes 5 aside in X writes it to G54 or the external offset: by hand, the machine ends 5 farther.
#[test]
fn an_offset_that_is_set_is_no_shift() {
    for (family, main, _) in FAMILIES {
        let package = on(family, "fanuc-31i");
        let start = format!("M98 P{main}");
        let plain = value(&behind(&package, "", &start).0, 5021);
        for (set, by) in [("G10 L2 P1 X5.", 5.0), ("G10 L2 P0 X-1.5", -1.5), ("#5201=2.\n#5221=3.", 5.0)] {
            let (run, _) = behind(&package, set, &start);
            assert_eq!(alarm(&run), None, "O{main} behind {set}");
            let moved = value(&run, 5021) - plain;
            assert!((moved - by).abs() < 1e-9, "O{main} behind {set} ends {moved} farther");
        }
    }
}

/// A macro works where its caller wants it: with G52 X5. it ends 5 farther.
#[test]
fn a_macro_called_by_hand_follows_a_shift() {
    for (family, main, macros) in FAMILIES {
        let package = on(family, "fanuc-31i");
        let call = call(&package, main, macros[0].0);
        let [plain, shifted] = ["", "G52 X5."].map(|blocks| behind(&package, blocks, &call).0);
        assert_eq!((alarm(&plain), alarm(&shifted)), (None, None), "{family}");
        let moved = value(&shifted, 5021) - value(&plain, 5021);
        assert!((moved - 5.0).abs() < 1e-9, "{family} ends {moved} farther");
    }
}
