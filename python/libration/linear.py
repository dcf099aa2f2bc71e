"""Linear plants of any size, and controllers of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MethodType
from typing import Any, Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._keywords import check_keywords
from ._matrices import array, columns, matrix
from ._settings import number, positive, shown
from ._toml import text_of
from ._transfer_functions import of_object, polynomials
from .operating_point import OperatingPoint, linearize
from .perturbations import LQR, PID, Steps, file_table, law

__all__ = [
    "LQG",
    "Butterworth2",
    "Cascade",
    "Difference",
    "Lag",
    "LinearPlant",
    "MovingAverage",
    "StateFeedback",
    "StateSpace",
]


@dataclass(frozen=True)
class Lag:
    """First-order lag before an input or behind an output, with a time constant in s."""

    seconds: float
    input: str | int | None = None
    """The name or number of the input; exactly one of ``input`` and ``output`` is required."""
    output: str | int | None = None
    name: str | None = None


@dataclass(frozen=True)
class Butterworth2:
    """Second-order Butterworth filter before an input or behind an output, with a cutoff frequency in Hz."""

    hertz: float
    input: str | int | None = None
    """The name or number of the input; exactly one of ``input`` and ``output`` is required."""
    output: str | int | None = None
    name: str | None = None


@dataclass(frozen=True)
class MovingAverage:
    """Mean of the last samples of an output, or of the last commands of an input. It runs with the controller."""

    samples: int
    input: str | int | None = None
    """The name or number of the input; exactly one of ``input`` and ``output`` is required."""
    output: str | int | None = None
    name: str | None = None


@dataclass(frozen=True)
class Difference:
    """Difference of the last two samples of an output over the period: its derivative per second. It runs with the controller."""

    output: str | int
    """The name or number of the output."""
    name: str | None = None


@dataclass(frozen=True, eq=False)
class LinearPlant:
    """A linear plant ``ẋ = Ax + Bu + Gw``, ``y = Cx + Du`` with white noise ``w`` of unit intensity.

    :meth:`mechanical`, :meth:`transfer_function` and :meth:`linearize` make one of another form. :func:`advise` also takes any object
    with ``A``, ``B``, ``C``, ``D`` and ``dt`` in its place, as ``control.ss`` and ``scipy.signal.StateSpace`` make them, or with
    ``num``, ``den`` and ``dt``, as ``control.tf`` and ``scipy.signal.TransferFunction`` do.
    """

    A: ArrayLike
    """States × states."""
    B: ArrayLike
    """States × inputs."""
    C: ArrayLike | None = None
    """Outputs × states (default: all states)."""
    D: ArrayLike | None = None
    """Outputs × inputs (default: zero)."""
    G: ArrayLike | None = None
    """States × noises (default: noise enters where the inputs do)."""
    dt: float | None = None
    """The period in s of a plant whose matrices are those of a step (default: continuous time)."""
    states: Sequence[str] | None = None
    """Names of the states, with units in parentheses: ``"angle (rad)"``."""
    inputs: Sequence[str] | None = None
    outputs: Sequence[str] | None = None
    parts: Sequence[Lag | Butterworth2 | MovingAverage | Difference] = field(default=())
    """Lags and filters of the channels."""
    operating_point: OperatingPoint | Any = None
    """The equilibrium at which :meth:`linearize` found the matrices; None of other plants."""

    @classmethod
    @check_keywords
    def mechanical(
        cls,
        mass: ArrayLike,
        damping: ArrayLike | None = None,
        stiffness: ArrayLike | None = None,
        force: ArrayLike | None = None,
        *,
        C: ArrayLike | None = None,
        D: ArrayLike | None = None,
        G: ArrayLike | None = None,
        states: Sequence[str] | None = None,
        inputs: Sequence[str] | None = None,
        outputs: Sequence[str] | None = None,
        parts: Sequence[Lag | Butterworth2 | MovingAverage | Difference] = (),
    ) -> LinearPlant:
        """Return the plant of masses, dampers and springs ``M q̈ + D q̇ + K q = B u``; its states are ``q`` and then ``q̇``.

        Parameters
        ----------
        mass, damping, stiffness:
            ``M``, ``D`` and ``K``, coordinates × coordinates, for 1 to 50 coordinates (default of the last two: zero).
        force:
            ``B``, coordinates × inputs; a vector is a column (default: an input for each coordinate).
        C, D:
            Outputs × states and outputs × inputs (default: the outputs are ``q``, without a direct path).
        G:
            States × noises, of all states (default: noise enters where the inputs do).
        states:
            Names of the coordinates, with units in parentheses. The rate of ``"angle (rad)"`` is ``"angle' (rad/s)"``.
        inputs, outputs, parts:
            As in :class:`LinearPlant`.

        Raises
        ------
        TypeError, ValueError
            For matrices that do not fit, or a singular mass matrix; the message names the matrix.
        """
        table: dict[str, Any] = {"mass": matrix("mass", mass)}
        for key, value in (("damping", damping), ("stiffness", stiffness)):
            if value is not None:
                table[key] = matrix(key, value)
        if force is not None:
            table["b"] = columns("force", force)
        for name, value in (("C", C), ("D", D)):
            if value is not None:
                table[name.lower()] = matrix(name, value)
        return cls._of_table(table, G, None, states, inputs, outputs, parts)

    @classmethod
    @check_keywords
    def transfer_function(
        cls,
        numerator: Any,
        denominator: Any,
        *,
        dt: float | None = None,
        G: ArrayLike | None = None,
        states: Sequence[str] | None = None,
        inputs: Sequence[str] | None = None,
        outputs: Sequence[str] | None = None,
        parts: Sequence[Lag | Butterworth2 | MovingAverage | Difference] = (),
    ) -> LinearPlant:
        """Return the plant of a transfer function, or of one for each output and input.

        Each has states of its own, in controllable canonical form, so that the plant may have more states than are necessary.

        Parameters
        ----------
        numerator, denominator:
            Polynomials by falling powers of ``s``, or of ``z`` with ``dt``: one, ``[1, 2]``, or nested lists outputs × inputs,
            ``[[[1], [2, 1]]]``.
        dt:
            The period in s of a sampled plant (default: continuous time).
        G, states, inputs, outputs, parts:
            As in :class:`LinearPlant`.

        Raises
        ------
        TypeError, ValueError
            For a numerator of higher degree than its denominator, a denominator of zero, or another structure.
        """
        table = {"numerator": polynomials("numerator", numerator), "denominator": polynomials("denominator", denominator)}
        period = None if dt is None else positive("dt", dt)
        return cls._of_table(table, G, period, states, inputs, outputs, parts)

    @classmethod
    def _of_table(
        cls,
        table: dict[str, Any],
        G: ArrayLike | None,
        dt: float | None,
        states: Any,
        inputs: Any,
        outputs: Any,
        parts: Sequence[Lag | Butterworth2 | MovingAverage | Difference],
    ) -> LinearPlant:
        """Return the plant of the keys of a plant file, which the engine reads."""
        if G is not None:
            table["g"] = columns("G", G)
        text = text_of("plant", table | _names(states, inputs, outputs))
        matrices, signals = _native._linear_plant(text)
        a, b, c, d, g = (np.array(rows) for rows in matrices)
        named = [[f"{name} ({unit})" if unit else name for name, unit in own] for own in signals]
        return cls(a, b, c, d, g, dt, named[0], named[1], named[2], parts)

    @classmethod
    @check_keywords
    def linearize(
        cls,
        f: Callable[..., ArrayLike],
        x0: ArrayLike,
        u0: ArrayLike,
        *,
        output: Callable[[np.ndarray, np.ndarray], ArrayLike] | None = None,
        dt: float | None = None,
        fixed_states: Sequence[str | int] | str | int = (),
        free_inputs: Sequence[str | int] | str | int = (),
        x_scale: ArrayLike | None = None,
        u_scale: ArrayLike | None = None,
        tolerance: float = 1e-8,
        G: ArrayLike | None = None,
        states: Sequence[str] | None = None,
        inputs: Sequence[str] | None = None,
        outputs: Sequence[str] | None = None,
        parts: Sequence[Lag | Butterworth2 | MovingAverage | Difference] = (),
    ) -> LinearPlant:
        """Linearise a nonlinear system at an equilibrium, which Newton's method finds.

        The states, inputs and outputs of the plant are deviations from ``plant.operating_point``.

        Parameters
        ----------
        f:
            ``f(x, u)`` returns the rates of the states, ``ẋ``. With ``dt`` it is a step of a simulator: ``f(x, u, dt)`` returns the
            states ``dt`` later, under the constant command ``u``. States must be independent of each other: a rotation is three
            numbers, not a quaternion.
        x0, u0:
            Where the search begins, vectors of at most 100 states and 1 to 100 inputs.
        output:
            ``output(x, u)`` returns the outputs (default: the states).
        dt:
            Length of a step in s; the plant is sampled then.
        fixed_states, free_inputs:
            States that stay at ``x0``, and inputs to solve for, by name or number. By default all states are solved for, and all
            inputs stay at ``u0``. If there are several equilibria, each step has the least norm relative to the scales.
        x_scale, u_scale:
            Typical deviations of states and inputs, numbers or vectors (default: the larger of 1 and the absolute starting value).
            Differences begin at a sixteenth of them.
        tolerance:
            Largest ``relative_residual`` of an equilibrium.
        G, states, inputs, outputs, parts:
            As in :class:`LinearPlant`.

        Raises
        ------
        TypeError, ValueError
            For an invalid value, no equilibrium (with the largest rate that is left), or a function that has no derivative there.
        """
        point, a, b, c, d = linearize(
            f,
            x0,
            u0,
            output=output,
            dt=dt,
            fixed_states=fixed_states,
            free_inputs=free_inputs,
            x_scale=x_scale,
            u_scale=u_scale,
            tolerance=tolerance,
            states=states,
            inputs=inputs,
        )
        return cls(a, b, c, d, G, dt, states, inputs, outputs, parts, point)


@dataclass(frozen=True, eq=False)
class StateFeedback:
    """Feedback ``u = -gain @ x`` of all states, inputs × states."""

    gain: ArrayLike


@dataclass(frozen=True, eq=False)
class LQG:
    """The regulator of a state that a Kalman filter estimates from the outputs, both designed for continuous time."""

    states: ArrayLike
    """Weights of the states, a matrix or its diagonal."""
    inputs: ArrayLike
    """Weights of the inputs, a matrix or its diagonal."""
    measurement: ArrayLike
    """Covariance of the noise of each sample, a matrix or its diagonal."""
    outputs: ArrayLike | None = None
    """Weights of the outputs, which add to those of the states, a matrix or its diagonal."""


@dataclass(frozen=True, eq=False)
class StateSpace:
    """A discrete controller ``m' = A m + B y``, ``u = C m + D y``, once per period."""

    A: ArrayLike
    B: ArrayLike
    C: ArrayLike
    D: ArrayLike


