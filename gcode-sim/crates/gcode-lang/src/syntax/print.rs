//! Printer: tree to text, one block per line, words separated by a space, comments byte for byte.
//!
//! Reading the text gives the same tree.
use super::ast::{
    BinaryOp, Block, CallForm, Comment, CommentMark, Condition, Decimal, DoLine, Expr, ExprKind, Item,
    OperatorSpelling, PrintKind, PrintPart, Program, ProgramName, Relation, Statement, Word, WordValue,
};
use super::file_items::byte_order_marks;

/// Prints a program, its O word first and a line feed after each block but one before a statement behind DO.
pub fn print(program: &Program) -> Vec<u8> {
    let mut out = Vec::new();
    match &program.name {
        ProgramName::Number(number) => out.extend(format!("O{number:04}").bytes()),
        ProgramName::Name(name) => out.extend(format!("<{name}>").bytes()),
        ProgramName::Unnamed => {}
    }
    // A comment after the O word is the title of the program.
    let titled =
        program.blocks.first().is_some_and(|b| b.items.is_empty() && b.number.is_none() && b.skip.is_none());
    if program.name != ProgramName::Unnamed && !titled {
        out.push(b'\n');
    }
    let mut blocks = program.blocks.iter().peekable();
    while let Some(block) = blocks.next() {
        print_block(block, &mut out);
        let goes_on = blocks.peek().is_some_and(|next| next.do_line == DoLine::Behind);
        out.push(if goes_on { b' ' } else { b'\n' });
    }
    if program.blocks.is_empty() && program.name == ProgramName::Unnamed {
        out.clear();
    }
    // At the start of a text a byte order mark is none of it; behind a leader it is unreadable.
    if byte_order_marks(&out) != 0 {
        out.insert(0, b'\n');
    }
    out
}

/// Appends a block without its line end. Comments keep their positions between the words.
fn print_block(block: &Block, out: &mut Vec<u8>) {
    let begin = out.len();
    let mut comments = block.comments.iter().peekable();
    if let Some(switch) = &block.skip {
        out.extend(skip(switch.node).bytes());
    }
    if let Some(number) = &block.number {
        out.extend(format!("N{}", number.node).bytes());
    }
    for item in &block.items {
        let start = match item {
            Item::Word(word) => word.span.start,
            Item::Statement(statement) => statement.span.start,
            Item::Skip(switch) => switch.span.start,
            Item::Unreadable(unreadable) => unreadable.span.start,
        };
        // Only comments in round brackets end before the line does.
        while let Some(comment) = comments.next_if(|c| c.span.start < start && c.mark == CommentMark::Round) {
            print_comment(comment, begin, out);
        }
        if out.len() > begin {
            out.push(b' ');
        }
        match item {
            Item::Word(word) => out.extend(print_word(word).bytes()),
            Item::Statement(statement) => {
                out.extend(statement_text(&statement.node, block.short_word.is_some()).bytes())
            }
            Item::Skip(switch) => out.extend(skip(switch.node).bytes()),
            Item::Unreadable(unreadable) => out.extend_from_slice(&unreadable.text),
        }
    }
    for comment in comments {
        print_comment(comment, begin, out);
    }
}

fn print_comment(comment: &Comment, begin: usize, out: &mut Vec<u8>) {
    if out.len() > begin {
        out.push(b' ');
    }
    out.extend_from_slice(match comment.mark {
        CommentMark::Round | CommentMark::Unclosed => b"(",
        CommentMark::Semicolon => b";",
        CommentMark::Slashes => b"//",
    });
    out.extend_from_slice(&comment.text);
    if comment.mark == CommentMark::Round {
        out.push(b')');
    }
}

fn skip(switch: u8) -> String {
    if switch == 1 { "/".into() } else { format!("/{switch}") }
}

fn print_word(word: &Word) -> String {
    let comma = if word.address.comma { "," } else { "" };
    let letter = match &word.axis {
        Some(axis) => format!("AX[{}]=", expr(axis)),
        None => char::from(word.address.letter).to_string(),
    };
    match &word.value {
        WordValue::Literal(number) => format!("{comma}{letter}{}", print_decimal(*number)),
        WordValue::Expr(value) => format!("{comma}{letter}{}", expr(value)),
        WordValue::Name(name) => format!("{comma}{letter}<{name}>"),
    }
}

/// Prints a number with its digits after the point: `12.5`, `5.`; `.5` becomes `0.5`.
pub fn print_decimal(number: Decimal) -> String {
    let sign = if number.negative { "-" } else { "" };
    match number.places {
        None => format!("{sign}{}", number.digits),
        Some(places) => {
            let places = usize::from(places);
            let digits = format!("{:0width$}", number.digits, width = places + 1);
            let (whole, fraction) = digits.split_at(digits.len() - places);
            format!("{sign}{whole}.{fraction}")
        }
    }
}

