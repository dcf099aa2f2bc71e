"""The engine."""

from os import PathLike
from typing import Any, Callable, Mapping, Sequence, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Self, disjoint_base

__all__ = [
    "Batch",
    "Buffer",
    "LinearLoops",
    "Memory",
    "Trajectories",
    "_MOST_STEPS",
    "_SETTINGS_BYTES",
    "__version__",
    "_advise",
    "_advise_equations",
    "_analyze",
    "_analyze_linear",
    "_check_bodies",
    "_analyze_temperature",
    "_audit_energy",
    "_compare_integrators",
    "_dataset_settings",
    "_equation_plant",
    "_equation_summary",
    "_forked",
    "_implicit_integrators",
    "_integrators",
    "_linear_plant",
    "_named_bodies",
    "_read_bodies",
    "_simulate_bodies",
    "_commanded",
    "_parameters",
    "_first_difference",
    "_gains",
    "_jacobian",
    "_identify",
    "_probe",
    "_program",
    "_run_lab",
    "_runge_kutta_methods",
    "_seconds_of_rollouts",
    "_seconds_of_steps",
    "_simulate",
    "_splitting_methods",
    "_studies",
    "_systems",
    "_task_expressions",
    "_join_datasets",
    "_verify_dataset",
    "_write_dataset",
]

_Numbers = NDArray[Any]
_System = tuple[str, Sequence[tuple[str, float]]]
_Columns = dict[str, _Numbers]
_Equations = tuple[str, str, Sequence[tuple[str, float]]]
_SystemAtStart = tuple[_Equations | _System, Sequence[float] | None, Sequence[float] | None]

__version__: str
_MOST_STEPS: int
_SETTINGS_BYTES: int

def _seconds_of_steps(settings: Mapping[str, Any], steps: int) -> float: ...

def _seconds_of_rollouts(
    settings: Mapping[str, Any],
    policy: Mapping[str, Any],
    horizon: int,
    rollouts: int,
) -> list[float]: ...
def _systems() -> list[tuple[str, str, int, int, list[tuple[str, str, str, float]]]]: ...
def _implicit_integrators() -> list[tuple[str, str]]: ...
def _integrators() -> list[tuple[str, str]]: ...
def _runge_kutta_methods() -> list[tuple[str, str, str]]: ...
def _splitting_methods() -> list[tuple[str, str, str]]: ...
def _studies() -> list[tuple[str, str]]: ...
def _commanded(system: _System) -> tuple[list[tuple[str, str]], list[str]]: ...
def _task_expressions(name: str) -> tuple[list[str], str, list[str]]: ...
def _parameters(system: _System) -> list[tuple[str, float]]: ...
def _program(
    integrator: str,
) -> tuple[list[tuple[str, int, int, int]], list[float], list[int]]: ...
def _simulate(
    system: _SystemAtStart, step: tuple[str, float], looped: Mapping[str, Any], rows: Mapping[str, Any]
) -> tuple[_Columns, dict[str, str], dict[str, Any]]: ...
def _equation_summary(system: _Equations) -> str: ...
def _equation_plant(
    system: _Equations,
) -> tuple[list[list[list[float]]], list[list[tuple[str, str]]], list[list[float]], float]: ...
def _analyze(
    system: _SystemAtStart, step: tuple[str, float], looped: Mapping[str, Any], options: Mapping[str, Any]
) -> str: ...
def _analyze_linear(config: str, dt: float | None, integrator: str | None) -> str: ...
def _analyze_temperature(
    system: _SystemAtStart,
    numbers: tuple[float, float, float | None],
    thermostats: Sequence[str] | None,
    draws: tuple[int, int],
) -> str: ...
def _audit_energy(
    traces: list[tuple[str, float | None, Any, Any]],
    tolerance: float | None,
    horizon: float | None,
    scale: float | None,
    invocation: str,
) -> tuple[str, bool, str]: ...
def _compare_integrators(system: _SystemAtStart, tolerance: float, horizon: float) -> str: ...
def _check_bodies(system: Mapping[str, Any]) -> None: ...
def _named_bodies(name: str, count: int, seed: int) -> dict[str, Any]: ...
def _read_bodies(path: str) -> dict[str, Any]: ...
def _simulate_bodies(
    system: Mapping[str, Any], options: Mapping[str, Any]
) -> tuple[str, _Numbers, _Numbers]: ...
def _linear_plant(text: str) -> tuple[list[list[list[float]]], list[list[tuple[str, str]]]]: ...
def _probe(
    description: str,
    step: Callable[[Any, Any, float], Any],
    observe: Callable[[Any], Any] | None,
    energy: Callable[[Any], Any] | None,
    restart: Callable[[], Any] | None,
    batched: bool,
) -> tuple[str, bool, str]: ...
def _jacobian(function: Callable[[Any], Any], z: Any, scale: Any) -> tuple[Any, Any]: ...
def _gains(
    description: str,
    dt: float,
    substeps: int,
    integrator: str,
    step: Callable[[Any, Any, float], Any] | None,
    set_gains: Callable[[Any, Any], None] | None,
) -> tuple[str, str]: ...
def _identify(arrays: list[Any], options: str) -> tuple[str, str | None, str]: ...
def _first_difference(
    first: Any, second: Any, shape: list[int]
) -> tuple[list[int], float, float, int | None, int] | None: ...
def _advise(
    config: str, page: bool, redesign: bool, progress: Callable[[str, int, int, str, int, int], Any] | None
) -> tuple[str, bool, str | None]: ...
def _advise_equations(
    system: _SystemAtStart,
    tolerance: tuple[str, float],
    horizon: float,
    page: bool,
    progress: Callable[[str, int, int, str, int, int], Any] | None,
) -> tuple[str, bool, str | None]: ...
def _run_lab(
    config: str,
    system: Mapping[str, Any] | None,
    names: Sequence[str] | None,
    effort: str | None,
    out: PathLike[str],
    progress: Callable[[str, int, int, str, int, int], Any] | None,
) -> tuple[str, list[tuple[str, str, _Columns, dict[str, str]]]]: ...
def _forked() -> None: ...
def _dataset_settings() -> str: ...
def _write_dataset(
    settings: str,
    system: _Equations | None,
    writing: Mapping[str, Any],
    progress: Callable[[int, int, int], Any] | None,
) -> tuple[int, int, int]: ...
def _join_datasets(
    parts: Sequence[PathLike[str]],
    out: PathLike[str],
    link: bool,
    resume: bool,
    progress: Callable[[int, int, int], Any] | None,
) -> tuple[int, int, int]: ...
def _verify_dataset(
    folder: PathLike[str],
    replay: bool,
    repair: bool,
    threads: int,
    progress: Callable[[int, int, int], Any] | None,
) -> tuple[list[tuple[str, PathLike[str], str, bool]], list[str]]: ...
@final
class Trajectories:
    def __new__(
        cls,
        system: _Equations | _System,
        integrator: str,
        dt: float,
        q: _Numbers,
        v: _Numbers,
        single: bool,
        threads: int,
    ) -> Self: ...
    def _advance(self, steps: int) -> None: ...
    def _step(self) -> int: ...
    def _states(self) -> list[_Numbers]: ...
    def _energies(self) -> _Numbers: ...

