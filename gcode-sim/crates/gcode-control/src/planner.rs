//! Makes the plan of a block of words. A planner only reads the control: a block that alarms has changed nothing.
use super::data::ControlData;
use super::flow::ProgramFlow;
use super::registers::Registers;

/// The control as the planning of a block sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planner<'a> {
    pub(super) registers: &'a Registers,
    /// Of the registers, what most of the planning needs.
    pub(super) data: &'a ControlData,
    pub(super) flow: &'a ProgramFlow,
}
