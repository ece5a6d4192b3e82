//! Properties of the reader: printing and reading keeps every tree, every text gives a tree, in linear time.
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use proptest::sample::select;

use super::ast::*;
use super::{
    BlockOutline, KnownBlocks, block_at, outline, parse, print, sequence_number_at, without_trailer,
};
use crate::source::{SourceId, Span, Spanned};

const NOWHERE: Span = Span { source: SourceId(0), start: 0, end: 0 };

/// Returns the tree as text without its spans.
fn without_spans(programs: &[Program]) -> String {
    let shown = format!("{programs:?}");
    let mut pieces = shown.split("Span {");
    let mut out = pieces.next().unwrap_or("").to_owned();
    for piece in pieces {
        out.push_str(piece.split_once('}').map_or("", |(_, rest)| rest));
    }
    out
}

fn expr(kind: ExprKind) -> Expr {
    Expr { kind, span: NOWHERE }
}

fn boxed(value: Expr) -> Box<Expr> {
    Box::new(value)
}

fn decimal() -> impl Strategy<Value = Decimal> {
    (0..=999_999_999u64, option::of(0..=9u8)).prop_map(|(digits, places)| Decimal {
        negative: false,
        digits,
        places,
    })
}

fn name() -> impl Strategy<Value = String> {
    "[A-Z_][A-Z0-9_]{0,7}"
}

/// Generates an unsigned value with at most `levels` nested brackets.
fn primary(levels: u32) -> BoxedStrategy<Expr> {
    let literal = decimal().prop_map(|d| expr(ExprKind::Literal(d)));
    let numbered = (0..=99_999u64).prop_map(|n| {
        let index = Decimal { negative: false, digits: n, places: None };
        expr(ExprKind::Variable(boxed(expr(ExprKind::Literal(index)))))
    });
    if levels == 0 {
        return prop_oneof![literal, numbered].boxed();
    }
    let bracket = |levels| sum(levels).prop_map(|e| expr(ExprKind::Bracket(boxed(e))));
    let indirect = bracket(levels - 1).prop_map(|e| expr(ExprKind::Variable(boxed(e))));
    let named = name().prop_map(|text| expr(ExprKind::Named(Name { text, index: None })));
    let one = Function::ALL.map(|(_, f)| f).into_iter().filter(|f| *f != Function::Pow);
    let one = (select(one.collect::<Vec<_>>()), sum(levels - 1))
        .prop_map(|(f, a)| expr(ExprKind::Call(f, CallForm::One(boxed(a)))));
    let two = (select(vec![Function::Atan, Function::Pow]), sum(levels - 1), sum(levels - 1))
        .prop_map(|(f, a, b)| expr(ExprKind::Call(f, CallForm::Comma(boxed(a), boxed(b)))));
    let slash = (sum(levels - 1), sum(levels - 1))
        .prop_map(|(a, b)| expr(ExprKind::Call(Function::Atan, CallForm::Slash(boxed(a), boxed(b)))));
    let parameter = (sum(levels - 1), option::of(sum(levels - 1)), option::of(sum(levels - 1))).prop_map(
        |(number, bit, axis)| {
            let (bit, axis) = (bit.map(boxed), axis.map(boxed));
            expr(ExprKind::Parameter { number: boxed(number), bit, axis })
        },
    );
    let axis_number = (b'A'..=b'Z').prop_map(|letter| expr(ExprKind::AxisNumber(letter)));
    prop_oneof![
        4 => literal,
        4 => numbered,
        1 => axis_number,
        2 => bracket(levels - 1),
        1 => indirect,
        1 => named,
        2 => one,
        1 => two,
        1 => slash,
        1 => parameter,
    ]
    .boxed()
}

fn signed(levels: u32) -> BoxedStrategy<Expr> {
    (primary(levels), 0..6u8)
        .prop_map(|(value, sign)| match sign {
            0 => expr(ExprKind::Negate(boxed(value))),
            1 => expr(ExprKind::Plus(boxed(value))),
            _ => value,
        })
        .boxed()
}

