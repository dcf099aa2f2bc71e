"""The claims of Gymnasium's tests of ``SyncVectorEnv``, ``CartPoleVectorEnv`` and ``make_vec``, about ``libration/CartPole-v1``."""

import gymnasium
import numpy as np
import pytest
from common import AUTORESETS
from gymnasium import VectorizeMode, spaces
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import TimeLimit
from gymnasium.wrappers import TransformObservation as SingleTransform
from vector_pairs import assert_equal_over_episodes, ours, theirs

from libration._classic_systems import CLASSIC
from libration.classic_control import CartPoleEnv, CartPoleVectorEnv

ID = "libration/CartPole-v1"


# Of a vector environment beside SyncVectorEnv.


@pytest.mark.parametrize("mode", AUTORESETS[:2])
def test_results_and_infos_are_those_of_the_sync_vector_env_of_gymnasium(mode):
    assert assert_equal_over_episodes(ours(4, autoreset_mode=mode), theirs(4, mode=mode)) > 4


@pytest.mark.parametrize("mode", AUTORESETS[:2])
def test_results_and_infos_are_those_of_the_sync_vector_env_of_our_single_environments(mode):
    single = gymnasium.make_vec(
        ID, 4, vectorization_mode="sync", vector_kwargs={"autoreset_mode": AutoresetMode(mode)}, starts="gymnasium"
    )
    assert assert_equal_over_episodes(ours(4, autoreset_mode=mode), single) > 4


def test_results_have_the_types_of_the_spaces_with_a_list_of_actions_too():
    envs = ours(8)
    observations, infos = envs.reset()
    assert isinstance(envs.observation_space, spaces.Box) and isinstance(envs.action_space, spaces.MultiDiscrete)
    assert isinstance(envs.single_action_space, spaces.Discrete) and infos == {}
    for actions in (envs.action_space.sample(), [envs.single_action_space.sample() for _ in range(8)]):
        assert observations.dtype == envs.observation_space.dtype and observations.shape == envs.observation_space.shape == (8, 4)
        assert observations in envs.observation_space
        observations, rewards, terminated, truncated, infos = envs.step(actions)
        assert rewards.shape == terminated.shape == truncated.shape == (8,) and isinstance(rewards[0], np.floating)
        assert terminated.dtype == truncated.dtype == np.bool_


@pytest.mark.parametrize("mode", AUTORESETS)
def test_the_metadata_have_the_mode_of_autoreset_as_a_member_of_the_enumeration(mode):
    for given in (mode, AutoresetMode(mode)):
        envs = ours(autoreset_mode=given)
        assert envs.metadata["autoreset_mode"] is AutoresetMode(mode)
        envs.close()


@pytest.mark.parametrize("concurrent", [1, 2, 3])
def test_final_observations_are_of_the_environments_that_end_together(concurrent):
    envs = ours(autoreset_mode="SameStep")
    envs.reset(seed=[42] * 3)
    # From equal starts those fall together that are pushed the same way; the others are pushed to and fro.
    for step in range(50):
        actions = np.array([0] * concurrent + [step % 2] * (3 - concurrent))
        observations, _, terminated, truncated, infos = envs.step(actions)
        if (terminated | truncated).any():
            break
        assert "final_obs" not in infos
    assert terminated.tolist() == [True] * concurrent + [False] * (3 - concurrent)
    assert infos["_final_obs"].tolist() == infos["_final_info"].tolist() == terminated.tolist()
    for n in range(3):
        if terminated[n]:
            assert infos["final_obs"][n] in envs.single_observation_space and not np.array_equal(infos["final_obs"][n], observations[n])
        else:
            assert infos["final_obs"][n] is None


@pytest.mark.parametrize("mode", AUTORESETS)
def test_a_reset_of_some_leaves_the_others(mode):
    envs = ours(autoreset_mode=mode)
    start, _ = envs.reset(seed=[0, 1, 2])
    for _ in range(3):
        last, *_ = envs.step(envs.action_space.sample())
    options = {"reset_mask": np.array([True, True, False])}
    again, infos = envs.reset(seed=[0, 1, 0], options=options)
    assert np.array_equal(again[:2], start[:2]) and np.array_equal(again[2], last[2]) and infos == {}
    assert options["reset_mask"].tolist() == [True, True, False]


