//! Ways through a program over all ranges, with the moves of each way as expressions of the ranges.
use gcode_control::Limits;
use gcode_control::symbolic::{Advance, Snapshot, SymbolicRun, Term, Test};
use gcode_enclosure::{Arena, Condition, Domain, Enclosures, NodeId, Unary};
use gcode_lang::program::Library;
use gcode_lang::program::modes::Motion;

use crate::answer::{ProveError, Setup, read_ranges};
use crate::leaf::End;
use crate::nodes::{Nodes, is_finite, semantics};
use crate::watch::Watch;

/// Ways through a program, and the expressions in them.
#[derive(Debug)]
pub struct Trace {
    nodes: Nodes,
    /// The box of the ranges, in their order.
    pub domain: Domain,
    /// Node of each range's variable; `None` for a range of one number.
    pub inputs: Vec<Option<NodeId>>,
    /// Every way that the ranges can take, and perhaps some that they can't.
    pub ways: Vec<TracedWay>,
}

impl Trace {
    /// Returns the expressions.
    pub fn arena(&self) -> &Arena {
        self.nodes.arena()
    }

    /// Returns the node of a function, which may be one that a way computes.
    pub fn function(&mut self, function: Unary, x: NodeId) -> NodeId {
        self.nodes.arena_mut().unary(function, x)
    }
}

/// One way through a program.
#[derive(Clone, Debug)]
pub struct TracedWay {
    /// Conditions that the values of the way keep.
    pub conditions: Vec<Condition>,
    /// Moves in their order, and operator stops among them.
    pub moves: Vec<TracedMove>,
    /// Operator stops with a text.
    pub stops: Vec<TracedStop>,
    /// End of the way.
    pub end: TracedEnd,
}

/// End of a way.
#[derive(Clone, Debug, PartialEq)]
pub enum TracedEnd {
    /// The program ends.
    Program,
    /// An alarm, by its code.
    Alarm(String),
    /// Something isn't followed.
    Unfollowed(String),
}

/// Kind of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// G00.
    Rapid,
    /// G01.
    Feed,
    /// Any other.
    Other,
}

/// Move of a way.
#[derive(Clone, Debug)]
pub struct TracedMove {
    /// Kind.
    pub kind: MoveKind,
    /// Machine position after it, by axis; `None` if it isn't followed.
    pub to: Vec<Option<NodeId>>,
    /// Machine position before it.
    pub from: Vec<Option<NodeId>>,
    /// Program and line of its block: `O8101 line 41`.
    pub place: String,
}

/// Operator stop of a way.
#[derive(Clone, Debug)]
pub struct TracedStop {
    /// Number of moves before it.
    pub moves: usize,
    /// Text of the stop.
    pub text: String,
    /// Variables that the text names, with their values.
    pub variables: Vec<(u32, Option<NodeId>)>,
}

/// Largest number of ways.
const MAX_WAYS: usize = 2000;

/// Largest number of moves of a way.
const MAX_MOVES: usize = 10_000;

/// Way that is followed.
struct OpenWay {
    snapshot: Snapshot,
    enclosures: Enclosures,
    /// Answers to the questions of the next block.
    answers: Vec<bool>,
    way: TracedWay,
}

/// Follows all ways of a program over ranges, `#1=0.1..9.9`.
///
/// # Errors
/// [`ProveError`] if the request can't be used.
pub fn trace<S: Setup>(
    setup: &S,
    ranges: &[String],
    limits: Limits,
    watch: &Watch<'_>,
) -> Result<Trace, ProveError> {
    let ranges = read_ranges(setup, ranges)?;
    let control = || setup.control(&[]).map_err(ProveError::Setup);
    let domain = Domain::new(
        ranges.iter().map(|range| gcode_enclosure::Interval::new(range.low, range.high)).collect(),
    );
    let mut nodes = Nodes::new(semantics(control()?.settings()), domain.clone(), 0.0);
    let mut run = SymbolicRun::new(control()?);
    let mut inputs = Vec::new();
    for (index, range) in ranges.iter().enumerate() {
        let is_number = range.low == range.high;
        let term = if is_number { Term::Number(range.low) } else { nodes.input(index) };
        inputs.push((!is_number).then(|| nodes.id(term)));
        // A variable that can't be set has been refused with the request.
        _ = run.set_term(range.variable, term);
    }
    let way = TracedWay {
        conditions: Vec::new(),
        moves: Vec::new(),
        stops: Vec::new(),
        end: TracedEnd::Unfollowed("a run that goes on".to_owned()),
    };
    let enclosures = Enclosures::with_degree(domain.clone(), 0);
    let mut open = vec![OpenWay { snapshot: run.snapshot(), enclosures, answers: Vec::new(), way }];
    let mut follower = Follower { run, nodes, limits, library: setup.library(), watch };
    let mut ways = Vec::new();
    while let Some(way) = open.pop() {
        if ways.len() + open.len() >= MAX_WAYS {
            let end = TracedEnd::Unfollowed(format!("more than {MAX_WAYS} ways"));
            ways.push(TracedWay { end, ..way.way });
            continue;
        }
        let (ended, others) = follower.follow(way);
        ways.extend(ended);
        open.extend(others);
    }
    Ok(Trace { nodes: follower.nodes, domain, inputs, ways })
}

