"""Libration: effects of integrator, time step, float type, latency, jitter and clocks on a simulated system.

:func:`simulate`, :func:`analyze`, :func:`advise` and :func:`run_lab` correspond to the commands of the program; :class:`Ensemble` steps many
trajectories, and :class:`LinearLoops` many loops around a linear plant. :class:`Environments` are the environments of the engine. With
Gymnasium installed they are registered as ``libration/Oscillator-v0``, ``libration/PendulumSwingUp-v0`` and ``libration/Duffing-v0``, for
``gymnasium.make`` and ``gymnasium.make_vec``; :class:`LinearVectorEnv` has a linear plant.
"""

import os as _os

from . import _native
from ._native import __version__
from . import datasets, hosts, plants, policies, sweeps
from .analysis import Advice, Analysis, advise, analyze
from .bits import FirstDifference, first_difference
from .bodies import Bodies, BodyMotion, simulate_bodies
from .comparison import IntegratorComparison, compare_integrators
from .energy import EnergyReport, audit_energy
from .ensemble import Ensemble
from .environments import Environments
from .equations import EquationSystem
from .gains import GainReport, gains
from .identification import Identification, identify
from .laboratory import STUDIES, Finding, Results, run_lab
from .linear import (
    LQG,
    Butterworth2,
    Cascade,
    Difference,
    Lag,
    LinearPlant,
    MovingAverage,
    StateFeedback,
    StateSpace,
)
from .linear_loops import LinearLoops, LinearRollout
from .operating_point import OperatingPoint
from .perturbations import LQR, PD, PID, Gaussian, LogNormal, LogUniform, Observer, Steps, Uniform
from .probe_report import ProbeReport
from .probing import probe
from .replay import ReplayBuffer
from .rollout import Rollout
from .simulation import Trajectory, simulate
from .sweeps import Sweep, SweepTable, sweep
from .systems import IMPLICIT_INTEGRATORS, INTEGRATORS, RUNGE_KUTTA_METHODS, SPLITTING_METHODS, SYSTEMS, CustomSystem, System
from .temperature import TemperatureAnalysis, analyze_temperature

__all__ = [
    "Advice",
    "Analysis",
    "Bodies",
    "BodyMotion",
    "Butterworth2",
    "Cascade",
    "CustomSystem",
    "Difference",
    "EnergyReport",
    "Ensemble",
    "Environments",
    "EquationSystem",
    "Finding",
    "FirstDifference",
    "GainReport",
    "Gaussian",
    "IMPLICIT_INTEGRATORS",
    "Identification",
    "INTEGRATORS",
    "IntegratorComparison",
    "LQG",
    "LQR",
    "LogNormal",
    "LogUniform",
    "Lag",
    "LinearLoops",
    "LinearPlant",
    "LinearRollout",
    "MovingAverage",
    "Observer",
    "OperatingPoint",
    "PD",
    "PID",
    "ProbeReport",
    "ReplayBuffer",
    "Results",
    "Rollout",
    "RUNGE_KUTTA_METHODS",
    "SPLITTING_METHODS",
    "STUDIES",
    "SYSTEMS",
    "StateFeedback",
    "StateSpace",
    "Steps",
    "Sweep",
    "SweepTable",
    "System",
    "TemperatureAnalysis",
    "Trajectory",
    "Uniform",
    "__version__",
    "advise",
    "analyze",
    "analyze_temperature",
    "audit_energy",
    "compare_integrators",
    "datasets",
    "first_difference",
    "gains",
    "hosts",
    "identify",
    "plants",
    "policies",
    "probe",
    "run_lab",
    "simulate",
    "simulate_bodies",
    "sweep",
    "sweeps",
]

if hasattr(_os, "register_at_fork"):
    _os.register_at_fork(after_in_child=_native._forked)

try:
    from . import classic_control, envs
    from .custom import CustomTaskVectorEnv
    from .envs import VectorEnv
    from .linear_envs import LinearVectorEnv
except ModuleNotFoundError as error:
    # Gymnasium is an extra.
    if error.name is None or error.name.split(".")[0] != "gymnasium":
        raise
else:
    envs.register()
    classic_control.register()
    __all__ += ["CustomTaskVectorEnv", "LinearVectorEnv", "VectorEnv", "classic_control", "envs"]


def __dir__() -> list[str]:
    return sorted(__all__)