@pytest.mark.parametrize(
    "mask", [np.array([True]), np.array([True, True, False, False]), np.array([[True] * 3]), np.array([1, 1, 0]), np.array([1.0, 1.0, 0.0]), np.zeros(3, bool)]
)
def test_a_wrong_mask_has_the_error_of_the_sync_vector_env(mask):
    raised = []
    for envs in (ours(autoreset_mode="Disabled"), theirs(mode="Disabled")):
        envs.reset(seed=0)
        with pytest.raises((TypeError, ValueError, AssertionError), match="reset_mask") as caught:
            envs.reset(options={"reset_mask": mask.copy()})
        raised.append(caught.type)
        envs.close()
    # Before Gymnasium 1.3 these are assertions.
    assert raised[1] in (raised[0], AssertionError) and raised[0] is not AssertionError


def test_the_seed_stays_until_the_next_one():
    envs = ours()
    # Gymnasium's own CartPoleVectorEnv has one number too, SyncVectorEnv a tuple.
    own = gymnasium.make_vec("CartPole-v1", 3, vectorization_mode="vector_entry_point")
    for env in (envs, own):
        env.reset(seed=42)
        assert env.np_random_seed == 42
        env.reset()
        assert env.np_random_seed == 42


def test_attributes_of_each_environment_are_a_tuple():
    envs = ours(4)
    envs.reset(seed=0)
    assert envs.call("gravity") == envs.get_attr("gravity") == (9.8,) * 4
    assert envs.render_mode is None and envs.get_attr("render_mode") == (None,) * 4
    with pytest.raises(AttributeError, match=r"gravity.*help: make other environments with gravity="):
        envs.set_attr("gravity", [9.81, 3.72, 8.87, 1.62])


def test_a_number_for_each_environment_moves_it_as_the_attributes_of_gymnasium_move_theirs():
    gravity = (9.81, 3.72, 8.87, 1.62)
    one, other = ours(4, gravity=np.array(gravity)), theirs(4)
    other.set_attr("gravity", list(gravity))
    assert one.get_attr("gravity") == other.get_attr("gravity") == gravity
    assert assert_equal_over_episodes(one, other) > 4


def test_pictures_are_a_tuple_of_arrays():
    pytest.importorskip("pygame")
    envs = ours(render_mode="rgb_array")
    envs.reset(seed=0)
    pictures = envs.render()
    assert isinstance(pictures, tuple) and [picture.shape for picture in pictures] == [(400, 600, 3)] * 3
    assert all(np.array_equal(*pair) for pair in zip(pictures, envs.call("render")))
    envs.close()


# Of CartPoleVectorEnv beside the single environment.


def test_one_environment_of_a_batch_is_the_single_environment_until_its_next_episode():
    env, envs = gymnasium.make("CartPole-v1").unwrapped, ours(1)
    assert np.array_equal(env.reset(seed=123)[0], envs.reset(seed=123)[0][0])
    over = False
    while not over:
        actions = envs.action_space.sample()
        observation, reward, *ended, info = env.step(actions[0])
        observations, rewards, terminated, truncated, infos = envs.step(actions)
        assert np.array_equal(observation, observations[0]) and reward == rewards[0]
        assert ended == [terminated[0], truncated[0]] and info == infos == {}
        over = any(ended)
    observations, rewards, terminated, truncated, infos = envs.step(actions)
    assert np.array_equal(env.reset()[0], observations[0])
    assert (rewards[0], terminated[0], truncated[0], infos) == (0.0, False, False, {})


