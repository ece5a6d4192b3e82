//! Tests of the run under a debugger: steps, stops and changes in both directions.
use std::collections::BTreeMap;

use proptest::prelude::*;

use super::*;
use crate::run::ReversibleRun;
use gcode_control::Value;
use gcode_lang::control::Settings;
use gcode_lang::program::{Expression, Library, Memory};
use gcode_lang::source::Bytes;

/// Library of texts by their numbers.
struct Texts(BTreeMap<u32, String>);

impl Library for Texts {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        let text = self.0.get(&number)?;
        Some((format!("O{number}.nc"), text.clone().into_bytes().into()))
    }
}

fn control(text: &str) -> Control {
    let mut memory = Memory::default();
    memory.load("O1.nc", text.as_bytes().to_vec());
    Control::new(memory, Settings::default())
}

fn run(text: &str, library: &[(u32, &str)]) -> ReversibleRun {
    let texts = library.iter().map(|(number, text)| (*number, (*text).to_owned())).collect();
    ReversibleRun::new(control(text), Box::new(Texts(texts)))
}

fn debuggee(text: &str) -> Debuggee {
    let mut debuggee = Debuggee::new(run(text, &[]), Rc::new(str::to_owned));
    debuggee.stand_here();
    debuggee
}

/// Sink that counts blocks.
#[derive(Default)]
struct CountedBlocks(u64);

impl EventSink for CountedBlocks {
    fn event(&mut self, _: &Event<'_>) {}
}

impl crate::run::PositionedSink for CountedBlocks {
    fn begin_block(&mut self, _: u64) {
        self.0 += 1;
    }
}

/// The loop has three blocks a turn, the WHILE, the sum and the END, and 1,000 turns.
#[test]
fn a_second_run_ends_where_it_is_interrupted() {
    const TEXT: &str = "O1\n#1=0\nWHILE[#1LT1000]DO1\n#1=#1+1\nEND1\nM30\n";
    let blocks = |is_interrupted: &dyn Fn(u64) -> bool| {
        let (mut sink, asked) = (CountedBlocks::default(), std::cell::Cell::new(0));
        let ask = || {
            asked.set(asked.get() + 1);
            is_interrupted(asked.get())
        };
        let is_whole = run(TEXT, &[]).run_again(control(TEXT), 1_000_000, &mut sink, &ask);
        (is_whole, sink.0)
    };
    assert_eq!(blocks(&|_| true), (false, 0));
    assert_eq!(blocks(&|asked| asked == 3), (false, 2048), "it asks once in 1,024 blocks");
    let (is_whole, all) = blocks(&|_| false);
    assert!(is_whole && (3000..3010).contains(&all), "{all}");
}

/// Everything of a run that a person can see.
fn shown(control: &Control) -> String {
    let variables: Vec<_> = control.variables().collect();
    let locals: Vec<_> = (0..=control.vars().level()).map(|level| control.vars().locals_of(level)).collect();
    let (stack, output) = (control.call_stack(), control.output());
    let (blocks, moves, stops) = (control.blocks(), control.moves(), control.stops().len());
    let positions = (control.machine_position(), control.work_position(0), control.seconds());
    format!("{variables:?} {locals:?} {stack:?} {output:?} {blocks} {moves} {stops} {positions:?}")
}

/// The next block of a run.
fn next(debuggee: &Debuggee) -> String {
    let sources = debuggee.control().memory().sources();
    debuggee.next_span().map_or_else(String::new, |block| sources.text(block))
}

/// Runs to the next stop.
fn advance(debuggee: &mut Debuggee, mut goal: Goal) -> Stop {
    let mut output = Vec::new();
    debuggee.set_off(goal);
    loop {
        if let Some(stop) = debuggee.advance(&mut goal, 7, &mut output) {
            return stop;
        }
    }
}

fn reverse(debuggee: &mut Debuggee) -> Stop {
    let end = debuggee.position();
    advance(debuggee, Goal::ReverseContinue { end })
}

fn at_block(text: &str, block: &str, conditions: Conditions) -> Breakpoint<BlockPlace> {
    let start = text.find(block).unwrap() as u32;
    Breakpoint::new(1, BlockPlace { path: "O1.nc".to_owned(), start }, conditions)
}

fn on_variable(number: u32, level: Option<usize>) -> Breakpoint<VariablePlace> {
    let place = VariablePlace { number, level, on_write: true, on_read: false };
    Breakpoint::new(2, place, Conditions::default())
}

fn number(debuggee: &Debuggee, number: u32) -> Option<f64> {
    debuggee.control().variable(number).unwrap().as_number()
}

const CALLS: &str = "O1\n(A REMARK)\n#1=1\n#100=0\nG65 P2 A5.\n#2=#100\nM30\nO2\n#100=#1\nIF[#1 LT 3]GOTO9\n#1=#1-1\nN9 M99\n";

#[test]
fn a_step_goes_into_a_call_over_it_and_out_of_it() {
    let mut debuggee = debuggee(CALLS);
    assert_eq!(next(&debuggee), "#1=1", "a remark is no place to stand");
    assert_eq!(advance(&mut debuggee, Goal::StepIn), Stop::Step);
    assert_eq!(advance(&mut debuggee, Goal::StepIn), Stop::Step);
    assert_eq!(next(&debuggee), "G65 P2 A5.");
    assert_eq!(advance(&mut debuggee, Goal::Next { depth: 0 }), Stop::Step);
    assert_eq!(next(&debuggee), "#2=#100");
    assert_eq!(number(&debuggee, 100), Some(5.0));
    // Back into the called program, through it, and out of it at its call.
    let before = ["N9 M99", "#1=#1-1", "IF[#1 LT 3]GOTO9", "#100=#1", "G65 P2 A5.", "#100=0", "#1=1"];
    for block in before {
        assert!(debuggee.step_back());
        assert_eq!(next(&debuggee), block);
    }
    assert!(!debuggee.step_back(), "the start of the run");
    assert_eq!(next(&debuggee), "#1=1");
    for _ in 0..4 {
        advance(&mut debuggee, Goal::StepIn);
    }
    assert_eq!(next(&debuggee), "IF[#1 LT 3]GOTO9");
    assert_eq!(advance(&mut debuggee, Goal::StepOut { depth: 1 }), Stop::Step);
    assert_eq!(next(&debuggee), "#2=#100");
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::End(End::Program));
}

