//! The verdict on flutes: the largest deviations, the helix angles by both laws, and the findings.
use schemars::JsonSchema;
use serde::Serialize;

use super::Inspection;
use super::measured_range::SPEED_TOLERANCE;
use crate::findings::{
    BURR_OFFSET, FLUTE_END, FLUTE_EXTRA, FLUTE_HEAD, FLUTE_HELIX, FLUTE_INDEX, FLUTE_MISSING, FLUTE_SPEED,
    FLUTE_SURFACE, FLUTE_TWICE, FLUTES_MEET, SPINDLE_STOPPED, START_UNKNOWN, WHEEL_FEED, WHEEL_INTO_BURR,
    WHEEL_SPEED,
};
use crate::flutes::{GrindingResult, Window};
use crate::verify::completion::{AnyVerdict, VerdictParts};
use crate::verify::conclusion::{Answer, Conclusion, Ending, SummaryWords, stop_sentence};
use crate::verify::verdict_finding::{Finding, finding_of, limit_per_kind};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};
use gcode_lang::source::Span;
use gcode_lang::units::Deg;
use gcode_part::job::FluteLaw;
use gcode_part::{Assumption, Flutes, Total};

/// The result of `verify --format json`. Lengths in mm, angles in degrees; nothing is rounded.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FluteVerdict {
    /// The kind of the numbers.
    pub basis: &'static str,
    /// The answer.
    pub verdict: Answer,
    /// The end of the run.
    pub outcome: Ending,
    /// The reasons for the answer in one line.
    pub summary: String,
    /// Findings about the program's text that probably explain the answer, one sentence each.
    pub likely_causes: Vec<String>,
    /// Law of the helix angle in the job.
    pub law: &'static str,
    /// Number of flutes ground; repeated passes over a flute do not count.
    pub flutes: usize,
    /// Number of flutes in the job.
    #[serde(rename = "wanted_flutes")]
    pub nominal_flutes: usize,
    /// The largest distance of the contact from the tooth bottom, between the points too; null without a flute.
    pub surface_deviation: Option<f64>,
    /// Its tolerance: the job's chord error, or that of the command line.
    pub tolerance: f64,
    /// Least helix angle; null without a flute.
    pub helix_min: Option<f64>,
    /// Largest helix angle; null without a flute.
    pub helix_max: Option<f64>,
    /// Nominal angle on the cylinder, by the job's law.
    pub helix: f64,
    /// The largest deviation from the job's law.
    pub helix_error: Option<f64>,
    /// Tolerance of the helix angle, either way.
    pub helix_tolerance: f64,
    /// The length over which a helix angle is measured.
    pub gauge: f64,
    /// The largest deviation of a gap between neighbours from the nominal one.
    pub index_error: Option<f64>,
    /// Tolerance of a gap, either way.
    pub index_tolerance: f64,
    /// Least speed of the contact along the flutes, mm/min, over a gauge length.
    pub speed_min: Option<f64>,
    /// The largest of these speeds.
    pub speed_max: Option<f64>,
    /// The speed that the job specifies, if it does.
    pub speed: Option<f64>,
    /// Tolerance of the speed, either way, as a fraction.
    pub speed_tolerance: f64,
    /// The least distance between the paths of neighbours, in a straight line.
    pub nearest: Option<f64>,
    /// Number of grinding passes.
    pub passes: usize,
    /// Grinding moves of all passes.
    pub moves: usize,
    /// Always empty for a burr.
    pub holes: [(); 0],
    /// Helix angles along a flute.
    pub laws: Vec<LawAngles>,
    /// All findings.
    pub findings: Vec<Finding>,
    /// Sentences on what the verdict does not cover.
    pub not_checked: Vec<String>,
    /// Values that the run read and nothing in the program set, and the passes that each can touch, counted from 1.
    pub assumptions: Vec<Assumption>,
    /// The words of the summary.
    #[serde(skip)]
    pub words: SummaryWords,
    /// Helix angle along the flute with the largest error.
    #[serde(skip)]
    pub helix_course: Vec<HelixSample>,
    /// The pass of that flute, counted from 1.
    #[serde(skip)]
    pub course_pass: usize,
    /// Least permitted distance of neighbours: twice the chord error.
    #[serde(skip)]
    pub min_nearest: f64,
    /// The findings with their locations, for printing.
    #[serde(skip)]
    pub diagnostics: Vec<Diagnostic>,
}

/// The helix angle at one polar angle: measured, and by both laws.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Law")]
pub struct LawAngles {
    /// Polar angle of the surface normal.
    #[serde(rename = "theta")]
    pub polar: f64,
    /// On the flute with the largest deviation from the law; null where it is not measured.
    pub measured: Option<f64>,
    /// By the law of constant helix angle.
    pub constant_helix: f64,
    /// By the published law.
    pub published: f64,
}

