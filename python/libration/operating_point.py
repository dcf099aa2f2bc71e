"""Operating points of nonlinear systems, and the matrices of a system linearised there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._derivatives import Array, central_jacobian, extrapolated_jacobian
from ._settings import count, nearest, positive

__all__ = ["OperatingPoint"]

MOST_STATES = 100
MOST_ITERATIONS = 100
LARGEST_JACOBIAN_ERROR = 0.01
"""Largest relative error of a row at which a function counts as differentiable."""


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """An equilibrium of a system under a constant command. States, inputs and outputs of its linear plant are deviations from it."""

    x: Array
    """States."""
    u: Array
    """Inputs."""
    y: Array | None
    """Outputs, if the system has an output function."""
    residual: float
    """The largest absolute rate of a state; of a sampled system the largest change of a state in a step."""
    relative_residual: float | None
    """The residual as a shift of states and inputs that would cause it, relative to their scales; None of equations."""
    jacobian_error: float | None
    """Estimated error of the Jacobians, relative to the largest entry of each row, with variables in units of their scales; None where
    derivatives are exact."""
    iterations: int | None
    """Iterations of Newton's method; None of equations."""
    scale: Array | None = field(repr=False)
    """Scales of the states and then of the inputs; None of equations."""

    def __repr__(self) -> str:
        def numbers(values: Array) -> str:
            return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"

        error = self.jacobian_error
        accuracy = "exact derivatives" if error is None else f"relative error of the Jacobian {error:.1e}"
        return f"<OperatingPoint: x = {numbers(self.x)}, u = {numbers(self.u)}, residual {self.residual:.1e}, {accuracy}>"


@dataclass(frozen=True)
class Variables:
    """Names and starting values of states and inputs."""

    x: Array
    u: Array
    scale: Array
    states: Sequence[str]
    inputs: Sequence[str]
    unknown: NDArray[np.int_]
    """Numbers of the states and inputs to solve for; inputs are numbered after the states."""

    def name(self, number: int) -> str:
        n = len(self.states)
        return f"state {self.states[number]!r}" if number < n else f"input {self.inputs[number - n]!r}"


def linearize(
    f: Callable[..., ArrayLike],
    x0: ArrayLike,
    u0: ArrayLike,
    *,
    output: Callable[[Array, Array], ArrayLike] | None,
    dt: float | None,
    fixed_states: Sequence[str | int] | str | int,
    free_inputs: Sequence[str | int] | str | int,
    x_scale: ArrayLike | None,
    u_scale: ArrayLike | None,
    tolerance: float,
    states: Sequence[str] | None,
    inputs: Sequence[str] | None,
) -> tuple[OperatingPoint, Array, Array, Array | None, Array | None]:
    """Return the operating point and the matrices ``A``, ``B``, ``C`` and ``D``; see :meth:`libration.LinearPlant.linearize`."""
    if not callable(f):
        raise TypeError(f"f is {f!r:.60}; expected a function f(x, u) that returns the rates of the states")
    tolerance = positive("tolerance", tolerance)
    variables = _variables(x0, u0, fixed_states, free_inputs, (x_scale, u_scale), states, inputs)
    n = len(variables.x)
    if dt is None:
        raw = _checked("f", lambda x, u: f(x, u), n)
    else:
        period = positive("dt", dt)
        raw = _checked("f", lambda x, u: f(x, u, period), n)

    def balance(z: Array) -> Array:
        """The rates of the states, or their changes in a step: zero at an equilibrium."""
        return raw(z[:n], z[n:]) - (0.0 if dt is None else z[:n])

    z, iterations = _equilibrium(balance, variables, tolerance, dt)
    jacobian, error = _jacobian("f", balance, z, variables)
    rest = balance(z)
    sizes = np.abs(jacobian) @ variables.scale
    relative = float(np.max(_quotient(np.abs(rest), sizes)))
    y, c, d, error_of_output = None, None, None, 0.0
    if output is not None:
        measured = _checked("output", output, None)
        y = measured(z[:n], z[n:])
        if not np.isfinite(y).all():
            raise ValueError(f"output returns {y[~np.isfinite(y)][0]} at the operating point; expected finite numbers")
        of_output, error_of_output = _jacobian("output", lambda z: measured(z[:n], z[n:]), z, variables)
        c, d = of_output[:, :n], of_output[:, n:]
    point = OperatingPoint(
        z[:n], z[n:], y, float(np.max(np.abs(rest))), relative, max(error, error_of_output), iterations, variables.scale
    )
    a = jacobian[:, :n] if dt is None else jacobian[:, :n] + np.eye(n)
    return point, a, jacobian[:, n:], c, d