const LOOP: &str = "O1\n#1=0\nWHILE[#1 LT 6]DO1\n#1=#1+1\n#100=#1*#1\nEND1\nM30\n";

#[test]
fn breakpoints_stop_in_both_directions() {
    let mut debuggee = debuggee(LOOP);
    let condition = Some(Expression::parse("#1 GT 3").unwrap());
    let conditions = Conditions { condition, ..Conditions::default() };
    debuggee.breakpoints_mut().replace_lines("O1.nc", vec![at_block(LOOP, "#100=", conditions)]);
    for value in [4.0, 5.0, 6.0] {
        assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::Breakpoint(vec![1]));
        assert_eq!(number(&debuggee, 1), Some(value));
    }
    for value in [5.0, 4.0] {
        assert_eq!(reverse(&mut debuggee), Stop::Breakpoint(vec![1]));
        assert_eq!(number(&debuggee, 1), Some(value));
    }
    assert_eq!(reverse(&mut debuggee), Stop::Entry);
    assert_eq!(number(&debuggee, 1), None);
}

#[test]
fn hits_are_counted_once_however_often_the_run_goes_over_them() {
    let mut debuggee = debuggee(LOOP);
    let hits = Some(HitCondition::parse("% 2").unwrap());
    let conditions = Conditions { hits, ..Conditions::default() };
    debuggee.breakpoints_mut().replace_lines("O1.nc", vec![at_block(LOOP, "#100=", conditions)]);
    for value in [2.0, 4.0] {
        assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::Breakpoint(vec![1]));
        assert_eq!(number(&debuggee, 1), Some(value));
    }
    assert_eq!(reverse(&mut debuggee), Stop::Breakpoint(vec![1]));
    assert_eq!(number(&debuggee, 1), Some(2.0));
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::Breakpoint(vec![1]));
    assert_eq!(number(&debuggee, 1), Some(4.0));
}

#[test]
fn a_written_variable_stops_behind_the_block_and_on_the_way_back_in_front_of_it() {
    let mut debuggee = debuggee(LOOP);
    debuggee.breakpoints_mut().replace_variables(vec![on_variable(100, None)]);
    for value in [1.0, 4.0] {
        assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::VariableBreakpoint(vec![2]));
        assert_eq!((number(&debuggee, 100), next(&debuggee).as_str()), (Some(value), "END1"));
    }
    assert_eq!(reverse(&mut debuggee), Stop::VariableBreakpoint(vec![2]));
    assert_eq!((number(&debuggee, 100), next(&debuggee).as_str()), (Some(1.0), "#100=#1*#1"));
    // A local is that of its level.
    let mut calls = self::debuggee(CALLS);
    calls.breakpoints_mut().replace_variables(vec![on_variable(1, Some(1))]);
    assert_eq!(advance(&mut calls, Goal::Continue), Stop::VariableBreakpoint(vec![2]));
    assert_eq!((number(&calls, 1), calls.control().vars().level()), (Some(4.0), 1));
}