@pytest.mark.parametrize("made", [CartPoleVectorEnv, lambda **given: ours(id="CartPole-v1", **given)])
def test_the_limit_of_a_batch_is_that_of_the_wrapper_of_a_single_environment(made):
    env, envs = TimeLimit(CartPoleEnv(), 5), made(num_envs=1, max_episode_steps=5)
    env.reset(seed=123), envs.reset(seed=123)
    for step in range(5):
        _, _, terminated, truncated, _ = env.step(step % 2)
        _, _, all_terminated, all_truncated, _ = envs.step(np.array([step % 2]))
        assert (terminated, truncated) == (all_terminated[0], all_truncated[0]) == (False, step == 4)
    assert envs.step(np.array([0]))[1:4] == ([0.0], [False], [False])


@pytest.mark.parametrize("starts", ["libration", "gymnasium"])
@pytest.mark.parametrize("id", [each.id for each in CLASSIC.values()])
def test_steps_without_copies_fill_arrays_in_turn(id, starts):
    given = dict(starts=starts, max_episode_steps=5)
    envs = gymnasium.make_vec(f"libration/{id}", 3, copy=False, buffers=3, **given)
    other = gymnasium.make_vec(f"libration/{id}", 3, **given)
    seen, copies, wanted = [], [], []
    for step in range(-1, 12):
        actions = envs.action_space.sample()
        rows, others = (env.reset(seed=3)[0] if step < 0 else env.step(actions)[0] for env in (envs, other))
        seen.append(rows), copies.append(rows.copy()), wanted.append(others)
    # A reset returns a new array.
    places = [rows.__array_interface__["data"][0] for rows in seen]
    assert len(set(places[1:])) == 3 and places[0] not in places[1:]
    for n, rows in enumerate(copies):
        # The copies of the other environment stay.
        assert np.array_equal(rows, wanted[n]) and rows.dtype == np.float32
    assert all(np.array_equal(seen[n], copies[n]) for n in (-1, -2, -3))
    assert len({rows.__array_interface__["data"][0] for rows in wanted}) == len(wanted)


# Of make_vec.


@pytest.mark.parametrize("num_envs", [1, 3, 10])
@pytest.mark.parametrize(
    ("mode", "kind"),
    [
        (None, CartPoleVectorEnv),
        ("vector_entry_point", CartPoleVectorEnv),
        (VectorizeMode.VECTOR_ENTRY_POINT, CartPoleVectorEnv),
        ("sync", SyncVectorEnv),
        (VectorizeMode.ASYNC, AsyncVectorEnv),
    ],
)
def test_make_vec_makes_the_class_of_each_mode(num_envs, mode, kind):
    if kind is AsyncVectorEnv and num_envs == 10:
        pytest.skip("ten processes show no more than three")
    envs = gymnasium.make_vec(ID, num_envs, vectorization_mode=mode)
    assert type(envs) is kind and envs.num_envs == num_envs
    envs.close()


def test_wrappers_of_make_vec_wrap_single_environments_and_no_batch():
    def doubled(env):
        return SingleTransform(env, lambda observation: 2 * observation, env.observation_space)

    envs = gymnasium.make_vec(ID, 2, vectorization_mode="sync", wrappers=[doubled])
    assert all(isinstance(env, SingleTransform) and isinstance(env.env, TimeLimit) for env in envs.envs)
    for refused in ({"wrappers": [doubled]}, {"vector_kwargs": {"copy": False}}):
        with pytest.raises(gymnasium.error.Error, match=r"(?i)vector"):
            ours(**refused)


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"num_envs": 3},
        {"vectorization_mode": "sync"},
        {"vectorization_mode": "vector_entry_point"},
        {"vectorization_mode": "sync", "vector_kwargs": {"copy": False}},
        {"vectorization_mode": "sync", "wrappers": (gymnasium.wrappers.TimeAwareObservation,)},
        {"copy": False, "autoreset_mode": "SameStep", "length": 0.4, "max_episode_steps": 7},
        {"render_mode": "rgb_array"},
    ],
)
def test_a_spec_makes_an_equal_environment(given):
    envs = gymnasium.make_vec(ID, **given)
    again = gymnasium.make_vec(envs.spec)
    assert envs.spec == again.spec and type(envs) is type(again)
    for name in ("num_envs", "observation_space", "single_observation_space", "action_space", "single_action_space", "render_mode"):
        assert getattr(envs, name) == getattr(again, name)
    envs.close(), again.close()
