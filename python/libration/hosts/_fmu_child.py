"""A program that runs an FMU in a process of its own; requests and answers are lines of JSON.

The package is not imported here: a crash of the FMU ends this process only.
"""

from __future__ import annotations

import ctypes
import faulthandler
import json
import os
import sys
from typing import Any

from fmpy import read_model_description
from fmpy.simulation import (
    apply_start_values,
    instantiate_fmu,
    settable_in_initialization_mode,
    settable_in_instantiated,
)

MOST_EVENT_ITERATIONS = 1000


class Instance:
    """An FMU from its instantiation to the end of its initialisation."""

    def __init__(self, load: dict[str, Any]) -> None:
        self.load = load
        self.model = read_model_description(load["folder"], validate=False)
        self.is_fmi2 = self.model.fmiVersion == "2.0"
        self.time: float = load["time"]
        self.fmu: Any = instantiate_fmu(load["folder"], self.model, load["kind"])

    def get(self, references: list[int]) -> list[float]:
        if not references:
            return []
        return list(self.fmu.getReal(references) if self.is_fmi2 else self.fmu.getFloat64(references))

    def set(self, references: list[int], values: list[float]) -> None:
        if references:
            (self.fmu.setReal if self.is_fmi2 else self.fmu.setFloat64)(references, values)

    def initialise(self) -> None:
        """Enter the initialisation mode with the start values and the action of the point."""
        fmu, model = self.fmu, self.model
        if self.is_fmi2:
            fmu.setupExperiment(startTime=self.time)
        rest = apply_start_values(fmu, model, self.load["start_values"], settable=settable_in_instantiated)
        if self.is_fmi2:
            fmu.enterInitializationMode()
        else:
            fmu.enterInitializationMode(startTime=self.time)
        rest = apply_start_values(fmu, model, rest, settable=settable_in_initialization_mode)
        if rest:
            raise ValueError(f"start_values has variables that cannot be set: {', '.join(rest)}")
        self.set(self.load["inputs"], self.load["action"])

    def renew(self, by_reset: bool) -> None:
        """Return to the instantiated FMU."""
        if by_reset:
            self.fmu.reset()
            return
        self.free()
        self.fmu.instantiate()

    def free(self) -> None:
        """Free the instance. The library stays loaded: some cannot be loaded twice."""
        (self.fmu.fmi2FreeInstance if self.is_fmi2 else self.fmu.fmi3FreeInstance)(self.fmu.component)


class CoSimulation(Instance):
    """Macro steps that all begin in the initialisation mode, the only one in which states can be set."""

    def __init__(self, load: dict[str, Any]) -> None:
        super().__init__(load)
        self.way: str = load["way"]
        self.saved: Any = None
        self.is_used = False

    def restore(self) -> None:
        if not self.is_used:
            self.initialise()
            self.is_used = True
            if self.way == "state":
                self.saved = self.fmu.getFMUState()
        elif self.way == "state":
            self.fmu.setFMUState(self.saved)
        else:
            self.renew(self.way == "reset")
            self.initialise()

    def step(self, x: list[float] | None, u: list[float], dt: float) -> dict[str, list[float]]:
        """Return the states before and after a macro step; without ``x`` they begin at their start values."""
        self.restore()
        if x is not None:
            self.set(self.load["setters"], x)
        self.fmu.exitInitializationMode()
        before = self.get(self.load["readers"])
        self.set(self.load["inputs"], u)
        found = self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=dt)
        if found is not None and (found[1] or (found[2] and found[3] < self.time + dt)):
            raise RuntimeError(f"the FMU ended the step of {dt:g} s at {found[3]:g} s")
        return {"before": before, "after": self.get(self.load["readers"])}