@dataclass(frozen=True, eq=False)
class Cascade:
    """An inner controller whose references an outer one computes less often.

    A controller is a matrix of gains (``u = gain @ y``, commands × measurements), a :class:`StateSpace`, or a list of PID controllers:
    outer ones ``(output, reference, PID)``, inner ones ``(output, input, PID)`` or ``(output, input, PID, reference)``, which hold
    the output at that reference. The outer controller measures the outputs, the inner one the outputs and then the references.
    """

    inner: Any
    outer: Any
    every: int
    """The outer controller runs in every so-manieth period."""
    inner_every: int = 1
    """The inner controller runs in every so-manieth period."""
    outer_latency: int = 0
    """The periods from a run of the outer controller until its references act, at most ``every``."""
    references: Sequence[str] | None = None
    """Names of the references, with units in parentheses (default: those of the outer PID controllers, or ``r1``, ``r2``, …)."""


def plant_of(system: Any) -> LinearPlant | None:
    """Return a linear plant for an object with the matrices of one; None for others."""
    if isinstance(system, LinearPlant):
        return system
    if isinstance(plant := getattr(system, "plant", None), MethodType):
        return plant()
    by_matrices = _has_matrices(system)
    fraction = None if by_matrices else of_object(system)
    if not by_matrices and fraction is None:
        if not hasattr(system, "to_ss"):
            return None
        system = system.to_ss()
        if not _has_matrices(system):
            return None
    dt = getattr(system, "dt", None)
    if dt is True:
        raise ValueError("system.dt is True, a period that is not given; expected a number of seconds, or 0 for continuous time")

    def labels(name: str) -> list[str] | None:
        found = getattr(system, name, None)
        return [str(label) for label in found] if found is not None else None

    period = float(dt) if dt else None
    if fraction is not None:
        return LinearPlant.transfer_function(
            *fraction, dt=period, inputs=labels("input_labels"), outputs=labels("output_labels")
        )
    return LinearPlant(
        system.A,
        system.B,
        system.C,
        system.D,
        dt=period,
        states=labels("state_labels"),
        inputs=labels("input_labels"),
        outputs=labels("output_labels"),
    )