/// The result of `reference` for a burr: the nominal flutes, without a program.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct NominalFlutes {
    /// Unit of all lengths.
    pub unit: &'static str,
    /// Always empty for a burr.
    pub holes: [(); 0],
    /// Number of flutes.
    pub flutes: u32,
    /// Law of the helix angle in the job.
    pub law: &'static str,
    /// Start of the flutes from the end of the cylinder.
    pub start: f64,
    /// Position of the pole along the axis.
    pub pole: f64,
    /// Polar angle at which flutes end, degrees.
    pub tip_angle: f64,
    /// Helix angles along a flute.
    pub laws: Vec<LawAngles>,
}

impl FluteVerdict {
    /// Returns the value from which every output states the verdict.
    pub fn conclusion(&self) -> Conclusion<'_> {
        Conclusion { answer: self.verdict, ending: self.outcome, summary: &self.summary }
    }
}

impl AnyVerdict for FluteVerdict {
    fn parts(&mut self) -> VerdictParts<'_> {
        VerdictParts {
            total: Total::Flutes(self.passes),
            answer: &mut self.verdict,
            summary: &mut self.summary,
            words: &mut self.words,
            likely_causes: &mut self.likely_causes,
            findings: &mut self.findings,
            diagnostics: &mut self.diagnostics,
            assumptions: &mut self.assumptions,
        }
    }
}

/// Returns the number of flutes and the kinds of errors in one line.
fn flute_counts(flutes: usize, nominal: usize, findings: &[Diagnostic]) -> String {
    let mut text = match flutes <= nominal {
        true => format!("{flutes} of {nominal} flutes ground"),
        false => format!("{flutes} flutes ground, {nominal} specified"),
    };
    let mut mentioned: Vec<&str> = Vec::new();
    for finding in findings.iter().filter(|finding| finding.severity == Severity::Error) {
        let words = describe_kind(finding.kind).unwrap_or(finding.kind.title);
        // The numbers show missing and extra flutes.
        let is_counted = [&FLUTE_MISSING, &FLUTE_EXTRA].contains(&finding.kind);
        if !is_counted && !mentioned.contains(&words) {
            mentioned.push(words);
            text.push_str(", ");
            text.push_str(words);
        }
    }
    text
}

/// Short descriptions of findings about flutes.
const SHORT: [(&FindingKind, &str); 16] = [
    (&START_UNKNOWN, "an axis at an unknown position"),
    (&FLUTE_MISSING, "a flute is missing"),
    (&FLUTE_EXTRA, "an extra flute"),
    (&FLUTE_TWICE, "a flute is ground twice"),
    (&FLUTE_SURFACE, "contact off the tooth bottom"),
    (&FLUTE_HELIX, "helix angle out of tolerance"),
    (&FLUTE_INDEX, "spacing out of tolerance"),
    (&FLUTE_END, "an end out of position"),
    (&FLUTE_HEAD, "head angle out of tolerance"),
    (&FLUTE_SPEED, "speed out of tolerance"),
    (&WHEEL_SPEED, "wheel speed out of tolerance"),
    (&WHEEL_FEED, "feed into the blank out of tolerance"),
    (&BURR_OFFSET, "the burr's position differs from the job's"),
    (&SPINDLE_STOPPED, "the wheel is stopped"),
    (&FLUTES_MEET, "neighbours overlap"),
    (&WHEEL_INTO_BURR, "the wheel enters the burr"),
];

/// Returns a short description of a finding about flutes; `None` for other findings.
pub fn describe_kind(kind: &FindingKind) -> Option<&'static str> {
    SHORT.iter().find(|(known, _)| *known == kind).map(|(_, words)| *words)
}

impl NominalFlutes {
    /// Returns the document of the nominal flutes.
    pub fn of(nominal: &Flutes) -> Self {
        Self {
            unit: "mm",
            holes: [],
            flutes: nominal.count,
            law: nominal.law.name(),
            start: nominal.start,
            pole: nominal.profile.pole(),
            tip_angle: nominal.tip_angle.0,
            laws: law_table(nominal, &[]),
        }
    }
}

/// A measured helix angle.
#[derive(Clone, Copy, Debug)]
pub struct HelixSample {
    /// Polar angle of the surface normal.
    pub polar: Deg,
    /// Helix angle there.
    pub helix: Deg,
}

/// The polar angles of the table; the tip angle comes last.
const TABLE_ANGLES: [f64; 9] = [90.0, 75.0, 60.0, 45.0, 30.0, 20.0, 15.0, 10.0, 5.0];

