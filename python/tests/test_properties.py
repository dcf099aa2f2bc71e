"""What holds whatever is asked."""

import copy
import math
import pathlib
import pickle
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from common import AUTORESETS, Lent, NAMES, PERTURBED
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st
from hypothesis.configuration import set_hypothesis_home_dir
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule

import libration
from libration.policies import MLP, Constant, Linear, Random

# What it notes down is no part of the sources.
set_hypothesis_home_dir(pathlib.Path(__file__).resolve().parents[2] / "target" / "hypothesis")


def examples(count):
    """The same every time: what fails is then what was changed, and fails until it is mended."""
    # A machine that is busy is no failure.
    slow = [HealthCheck.too_slow]
    return settings(
        derandomize=True,
        database=None,
        deadline=None,
        max_examples=count,
        suppress_health_check=slow,
    )


SEEDS = st.integers(0, 2**63)
# One vector of lanes, parts of it and more than it.
COUNTS = st.sampled_from([1, 2, 3, 8, 9, 17])
WIDTHS = {"Oscillator": 2, "Pendulum": 3, "Duffing": 2}


@st.composite
def kinds(draw, modes=AUTORESETS, perturbed=None):
    """Keywords of environments whose episodes are short."""
    kind = dict(
        name=draw(st.sampled_from(NAMES)),
        autoreset_mode=draw(st.sampled_from(modes)),
        dtype=draw(st.sampled_from(["float32", "float64"])),
        max_episode_steps=draw(st.sampled_from([1, 2, 7, 30])),
    )
    if kind["name"] != "Pendulum":
        kind["bound"] = 1.2
    if draw(st.booleans()) if perturbed is None else perturbed:
        kind.update(PERTURBED)
    return kind


def made(kind, num_envs=3, **given):
    return libration.Environments(num_envs=num_envs, **{**kind, **given})


def same(one, other):
    """Arrays are the same to the bit, and of one dtype and shape."""
    for mine, theirs in zip(one, other, strict=True):
        assert (mine.dtype, mine.shape) == (theirs.dtype, theirs.shape)
        assert mine.tobytes() == theirs.tobytes()


def sound(envs, outcome):
    """A step has the shapes and types that it should, and pays numbers."""
    seen, rewards, terminated, truncated, infos = outcome
    n, dtype = envs.num_envs, envs.states.dtype
    assert (seen.shape, seen.dtype) == ((n, len(envs.preset.seen)), dtype)
    assert (rewards.shape, rewards.dtype) == ((n,), dtype)
    assert terminated.shape == truncated.shape == (n,)
    assert terminated.dtype == truncated.dtype == np.bool_
    assert np.isfinite(rewards).all()
    told = infos.get("final_info", infos)
    lost = told.get("lost", np.zeros(n, np.bool_))
    assert terminated[lost].all() and (rewards[lost] == 0).all()


class Plain(np.ndarray):
    """A subclass that adds nothing."""


def strided(array):
    room = np.full((2 * len(array), 3), 99, array.dtype)
    room[::2, 1] = array
    return room[::2, 1]


def misaligned(array):
    room = np.empty(array.nbytes + 1, np.uint8)[1:].view(array.dtype)
    room[:] = array
    return room


def locked(array):
    array.flags.writeable = False
    return array


def native(array):
    return array.astype(array.dtype.newbyteorder("="))


HOLDERS = {
    "as it is": lambda array: array,
    "strided": strided,
    "reversed": lambda array: array[::-1].copy()[::-1],
    "misaligned": misaligned,
    "read-only": locked,
    "column": lambda array: array[:, None],
    "column of Fortran's": lambda array: np.asfortranarray(np.tile(array[:, None], 2))[:, :1],
    "strided column": lambda array: strided(array)[:, None],
    "subclass": lambda array: array.view(Plain),
    "memory view": lambda array: memoryview(native(array)),
    "list": lambda array: array.tolist(),
    "tuple of lists": lambda array: tuple(array[:, None].tolist()),
    # DLPack knows neither the other byte order nor long doubles.
    "DLPack": lambda array: Lent(array.astype(np.dtype(array.dtype.str[1:].replace("f16", "f8")))),
}