/// Prints an expression in the notation of a control.
fn expr(value: &Expr) -> String {
    match &value.kind {
        ExprKind::Literal(number) => print_decimal(*number),
        ExprKind::Variable(index) => format!("#{}", expr(index)),
        ExprKind::Named(name) => match &name.index {
            Some(index) => format!("[#{}[{}]]", name.text, expr(index)),
            None => format!("[#{}]", name.text),
        },
        ExprKind::Negate(inner) => format!("-{}", expr(inner)),
        ExprKind::Plus(inner) => format!("+{}", expr(inner)),
        ExprKind::Bracket(inner) => format!("[{}]", expr(inner)),
        ExprKind::Binary(op, left, right) => {
            format!("{}{}{}", expr(left), operator(*op, OperatorSpelling::Letters), expr(right))
        }
        ExprKind::Call(function, form) => match form {
            CallForm::One(a) => format!("{}[{}]", function.name(), expr(a)),
            CallForm::Slash(a, b) => format!("{}[{}]/[{}]", function.name(), expr(a), expr(b)),
            CallForm::Comma(a, b) => format!("{}[{},{}]", function.name(), expr(a), expr(b)),
        },
        ExprKind::Parameter { number, bit, axis } => {
            let bit = bit.as_ref().map(|bit| format!(",{}", expr(bit))).unwrap_or_default();
            let axis = axis.as_ref().map(|axis| format!("/[{}]", expr(axis))).unwrap_or_default();
            format!("PRM[{}{bit}]{axis}", expr(number))
        }
        ExprKind::AxisNumber(letter) => format!("AXNUM[{}]", char::from(*letter)),
    }
}

/// Prints an operator by letters, in spaces, or by its sign; some have only one of the spellings.
fn operator(op: BinaryOp, spelling: OperatorSpelling) -> String {
    let all = [BinaryOp::OF_SUM, BinaryOp::OF_PRODUCT].into_iter().flatten();
    let texts = all.filter(|(_, other)| *other == op).map(|(text, _)| text);
    let is_sign = |text: &&str| text.len() == 1;
    match texts.max_by_key(|text| is_sign(text) == (spelling == OperatorSpelling::Sign)) {
        Some(text) if !is_sign(&text) => format!(" {text} "),
        text => text.unwrap_or_default().to_owned(),
    }
}

/// Prints a condition without the brackets of its IF or WHILE.
fn condition(value: &Condition) -> String {
    match value {
        Condition::Compare { left, relation, spelling, right, .. } => {
            let row = Relation::SPELLINGS.iter().find(|(other, ..)| other == relation);
            let text = row.map_or("", |(_, letters, sign)| match spelling {
                OperatorSpelling::Letters => letters,
                OperatorSpelling::Sign => sign,
            });
            format!("{} {text} {}", expr(left), expr(right))
        }
        Condition::Logic(op, spelling, left, right) => {
            format!("{}{}{}", condition(left), operator(*op, *spelling), condition(right))
        }
        Condition::Bracket(inner) => format!("[{}]", condition(inner)),
        Condition::Value { value, .. } => expr(value),
    }
}

/// Prints a statement with its keywords in full, or abbreviated to two letters if `short`.
fn statement_text(statement: &Statement, short: bool) -> String {
    let word = |text: &'static str| if short { &text[..2] } else { text };
    match statement {
        Statement::Assign { target, value } => format!("{}={}", expr(target), expr(value)),
        Statement::Goto(to) => format!("{} {}", word("GOTO"), expr(to)),
        Statement::IfGoto { condition: c, to } => {
            format!("IF[{}]{} {}", condition(c), word("GOTO"), expr(to))
        }
        Statement::IfThen { condition: c, then } => {
            format!("IF[{}]{} {}", condition(c), word("THEN"), statement_text(then, short))
        }
        Statement::If { condition: c, has_then } => {
            format!("IF[{}]{}", condition(c), if *has_then { word("THEN") } else { "" })
        }
        Statement::While { condition: c, number } => {
            format!("{}[{}]DO{}", word("WHILE"), condition(c), number.node)
        }
        Statement::Do(number) => format!("DO{}", number.node),
        Statement::End(number) => format!("{}{}", word("END"), number.node),
        Statement::SetNames { first, names } => {
            format!("{} {}[{}]", word("SETVN"), expr(first), names.join(","))
        }
        Statement::Print { kind, parts } => {
            let begin = match kind {
                PrintKind::Decimal => word("DPRNT"),
                PrintKind::Binary => word("BPRNT"),
            };
            let parts: Vec<_> = parts
                .iter()
                .map(|part| match part {
                    PrintPart::Text(text) => text.clone(),
                    PrintPart::Value { variable, format } => format!("{}[{format}]", expr(variable)),
                })
                .collect();
            format!("{begin}[{}]", parts.concat())
        }
        Statement::OpenOutput => word("POPEN").into(),
        Statement::CloseOutput => word("PCLOS").into(),
    }
}