/// Makes the verdict of the findings.
pub(super) fn verdict(
    inspection: &Inspection<'_>,
    findings: Vec<Diagnostic>,
    locate: &dyn Fn(Span) -> (String, u32),
) -> FluteVerdict {
    let (nominal, actual, worst) = (inspection.nominal, inspection.actual, inspection.worst_helix());
    let (helix, speed) = (inspection.helix.as_ref(), inspection.speed.as_ref());
    let samples = actual.passes.iter().flat_map(|pass| &pass.trace.samples);
    let flutes = inspection.spacing.flutes.len();
    let counts = flute_counts(flutes, nominal.count as usize, &findings);
    let words =
        SummaryWords { stop: stop_sentence(findings.iter(), locate), counts, ..SummaryWords::default() };
    let gauge = nominal.gauge;
    let worst_pass = worst.map_or(0, |worst| worst.pass);
    let along: Vec<HelixSample> = actual.passes.get(worst_pass).map_or(Vec::new(), |pass| {
        let angles = |window: Window<'_>| HelixSample { polar: window.middle.polar, helix: window.helix };
        pass.trace.windows(gauge).map(angles).collect()
    });
    let mut verdict = FluteVerdict {
        basis: "predicted by simulation, not measured",
        verdict: Answer::to(findings.iter()),
        outcome: Ending::of(findings.iter()),
        summary: String::new(),
        words,
        likely_causes: Vec::new(),
        law: nominal.law.name(),
        flutes,
        nominal_flutes: nominal.count as usize,
        surface_deviation: samples.map(|s| s.deviation.abs()).reduce(f64::max),
        tolerance: nominal.surface_tolerance,
        helix_min: helix.map(|range| range.min),
        helix_max: helix.map(|range| range.max),
        helix: nominal.helix.0,
        helix_error: worst.map(|worst| worst.error),
        helix_tolerance: nominal.helix_tolerance.0,
        gauge,
        index_error: inspection.spacing.worst_gap.map(|gap| gap.error.0),
        index_tolerance: nominal.index_tolerance.0,
        speed_min: speed.map(|range| range.min),
        speed_max: speed.map(|range| range.max),
        speed: nominal.speed,
        speed_tolerance: SPEED_TOLERANCE,
        nearest: inspection.spacing.nearest_approach.map(|near| near.distance),
        passes: actual.passes.len(),
        moves: actual.passes.iter().map(|pass| pass.moves).sum(),
        holes: [],
        laws: law_table(nominal, &along),
        findings: findings.iter().map(|finding| finding_of(finding, None, false, locate)).collect(),
        not_checked: not_checked(nominal, actual, locate),
        helix_course: along,
        course_pass: worst_pass + 1,
        min_nearest: 2.0 * nominal.chord_error,
        assumptions: Vec::new(),
        diagnostics: limit_per_kind(findings.into_iter()),
    };
    verdict.parts().update_summary();
    verdict
}

/// Returns sentences on what the verdict does not cover.
fn not_checked(
    nominal: &Flutes,
    actual: &GrindingResult,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Vec<String> {
    let mut all = vec![
        "the wheel's width, form and body: it is simulated as one point, so gouging of a neighbouring \
         tooth next to the contact is unknown"
            .to_owned(),
        "the direction of the wheel's swivel B: only its angle is compared with the helix angle".to_owned(),
        "the wheel's direction of rotation: the job does not give it".to_owned(),
    ];
    let conditions = [
        (nominal.speed.is_none(), "the speed along the flutes: the job has no program.speed"),
        (nominal.wheel.is_none(), "the wheel's spindle speed: the job has no program.wheel"),
        (nominal.plunge.is_none(), "the wheel's feed into the blank: the job has no program.plunge"),
        (
            nominal.clearance.is_none(),
            "the distance from the blank where rapid motion ends, except for contact: the job has no \
             machine.clearance",
        ),
        (actual.offset.is_none(), "the job's c_offset: the machine file has no axis C that rotates about z"),
    ];
    all.extend(conditions.iter().filter(|(lacks, _)| *lacks).map(|(_, sentence)| (*sentence).to_owned()));
    let unchecked = actual.unchecked_rapids;
    if 0 < unchecked {
        let moves = if unchecked == 1 { "1 move" } else { &format!("{unchecked} moves") };
        all.push(format!(
            "rapid motion up to where the wheel is first clear of the blank ({moves}): the axes' start \
             position is unknown"
        ));
    }
    let unknown = actual.unknown_rapids.as_ref();
    all.extend(unknown.map(|unknown| {
        let (what, reason) = unknown.describe(locate(unknown.backtrace.block));
        format!("{what}: {reason}")
    }));
    all
}

/// Returns the table of the laws, with the measured angles.
fn law_table(nominal: &Flutes, along: &[HelixSample]) -> Vec<LawAngles> {
    let tip = nominal.tip_angle.0;
    let all = TABLE_ANGLES.into_iter().filter(|polar| tip < *polar).chain([tip]);
    let at = |theta: f64| {
        let near = |one: &&HelixSample, other: &&HelixSample| {
            (one.polar.0 - theta).abs().total_cmp(&(other.polar.0 - theta).abs())
        };
        // The last window is half a gauge length before the end of the flute.
        let nearest = along.iter().min_by(near).filter(|angles| (angles.polar.0 - theta).abs() < 2.5);
        LawAngles {
            polar: theta,
            measured: nearest.map(|angles| angles.helix.0),
            constant_helix: nominal.helix_angle(FluteLaw::ConstantHelix, Deg(theta)).0,
            published: nominal.helix_angle(FluteLaw::Published, Deg(theta)).0,
        }
    };
    all.map(at).collect()
}