def _equilibrium(
    balance: Callable[[Array], Array], variables: Variables, tolerance: float, dt: float | None
) -> tuple[Array, int]:
    """Solve ``balance(z) = 0`` by Newton's method, with steps of least norm relative to the scales, halved until they improve.

    The iteration goes on to where rounding ends it. The result is an equilibrium if a shift of the variables by ``tolerance`` of
    their scales could cause the rest.
    """
    what = "rate" if dt is None else "change in a step"
    scale, unknown = variables.scale, variables.unknown
    z = np.concatenate([variables.x, variables.u])
    rest = balance(z)
    if not np.isfinite(rest).all():
        raise ValueError(f"f returns {rest[~np.isfinite(rest)][0]} at x0 and u0; expected finite numbers")
    iterations = 0
    for iterations in range(MOST_ITERATIONS):
        jacobian = central_jacobian(balance, z, scale)
        if not np.isfinite(jacobian).all():
            j = int(np.argmin(np.isfinite(jacobian).all(axis=0)))
            raise ValueError(f"f is not finite near {variables.name(j)} = {z[j]:g}; expected finite numbers")
        sizes = np.abs(jacobian) @ scale
        if not iterations:
            _check_repeats("f", rest, balance(z), sizes)
        relative = _quotient(np.abs(rest), sizes)
        if not rest.any() or not len(unknown):
            break
        influence = np.abs(jacobian[:, unknown]) @ scale[unknown]
        # A shift by 10⁹ scales is none that Newton's method can find.
        beyond = np.abs(rest) > 1e9 * influence
        if (beyond & (relative > tolerance)).any():
            i = int(np.argmax(beyond & (relative > tolerance)))
            raise ValueError(
                f"the {what} of state {variables.states[i]!r} is {rest[i]:g}, and nothing that is solved for has an influence on it; "
                "help: free an input or a state, or begin elsewhere"
            )
        rows = np.where(influence > 0, 1 / np.where(influence > 0, influence, 1.0), 0.0)
        system = rows[:, np.newaxis] * jacobian[:, unknown] * scale[unknown]
        # Entries have about ten digits, so smaller singular values are zero.
        shift = np.linalg.lstsq(system, -rows * rest, rcond=1e-9)[0]
        shift *= min(1.0, 10.0 / float(np.max(np.abs(shift), initial=1e-300)))
        size = float(np.linalg.norm(rows * rest))
        factor = 1.0
        while factor > 1e-9:
            tried = z.copy()
            tried[unknown] += factor * shift * scale[unknown]
            rest_tried = balance(tried)
            if np.isfinite(rest_tried).all() and np.linalg.norm(rows * rest_tried) < (1 - 1e-4 * factor) * size:
                break
            factor /= 2
        else:
            break
        z, rest = tried, rest_tried
    i = int(np.argmax(relative))
    if relative[i] > tolerance:
        solved = "" if len(unknown) else "; all states are fixed and all inputs are held"
        raise ValueError(
            f"no equilibrium found: after {iterations} iterations the {what} of state {variables.states[i]!r} is {rest[i]:.3g} at "
            f"x = {_short(z[: len(variables.x)])}, u = {_short(z[len(variables.x) :])}{solved}; "
            "help: begin nearer to one, free an input, or smooth jumps of f"
        )
    return z, iterations


def _jacobian(
    name: str, function: Callable[[Array], Array], z: Array, variables: Variables
) -> tuple[Array, float]:
    """Return the Jacobian with its relative error."""
    before = function(z)
    jacobian, error = extrapolated_jacobian(function, z, variables.scale)
    sizes = np.max(np.abs(jacobian) * variables.scale, axis=1)
    missing = np.isnan(jacobian).any(axis=0)
    if missing.any():
        j = int(np.argmax(missing))
        raise ValueError(f"{name} is not finite near {variables.name(j)} = {z[j]:g}; expected finite numbers there")
    _check_repeats(name, before, function(z), sizes)
    relative = _quotient(error * variables.scale, sizes[:, np.newaxis])
    if (worst := float(np.max(relative))) > LARGEST_JACOBIAN_ERROR:
        i, j = divmod(int(np.argmax(relative)), relative.shape[1])
        raise ValueError(
            f"entry {i + 1} of {name} has no derivative by {variables.name(j)} at {z[j]:g}: its relative error is {worst:.1g}; "
            "expected a smooth function; help: smooth friction, contacts and limits, or change x_scale and u_scale"
        )
    return jacobian, worst


