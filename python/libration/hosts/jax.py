"""Functions of JAX as steps, in float64."""

from __future__ import annotations

import importlib
from typing import Any, Callable, Iterator, Sequence

import jax
import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._keywords import check_keywords
from .._settings import positive
from .host import Host

Array = NDArray[np.float64]

# Rows of one call of the compiled function. XLA rounds sums of products differently for other numbers of rows, so that a row alone
# would differ from the same row in a batch.
_ROWS = 32
_SHORT = ("float32", "float16", "bfloat16")


@check_keywords
def jax_host(
    step: Callable[..., Any],
    state: ArrayLike,
    action: ArrayLike = (),
    dt: float | None = None,
    *,
    energy: Callable[..., Any] | None = None,
    states: Sequence[str] | None = None,
    inputs: Sequence[str] | None = None,
    title: str | None = None,
) -> Host:
    """Return a function of JAX as a host.

    The function is traced, compiled and batched in float64. The option ``jax_enable_x64`` stays as it is outside of the host's calls.
    ``reference_A`` and ``reference_B`` are those of ``jax.jacfwd``.

    Parameters
    ----------
    step:
        A pure function ``step(x, u, dt)`` of a state, an action and a timestep in s; it returns the state after the step.
    state, action:
        The point: n and m numbers.
    dt:
        Timestep in s at which the step is described.
    energy:
        A pure function ``energy(x)`` that returns the mechanical energy in J.
    states, inputs:
        Names of states and actions, with units in parentheses.
    title:
        Title (default: the name of the function).

    Raises
    ------
    TypeError, ValueError
        For a function that JAX cannot trace, or a state after the step of another shape or type.
    """
    for name, function in (("step", step), ("energy", energy)):
        if not callable(function) and not (name == "energy" and function is None):
            raise TypeError(f"{name} must be a function, not {type(function).__name__}")
    if dt is None:
        raise TypeError("dt is missing; expected the timestep in s")
    timestep = positive("dt", dt)
    start, vector = _vector("state", state), _vector("action", action)
    n, m = len(start), len(vector)
    notes: list[str] = []
    with _float64():
        _trace("step", step, (start, vector, timestep), (n,), notes)
        if energy is not None:
            _trace("energy", energy, (start,), (), notes)
    simulation = _Function(step, energy, start, vector)
    after = simulation.step(start[np.newaxis], vector[np.newaxis], timestep)[0]
    rest = bool(np.max(np.abs(after - start), initial=0.0) <= 1e-12 * max(1.0, float(np.max(np.abs(start), initial=0.0))))
    if not rest:
        notes.append("the point is no equilibrium: a step changes it")
    reference_a, reference_b = _reference(step, start, vector, timestep, notes)
    return Host(
        step=simulation.step,
        state=start,
        action=vector,
        dt=timestep,
        states=_names("states", states, "x", n),
        inputs=_names("inputs", inputs, "u", m),
        title=title if title is not None else getattr(step, "__name__", type(step).__name__),
        integrator="unknown",
        version=f"JAX {jax.__version__}",
        energy=None if energy is None else simulation.energy,
        equilibrium=rest,
        notes=tuple(notes),
        reference_A=reference_a,
        reference_B=reference_b,
        reference_source="" if reference_a is None else "jax.jacfwd",
        reference_is_exact=reference_a is not None,
    )


class _Function:
    """A step and an energy, compiled for blocks of rows."""

    def __init__(self, step: Callable[..., Any], energy: Callable[..., Any] | None, start: Array, vector: Array) -> None:
        self.start, self.vector = start, vector
        self.steps = jax.jit(jax.vmap(step, (0, 0, None)))
        self.energies = None if energy is None else jax.jit(jax.vmap(energy))

    def step(self, states: Array, actions: Array, dt: float) -> Array:
        states, actions = _rows("states", states, len(self.start)), _rows("actions", actions, len(self.vector))
        if len(actions) != len(states):
            raise ValueError(f"actions has {len(actions)} rows; expected {len(states)}, as many as states")
        dt = positive("dt", dt)
        valid = np.isfinite(np.concatenate([states, actions], axis=1)).all(axis=1, keepdims=True)
        # A row that is not finite may keep a loop of the function running.
        states = np.where(valid, states, self.start)
        actions = np.where(valid, actions, self.vector)
        after = np.empty_like(states)
        with _float64():
            for first in range(0, len(states), _ROWS):
                block = slice(first, first + _ROWS)
                found = self.steps(_filled(states[block]), _filled(actions[block]), dt)
                after[block] = np.asarray(found, dtype=np.float64)[: len(states[block])]
        return np.where(valid, after, np.nan)

    def energy(self, states: Array) -> Array:
        """Return the energy in J of each row."""
        states = _rows("states", states, len(self.start))
        found = np.empty(len(states))
        assert self.energies is not None
        with _float64():
            for first in range(0, len(states), _ROWS):
                block = slice(first, first + _ROWS)
                found[block] = np.asarray(self.energies(_filled(states[block])), dtype=np.float64)[: len(states[block])]
        return found


