//! What manuals rule out beside a mirror image, scaling or a rotation: reference returns, other coordinate systems, and
//! switching them out of their order, which is mirror, scale, rotate, and back the other way.
use super::modal_state::Modal;
use super::state::State;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::code_facts::CoordinateUse;
use gcode_lang::program::g_codes::{Effect, OneShot, spelled};
use gcode_lang::program::modes::{Mirror, Rotation, Scaling};

/// Holds a block's codes against what was in force before it; `state` has its modal codes, not yet its transform. G53
/// without an axis only waits.
pub(super) fn check(
    block_words: &BlockWords,
    before: &Modal,
    state: &State,
    names_axis: bool,
) -> Result<(), Alarm> {
    let modal = &state.modal;
    let is_rotated = before.rotation == Rotation::On && modal.rotation == Rotation::On;
    let is_mirrored = before.mirror == Mirror::On;
    let is_scaled = before.scaling == Scaling::On && modal.scaling == Scaling::On;
    let is_wait = |effect| effect == Effect::OneShot(OneShot::MachineSystem) && !names_axis;
    for row in block_words.g_codes().filter(|row| !is_wait(row.effect)) {
        let is_bound = row.facts.coordinates == CoordinateUse::NotTransformed;
        let active_code = match row.effect {
            _ if is_bound && is_rotated => "G68",
            _ if is_bound && is_mirrored => "G51.1",
            Effect::Mirror(Mirror::On) | Effect::Scaling(Scaling::On) if is_rotated => "G68",
            Effect::Mirror(Mirror::On) if is_scaled => "G51",
            Effect::Mirror(Mirror::Off) if is_mirrored && is_rotated => "G68",
            Effect::Mirror(Mirror::Off) if is_mirrored && is_scaled => "G51",
            Effect::Scaling(Scaling::Off) if before.scaling == Scaling::On && is_rotated => "G68",
            _ => continue,
        };
        let cancel_code = match active_code {
            "G68" => "G69",
            "G51" => "G50",
            _ => "G50.1",
        };
        let what =
            format!("G{} while {active_code} is on (command {cancel_code} before it)", spelled(row.code));
        return Err(Alarm::NotSimulated { what });
    }
    Ok(())
}