def _check_repeats(name: str, before: Array, again: Array, sizes: Array) -> None:
    """Check that a function returns the same as before it was called for other arguments, to a millionth of its row."""
    if not np.array_equal(before, again) and np.max(_quotient(np.abs(again - before), sizes)) > 1e-6:
        raise ValueError(
            f"{name} returns values that differ by {np.max(np.abs(again - before)):.3g} for the same x and u; "
            "expected a function of x and u alone; help: set the whole state of the simulator in it"
        )


def _quotient(part: Array, whole: Array) -> Array:
    """Return ``part / whole``, 0 where both are zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(part == 0, 0.0, part / whole)


def _checked(name: str, function: Callable[..., ArrayLike], entries: int | None) -> Callable[[Array, Array], Array]:
    """Return the function with a check of what it returns. It gets copies, and its result is copied: it may use them again."""
    expected = entries

    def checked(x: Array, u: Array) -> Array:
        nonlocal expected
        value = function(x.copy(), u.copy())
        if value is None:
            raise TypeError(f"{name} returns None; expected an array of {'numbers' if expected is None else f'shape ({expected},)'}")
        array = np.asarray(value)
        if array.dtype.kind not in "fiu":
            raise TypeError(f"{name} returns dtype {array.dtype}; expected real numbers")
        if expected is None:
            expected = array.size if array.ndim <= 1 else None
            array = np.atleast_1d(array)
        if array.shape != (expected,) or not expected:
            wanted = "(outputs,)" if expected is None else f"({expected},)"
            raise ValueError(f"{name} returns an array of shape {array.shape}; expected {wanted}")
        return np.array(array, dtype=np.float64)

    return checked


def _variables(
    x0: ArrayLike,
    u0: ArrayLike,
    fixed_states: Sequence[str | int] | str | int,
    free_inputs: Sequence[str | int] | str | int,
    scales: tuple[ArrayLike | None, ArrayLike | None],
    states: Sequence[str] | None,
    inputs: Sequence[str] | None,
) -> Variables:
    x, u = _vector("x0", x0), _vector("u0", u0)
    count("the number of states", len(x), 1, MOST_STATES)
    count("the number of inputs", len(u), 1, MOST_STATES)
    scale = []
    for name, given, start in (("x_scale", scales[0], x), ("u_scale", scales[1], u)):
        one = np.maximum(1.0, np.abs(start)) if given is None else _vector(name, given)
        if len(one) not in (1, len(start)):
            raise ValueError(f"{name} has {len(one)} entries; expected 1 or {len(start)}")
        one = np.broadcast_to(one, start.shape)
        if not (one > 0).all():
            raise ValueError(f"{name} has the entry {one[one <= 0][0]:g}; expected numbers above 0")
        scale.append(one)
    of_states, of_inputs = _labels("states", states, "x", len(x)), _labels("inputs", inputs, "u", len(u))
    fixed = _numbers("fixed_states", fixed_states, of_states)
    free = _numbers("free_inputs", free_inputs, of_inputs)
    unknown = [i for i in range(len(x)) if i not in fixed] + [len(x) + i for i in sorted(free)]
    return Variables(x, u, np.concatenate(scale), of_states, of_inputs, np.array(unknown, dtype=int))


def _vector(name: str, value: ArrayLike) -> Array:
    array = np.atleast_1d(np.asarray(value))
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}; expected real numbers")
    if array.ndim != 1:
        raise ValueError(f"{name} has shape {array.shape}; expected a vector")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} has an entry that is not finite; expected finite numbers")
    return array.astype(np.float64)


def _labels(name: str, given: Sequence[str] | None, letter: str, length: int) -> list[str]:
    """Return names without units."""
    if given is None:
        return [f"{letter}{i + 1}" for i in range(length)]
    if isinstance(given, str) or len(given) != length:
        number = 1 if isinstance(given, str) else len(given)
        raise ValueError(f"{name} has {number} names; expected {length}, one for each entry of {letter}0")
    return [str(one).partition("(")[0].strip() for one in given]


def _numbers(name: str, given: Sequence[str | int] | str | int, labels: Sequence[str]) -> set[int]:
    """Return the numbers of signals that are given by name or number."""
    found = set()
    for one in (given,) if isinstance(given, (str, int)) else given:
        if isinstance(one, str):
            label = one.partition("(")[0].strip()
            if label not in labels:
                raise ValueError(f"{name} has the unknown name {label!r}: {nearest(label, labels)}")
            found.add(labels.index(label))
        else:
            found.add(count(name, one, 0, len(labels) - 1))
    return found


def _short(values: Array) -> str:
    shown = ", ".join(f"{value:.3g}" for value in values[:6])
    return f"[{shown}{', …' if len(values) > 6 else ''}]"
