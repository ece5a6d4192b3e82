//! Names that every rule uses.
pub(crate) use gcode_lang::alarm::Alarm;
pub(crate) use gcode_lang::diag::{Diagnostic, Severity};
pub(crate) use gcode_lang::program::{OpIndex, OpKind};

pub(crate) use crate::context::{CheckContext, ProgramUnit, Role};
pub(crate) use crate::rule::Rule;
