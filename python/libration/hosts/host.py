"""The description of a simulator at a point, which an audit of its step needs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from .measured_delay import MeasuredDelay, StrayResults

Array = NDArray[np.float64]
Step = Callable[[Array, Array, float], Array]
Recording = tuple[str, Array, Array]


@dataclass(frozen=True, eq=False)
class Host:
    """A simulator at a point, as a function of states, actions and the timestep.

    States are minimal coordinates: as many numbers as the simulator has degrees of freedom. Where the space of positions is curved
    (rotations in three dimensions), they are rotation vectors from the point, so that the point has zeros there. All other states
    are those of the simulator.
    """

    step: Step
    """``step(states, actions, dt)``: states × n, actions × m and a timestep in s; the states after it, states × n. Rows are independent
    of each other and of earlier calls, except with memory. A row that is not finite returns NaN."""
    state: Array
    """The point, n numbers."""
    action: Array
    """The action at the point, m numbers."""
    dt: float
    """The timestep in s that the simulator is set to."""
    states: tuple[str, ...]
    """Names of the states, with units in parentheses: ``"shoulder (rad)"``, ``"shoulder' (rad/s)"``."""
    inputs: tuple[str, ...]
    """Names of the actions, with units in parentheses."""
    title: str
    integrator: str
    """The integrator that the simulator says it uses."""
    version: str = ""
    """The simulator with its version: ``"MuJoCo 4.0.0"``; empty if it is not known."""
    energy: Callable[[Array], Array] | None = None
    """``energy(states)``: the mechanical energy in J of each row, without actuators and constraints."""
    mass: Array | None = None
    """The joint-space inertia at the point, velocities × velocities."""
    positions: tuple[tuple[int, int], ...] = ()
    """Pairs of the numbers of a position and of its rate."""
    equilibrium: bool | None = None
    """Whether the point is an equilibrium by the forces of the simulator; None if they are not known."""
    notes: tuple[str, ...] = ()
    """Facts that limit the validity of an audit at this point."""
    validity: tuple[str, ...] = ()
    """What ends the validity of an audit at this point, such as contacts that change."""
    reference_A: Array | None = None
    """The derivative of the step by the states that the simulator itself computes, in these coordinates."""
    reference_B: Array | None = None
    """The derivative of the step by the actions that the simulator itself computes."""
    reference_source: str = ""
    """The function that computes these derivatives: ``"mjd_transitionFD"``, ``"jax.jacfwd"``; empty without them."""
    reference_is_exact: bool = False
    """Whether they have rounding errors only, as those of automatic differentiation do: an audit then uses them."""
    joint_damping: tuple[float, ...] = ()
    """The damping of each velocity that the integrator may treat implicitly, besides that of actuators."""
    delays: tuple[float, ...] = ()
    """The delay of each action in s that the simulator states; empty if it states none."""
    exchange_latency: float = 0.0
    """The latency in s of exchanging values with other simulators at the ends of steps: the macro step of a co-simulation."""
    joints: tuple[str, ...] = ()
    """Names of the joints."""
    recordings: tuple[Recording, ...] = ()
    """Names and pairs of recordings that should have the same bits, steps × components or steps × environments × components."""
    memory: bool = False
    """Whether each row continues a simulation: what is no state lives on from call to call."""
    fixed_dt: bool = False
    """Whether the simulator has the timestep :attr:`dt` only."""
    observe: Callable[[Array], Array] | None = None
    """``observe(states)``: the observation of each state, or that of the last step, states × numbers."""
    not_examined: tuple[str, ...] = ()
    """What an audit of the host does not examine, such as wrappers that it leaves out."""
    direct_inputs: tuple[str, ...] = ()
    """Actions that are set past the way of commands, so that their lateness is unknown."""
    measured_inputs: tuple[MeasuredDelay, ...] = ()
    """Inputs whose lateness the host measures: discrete ones and those whose delay varies at random."""
    measured_observation: MeasuredDelay | None = None
    """The age of observations, if it varies."""
    stray_results: StrayResults | None = None
    """Results that calls with equal states and actions do not repeat, if there are any."""
    operating_point: dict[str, Any] | None = None
    """Where the point is from a requested one from which it was searched for: its changes, its residual and changed contacts."""
    reset: Callable[[], None] = field(default=lambda: None)
    """Forget what earlier calls left; it has an effect with memory only."""
