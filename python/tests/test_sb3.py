"""Environments of Stable-Baselines3. Where it is not installed, a stand-in for its base class takes its place."""

import copy
import pickle
import subprocess
import sys
import types

import gymnasium
import numpy as np
import pytest

import libration
from common import IDS

# All that an environment draws: latencies, clocks and noise.
UNSTEADY = dict(action_delay=(0.0, 0.05), substeps=50, jitter=0.05, skew=("uniform", 0.001), observation_noise=0.01)
NEAR = dict(bound=1.0, start_velocity=(-5.0, 5.0), max_episode_steps=30)


class BaseVecEnv:
    """What the base class of Stable-Baselines3 2.9 does."""

    def __init__(self, num_envs, observation_space, action_space):
        self.num_envs, self.observation_space, self.action_space = num_envs, observation_space, action_space
        self.reset_infos = [{} for _ in range(num_envs)]
        self._reset_seeds()
        self._reset_options()
        modes = self.get_attr("render_mode")
        assert all(mode == modes[0] for mode in modes)
        self.render_mode = modes[0]

    def _reset_seeds(self):
        self._seeds = [None] * self.num_envs

    def _reset_options(self):
        self._options = [{} for _ in range(self.num_envs)]

    def step(self, actions):
        self.step_async(actions)
        return self.step_wait()

    def seed(self, seed=None):
        self._seeds = [(0 if seed is None else seed) + n for n in range(self.num_envs)]
        return self._seeds

    def set_options(self, options):
        self._options = [dict(options) for _ in range(self.num_envs)]

    def has_attr(self, name):
        try:
            self.get_attr(name)
        except AttributeError:
            return False
        return True

    def render(self, mode=None):
        # Two pictures stand in a column.
        return np.concatenate(self.get_images())

    def _get_indices(self, indices):
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else indices


class Monitor(gymnasium.Wrapper):
    """The class of the wrapper alone."""


def stand_in():
    modules = {name: types.ModuleType(f"stable_baselines3{name}") for name in ("", ".common", ".common.monitor", ".common.vec_env")}
    modules[".common.monitor"].Monitor, modules[".common.vec_env"].VecEnv = Monitor, BaseVecEnv
    return {module.__name__: module for module in modules.values()}


@pytest.fixture(scope="module")
def sb3():
    """``libration.sb3``, over Stable-Baselines3 or its stand-in."""
    with pytest.MonkeyPatch.context() as patch:
        try:
            import stable_baselines3  # noqa: F401
        except ModuleNotFoundError:
            for name, module in stand_in().items():
                patch.setitem(sys.modules, name, module)
        import libration.sb3

        yield libration.sb3
        sys.modules.pop("libration.sb3")
        del libration.sb3


def test_without_stable_baselines3_the_import_names_the_extra():
    code = "import sys; sys.modules['stable_baselines3'] = None; import libration.sb3"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 1
    assert "ImportError: libration.sb3 requires Stable-Baselines3" in done.stderr
    assert done.stderr.strip().endswith("help: pip install 'libration[sb3]'")


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize(("name", "settings"), [("Pendulum", dict(max_episode_steps=40)), ("Oscillator", NEAR)])
def test_steps_are_those_of_single_environments_side_by_side(sb3, name, settings, dtype):
    settings = {**UNSTEADY, **settings, "dtype": dtype}
    ours = sb3.VecEnv(IDS[name], 6, **settings)
    theirs = [gymnasium.make(IDS[name], **settings) for _ in range(6)]
    ours.seed(7)
    np.testing.assert_array_equal(ours.reset(), [one.reset(seed=7 + n)[0] for n, one in enumerate(theirs)])
    rng = np.random.default_rng(0)
    paid = [[] for _ in theirs]
    seen = set()
    for _ in range(150):
        actions = rng.uniform(-3, 3, (6, 1)).astype(dtype)
        observations, rewards, dones, infos = ours.step(actions)
        assert rewards.dtype == np.float32 and dones.dtype == bool and len(infos) == 6
        for n, one in enumerate(theirs):
            observation, reward, terminated, truncated, _ = one.step(actions[n])
            paid[n].append(reward)
            wanted = {"TimeLimit.truncated": truncated and not terminated}
            seen |= {"terminated"} if terminated else {"truncated"} if truncated else set()
            found = dict(infos[n])
            if terminated or truncated:
                np.testing.assert_array_equal(found.pop("terminal_observation"), observation)
                episode = found.pop("episode")
                assert episode["l"] == len(paid[n]) and episode["t"] >= 0
                assert episode["r"] == pytest.approx(sum(paid[n]), abs=1e-6)
                paid[n] = []
                observation = one.reset()[0]
            assert found == wanted
            np.testing.assert_array_equal(observations[n], observation)
            assert rewards[n] == np.float32(reward) and dones[n] == (terminated or truncated)
    assert "truncated" in seen and ("terminated" in seen) == (name == "Oscillator")