#[test]
fn a_program_stops_the_run_when_it_begins() {
    let mut debuggee = debuggee(CALLS);
    let place = |name: Option<&str>, number| ProgramPlace {
        name: name.and_then(gcode_lang::syntax::ast::ProgramPath::parse).map(|path| path.name),
        number,
    };
    let programs = vec![
        Breakpoint::new(3, place(Some("O2"), None), Conditions::default()),
        Breakpoint::new(4, place(Some("O2"), Some(9)), Conditions::default()),
    ];
    debuggee.breakpoints_mut().replace_programs(programs);
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::ProgramBreakpoint(vec![3]));
    assert_eq!(next(&debuggee), "#100=#1");
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::ProgramBreakpoint(vec![4]));
    assert_eq!(next(&debuggee), "N9 M99");
    assert_eq!(reverse(&mut debuggee), Stop::ProgramBreakpoint(vec![3]));
    assert_eq!(next(&debuggee), "#100=#1");
    let line = at_block(CALLS, "#100=#1", Conditions::default());
    debuggee.breakpoints_mut().replace_lines("O1.nc", vec![line]);
    assert_eq!(reverse(&mut debuggee), Stop::Entry);
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::Breakpoint(vec![1, 3]), "both are told");
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::ProgramBreakpoint(vec![4]));
    assert_eq!(reverse(&mut debuggee), Stop::Breakpoint(vec![1, 3]));
}

#[test]
fn an_alarm_stands_in_front_of_its_block_and_a_change_lets_it_try_again() {
    let text = "O1\n#1=0\n#2=6/#1\nM30\n";
    let alarm = |debuggee: &mut Debuggee| advance(debuggee, Goal::Continue);
    let mut first = debuggee(text);
    assert_eq!(alarm(&mut first), Stop::End(End::Stopped), "no filter");
    let mut second = debuggee(text);
    second.set_filters(Filters::of(["PS"]));
    assert!(matches!(alarm(&mut second), Stop::Exception(exception) if exception.code == "PS0112"));
    assert_eq!(next(&second), "#2=6/#1");
    assert_eq!(alarm(&mut second), Stop::End(End::Stopped), "nothing has changed");
    let mut third = debuggee(text);
    third.set_filters(Filters::of(["alarm"]));
    alarm(&mut third);
    third.change(Change::Assign { level: 0, number: 1, value: Value::Number(3.0) }).unwrap();
    assert_eq!(advance(&mut third, Goal::StepIn), Stop::Step);
    assert_eq!(number(&third, 2), Some(2.0));
    assert_eq!(alarm(&mut third), Stop::End(End::Program));
}

#[test]
fn a_vacant_read_stops_in_front_of_its_block() {
    let mut debuggee = debuggee("O1\nIF[#5 EQ #0]GOTO 7\nN7 #1=#5+#6\n#2=#1\nM30\n");
    debuggee.set_filters(Filters::of(["vacant"]));
    let Stop::Exception(exception) = advance(&mut debuggee, Goal::Continue) else { panic!("no exception") };
    assert_eq!(next(&debuggee), "N7 #1=#5+#6", "a test for vacancy is no read");
    assert!(exception.message.starts_with("#5, #6 are vacant"), "{}", exception.message);
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::End(End::Program), "once, and #1 is 0");
}

#[test]
fn operator_stops_pause_and_messages_are_output() {
    let mut debuggee = debuggee("O1\n#3006=1(SET HEAD)\nM00\n#1=5.\nDPRNT[X#1[32]]\nM30\n");
    let mut output = Vec::new();
    let stop = debuggee.advance(&mut Goal::Continue, 9, &mut output);
    assert_eq!(stop, Some(Stop::Pause("#3006: SET HEAD".to_owned())));
    assert_eq!(output.pop().map(|line| line.text), Some("#3006: SET HEAD".to_owned()));
    let stop = debuggee.advance(&mut Goal::Continue, 9, &mut output);
    assert_eq!((stop, next(&debuggee)), (Some(Stop::Pause("M00".to_owned())), "#1=5.".to_owned()));
    let stop = debuggee.advance(&mut Goal::Continue, 9, &mut output);
    assert_eq!(stop, Some(Stop::End(End::Program)));
    // Three digits before the point and two behind it, with spaces for leading zeros.
    assert_eq!(output.len(), 1);
    assert_eq!(output[0].text.replace(' ', ""), "X5.00");
}

