"""Analysis of a step, and limits of a loop or a simulation."""

from __future__ import annotations

import html
import json
import os
import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping

from . import _native
from ._requests import coordinates, integrator_name, loop_request, system_request, whole
from ._keywords import check_keywords
from ._html import pairs, table
from ._plots import Panels, plot_plant, plot_steps
from ._progress import Progress, ProgressDisplay
from ._settings import number
from ._toml import text_of
from .equations import EquationSystem
from .linear import linear_request, plant_of, tolerance_table
from .perturbations import LQR, PD, PID, Controller, Observer, file_table, law, numbers
from .perturbations import latency as _latency
from .systems import System, known

__all__ = ["Advice", "Analysis", "advise", "analyze"]


class Answer(Mapping[str, Any]):
    """A mapping of named results: ``answer["trace"]`` or ``answer.trace``."""

    def __init__(self, parts: dict[str, Any]) -> None:
        self._parts = parts

    def __getitem__(self, name: str) -> Any:
        return self._parts[name]

    def __iter__(self) -> Any:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    if not TYPE_CHECKING:
        # Type checkers read the annotations of the subclasses, so that a misspelt name is an error.
        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                # Copies and pickles read such attributes before ``_parts`` exists.
                raise AttributeError(name)
            if name not in self._parts:
                raise AttributeError(f"{type(self).__name__} has no part {name!r}; expected one of {', '.join(self)}")
            return self._parts[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._parts]

    def __repr__(self) -> str:
        return "\n".join([type(self).__name__, *(f"  {name}: {value!r}" for name, value in self.items())])

    def _repr_html_(self) -> str:
        return pairs(self.items())