def test_an_id_a_class_and_an_environment_make_equal_environments(sb3):
    vector = libration.VectorEnv("Pendulum", 3, autoreset_mode="SameStep", action_delay=0.05)
    made = [sb3.VecEnv(name, 3, action_delay=0.05) for name in ("libration/PendulumSwingUp-v0", "Pendulum", libration.envs.PendulumVectorEnv)]
    made.append(sb3.VecEnv(vector))
    steps = []
    for envs in made:
        assert envs.num_envs == 3 and envs.observation_space.shape == (3,) and envs.action_space.shape == (1,)
        envs.seed(2)
        envs.reset()
        steps.append(np.array([envs.step(np.ones((3, 1), np.float32))[0] for _ in range(5)]))
    assert all(np.array_equal(steps[0], other) for other in steps[1:])
    assert made[0].spec.id == "libration/PendulumSwingUp-v0" and sb3.VecEnv("Pendulum").num_envs == 1


def test_systems_by_equations_and_tasks_by_functions_are_environments_too(sb3):
    spring = libration.System(acceleration={"q": "-10*q + u"}, inputs=["u"])
    keywords = dict(dt=0.01, reward="-q^2", start={"q": (-1, 1)}, max_episode_steps=4)
    tasked = libration.CustomTaskVectorEnv(
        "Pendulum", 2, task=lambda before, actions, after: after[:, 1], autoreset_mode="SameStep", max_episode_steps=4
    )
    for envs, dt in ((sb3.VecEnv(spring, 2, **keywords), 0.01), (sb3.VecEnv(tasked), 0.05)):
        envs.reset()
        for _ in range(4):
            _, rewards, dones, infos = envs.step(np.zeros((2, 1), np.float32))
        assert dones.all() and [info["episode"]["l"] for info in infos] == [4, 4]
        assert envs.get_attr("dt") == [dt] * 2


def test_seeds_belong_to_one_reset_and_episodes_then_differ(sb3):
    envs = sb3.VecEnv("Pendulum", 3)
    assert list(envs.seed(5)) == [5, 6, 7]
    first, second = envs.reset(), envs.reset()
    np.testing.assert_array_equal(first, gymnasium.make_vec("libration/PendulumSwingUp-v0", 3).reset(seed=5)[0])
    assert not np.isin(first, second).any() and envs.reset_infos == [{}] * 3
    envs.seed(5)
    np.testing.assert_array_equal(envs.reset(), first)
    envs.set_options({"gravity": 1})
    with pytest.raises(ValueError, match="gravity.*expected no options"):
        envs.reset()


def test_a_reset_begins_statistics_anew(sb3):
    envs = sb3.VecEnv("Pendulum", 2, max_episode_steps=3)
    for steps in (2, 3):
        envs.reset()
        total = np.zeros(2)
        for _ in range(steps):
            _, rewards, dones, infos = envs.step(np.ones((2, 1), np.float32))
            total += rewards
    assert dones.all() and [info["episode"]["l"] for info in infos] == [3, 3]
    assert [info["episode"]["r"] for info in infos] == pytest.approx(total, abs=1e-5)


def test_an_episode_that_terminates_in_the_step_of_its_limit_is_not_truncated(sb3):
    envs = sb3.VecEnv("Oscillator", 2, bound=1e-9, max_episode_steps=1)
    envs.reset()
    _, _, dones, infos = envs.step(np.zeros((2, 1), np.float32))
    assert dones.all() and not any(info["TimeLimit.truncated"] for info in infos)


def test_a_lost_environment_is_told_in_its_info_alone(sb3):
    for limit in (1, 9):
        envs = sb3.VecEnv("Duffing", 2, bound=np.inf, max_action=1e30, max_episode_steps=limit)
        envs.reset()
        _, _, dones, infos = envs.step(np.array([[1e30], [0.0]], np.float32))
        assert dones.tolist() == [True, limit == 1]
        assert infos[0]["lost"] is True and "lost" not in infos[1]


def test_a_step_without_an_end_makes_no_object_per_environment(sb3):
    envs = sb3.VecEnv("Pendulum", 1000)
    envs.reset()
    infos = envs.step(np.zeros((1000, 1), np.float32))[3]
    assert type(infos) is list and len(infos) == 1000 and len({id(info) for info in infos}) == 1
    assert infos[0] == {"TimeLimit.truncated": False}


