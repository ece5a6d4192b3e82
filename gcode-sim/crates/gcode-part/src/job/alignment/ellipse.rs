//! `[ellipse]` of an alignment job: the outline that an edge finder follows. The section and each of its keys
//! are optional.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{Chord, EllipsePath};
use crate::job::sections::in_range;
use crate::job::{FileError, JobControl, Reader, Surface};
use crate::reader::bounds::{Bounded, ChordError, KeyRange, PathFeed, Radius};

/// The outline in the plane z = 0 that an edge finder follows.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileEllipse {
    /// x of its start, mm [default: that of F].
    from: Option<Bounded<Radius>>,
    /// x of its end, mm [default: that of E].
    to: Option<Bounded<Radius>>,
    /// Tolerance of the ball position, mm: no less than the least increment [default: 0.002, or two
    /// increments].
    chord_error: Option<Bounded<ChordError>>,
    /// mm/min [default: 200].
    feed: Option<Bounded<PathFeed>>,
}

impl FileEllipse {
    pub(super) fn check(
        &self,
        reader: &Reader<'_>,
        control: JobControl,
        surface: Surface,
        chord: Chord,
    ) -> Result<EllipsePath, FileError> {
        let allowed = format!("0 to the equatorial radius a = {} mm", surface.a);
        let radius = |key: &str, value: &Option<Bounded<Radius>>, default: f64| match value {
            Some(value) => reader.number(key, value, &allowed, in_range(0.0, surface.a)),
            None => Ok(default),
        };
        let (increment, most) = (control.increment.size(), ChordError::MAX);
        let path = EllipsePath {
            from: radius("ellipse.from", &self.from, chord.f_radius)?,
            to: radius("ellipse.to", &self.to, chord.e_radius)?,
            chord_error: match &self.chord_error {
                Some(error) => {
                    let allowed = format!("{increment} (the least increment) to {most} mm");
                    reader.number("ellipse.chord_error", error, &allowed, in_range(increment, most))?
                }
                None => f64::max(0.002, 2.0 * increment),
            },
            feed: self.feed.as_ref().map_or(200.0, Bounded::get),
        };
        if path.from == path.to {
            let message = format!(
                "the ellipse begins and ends at x = {} mm: 'ellipse.from' and 'ellipse.to' (by default F and E) must differ",
                path.from
            );
            let line =
                [&self.to, &self.from].into_iter().flatten().next().map(|at| reader.line(at.span().start));
            return Err(FileError { line, message });
        }
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use crate::job::Job;

    /// Parses a job whose section `[ellipse]` has these lines.
    fn job(increment: &str, section: &str) -> Result<Job, String> {
        let text = format!(
            "family = \"alignment\"\n\
             control = {{ dialect = \"fanuc-31i\", increment = \"{increment}\" }}\n\
             machine = {{ rotary = {{ letter = \"B\", sign = 1 }} }}\n\
             surface = {{ kind = \"ellipsoid\", a = 1158.8, b = 724.3 }}\n\
             probe = {{ radius = 3.0 }}\n\
             sine_table = {{ length = 200.0, phi = 38.5, gauge_blocks = \"metric-87\" }}\n\
             chord = {{ e_radius = 812.4, f_radius = 318.0, circle = 1.0, candidates = 10 }}\n\
             runout = {{ heights = [150.0, 420.0], angles = [-25.0, 25.0, 11] }}\n\
             {section}"
        );
        Job::parse(&text).map_err(|error| error.to_string())
    }

    #[test]
    fn left_out_it_goes_from_f_to_e() {
        for (increment, chord_error) in [("IS-A", 0.02), ("IS-B", 0.002), ("IS-C", 0.002)] {
            let Ok(Job::Alignment(job)) = job(increment, "") else { panic!("no alignment") };
            let path = job.ellipse;
            assert_eq!((path.from, path.to, path.chord_error, path.feed), (318.0, 812.4, chord_error, 200.0));
        }
    }

    #[test]
    fn what_cannot_be_used_is_named_with_its_line() {
        for (section, message) in [
            ("from = -1", "line 10: key 'ellipse.from' is -1: 0 to the equatorial radius a = 1158.8 mm"),
            ("to = 1200", "line 10: key 'ellipse.to' is 1200: 0 to the equatorial radius a = 1158.8 mm"),
            (
                "chord_error = 0.0005",
                "line 10: key 'ellipse.chord_error' is 0.0005: 0.001 (the least increment) to 1 mm",
            ),
            ("feed = 0", "line 10: key 'ellipse.feed' is 0: 1 to 10000 mm/min"),
            ("speed = 1", "line 10: key 'ellipse.speed' is unknown; allowed: from, to, chord_error, feed"),
            (
                "to = 318",
                "line 10: the ellipse begins and ends at x = 318 mm: 'ellipse.from' and 'ellipse.to' (by default F and E) must differ",
            ),
        ] {
            assert_eq!(job("IS-B", &format!("[ellipse]\n{section}")).unwrap_err(), message);
        }
    }
}