class Analysis(Answer):
    """Analysis of steps on a system, with the keys of ``libration analyze --json``; of a linear plant with those of ``docs/plants.md``.

    ``spectral_radius`` and all keys without ``closed_loop`` belong to one step from the start without feedback. The loop has
    ``closed_loop_spectral_radius``, and with jitter or losses ``mean_square_growth``. An analysis has the attributes of its kind only:
    ``dir(analysis)`` and ``list(analysis)`` have their names. A number that is not finite, since a step overflows, is None.
    """

    # Of a system, and of a linear plant.
    schema: str
    """Version of the keys."""
    dt: float
    """Time step in s; of a linear plant None without one."""
    note: str
    """A restriction of the numbers."""
    verdicts: dict[str, dict[str, Any]]
    """What is stable or resolved: ``plant``, ``step``, ``motion`` and ``loop`` with ``outcome`` and ``evidence``, as far as they apply."""

    # Of a system.
    system: dict[str, Any]
    """Its ``name``, ``states`` with their start, ``parameters`` and what follows from its equations."""
    integrator: str
    steps: Any
    """Number of steps of the motion; of a linear plant the steps of each integrator, a list."""
    update_matrix: list[list[float]]
    """The derivative of one step from the start."""
    update_matrix_in_z: list[list[str]]
    """Of an oscillator: its entries as polynomials of ``z = ω·dt``."""
    determinant: float
    determinant_minus_one: float
    trace: float
    eigenvalues: list[list[float]]
    """Real and imaginary parts, ``[re, im]``."""
    spectral_radius: float
    """Largest absolute eigenvalue of one step without feedback."""
    spectral_radius_minus_one: float
    flow_spectral_radius_minus_one: float
    """That of an exact step: how much the motion itself grows, linearised at the start."""
    bounded: bool | None
    """Whether all trajectories stay bounded; None if the system is not linear."""
    stability_windows: list[list[float | None]]
    """Of an oscillator: ranges of stable time steps in s; an end without limit is None."""
    largest_dt: dict[str, float | None]
    """Of an oscillator: largest time step in s for each criterion."""
    modified_hamiltonian: dict[str, float]
    order_of_word: dict[str, Any]
    symplecticity_defect: float
    reversibility_defect: float
    phase_error_per_step: float | None
    """Phase error in rad per step."""
    force_evaluations_per_step: int
    max_energy_drift: float
    """Of an oscillator: largest relative energy drift within ``steps`` steps, without simulation."""
    log10_max_energy_drift: float | None
    max_energy_drift_step: int
    motion: dict[str, Any]
    """Order, errors and energy of the integrator on the motion from the start; its ``examination`` is beside the exact motion."""
    newton_residual: dict[str, Any]
    """Of an implicit integrator that iterates: what its Newton steps leave in the motion, and in which step."""
    operating_point: dict[str, Any] | None
    """The equilibrium near the start."""
    linear: dict[str, Any] | None
    """The analysis of the plant at this equilibrium."""
    no_modes: str | None
    """Reason for a missing ``linear``."""
    steps_along_motion: dict[str, Any]
    """The largest stable step along the motion, an estimate."""

    # Of a loop around a system of the catalogue.
    command: str
    """Quantity of commands, ``acceleration`` or ``force``."""
    feedback: list[float]
    feedback_units: list[str]
    latency_steps: float
    closed_loop_spectral_radius: float
    closed_loop_spectral_radius_minus_one: float
    critical_latency_steps: float | None
    critical_latency_split_steps: float | None
    critical_latency_seconds: float | None
    """Latency in s at which the loop becomes unstable."""
    latency_windows: list[list[float | None]]
    """Ranges of stable latencies in steps."""
    delay_margin_seconds: float | None
    jitter_clips: bool
    mean_square_radius: float | None
    mean_square_growth: float | None
    """Growth of the second moments per step, a logarithm."""
    lyapunov_exponent: float | None
    dephasing_steps: float | None
    cost_weights: list[float]
    cost: float | None
    cost_infinite: bool | None
    cost_increase: float | None
    """Relative increase of the cost by latency, jitter and losses."""

    # Of a linear plant.
    states: list[dict[str, str]]
    """``name`` and ``unit`` of each state."""
    inputs: list[dict[str, str]]
    outputs: list[dict[str, str]]
    sampling_period: float | None
    """Period of a sampled plant in s."""
    mechanical: bool
    modes: list[dict[str, Any]]
    """Modes of the plant, the one that grows fastest first."""
    fastest_rate: float
    """Largest absolute eigenvalue in 1/s."""
    slowest_rate: float | None
    stiffness: float | None
    not_applicable: list[str]
    """Integrators that do not apply to the plant."""
    loop: dict[str, Any] | Any
    """The closed loop; None without a controller."""

    def plot(self) -> Panels:
        """Draw the analysis by matplotlib, and return the axes of the panels.

        Of a system: eigenvalues of a step, stable time steps of an oscillator, stable latencies of a loop, errors of the integrator, and
        modes at the equilibrium. Of a linear plant: modes of plant and loop, and the stable time steps of integrators.

        Raises
        ------
        ImportError
            Without matplotlib: ``pip install 'libration[plots]'``.
        """
        return plot_plant(self) if "modes" in self else plot_steps(self)