#[test]
fn what_is_on_the_block_behind_a_stop_counts() {
    let text = "O1\nM00\n#1=#5\n#2=2\nM30\n";
    let with = |breakpoint: Conditions, filters: &[&str]| {
        let mut debuggee = debuggee(text);
        debuggee.breakpoints_mut().replace_lines("O1.nc", vec![at_block(text, "#1=#5", breakpoint)]);
        debuggee.set_filters(Filters::of(filters.iter().copied()));
        assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::Pause("M00".to_owned()));
        debuggee
    };
    let mut on_line = with(Conditions::default(), &[]);
    assert_eq!(advance(&mut on_line, Goal::Continue), Stop::Breakpoint(vec![1]));
    assert_eq!(advance(&mut on_line, Goal::Continue), Stop::End(End::Program));
    let mut stepped = with(Conditions::default(), &[]);
    assert_eq!(advance(&mut stepped, Goal::StepIn), Stop::Step);
    assert_eq!(next(&stepped), "#2=2");
    let mut vacant = with(Conditions::default(), &["vacant"]);
    assert!(matches!(advance(&mut vacant, Goal::Continue), Stop::Exception(_)));
    let log = Some(LogMessage::parse("here").unwrap());
    let mut logged = with(Conditions { log, ..Conditions::default() }, &[]);
    let mut output = Vec::new();
    logged.set_off(Goal::StepIn);
    assert_eq!(logged.advance(&mut Goal::StepIn, 9, &mut output), Some(Stop::Step));
    assert_eq!(output.len(), 1);
}

#[test]
fn a_change_belongs_to_the_run_until_another_one_is_made_before_it() {
    let text = "O1\n#1=1\n#2=#1\n#3=#2\n#4=#3\nM30\n";
    let mut run = run(text, &[]);
    let steps = |run: &mut ReversibleRun, count| {
        for _ in 0..count {
            assert!(run.step(&mut ()).is_none());
        }
    };
    let assign = |number, value| Change::Assign { level: 0, number, value: Value::Number(value) };
    let value = |run: &ReversibleRun, number| run.control().variable(number).unwrap().as_number();
    steps(&mut run, 2);
    run.change(assign(2, 7.0)).unwrap();
    steps(&mut run, 2);
    assert_eq!(value(&run, 4), Some(7.0));
    run.go_back_to(2);
    assert_eq!(value(&run, 2), Some(7.0), "here the change is made");
    run.go_back_to(1);
    assert_eq!(value(&run, 2), None);
    steps(&mut run, 3);
    assert_eq!(value(&run, 4), Some(7.0), "forward again");
    run.go_back_to(1);
    run.change(assign(1, 3.0)).unwrap();
    steps(&mut run, 3);
    assert_eq!(value(&run, 4), Some(3.0), "the later change is gone");
}

#[test]
fn a_goto_stays_in_its_program_and_is_part_of_the_run() {
    let mut debuggee = debuggee(CALLS);
    let block = |text: &str| {
        let start = CALLS.find(text).unwrap() as u32;
        Span { start, end: start, ..Span::default() }
    };
    assert_eq!(debuggee.change(Change::Jump { to: block("#100=#1") }), Err(ChangeRefusal::OtherProgram));
    debuggee.change(Change::Jump { to: block("#2=#100") }).unwrap();
    assert_eq!(advance(&mut debuggee, Goal::StepIn), Stop::Step);
    assert_eq!((next(&debuggee).as_str(), number(&debuggee, 2)), ("M30", None), "#100 is vacant");
    assert!(debuggee.step_back());
    assert_eq!(next(&debuggee), "#2=#100");
    // Nothing was executed before the choice: it is undone, with what was changed behind it alone.
    let first = "#1=1";
    assert!(debuggee.step_back());
    assert_eq!(next(&debuggee), first);
    assert!(!debuggee.step_back());
    debuggee.change(Change::Assign { level: 0, number: 101, value: Value::Number(5.0) }).unwrap();
    debuggee.change(Change::Jump { to: block("#2=#100") }).unwrap();
    debuggee.change(Change::Assign { level: 0, number: 102, value: Value::Number(6.0) }).unwrap();
    assert!(debuggee.step_back());
    assert_eq!((next(&debuggee).as_str(), number(&debuggee, 101)), (first, Some(5.0)));
    assert_eq!(number(&debuggee, 102), None);
}