@pytest.mark.parametrize(
    "change",
    [
        lambda info: info.__setitem__("mine", 1),
        lambda info: info.__delitem__("TimeLimit.truncated"),
        lambda info: info.update(mine=1),
        lambda info: info.setdefault("mine", 1),
        lambda info: info.pop("TimeLimit.truncated"),
        lambda info: info.popitem(),
        lambda info: info.clear(),
        lambda info: info.__ior__({"mine": 1}),
    ],
)
def test_an_info_that_environments_share_cannot_change_but_its_copies_can(sb3, change):
    envs = sb3.VecEnv("Pendulum", 2)
    envs.reset()
    info = envs.step(np.zeros((2, 1), np.float32))[3][0]
    with pytest.raises(TypeError, match=r"cannot change; help: info.copy\(\)"):
        change(info)
    for other in (info.copy(), copy.copy(info), copy.deepcopy(info), pickle.loads(pickle.dumps(info)), dict(info)):
        assert type(other) is dict and other == info
        change(other)
    assert envs.step(np.zeros((2, 1), np.float32))[3][1] == {"TimeLimit.truncated": False}


def test_infos_of_ended_episodes_belong_to_one_environment(sb3):
    envs = sb3.VecEnv("Pendulum", 2, max_episode_steps=1)
    envs.reset()
    infos = envs.step(np.zeros((2, 1), np.float32))[3]
    infos[0]["mine"] = 1
    infos[0]["terminal_observation"][:] = 0
    assert "mine" not in infos[1] and infos[1]["terminal_observation"].any()


def test_attributes_and_methods_are_those_of_the_chosen_environments(sb3):
    envs = sb3.VecEnv("Pendulum", 3, render_mode="rgb_array")
    envs.reset()
    assert envs.get_attr("dt") == [0.05] * 3 and envs.get_attr("dt", 1) == [0.05] and envs.get_attr("dt", [0, 2]) == [0.05] * 2
    np.testing.assert_array_equal(envs.get_attr("state", [2]), envs.envs.states[2:])
    assert envs.has_attr("omega2") and not envs.has_attr("omega")
    pictures = envs.env_method("render", indices=[0, 1])
    assert len(pictures) == 2 and pictures[0].shape == (300, 300, 3)
    with pytest.raises(AttributeError, match="dt of single environments cannot be set to .*0.1.*expected render_mode"):
        envs.set_attr("dt", 0.1, [1])
    with pytest.raises(AttributeError, match="reset is a method of all environments"):
        envs.env_method("reset")
    with pytest.raises(ValueError, match="must be the same for all"):
        envs.set_attr("render_mode", None, [1])
    envs.set_attr("render_mode", None)
    assert envs.render_mode is None and envs.get_attr("render_mode") == [None] * 3


def test_pictures_are_those_of_the_environments(sb3):
    envs = sb3.VecEnv("Pendulum", 2, render_mode="rgb_array")
    envs.reset()
    images = envs.get_images()
    assert type(images) is list and all(np.array_equal(a, b) for a, b in zip(images, envs.envs.render()))
    np.testing.assert_array_equal(envs.render(), np.concatenate(images))
    with pytest.warns(UserWarning, match="render_mode is None; expected 'rgb_array'"):
        assert sb3.VecEnv("Pendulum", 2).get_images() == [None, None]


@pytest.mark.parametrize("monitor", [True, False])
def test_statistics_are_those_of_a_monitor_or_there_are_none(sb3, monitor):
    from stable_baselines3.common.monitor import Monitor

    envs = sb3.VecEnv("Pendulum", 2, monitor=monitor, max_episode_steps=1)
    envs.reset()
    infos = envs.step(np.zeros((2, 1), np.float32))[3]
    assert ("episode" in infos[0]) == monitor and envs.env_is_wrapped(Monitor) == [monitor] * 2
    assert envs.env_is_wrapped(gymnasium.Wrapper, [1]) == [False]


def test_environments_that_stable_baselines3_would_misunderstand_are_refused(sb3):
    same = dict(autoreset_mode="SameStep")
    for env, given, error, told in [
        (libration.VectorEnv("Pendulum", 2), {}, ValueError, "autoreset_mode is 'NextStep'; expected 'SameStep'"),
        ("Pendulum", dict(autoreset_mode="Disabled"), ValueError, "autoreset_mode is 'Disabled'; expected 'SameStep'"),
        ("Pendulum", dict(copy=False), ValueError, "copy is False; expected True"),
        (libration.VectorEnv("Pendulum", 2, **same), dict(dt=0.1), TypeError, "dt is given, but the environments exist already"),
        (libration.VectorEnv("Pendulum", 2, **same), dict(num_envs=2), TypeError, "num_envs is given, but"),
        (gymnasium.make("libration/PendulumSwingUp-v0"), {}, TypeError, "env is of type .*; expected a vector environment of libration"),
        (7, {}, TypeError, "env is of type int"),
        ("Pendulum", dict(intergrator="rk4"), TypeError, "did you mean 'integrator'"),
    ]:
        with pytest.raises(error, match=told):
            sb3.VecEnv(env, **given)


def test_close_closes_the_environments(sb3):
    envs = sb3.VecEnv("Pendulum", 2)
    envs.close()
    assert envs.envs.closed