@examples(150)
@given(
    kind=kinds(),
    holder=st.sampled_from(sorted(HOLDERS)),
    dtype=st.sampled_from("f2 f4 f8 g i1 i2 i4 i8 u1 u2 u4 u8".split()),
    order=st.sampled_from("<>"),
    data=st.data(),
)
def test_actions_of_any_numeric_type_in_any_layout_do_what_plain_ones_do(
    kind, holder, dtype, order, data
):
    num_envs = data.draw(COUNTS)
    # What every one of the types can hold exactly, so that nothing is rounded twice.
    one = {"i": st.integers(-128, 127), "u": st.integers(0, 255)}.get(
        dtype[0], st.floats(-50, 50, width=16)
    )
    numbers = data.draw(st.lists(one, min_size=num_envs, max_size=num_envs))
    plain, other = made(kind, num_envs), made(kind, num_envs)
    same([plain.reset(seed=1)[0]], [other.reset(seed=1)[0]])
    wanted = plain.step(np.array(numbers, kind["dtype"]))
    assert wanted[0].dtype == wanted[1].dtype == kind["dtype"]
    held = HOLDERS[holder](np.array(numbers, np.dtype(dtype).newbyteorder(order)))
    same(other.step(held)[:4], wanted[:4])
    assert plain._state() == other._state()


@examples(30)
@given(kind=kinds(), num_envs=COUNTS, buffers=st.integers(1, 3))
def test_actions_that_lie_in_arrays_about_to_be_filled_do_what_their_copies_do(
    kind, num_envs, buffers
):
    kind["autoreset_mode"] = "SameStep"
    reused, fresh = made(kind, num_envs, copy=False, buffers=buffers), made(kind, num_envs)
    reused.reset(seed=1), fresh.reset(seed=1)
    actions = copied = np.ones(num_envs, kind["dtype"])
    for _ in range(8):
        found, wanted = reused.step(actions), fresh.step(copied)
        same(found[:4], wanted[:4])
        # Rewards are numbers of the right type in the right layout: they are read where they lie.
        actions, copied = found[1], wanted[1].copy()


def spoiled(numbers, n, bad):
    numbers = list(numbers)
    numbers[n] = bad
    return numbers


@st.composite
def no_actions(draw):
    """What cannot be three actions of 32 bits."""
    numbers = draw(st.lists(st.floats(-5, 5, width=16), min_size=3, max_size=3))
    n = draw(st.integers(0, 2))
    bad = draw(st.sampled_from([math.nan, math.inf, -math.inf]))
    shape = draw(
        st.lists(st.integers(0, 4), max_size=4).filter(lambda shape: shape not in ([3], [3, 1]))
    )
    return draw(
        st.sampled_from(
            [
                spoiled(numbers, n, bad),
                np.array(spoiled(numbers, n, bad), np.float16)[:, None],
                np.array(spoiled(numbers, n, bad), ">f4"),
                np.array(spoiled(numbers, n, bad), np.float32),
                np.array(spoiled(numbers, n, bad), np.float64)[::-1],
                # Finite, but no number of 32 bits.
                spoiled(numbers, n, math.copysign(1e39, numbers[0])),
                spoiled(numbers, n, 10**400),
                np.array(spoiled(numbers, n, 1e300), np.longdouble),
                np.zeros(shape, np.float32),
                np.zeros(shape, np.int8),
                np.array(numbers, complex),
                np.array(numbers, object),
                np.array(numbers, str),
                np.ones(3, "M8[s]"),
                np.ones(3, "m8[s]"),
                np.array(numbers) > 0,
                np.zeros(3, [("action", np.float32)]),
                np.float32(numbers[0]),
                [numbers, numbers[1:]],
                [[number] for number in numbers[1:]],
                spoiled(numbers, n, None),
                spoiled(numbers, n, "1"),
                dict(enumerate(numbers)),
                iter(numbers),
                "123",
                b"123",
                None,
                Ellipsis,
            ]
        )
    )


@examples(150)
@given(name=st.sampled_from(NAMES), mode=st.sampled_from(AUTORESETS), bad=no_actions())
def test_what_is_no_action_for_each_is_refused_and_nothing_has_changed(name, mode, bad):
    envs, other = (libration.Environments(name, 3, autoreset_mode=mode) for _ in range(2))
    envs.reset(seed=2), other.reset(seed=2)
    before = envs._state()
    with pytest.raises((TypeError, ValueError)):
        envs.step(bad)
    assert envs._state() == before
    same(envs.step(np.ones(3))[:4], other.step(np.ones(3))[:4])


