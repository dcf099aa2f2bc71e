//! The steps of a block of loops: one scalar step in a loop over lanes.

use core::ops::Range;

use bytemuck::Pod;
use libration_core::array::rows;
use libration_core::control::delay::Event;
use libration_core::control::{Clock, Controller, Delay, Disturbance, Memory};
use libration_core::random::EPOCH;
use libration_core::system::CommandedSystem;
use libration_core::{Float, Integrator, State, System};
use pulp::{Simd, WithSimd};

use super::generators::Generators;
use super::lane::{ratio, step_with_command};
use super::rows::Block;
use super::setup::{Layout, Setup};
use crate::ensemble::Assign;
use crate::ensemble::kernel::{Lines, at, put};
use crate::ensemble::planes::Share;

/// Values that all blocks share.
pub(super) struct Common<'s, T, A, M, K, C, L, N> {
    pub(super) setup: &'s Setup<A, M, K, C, L, N>,
    pub(super) layout: Layout,
    pub(super) dt: T,
    pub(super) seed: u64,
}

/// Commands on their way up to which all rows are looked at, which is vectors; of more, lane by lane, the one that arrives. The number
/// is a guess, and changes no bit.
const SCANNED: usize = 8;

/// The age of no command.
const NONE: u32 = u32::MAX;

/// Takes the steps of a range with all trajectories of a block. `WHOLE`: all commands arrive at the beginning of a step,
/// the same for all. It is a separate kernel: next to loops that index the state, the state would be kept in memory.
#[rustfmt::skip]
pub(super) struct Steps<'b, 'a, T, A, M, K, C, L, N, Sys, const D: usize, const W: usize, const WHOLE: bool>
where
    A: Assign<Sys>,
{
    pub(super) common: &'b Common<'b, T, A, M, K, C, L, N>,
    pub(super) block: &'b mut Share<'a, T, D>,
    pub(super) memory: Block<'b, T, W>,
    pub(super) generators: &'b mut Generators<W>,
    pub(super) systems: A::Lanes<W>,
    pub(super) steps: Range<u64>,
}