#[test]
fn a_breakpoint_in_a_program_that_is_loaded_later_stops_the_run() {
    let called = "O9\n#100=8\nM99\n";
    let mut debuggee = Debuggee::new(run("O1\n#1=1\nM98 P9\nM30\n", &[(9, called)]), Rc::new(str::to_owned));
    let place = BlockPlace { path: "O9.nc".to_owned(), start: called.find("#100").unwrap() as u32 };
    let breakpoint = Breakpoint::new(5, place, Conditions::default());
    debuggee.breakpoints_mut().replace_lines("O9.nc", vec![breakpoint]);
    assert_eq!(advance(&mut debuggee, Goal::Continue), Stop::Breakpoint(vec![5]));
    assert_eq!(next(&debuggee), "#100=8");
}

/// Blocks of a program of loops, calls, jumps, moves, stops and prints.
fn program() -> impl Strategy<Value = String> {
    let block = prop_oneof![
        (1_u32..6, 0_i32..9).prop_map(|(to, value)| format!("#{to}={value}")),
        (1_u32..6, 1_u32..6).prop_map(|(to, from)| format!("#{to}=#{from}+1")),
        (100_u32..104, 1_u32..6).prop_map(|(to, from)| format!("#{to}=#{to}+#{from}")),
        (1_u32..6).prop_map(|number| format!("G91 G0 X#{number} Y1.")),
        (1_u32..6).prop_map(|number| format!("G65 P2 A#{number} B2.")),
        Just("M98 P3".to_owned()),
        Just("M98 P3 L3".to_owned()),
        (1_u32..6).prop_map(|number| format!("IF[#{number} GT 4]THEN #101=#101+1")),
        (1_u32..6).prop_map(|number| format!("DPRNT[V#{number}[30]]")),
        Just("#5221=#5221+1".to_owned()),
        Just("M00".to_owned()),
        Just("(REMARK)".to_owned()),
        Just("G66 P3".to_owned()),
        Just("G90 G54 G81 X1. Z-2. R1. F100".to_owned()),
        Just("G80".to_owned()),
        (1_u32..6).prop_map(|number| format!("#102=#102/#{number}")),
    ];
    let blocks = || prop::collection::vec(block.clone(), 1..9).prop_map(|blocks| blocks.join("\n"));
    (blocks(), blocks(), blocks(), 1_u32..40).prop_map(|(before, inside, after, count)| {
        let called = "O2\n#10=#1+#2\n#103=#103+#10\nM98 P3\nM99\nO3\n#100=#100+1\nG91 G1 Z-1. F50\nM99\n";
        format!(
            "O1\n{before}\n#20=0\nWHILE[#20 LT {count}]DO1\n#20=#20+1\n{inside}\nEND1\n{after}\nM30\n{called}"
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// The state after n blocks forwards and k backwards is that of a fresh run of n − k blocks.
    #[test]
    fn going_back_is_as_never_having_gone_there(text in program(), ways in prop::collection::vec(0.0_f64..1.0, 1..6)) {
        // The states of a run that never goes back.
        let mut fresh = run(&text, &[]);
        let mut states = vec![shown(fresh.control())];
        while states.len() < 20_000 && fresh.step(&mut ()).is_none() {
            states.push(shown(fresh.control()));
        }
        let last = states.len() - 1;
        let mut run = ReversibleRun::with_gap(control(&text), Box::new(Texts(BTreeMap::new())), 13);
        let mut position = 0;
        for way in ways {
            let target = (way * last as f64).round() as usize;
            if target < position {
                run.go_back_to(target as u64);
            } else {
                (position..target).for_each(|_| assert!(run.step(&mut ()).is_none()));
            }
            position = target;
            prop_assert_eq!(shown(run.control()), states[position].clone(), "position {}", position);
        }
    }
}

#[test]
fn the_message_of_a_stop_has_the_values_that_it_names() {
    let mut debuggee = debuggee("O1\n#140=-90.\n#3006=1(HEAD #140 AND #141, #140 #X)\nM30\n");
    let stop = advance(&mut debuggee, Goal::Continue);
    let text = "#3006: HEAD #140 AND #141, #140 #X (#140 = -90, #141 = vacant)";
    assert_eq!(stop, Stop::Pause(text.to_owned()));
}
