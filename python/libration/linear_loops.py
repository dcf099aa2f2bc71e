"""Many loops around a linear plant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._keywords import check_keywords
from ._settings import count, nearest, number, shown
from ._toml import text_of
from .linear import linear_request, plant_of

__all__ = ["LinearLoops", "LinearRollout"]


@dataclass(frozen=True, eq=False)
class LinearRollout:
    """Rows of many loops. A row belongs to the beginning of a period, after the controller has run."""

    time: NDArray[np.float64]
    """Times in s, ``(rows, num_loops)``; with jitter each loop has its own."""
    states: NDArray[np.float64]
    """States of the plant, ``(rows, num_loops, states)``."""
    outputs: NDArray[np.float64]
    """Measurements that the controller reads in this period, with their latency and noise, ``(rows, num_loops, outputs)``."""
    inputs: NDArray[np.float64]
    """Commands that act at the inputs, with their disturbance, ``(rows, num_loops, inputs)``."""
    cost: NDArray[np.float64]
    """Cost since the start, ``(rows, num_loops)``: the integral of its rate; of a sampled plant its sum over samples."""


class LinearLoops:
    """Loops around a linear plant, which the engine steps together, exactly.

    Between the events of a period the plant moves by matrix exponentials. White noise has its exact covariance in each part of a
    period, and the cost is integrated over continuous time; under noise it is the expectation, given the state at the beginning of
    each part. Loop ``n`` has the same bits for any ``num_loops`` and ``threads``.

    Parameters
    ----------
    plant, controller:
        As in :func:`~libration.advise` for a linear plant; without a controller the loops are open.
    num_loops:
        Number of loops.
    period:
        Period in s (default: 0.01, or ``dt`` of a sampled plant).
    latency, output_latency, jitter, skew, loss, missing, cost_weights, measurement_noise:
        As in :func:`~libration.advise`.
    reference:
        What the controller subtracts from its measurements: a value for each output, or a dictionary by name (default: zeros).
    disturbance:
        What is added to the commands: a value for each input, or a dictionary by name (default: zeros).
    noise:
        Whether the plant and the measurements have their noise. The default noise of a plant is white, of unit intensity, and enters
        where its inputs do.
    x0, seed:
        As in :meth:`reset`.
    threads:
        Number of threads (0: one per core).

    Raises
    ------
    TypeError, ValueError
        For an invalid value; the message has the name of the parameter and the allowed values.
    MemoryError
        If there is not enough memory.
    """

    _open = False

    @check_keywords
    def __init__(
        self,
        plant: Any,
        controller: Any = None,
        num_loops: int = 1,
        *,
        period: float | None = None,
        latency: Any = None,
        output_latency: Any = None,
        jitter: Any = None,
        skew: float | None = None,
        loss: float | None = None,
        missing: str | None = None,
        cost_weights: Any = None,
        measurement_noise: ArrayLike | None = None,
        reference: ArrayLike | Mapping[str, float] | None = None,
        disturbance: ArrayLike | Mapping[str, float] | None = None,
        noise: bool = False,
        x0: ArrayLike | None = None,
        seed: int = 0,
        threads: int = 1,
    ) -> None:
        found = plant_of(plant)
        if found is None:
            raise TypeError(f"plant is {shown(plant)}; expected a LinearPlant, or an object with A, B, C, D and dt or with num, den and dt")
        timing = {
            "period": found.dt if period is None else period,
            "latency": latency,
            "output_latency": output_latency,
            "jitter": jitter,
            "skew": skew,
            "loss": loss,
            "missing": missing,
            "cost_weights": cost_weights,
            "measurement_noise": measurement_noise,
            "tolerance": None,
        }
        self.num_loops = count("num_loops", num_loops, 1, 2**40)
        request = text_of("config", linear_request(found, controller, timing, required=False))
        self._loops = _native.LinearLoops(
            request, self.num_loops, count("threads", threads, 0, 1024), bool(noise), self._open
        )
        names = [[name for name, _ in signals] for signals in self._loops._names()]
        self.state_names, self.input_names, self.output_names = (tuple(own) for own in names)
        self.units: Mapping[str, str] = {name: unit for signals in self._loops._names() for name, unit in signals}
        """Units of states, inputs and outputs by name."""
        self._reference = _constants("reference", reference, self.output_names)
        self._disturbance = _constants("disturbance", disturbance, self.input_names)
        self.reset(seed, x0)

    @property
    def period(self) -> float:
        """Period in s."""
        return self._loops._period()

    @property
    def step_count(self) -> int:
        """Number of periods since the start."""
        return self._loops._step()

    def reset(self, seed: int = 0, x0: ArrayLike | None = None) -> None:
        """Begin anew.

        Parameters
        ----------
        seed:
            Seed of all random numbers.
        x0:
            Initial states, ``(states,)`` for all loops or ``(num_loops, states)`` (default: zeros).
        """
        shape = (self.num_loops, len(self.state_names))
        start = np.zeros(shape) if x0 is None else np.asarray(x0, dtype=np.float64)
        if start.shape not in (shape, shape[1:]):
            raise ValueError(f"x0 has shape {start.shape}; expected {shape[1:]} or {shape}")
        if not np.isfinite(start).all():
            raise ValueError("x0 has an entry that is not finite; expected finite numbers")
        self._loops._set_constants(self._reference, self._disturbance)
        self._loops._reset(count("seed", seed, 0, 2**64 - 1), np.ascontiguousarray(np.broadcast_to(start, shape)))

    def set_reference(self, reference: ArrayLike | Mapping[str, float]) -> None:
        """Change the reference from the next period on."""
        self._reference = _constants("reference", reference, self.output_names)
        self._loops._set_constants(self._reference, self._disturbance)

    def set_disturbance(self, disturbance: ArrayLike | Mapping[str, float]) -> None:
        """Change the disturbance from now on."""
        self._disturbance = _constants("disturbance", disturbance, self.input_names)
        self._loops._set_constants(self._reference, self._disturbance)

    def step(self, periods: int = 1) -> LinearRollout:
        """Go on by ``periods`` periods and return the present row; its arrays have no axis of rows."""
        self._loops._advance(count("periods", periods, 0, 2**62))
        return LinearRollout(*(array[0] for array in self._loops._rollout(1, 1)))

    def rollout(self, periods: int, every: int = 1) -> LinearRollout:
        """Go on by ``periods`` periods; the rows are the present one and each ``every``-th after it."""
        every = count("every", every, 1, 2**62)
        periods = count("periods", periods, 0, 2**62)
        if periods % every:
            raise ValueError(f"periods is {periods}; expected a multiple of every, {every}")
        return LinearRollout(*self._loops._rollout(periods // every + 1, every))

    def __len__(self) -> int:
        return self.num_loops

    def __repr__(self) -> str:
        return f"<LinearLoops: {self.num_loops} loops of {len(self.state_names)} states, period {self.period:g} s>"

    def __copy__(self) -> LinearLoops:
        raise TypeError("LinearLoops cannot be copied; help: make others with the same arguments")

    def __reduce__(self) -> Any:
        raise TypeError("LinearLoops cannot be pickled; help: make others with the same arguments")


class OpenLoops(LinearLoops):
    """Loops whose commands the caller gives, period by period. They rest before commands are computed."""

    _open = True

    def command(self, commands: NDArray[np.float64]) -> LinearRollout:
        """Go on by a period with commands, ``(num_loops, inputs)``, and return the present row."""
        self._loops._advance_by(commands)
        return LinearRollout(*(array[0] for array in self._loops._rollout(1, 1)))


def _constants(name: str, given: Any, known: Sequence[str]) -> list[float]:
    """Return a value for each signal."""
    if given is None:
        return [0.0] * len(known)
    if isinstance(given, Mapping):
        values = dict.fromkeys(known, 0.0)
        for key, value in given.items():
            if key not in values:
                raise ValueError(f"{name} has the unknown name {key!r}: {nearest(str(key), known)}")
            values[key] = number(name, value, "finite")
        return list(values.values())
    values_given = np.atleast_1d(np.asarray(given, dtype=np.float64))
    if values_given.shape != (len(known),):
        raise ValueError(f"{name} has shape {values_given.shape}; expected ({len(known)},), a value for each of {', '.join(known)}")
    return [number(name, value, "finite") for value in values_given.tolist()]
