//! The order of work: by tool, then by radius and direction (one setting of the head), then by azimuth; or by setting, then by
//! tool.
use gcode_part::job::{AxisDirection, HoleSpec, PinHoles, Tool, WorkOrder};

/// One tool and the holes it makes.
#[derive(Debug)]
pub(crate) struct ToolPass<'j> {
    pub(crate) tool: &'j Tool,
    pub(crate) settings: Vec<HeadSetting<'j>>,
}

/// Holes that share a head angle and a height.
#[derive(Clone, Debug)]
pub(crate) struct HeadSetting<'j> {
    pub(crate) radius: f64,
    pub(crate) axis: AxisDirection,
    /// Holes in the order of their azimuths.
    pub(crate) holes: Vec<&'j HoleSpec>,
    /// True if the head has the angle from the setting before.
    pub(crate) is_head_set: bool,
}

impl HeadSetting<'_> {
    /// Returns true if both settings have one head angle: that of all axial holes is 90°.
    fn has_angle_of(&self, other: &Self) -> bool {
        self.axis == other.axis && (self.axis == AxisDirection::Axial || self.radius == other.radius)
    }
}

/// Returns the work of every tool that makes a hole, in the order of the job.
pub(crate) fn passes(job: &PinHoles) -> Vec<ToolPass<'_>> {
    match job.machine.order {
        WorkOrder::Tool => {
            let passes = job.tools.iter().map(|tool| ToolPass { tool, settings: settings(job, tool) });
            passes.filter(|pass| !pass.settings.is_empty()).collect()
        }
        WorkOrder::Head => by_head(job),
    }
}

/// Returns the settings of one tool, by radius, axial holes before those along normals.
fn settings<'j>(job: &'j PinHoles, tool: &Tool) -> Vec<HeadSetting<'j>> {
    let mut holes: Vec<&HoleSpec> =
        job.holes.iter().filter(|hole| hole.tools.contains(&tool.number)).collect();
    holes.sort_by(|one, other| {
        let direction = |hole: &HoleSpec| matches!(hole.axis, AxisDirection::Normal);
        one.radius
            .total_cmp(&other.radius)
            .then(direction(one).cmp(&direction(other)))
            .then(one.azimuth.total_cmp(&other.azimuth))
    });
    let mut settings: Vec<HeadSetting<'_>> = Vec::new();
    for hole in holes {
        match settings.last_mut() {
            Some(last) if last.radius == hole.radius && last.axis == hole.axis => last.holes.push(hole),
            _ => {
                let (radius, axis) = (hole.radius, hole.axis);
                settings.push(HeadSetting { radius, axis, holes: vec![hole], is_head_set: false });
            }
        }
    }
    settings
}

/// Returns the work by head angles: all tools at the first angle, then all at the next. All axial holes share one.
fn by_head(job: &PinHoles) -> Vec<ToolPass<'_>> {
    let work = job.tools.iter().flat_map(|tool| settings(job, tool).into_iter().map(move |one| (tool, one)));
    let mut work: Vec<_> = work.collect();
    // Stable: the tools at one angle keep their order, and so do the radii of axial holes.
    work.sort_by(|(_, one), (_, other)| {
        let angle = |setting: &HeadSetting<'_>| match setting.axis {
            AxisDirection::Axial => f64::NEG_INFINITY,
            AxisDirection::Normal => setting.radius,
        };
        angle(one).total_cmp(&angle(other))
    });
    let mut passes: Vec<ToolPass<'_>> = Vec::new();
    for (tool, setting) in work {
        let before = passes.last().and_then(|pass| pass.settings.last());
        let is_head_set = before.is_some_and(|before| setting.has_angle_of(before));
        let setting = HeadSetting { is_head_set, ..setting };
        match passes.last_mut() {
            Some(pass) if pass.tool.number == tool.number => pass.settings.push(setting),
            _ => passes.push(ToolPass { tool, settings: vec![setting] }),
        }
    }
    passes
}

#[cfg(test)]
mod tests {
    use gcode_part::job::Job;

    use super::*;

    /// Two axial holes and three along normals, each for the drill and the end mill; `order` is a line of `[machine]`.
    fn job(order: &str) -> PinHoles {
        let mut text = format!(
            "family = \"pin-holes\"\n[control]\ndialect = \"fanuc-31i\"\nincrement = \"IS-B\"\n[machine]\n\
             rotary = {{ letter = \"B\", sign = 1 }}\n{order}\n[surface]\nkind = \"ellipsoid\"\na = 500\nb = 300\n\
             [tolerance]\nposition = 0.1\n",
        );
        for (id, radius, azimuth, axis) in [
            ("a", 200, 90, "normal"),
            ("b", 100, 5, "normal"),
            ("c", 200, -90, "normal"),
            ("d", 200, 0, "axial"),
            ("e", 50, 0, "axial"),
        ] {
            text.push_str(&format!(
                "[[hole]]\nid = \"{id}\"\nradius = {radius}\nazimuth = {azimuth}\naxis = \"{axis}\"\ndiameter = 6\ndepth = 15\n"
            ));
        }
        match Job::parse(&text) {
            Ok(Job::PinHoles(job)) => job,
            other => panic!("no pin holes: {other:?}\n{text}"),
        }
    }

    /// Tool, then its settings; `=` before holes for which the head is set already.
    fn shown(job: &PinHoles) -> Vec<String> {
        let setting = |setting: &HeadSetting<'_>| {
            let ids: Vec<_> = setting.holes.iter().map(|hole| hole.id.as_str()).collect();
            format!("{}{}", if setting.is_head_set { "=" } else { "" }, ids.join(" "))
        };
        let pass = |pass: &ToolPass<'_>| {
            let settings: Vec<_> = pass.settings.iter().map(setting).collect();
            format!("T{}: {}", pass.tool.number, settings.join(" | "))
        };
        passes(job).iter().map(pass).collect()
    }

    #[test]
    fn holes_are_ordered_by_tool_then_setting_then_azimuth() {
        let expected = ["T1: e | b | d | c a", "T2: e | b | d | c a"];
        assert_eq!(shown(&job("")), expected);
        assert_eq!(shown(&job("order = \"tool\"")), expected);
    }

    /// The head is set three times instead of eight: for all axial holes, for radius 100, for radius 200. The second tool of a
    /// setting follows the first one at the same angle.
    #[test]
    fn one_setting_of_the_head_serves_all_tools() {
        let by_head = job("order = \"head\"");
        assert_eq!(shown(&by_head), ["T1: e | =d", "T2: =e | =d", "T1: b", "T2: =b", "T1: c a", "T2: =c a"]);
        let settings = |job: &PinHoles| {
            passes(job)
                .iter()
                .flat_map(|pass| pass.settings.iter().map(|one| one.is_head_set))
                .filter(|set| !set)
                .count()
        };
        assert_eq!((settings(&by_head), settings(&job(""))), (3, 8));
    }
}