def _has_matrices(system: Any) -> bool:
    return all(hasattr(system, name) for name in "ABCD")


def _names(states: Any, inputs: Any, outputs: Any) -> dict[str, list[str]]:
    """Return the names of signals by the keys of a plant file."""
    table = {}
    for key, names in (("states", states), ("inputs", inputs), ("outputs", outputs)):
        if isinstance(names, str):
            raise TypeError(f"{key} is {names!r:.60}; expected a list with a name for each")
        if names is not None:
            table[key] = [str(name) for name in names]
    return table


def _weights(name: str, value: ArrayLike) -> list[Any]:
    """Return a matrix row by row, or its diagonal."""
    weights = np.atleast_1d(array(name, value))
    if weights.ndim > 2:
        raise ValueError(f"{name} has shape {weights.shape}; expected a matrix or its diagonal")
    return weights.tolist()


def linear_request(plant: LinearPlant, controller: Any, timing: dict[str, Any], required: bool = True) -> dict[str, Any]:
    """Return the request for a loop around a linear plant as the content of a request file, without a controller if none is required."""
    # A vector is the column of the only input.
    table: dict[str, Any] = {"a": matrix("A", plant.A), "b": columns("B", plant.B)}
    for key, value in (("c", plant.C), ("d", plant.D)):
        if value is not None:
            table[key] = matrix(key.upper(), value)
    if plant.G is not None:
        table["g"] = columns("G", plant.G)
    table |= _names(plant.states, plant.inputs, plant.outputs)
    if plant.dt is not None:
        table["sampling-period"] = number("dt", plant.dt, "a number of seconds")
    if controller is None and required:
        raise TypeError("controller is missing; expected LQR, LQG, StateFeedback, StateSpace, Cascade or a list of PID for a linear plant")
    request: dict[str, Any] = {"system": {"linear": table}}
    if controller is not None:
        request["controller"] = _controller(controller)
    if plant.parts:
        # Feedback of the state measures the states.
        of_states = isinstance(controller, (LQR, StateFeedback)) or plant.C is None
        measured = ("x", plant.states) if of_states else ("y", plant.outputs)
        request["part"] = [_part(part, ("u", plant.inputs), measured) for part in plant.parts]
    # A sampled plant keeps its period.
    request["loop"] = _loop(timing | {"period": plant.dt} if timing.get("period") is None else timing)
    if timing["tolerance"] is not None:
        request["tolerance"] = tolerance_table(timing["tolerance"], "('cost', 0.05)")
    return request


