//! Checkpoints of a control: all that decides how a run continues, without the lists that only grow.
use super::control::Control;
use super::executor::Executor;
use super::loop_detection::LoopDetector;
use super::outcome::{Outcome, RunLog};

/// State of a control between two blocks of its run.
///
/// Stops and printed lines stay in the control: a checkpoint holds their numbers alone.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    executor: Executor,
    loop_detector: LoopDetector,
    outcome: Option<Outcome>,
    stops: usize,
    printed: usize,
}

impl Control {
    /// Returns a checkpoint of the run.
    pub fn checkpoint(&self) -> Checkpoint {
        let Executor { registers, flow, log } = &self.executor;
        Checkpoint {
            executor: Executor { registers: registers.clone(), flow: flow.clone(), log: log.without_lists() },
            loop_detector: self.loop_detector.clone(),
            outcome: self.outcome().cloned(),
            stops: log.stops.len(),
            printed: log.printed.len(),
        }
    }

    /// Goes back to a checkpoint of this run. Programs loaded since stay in memory.
    pub fn restore(&mut self, checkpoint: &Checkpoint) {
        let RunLog { mut stops, mut printed, .. } = std::mem::take(&mut self.executor.log);
        stops.truncate(checkpoint.stops);
        printed.truncate(checkpoint.printed);
        self.executor = checkpoint.executor.clone();
        self.executor.log.stops = stops;
        self.executor.log.printed = printed;
        self.loop_detector = checkpoint.loop_detector.clone();
        self.set_outcome(checkpoint.outcome.clone());
    }
}

#[cfg(test)]
mod tests {
    use crate::{Control, Outcome, Value};
    use gcode_lang::control::Settings;
    use gcode_lang::program::{Memory, NoLibrary};

    fn control(text: &str) -> Control {
        let mut memory = Memory::default();
        memory.load("O1.nc", text.as_bytes().to_vec());
        Control::new(memory, Settings::default())
    }

    /// Variables, position, printed lines, stops and blocks.
    fn shown(control: &Control) -> String {
        let variables: Vec<_> = control.variables().collect();
        let (output, stops) = (control.output(), control.stops());
        format!("{variables:?} {:?} {output:?} {stops:?} {}", control.machine_position(), control.blocks())
    }

    #[test]
    fn a_run_continues_from_a_checkpoint_as_it_did_before() {
        let text = "O1\n#1=0\nWHILE[#1 LT 9]DO1\n#1=#1+1\nG65 P2 A#1\nM00\nEND1\nM30\nO2\n#100=#1\nG91 G0 X#1\nDPRNT[V#1[20]]\nM99\n";
        let mut control = control(text);
        let (mut checkpoints, mut states) = (Vec::new(), Vec::new());
        loop {
            checkpoints.push(control.checkpoint());
            states.push(shown(&control));
            if control.step(&mut NoLibrary, &mut ()).is_some() {
                break;
            }
        }
        // 1 + 9 times (WHILE, #1, G65, 4 in O2, M00, END) + the last WHILE + M30.
        assert_eq!(states.len(), 1 + 9 * 9 + 2);
        for (index, checkpoint) in checkpoints.iter().enumerate().rev() {
            control.restore(checkpoint);
            assert!(control.outcome().is_none());
            assert_eq!(shown(&control), states[index], "block {index}");
        }
        assert!(!states.iter().skip(1).any(|state| *state == states[0]));
        while control.step(&mut NoLibrary, &mut ()).is_none() {}
        assert!(matches!(control.outcome(), Some(Outcome::End)));
        assert_eq!(control.variable(100), Ok(Value::Number(9.0)));
        assert_eq!((control.stops().len(), control.output().len()), (9, 9));
    }
}