NUMBERS = st.one_of(
    st.integers(),
    st.floats(),
    # Where floats end, and beyond.
    st.sampled_from([5e-324, 1e-310, 1e-46, 1e-45, 3e38, 4e38, 1.7e308, 10**400, -(10**400)]),
    st.fractions(),
    st.decimals(),
    st.booleans(),
    st.complex_numbers(),
    st.floats(width=32).map(np.float32),
    st.floats(width=16).map(np.float16),
    st.integers(-128, 127).map(np.int8),
    st.sampled_from([np.bool_(True), np.longdouble(1), np.timedelta64(1, "s"), np.array(0.5)]),
)
THINGS = st.one_of(
    NUMBERS,
    st.none(),
    st.text(max_size=5),
    st.binary(max_size=3),
    st.lists(NUMBERS, max_size=3),
    st.tuples(NUMBERS, NUMBERS),
    st.tuples(st.sampled_from(["gaussian", "uniform", "normal"]), NUMBERS),
    st.sampled_from([{}, {1: 2}, {0.5, 1.5}, range(2), np.ones(2), np.ones((2, 2)), object(), int]),
)
USUAL = {
    "max_episode_steps": st.sampled_from([1, 2, math.inf]),
    "autoreset_mode": st.sampled_from(AUTORESETS),
    "integrator": st.sampled_from(["rk4", "leapfrog", "suzuki4"]),
    "dt": st.floats(1e-3, 1.0),
    "substeps": st.integers(1, 50),
    "action_delay": st.sampled_from([0, 0.05, 0.1, (0.0, 0.1)]),
    "observation_delay": st.sampled_from([0, 0.05, 0.1, (0.0, 0.1)]),
    "jitter": st.floats(0, 1),
    "skew": st.floats(0, 1),
    "observation_noise": st.floats(0, 1),
    "max_action": st.floats(1e-3, 1e3),
    "start_position": st.floats(-2, 2),
    "start_velocity": st.floats(-2, 2),
    "dtype": st.sampled_from(["float32", np.float64]),
    "threads": st.sampled_from([0, 1, 2]),
    "copy": st.booleans(),
    "buffers": st.integers(1, 3),
    "omega2": st.floats(0.1, 100),
    "m": st.floats(0.1, 10),
    "k": st.floats(0.1, 10),
    "alpha": st.floats(-2, 2),
    "beta": st.floats(0.1, 2),
    "position_cost": st.floats(0, 1),
    "velocity_cost": st.floats(0, 1),
    "effort_cost": st.floats(0, 1),
    "bound": st.floats(0.1, 10),
    "spring": st.none(),
}


@st.composite
def keywords(draw):
    names = draw(st.lists(st.sampled_from(sorted(USUAL)), max_size=5, unique=True))
    return {name: draw(st.one_of(USUAL[name], THINGS)) for name in names}


@examples(400)
@given(name=st.sampled_from(NAMES), given=keywords())
@example("Pendulum", {"dt": 10**400})
@example("Pendulum", {"dt": -(10**400)})
@example("Pendulum", {"dt": Fraction(10**400)})
@example("Pendulum", {"dt": 1e-300, "action_delay": 1e308})
@example("Pendulum", {"dt": 5e-324, "action_delay": 0.1})
@example("Pendulum", {"dt": 5e-324, "substeps": 10})
@example("Pendulum", {"dt": 1e-310, "dtype": "float64"})
@example("Pendulum", {"dt": Decimal("0.05")})
@example("Pendulum", {"max_episode_steps": Decimal("sNaN")})
@example("Duffing", {"alpha": 1.7e308, "dtype": "float64"})
@example("Oscillator", {"start_position": (-1.7e308, 1.7e308), "dtype": "float64"})
@example("Oscillator", {"integrator": "\ud800"})
def test_any_keywords_make_environments_that_work_or_are_refused(name, given):
    # Hundreds of threads and of thousands of substeps cost nothing but time.
    threads, substeps = given.get("threads"), given.get("substeps")
    assume(not (isinstance(threads, (int, np.integer)) and 8 < threads <= 1024))
    try:
        envs = libration.Environments(name, 3, **given)
    except (TypeError, ValueError):
        return
    if isinstance(substeps, (int, np.integer)) and substeps > 1000:
        return
    seen, _ = envs.reset(seed=0)
    assert seen.shape == (3, WIDTHS[name])
    stands = False
    for action in (0.0, 1.0, -1.0):
        if stands:
            envs.reset()
        outcome = envs.step(np.full(3, action))
        sound(envs, outcome)
        stands = (outcome[2] | outcome[3]).any() and given.get("autoreset_mode") == "Disabled"
    assert pickle.loads(pickle.dumps(envs))._state() == envs._state()