def tolerance_table(tolerance: Any, example: str) -> dict[str, float]:
    """Return a pair of a kind and the most that is allowed as the content of the table ``[tolerance]``."""
    if isinstance(tolerance, str) or not isinstance(tolerance, Sequence) or len(tolerance) != 2 or not isinstance(tolerance[0], str):
        raise TypeError(f"tolerance is {shown(tolerance)}; expected a pair like {example}")
    return {tolerance[0]: number("tolerance", tolerance[1], "a number")}


def _part(
    part: Lag | Butterworth2 | MovingAverage | Difference, inputs: tuple[str, Any], outputs: tuple[str, Any]
) -> dict[str, Any]:
    if isinstance(part, Difference):
        table: dict[str, Any] = {"difference": True}
    elif isinstance(part, MovingAverage):
        table = {"moving-average": number("samples", part.samples, "a number")}
    elif isinstance(part, Lag):
        table = {"lag": number("lag", part.seconds, "a number")}
    else:
        table = {"butterworth2": number("butterworth2", part.hertz, "a number")}
    if part.name is not None:
        table["name"] = part.name
    for side, channel, (letter, names) in (
        ("input", getattr(part, "input", None), inputs),
        ("output", part.output, outputs),
    ):
        if isinstance(channel, int):
            # A name may have a unit in parentheses.
            table[side] = f"{letter}{channel + 1}" if names is None else str(names[channel]).partition("(")[0].strip()
        elif channel is not None:
            table[side] = channel
    return table