@final
class LinearLoops:
    def __new__(cls, config: str, count: int, threads: int, noise: bool, open: bool) -> Self: ...
    def _names(self) -> list[list[tuple[str, str]]]: ...
    def _period(self) -> float: ...
    def _step(self) -> int: ...
    def _reset(self, seed: int, x0: NDArray[np.float64]) -> None: ...
    def _set_constants(self, reference: Sequence[float], disturbance: Sequence[float]) -> None: ...
    def _advance(self, periods: int) -> None: ...
    def _advance_by(self, commands: NDArray[np.float64]) -> None: ...
    def _rollout(
        self, rows: int, every: int
    ) -> tuple[
        NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]
    ]: ...

@final
class Buffer:
    def __new__(
        cls,
        steps: int,
        environments: int,
        sizes: Sequence[int],
        single: bool,
        priorities: bool,
        ends: int | None = None,
    ) -> Self: ...
    def __len__(self) -> int: ...
    def _insert(self, memory: Memory, next: _Numbers) -> None: ...
    def _sample(self, request: Mapping[str, Any]) -> dict[str, _Numbers]: ...
    def _sequences(self, request: Mapping[str, Any]) -> dict[str, _Numbers]: ...
    def _update(
        self, numbers: NDArray[np.uint64], priorities: NDArray[np.float64], exponent: float
    ) -> int: ...

@final
class Memory:
    def _arrays(self) -> dict[str, NDArray[Any]]: ...
    def _ends(self) -> dict[str, NDArray[Any]]: ...
    def _transitions(self) -> NDArray[np.bool_]: ...
    def _estimates(
        self, gamma: float, lambda_: float, next: Sequence[float], last: Sequence[float]
    ) -> list[NDArray[Any]]: ...

@disjoint_base
class Batch:
    def __new__(cls, *args: Any, **kwargs: Any) -> Self: ...
    def _set_up(self, settings: Mapping[str, Any], buffers: int, rounds: bool = False) -> None: ...
    def _step_single(self, action: Any) -> tuple[NDArray[Any], float, bool, bool, dict[str, Any]]: ...
    def step(
        self, actions: Any
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]: ...
    def _nothing(self, actions: Any) -> None: ...
    def _reset(
        self, seeds: Sequence[int | None], mask: NDArray[np.bool_] | None = None
    ) -> NDArray[Any]: ...
    def _end(self, which: NDArray[np.bool_]) -> None: ...
    def _memory(self, horizon: int, log_probabilities: bool, values: bool) -> Memory: ...
    def _rollout(self, policy: Mapping[str, Any], memory: Memory) -> NDArray[Any]: ...
    def _states(self) -> NDArray[Any]: ...
    def _set_states(self, states: list[list[float]], which: list[int]) -> NDArray[Any]: ...
    def _start_within(self, ranges: list[list[float]], which: list[int]) -> NDArray[Any]: ...
    def _episode_numbers(self, ahead: int = 0) -> NDArray[Any]: ...
    def _state(self) -> tuple[bytes, bool, bytes]: ...
    def _restore(self, state: tuple[bytes, bool, bytes]) -> None: ...
    def _close(self) -> None: ...
