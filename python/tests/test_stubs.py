"""What types say of the package is true of it."""

import inspect
import os
import subprocess
import sys
from pathlib import Path

from libration import Environments, _environment_keywords, advise, analyze
from libration import LQR, EquationSystem, LinearPlant, System
from libration._settings import OPTIONS
from libration.systems import EquationKeywords

TESTS = Path(__file__).parent
CONFIG = TESTS.parents[1] / "pyproject.toml"


def test_the_package_agrees_with_its_types_and_its_stub_with_the_module_and_checkers_accept_correct_calls_only(tmp_path):
    """By one program: each of several would check the types of NumPy as well, for longer than those of the package."""
    # stubtest fails where mypy has an error in any module. The modules without a stub have no other signatures than their own.
    allowed = tmp_path / "allowed.txt"
    allowed.write_text(r"(libration(?!\._native\b)|typed_calls).*")
    options = ["--mypy-config-file", CONFIG, "--allowlist", allowed, "--ignore-unused-allowlist"]
    run = [sys.executable, "-m", "mypy.stubtest", "libration", "typed_calls", *options]
    done = subprocess.run(run, capture_output=True, text=True, cwd=TESTS, env={**os.environ, "MYPYPATH": str(TESTS)})
    assert done.returncode == 0, done.stdout + done.stderr


def test_each_keyword_of_environments_has_its_type_in_the_one_place():
    own = set(inspect.signature(Environments.__init__).parameters) - {"self", "name", "num_envs", "parameters"}
    typed = set(_environment_keywords.VectorKeywords.__optional_keys__)
    assert typed == own | set(_environment_keywords.Parameters.__optional_keys__)
    assert own == set(OPTIONS) - {"num_envs", "render_mode"}
    equations = set(inspect.signature(EquationSystem.__init__).parameters) - {"self", "name", "acceleration", "rate"}
    assert set(EquationKeywords.__optional_keys__) == equations


def test_each_key_of_an_analysis_and_of_advice_is_an_attribute_that_type_checkers_know():
    spring = System("oscillator", omega2=10.0)
    equations = System(acceleration={"x": "-10*x"}, start={"x": 1.0})
    plant, weights = LinearPlant.mechanical(1.0, 0.1, 10.0, 1.0), LQR([[1.0, 0.0], [0.0, 1.0]], [[1.0]])
    loop = {"feedback": (10.0, 2.0), "latency": 0.02, "jitter": 0.05, "skew": 0.01, "loss": 0.1}
    found = [
        analyze(spring, integrator="velocity-verlet", dt=0.01, max_drift=1e-3, max_amplitude=2.0, max_error=1e-3),
        analyze(spring, integrator="exact", dt=0.01, **loop),
        analyze("oscillator", integrator="explicit-euler", dt=10.0),
        analyze("pendulum", integrator="rk4", dt=0.01, steps=100),
        analyze(equations, integrator="rk4", dt=0.01, steps=100),
        analyze(plant, integrator="rk4", dt=0.01),
        analyze(plant, weights, period=0.01, latency=0.004),
        advise(spring, q=1.0, horizon=1.0),
        advise(equations, horizon=1.0),
        advise(plant, weights, period=0.1),
    ]
    for answer in found:
        missing = set(answer) - set(type(answer).__annotations__)
        assert not missing
        # An attribute that the answer lacks is an error, not None.
        for name in set(type(answer).__annotations__) - set(answer) - {"holds", "request", "page"}:
            assert not hasattr(answer, name)