def _cost(of_states: str, states: Any, outputs: Any, of_inputs: str, inputs: Any) -> dict[str, Any]:
    given = {"states": (of_states, states), "outputs": ("outputs", outputs), "inputs": (of_inputs, inputs)}
    return {key: _weights(name, weights) for key, (name, weights) in given.items() if weights is not None}


def _controller(controller: Any) -> dict[str, Any]:
    if isinstance(controller, StateFeedback):
        return {"state-feedback": {"gain": matrix("gain", controller.gain)}}
    if isinstance(controller, LQR):
        if controller.inputs is None:
            raise ValueError("LQR has one argument; expected LQR(Q, R), weights of states and inputs, for a linear plant")
        return {"lqr": _cost("Q", controller.weights, controller.outputs, "R", controller.inputs)}
    if isinstance(controller, LQG):
        cost = _cost("states", controller.states, controller.outputs, "inputs", controller.inputs)
        return {"lqg": cost | {"measurement": _weights("measurement", controller.measurement)}}
    if isinstance(controller, StateSpace):
        return {"state-space": _state_space(controller)}
    if isinstance(controller, Cascade):
        return {"cascade": _cascade(controller)}
    if isinstance(controller, Sequence) and controller and all(isinstance(one, tuple) for one in controller):
        return {"pid": [_pid(*one) for one in controller]}
    expected = "LQR(Q, R), LQG, StateFeedback, StateSpace, Cascade, or a list of (output, input, PID)"
    raise TypeError(f"controller is {shown(controller)}; expected {expected}{_help(controller)}")


def _help(controller: Any) -> str:
    if not _has_matrices(controller):
        return ""
    return "; help: libration.StateSpace(A, B, C, D) is u = C m + D y, without the minus of a negative feedback"


def _state_space(controller: StateSpace) -> dict[str, Any]:
    empty = not np.size(controller.A)
    table = {} if empty else {key: matrix(key.upper(), getattr(controller, key.upper())) for key in "abc"}
    return {**table, "d": matrix("D", controller.D)}


def _cascade(cascade: Cascade) -> dict[str, Any]:
    counts = {name: getattr(cascade, name) for name in ("every", "inner_every", "outer_latency")}
    table: dict[str, Any] = {name.replace("_", "-"): number(name, value, "a number") for name, value in counts.items()}
    if cascade.references is not None:
        table["references"] = [str(name) for name in cascade.references]
    for side in ("inner", "outer"):
        table[side] = _cascaded(side, getattr(cascade, side))
    return table


