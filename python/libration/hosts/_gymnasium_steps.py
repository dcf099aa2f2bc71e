"""Steps of an environment from any state, through its wrappers."""

from __future__ import annotations

import copy
import numbers
import warnings
from collections import Counter
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Calls after which an environment should have forgotten what was before, as in the audit of a step.
CALLS = 64
# Calls with the same values, among which a memory that counts them shows.
ALIKE = 512
# Changes of one call from which its effect on later ones shows, also of wrappers that draw random numbers.
IMPULSES = 16
# Calls without a change: a result that differs among them does so by itself.
CONTROLS = 2 * CALLS * IMPULSES
_PLAIN = (numbers.Number, str, bytes, np.ndarray, np.generic, tuple, list, dict, type(None))
_FIXED = (numbers.Number, str, bytes, np.generic, type(None))


class Responses:
    """The calls that respond to changes of single calls, and those that differ by themselves."""

    def __init__(self) -> None:
        self.calls = 0
        self.strays = 0
        self._found: list[list[dict[int, bytes]]] = [[], []]

    @property
    def states(self) -> list[set[int]]:
        """For each change the numbers of the later calls whose states differ: 0 is the call itself."""
        return [set(one) for one in self._found[0]]

    @property
    def observations(self) -> list[set[int]]:
        """The same of observations."""
        return [set(one) for one in self._found[1]]

    def add(self, base: tuple[bytes, bytes], results: Sequence[tuple[bytes, bytes]]) -> None:
        """Add the results of a changed call and of those after it, beside those of calls without a change."""
        self.calls += len(results)
        for found, own, values in zip(self._found, base, zip(*results)):
            found.append({call: value for call, value in enumerate(values) if value != own})

    def drop_strays(self, base: tuple[bytes, bytes], controls: Sequence[tuple[bytes, bytes]]) -> None:
        """Count the results that differ without a change among ``controls``, and late ones that occur only once; both are no responses.

        A response is that of the changed call too, or of another change, or, unless controls differ, another change has one after as many
        calls.
        """
        self.calls += len(controls)
        self.strays += sum(control != base for control in controls)
        is_steady = self.strays == 0
        strays: set[tuple[int, int]] = set()
        for found, own, values in zip(self._found, base, zip(*controls)):
            alone = {value for value in values if value != own}
            values_seen = Counter(value for one in found for value in one.values())
            calls_seen = Counter(call for one in found for call in one)
            for change, one in enumerate(found):
                for call, value in [(call, value) for call, value in one.items() if call > 0]:
                    if value in alone or (values_seen[value] == 1 and not (is_steady and calls_seen[call] > 1)):
                        del one[call]
                        strays.add((change, call))
        self.strays += len(strays)