fn chain(parts: BoxedStrategy<Expr>, ops: [BinaryOp; 4]) -> BoxedStrategy<Expr> {
    (parts.clone(), vec((select(ops.to_vec()), parts), 0..3))
        .prop_map(|(first, more)| {
            more.into_iter().fold(first, |left, (op, right)| {
                // `ATAN[a]/[b]` and `PRM[n]/[axis]` are not divisions.
                let op = match (op, &right.kind) {
                    (BinaryOp::Div, ExprKind::Bracket(_) | ExprKind::Named(_)) => BinaryOp::Mul,
                    _ => op,
                };
                expr(ExprKind::Binary(op, boxed(left), boxed(right)))
            })
        })
        .boxed()
}

fn sum(levels: u32) -> BoxedStrategy<Expr> {
    let term = chain(signed(levels), [BinaryOp::Mul, BinaryOp::Div, BinaryOp::Mod, BinaryOp::And]);
    chain(term, [BinaryOp::Add, BinaryOp::Sub, BinaryOp::Or, BinaryOp::Xor])
}

fn condition(levels: u32) -> BoxedStrategy<Condition> {
    use Relation::{Eq, Ge, Gt, Le, Lt, Ne};
    let written = || select(vec![OperatorSpelling::Letters, OperatorSpelling::Sign]);
    let compare = (sum(levels), select(vec![Eq, Ne, Gt, Ge, Lt, Le]), written(), sum(levels)).prop_map(
        |(left, relation, written, right)| Condition::Compare {
            left,
            relation,
            spelling: written,
            right,
            span: NOWHERE,
        },
    );
    if levels == 0 {
        return compare.boxed();
    }
    let bracket = |levels| condition(levels).prop_map(|c| Condition::Bracket(Box::new(c)));
    use OperatorSpelling::{Letters, Sign};
    let joined = [
        (BinaryOp::And, Letters),
        (BinaryOp::Or, Letters),
        (BinaryOp::Xor, Letters),
        (BinaryOp::And, Sign),
        (BinaryOp::Or, Sign),
    ];
    let logic = (select(joined.to_vec()), bracket(levels - 1), bracket(levels - 1))
        .prop_map(|((op, written), a, b)| Condition::Logic(op, written, Box::new(a), Box::new(b)));
    prop_oneof![3 => compare, 1 => logic, 1 => bracket(levels - 1)].boxed()
}

fn variable() -> BoxedStrategy<Expr> {
    primary(1)
        .prop_filter("a variable", |e| matches!(e.kind, ExprKind::Variable(_) | ExprKind::Named(_)))
        .boxed()
}

fn statement() -> impl Strategy<Value = Statement> {
    let assign = || (variable(), sum(2)).prop_map(|(target, value)| Statement::Assign { target, value });
    let number = || (0..=99i64).prop_map(|n| Spanned::new(n, NOWHERE));
    let text = "[A-Z0-9+*/.-]{1,9}".prop_map(PrintPart::Text);
    let value =
        (variable(), "[0-9]{1,2}").prop_map(|(variable, format)| PrintPart::Value { variable, format });
    let parts = (option::of(text), vec(value, 0..3)).prop_map(|(text, values)| {
        let mut parts: Vec<_> = text.into_iter().collect();
        parts.extend(values);
        parts
    });
    prop_oneof![
        4 => assign(),
        1 => sum(1).prop_map(Statement::Goto),
        1 => (condition(2), sum(1)).prop_map(|(condition, to)| Statement::IfGoto { condition, to }),
        1 => (condition(1), assign())
            .prop_map(|(condition, then)| Statement::IfThen { condition, then: Box::new(then) }),
        1 => (condition(1), number()).prop_map(|(condition, number)| Statement::While { condition, number }),
        1 => number().prop_map(Statement::Do),
        1 => number().prop_map(Statement::End),
        1 => (primary(0), vec(name(), 1..4)).prop_map(|(first, names)| Statement::SetNames { first, names }),
        1 => (select(vec![PrintKind::Decimal, PrintKind::Binary]), parts)
            .prop_map(|(kind, parts)| Statement::Print { kind, parts }),
        1 => Just(Statement::OpenOutput),
        1 => Just(Statement::CloseOutput),
    ]
}

