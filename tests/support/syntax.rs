//! Cases of kind `syntax`: what was read of `case.nc` in words, one line a block; grouping shown in round brackets.
use gcode_lang::source::{SourceId, Sources};
use gcode_lang::syntax::ast::{
    BinaryOp, Block, CallForm, CommentMark, Condition, Expr, ExprKind, Item, OperatorSpelling, PrintPart,
    Program, ProgramName, Statement, Word, WordValue,
};
use gcode_lang::syntax::{parse, print_decimal};

use crate::Case;

/// Reads the file and compares the result with `read.snap`.
pub(crate) fn run(case: &Case) {
    let mut sources = Sources::default();
    let id = sources.add("case.nc", case.bytes("case.nc"));
    let programs = parse(id, &sources.get(id).bytes);
    let shown: Vec<_> = programs.iter().map(|p| program(p, &sources, id)).collect();
    case.snapshot("read", &shown.join("\n"));
}

fn program(program: &Program, sources: &Sources, id: SourceId) -> String {
    let mut shown = match &program.name {
        ProgramName::Number(number) => format!("program O{number:04}\n"),
        ProgramName::Name(name) => format!("program <{name}>\n"),
        ProgramName::Unnamed => "program without a number\n".to_owned(),
    };
    for found in &program.blocks {
        let line = sources.get(id).line_column(found.span.start).line;
        shown.push_str(&format!("  line {line}: {}\n", block(found, sources)));
    }
    shown
}

fn block(block: &Block, sources: &Sources) -> String {
    let mut parts = Vec::new();
    if let Some(skip) = &block.skip {
        parts.push(format!("skipped by switch {}", skip.node));
    }
    if let Some(number) = &block.number {
        parts.push(format!("number {}", number.node));
    }
    let mut words = Vec::new();
    for item in &block.items {
        if !matches!(item, Item::Word(_)) && !words.is_empty() {
            parts.push(format!("words {}", words.join(" ")));
            words.clear();
        }
        match item {
            Item::Word(found) => words.push(word(found)),
            Item::Statement(found) => parts.push(statement(&found.node)),
            Item::Skip(skip) => parts.push(format!("the rest skipped by switch {}", skip.node)),
            Item::Unreadable(found) => {
                let row = found.alarm.node.row();
                let column = sources.line_column(found.alarm.span).column;
                let help = row.help.map(|help| format!(" ({help})")).unwrap_or_default();
                parts.push(format!("{} in column {column}: {}{help}", row.code, row.message));
            }
        }
    }
    if !words.is_empty() {
        parts.push(format!("words {}", words.join(" ")));
    }
    for comment in &block.comments {
        let kind = match comment.mark {
            CommentMark::Round => "comment",
            CommentMark::Unclosed => "unclosed comment",
            CommentMark::Semicolon | CommentMark::Slashes => "remark",
        };
        parts.push(format!("{kind} \"{}\"", comment.text.escape_ascii()));
    }
    parts.join(", ")
}

fn word(word: &Word) -> String {
    let comma = if word.address.comma { "," } else { "" };
    let letter = match &word.axis {
        Some(axis) => format!("AX({})", expr(axis)),
        None => char::from(word.address.letter).to_string(),
    };
    match &word.value {
        WordValue::Literal(number) => format!("{comma}{letter}{}", print_decimal(*number)),
        WordValue::Expr(value) => format!("{comma}{letter}={}", expr(value)),
        WordValue::Name(name) => format!("{comma}{letter}=program <{name}>"),
    }
}

fn statement(found: &Statement) -> String {
    match found {
        Statement::Assign { target, value } => format!("set {} to {}", expr(target), expr(value)),
        Statement::Goto(to) => format!("go to {}", expr(to)),
        Statement::IfGoto { condition: c, to } => format!("if {} go to {}", condition(c), expr(to)),
        Statement::If { condition: c, has_then } => {
            format!("if {}{}, what follows", condition(c), if *has_then { " then" } else { "" })
        }
        Statement::IfThen { condition: c, then } => format!("if {} then {}", condition(c), statement(then)),
        Statement::While { condition: c, number } => format!("while {} do {}", condition(c), number.node),
        Statement::Do(number) => format!("do {}", number.node),
        Statement::End(number) => format!("end {}", number.node),
        Statement::SetNames { first, names } => {
            format!("name variables from {}: {}", expr(first), names.join(", "))
        }
        Statement::Print { kind, parts } => {
            if parts.is_empty() {
                return format!("print {kind:?}: an empty line");
            }
            let parts: Vec<_> = parts
                .iter()
                .map(|part| match part {
                    PrintPart::Text(text) => format!("\"{text}\""),
                    PrintPart::Value { variable, format } => format!("{} as {format}", expr(variable)),
                })
                .collect();
            format!("print {kind:?}: {}", parts.join(", "))
        }
        Statement::OpenOutput => "open the output".into(),
        Statement::CloseOutput => "close the output".into(),
    }
}

fn expr(value: &Expr) -> String {
    match &value.kind {
        ExprKind::Literal(number) => print_decimal(*number),
        ExprKind::Variable(index) => format!("#{}", expr(index)),
        ExprKind::Named(name) => match &name.index {
            Some(index) => format!("variable {}[{}]", name.text, expr(index)),
            None => format!("variable {}", name.text),
        },
        ExprKind::Negate(inner) => format!("-{}", expr(inner)),
        ExprKind::Plus(inner) => format!("+{}", expr(inner)),
        ExprKind::Bracket(inner) => format!("[{}]", expr(inner)),
        ExprKind::Binary(op, left, right) => format!("({} {} {})", expr(left), operator(*op), expr(right)),
        ExprKind::Call(function, form) => match form {
            CallForm::One(a) => format!("{function:?}({})", expr(a)),
            CallForm::Slash(a, b) => format!("{function:?}({} over {})", expr(a), expr(b)),
            CallForm::Comma(a, b) => format!("{function:?}({} and {})", expr(a), expr(b)),
        },
        ExprKind::Parameter { number, bit, axis } => {
            let bit = bit.as_ref().map(|bit| format!(" bit {}", expr(bit))).unwrap_or_default();
            let axis = axis.as_ref().map(|axis| format!(" axis {}", expr(axis))).unwrap_or_default();
            format!("parameter({}{bit}{axis})", expr(number))
        }
        ExprKind::AxisNumber(letter) => format!("number of axis {}", char::from(*letter)),
    }
}

fn operator(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Add => "+",
        BinaryOp::Sub => "-",
        BinaryOp::Mul => "*",
        BinaryOp::Div => "/",
        BinaryOp::Mod => "mod",
        BinaryOp::And => "and",
        BinaryOp::Or => "or",
        BinaryOp::Xor => "xor",
    }
}

fn sign(written: OperatorSpelling) -> &'static str {
    match written {
        OperatorSpelling::Letters => "",
        OperatorSpelling::Sign => " by its sign",
    }
}

fn condition(value: &Condition) -> String {
    match value {
        Condition::Compare { left, relation, spelling: written, right, .. } => {
            format!("{} {relation:?}{} {}", expr(left), sign(*written), expr(right))
        }
        Condition::Logic(op, written, left, right) => {
            format!("({} {}{} {})", condition(left), operator(*op), sign(*written), condition(right))
        }
        Condition::Bracket(inner) => format!("[{}]", condition(inner)),
        Condition::Value { value, .. } => expr(value),
    }
}