def _float64() -> Any:
    """Return the context in which JAX computes in float64."""
    if hasattr(jax, "enable_x64"):
        return jax.enable_x64(True)
    experimental: Any = importlib.import_module("jax.experimental")
    # Older versions of JAX.
    return experimental.enable_x64()


def _filled(rows: Array) -> Array:
    """Return a whole block, whose last rows repeat the first one."""
    return np.concatenate([rows, np.repeat(rows[:1], _ROWS - len(rows), axis=0)])


def _trace(name: str, function: Callable[..., Any], arguments: tuple[Any, ...], expected: tuple[int, ...], notes: list[str]) -> None:
    """Check the shape and type of the result, and add notes of numbers in less than float64."""
    try:
        program, shape = jax.make_jaxpr(function, return_shape=True)(*arguments)
    except jax.errors.ConcretizationTypeError as error:
        what = str(error).splitlines()[0]
        raise ValueError(
            f"JAX cannot trace {name}: {what}; help: use jax.numpy and jax.lax.cond in place of numpy, float() and if"
        ) from error
    except Exception as error:
        raise ValueError(f"{name} fails at the point: {type(error).__name__}: {' '.join(str(error).split())[:300]}") from error
    if not hasattr(shape, "shape"):
        raise TypeError(f"{name} returns a {type(shape).__name__}; expected an array of shape {expected}")
    if shape.shape != expected:
        raise ValueError(f"{name} returns an array of shape {shape.shape}; expected {expected}")
    if not np.issubdtype(shape.dtype, np.floating) and str(shape.dtype) not in _SHORT:
        raise TypeError(f"{name} returns numbers of type {shape.dtype}; expected float64")
    kinds = sorted({kind for kind in _conversions(program.jaxpr)})
    if kinds:
        notes.append(
            f"{name} computes in {' and '.join(kinds)} inside: differences have about three digits; "
            f"help: remove conversions to {' and '.join(kinds)}"
        )
    short = sorted({str(c.dtype) for c in _constants(program) if str(getattr(c, "dtype", "")) in _SHORT})
    if short:
        notes.append(
            f"{name} has constants in {' and '.join(short)}, which have about seven digits or fewer; "
            "help: make them with numpy, or set jax_enable_x64 before they are made"
        )


def _conversions(jaxpr: Any) -> Iterator[str]:
    """Yield the short types to which a program converts longer numbers."""
    for equation in jaxpr.eqns:
        if equation.primitive.name in ("convert_element_type", "reduce_precision"):
            before, after = equation.invars[0].aval.dtype, equation.outvars[0].aval.dtype
            if str(after) in _SHORT and str(before) == "float64":
                yield str(after)
        for inner in _inner(equation):
            yield from _conversions(getattr(inner, "jaxpr", inner))


def _constants(program: Any) -> Iterator[Any]:
    """Yield the arrays of a program that are no arguments."""
    yield from getattr(program, "consts", ())
    for equation in getattr(program, "jaxpr", program).eqns:
        for inner in _inner(equation):
            yield from _constants(inner)


def _inner(equation: Any) -> Iterator[Any]:
    """Yield the programs inside of an equation."""
    for value in equation.params.values():
        for one in value if isinstance(value, (tuple, list)) else (value,):
            if hasattr(one, "eqns") or hasattr(one, "jaxpr"):
                yield one


def _reference(
    step: Callable[..., Any], start: Array, vector: Array, dt: float, notes: list[str]
) -> tuple[Array | None, Array | None]:
    """Return the Jacobians of JAX, or None with a note of its refusal."""
    try:
        with _float64():
            a, b = jax.jit(jax.jacfwd(step, argnums=(0, 1)))(start, vector, dt)
        return np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    except Exception as error:
        notes.append(f"jax.jacfwd gives no reference: {' '.join(str(error).split())[:200]}")
        return None, None


def _vector(name: str, value: ArrayLike) -> Array:
    try:
        vector = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is a {type(value).__name__}; expected a vector of numbers") from None
    if vector.ndim != 1:
        raise ValueError(f"{name} has shape {vector.shape}; expected a vector; help: use jax.flatten_util.ravel_pytree")
    if not np.isfinite(vector).all():
        raise ValueError(f"{name}[{int(np.argmin(np.isfinite(vector)))}] is not finite; expected finite numbers")
    return vector


def _rows(name: str, value: Array, width: int) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name} has shape {array.shape}; expected (rows, {width})")
    return array


def _names(what: str, names: Sequence[str] | None, letter: str, expected: int) -> tuple[str, ...]:
    found = tuple(names) if names is not None else tuple(f"{letter}{k + 1}" for k in range(expected))
    if len(found) != expected:
        raise ValueError(f"{what} has {len(found)} names; expected {expected}")
    return found