/// Means to follow ways.
struct Follower<'a, L> {
    run: SymbolicRun,
    nodes: Nodes,
    limits: Limits,
    library: L,
    watch: &'a Watch<'a>,
}

impl<L: Library> Follower<'_, L> {
    /// Follows a way to its end, or to the next question: the way at its end, or those that are still to be followed.
    fn follow(&mut self, mut open: OpenWay) -> (Option<TracedWay>, Vec<OpenWay>) {
        self.run.restore(&open.snapshot);
        let end = loop {
            let blocks = self.run.control().blocks();
            if self.watch.is_over() {
                break TracedEnd::Unfollowed("the time is over".to_owned());
            }
            if blocks >= self.limits.blocks || open.way.moves.len() > MAX_MOVES {
                break TracedEnd::Unfollowed(format!("a run of more than {blocks} blocks"));
            }
            let before = (self.positions(), self.run.control().stops().len());
            match self.run.advance(&mut self.nodes, &open.answers, &mut self.library) {
                Advance::Next(used) => {
                    open.answers.drain(..used);
                    self.record(&mut open.way, before);
                }
                Advance::End(outcome, _) => {
                    self.record(&mut open.way, before);
                    break match End::of(&outcome, self.run.control()) {
                        End::Program => TracedEnd::Program,
                        End::Alarm(code) => TracedEnd::Alarm(code),
                        End::Unfollowed(what) => TracedEnd::Unfollowed(what),
                        End::Excluded | End::Endless => TracedEnd::Unfollowed("an endless loop".to_owned()),
                    };
                }
                Advance::Unfollowed(what) => {
                    break TracedEnd::Unfollowed(format!("{}: {what}", self.place()));
                }
                Advance::Fork(test) => return (None, self.answer(open, test)),
            }
        };
        (Some(TracedWay { end, ..open.way }), Vec::new())
    }

    /// Answers a question, both ways where it isn't decided.
    fn answer(&mut self, mut open: OpenWay, test: Test) -> Vec<OpenWay> {
        let nodes = &mut self.nodes;
        let (condition, decided) = match test {
            Test::Compare(relation, left, right) => {
                let condition = nodes.condition(relation, left, right);
                (Some(condition), open.enclosures.decide(nodes.arena(), condition))
            }
            Test::Finite(term) => {
                let node = nodes.id(term);
                (None, is_finite(nodes.arena(), &mut open.enclosures, node))
            }
        };
        open.snapshot = self.run.snapshot();
        if let Some(answer) = decided {
            open.answers.push(answer);
            return vec![open];
        }
        let with_answer = |answer: bool| {
            let (mut enclosures, mut way) = (open.enclosures.clone(), open.way.clone());
            if let Some(condition) = condition {
                let condition = if answer { condition } else { condition.negated() };
                way.conditions.push(condition);
                if !enclosures.assume(self.nodes.arena(), condition) {
                    return None;
                }
            }
            let answers = open.answers.iter().copied().chain([answer]).collect();
            Some(OpenWay { snapshot: open.snapshot.clone(), enclosures, answers, way })
        };
        [true, false].into_iter().filter_map(with_answer).collect()
    }

    /// Returns the machine position by axis.
    fn positions(&mut self) -> Vec<Option<NodeId>> {
        let axes = self.run.control().settings().axes.len();
        (0..axes).map(|axis| self.run.machine_position(axis).map(|term| self.nodes.id(term))).collect()
    }

    /// Records a move and a stop of the block that has been executed.
    fn record(&mut self, way: &mut TracedWay, (from, stops): (Vec<Option<NodeId>>, usize)) {
        let to = self.positions();
        if self.run.control().stops().len() > stops
            && let Some((text, variables)) = self.run.last_stop()
        {
            let node = |(number, term): (u32, Option<Term>)| (number, term.map(|term| self.nodes.id(term)));
            let (text, variables) = (text.to_owned(), variables.into_iter().map(node).collect());
            way.stops.push(TracedStop { moves: way.moves.len(), text, variables });
        }
        let is_same = from.iter().zip(&to).all(|(from, to)| from.is_some() && from == to);
        if !is_same {
            way.moves.push(TracedMove { kind: self.kind(), from, to, place: self.place() });
        }
    }

    /// Returns the kind of the move that the current block has made.
    fn kind(&self) -> MoveKind {
        let control = self.run.control();
        let state = control.state();
        let text = control.memory().sources().text(control.backtrace().block);
        if state.modal.cycle.is_some() || !has_plain_codes(&text) {
            return MoveKind::Other;
        }
        match state.modal.motion {
            Motion::Rapid => MoveKind::Rapid,
            Motion::Linear => MoveKind::Feed,
            _ => MoveKind::Other,
        }
    }

    /// Returns program and line of the current block.
    fn place(&self) -> String {
        let (memory, block) = (self.run.control().memory(), self.run.control().backtrace().block);
        let line = memory.sources().line_column(block).line;
        let program = memory.program_at(block).map_or_else(String::new, |program| program.label());
        format!("{program} line {line}")
    }
}