fn word() -> impl Strategy<Value = Item> {
    let literal = (decimal(), any::<bool>())
        .prop_map(|(number, negative)| WordValue::Literal(Decimal { negative, ..number }));
    let single = primary(2).prop_filter("one value", |e| {
        matches!(e.kind, ExprKind::Variable(_) | ExprKind::Named(_) | ExprKind::Bracket(_))
    });
    let value = (single, any::<bool>()).prop_map(|(value, negative)| {
        WordValue::Expr(boxed(if negative { expr(ExprKind::Negate(boxed(value))) } else { value }))
    });
    let value = prop_oneof![3 => literal, 1 => value];
    let word = ("[A-MQ-Z]", any::<bool>(), value).prop_map(|(letter, comma, value)| {
        let address = Address { letter: letter.as_bytes()[0], comma };
        Item::Word(Word { address, axis: None, value, span: NOWHERE })
    });
    let call = "[A-Z0-9+_.-]{1,32}".prop_map(|name| {
        let address = Address { letter: b'P', comma: false };
        Item::Word(Word { address, axis: None, value: WordValue::Name(name), span: NOWHERE })
    });
    prop_oneof![9 => word, 1 => call]
}

/// Generates comments in round brackets, and one at the end that extends to the end of the line.
fn comments() -> impl Strategy<Value = Vec<Comment>> {
    let bytes = || vec(any::<u8>().prop_filter("no end", |b| !b"()\r\n".contains(b)), 0..6);
    let comment = |mark| {
        move |mut text: Vec<u8>| {
            if mark != CommentMark::Round {
                text.splice(0..0, *b" ?");
                text.push(b'.');
            }
            Comment { span: NOWHERE, text, mark }
        }
    };
    let last = prop_oneof![
        bytes().prop_map(comment(CommentMark::Unclosed)),
        bytes().prop_map(comment(CommentMark::Semicolon)),
        bytes().prop_map(comment(CommentMark::Slashes)),
    ];
    (vec(bytes().prop_map(comment(CommentMark::Round)), 0..2), option::weighted(0.1, last)).prop_map(
        |(mut comments, last)| {
            comments.extend(last);
            comments
        },
    )
}

fn block() -> impl Strategy<Value = Block> {
    let statement = statement().prop_map(|s| vec![Item::Statement(Box::new(Spanned::new(s, NOWHERE)))]);
    let skip = || (1..=9u8).prop_map(|n| Spanned::new(n, NOWHERE));
    let words = (vec(word(), 1..5), option::weighted(0.1, (skip(), word()))).prop_map(|(mut words, tail)| {
        if let Some((skip, word)) = tail {
            words.extend([Item::Skip(skip), word]);
        }
        words
    });
    let items = prop_oneof![3 => words, 3 => statement, 1 => Just(Vec::new())];
    let number = (0..=99_999_999u32).prop_map(|n| Spanned::new(n, NOWHERE));
    (option::weighted(0.1, skip()), option::weighted(0.3, number), items, comments())
        .prop_map(|(skip, number, items, comments)| Block {
            span: NOWHERE,
            skip,
            number,
            short_word: None,
            behind_semicolon: None,
            do_line: DoLine::No,
            items,
            comments,
        })
        .prop_filter("something", |b| {
            b.skip.is_some() || b.number.is_some() || !b.items.is_empty() || !b.comments.is_empty()
        })
}

fn program() -> impl Strategy<Value = Program> {
    let name = prop_oneof![
        4 => (1..=99_999_999u32).prop_map(ProgramName::Number),
        1 => "[A-NP-Z][A-Z0-9+_.-]{0,31}".prop_map(ProgramName::Name),
        1 => Just(ProgramName::Unnamed),
    ];
    (name, vec(block(), 1..6)).prop_map(|(name, blocks)| Program { name, span: NOWHERE, blocks })
}

