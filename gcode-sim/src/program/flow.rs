//! Pairs DO and END, and finds blocks by sequence number.
use super::{Op, OpIndex, OpKind, Statement};
use crate::alarm::Alarm;

/// Writes into every WHILE, DO and END where its partner stands. What has none becomes the alarm that a control
/// raises when it gets there.
pub(super) fn pair_loops(ops: &mut [Op]) {
    let mut open: Vec<(u8, OpIndex)> = Vec::new();
    for index in 0..ops.len() {
        let OpKind::Statement(statement) = &ops[index].kind else { continue };
        match *statement {
            Statement::While { number, .. } | Statement::Do { number, .. } => {
                // A loop inside one of the same number: the outer one's END can't be told from the inner one's.
                while open.iter().any(|(n, _)| *n == number) {
                    leave_open(ops, open.pop());
                }
                open.push((number, index));
            }
            Statement::End { number, .. } => {
                if !open.iter().any(|(n, _)| *n == number) {
                    raise(&mut ops[index], Alarm::MissingDo { number });
                    continue;
                }
                while open.last().is_some_and(|(n, _)| *n != number) {
                    leave_open(ops, open.pop());
                }
                if let Some((_, start)) = open.pop() {
                    join(ops, start, index);
                }
            }
            _ => {}
        }
    }
    while let Some(entry) = open.pop() {
        leave_open(ops, Some(entry));
    }
}

fn leave_open(ops: &mut [Op], entry: Option<(u8, OpIndex)>) {
    if let Some((number, index)) = entry {
        raise(&mut ops[index], Alarm::MissingEnd { number });
    }
}

fn raise(op: &mut Op, alarm: Alarm) {
    op.kind = OpKind::Alarm(Box::new(alarm.at(op.span)));
}

fn join(ops: &mut [Op], from: OpIndex, to: OpIndex) {
    if let OpKind::Statement(Statement::While { end, .. } | Statement::Do { end, .. }) = &mut ops[from].kind {
        *end = to;
    }
    if let OpKind::Statement(Statement::End { start, .. }) = &mut ops[to].kind {
        *start = from;
    }
}

/// Each loop by its first and last operation, with its number.
pub(super) fn loops(ops: &[Op]) -> Vec<(OpIndex, OpIndex, u8)> {
    let of = |(index, op): (OpIndex, &Op)| match &op.kind {
        OpKind::Statement(Statement::While { number, end, .. } | Statement::Do { number, end }) => {
            Some((index, *end, *number))
        }
        _ => None,
    };
    ops.iter().enumerate().filter_map(of).collect()
}

/// Sequence numbers in the order a search needs them.
pub(super) fn numbers(ops: &[Op]) -> Vec<(u32, OpIndex)> {
    let mut numbers: Vec<_> =
        ops.iter().enumerate().filter_map(|(index, op)| Some((op.number?, index))).collect();
    numbers.sort_unstable();
    numbers
}