class ModelExchange(Instance):
    """Derivatives and steps of forward Euler."""

    def __init__(self, load: dict[str, Any]) -> None:
        super().__init__(load)
        self.size, self.indicators = int(self.model.numberOfContinuousStates), int(self.model.numberOfEventIndicators)
        self.next_event: float | None = None
        self.begin()

    def begin(self) -> None:
        self.initialise()
        self.fmu.exitInitializationMode()
        self.update()
        self.start = self.vector(self.fmu.getContinuousStates, self.size)
        self.had_event = False

    def update(self) -> None:
        """Update discrete states until they settle, and enter the continuous-time mode."""
        for _ in range(MOST_EVENT_ITERATIONS):
            again, ends, _, _, defined, time = self.fmu.newDiscreteStates() if self.is_fmi2 else self.fmu.updateDiscreteStates()
            if ends:
                raise RuntimeError("the FMU ended the simulation in an event")
            if not again:
                self.next_event = time if defined else None
                self.fmu.enterContinuousTimeMode()
                return
        raise RuntimeError(f"discrete states do not settle in {MOST_EVENT_ITERATIONS} iterations of an event")

    def event(self) -> float | None:
        """Return the time of the next event at the point."""
        return self.next_event

    def vector(self, read: Any, size: int) -> list[float]:
        values = (ctypes.c_double * size)()
        read(values, size)
        return list(values)

    def point(self) -> list[float]:
        return self.start

    def place(self, x: list[float], u: list[float]) -> None:
        if self.had_event:
            self.renew(self.load["way"] == "reset")
            self.begin()
        self.fmu.setTime(self.time)
        self.fmu.setContinuousStates((ctypes.c_double * self.size)(*x), self.size)
        self.set(self.load["inputs"], u)

    def derivatives(self) -> list[float]:
        return self.vector(self.fmu.getDerivatives if self.is_fmi2 else self.fmu.getContinuousStateDerivatives, self.size)

    def rates(self, x: list[float], u: list[float]) -> list[float]:
        """Return the derivatives of the states, and then the outputs."""
        self.place(x, u)
        return self.derivatives() + self.get(self.load["outputs"])

    def columns(self, x: list[float], u: list[float]) -> list[list[float]]:
        """Return the directional derivatives by each state and then each input."""
        self.place(x, u)
        unknowns = self.load["derivatives"] + self.load["outputs"]
        return [list(self.fmu.getDirectionalDerivative(unknowns, [known], [1.0])) for known in self.load["readers"] + self.load["inputs"]]

    def step(self, x: list[float] | None, u: list[float], dt: float) -> dict[str, list[float]]:
        """Return the states before and after a step; without ``x`` they begin at their start values."""
        x = self.start if x is None else x
        self.place(x, u)
        z = self.vector(self.fmu.getEventIndicators, self.indicators) if self.indicators else []
        after = [value + dt * rate for value, rate in zip(x, self.derivatives())]
        self.fmu.setContinuousStates((ctypes.c_double * self.size)(*after), self.size)
        self.fmu.setTime(self.time + dt)
        ends, crossed = False, False
        if self.load["needs_completed_step"]:
            # What it changes is not undone by setting states.
            self.had_event = True
            crossed, ends = self.fmu.completedIntegratorStep()
        if ends:
            raise RuntimeError("the FMU ended the simulation in a step")
        now = self.vector(self.fmu.getEventIndicators, self.indicators) if self.indicators else []
        if crossed or any((a < 0 <= b) or (b <= 0 < a) for a, b in zip(z, now)):
            self.had_event = True
            self.fmu.enterEventMode()
            self.update()
            after = self.vector(self.fmu.getContinuousStates, self.size)
        return {"before": x, "after": after}


def main() -> None:
    faulthandler.enable()
    # What the FMU prints must not come between the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    instance: Any = None
    for line in sys.stdin:
        request = json.loads(line)
        try:
            if request["operation"] == "load":
                instance = (CoSimulation if request["kind"] == "CoSimulation" else ModelExchange)(request)
                answer: dict[str, Any] = {"result": None}
            else:
                answer = {"result": getattr(instance, request["operation"])(*request["arguments"])}
        except Exception as error:
            answer = {"error": f"{' '.join(str(error).split())}", "status": getattr(error, "status", None)}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
    if instance is not None:
        instance.free()


if __name__ == "__main__":
    main()