impl<T, A, M, K, C, L, N, Sys, const D: usize, const W: usize, const WHOLE: bool> WithSimd
    for Steps<'_, '_, T, A, M, K, C, L, N, Sys, D, W, WHOLE>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Controller<T, D>,
    C: Clock<T>,
    L: Delay<T>,
    N: Disturbance,
    Sys: System<T, D>,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Steps { common, block, mut memory, generators, systems, steps } = self;
        let Common { setup, layout, dt, seed } = *common;
        let Setup { method, clock, controller, delay, disturbance, .. } = *setup;
        let schedule = delay.schedule();
        let (first, zero) = (block.first as u64, T::zero());
        let period = dt * T::from_f64(schedule.period());
        let words = [clock.words(), delay.words(), D * disturbance.words()];

        // Locals, each by itself: what the compiler can keep in registers.
        let (q, v) = block.load::<W>();
        let (mut q, mut v) = (Lines(q), Lines(v));
        let mut held = Lines([[zero; W]; D]);
        if K::ACTS {
            held = Lines(rows(|i| memory.get(layout.held + i, zero)));
        }
        let mut pushed = Lines([[zero; W]; D]);
        let mut clocks = C::Memory::load(&|i| memory.get(layout.clock + i, zero));
        let mut delays = L::Memory::load(&|i| memory.get(layout.delay + i, zero));
        let mut controllers = K::Memory::load(&|i| memory.get(layout.controller + i, zero));

        // Closures would do, but the compiler may leave one outside the vector code.
        macro_rules! look {
            ($place:expr) => {{
                let place = layout.ring + $place * D;
                let mut commands = [[zero; W]; D];
                for l in 0..W {
                    let state = State { q: at(&q.0, l), v: at(&v.0, l) };
                    let mut own = K::Memory::lane(&controllers, l);
                    put(&mut commands, l, controller.command(&mut own, &state, period));
                    K::Memory::set_lane(&mut controllers, l, own);
                }
                (0..D).for_each(|i| memory.set(place + i, &commands[i]));
            }};
        }
        macro_rules! look_where {
            ($place:expr, $l:ident, $looks:expr) => {{
                let place = layout.ring + $place * D;
                let mut commands: [[T; W]; D] = rows(|i| memory.get(place + i, zero));
                for $l in 0..W {
                    let state = State { q: at(&q.0, $l), v: at(&v.0, $l) };
                    let mut own = K::Memory::lane(&controllers, $l);
                    let command = controller.command(&mut own, &state, period);
                    if $looks {
                        put(&mut commands, $l, command);
                        K::Memory::set_lane(&mut controllers, $l, own);
                    }
                }
                (0..D).for_each(|i| memory.set(place + i, &commands[i]));
            }};
        }
        macro_rules! act {
            ($place:expr) => {{
                let place = layout.ring + $place * D;
                held.0 = rows(|i| memory.get(place + i, zero));
            }};
        }
        // All that acts on a lane besides the system's own forces.
        macro_rules! under_command {
            ($l:expr, $dt:expr) => {{
                let mut command = at(&held.0, $l);
                if const { N::ACTS } {
                    (0..D).for_each(|i| command[i] = command[i] + pushed.0[i][$l]);
                }
                let system = CommandedSystem { system: A::lane(&systems, $l), command };
                step_with_command(method, &system, &mut q, &mut v, $l, $dt);
            }};
        }
        macro_rules! push {
            ($pushes:ident, $l:expr, $dt:expr) => {
                if const { N::ACTS } {
                    for row in &mut pushed.0 {
                        row[$l] = disturbance.acceleration($dt, &mut || $pushes.next($l));
                    }
                }
            };
        }

        let mut begin = steps.start;
        while begin < steps.end {
            let end = steps.end.min((begin / EPOCH + 1).saturating_mul(EPOCH));
            let [mut times, mut latencies, mut pushes] =
                generators.at_step(seed, first, begin, words);
            if const { !K::ACTS && !N::ACTS } {
                for step in begin..end {
                    let beat = clock.beat(step);
                    for l in 0..W {
                        let h = dt * ratio::<T, C, W>(&clock, &mut clocks, beat, &mut times, l);
                        step_with_command(method, &A::lane(&systems, l), &mut q, &mut v, l, h);
                    }
                }
            } else if const { !K::ACTS } {
                for step in begin..end {
                    let beat = clock.beat(step);
                    for l in 0..W {
                        let h = dt * ratio::<T, C, W>(&clock, &mut clocks, beat, &mut times, l);
                        push!(pushes, l, h);
                        under_command!(l, h);
                    }
                }
            } else if const { WHOLE } {
                let mut slot = (begin % layout.places as u64) as usize;
                for step in begin..end {
                    // The oldest command lies where the next will.
                    let next = if slot + 1 == layout.places { 0 } else { slot + 1 };
                    look!(slot);
                    act!(next);
                    slot = next;
                    let beat = clock.beat(step);
                    for l in 0..W {
                        let h = dt * ratio::<T, C, W>(&clock, &mut clocks, beat, &mut times, l);
                        push!(pushes, l, h);
                        under_command!(l, h);
                    }
                }
            } else if const { L::SHARED } {
                for step in begin..end {
                    let beat = clock.beat(step);
                    let mut length = [zero; W];
                    for (l, length) in length.iter_mut().enumerate() {
                        *length = dt * ratio::<T, C, W>(&clock, &mut clocks, beat, &mut times, l);
                        push!(pushes, l, *length);
                    }
                    // Seconds of the step that are gone.
                    let (mut part, mut gone) = (0.0, [zero; W]);
                    for (until, event) in schedule.events(step) {
                        if until > part {
                            part = until;
                            for l in 0..W {
                                let then = T::from_f64(until) * length[l];
                                under_command!(l, then - gone[l]);
                                gone[l] = then;
                            }
                        }
                        match event {
                            Event::Sample(k) => look!(k.rem_euclid(layout.places as i128) as usize),
                            Event::Actuate(k) => act!(k.rem_euclid(layout.places as i128) as usize),
                        }
                    }
                    for l in 0..W {
                        under_command!(l, length[l] - gone[l]);
                    }
                }
            } else {
                for step in begin..end {
                    let slot = (step % layout.places as u64) as usize;
                    let (beat, late) = (clock.beat(step), delay.beat(step));
                    let (mut ages, mut parts, mut looks) = ([NONE; W], [zero; W], [zero; W]);
                    let mut length = [zero; W];
                    for l in 0..W {
                        length[l] = dt * ratio::<T, C, W>(&clock, &mut clocks, beat, &mut times, l);
                        push!(pushes, l, length[l]);
                        let mut own = L::Memory::lane(&delays, l);
                        let arrival = delay.arrival(&mut own, late, &mut || latencies.next(l));
                        L::Memory::set_lane(&mut delays, l, own);
                        ages[l] = if arrival.fresh { arrival.age } else { NONE };
                        (parts[l], looks[l]) = (arrival.part, arrival.looks);
                    }
                    let mut gone = [zero; W];
                    macro_rules! until {
                        ($l:ident, $part:expr) => {{
                            for $l in 0..W {
                                let then = $part * length[$l];
                                under_command!($l, then - gone[$l]);
                                gone[$l] = then;
                            }
                        }};
                    }
                    // Few rows one by one, which is vectors, and many lane by lane.
                    macro_rules! arrive {
                        ($l:ident, $arrives:expr) => {{
                            for $l in (0..W).filter(|_| layout.places > SCANNED) {
                                let age = ages[$l] as usize;
                                if (age < layout.places) & $arrives {
                                    let place = (slot + layout.places - age) % layout.places;
                                    for i in 0..D {
                                        let row = layout.ring + place * D + i;
                                        held.0[i][$l] = memory.lane(row, $l).unwrap_or(zero);
                                    }
                                }
                            }
                            let scanned = if layout.places > SCANNED { 0 } else { layout.places };
                            for age in 0..scanned {
                                let place = (slot + layout.places - age) % layout.places;
                                for i in 0..D {
                                    let row = memory.get(layout.ring + place * D + i, zero);
                                    for $l in 0..W {
                                        let this = (ages[$l] == age as u32) & $arrives;
                                        held.0[i][$l] = if this { row[$l] } else { held.0[i][$l] };
                                    }
                                }
                            }
                        }};
                    }
                    if const { L::SPLITS < 2 } {
                        look!(slot);
                        if const { L::SPLITS > 0 } {
                            until!(l, parts[l]);
                        }
                        arrive!(l, true);
                    } else {
                        // In some lanes the look comes first, in others the command.
                        until!(l, if looks[l] <= parts[l] { looks[l] } else { parts[l] });
                        look_where!(slot, l, looks[l] <= parts[l]);
                        arrive!(l, looks[l] > parts[l]);
                        until!(l, if looks[l] <= parts[l] { parts[l] } else { looks[l] });
                        look_where!(slot, l, looks[l] > parts[l]);
                        arrive!(l, looks[l] <= parts[l]);
                    }
                    until!(l, T::one());
                }
            }
            generators.keep(end, [times, latencies, pushes], words);
            begin = end;
        }

        block.store(&q.0, &v.0);
        C::Memory::store(&clocks, &mut |i, row| memory.set(layout.clock + i, row));
        L::Memory::store(&delays, &mut |i, row| memory.set(layout.delay + i, row));
        K::Memory::store(&controllers, &mut |i, row| memory.set(layout.controller + i, row));
        if K::ACTS {
            (0..D).for_each(|i| memory.set(layout.held + i, &held.0[i]));
        }
    }
}
