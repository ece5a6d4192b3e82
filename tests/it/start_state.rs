//! Modes and shifts in force when a main program is started or a resident macro is called by hand: the programs that drill and grind
//! refuse them before anything moves, and make the same moves if they were cancelled.
use gcode_gen::families;
use gcode_lang::motion::EventKind;
use gcode_session::Run;
use gcode_tests::bench::{Bench, alarm, value};
use gcode_tests::expect::Recorder;

/// A family with its main program and that one's alarms, for changed coordinates and for shifts, and its macros with theirs.
type Family = (&'static str, u32, [u16; 2], &'static [(u32, u16)]);

/// O8503 begins above the surface, so that a call by hand needs a move before it: `tests/suite/macro` has its refusals.
const FAMILIES: [Family; 4] = [
    ("pin-holes", 8100, [3017, 3018], &[(8101, 3017), (8102, 3030)]),
    ("honeycomb", 8300, [3051, 3052], &[(8301, 3051)]),
    ("burr", 8400, [3097, 3098], &[(8401, 3097)]),
    ("pattern", 8500, [3184, 3196], &[]),
];

/// Codes that change coordinates, with those that cancel them. The first alone is simulated of a Haas.
const CHANGED: [(&str, &str); 4] =
    [("G68 X0 Y0 R10.", "G69"), ("G51 X0 Y0 P2000", "G50"), ("G16", "G15"), ("G51.1 X0", "G50.1 X0")];

/// A family's own job on a control, with fewer holes and flutes. A Haas has no LN, so that a burr has no macro there.
fn on(family: &str, dialect: &str) -> Bench {
    let text = families::ALL.iter().find(|one| one.name == family).unwrap().new_job;
    let form = if dialect == "haas-ngc" { "form = \"moves\"" } else { "form = \"loop\"" };
    let fewer = match family {
        "honeycomb" => text.replacen("pitch = 10.0", "pitch = 90.0", 1),
        _ => text.replacen("flutes = 16", "flutes = 3", 1).replacen("form = \"loop\"", form, 1),
    };
    Bench::of(&fewer.replacen("fanuc-31i", dialect, 1))
}

/// These blocks, as in MDI, and then a main program or the call of a macro. The start and events of unknown axes are left out: they move nothing.
fn behind(bench: &Bench, blocks: &str, then: &str) -> (Run, Vec<EventKind>) {
    let mut recorder = Recorder::default();
    let run = bench.clone().with_main(1, &format!("{blocks}\n{then}")).run_to(1, &mut recorder);
    let kinds = recorder.0.into_iter().map(|(_, kind, _)| kind);
    (
        run,
        kinds
            .filter(|kind| !matches!(kind, EventKind::Start { .. } | EventKind::PositionUnknown { .. }))
            .collect(),
    )
}

/// The first call of a macro, as the main program has it.
fn call(bench: &Bench, main: u32, number: u32) -> String {
    let text = &bench.package.program(main).unwrap().text;
    let at = text.find(&format!("G65 P{number} ")).unwrap();
    text[at..].lines().next().unwrap().to_owned()
}

/// A Haas shows 1000 + n where a Fanuc shows 3000 + n.
fn shown(number: u16, dialect: &str) -> u16 {
    if dialect == "haas-ngc" { number - 2000 } else { number }
}

#[test]
fn changed_coordinates_are_an_alarm_before_a_main_program_does_anything() {
    for (family, main, [number, _], _) in FAMILIES {
        for (dialect, seen) in [("fanuc-31i", 4), ("fanuc-0i-f", 4), ("haas-ngc", 1)] {
            let bench = on(family, dialect);
            let start = format!("M98 P{main}");
            let (_, plain) = behind(&bench, "", &start);
            assert!(plain.len() > 20, "O{main} does nothing");
            for (on, off) in &CHANGED[..seen] {
                let (refused, events) = behind(&bench, on, &start);
                assert_eq!(alarm(&refused), Some(shown(number, dialect)), "O{main} behind {on}, {dialect}");
                assert_eq!(events, [], "O{main} behind {on}, {dialect}");
                let (cancelled, events) = behind(&bench, &format!("{on}\n{off}"), &start);
                assert_eq!(alarm(&cancelled), None, "O{main} behind {on} and {off}, {dialect}");
                assert!(events == plain, "O{main} behind {on} and {off} makes other moves, {dialect}");
            }
        }
    }
}

/// A tilted plane is of the group of G68, as 68.2.
#[test]
fn a_tilted_plane_changes_coordinates_too() {
    for (family, main, ..) in FAMILIES.iter().filter(|(family, ..)| *family != "burr") {
        let (refused, events) =
            behind(&on(family, "fanuc-31i"), "G68.2 X0 Y0 Z0 I0 J90. K0", &format!("M98 P{main}"));
        assert!(alarm(&refused).is_some() && events.is_empty(), "O{main}");
    }
}

