"""The results of an audit."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._json import json_text
from ._settings import number
from .analysis import Advice, advise
from .linear import LinearPlant
from .perturbations import Steps

__all__ = ["ProbeReport"]

Array = NDArray[np.float64]


class ProbeReport:
    """The results of an audit of a step.

    :attr:`results` has all numbers under the keys of ``libration probe --json``, and ``exchange_latency``.
    """

    def __init__(self, results: dict[str, Any], holds: bool, page: str) -> None:
        self.results = results
        self.holds = holds
        """Whether the verdict is good: what was examined has no fault, and that decides."""
        self._page = page

    def __repr__(self) -> str:
        return f"<ProbeReport: {self.answer}>"

    @property
    def answer(self) -> str:
        """The answer in a few sentences."""
        return str(self.results["answer"])

    @property
    def verdict(self) -> dict[str, Any]:
        """``outcome`` (``"no-fault"``, ``"fault"`` or ``"unknown"``), its ``evidence``, and what the audit did not examine as ``not_examined``."""
        return {"not_examined": [], **self.results["verdict"]}

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Faults of the step, and facts without which its numbers mislead: ``kind``, ``is_fault``, ``text``, and what to change as ``help``."""
        return list(self.results["findings"])

    @property
    def notes(self) -> list[str]:
        """What the simulator says of itself."""
        return list(self.results["notes"])

    @property
    def modes(self) -> list[dict[str, Any]]:
        """The modes of the step beside those of the system, the one that grows fastest first."""
        return list(self.results["modes"])

    @property
    def numerical_damping(self) -> list[float | None]:
        """The damping ratio that the step adds to each mode."""
        return [mode["numerical_damping"] for mode in self.modes]

    @property
    def spectral_radius(self) -> float:
        """The largest factor of a mode per step; NaN if the step was not linearised."""
        found = self.results["spectral_radius"]
        return float("nan") if found is None else float(found)

    @property
    def largest_dt(self) -> float | None:
        """The longest stable step in s; None if no limit was found, or if there is no stable step."""
        found = self.results["largest_dt"]
        return None if found is None else found["dt"]

    @property
    def hidden_latency(self) -> list[dict[str, Any]]:
        """The latency of each input in s: of late commands, of the integrator, and in total. None: not examined.

        Discrete actions of an environment come last.
        """
        return list(self.results["hidden_latency"])

    @property
    def exchange_latency(self) -> float:
        """The latency in s of exchanging values with other simulators at the ends of steps: the macro step of a co-simulation, else 0."""
        return float(self.results.get("exchange_latency", 0.0))

    @property
    def delays(self) -> list[dict[str, Any]]:
        """Of commands that wait in a queue: the delays in steps and how many of the audited steps used them."""
        return list(self.results["delays"])

    @property
    def order(self) -> int | None:
        """The order of convergence; None if the estimates do not settle."""
        found = self.results["order"]
        return None if found is None else found["order"]

    @property
    def integrators(self) -> list[str]:
        """Names of the integrators whose results the step has, or if there are none, whose matrix."""
        found = self.results["recognition"]
        if found is None:
            return []
        return list(found["by_results"]["methods"] or (found["by_matrix"] or {}).get("methods", []))

    @property
    def defects(self) -> dict[str, Any] | None:
        """Defects of volume, symplecticity, reversibility and energy."""
        found: dict[str, Any] | None = self.results["defects"]
        return found

    @property
    def bits(self) -> dict[str, Any]:
        """Whether the same call gives the same bits."""
        return dict(self.results["bits"])

    @property
    def A(self) -> Array | None:
        """States × states of the step."""
        return self._matrix("step", "a")

    @property
    def B(self) -> Array | None:
        """States × inputs of the step."""
        return self._matrix("step", "b")

    @property
    def jacobian_error(self) -> float:
        """The largest estimated error of an entry of :attr:`A` and :attr:`B`, in parts of the largest entry of its row in units of the scales.

        Infinite if the step was not linearised.
        """
        found = self.results["jacobian_error"]
        return float("inf") if found is None else float(found)

    @property
    def repeat_command(self) -> str:
        """The command or the Python call that repeats the audit; empty if it is not known.

        A value without a short notation, such as a function without a name, is the name of its parameter.
        """
        return str(self.results["repeat_command"])

    def _matrix(self, of: str, name: str) -> Array | None:
        found = self.results[of]
        if found is None:
            return None
        n = len(self.results["states"])
        matrix = np.array(found[name], dtype=np.float64)
        return matrix.reshape(n, matrix.size // n)

    @property
    def plant(self) -> LinearPlant:
        """The plant in continuous time whose exact steps are those of the simulator, with all numerical damping.

        Raises
        ------
        ValueError
            If there is none: a mode changes its sign from step to step, or the step was not linearised. :attr:`sampled_plant` may exist.
        """
        self._check_linearised()
        if self.results["modified_flow"] is None:
            raise ValueError("the step is no exact step of a plant in continuous time; use sampled_plant, with latencies of whole steps")
        return self._plant("modified_flow", None)

    @property
    def sampled_plant(self) -> LinearPlant:
        """The plant of a step.

        Raises
        ------
        ValueError
            If the step was not linearised.
        """
        self._check_linearised()
        return self._plant("step", float(self.results["dt"]))

    def _check_linearised(self) -> None:
        if self.results["step"] is None:
            raise ValueError("the step was not linearised; see findings")

    def _plant(self, of: str, dt: float | None) -> LinearPlant:
        a, b = self._matrix(of, "a"), self._matrix(of, "b")
        assert a is not None and b is not None
        if b.shape[1] == 0:
            raise ValueError("the audit has no actions; a plant requires an input: the step has none, or the audit held its commands (see findings)")
        return LinearPlant(a, b, dt=dt, states=self.results["states"], inputs=self.results["inputs"])

    def advise(self, controller: Any, *, period: float | None = None, exchange: bool = True, **keywords: Any) -> Advice:
        """Return the limits of a loop around the step, by :func:`libration.advise` with all its keywords.

        Deviations from the state and the action are controlled. Latencies that were found in the step and :attr:`exchange_latency` are
        added to ``latency``.

        Parameters
        ----------
        period:
            Sample period of the controller in s (default: a step).
        exchange:
            Whether to add :attr:`exchange_latency`; False for a controller that acts within the same step, as in a program that calls the
            step itself.
        """
        plant = self.plant
        period = float(self.results["dt"]) if period is None else period
        late = np.full(len(self.results["inputs"]), self.exchange_latency if exchange else 0.0)
        entries = self.hidden_latency
        # An input that is set past the commands is as late as the discrete action in whose place it is.
        discrete = sum(float(entry["late"]) for entry in entries[len(late) :])
        for k, entry in enumerate(entries[: len(late)]):
            late[k] += discrete if entry["late"] is None else float(entry["late"])
        if late.any():
            keywords["latency"] = _added(keywords.get("latency"), late, period)
        return advise(plant, controller, period=period, **keywords)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the HTML page, or with the suffix ``.json`` all numbers; one that is not finite is null."""
        text = json_text(self.results) if str(path).endswith(".json") else self._page
        Path(path).write_text(text, encoding="utf-8")


def _is_latency(value: float) -> bool:
    return 0 <= value < float("inf")


def _added(latency: Any, late: Array, period: float) -> Any:
    """Return the latency of each input in s, with those of the step."""
    given = list(latency) if isinstance(latency, (list, tuple)) or np.ndim(latency) == 1 else [latency] * len(late)
    if len(given) != len(late):
        # Another number of latencies is an error of ``advise``.
        return latency

    def seconds(value: Any) -> float:
        of_steps = isinstance(value, Steps)
        found = number("latency", value.number if of_steps else 0.0 if value is None else value, "finite and at least 0", _is_latency)
        return found * period if of_steps else found

    return [seconds(one) + float(more) for one, more in zip(given, late)]
