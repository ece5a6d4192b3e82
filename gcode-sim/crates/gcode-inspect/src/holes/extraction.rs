//! Result of following a run: its holes, the findings about its motion, and what was not compared.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};

use super::clearance::CloseMotion;
use super::cone_end::AssumedCone;
use super::{
    CutConditions, DrilledHole, LengthMismatch, Search, UnjudgedMotions, UnknownRapids, UnsearchedMotions,
};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_lang::source::Span;
use gcode_part::{HoleList, ProcessLimits, Unit};

/// A bore made backwards.
#[derive(Clone, Debug)]
pub(crate) struct BackBored {
    /// Deepest point of the tip.
    pub end: Point3<f64>,
    /// Direction in which the bore is open.
    pub out: Vector3<f64>,
    pub backtrace: Backtrace,
}

/// A stroke of a drilling cycle that cuts nothing of the known part.
#[derive(Clone, Debug)]
pub struct AirStroke {
    /// Where its feed begins.
    pub start: Point3<f64>,
    /// Its deepest point.
    pub bottom: Point3<f64>,
    /// Direction back to the start.
    pub out: Vector3<f64>,
    /// The tool.
    pub tool: Option<u32>,
    /// Its block.
    pub block: Span,
}

/// Holes that a program drills, and findings about the motion of the tool.
#[derive(Clone, Debug, Default)]
pub struct HoleExtraction {
    /// Holes, in the order in which they are begun.
    pub holes: Vec<DrilledHole>,
    /// Findings about motion.
    pub findings: Vec<Diagnostic>,
    /// Motion near the part; empty if the part's surface is unknown.
    pub(crate) close_motions: Vec<CloseMotion>,
    /// Conditions of all cuts.
    pub(crate) cut_conditions: Vec<CutConditions>,
    /// Feeds of tools whose length differs from their length offset.
    pub(crate) length_mismatches: Vec<LengthMismatch>,
    /// Tools that have had a length offset, cutting or not.
    pub(crate) offset_tools: BTreeSet<Option<u32>>,
    /// H numbers of the tool lengths that the program sets, without 0.
    pub program_lengths: BTreeSet<u32>,
    /// H of tools touched off that the program sets to another length than the machine file: the number, the program's length and
    /// that of the file, mm.
    pub reset_lengths: Vec<(u32, f64, f64)>,
    /// Called programs that do nothing here: stubs of M99 alone, as `O9811`.
    pub called_stubs: Vec<String>,
    /// Rapids whose path over the part is unknown; `None` if there are none.
    pub(crate) unknown_rapids: Option<UnknownRapids>,
    /// Rotary axes of the default machine that the program never commands, as bits; they count as 0.
    pub(crate) assumed_axes: u8,
    /// Limits with which the motion was compared.
    pub(crate) process_limits: ProcessLimits,
    /// The stock or the surface is known, and all motion was compared with it.
    pub(crate) is_metal_known: bool,
    /// Motions whose searches for metal have been given up.
    pub(crate) unsearched: BTreeMap<Search, UnsearchedMotions>,
    pub(crate) unjudged: UnjudgedMotions,
    /// Rapids that are free only if the tool change before them retracts the tool.
    pub(crate) rapids_behind_change: UnsearchedMotions,
    /// Tools of unknown diameter that mill a known body: what they remove is unknown.
    pub(crate) unsized_mills: Vec<Option<u32>>,
    /// Tools of unknown end that count as cones.
    pub(crate) assumed_cones: BTreeMap<u32, AssumedCone>,
    /// Indices of the nominal holes whose entries are under metal that no feed removes.
    pub(crate) covered_entries: Vec<usize>,
    /// Number of strokes of mills that count as milling.
    pub(crate) milled_strokes: u64,
    /// Pockets are stated, and no block mills any of them.
    pub(crate) has_unmilled_pockets: bool,
    /// First and last block of each run of blocks that mill stated pockets.
    pub(crate) milled_blocks: Vec<[Span; 2]>,
    /// Ends of the first feeds along the tool that go beside the part.
    pub(crate) feeds_in_air: Vec<(Point3<f64>, Backtrace)>,
    pub(crate) back_bored: Vec<BackBored>,
    /// Warnings about drilling cycles that cut nothing.
    pub(crate) cycles_in_air: Vec<Diagnostic>,
    /// Number of their strokes.
    pub(crate) strokes_in_air: u64,
    /// Those of them whose places are known, the first ones.
    pub air_strokes: Vec<AirStroke>,
    /// Feeds were too many for their metal to be followed.
    pub(crate) is_removal_cut_short: bool,
}

impl HoleExtraction {
    /// Returns the number of strokes of drilling cycles that cut nothing.
    pub fn strokes_in_air(&self) -> u64 {
        self.strokes_in_air
    }

    /// Returns the holes as a list; `locate` returns the program and the line of a block.
    pub fn list(&self, locate: impl Fn(Span) -> (String, u32)) -> HoleList {
        let holes = self.holes.iter().map(|hole| hole.hole(&locate)).collect();
        HoleList { unit: Unit::Mm, holes, stock: None, assumptions: None, stopped: None }
    }
}