@pytest.mark.parametrize(
    ("given", "error", "said"),
    [
        (dict(dt=10**400), ValueError, "dt is inf, but it must be finite and greater than 0"),
        (dict(max_action=-(10**400)), ValueError, "max_action is -inf"),
        (dict(dt=1e-300, action_delay=1e308), ValueError, "action_delay is 1e.308 s"),
        (dict(dt=5e-324, action_delay=0.1), ValueError, "action_delay is 0.1 s"),
        (dict(dt=5e-324, substeps=10), ValueError, "dt/substeps is 0.0, but it must be finite"),
        (dict(omega2=1e300), ValueError, "omega2 is 1e300; it must be small enough for the float type"),
        (dict(start_position=b"ab"), TypeError, "start_position must be a number, not bytes"),
        (dict(render_mode="human"), TypeError, "unexpected keyword argument 'render_mode'"),
    ],
)
def test_numbers_beyond_floats_and_what_is_no_number_are_refused_with_their_names(
    given, error, said
):
    with pytest.raises(error, match=said):
        libration.Environments("Pendulum", **given)


@examples(40)
@given(
    num_envs=st.one_of(st.integers(-(2**70), 0), st.integers(2**37, 2**70), THINGS),
    name=st.sampled_from(NAMES),
)
def test_no_number_of_environments_that_cannot_be_is_made(num_envs, name):
    if isinstance(num_envs, (int, np.integer)) and not isinstance(num_envs, bool):
        assume(not 0 < num_envs < 2**37)
    # Of 2^37 environments each takes tens of bytes: terabytes, which nobody has.
    with pytest.raises((TypeError, ValueError, MemoryError)):
        libration.Environments(name, num_envs)


ONE_SEED = st.one_of(st.none(), SEEDS, st.sampled_from([0, 2**64 - 1]))
MASKS = st.lists(st.booleans(), min_size=3, max_size=3).filter(any)
RESETS = st.tuples(
    st.one_of(SEEDS, st.none(), st.lists(ONE_SEED, min_size=3, max_size=3), SEEDS.map(np.uint64)),
    st.one_of(
        st.sampled_from([None, {}]),
        st.one_of(
            MASKS.map(np.array),
            MASKS.map(lambda mask: np.repeat(mask, 2)[::2]),
            MASKS.map(lambda mask: np.array(mask[::-1])[::-1]),
            # Whatever its byte is, a flag that is not 0 is one.
            MASKS.map(lambda mask: (np.array(mask) * np.uint8(7)).view(np.bool_)),
        ).map(lambda mask: {"reset_mask": mask}),
    ),
)


@examples(120)
@given(kind=kinds(), asked=RESETS)
def test_a_reset_begins_what_it_says_and_nothing_else(kind, asked):
    seed, options = asked
    envs = made(kind)
    envs.reset(seed=5)
    envs.step(np.ones(3))
    states = envs.states
    seen, infos = envs.reset(seed=seed, options=options)
    assert infos == {} and (seen.shape, seen.dtype) == ((3, WIDTHS[kind["name"]]), states.dtype)
    mask = (options or {}).get("reset_mask", np.ones(3, bool))
    if isinstance(seed, (int, np.integer)):
        seed = [int(seed) + n for n in range(3)]
    for n in range(3):
        if not mask[n]:
            same([envs.states[n]], [states[n]])
        elif seed is None or seed[n] is None:
            assert (envs.states[n] != states[n]).all()
        else:
            same([seen[n : n + 1]], [made(kind, 1).reset(seed=seed[n])[0]])