/// Returns true for a block with no G codes but those of straight moves and of their modes.
fn has_plain_codes(block: &str) -> bool {
    let text = block.split('(').next().unwrap_or_default().to_ascii_uppercase();
    let code = |rest: &str| {
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').len();
        rest[..digits].parse::<f64>().ok()
    };
    let plain = [0.0, 1.0, 17.0, 18.0, 19.0, 21.0, 40.0, 49.0, 80.0, 90.0, 91.0, 94.0];
    let is_function = |at: usize| text[..at].ends_with(|c: char| c.is_ascii_alphabetic());
    text.match_indices('G')
        .filter(|(at, _)| !is_function(*at))
        .all(|(at, _)| code(text[at + 1..].trim_start()).is_some_and(|code| plain.contains(&code)))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use gcode_control::Control;
    use gcode_lang::control::Settings;
    use gcode_lang::program::{Memory, NoLibrary};

    use super::*;

    struct OneProgram(&'static str);

    impl Setup for OneProgram {
        type Library = NoLibrary;

        fn control(&self, _: &[(String, String)]) -> Result<Control, String> {
            let mut memory = Memory::default();
            memory.load("O1.nc", self.0.as_bytes());
            Ok(Control::new(memory, Settings::default()))
        }

        fn library(&self) -> NoLibrary {
            NoLibrary
        }
    }

    fn traced(program: &'static str) -> Trace {
        let watch = Watch::new(&|| Duration::ZERO, Duration::from_secs(5));
        trace(&OneProgram(program), &["#1=-4..4".to_owned()], Limits { blocks: 1000 }, &watch).unwrap()
    }

    #[test]
    fn each_side_of_a_question_is_a_way_with_its_moves() {
        let trace =
            traced("O1\nIF[#1 LT 0]GOTO 9\nG90 G00 X#1\nG01 X[2*#1] F100.\nM30\nN9 #3000=1(NEGATIVE)\n");
        let ends: Vec<_> = trace.ways.iter().map(|way| (&way.end, way.moves.len())).collect();
        assert!(ends.contains(&(&TracedEnd::Alarm("MC3001".to_owned()), 0)), "{ends:?}");
        assert!(ends.contains(&(&TracedEnd::Program, 2)), "{ends:?}");
        let way = trace.ways.iter().find(|way| way.end == TracedEnd::Program).unwrap();
        assert_eq!(way.conditions.len(), 1);
        let kinds: Vec<_> = way.moves.iter().map(|one| (one.kind, one.place.as_str())).collect();
        assert_eq!(kinds, [(MoveKind::Rapid, "O0001 line 3"), (MoveKind::Feed, "O0001 line 4")]);
        assert_eq!(way.moves[0].to[0], way.moves[1].from[0]);
        let end = way.moves[1].to[0].unwrap();
        assert_eq!(trace.arena().evaluate(end, &[1.2344]).ok(), Some(2.469), "2.4688, to the increment");
    }

    #[test]
    fn a_stop_shows_the_variable_that_its_text_names() {
        let trace = traced("O1\n#100=ABS[#1]\n#3006=1(SET HEAD TO #100)\nM30\n");
        let stop = &trace.ways[0].stops[0];
        let (number, value) = stop.variables[0];
        assert_eq!((stop.moves, number), (0, 100));
        assert_eq!(trace.arena().evaluate(value.unwrap(), &[-3.0]).ok(), Some(3.0));
    }

    #[test]
    fn a_block_with_another_code_is_no_plain_move() {
        assert!(has_plain_codes("N5 G90 G01 X[#1*COS[#2]] F#9 (G53)"));
        assert!(has_plain_codes("X#28 Y#29"));
        assert!(!has_plain_codes("G53 X1."));
        assert!(!has_plain_codes("G90 G 31 X1."));
        assert!(!has_plain_codes("G#4 X1."));
    }
}
