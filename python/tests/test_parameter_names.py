"""Names and limits of parameters of environments, as errors show them."""

import numpy as np
import pytest

from libration import Environments, LogUniform, System, Uniform

SPRING = System(
    acceleration={"q": "-omega2*q + u"},
    parameters={"omega2": 10.0},
    inputs=["u"],
    task={"observe": ["q", "q'", "omega2"], "reward": "-q^2 - 0.001*u^2", "start": {"q": (-1, 1)}},
)


@pytest.mark.parametrize("name", ["jitter", "actions", "dt", "num_envs", "render_mode", "name", "system"])
def test_a_parameter_with_the_name_of_a_keyword_is_refused_by_name(name):
    system = System(acceleration={"q": f"-{name}*q + u"}, parameters={name: 10.0}, inputs=["u"])
    with pytest.raises(ValueError, match=rf"the system 'system' has a parameter '{name}', but .* keyword of environments; help: .*'{name}_'"):
        Environments(system, dt=0.01, reward="-q^2")


def test_a_parameter_that_varies_is_no_mask_of_infos():
    system = System(acceleration={"q": "-_k*q + u"}, parameters={"_k": 10.0}, inputs=["u"])
    for value in (Uniform(1, 2), np.array([1.0, 2.0])):
        with pytest.raises(ValueError, match=r"parameter '_k' varies, but .* masks; help: .*'k'"):
            Environments(system, 2, dt=0.01, reward="-q^2", _k=value)
    envs = Environments(system, 2, dt=0.01, reward="-q^2", _k=3.0)
    assert envs.reset(seed=0)[1] == {}


def test_more_numbers_that_vary_than_an_episode_can_have_are_an_error_with_their_count():
    names = [f"k{i}" for i in range(65)]
    system = System(acceleration={"q": f"u - q*({' + '.join(names)})"}, parameters=dict.fromkeys(names, 1.0), inputs=["u"])
    given = {name: Uniform(1, 2) for name in names[:64]}
    assert len(Environments(system, 2, dt=0.01, reward="-q^2", **given).parameters) == 64
    for more, text in (({"k64": Uniform(1, 2)}, "65 parameters and 0"), ({"max_action": np.array([1.0, 2.0])}, "64 parameters and 1")):
        with pytest.raises(ValueError, match=rf"65 numbers vary, {text} largest actions, .* at most 64; help: .*one number"):
            Environments(system, 2, dt=0.01, reward="-q^2", **given, **more)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"omega2": Uniform(1, 1e300)}, r"omega2 is 1e\+300, but it must be finite in float32"),
        ({"omega2": LogUniform(1e-60, 1)}, r"omega2 is 1e-60, but it must be finite and greater than 0 in float32"),
        ({"omega2": np.array([1.0, 1e300])}, r"omega2 is 1e\+300"),
        ({"max_action": 1e-60}, r"max_action is 1e-60, but it must be greater than 0 in float32"),
        ({"max_action": Uniform(1e-60, 1)}, r"max_action is 1e-60"),
    ],
)
def test_numbers_beyond_the_float_type_are_refused_by_name(given, text):
    with pytest.raises(ValueError, match=text):
        Environments(SPRING, 2, dt=0.01, **given)
    Environments(SPRING, 2, dt=0.01, dtype="float64", **given)


def test_no_parameter_that_varies_has_the_name_of_a_largest_action_that_varies():
    system = System(acceleration={"q": "u - max_action_u*q", "p": "w - p"}, parameters={"max_action_u": 1.0}, inputs=["u", "w"])
    given = {"dt": 0.1, "reward": "-q^2"}
    with pytest.raises(ValueError, match="the parameter 'max_action_u' varies, but infos have the largest action of 'u' under this name; help: .* 'max_action_u_'"):
        Environments(system, 3, max_action=[Uniform(1, 2), 1.0], max_action_u=Uniform(5, 6), **given)
    # Only one of them is in infos.
    for one in ({"max_action": [Uniform(1, 2), 1.0], "max_action_u": 5.0}, {"max_action": [2.0, 1.0], "max_action_u": Uniform(5, 6)}):
        assert "max_action_u" in Environments(system, 3, **one, **given).parameters