@examples(120)
@given(
    seed=st.one_of(
        st.integers(max_value=-1),
        st.integers(min_value=2**64 - 2),
        st.lists(ONE_SEED, max_size=6).filter(lambda seeds: len(seeds) != 3),
        st.tuples(ONE_SEED, ONE_SEED, st.sampled_from([-1, 2**64, 0.5, "1", True, [1]])),
        st.floats(),
        st.sampled_from(["seed", b"", True, {1, 2}, np.zeros(3), np.zeros((3, 1), int), object]),
    ),
    mask=st.one_of(
        MASKS,
        st.lists(st.booleans(), max_size=6).filter(lambda mask: len(mask) != 3).map(np.array),
        MASKS.map(lambda mask: np.array([mask])),
        MASKS.map(lambda mask: np.array(mask, int)),
        MASKS.map(lambda mask: np.array(mask, object)),
        st.sampled_from([None, 1, "mask", np.bool_(True), np.zeros(3, bool)]),
    ),
    fine=st.sampled_from(["seed", "mask", "none"]),
)
@example(1, np.zeros(3, bool), "seed")
@example(2**64 - 2, None, "mask")
@example([0, 2**64, None], None, "mask")
def test_a_reset_that_cannot_be_is_refused_and_nothing_has_changed(seed, mask, fine):
    seed = 1 if fine == "seed" else seed
    mask = np.ones(3, bool) if fine == "mask" else mask
    envs = libration.Environments("Pendulum", 3)
    envs.reset(seed=5)
    before = envs._state()
    with pytest.raises((TypeError, ValueError)):
        envs.reset(seed=seed, options={"reset_mask": mask})
    assert envs._state() == before


POLICIES = st.one_of(
    st.floats(-30, 30).map(Constant),
    st.tuples(st.floats(-5, 0), st.floats(0.5, 5)).map(lambda ends: Random(*ends)),
)


def go_on(envs, steps, policy):
    """All that is seen of environments that act by hand, then by a policy, and by hand again."""
    seen = []

    def by_hand():
        for t in range(steps):
            *arrays, _ = envs.step(np.full(envs.num_envs, t % 5 - 2.0))
            seen.extend(array.copy() for array in arrays)
            ended = arrays[2] | arrays[3]
            if envs._settings["autoreset"] == "Disabled" and ended.any():
                seen.append(envs.reset(options={"reset_mask": ended})[0].copy())

    by_hand()
    found = envs.rollout(policy, steps)
    seen += [found.observations, found.actions, found.rewards, found.last_observations]
    seen.append(envs.reset()[0])
    by_hand()
    return seen


