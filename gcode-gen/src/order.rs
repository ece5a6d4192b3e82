//! The order of work: by tool, then by radius and direction (one setting of the head), then by azimuth.
use gcode_part::job::{AxisDirection, HoleSpec, PinHoles, Tool};

/// One tool and the holes it makes.
#[derive(Debug)]
pub(crate) struct ToolPass<'j> {
    pub(crate) tool: &'j Tool,
    pub(crate) settings: Vec<HeadSetting<'j>>,
}

/// Holes that share a head angle and a height.
#[derive(Debug)]
pub(crate) struct HeadSetting<'j> {
    pub(crate) radius: f64,
    pub(crate) axis: AxisDirection,
    /// Holes in the order of their azimuths.
    pub(crate) holes: Vec<&'j HoleSpec>,
}

/// Returns every tool that makes a hole, in the order of the tool list.
pub(crate) fn passes(job: &PinHoles) -> Vec<ToolPass<'_>> {
    let mut holes: Vec<&HoleSpec> = job.holes.iter().collect();
    holes.sort_by(|one, other| {
        let direction = |hole: &HoleSpec| matches!(hole.axis, AxisDirection::Normal);
        one.radius
            .total_cmp(&other.radius)
            .then(direction(one).cmp(&direction(other)))
            .then(one.azimuth.total_cmp(&other.azimuth))
    });
    let of_tool = |tool: &'_ Tool| {
        let mut settings: Vec<HeadSetting<'_>> = Vec::new();
        for hole in holes.iter().copied().filter(|hole| hole.tools.contains(&tool.number)) {
            match settings.last_mut() {
                Some(last) if last.radius == hole.radius && last.axis == hole.axis => last.holes.push(hole),
                _ => settings.push(HeadSetting { radius: hole.radius, axis: hole.axis, holes: vec![hole] }),
            }
        }
        settings
    };
    let passes = job.tools.iter().map(|tool| ToolPass { tool, settings: of_tool(tool) });
    passes.filter(|pass| !pass.settings.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use gcode_part::job::Job;

    use super::*;

    #[test]
    fn holes_are_ordered_by_tool_then_setting_then_azimuth() {
        let mut text = String::from(
            "family = \"pin-holes\"\n[control]\ndialect = \"fanuc-31i\"\nincrement = \"IS-B\"\n[machine]\n\
             rotary = { letter = \"B\", sign = 1 }\n[surface]\nkind = \"ellipsoid\"\na = 500\nb = 300\n\
             [tolerance]\nposition = 0.1\n",
        );
        for (id, radius, azimuth, axis) in [
            ("a", 200, 90, "normal"),
            ("b", 100, 5, "normal"),
            ("c", 200, -90, "normal"),
            ("d", 200, 0, "axial"),
        ] {
            text.push_str(&format!(
                "[[hole]]\nid = \"{id}\"\nradius = {radius}\nazimuth = {azimuth}\naxis = \"{axis}\"\ndiameter = 6\ndepth = 15\n"
            ));
        }
        let Ok(Job::PinHoles(job)) = Job::parse(&text) else { panic!("no pin holes: {text}") };
        let shown: Vec<_> = passes(&job)
            .iter()
            .map(|pass| {
                let settings = pass.settings.iter().map(|setting| {
                    let ids: Vec<_> = setting.holes.iter().map(|hole| hole.id.as_str()).collect();
                    ids.join(" ")
                });
                format!("T{}: {}", pass.tool.number, settings.collect::<Vec<_>>().join(" | "))
            })
            .collect();
        assert_eq!(shown, ["T1: b | d | c a", "T2: b | d | c a"]);
    }
}