class Advice(Answer):
    """Limits of a loop or a simulation, with the keys of ``libration advise --json``.

    The keys for systems of the catalogue are in ``docs/advise.md``, those for linear plants in ``docs/plants.md``.
    """

    holds: bool
    """Whether the loop is stable and within the tolerance with all stated values, and an integrator is accurate enough."""
    request: str
    """The request, as a file for ``libration advise --config``."""
    page: str | None
    """An HTML page with a stability map, with ``page=True``."""

    answer: str
    """The answer in a few sentences."""
    verdict: dict[str, Any]
    """The ``outcome`` (``stable``, ``unstable``, ``within``, ``exceeds`` or ``unknown``), its ``evidence``, and what was ``not_examined``."""
    unstable_motions: list[str]
    """What does not decay without imperfections; missing if the loop is stable without them."""
    warnings: list[str]
    repeat_command: str
    """The call, or the command with the file of ``config``, that repeats this advice."""

    # Of systems of the catalogue and by equations.
    system: str
    parameters: dict[str, float]
    q: list[float]
    v: list[float]
    tolerance: dict[str, Any]
    """The measure ``of``, the largest allowed value ``most``, and the ``scale`` of an error of the energy."""
    horizon: float
    """Duration in s."""
    loop: dict[str, Any] | Any
    """Budgets and remedies of the loop; None without a controller."""
    integrators: list[dict[str, Any]]
    """Each integrator with its largest step, cheapest first."""
    command: str | None
    """A command that takes the advised steps."""
    search: dict[str, Any] | None
    """What the search covers: ``integrators``, the shortest and the longest of ``steps`` in s, ``not_tried``; None for a loop."""
    tried_down_to: float | None
    runner_up: str | None
    floats: list[dict[str, Any]]
    """Errors of the float types."""
    throughput: dict[str, Any] | Any
    """Memory and speed of rollouts; None without advised steps."""

    # Of linear plants.
    states: list[dict[str, str]]
    """``name`` and ``unit`` of each state."""
    inputs: list[dict[str, str]]
    outputs: list[dict[str, str]]
    operating_point: dict[str, Any] | None
    plant_modes: list[dict[str, Any]]
    part_modes: list[dict[str, Any]]
    """Modes of lags and filters."""
    controller: str
    gain: list[list[float]] | None
    filter: list[list[float]] | None
    controller_matrices: dict[str, Any] | Any
    schedule: list[dict[str, Any]]
    period: float
    """Sample period in s."""
    budgets: list[dict[str, Any]]
    """Budget of each imperfection."""
    fails_first: dict[str, Any] | Any
    """The imperfection that fails first, or None."""
    chain: list[dict[str, Any]]
    margins: list[dict[str, Any]]
    growth: float
    """Growth of the second moments per period, a logarithm."""
    margin: float | None
    margin_tried_up_to: float | None
    ideal_cost: float
    cost: float | None
    cost_increase: float | None
    cost_tolerance: float | None
    deviations: list[dict[str, Any]]
    simulated: dict[str, Any] | Any
    deadline_misses: dict[str, Any] | Any
    remedies: dict[str, Any] | Any
    redesign: dict[str, Any] | Any
    """The controller of least cost, with ``redesign=True``."""

    def __init__(self, parts: dict[str, Any], holds: bool, request: str, page: str | None) -> None:
        super().__init__(parts)
        self.holds, self.request, self.page = holds, request, page

    def save(self, path: str | Path) -> None:
        """Write the page to a file.

        Raises
        ------
        ValueError
            If there is no page.
        OSError
            If the file cannot be written.
        """
        if self.page is None:
            raise ValueError("there is no page; help: call advise with page=True")
        Path(path).write_text(self.page, encoding="utf-8")

    def _repr_html_(self) -> str:
        """Return the answer, the warnings, the budgets of the loop and the steps of the integrators."""
        parts = [f"<p>{html.escape(self.answer)}</p>"]
        if self.warnings:
            parts.append(f"<ul>{''.join(f'<li>{html.escape(warning)}</li>' for warning in self.warnings)}</ul>")
        budgets = self.get("budgets") or (self.get("loop") or {}).get("budgets") or []
        if budgets:
            head = ["imperfection", "unit", "stated", "stable up to", "part used"]
            rows = [
                (" of ".join(filter(None, (one["kind"], one.get("channel")))), one["unit"])
                + (one["stated"], _limit(one), None if one["used"] is None else f"{100 * one['used']:.3g} %")
                for one in budgets
            ]
            parts.append(table(head, rows, 2))
        steps = self.get("integrators") or []
        if steps:
            head = ["integrator", "dt in s", "force evaluations per simulated s"]
            parts.append(table(head, [(one["integrator"], one["dt"], one["evaluations"]) for one in steps[:5]]))
        return "".join(parts)


def _limit(budget: Mapping[str, Any]) -> Any:
    return f"beyond {budget['tried_up_to']:.6g}" if budget["stable_up_to"] is None else budget["stable_up_to"]


