//! A day of the watch's intake in simulated time, with events that are lost, and a disk that refuses for minutes.

use std::time::{Duration, Instant, SystemTime};

use ieap::pipeline::{Context, Intake, Silent};
use rand::RngExt;

use super::computer::Weather;
use super::{FIRST_SEED, World};
use crate::campaign::counted;

/// Time for which a file must not change.
const QUIET: Duration = Duration::from_secs(5);
/// Within this time of its last change a file is in, with a look every 30 s at least.
const SOON: Duration = Duration::from_secs(60);

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_day_of_intake_loses_and_doubles_nothing_and_every_file_is_in_soon() {
    let mut world = World::new(FIRST_SEED, false);
    let (began, clock) = (Instant::now(), SystemTime::now());
    let end = Duration::from_secs(counted(3600, 86_400) as u64);
    let (mut now, mut next_act, mut fair_since) = (Duration::ZERO, Duration::ZERO, Duration::ZERO);
    let (mut looks, mut foul, mut acts, mut refused) = (0, 0, 0, 0);
    let mut last_act = Duration::ZERO;
    let mut intake = Intake::new(QUIET);
    let mut context = Context::open(world.folder.path(), false).unwrap();
    while now < end {
        world.computer.set_clock(clock + now);
        world.people.clock = Some(clock + now);
        if now >= next_act {
            world.people.act(&mut world.rng);
            (acts, last_act) = (acts + 1, now);
            // Now busily, now nothing for a quarter of an hour.
            let pause_s = if world.rng.random_bool(0.7) { 20 } else { 900 };
            next_act = now + Duration::from_secs(world.rng.random_range(1..pause_s));
        }
        let is_fair = fair_since <= now;
        world.computer.have(Weather {
            refusals: if is_fair { 0.0 } else { 0.05 },
            ..Weather::default()
        });
        if is_fair && world.rng.random_bool(0.02) {
            fair_since = now + Duration::from_secs(world.rng.random_range(60..1200));
        }
        let at = began + now;
        let look = super::on(&world.computer, || intake.look(&mut context, &|| at, &Silent)).unwrap();
        let look = look.unwrap();
        (looks, foul) = (looks + 1, foul + usize::from(!is_fair));
        refused += usize::from(look.taken.is_none());
        // Half of all events come; the others are lost, as when a queue overflows.
        let hint = if world.rng.random_bool(0.5) {
            next_act + Duration::from_millis(300)
        } else {
            end
        };
        let rested = now.saturating_sub(last_act.max(fair_since));
        if is_fair && rested > SOON && look.taken.is_some() {
            world.every_file_is_in_once();
        }
        now = (now + look.wait).min(hint.max(now + Duration::from_millis(100)));
    }
    eprintln!(
        "{} h: {acts} acts of people, {looks} looks, {foul} of them while the system refused calls, {refused} in vain",
        end.as_secs() / 3600
    );
    drop(context);
    world.end();
}
