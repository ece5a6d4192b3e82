//! The modal state: one typed field per group, so that it cannot contradict itself; `Default` is power-on.
use gcode_lang::program::cycles::Cycle;
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::{
    CutterSide, CuttingMode, Distance, FeedMode, Length, Mirror, ModalCall, Motion, Plane, Polar, ReturnTo,
    Rotation, Scaling, SpindleMode, StrokeCheck, Unit, WorkSystem,
};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Modal {
    pub motion: Motion,
    pub plane: Plane,
    pub distance: Distance,
    pub stroke_check: StrokeCheck,
    pub feed_mode: FeedMode,
    pub unit: Unit,
    pub cutter: CutterSide,
    pub length: Length,
    /// `None` is G80.
    pub cycle: Option<&'static Cycle>,
    pub return_to: ReturnTo,
    pub scaling: Scaling,
    pub call: ModalCall,
    pub spindle_mode: SpindleMode,
    pub work: WorkSystem,
    pub cutting: CuttingMode,
    pub rotation: Rotation,
    pub polar: Polar,
    pub mirror: Mirror,
}

impl Modal {
    /// Puts a modal code in force. One-shot codes and those with words of their own are the block's business.
    pub(super) fn apply(&mut self, row: &GCodeRow) {
        match row.effect {
            Effect::Plane(plane) => self.plane = plane,
            Effect::Distance(distance) => self.distance = distance,
            Effect::StrokeCheck(check) => self.stroke_check = check,
            Effect::FeedMode(mode) => self.feed_mode = mode,
            Effect::Unit(unit) => self.unit = unit,
            Effect::Cutter(side) => self.cutter = side,
            Effect::Length(length) => self.length = length,
            Effect::Cycle(cycle) => self.cycle = cycle,
            Effect::ReturnTo(to) => self.return_to = to,
            Effect::Scaling(scaling) => self.scaling = scaling,
            Effect::SpindleMode(mode) => self.spindle_mode = mode,
            Effect::Work(number) => self.work = WorkSystem::Standard(number),
            Effect::Cutting(mode) => self.cutting = mode,
            Effect::Rotation(rotation) => self.rotation = rotation,
            Effect::Polar(polar) => self.polar = polar,
            Effect::Mirror(mirror) => self.mirror = mirror,
            Effect::NumberedWork(number) => self.work = WorkSystem::Additional(number),
            // See [`State::set_motion_mode`](super::State).
            Effect::Motion(_)
            | Effect::AdditionalWork
            | Effect::OneShot(_)
            | Effect::NoEffect
            | Effect::LookAhead
            | Effect::Smoothness
            | Effect::Call
            | Effect::NotSimulated => {}
        }
    }

    /// The G code × 10 in force in a group, as #4001… shows it.
    pub fn code(&self, group: u32) -> Option<u32> {
        Some(match group {
            1 => self.motion.code(),
            2 => self.plane.code(),
            3 => self.distance.code(),
            4 => self.stroke_check.code(),
            5 => self.feed_mode.code(),
            6 => self.unit.code(),
            7 => self.cutter.code(),
            8 => self.length.code(),
            9 => self.cycle.map_or(800, |cycle| cycle.code),
            10 => self.return_to.code(),
            11 => self.scaling.code(),
            12 => self.call.code(),
            13 => self.spindle_mode.code(),
            14 => self.work.code(),
            15 => self.cutting.code(),
            16 => self.rotation.code(),
            17 => self.polar.code(),
            18 | 19 => 401,
            // In-feed control and polar interpolation are always off.
            20 => 1600,
            21 => 131,
            22 => self.mirror.code(),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_on_is_the_safe_line_of_every_manual() {
        let modal = Modal::default();
        let codes: Vec<_> = (1..=17).filter_map(|group| modal.code(group)).collect();
        assert_eq!(
            codes,
            [0, 170, 900, 220, 940, 210, 400, 490, 800, 980, 500, 670, 970, 540, 640, 690, 150]
        );
    }
}
