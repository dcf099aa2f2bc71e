"""Functions of a simulator as functions on rows, with errors for results of another shape."""

from __future__ import annotations

import operator
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def vector(name: str, value: ArrayLike) -> Array:
    """Return a vector of finite numbers; a number is a vector of one.

    Raises
    ------
    TypeError, ValueError
        If it is none; the message has its name.
    """
    found = np.atleast_1d(numbers_of(name, value))
    if found.ndim != 1:
        raise ValueError(f"{name} has shape {found.shape}; expected one dimension")
    if not np.isfinite(found).all():
        k = int(np.argmin(np.isfinite(found)))
        raise ValueError(f"{name}[{k}] is {found[k]}; expected finite numbers")
    return found


def numbers_of(name: str, value: Any) -> Array:
    """Return real numbers in double precision."""
    try:
        found = np.asarray(value)
        if found.dtype.kind not in "biuf":
            # Objects such as Fraction are numbers; None, text and complex numbers are not.
            if found.dtype.kind != "O" or any(item is None for item in found.flat):
                raise TypeError
        return np.array(found, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {' '.join(repr(value).split())[:60]}; expected real numbers") from None


def names(name: str, value: Sequence[str]) -> list[str]:
    """Return a list of strings."""
    if isinstance(value, str):
        raise TypeError(f"{name} is the string {value!r}; expected a list of strings")
    found = list(value)
    for one in found:
        if not isinstance(one, str):
            raise TypeError(f"{name} has a {type(one).__name__}; expected strings")
    return found


def signals(name: str, value: Sequence[str]) -> list[str]:
    """Return names of states or inputs, each with or without a unit in parentheses."""
    found = names(name, value)
    for k, one in enumerate(found):
        stripped = one.strip()
        if not (stripped.rpartition("(")[0].strip() if stripped.endswith(")") and "(" in stripped else stripped):
            raise ValueError(f"{name}[{k}] is {one!r}; expected a name, or a name and its unit: 'angle (rad)'")
    return found


def pair_numbers(value: Any, n: int) -> tuple[tuple[int, int], ...]:
    """Return pairs of numbers of states."""
    found = []
    for pair in value:
        try:
            position, velocity = (operator.index(k) for k in pair)
        except (TypeError, ValueError):
            raise ValueError(f"pairs has {pair!r}; expected the numbers of a position and of its velocity") from None
        if not (0 <= position < n and 0 <= velocity < n) or position == velocity:
            raise ValueError(f"pairs has ({position}, {velocity}); expected two different numbers from 0 to {n - 1}")
        found.append((position, velocity))
    used = [k for pair in found for k in pair]
    if len(set(used)) < len(used):
        raise ValueError(f"pairs is {found}; expected each state in one pair")
    return tuple(found)


def callable_of(name: str, value: Any) -> None:
    """Check that a value is a function."""
    if not callable(value):
        raise TypeError(f"{name} is a {type(value).__name__}; expected a function")


def rows_of_step(step: Callable[..., Any], n: int, batched: bool) -> Callable[[Array, Array, float], Array]:
    """Return the step on rows."""

    def result(value: Any, shape: tuple[int, ...]) -> Array:
        if value is None:
            raise TypeError(f"step returned None; expected numbers of shape {shape}")
        # A copy, so that a step may return the same array again and again.
        found = numbers_of("the result of step", value)
        if found.shape != shape:
            raise ValueError(f"step returned an array of shape {found.shape}; expected {shape}")
        return found

    def of_batch(states: Array, actions: Array, dt: float) -> Array:
        shape = states.shape
        return result(step(states, actions, dt), shape)

    def of_each(states: Array, actions: Array, dt: float) -> Array:
        # Copies, so that a step may change its arguments.
        return np.stack([alone(x.copy(), u.copy(), dt) for x, u in zip(states, actions)])

    def alone(x: Array, u: Array, dt: float) -> Array:
        try:
            return result(step(x, u, dt), (n,))
        except OverflowError:
            # Of numbers of Python, in a run that diverges.
            return np.full(n, np.inf)

    return of_batch if batched else of_each


def energies_of(energy: Callable[..., Any], batched: bool) -> Callable[[Array], Array]:
    """Return the energy of rows."""

    def of_batch(states: Array) -> Array:
        count = len(states)
        found = numbers_of("the result of energy", energy(states))
        if found.shape not in ((count,), (count, 1)):
            raise ValueError(f"energy returned an array of shape {found.shape}; expected ({count},)")
        return found.reshape(count)

    def of_each(states: Array) -> Array:
        found = [numbers_of("the result of energy", alone(x.copy())) for x in states]
        if any(one.size != 1 for one in found):
            raise ValueError(f"energy returned an array of shape {found[0].shape}; expected a number")
        return np.array([one.item() for one in found])

    def alone(x: Array) -> Any:
        try:
            return energy(x)
        except OverflowError:
            return np.inf

    return of_batch if batched else of_each


def check_energy(energy: Callable[[Array], Array] | None, state: Array) -> None:
    """Check that an energy of rows is finite at a state."""
    if energy is None:
        return
    found = np.ravel(energy(state[np.newaxis].copy()))
    if not np.isfinite(found).all():
        raise ValueError(f"energy returned {found[0]} at the given state; expected a finite number")


def observations_of(observe: Callable[..., Any], batched: bool) -> Callable[[Array], Array]:
    """Return the observations of rows.

    Raises
    ------
    TypeError, ValueError
        If an observation is empty, has another size than the first one, or is not finite for a finite state.
    """
    size: list[int] = []

    def checked(states: Array, found: Array, shape: tuple[int, ...]) -> Array:
        if found.shape[1] == 0:
            raise ValueError(f"observe returned an array of shape {shape}; expected at least one number for each state")
        size[:] = size or [found.shape[1]]
        if found.shape[1] != size[0]:
            raise ValueError(f"observe returned {found.shape[1]} numbers for a state, but {size[0]} at the first call; expected {size[0]}")
        wrong = np.isfinite(states).all(axis=1, keepdims=True) & ~np.isfinite(found)
        if wrong.any():
            row, k = (int(index) for index in np.argwhere(wrong)[0])
            raise ValueError(f"observe returned {found[row, k]} in component {k} for the state {states[row].tolist()}; expected finite numbers")
        return found

    def of_batch(states: Array) -> Array:
        count = len(states)
        found = numbers_of("the result of observe", observe(states.copy()))
        if found.ndim == 0 or len(found) != count:
            raise ValueError(f"observe returned an array of shape {found.shape}; expected {count} rows")
        return checked(states, found.reshape(count, -1) if found.size else np.empty((count, 0)), found.shape)

    def of_each(states: Array) -> Array:
        rows = []
        for x in states:
            found = numbers_of("the result of observe", observe(x.copy()))
            rows.append(checked(x[np.newaxis], found.reshape(1, -1) if found.size else np.empty((1, 0)), found.shape)[0])
        return np.stack(rows)

    return of_batch if batched else of_each


def inertia(mass: ArrayLike, count: int) -> list[list[float]]:
    """Return a symmetric positive definite matrix, or one with the given diagonal."""
    found = numbers_of("mass", mass)
    found = np.diag(np.atleast_1d(found)) if found.ndim < 2 else found
    if found.shape != (count, count):
        raise ValueError(f"mass has shape {found.shape}; expected {count} × {count} numbers, one for each pair, or the diagonal")
    if not np.isfinite(found).all():
        i, j = (int(k) for k in np.argwhere(~np.isfinite(found))[0])
        raise ValueError(f"mass[{i}, {j}] is {found[i, j]}; expected finite numbers")
    diagonal = np.diag(found)
    if not (diagonal > 0).all():
        k = int(np.argmin(diagonal > 0))
        raise ValueError(f"mass[{k}, {k}] is {diagonal[k]}; expected a number above 0")
    # Coordinates may have different units, so that entries are compared in units of their diagonal.
    scale = np.sqrt(diagonal)
    scaled = found / scale[:, np.newaxis] / scale
    apart = np.abs(scaled - scaled.T)
    if (apart > 1e-9).any():
        i, j = (int(k) for k in np.unravel_index(np.argmax(apart), apart.shape))
        raise ValueError(f"mass[{i}, {j}] is {found[i, j]}, but mass[{j}, {i}] is {found[j, i]}; expected a symmetric matrix")
    if count and np.linalg.eigvalsh(scaled)[0] <= count * np.finfo(np.float64).eps:
        least = np.linalg.eigvalsh(found)[0]
        raise ValueError(f"mass has the eigenvalue {least:.6g}; expected a positive definite matrix, also with rounding errors")
    rows: list[list[float]] = found.tolist()
    return rows


def contiguous(function: Callable[..., Any], ndim: int) -> Callable[..., Array]:
    """Return the function with results in the memory order that the engine reads."""

    def called(*arguments: Any) -> Array:
        found = np.ascontiguousarray(function(*arguments), dtype=np.float64)
        if found.ndim != ndim:
            raise ValueError(f"the result has shape {found.shape}; expected {ndim} dimensions")
        return found

    return called