@check_keywords
def analyze(
    system: Any,
    controller: Any = None,
    *,
    integrator: str | None = None,
    dt: float | None = None,
    q: Any = None,
    v: Any = None,
    steps: int | None = None,
    max_drift: float | None = None,
    max_amplitude: float | None = None,
    max_error: float | None = None,
    feedback: Any = None,
    period: float | None = None,
    latency: Any = None,
    output_latency: Any = None,
    jitter: Any = None,
    skew: Any = None,
    loss: float | None = None,
    missing: str | None = None,
    cost_weights: Any = None,
    measurement_noise: Any = None,
    clock: str | None = None,
) -> Analysis:
    """Return the analysis of one step or of a linear plant, as ``libration analyze`` prints it.

    Parameters
    ----------
    system:
        A name or a :class:`~libration.System`, which requires ``integrator`` and ``dt``; or a linear plant, as in
        :func:`~libration.advise`. With a controller a system by equations is its plant at an equilibrium.
    controller:
        Of a linear plant: as in :func:`~libration.advise`; without one its commands are zero.
    integrator, dt:
        As in :func:`~libration.simulate`. Of a linear plant both are optional: without ``integrator`` the analysis has all that apply,
        without ``dt`` the time steps at which they are stable.
    q, v, feedback:
        As in :func:`~libration.simulate`.
    latency, jitter, skew:
        As in :func:`~libration.simulate`; of a loop around a linear plant as in :func:`~libration.advise`.
    steps:
        Number of steps of the motion and its energy drift (linear systems: up to 10¹⁵; default: 1,000,000, of a nonlinear motion 1000).
    max_drift, max_amplitude, max_error:
        Limits for which the largest ``dt`` is added (oscillator): a relative energy drift, a length in m, an error relative to the
        amplitude.
    loss:
        Probability that a command is lost, at least 0 and below 1; the previous command then stays active.
    cost_weights:
        Weights of position², velocity² and command² in the cost of the loop (default: those of its energy). Of a linear plant a pair,
        weights of states and inputs.
    period, output_latency, missing, measurement_noise, clock:
        Of a loop around a linear plant: as in :func:`~libration.advise`.

    Raises
    ------
    TypeError, ValueError
        For an invalid value, before any work; the message has the name of the parameter and the allowed values.
    """
    of_catalogue = {
        "q": q,
        "v": v,
        "steps": steps,
        "max_drift": max_drift,
        "max_amplitude": max_amplitude,
        "max_error": max_error,
        "feedback": feedback,
    }
    of_loop = {"latency": latency, "jitter": jitter, "skew": skew, "loss": loss, "cost_weights": cost_weights}
    of_linear = {
        "period": period,
        "output_latency": output_latency,
        "missing": missing,
        "measurement_noise": measurement_noise,
        "clock": clock,
    }
    is_stepped = isinstance(system, EquationSystem) and controller is None and integrator is not None and dt is not None
    if is_stepped:
        for name, value in ({"feedback": feedback} | of_loop | of_linear).items():
            if value is not None:
                raise TypeError(f"{name} cannot be combined with a system by equations")
    elif (plant := plant_of(system)) is not None:
        for name, value in of_catalogue.items():
            if value is not None:
                raise TypeError(f"{name} cannot be combined with a linear plant")
        if controller is None:
            for name, value in (of_loop | of_linear).items():
                if value is not None:
                    raise TypeError(f"{name} requires a controller")
        if integrator is not None and not isinstance(integrator, str):
            raise TypeError(f"integrator is {integrator!r:.60}; expected a name")
        request = linear_request(plant, controller, of_loop | of_linear | {"tolerance": None}, required=False)
        step = None if dt is None else number("dt", dt, "finite and greater than 0")
        return Analysis(json.loads(_native._analyze_linear(text_of("config", request), step, integrator)))
    for name, value in ({"controller": controller} | of_linear).items():
        if value is not None:
            raise TypeError(f"{name} requires a linear plant")
    if integrator is None or dt is None:
        raise TypeError(f"{'integrator' if integrator is None else 'dt'} is missing")
    criteria = {"max_drift": max_drift, "max_amplitude": max_amplitude, "max_error": max_error}
    answer = _native._analyze(
        system_request(system, q, v),
        (integrator_name(integrator), number("dt", dt, "finite and greater than 0")),
        loop_request(feedback, latency, jitter, skew, loss, cost_weights),
        {
            "steps": None if steps is None else whole("steps", steps),
            **{
                name: None if value is None else number(name, value, "1e-60 to 1e60")
                for name, value in criteria.items()
            },
        },
    )
    return Analysis(json.loads(answer))