def _cascaded(side: str, controller: Any) -> dict[str, Any]:
    if isinstance(controller, StateSpace):
        return {"state-space": _state_space(controller)}
    if isinstance(controller, Sequence) and controller and all(isinstance(one, tuple) for one in controller):
        pids = []
        for one in controller:
            if len(one) not in ((3, 4) if side == "inner" else (3,)) or not isinstance(one[2], PID):
                expected = "(output, input, PID) or (output, input, PID, reference)" if side == "inner" else "(output, reference, PID)"
                raise TypeError(f"{side} has the entry {one!r:.60}; expected {expected}")
            names = {"output": one[0], "input" if side == "inner" else "reference": one[1]}
            if len(one) == 4:
                names["reference"] = one[3]
            pids.append({**names, **_gains(one[2])})
        return {"pid": pids}
    if _has_matrices(controller):
        expected = "a matrix of gains, StateSpace, or a list of PID controllers"
        raise TypeError(f"{side} is {shown(controller)}; expected {expected}{_help(controller)}")
    return {"gain": matrix(side, controller)}


def _pid(output: str, input: str, gains: PID) -> dict[str, Any]:
    return {"output": output, "input": input, **_gains(gains)}


def _gains(gains: PID) -> dict[str, Any]:
    table = file_table(gains)
    return {name: number(name, table[name], "a number") for name in ("proportional", "integral", "derivative", "filter")}


def _loop(timing: dict[str, Any]) -> dict[str, Any]:
    loop: dict[str, Any] = {}
    for name in ("period", "skew", "loss", "overrun_probability"):
        if (value := timing.get(name)) is not None:
            loop[name.replace("_", "-")] = number(name, value, "a number", lambda _: True)
    for name in ("missing", "overrun", "deadline_misses"):
        value = timing.get(name)
        if value is not None:
            if not isinstance(value, str):
                example = {"missing": "'hold' or 'zero'", "overrun": "'kill', 'skip' or 'queue'"}.get(name, "text like '2 of 5'")
                raise TypeError(f"{name} is {value!r:.60}; expected {example}")
            loop[name.replace("_", "-")] = value
    period = loop.get("period", 0.01)

    def seconds(name: str, value: Any) -> float:
        if isinstance(value, Steps):
            return number(name, value.number, "finite and at least 0") * period
        return number(name, value, "finite and at least 0")

    for name in ("latency", "output_latency"):
        value = timing[name]
        if value is None:
            continue
        several = isinstance(value, (list, tuple)) or np.ndim(value) == 1
        loop[name.replace("_", "-")] = [seconds(name, one) for one in value] if several else seconds(name, value)
    if timing["jitter"] is not None:
        loop["law"], loop["jitter"] = law("jitter", timing["jitter"]) or ("gaussian", 0.0)
    if timing["cost_weights"] is not None:
        weights = timing["cost_weights"]
        if isinstance(weights, Mapping):
            if unknown := set(weights) - {"states", "outputs", "inputs"}:
                raise ValueError(f"cost_weights has the key {sorted(unknown)[0]!r:.60}; expected 'states', 'outputs' and 'inputs'")
            loop["cost"] = {key: _weights("cost_weights", one) for key, one in weights.items()}
        elif isinstance(weights, (tuple, list)) and len(weights) == 2:
            states, inputs = weights
            loop["cost"] = {"states": _weights("cost_weights", states), "inputs": _weights("cost_weights", inputs)}
        else:
            raise TypeError(
                f"cost_weights is {weights!r:.60}; expected (Q, R), weights of states and inputs, or a dictionary of those of "
                "'states', 'outputs' and 'inputs'"
            )
    if timing.get("clock") is not None:
        loop["clock"] = str(timing["clock"])
    if timing["measurement_noise"] is not None:
        loop["measurement-noise"] = _weights("measurement_noise", timing["measurement_noise"])
    return loop
