//! A symbolic run whose variables are all known is the run of the control.
use super::*;
use crate::outcome::Limits;
use gcode_lang::control::Settings;
use gcode_lang::program::NoLibrary;

/// Terms whose nodes are answered by nothing: every question is asked.
#[derive(Debug, Default)]
struct Recorded(Vec<(TermOperation, [Term; 2])>);

impl Terms for Recorded {
    fn node(&mut self, operation: TermOperation, operands: [Term; 2]) -> Term {
        self.0.push((operation, operands));
        Term::Node(self.0.len() as u32)
    }

    fn bounds(&mut self, _: Term) -> (f64, f64) {
        (0.0, 100.0)
    }

    fn answer(&mut self, _: &Test) -> Option<bool> {
        None
    }
}

fn control(text: &str) -> Control {
    let mut memory = Memory::default();
    memory.load("O1.nc", format!("O1\n{text}").into_bytes());
    let mut settings = Settings::default();
    // B, the fifth axis, rolls over.
    settings.rolls_over[4] = true;
    Control::new(memory, settings)
}

/// Executes blocks with these answers until the run ends, forks or isn't followed.
fn advance(run: &mut SymbolicRun, terms: &mut Recorded, answers: &[bool]) -> Advance {
    let mut answers = answers;
    loop {
        match run.advance(terms, answers, &mut NoLibrary) {
            Advance::Next(used) => answers = &answers[used..],
            other => return other,
        }
    }
}

#[test]
fn a_run_without_terms_is_the_run_of_the_control() {
    let programs = [
        "#1=2\nWHILE[#1 LT 50]DO1\n#1=#1*#1+0.5\nIF[#1 GT 9]GOTO 5\nEND1\nN5 #100=ROUND[#1]\nM30\n",
        "G65 P2 A1.5 B-#0 C[1+2]\n#101=#100\nM30\nO2\n#100=#1+#3\nIF[#2 EQ #0]THEN #100=#100*2\nM99\n",
        "#2=-4\n#100=SQRT[#2]\nM30\n",
        "#100=1/#1\nM30\n",
        "G90 G00 X1.2345 Y[1/3] B370.\nG91 G01 X-0.5 F100.\n#100=#5001\n#101=#5002\nM30\n",
        "G90 G00 Z50.\nG99 G81 X[1+1] Y0. Z-12. R2. F60.\nG80\n#100=#5003\nM30\n",
        "GOTO[2*5]\nN10 #100=ATAN[-1]/[-1]\n#[100+1]=#4003\nM98 P2 L3\nM30\nO2\n#102=#102+1\nM99\n",
        "#3000=7(STOP)\nM30\n",
        "G01 X1.\nM30\n",
        "GOTO 7\nM30\n",
        "#1=1 #2=#1+1 #100=#2*3\nIF[[#1 EQ 1]AND[#2 EQ 3]]GOTO 9\n#101=5\nN9 M30\n",
        "N1 #1=#1+1\nIF[#1 LT 5]GOTO 1\nG04 X1.\n#100=#3001\nM30\n",
    ];
    for text in programs {
        let mut real = control(text);
        let outcome = real.run(Limits::default(), &mut NoLibrary, &mut ());
        let mut run = SymbolicRun::new(control(text));
        let Advance::End(followed, _) = advance(&mut run, &mut Recorded::default(), &[]) else {
            panic!("{text}: the run doesn't end")
        };
        let end = |outcome: &Outcome| match outcome {
            Outcome::Alarm(stop) => format!("{:?} {:?}", stop.alarm, stop.span),
            outcome => format!("{outcome:?}"),
        };
        assert_eq!(end(&followed), end(&outcome), "{text}");
        assert_eq!(run.control().blocks(), real.blocks(), "{text}");
        run.leave_calls();
        let values =
            |control: &Control| control.variables().map(|(n, v)| (n, v.to_bits())).collect::<Vec<_>>();
        assert_eq!(values(run.control()), values(&real), "{text}");
        assert_eq!(run.control().work_position(0), real.work_position(0), "{text}");
    }
}

#[test]
fn each_answer_is_a_way_of_its_own_and_a_question_changes_nothing() {
    let mut run = SymbolicRun::new(control("IF[#1 LT 5]GOTO 9\n#100=SQRT[#1-5]\nN9 M30\n"));
    run.set_term(1, Term::Node(0)).unwrap();
    let start = run.snapshot();
    let mut terms = Recorded::default();
    let test = Test::Compare(gcode_lang::syntax::ast::Relation::Lt, Term::Node(0), Term::Number(5.0));
    assert!(matches!(advance(&mut run, &mut terms, &[]), Advance::Fork(asked) if asked == test));
    assert_eq!(run.control().blocks(), 0, "the block has not begun");
    assert!(matches!(advance(&mut run, &mut terms, &[true]), Advance::End(Outcome::End, 0)));
    assert_eq!(run.variable(100).unwrap(), None);
    run.restore(&start);
    // The difference is finite, and the root's argument isn't negative.
    let answers = [false, true, false];
    assert!(matches!(advance(&mut run, &mut terms, &answers), Advance::End(Outcome::End, _)));
    assert!(matches!(run.variable(100), Ok(Some(Term::Node(_)))));
    run.restore(&start);
    let negative = advance(&mut run, &mut terms, &[false, true, true]);
    assert!(
        matches!(&negative, Advance::End(Outcome::Alarm(stop), _) if stop.alarm.code().to_string() == "PS0119")
    );
}

#[test]
fn what_depends_on_a_term_and_is_not_followed_is_named() {
    for (text, named) in [
        ("G90 G02 X#1 Y0. R5. F100.\nM30\n", "an arc by R that ends at its start"),
        ("G90 G00 X#1\nG28 X0\nM30\n", "G28"),
        ("G90 G00 B#1\n#100=#5005\nM30\n", "#5005"),
        ("#5221=#1\nM30\n", "#5221"),
        ("G90 G00 X#1\n#100=#3001\nM30\n", "#3001"),
        ("G90 G00 B#1\n#100=#5045\nM30\n", "#5045"),
    ] {
        let mut run = SymbolicRun::new(control(text));
        run.set_term(1, Term::Node(0)).unwrap();
        // Every question has the answer with which the run continues: no alarm.
        let end = advance(&mut run, &mut Recorded::default(), &[false; 20]);
        assert!(matches!(&end, Advance::Unfollowed(what) if what.contains(named)), "{text}: {end:?}");
    }
}

#[test]
fn a_bit_of_a_term_is_not_followed_and_raises_no_alarm() {
    let mut memory = Memory::default();
    memory.load("O1.nc", b"O1\n#2=6\n#100=#2.1\n#101=#1.1\nM30\n".to_vec());
    let settings = Settings { has_variable_bits: true, ..Settings::default() };
    let mut run = SymbolicRun::new(Control::new(memory, settings));
    run.set_term(1, Term::Node(0)).unwrap();
    let end = advance(&mut run, &mut Recorded::default(), &[]);
    assert!(matches!(&end, Advance::Unfollowed(what) if what == "a bit of #1"), "{end:?}");
    // Bit 1 of 6, binary 110.
    assert_eq!(run.variable(100).unwrap(), Some(Term::Number(1.0)));
}