def _of_catalogue(system: Any) -> System:
    system = known(system)
    if not isinstance(system, System):
        raise ValueError(f"system is {type(system).__name__}; expected a system of the catalogue")
    return system


_LINEAR_ONLY = ("output_latency", "measurement_noise", "missing", "deadline_misses", "overrun", "overrun_probability", "clock")
"""Keywords of :func:`advise` that require a linear plant."""


@check_keywords
def advise(
    system: Any = None,
    controller: Any = None,
    *,
    q: Any = None,
    v: Any = None,
    period: float | None = None,
    latency: Any = None,
    output_latency: Any = None,
    jitter: Any = None,
    skew: float | None = None,
    loss: float | None = None,
    missing: str | None = None,
    deadline_misses: str | None = None,
    overrun: str | None = None,
    overrun_probability: float | None = None,
    cost_weights: Any = None,
    measurement_noise: Any = None,
    clock: str | None = None,
    deviation: float | None = None,
    tolerance: tuple[str, float] | None = None,
    horizon: float | None = None,
    config: Any = None,
    page: bool = False,
    redesign: bool = False,
    progress: Progress = None,
) -> Advice:
    """Return the limits of a loop or a simulation, as ``libration advise`` prints them.

    Parameters
    ----------
    system:
        A name or a :class:`~libration.System`, by equations without a controller for a simulation from its start and with one for a
        loop at its equilibrium; or a linear plant: a :class:`~libration.LinearPlant`, or any object with ``A``,
        ``B``, ``C``, ``D`` and ``dt``, as ``control.ss`` and ``scipy.signal.StateSpace`` make them, or with ``num``, ``den`` and ``dt``,
        as ``control.tf`` and ``scipy.signal.TransferFunction`` do.
    controller:
        Gains of position and velocity, in s⁻² and s⁻¹ (in N/m and N·s/m for a system with ``m`` and ``k``),
        :class:`~libration.PD`, :class:`~libration.PID`, :class:`~libration.LQR` or
        :class:`~libration.Observer` (default: no loop). Of a linear plant ``LQR(Q, R)``, :class:`~libration.LQG`,
        :class:`~libration.StateFeedback`, :class:`~libration.StateSpace`, :class:`~libration.Cascade`, or a list of
        ``(output, input, PID)``.
    q, v:
        Start of a simulation (default: that of the equations, or the origin), or operating point of a loop (default: the origin).
    period:
        Sample period in s (default: 0.01).
    latency, jitter, skew, loss:
        Imperfections of the loop: latency in s or :class:`~libration.Steps`, distribution of the sample period, relative clock error
        (positive: slow), probability that a command is lost. Of a linear plant ``latency`` may have a value for each input.
    missing, deadline_misses, overrun, overrun_probability:
        Of a linear plant: what acts in place of a missing command, ``"hold"`` (default) or ``"zero"``; how many deadlines are missed at
        worst, ``"2 of 5"`` or ``"2 consecutive"``; what happens to a job that overruns its period, ``"kill"`` (default), ``"skip"`` or
        ``"queue"``; the probability that a job overruns.
    output_latency, measurement_noise:
        Of a linear plant: latency of the measurements in s, and variances of their noise; for all, or for each output.
    clock:
        Of a linear plant: whether the controller uses the ``"nominal"`` period (default) or the ``"measured"`` length of the last one.
    cost_weights, deviation, tolerance, horizon:
        Weights of position², velocity² and command² in the cost; largest deviation from which the loop must return, in m or rad;
        of a linear plant a pair, weights of states and inputs; tolerance of ``energy``, ``phase``, ``trajectory`` or ``cost``, as ``("energy", 1e-6)``; duration in s.
    config:
        A dictionary or the path of a request file, in place of all parameters above.
    page:
        Whether to add an HTML page with a stability map, which takes longer.
    redesign:
        Whether to design the controller of least cost for the stated latencies, jitter, skew and losses, of a linear plant with an
        :class:`~libration.LQR`, an :class:`~libration.LQG`, or ``cost_weights``.

    Raises
    ------
    TypeError, ValueError
        For an invalid value, before any work; the message has the name of the parameter and the allowed values.
    """
    keywords = {
        "system": system,
        "controller": controller,
        "q": q,
        "v": v,
        "period": period,
        "latency": latency,
        "output_latency": output_latency,
        "jitter": jitter,
        "skew": skew,
        "loss": loss,
        "missing": missing,
        "deadline_misses": deadline_misses,
        "overrun": overrun,
        "overrun_probability": overrun_probability,
        "cost_weights": cost_weights,
        "measurement_noise": measurement_noise,
        "clock": clock,
        "deviation": deviation,
        "tolerance": tolerance,
        "horizon": horizon,
    }
    given = [name for name, value in keywords.items() if value is not None]
    if config is not None:
        if given:
            raise TypeError(f"{given[0]} cannot be combined with config")
        request = text_of("config", config)
    elif system is None:
        raise TypeError("system and config are missing; expected one of them")
    elif isinstance(system, EquationSystem) and controller is None:
        return _advise_simulation(system, keywords, page, redesign, progress)
    elif (plant := plant_of(system)) is not None:
        for name in ("q", "v", "deviation", "horizon"):
            if keywords[name] is not None:
                raise TypeError(f"{name} cannot be combined with a linear plant")
        given_request = linear_request(plant, controller, keywords)
        request = text_of("config", given_request)
    else:
        for name in _LINEAR_ONLY:
            if keywords.pop(name) is not None:
                raise TypeError(f"{name} requires a linear plant")
        given_request = _request(**keywords)
        request = text_of("config", given_request)
    with ProgressDisplay(progress) as display:
        report = (lambda _, __, ___, what, done, total: display.update(done / max(total, 1), what)) if display.enabled else None
        answer, holds, html_page = _native._advise(request, bool(page), bool(redesign), report)
    repeat = _Repetition(config if config is not None else given_request, {"redesign": True} if redesign else {})
    return Advice(repeat.of(json.loads(answer)), holds, request, None if html_page is None else repeat.page(html_page))


