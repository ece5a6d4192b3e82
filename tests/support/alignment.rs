//! The programs of an alignment on a part that stands somehow, and what they leave in the control.
use gcode_control::{Limits, Observer, Outcome};
use gcode_gen::check::Programs;
use gcode_gen::families;
use gcode_gen::package::Package;
use gcode_inspect::holes::HoleExtractor;
use gcode_inspect::machine::{Machine, Placement};
use gcode_lang::units::Deg;
use gcode_part::Surface;
use gcode_part::job::{Alignment, Job};
use gcode_session::{Request, Run, run_observed};

use crate::workspace;

/// A job's programs, which may have been edited at the machine.
#[derive(Clone)]
pub struct Bench {
    pub job: Alignment,
    pub package: Package,
    pub limits: Limits,
}

impl Bench {
    /// The programs of `examples/alignment` with some of the job's text changed.
    pub fn of(changes: &[(&str, &str)]) -> Self {
        let mut text = std::fs::read_to_string(workspace().join("examples/alignment/job.toml")).unwrap();
        for (from, to) in changes {
            assert!(text.contains(from), "{from} isn't in the job");
            text = text.replace(from, to);
        }
        let job = Job::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let package = families::emit(&job);
        let Job::Alignment(job) = job else { panic!("no alignment") };
        Self { job, package, limits: Limits::default() }
    }

    /// Another text in a program.
    pub fn edited(mut self, number: u32, from: &str, to: &str) -> Self {
        let program = self.package.programs.iter_mut().find(|program| program.number == number).unwrap();
        assert!(program.text.contains(from), "{from} isn't in O{number}");
        program.text = program.text.replace(from, to);
        self
    }

    /// More lines in the machine file.
    pub fn with_machine(mut self, lines: &str) -> Self {
        self.package.machine.push_str(lines);
        self
    }

    /// A main program on a part that stands so, with these variables in the control.
    pub fn run(&self, main: u32, part: &Placement, set: &[(u32, f64)]) -> Run {
        self.run_observed(main, part, set, &mut ())
    }

    /// The same with somebody who looks on from block to block.
    pub fn run_observed(
        &self,
        main: u32,
        part: &Placement,
        set: &[(u32, f64)],
        watcher: &mut impl Observer,
    ) -> Run {
        let machine = Machine { part: *part, ..Machine::parse(&self.package.machine).unwrap() };
        let text = self.package.program(main).unwrap().text.clone().into_bytes();
        let mut request = Request::new(format!("O{main}.nc"), text, machine);
        request.variables = set.to_vec();
        request.limits = self.limits;
        let surface = Surface::Ellipsoid { a: self.job.surface.a, b: self.job.surface.b };
        let mut probe = HoleExtractor::new(&request.machine).with_surface(Some(surface));
        run_observed(&request, &mut Programs(&self.package), &mut probe, watcher).unwrap()
    }
}

/// A part that is shifted (mm) and then tilted about x, y and z (degrees).
pub fn placement(shift: [f64; 3], tilt: [f64; 3]) -> Placement {
    Placement { shift: shift.into(), tilt: tilt.map(Deg), ..Placement::default() }
}

/// The number of the macro alarm that ended a run; `None` where it came to its end.
pub fn alarm(run: &Run) -> Option<u16> {
    match &run.outcome {
        Outcome::Alarm(stopped) => {
            let code = stopped.alarm.code();
            Some(code.raised.unwrap_or_else(|| panic!("{code}")))
        }
        Outcome::End => None,
        Outcome::Limit => panic!("it doesn't end"),
    }
}

pub fn vacant(run: &Run, number: u32) -> bool {
    run.control.variable(number).unwrap().is_vacant()
}

/// A variable, a vacant one as 0.
pub fn value(run: &Run, number: u32) -> f64 {
    run.control.variable(number).unwrap().number()
}

/// What stands in #500 to #599 at the end of a run, for the next one.
pub fn kept_variables(run: &Run) -> Vec<(u32, f64)> {
    (500..600).filter(|n| !vacant(run, *n)).map(|n| (n, value(run, n))).collect()
}

/// Candidates of marks as they are typed in, three variables each: the model's own E and F as the first of ten, the others beside
/// them.
pub fn marks() -> Vec<(u32, f64)> {
    let y = |x: f64, z: f64| 724.3 * (1.0 - (x * x + z * z) / (1158.8 * 1158.8)).sqrt();
    let points = [812.4, 318.0].into_iter().flat_map(|x| (0..10).map(move |n| (x, 0.09 * f64::from(n))));
    (501..).zip(points.flat_map(|(x, z)| [x, y(x, z), z])).collect()
}