proptest! {
    #[test]
    fn a_printed_tree_reads_as_the_same_tree(program in program()) {
        let text = print(&program);
        let read = parse(SourceId(0), &text);
        prop_assert_eq!(without_spans(&[program]), without_spans(&read), "{}", String::from_utf8_lossy(&text));
    }

    #[test]
    fn any_text_that_is_read_and_printed_reads_as_the_same_tree(
        lines in vec("([A-Zxg#\\[\\]()/;,.=+*<>%:&|O0-9 -]|AND|EQ|GOTO|GO|WH|EN|IF|THEN|DO|SIN|#1|X1\\.|M99|//|\\[#1|é){0,12}", 1..6)
    ) {
        for program in parse(SourceId(0), lines.join("\n").as_bytes()) {
            let text = print(&program);
            let again = parse(SourceId(0), &text);
            prop_assert_eq!(without_spans(&[program]), without_spans(&again), "{}", String::from_utf8_lossy(&text));
        }
    }

    #[test]
    fn an_outline_has_the_programs_and_blocks_of_the_tree(
        lines in vec("([A-Zxg#\\[\\]()/;,.=+*<>%:&|O0-9 -]|N1|WH|EN|IF|DO|M99|M30|O7|//|\\t|\\x1a|\u{feff}|é){0,12}", 1..6),
        end in select(vec!["\n", "\r\n", "\r", "\n\r\r"]),
    ) {
        let text = lines.join(end);
        let whole = without_trailer(text.as_bytes());
        let tree = parse(SourceId(0), text.as_bytes());
        let at = |start| (sequence_number_at(SourceId(0), whole, start), block_at(SourceId(0), whole, start));
        let outlined = outline(SourceId(0), text.as_bytes(), &KnownBlocks::default(), |(), block| match block {
            BlockOutline::Words(span) => at(span.start),
            BlockOutline::Tree(block) => at(block.span.start),
            BlockOutline::WithinLine(block) => (block.number.map(|n| n.node), Some(*block)),
        });
        prop_assert_eq!(tree.len(), outlined.len());
        for (tree, outlined) in tree.into_iter().zip(outlined) {
            prop_assert_eq!((tree.name, tree.span), (outlined.name, outlined.span));
            let blocks = tree.blocks.into_iter().map(|b| (b.number.as_ref().map(|n| n.node), Some(b)));
            prop_assert_eq!(blocks.collect::<Vec<_>>(), outlined.blocks);
        }
    }

    #[test]
    fn every_text_gives_a_tree_with_spans_inside_it(bytes in vec(any::<u8>(), 0..200)) {
        for program in parse(SourceId(0), &bytes) {
            for block in &program.blocks {
                prop_assert!(block.span.start <= block.span.end && block.span.end as usize <= bytes.len());
            }
        }
    }
}

#[test]
fn statements_behind_do_are_printed_in_its_line() {
    let text = b"WHILE[#1 GT 0]DO1 #1=#1-1 END1\nG04\n";
    let printed = print(&parse(SourceId(0), text)[0]);
    assert_eq!(String::from_utf8_lossy(&printed).lines().count(), 2, "{}", String::from_utf8_lossy(&printed));
    assert_eq!(without_spans(&parse(SourceId(0), text)), without_spans(&parse(SourceId(0), &printed)));
}

#[test]
fn a_byte_order_mark_behind_a_leader_is_printed_as_unreadable() {
    let text = "\0\0\u{feff}?%\r\n]]\n";
    let printed = print(&parse(SourceId(0), text.as_bytes())[0]);
    assert_eq!(String::from_utf8_lossy(&printed), "\n\u{feff}?%\n]]\n");
    assert_eq!(print(&parse(SourceId(0), &printed)[0]), printed);
}

/// The pieces together take a second; each takes hours if the reader examines any byte again for each other byte.
#[test]
fn long_lines_are_read_in_linear_time() {
    let (end, ended) = mpsc::channel();
    thread::spawn(move || {
        read_long_lines();
        end.send(()).ok();
    });
    ended.recv_timeout(Duration::from_secs(300)).expect("a long line is not read in linear time");
}

fn read_long_lines() {
    for piece in [
        "(", "(()", "()", ";", "; X1", "//", "/", "[", "[#", "#1=", "1", " ", "X", "X1", "+", "#1+", "O1",
        "M99O1(A)", "<", "%", "IF[", "SIN[", "E N", "\r", "\r\r\n", "\u{feff}", "X#1 ", "- ", "(A(B)",
    ] {
        let text = piece.repeat(300_000 / piece.len());
        parse(SourceId(0), text.as_bytes());
        outline(SourceId(0), text.as_bytes(), &KnownBlocks::default(), |(), _| ());
        let text = format!("#1=1{}", piece.repeat(300_000 / piece.len()));
        parse(SourceId(0), text.as_bytes());
    }
}