class _Repetition:
    """Commands or calls that repeat an advice, in place of a command with a file that does not exist."""

    _COMMAND = "libration advise --config config.toml"

    def __init__(self, config: Any, keywords: dict[str, Any]) -> None:
        """Repeat advice on a file or on a request as a dictionary, with further keywords."""
        self._config, self._keywords = config, keywords

    def _call(self, rest: str) -> str:
        """Return the command or the call with further options of the command."""
        words = [word for word in rest.split() if word != "--json"]
        if not isinstance(self._config, Mapping):
            flags = [f"--{name}" for name in self._keywords]
            return " ".join(["libration advise --config", shlex.quote(os.fspath(self._config)), *flags, *rest.split()])
        request = dict(self._config)
        options = {word.removeprefix("--"): value for word, value in zip(words[::2], words[1::2])}
        if "jitter" in options:
            options["law"], options["jitter"] = options["jitter"].split(":")
        if options:
            numbers_of = {name: value if name == "law" else float(value) for name, value in options.items()}
            request["loop"] = {**request.get("loop", {}), **numbers_of}
        keywords = "".join(f", {name}={value!r}" for name, value in self._keywords.items())
        return f"libration.advise(config={request!r}{keywords})"

    def of(self, found: Any) -> Any:
        """Return results with what repeats them."""
        if isinstance(found, str) and found.startswith(self._COMMAND):
            return self._call(found.removeprefix(self._COMMAND))
        if isinstance(found, dict):
            return {name: self.of(part) for name, part in found.items()}
        return [self.of(part) for part in found] if isinstance(found, list) else found

    def page(self, text: str) -> str:
        """Return a page with what repeats it."""
        command = re.compile(re.escape(self._COMMAND) + r"([^<]*)")
        return command.sub(lambda match: html.escape(self._call(html.unescape(match[1]))), text)


