//! The programs of a job on their control: edited, on a misplaced part, with variables set, and what a run leaves behind.
use gcode_control::{Control, Limits, Observer, Outcome};
use gcode_gen::check::Programs;
use gcode_gen::families;
use gcode_gen::package::{Package, Program, file_name};
use gcode_inspect::holes::HoleExtractor;
use gcode_inspect::machine::{Machine, Placement};
use gcode_lang::motion::EventSink;
use gcode_lang::units::Deg;
use gcode_part::Surface;
use gcode_part::job::Job;
use gcode_session::{Request, Run, run_observed};

use crate::{edited, workspace};

/// A job with the programs it becomes.
#[derive(Clone)]
pub struct Bench {
    pub job: Job,
    pub package: Package,
    pub limits: Limits,
}

impl Bench {
    /// The programs of a job file's text.
    pub fn of(job: &str) -> Self {
        let job = Job::parse(job).unwrap_or_else(|error| panic!("{error}\n{job}"));
        Self { package: families::emit(&job), job, limits: Limits::default() }
    }

    /// The programs of `examples/<name>` with edits `A => B` of the job.
    pub fn example(name: &str, edits: &[&str]) -> Self {
        Self::of(&edits.iter().fold(example(name), |job, edit| edited(&job, edit)))
    }

    /// Applies `A => B` to a program.
    #[must_use]
    pub fn edited(mut self, number: u32, edit: &str) -> Self {
        let program = self.package.programs.iter_mut().find(|program| program.number == number).unwrap();
        program.text = edited(&program.text, edit);
        self
    }

    /// Adds a main program of these blocks.
    #[must_use]
    pub fn with_main(mut self, number: u32, blocks: &str) -> Self {
        self.package.programs.push(Program { number, text: format!("O{number}\n{blocks}\nM30\n") });
        self
    }

    /// Adds lines to the machine file.
    #[must_use]
    pub fn with_machine(mut self, lines: &str) -> Self {
        self.package.machine.push_str(lines);
        self
    }

    pub fn machine(&self) -> Machine {
        Machine::parse(&self.package.machine).unwrap()
    }

    /// A run of one of the main programs.
    pub fn request(&self, main: u32) -> Request {
        let text = self.package.program(main).unwrap().text.as_bytes();
        Request { limits: self.limits, ..Request::new(file_name(main), text, self.machine()) }
    }

    /// Runs a main program on a misplaced part with variables set.
    pub fn run(&self, main: u32, part: &Placement, set: &[(u32, f64)]) -> Run {
        self.run_observed(main, part, set, &mut (), &mut ())
    }

    /// Runs a main program on a part in its place and emits the machine's events to `sink`.
    pub fn run_to(&self, main: u32, sink: &mut impl EventSink) -> Run {
        self.run_observed(main, &Placement::default(), &[], sink, &mut ())
    }

    /// Runs a main program on a misplaced part, with a sink and an observer.
    pub fn run_observed(
        &self,
        main: u32,
        part: &Placement,
        set: &[(u32, f64)],
        sink: &mut impl EventSink,
        observer: &mut impl Observer,
    ) -> Run {
        let mut request = self.request(main);
        request.machine.part = *part;
        request.variables = set.to_vec();
        let surface = match &self.job {
            Job::Alignment(job) => Some(Surface::Ellipsoid { a: job.surface.a, b: job.surface.b }),
            _ => None,
        };
        let mut probe = HoleExtractor::new(&request.machine).with_surface(surface);
        run_observed(&request, &mut Programs(&self.package), &mut (&mut probe, sink), observer).unwrap()
    }
}

/// The job file of an example.
pub fn example(name: &str) -> String {
    std::fs::read_to_string(workspace().join("examples").join(name).join("job.toml")).unwrap()
}

/// A part that is shifted (mm) and then tilted about x, y and z (degrees).
pub fn placement(shift: [f64; 3], tilt: [f64; 3]) -> Placement {
    Placement { shift: shift.into(), tilt: tilt.map(Deg), ..Placement::default() }
}

/// The number of the macro alarm that ended a run; `None` at the end of the program.
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

/// The variables #500 to #599 at the end of a run, for the next one.
pub fn kept_variables(control: &Control) -> Vec<(u32, f64)> {
    control.variables().filter(|(number, _)| (500..600).contains(number)).collect()
}

/// Candidates of marks as they are typed in, three variables each: the model's own E and F as the first of ten, the
/// others beside them.
pub fn marks() -> Vec<(u32, f64)> {
    let y = |x: f64, z: f64| 724.3 * (1.0 - (x * x + z * z) / (1158.8 * 1158.8)).sqrt();
    let points = [812.4, 318.0].into_iter().flat_map(|x| (0..10).map(move |n| (x, 0.09 * f64::from(n))));
    (501..).zip(points.flat_map(|(x, z)| [x, y(x, z), z])).collect()
}