class Steps:
    """The steps of an environment, whose state is set before each of them.

    Each step also sets all other plain attributes of the environment to what they were, unless they are a memory: then, and in
    wrappers, they live on from call to call.
    """

    def __init__(
        self, outer: Any, state: str, clock: str | None, action: str | None, fixed: Any, angles: tuple[int, ...], is_wrapped: bool
    ) -> None:
        self.outer, self.inner = outer, outer.unwrapped
        self.names, self.fixed, self.angles = (state, clock, action), fixed, list(angles)
        self.is_single = self.keeps_attributes = self.draws = False
        self.count: int | None = None
        self.observation: Array | None = None
        self.is_observed = _is_numeric(outer.observation_space)
        plain = {name: value for name, value in vars(self.inner).items() if isinstance(value, _PLAIN)}
        self.plain = {name: value for name, value in plain.items() if isinstance(value, _FIXED)}
        self.containers = copy.deepcopy({name: value for name, value in plain.items() if name not in (*self.plain, state)})
        generator: Any = getattr(self.inner, "np_random", None)
        self.bits = copy.deepcopy(generator.bit_generator.state) if hasattr(generator, "bit_generator") else None
        # Wrappers draw from the same generator.
        self.holds_generator = not is_wrapped
        if is_wrapped:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                outer.reset(seed=0)
        self._count_steps()

    def _count_steps(self) -> None:
        """Count the steps that wrappers take at once; they never see the end of an episode."""
        original = self.inner.step
        self.calls = 0

        def counted(action: Any) -> Any:
            self.calls += 1
            observation, reward, _, _, info = original(action)
            return observation, reward, False, False, info

        self.inner.step = counted

    def step(self, states: Array, actions: Array, dt: float) -> Array:
        states, actions = np.asarray(states, dtype=np.float64), np.asarray(actions, dtype=np.float64)
        if states.ndim != 2 or len(actions) != len(states):
            raise ValueError(f"states and actions have shapes {states.shape} and {actions.shape}; expected a row for each state")
        after = np.full(states.shape, np.nan)
        with warnings.catch_warnings():
            # Of steps after the end of an episode.
            warnings.simplefilter("ignore")
            for row, (state, action) in enumerate(zip(states, actions)):
                if np.isfinite(state).all() and np.isfinite(action).all():
                    after[row] = self._one(state, action, dt)
        return after

    def _one(self, state: Array, action: Array, dt: float) -> Array:
        inner, (state_name, clock, action_name) = self.inner, self.names
        if not self.keeps_attributes:
            self._restore()
        holds_generator = self.holds_generator and self.bits is not None
        if holds_generator:
            inner.np_random.bit_generator.state = self.bits
        if clock is not None:
            setattr(inner, clock, float(dt) / (self.count or 1))
        setattr(inner, state_name, state.copy())
        if action_name is not None:
            setattr(inner, action_name, float(action[0]))
        self.calls = 0
        observation = self.outer.step(action.copy() if self.fixed is None else self.fixed)[0]
        if self.count is None:
            self.count = self.calls
        if self.calls != self.count or self.count == 0:
            raise ValueError(
                f"wrappers take {self.calls} steps of the environment in one, and {self.count} before; expected always as many, at least one"
            )
        if self.is_observed:
            self.observation = _numbers(self.outer.observation_space, observation)
        found = getattr(inner, state_name)
        self.is_single |= getattr(found, "dtype", None) == np.float32
        if holds_generator and not self.draws:
            self.draws = inner.np_random.bit_generator.state != self.bits
        after = np.array(found, dtype=np.float64)
        if self.angles:
            after[self.angles] -= 2 * np.pi * np.round((after[self.angles] - state[self.angles]) / (2 * np.pi))
        return after

    def _restore(self) -> None:
        """Set all plain attributes to what they were."""
        attributes = vars(self.inner)
        attributes.update(self.plain)
        if self.containers:
            attributes.update(copy.deepcopy(self.containers))

    def settle(self) -> None:
        """Leave the generator alone from now on if no step has drawn from it."""
        self.holds_generator &= self.draws

    def observe(self, states: Array) -> Array:
        """Return the observation that the last step returned, for each state."""
        assert self.observation is not None
        return np.tile(self.observation, (len(states), 1))

    def responses(self, state: Array, action: Array, changed: tuple[Array, Array, Any], dt: float) -> Responses | None:
        """Return the calls that respond to single calls with another state, action or discrete action. None if calls with the same values
        vary from the start.
        """
        base_fixed = self.fixed

        def result(x: Array, u: Array) -> tuple[bytes, bytes]:
            after = self._one(x, u, dt)
            return after.tobytes(), b"" if self.observation is None else self.observation.tobytes()

        def repeated(count: int) -> list[tuple[bytes, bytes]]:
            return [result(state, action) for _ in range(count)]

        responses = Responses()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            repeated(CALLS)
            for impulse in range(IMPULSES):
                # Pauses, since a delay may depend on the number of the call.
                repeated(impulse % 5)
                base, again = repeated(2)
                if base != again:
                    return None
                self.fixed = changed[2]
                first = result(*changed[:2])
                self.fixed = base_fixed
                responses.add(base, [first, *repeated(CALLS)])
            responses.drop_strays(base, repeated(CONTROLS))
        return responses

    def remembers(self, state: Array, action: Array, changes: Sequence[tuple[Array, Array, Any]], dt: float) -> bool:
        """Whether attributes that live on change calls of the same values, or calls after a changed one.

        Each sequence of calls begins with the attributes as they were. So a memory that only fades, such as a filter of actions, is found,
        which never is what it was before, and so is one that grows, such as a counter.
        """
        base_fixed = self.fixed

        def sequence(first: tuple[Array, Array, Any], then: tuple[Array, Array, Any], calls: int) -> list[tuple[bytes, bytes]]:
            self._restore()
            found = []
            for call in range(1 + calls):
                x, u, self.fixed = then if call else first
                after = self._one(x, u, dt)
                found.append((after.tobytes(), b"" if self.observation is None else self.observation.tobytes()))
            self.fixed = base_fixed
            return found[1:]

        point = (state, action, base_fixed)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # Where a state is at rest, a force that depends on it is not seen.
            for own in (point, *changes):
                base, again = (sequence(own, own, ALIKE) for _ in range(2))
                if base != again:
                    continue
                others = (other for other in (point, *changes) if other is not own)
                if any(one != base[0] for one in base) or any(sequence(other, own, CALLS) != base[:CALLS] for other in others):
                    return True
        return False

    def other_actions(self) -> list[int]:
        """Return the discrete actions besides the one that is fixed."""
        space = self.outer.action_space
        return [one for one in range(int(space.start), int(space.start + space.n)) if one != self.fixed]

    def has_memory(self, state: Array, action: Array, changes: Sequence[tuple[Array, Array, Any]], dt: float) -> bool | None:
        """Whether results depend on earlier calls; None if they vary by themselves."""
        for changed in changes:
            found = self.responses(state, action, changed, dt)
            if found is None or found.strays:
                return None
            if any(call > 0 for both in (*found.states, *found.observations) for call in both):
                return True
        return False


def _is_numeric(space: Any) -> bool:
    """Whether observations are real numbers: small changes of a state change them."""
    if isinstance(space, gymnasium.spaces.Box):
        return bool(np.issubdtype(space.dtype, np.floating))
    if isinstance(space, gymnasium.spaces.Dict):
        return all(_is_numeric(one) for one in space.spaces.values())
    return isinstance(space, gymnasium.spaces.Tuple) and all(_is_numeric(one) for one in space.spaces)


def _numbers(space: Any, observation: Any) -> Array:
    if isinstance(space, gymnasium.spaces.Box):
        return np.array(observation, dtype=np.float64).ravel()
    return np.array(gymnasium.spaces.flatten(space, observation), dtype=np.float64)