def _advise_simulation(system: EquationSystem, keywords: dict[str, Any], page: bool, redesign: bool, progress: Progress) -> Advice:
    """Advise on simulations of a system by equations."""
    loop = {**keywords, "redesign": redesign or None}
    for name, value in loop.items():
        if value is not None and name not in ("system", "q", "v", "tolerance", "horizon"):
            raise TypeError(f"{name} requires a controller")
    tolerance, horizon = keywords["tolerance"], keywords["horizon"]
    request = system_request(system, keywords["q"], keywords["v"])
    kind, most = next(iter(tolerance_table(("trajectory", 1e-3) if tolerance is None else tolerance, "('energy', 1e-6)").items()))
    seconds = number("horizon", 10.0 if horizon is None else horizon, "a number")
    with ProgressDisplay(progress) as display:
        report = (lambda _, __, ___, what, done, total: display.update(done / max(total, 1), what)) if display.enabled else None
        found = _native._advise_equations(request, (kind, most), seconds, bool(page), report)
    answer, holds, html_page = found
    parts = json.loads(answer)
    if "--system FILE" in parts["repeat_command"]:
        # The system has no file.
        start = "".join(f"{name}={value!r}, " for name, value in zip("qv", request[1:]) if value is not None)
        parts["repeat_command"] = f"libration.advise(system, {start}tolerance={(kind, most)!r}, horizon={seconds!r})"
    return Advice(parts, holds, system._text[0], html_page)


def _request(
    system: Any,
    controller: Any,
    q: Any,
    v: Any,
    period: Any,
    latency: Any,
    jitter: Any,
    skew: Any,
    loss: Any,
    cost_weights: Any,
    deviation: Any,
    tolerance: Any,
    horizon: Any,
) -> dict[str, Any]:
    """Return the request as the content of a request file."""
    system = _of_catalogue(system)
    at, speed = coordinates("q", q), coordinates("v", v)
    origin = [0.0] * len(at or speed or [0.0] * system.dimensions.start)
    start = {"q": at or origin, "v": speed or origin}
    request: dict[str, Any] = {"system": {system.name: dict(system.parameters)}, "start": start}
    if horizon is not None:
        request["request"] = {"horizon": number("horizon", horizon, "a number")}
    if tolerance is not None:
        request["tolerance"] = tolerance_table(tolerance, "('energy', 1e-6)")
    loop: dict[str, Any] = {
        name: number(name, value, "a number", lambda _: True)
        for name, value in {
            "period": period,
            "skew": skew,
            "loss": loss,
            "deviation": deviation,
        }.items()
        if value is not None
    }
    if cost_weights is not None:
        loop["cost"] = numbers("cost_weights", cost_weights, 3)
    if latency is not None:
        unit, late = _latency(latency) or ("seconds", 0.0)
        loop["latency"] = late * loop.get("period", 0.01) if unit == "steps" else late
    if jitter is not None:
        loop["law"], loop["jitter"] = law("jitter", jitter) or ("gaussian", 0.0)
    if controller is not None:
        request["controller"] = _controller(controller)
    if loop:
        request["loop"] = loop
    return request


def _controller(controller: Any) -> dict[str, Any]:
    several = {"weights": 3, "gains": 2, "noise": 2, "correction": 2}
    table: dict[str, Any] = {}
    if not isinstance(controller, (PID, LQR, Observer)):
        if not isinstance(controller, PD):
            controller = PD(*numbers("controller", controller, 2))
        return {"pd": {name: number(name, gain, "a number") for name, gain in file_table(controller).items()}}
    for name, value in file_table(controller).items():
        if name in several and value is not None:
            table[name] = numbers(name, value, several[name])
        elif value is not None:
            table[name] = number(name, value, "a number", lambda _: True)
    if "noise" in table:
        table["acceleration"], table["position"] = table.pop("noise")
    return {type(controller).__name__.lower(): table}
