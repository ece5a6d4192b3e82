//! Contact of a touch probe: where its ball touches the part, and when the control latches the position.
use super::path::AxisMotion;
use super::random::RandomStream;
use super::{Machine, Probe, Setup};
use gcode_lang::motion::{SkipMove, SkipSignal};
use gcode_part::PartSolid;

/// Largest deviation of the ball's path from its chords, mm.
pub(crate) const BALL_CHORD_TOLERANCE: f64 = 1e-5;

impl Machine {
    /// Returns the result of G31 with this probe; `touches` is the number of earlier touches of the run, each
    /// with its own noise.
    pub fn probe(
        &self,
        probe: &Probe,
        feed: &SkipMove<'_>,
        setup: &Setup,
        part: &PartSolid,
        touches: u64,
    ) -> SkipSignal {
        let travel = AxisMotion { from: feed.from, to: feed.to, arc: None };
        let Some(contact) = self.touch(&travel, setup, part, probe.radius) else {
            return SkipSignal::Missed;
        };
        let (seconds, length) = (feed.seconds.0, feed.rate.0 / 60.0 * feed.seconds.0);
        let noise = probe.noise.sample(RandomStream::new(probe.seed).branch(touches));
        let late = if seconds > 0.0 { probe.delay.0 / seconds + noise / length } else { 0.0 };
        let latched = (contact + late).max(0.0);
        let over = if seconds > 0.0 { probe.overrun.0 / seconds } else { 0.0 };
        let stopped = (latched + over).min(1.0);
        let tip = self.forward(&travel.position(stopped), setup).tip;
        let (deflection, overtravel_limit) =
            (probe.radius - part.nearest(&tip).distance, probe.overtravel_limit);
        match () {
            () if deflection > overtravel_limit => {
                SkipSignal::StylusBroken { stopped, deflection, overtravel_limit }
            }
            // A signal after the end of the block skips nothing.
            () if latched > 1.0 => SkipSignal::Missed,
            () => SkipSignal::Received { latched, stop_fraction: stopped },
        }
    }