@examples(60)
@given(
    kind=kinds(),
    num_envs=COUNTS,
    before=st.integers(0, 40),
    after=st.integers(1, 15),
    policy=POLICIES,
    keep=st.sampled_from([copy.copy, copy.deepcopy, lambda envs: pickle.loads(pickle.dumps(envs))]),
)
def test_a_copy_made_at_any_point_goes_on_bit_for_bit(
    kind, num_envs, before, after, policy, keep
):
    envs = made(kind, num_envs)
    if before:
        envs.reset(seed=before)
        if before > 1:
            go_on(envs, before // 2, policy)
        other = keep(envs)
    else:
        # Nor has what was not reset been reset in its copy.
        other = keep(envs)
        with pytest.raises(RuntimeError, match="must be reset"):
            other.step(np.zeros(num_envs))
        envs.reset(seed=1), other.reset(seed=1)
    same(go_on(other, after, policy), go_on(envs, after, policy))
    assert other._state() == envs._state()


@examples(60)
@given(
    kind=kinds(modes=AUTORESETS[:2]),
    num_envs=COUNTS,
    horizon=st.integers(1, 70),
    data=st.data(),
)
def test_a_rollout_over_any_horizon_is_the_steps_that_are_taken_by_hand(
    kind, num_envs, horizon, data
):
    weight = st.floats(-5, 5, width=16)
    width = WIDTHS[kind["name"]]
    policy = data.draw(
        st.one_of(
            weight.map(Constant),
            st.builds(Linear, st.lists(weight, min_size=width, max_size=width), weight),
        )
    )
    engine, hand = made(kind, num_envs), made(kind, num_envs)
    engine.reset(seed=3)
    seen, _ = hand.reset(seed=3)
    found = engine.rollout(policy, horizon)
    returns, lengths, ends = np.zeros(num_envs), np.zeros(num_envs, int), []
    waits = np.zeros(num_envs, bool)
    eps = np.finfo(kind["dtype"]).eps
    for t in range(horizon):
        if isinstance(policy, Constant):
            wanted, room = np.full(num_envs, policy.action), 0.0
        else:
            weights = np.array(policy.weights)
            wanted = seen.astype(float) @ weights + policy.bias
            # Three products and three sums at most, each rounded.
            room = 6 * eps * (np.abs(seen) @ np.abs(weights) + abs(policy.bias) + eps)
        assert (np.abs(found.actions[t, :, 0] - wanted) <= room).all()
        same([found.observations[t]], [seen])
        seen, *outcome, _ = hand.step(found.actions[t])
        same([found.rewards[t], found.terminated[t], found.truncated[t]], outcome)
        returns, lengths = returns + outcome[0], lengths + ~waits
        ended = outcome[1] | outcome[2]
        ends += [(t, n, lengths[n], returns[n]) for n in np.flatnonzero(ended)]
        returns[ended], lengths[ended] = 0.0, 0
        waits = ended & (kind["autoreset_mode"] == "NextStep")
    same([found.last_observations], [seen])
    told = found.episodes
    columns = [told[name].tolist() for name in ("steps", "environments", "lengths")]
    assert list(zip(*columns, strict=True)) == [end[:3] for end in ends]
    # Each of 30 sums at most is rounded, to the type of the environment.
    wanted = [end[3] for end in ends]
    np.testing.assert_allclose(told["returns"], wanted, rtol=30 * eps, atol=30 * eps)


@examples(40)
@given(
    kind=kinds(),
    n=st.integers(0, 20),
    more=st.integers(0, 1500),
    threads=st.sampled_from([1, 2, 3]),
    seed=st.integers(0, 2**62),
)
def test_an_environment_is_what_it_is_alone_beside_any_others_on_any_threads(
    kind, n, more, threads, seed
):
    def story(n, num_envs, threads, mode, first):
        """What environment `n` sees, is paid and how it ends in 25 transitions of its own."""
        envs = made(kind, num_envs, threads=threads, autoreset_mode=mode)
        seen, _ = envs.reset(seed=first)
        told = []
        while len(told) < 25:
            action = len(told) % 5 - 2.0
            before = seen[n]
            seen, *outcome, _ = envs.step(np.full(num_envs, action))
            told.append([*before, *(array[n] for array in outcome)])
            ended = outcome[1] | outcome[2]
            if mode == "Disabled" and ended.any():
                seen, _ = envs.reset(options={"reset_mask": ended})
            elif mode == "NextStep" and ended[n]:
                seen = envs.step(np.zeros(num_envs))[0]
        return np.array(told)

    found = story(n, n + 1 + more, threads, kind["autoreset_mode"], seed)
    same([found], [story(0, 1, 1, "SameStep", seed + n)])


@examples(60)
@given(kind=kinds(), num_envs=COUNTS, data=st.data())
def test_bytes_that_are_no_state_are_refused_and_a_true_one_is_taken_up_after_any(
    kind, num_envs, data
):
    envs, other = made(kind, num_envs), made(kind, num_envs)
    envs.reset(seed=1), other.reset(seed=1)
    envs.step(np.ones(num_envs)), other.step(np.ones(num_envs))
    state, untouched, standing = kept = envs._state()
    cut = data.draw(st.integers(0, len(state) - 1))
    more = data.draw(st.binary(min_size=1, max_size=100))
    for bad in (
        (state[:cut], untouched, standing),
        (state + more, untouched, standing),
        (more * (len(state) // len(more) + 2), untouched, standing),
        (state, untouched, bytes(num_envs + 1)),
        (state, untouched, bytes(num_envs - 1)),
    ):
        with pytest.raises(ValueError):
            envs._restore(bad)
        assert envs._state() == kept
    # The right length and garbage: taken or refused, it does no harm to what follows.
    damaged = bytearray(state)
    for at in data.draw(st.lists(st.integers(0, len(state) - 1), min_size=1, max_size=20)):
        damaged[at] = data.draw(st.integers(0, 255))
    for bad in (damaged, bytearray((more * len(state))[: len(state)])):
        try:
            envs._restore((bytes(bad), untouched, standing))
        except ValueError:
            assert envs._state() == kept
        envs._restore(kept)
        assert envs._state() == kept
    if kind["max_episode_steps"] > 1 or kind["autoreset_mode"] != "Disabled":
        actions = np.full(num_envs, 0.5)
        if not (kind["autoreset_mode"] == "Disabled" and any(standing)):
            same(envs.step(actions)[:4], other.step(actions)[:4])


@examples(120)
@given(
    widths=st.lists(st.integers(0, 9), max_size=3),
    ends=st.tuples(st.sampled_from([2, 3, 3, 3]), st.sampled_from([0, 1, 1, 1, 2])),
    activation=st.sampled_from(["tanh", "relu"]),
    dtype=st.sampled_from([np.float16, np.float32, np.float64, np.int8]),
    seed=st.integers(0, 2**32),
)
def test_networks_of_any_shape_answer_as_numpy_does_or_are_refused(
    widths, ends, activation, dtype, seed
):
    rng = np.random.default_rng(seed)
    sizes = [ends[0], *widths, ends[1]]
    layers = [
        (rng.uniform(-3, 3, (n, m)).astype(dtype), rng.uniform(-3, 3, n).astype(dtype))
        for m, n in zip(sizes, sizes[1:])
    ]
    envs = libration.Environments("Pendulum", 5, dtype="float64")
    envs.reset(seed=0)
    policy = MLP(layers, activation)
    if ends != (3, 1):
        with pytest.raises(ValueError, match="shape|outputs"):
            envs.rollout(policy, 4)
        return
    try:
        found = envs.rollout(policy, 4)
    except ValueError:
        # A layer without numbers is none.
        assert 0 in widths
        return
    function = {"tanh": np.tanh, "relu": lambda x: np.maximum(x, 0)}[activation]
    x = found.observations
    for i, (matrix, biases) in enumerate(layers):
        x = x @ matrix.astype(float).T + biases.astype(float)
        x = x if i + 1 == len(layers) else function(x)
    # Four layers of at most 9 products of at most 3 each make 27^4 of an error of 16 ulps at worst.
    np.testing.assert_allclose(found.actions, x, rtol=1e-11, atol=1e-9)


@examples(150)
@given(
    policy=st.one_of(
        st.builds(Constant, NUMBERS),
        st.builds(Random, NUMBERS, NUMBERS),
        st.builds(Linear, st.lists(NUMBERS, min_size=2, max_size=3), NUMBERS),
        st.builds(Linear, THINGS, THINGS),
        st.builds(MLP, st.lists(st.tuples(THINGS, THINGS), max_size=2), THINGS),
        st.builds(MLP, THINGS),
        st.floats().map(lambda x: MLP([([[x] * 3], [x])])),
        st.floats().map(lambda x: MLP([([[x] * 3] * 2, [x] * 2), ([[x, -x]], [0])], "relu")),
    ),
    dtype=st.sampled_from(["float32", "float64"]),
)
@example(Constant(10**400), "float64")
@example(Linear(np.ones(3, np.longdouble) * np.longdouble("1e400")), "float64")
@example(MLP([([[1e308] * 3] * 2, [1e308] * 2), ([[1e308, -1e308]], [0])], "relu"), "float64")
def test_policies_of_any_numbers_are_paid_numbers_or_are_refused(policy, dtype):
    envs = libration.Environments("Pendulum", 5, dtype=dtype, autoreset_mode="SameStep")
    envs.reset(seed=0)
    before = envs._state()
    try:
        found = envs.rollout(policy, 6)
    except (TypeError, ValueError):
        assert envs._state() == before
        return
    assert np.isfinite(found.rewards).all() and np.isfinite(found.observations).all()
    # What is lost is so for its action: the pendulum goes on for ever under any that is a number.
    lost = np.zeros((6, 5), bool)
    told = found.episodes
    lost[told["steps"], told["environments"]] = told["lost"]
    np.testing.assert_array_equal(lost, ~np.isfinite(found.actions[..., 0]))
    if isinstance(policy, Random):
        low, high = np.array([policy.low, policy.high], dtype)
        assert (low <= found.actions).all() and (found.actions <= high).all()


class Uses(RuleBasedStateMachine):
    """Environments, and more of them under the same hands, with threads and arrays used again."""

    FEW, MANY = 3, 8

    @initialize(kind=kinds(), seed=st.integers(0, 2**40))
    def make(self, kind, seed):
        self.kind = kind
        self.envs = made(kind, self.FEW)
        self.more = made(kind, self.MANY, threads=2, copy=False, buffers=2)
        self.begun, self.closed = False, False
        self.stands = np.zeros(self.MANY, bool)
        self.first(seed)

    def first(self, seed):
        found, wanted = self.envs.reset(seed=seed), self.more.reset(seed=seed)
        same([found[0]], [wanted[0][: self.FEW]])
        self.begun, self.stands[:] = True, False

    @precondition(lambda self: not self.closed)
    @rule(seed=st.integers(0, 2**40))
    def begin_anew(self, seed):
        self.first(seed)

    @precondition(lambda self: not self.closed and self.begun)
    @rule(which=st.integers(1, 2**8 - 1))
    def begin_some(self, which):
        mask = np.array([bool(which >> n & 1) for n in range(self.MANY)])
        mask[0] = True
        found, _ = self.envs.reset(options={"reset_mask": mask[: self.FEW]})
        wanted, _ = self.more.reset(options={"reset_mask": mask})
        same([found], [wanted[: self.FEW]])
        self.stands &= ~mask

    def rouse(self):
        """None of those that only one of both has stands still."""
        mask = self.stands & (np.arange(self.MANY) >= self.FEW)
        if mask.any():
            self.more.reset(options={"reset_mask": mask})
            self.stands &= ~mask

    def stand(self, ended):
        if self.kind["autoreset_mode"] == "Disabled":
            self.stands[:] = ended

    @precondition(lambda self: not self.closed and self.begun)
    @rule(action=st.floats(-9, 9))
    def act(self, action):
        self.rouse()
        if self.stands.any():
            with pytest.raises(RuntimeError, match="is over"):
                self.envs.step(np.full(self.FEW, action))
            return
        found = self.envs.step(np.full(self.FEW, action))
        sound(self.envs, found)
        wanted = self.more.step(np.full(self.MANY, action))
        same(found[:4], [array[: self.FEW] for array in wanted[:4]])
        self.stand(wanted[2] | wanted[3])

    @precondition(lambda self: not self.closed)
    @rule(bad=st.sampled_from([np.nan, "1", None, 1j]))
    def act_in_vain(self, bad):
        before = self.envs._state()
        with pytest.raises((TypeError, ValueError, RuntimeError)):
            self.envs.step([bad] * self.FEW)
        assert self.envs._state() == before

    @precondition(lambda self: not self.closed and self.begun)
    @rule(policy=POLICIES, horizon=st.integers(1, 12))
    def roll(self, policy, horizon):
        self.rouse()
        if self.stands.any():
            with pytest.raises(RuntimeError, match="is over"):
                self.envs.rollout(policy, horizon)
            return
        found, wanted = self.envs.rollout(policy, horizon), self.more.rollout(policy, horizon)
        for name in ("observations", "actions", "rewards", "terminated", "truncated"):
            same([getattr(found, name)], [getattr(wanted, name)[:, : self.FEW].copy()])
        same([found.last_observations], [wanted.last_observations[: self.FEW]])
        self.stand(wanted.terminated[-1] | wanted.truncated[-1])

    @precondition(lambda self: not self.closed)
    @rule()
    def copy(self):
        state = self.envs._state()
        self.envs = pickle.loads(pickle.dumps(self.envs))
        self.more = copy.deepcopy(self.more)
        assert self.envs._state() == state

    @rule()
    def close(self):
        self.envs._close()
        self.closed = True

    @precondition(lambda self: self.closed)
    @rule()
    def use_what_is_closed(self):
        for use in (
            lambda: self.envs.step(np.zeros(self.FEW)),
            lambda: self.envs.reset(seed=0),
            lambda: self.envs.rollout(Constant(), 1),
            lambda: self.envs.states,
            lambda: pickle.dumps(self.envs),
        ):
            with pytest.raises(RuntimeError, match="closed"):
                use()

    @precondition(lambda self: self.closed)
    @rule(kind=kinds(), seed=st.integers(0, 2**40))
    def make_others(self, kind, seed):
        self.make(kind=kind, seed=seed)


TestUsesInAnyOrderDoWhatTheyDoAmongMoreEnvironments = Uses.TestCase
Uses.TestCase.settings = settings(examples(40), stateful_step_count=25)