#[test]
fn a_macro_called_by_hand_refuses_changed_coordinates() {
    for (family, main, _, macros) in FAMILIES {
        for (dialect, seen) in [("fanuc-31i", 4), ("haas-ngc", 1)] {
            if (family, dialect) == ("burr", "haas-ngc") {
                continue;
            }
            let bench = on(family, dialect);
            for (number, refusal) in macros {
                let call = call(&bench, main, *number);
                for (on, off) in &CHANGED[..seen] {
                    let (refused, events) = behind(&bench, on, &call);
                    assert_eq!(alarm(&refused), Some(shown(*refusal, dialect)), "O{number} behind {on}");
                    assert_eq!(events, [], "O{number} behind {on}");
                    let (cancelled, events) = behind(&bench, &format!("{on}\n{off}"), &call);
                    assert_eq!(alarm(&cancelled), None, "O{number} behind {on} and {off}");
                    assert!(!events.is_empty(), "O{number} does nothing");
                }
            }
        }
    }
}

/// A grinder has no Z. G43 leaves the tip elsewhere, and that is no shift.
#[test]
fn a_shift_of_the_work_zero_is_an_alarm_before_a_main_program_does_anything() {
    for (family, main, [_, number], _) in FAMILIES {
        for dialect in ["fanuc-31i", "fanuc-0i-f", "haas-ngc"] {
            let bench = on(family, dialect);
            let start = format!("M98 P{main}");
            let (_, plain) = behind(&bench, "", &start);
            let in_z = ["G52 Z.5", "G92 X0 Y0 Z-0.001"];
            let shifts = ["G52 X0.001", "G52 Y-5.", "G52 X-300. Y300.", "G92 X1."];
            for shift in shifts.into_iter().chain(in_z.into_iter().filter(|_| family != "burr")) {
                let (refused, events) = behind(&bench, shift, &start);
                assert_eq!(
                    alarm(&refused),
                    Some(shown(number, dialect)),
                    "O{main} behind {shift}, {dialect}"
                );
                assert_eq!(events, [], "O{main} behind {shift}, {dialect}");
            }
            // Cancelled, of a rotary that the program's own G52 cancels, or in a work offset that isn't the program's.
            let rotary = match family {
                "honeycomb" => "G52 B5.\nG52 B0",
                // The machine of a plate has no rotary.
                "pattern" => "G52 Y1.\nG52 Y0",
                _ => "G52 B5.",
            };
            for none in ["G52 X1.\nG52 X0", rotary, "G10 L2 P2 X7.\nG55"] {
                let (run, events) = behind(&bench, none, &start);
                assert_eq!(alarm(&run), None, "O{main} behind {none}, {dialect}");
                assert!(events == plain, "O{main} behind {none} makes other moves, {dialect}");
            }
        }
        let bench = on(family, "fanuc-31i");
        if family != "burr" {
            let (run, _) = behind(&bench, "G10 L10 P1 R50.\nG43 H1 Z100.", &format!("M98 P{main}"));
            assert_eq!(alarm(&run), None, "O{main} behind G43");
        }
    }
}

/// Holes that belong 5 mm further in X have it in G54 or in the external offset: by hand, the machine ends 5 farther.
#[test]
fn an_offset_that_is_set_is_no_shift() {
    for (family, main, ..) in FAMILIES {
        let bench = on(family, "fanuc-31i");
        let start = format!("M98 P{main}");
        let plain = value(&behind(&bench, "", &start).0, 5021);
        for (set, by) in [("G10 L2 P1 X5.", 5.0), ("G10 L2 P0 X-1.5", -1.5), ("#5201=2.\n#5221=3.", 5.0)] {
            let (run, _) = behind(&bench, set, &start);
            assert_eq!(alarm(&run), None, "O{main} behind {set}");
            let moved = value(&run, 5021) - plain;
            assert!((moved - by).abs() < 1e-9, "O{main} behind {set} ends {moved} farther");
        }
    }
}

/// A macro works in its caller's coordinates: with G52 X5. it ends 5 farther.
#[test]
fn a_macro_called_by_hand_follows_a_shift() {
    for (family, main, _, macros) in FAMILIES.iter().filter(|(.., macros)| !macros.is_empty()) {
        let bench = on(family, "fanuc-31i");
        let call = call(&bench, *main, macros[0].0);
        let [plain, shifted] = ["", "G52 X5."].map(|blocks| behind(&bench, blocks, &call).0);
        assert_eq!((alarm(&plain), alarm(&shifted)), (None, None), "{family}");
        let moved = value(&shifted, 5021) - value(&plain, 5021);
        assert!((moved - 5.0).abs() < 1e-9, "{family} ends {moved} farther");
    }
}