    /// Returns the fraction of a motion, 0 to 1, at which a ball round the tool's tip touches the part.
    ///
    /// 0 if the ball is inside at the start, `None` if it does not touch. The path is cut into chords short
    /// enough to replace the curve.
    pub fn touch(
        &self,
        travel: &AxisMotion<'_>,
        setup: &Setup,
        part: &PartSolid,
        radius: f64,
    ) -> Option<f64> {
        let tip = |part: f64| self.forward(&travel.position(part), setup).tip;
        let mut from = tip(0.0);
        // A position is rounded to the increment: a ball that just touched may be inside by that much, and
        // leaves freely.
        if part.nearest(&from).distance - radius < -self.increment.size() {
            return Some(0.0);
        }
        let steps = self.chord_count(travel, setup, BALL_CHORD_TOLERANCE);
        for step in 0..steps {
            let to = tip(f64::from(step + 1) / f64::from(steps));
            if let Some(along) = part.contact_between(&from, &to, radius) {
                return Some((f64::from(step) + along) / f64::from(steps));
            }
            from = to;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use nalgebra::Point3;

    use super::*;
    use crate::machine::Distribution;
    use gcode_lang::motion::Position;
    use gcode_lang::units::{Deg, MmPerMin, Seconds};
    use gcode_part::Surface;

    const BODY: Surface = Surface::Ellipsoid { a: 500.0, b: 400.0 };

    fn at(x: f64, y: f64, z: f64, b: f64) -> Position {
        Position([x, y, z, 0.0, b, 0.0, 0.0, 0.0])
    }

    fn touch(machine: &Machine, from: Position, to: Position, radius: f64) -> Option<f64> {
        let travel = AxisMotion { from: &from, to: &to, arc: None };
        machine.touch(&travel, &Setup::default(), &BODY.into(), radius)
    }

    fn near(found: Option<f64>, expected: f64) {
        assert!(found.is_some_and(|found| (found - expected).abs() < 1e-9), "{found:?} is not {expected}");
    }

    /// Down to the pole from 450 to 350: the centre of a ball of 3 stops at 403, after 47 of 100 mm.
    #[test]
    fn contacts_at_the_pole_and_the_equator_are_those_computed_by_hand() {
        let machine = Machine::default();
        near(touch(&machine, at(0.0, 450.0, 0.0, 0.0), at(0.0, 350.0, 0.0, 0.0), 3.0), 0.47);
        near(touch(&machine, at(0.0, -450.0, 0.0, 0.0), at(0.0, -350.0, 0.0, 0.0), 3.0), 0.47);
        near(touch(&machine, at(600.0, 0.0, 0.0, 30.0), at(400.0, 0.0, 0.0, 30.0), 3.0), 0.485);
        near(touch(&machine, at(0.0, 0.0, -600.0, 0.0), at(0.0, 0.0, -400.0, 0.0), 0.0), 0.5);
        assert_eq!(touch(&machine, at(0.0, 450.0, 0.0, 0.0), at(0.0, 403.001, 0.0, 0.0), 3.0), None);
    }

    /// Past the pole in x at a height that is a tenth of a micrometre too low or too high for a ball of 3 mm.
    #[test]
    fn a_grazing_contact_is_found() {
        let machine = Machine::default();
        let pass = |y: f64| touch(&machine, at(-900.0, y, 0.0, 0.0), at(1100.0, y, 0.0, 0.0), 3.0);
        assert_eq!(pass(403.000_1), None);
        // The offset surface is round the pole like a circle of a²/b + 3 = 628: 0.0001 below its top it is
        // √(2·628·0.0001) = 0.3544 wide to each side.
        let found = pass(402.999_9).unwrap() * 2000.0 - 900.0;
        assert!((found + 0.354_400_9).abs() < 1e-4, "{found}");
    }

    /// The part is eccentric on the table; B rotates it into a stationary ball. By hand: the pole at (40, ·,
    /// 0) of the table moves to machine (40·cos B, ·, −40·sin B), and a sphere round it of 100 + 5 reaches
    /// the ball at (0, 0, −130) when 40² + 130² − 2·40·130·sin B = 105².
    #[test]
    fn a_rotating_table_brings_the_part_to_the_ball() {
        let sphere = PartSolid::from(Surface::Ellipsoid { a: 100.0, b: 100.0 });
        let mut machine = Machine::default();
        machine.part.shift.x = 40.0;
        let (from, to) = (at(0.0, 0.0, -130.0, 0.0), at(0.0, 0.0, -130.0, 90.0));
        let travel = AxisMotion { from: &from, to: &to, arc: None };
        let found = machine.touch(&travel, &Setup::default(), &sphere, 5.0).unwrap() * 90.0;
        let sine = (1600.0 + 16_900.0 - 11_025.0) / 10_400.0;
        // The chords deviate by 1e-5 mm, and a degree closes the gap by 0.6 mm.
        assert!((found - Deg::asin(sine).0).abs() < 3e-5, "{found}");
        // In the other direction the part moves away from it.
        let back = at(0.0, 0.0, -130.0, -90.0);
        let travel = AxisMotion { from: &from, to: &back, arc: None };
        assert_eq!(machine.touch(&travel, &Setup::default(), &sphere, 5.0), None);
    }

    #[test]
    fn a_ball_in_contact_leaves_freely_and_a_deflected_one_signals_at_once() {
        let machine = Machine::default();
        let from = |y: f64, to: f64| touch(&machine, at(0.0, y, 0.0, 0.0), at(0.0, to, 0.0, 0.0), 3.0);
        assert_eq!(from(403.0, 450.0), None);
        assert_eq!(from(402.9996, 450.0), None, "rounded to the increment");
        assert_eq!(from(402.9996, 380.0), Some(0.0));
        assert_eq!(from(402.9, 450.0), Some(0.0), "pushed in: the signal is there already");
    }

    /// A machine whose X has a wave of 0.02 mm: the ball touches at the actual X.
    #[test]
    fn errors_of_the_axes_move_the_contact() {
        let text = "[errors.linear]\nx = { uniform = 0.02 }\nwave = 300\nseed = 5\n";
        let machine = Machine::parse(text).unwrap();
        let found = touch(&machine, at(600.0, 0.0, 0.0, 0.0), at(400.0, 0.0, 0.0, 0.0), 3.0).unwrap();
        let x = 600.0 - 200.0 * found;
        let error = machine.slides.0[0].error.value_at(x);
        assert!(error.abs() > 1e-3 && (x + error - 503.0).abs() < 2e-5, "{x} and {error}");
    }

    /// 600 mm/min are 10 mm per second; the travel of 100 mm takes 10 s.
    fn probed(probe: &Probe, touches: u64) -> SkipSignal {
        let (from, to) = (at(0.0, 450.0, 0.0, 0.0), at(0.0, 350.0, 0.0, 0.0));
        let feed = SkipMove { from: &from, to: &to, rate: MmPerMin(600.0), seconds: Seconds(10.0) };
        Machine::default().probe(probe, &feed, &Setup::default(), &BODY.into(), touches)
    }

    #[test]
    fn a_delay_latches_the_position_late_and_an_overrun_stops_later() {
        let mut probe = Probe::new(3.0);
        (probe.delay, probe.overrun) = (Seconds(0.02), Seconds(0.05));
        let SkipSignal::Received { latched, stop_fraction } = probed(&probe, 0) else { panic!("it touches") };
        // 0.2 and 0.5 mm beyond the contact at 47 mm.
        assert!((latched - 0.472).abs() < 1e-9 && (stop_fraction - 0.477).abs() < 1e-9);
        probe.overtravel_limit = 0.6;
        let SkipSignal::StylusBroken { deflection, overtravel_limit, .. } = probed(&probe, 0) else {
            panic!("0.7 is more than 0.6")
        };
        assert!((deflection - 0.7).abs() < 1e-9 && overtravel_limit == 0.6);
        // A delay beyond the end of the travel: no signal during the block.
        (probe.delay, probe.overtravel_limit) = (Seconds(6.0), f64::INFINITY);
        assert_eq!(probed(&probe, 0), SkipSignal::Missed);
    }

    #[test]
    fn noise_differs_from_touch_to_touch_and_not_from_run_to_run() {
        let mut probe = Probe::new(3.0);
        probe.noise = Distribution::Uniform(0.01);
        let latched = |touches: u64| match probed(&probe, touches) {
            SkipSignal::Received { latched, .. } => latched,
            other => panic!("{other:?}"),
        };
        let (first, second) = (latched(0), latched(1));
        assert!(first != second && first == latched(0));
        assert!([first, second].iter().all(|n| (n - 0.47).abs() <= 1e-4), "0.01 of 100 mm");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// An independent search: the ball moves in 2000 steps, and at each the distance of the surface is
        /// found by Newton steps on the surface itself.
        #[test]
        fn a_walk_in_small_steps_finds_the_same_contact(
            (latitude, azimuth, b) in (-1.5..1.5f64, -3.0..3.0f64, -180.0..180.0),
            (dx, dy, dz) in (-1.0..1.0, -1.0..1.0, -1.0..1.0f64),
            (radius, shift) in (0.0..8.0, -1.0..1.0),
        ) {
            let r = 500.0 * libm::cos(latitude);
            let aim = nalgebra::Vector3::new(
                r * libm::cos(azimuth), 400.0 * libm::sin(latitude), r * libm::sin(azimuth));
            let away = nalgebra::Vector3::new(dx, dy, dz);
            prop_assume!(away.norm() > 0.1);
            let (start, end) = (aim + away * 400.0, aim - away * 100.0);
            let mut machine = Machine::default();
            machine.part.shift.x = shift;
            let found = touch(&machine, at(start.x, start.y, start.z, b), at(end.x, end.y, end.z, b), radius);
            let frame = machine.part_frame(&at(0.0, 0.0, 0.0, b));
            let point = |t: f64| frame.inverse_transform_point(&Point3::from(start + (end - start) * t));
            let walked = (0..=2000).map(|n| f64::from(n) / 2000.0).find(|t| by_newton(&point(*t)) <= radius);
            match (found, walked) {
                (Some(found), Some(walked)) => {
                    prop_assert!(found <= walked + 1e-9 && walked - found < 6e-4, "{} {}", found, walked);
                }
                (None, None) => {}
                // Between two steps a touch may be so shallow that the stepwise search misses it.
                (Some(found), None) => prop_assert!(by_newton(&point(found)) < radius + 1e-6),
                (None, Some(_)) => prop_assert!(false, "a contact was jumped over"),
            }
        }
    }

    /// Returns the signed distance by Lagrange's conditions q + λ·∇q = p, ∇ the surface's gradient, solved by
    /// Newton in λ from outside; inside, any negative number.
    fn by_newton(p: &Point3<f64>) -> f64 {
        if BODY.value(p) <= 0.0 {
            return BODY.value(p);
        }
        let (a2, b2) = (250_000.0, 160_000.0);
        let mut lambda = 0.0;
        for _ in 0..40 {
            let (u, v) = (1.0 + lambda / a2, 1.0 + lambda / b2);
            let flat = (p.x * p.x + p.z * p.z) / a2;
            let tall = p.y * p.y / b2;
            let value = flat / (u * u) + tall / (v * v) - 1.0;
            let slope = -2.0 * (flat / (u * u * u) / a2 + tall / (v * v * v) / b2);
            lambda -= value / slope;
        }
        let foot =
            Point3::new(p.x / (1.0 + lambda / a2), p.y / (1.0 + lambda / b2), p.z / (1.0 + lambda / a2));
        (p - foot).norm()
    }
}
