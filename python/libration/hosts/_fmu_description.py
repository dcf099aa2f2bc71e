"""The variables of an FMU: states, inputs and outputs."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterable, Mapping, Sequence
from xml.etree import ElementTree

import fmpy
from fmpy.simulation import settable_in_initialization_mode, settable_in_instantiated

from .._settings import nearest
from ._fmu_archive import check_archive

KINDS = ("CoSimulation", "ModelExchange")
_FLOATS = ("Real", "Float64")


class Folder:
    """The files of an FMU; those of an archive are removed at the end."""

    def __init__(self, path: Path) -> None:
        if path.is_dir():
            self.path = str(path)
            return
        self.path = tempfile.mkdtemp(prefix="fmu-")
        self.remove = weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)
        fmpy.extract(path, self.path)


@dataclass(frozen=True)
class Description:
    """An FMU of one kind, without its binary."""

    name: str
    """The name of the file."""
    model: Any
    """The ModelDescription of FMPy."""
    kind: str
    interface: Any
    """The capabilities of this kind."""
    folder: Folder

    @property
    def directional(self) -> str:
        """The name of the function of directional derivatives."""
        return f"fmi{str(self.model.fmiVersion)[0]}GetDirectionalDerivative"

    @property
    def has_directional(self) -> bool:
        """Whether the FMU provides directional derivatives. FMPy 0.3 leaves out the flag of FMI 3."""
        element = ElementTree.parse(os.path.join(self.folder.path, "modelDescription.xml")).find(self.kind)
        flag = "providesDirectionalDerivative" + ("" if self.model.fmiVersion == "2.0" else "s")
        return element is not None and element.get(flag) in ("true", "1")

    @property
    def inner_step(self) -> float | None:
        """The fixed length in s of the steps that the FMU states to make within a macro step; None if it states none."""
        found = getattr(self.interface, "fixedInternalStepSize", None)
        return None if found is None else float(found)

    def macro_step(self) -> float:
        """Return the fixed step of the FMU, or that of its default experiment."""
        experiment = self.model.defaultExperiment
        for step in (self.inner_step, experiment.stepSize if experiment is not None else None):
            if step is not None:
                return float(step)
        raise ValueError(f"dt is missing, and {self.name} has no step of a default experiment; expected the macro step in s")

    def variable(self, what: str, name: str) -> Any:
        """Return a scalar of float64 by its name."""
        known = {variable.name: variable for variable in self.model.modelVariables}
        if name not in known:
            raise ValueError(f"{what} has {name!r}, which is no variable of {self.name}: {nearest(name, known)[:400]}")
        if not is_float(known[name]):
            shape = " array" if known[name].dimensions else ""
            raise ValueError(f"{what} has {name!r}, which is a {known[name].type}{shape}; expected a scalar of float64")
        return known[name]

    def inputs(self, names: Sequence[str] | None) -> tuple[list[Any], list[str]]:
        """Return the inputs, and the names of those that stay at their start values."""
        every = [v for v in self.model.modelVariables if v.causality == "input"]
        if names is None:
            chosen = [v for v in every if is_float(v) and v.variability in (None, "continuous")]
        else:
            chosen = [self.variable("inputs", name) for name in names]
        for v in chosen:
            if v.causality != "input":
                raise ValueError(f"inputs has {v.name!r}, whose causality is {v.causality!r}; expected 'input'")
        return chosen, [v.name for v in every if v not in chosen]

    def outputs(self, names: Sequence[str] | None) -> list[Any]:
        if names is not None:
            return [self.variable("outputs", name) for name in names]
        return [u.variable for u in self.model.outputs if is_float(u.variable)]

    def continuous_states(self) -> list[Any]:
        """Return the continuous states that the model structure lists, in its order."""
        return [u.variable.derivative for u in self.model.derivatives if u.variable.derivative is not None]

    def settable_states(self, names: Sequence[str] | Mapping[str, str] | None) -> tuple[list[Any], list[Any]]:
        """Return the states of a co-simulation, and the variables that set them."""
        if names is None:
            listed = self.continuous_states()
            names = [v.name for v in listed]
            if not names:
                raise ValueError(f"{self.name} lists no continuous states; help: name the states: {self._settable()}")
        pairs = names if isinstance(names, Mapping) else {name: name for name in names}
        readers = [self.variable("states", name) for name in pairs]
        setters = [self.variable("states", name) for name in pairs.values()]
        for v in setters:
            if not (settable_in_instantiated(v) or settable_in_initialization_mode(v)) or v.initial == "approx":
                raise ValueError(
                    f"state {v.name!r} has initial={v.initial!r}, so that it cannot be set; expected 'exact'; "
                    f"help: give {{state: variable that sets it}}: {self._settable()}"
                )
        return readers, setters

    def _settable(self) -> str:
        known = [v for v in self.model.modelVariables if is_float(v) and v.initial == "exact" and v.causality != "input"]
        # Parameters come last.
        names = [v.name for v in sorted(known, key=lambda v: v.causality in ("parameter", "calculatedParameter"))]
        return f"variables that can be set are {', '.join(names[:20])}" if names else "no variable can be set"


def describe(path: str | os.PathLike[str], kind: str | None) -> Description:
    """Return the description of an FMU.

    Raises
    ------
    TypeError, ValueError
        For a file that is no FMU of FMI 2 or 3, or that has no binary for this platform or kind.
    """
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"path must be the path of an FMU, not {type(path).__name__}")
    file = Path(path)
    if not file.exists():
        raise ValueError(f"path is {str(path)!r}, and there is no such file; expected the path of an FMU")
    if kind is not None and kind not in KINDS:
        raise ValueError(f"kind is {kind!r}: {nearest(str(kind), KINDS)}")
    check_archive(file)
    try:
        model = fmpy.read_model_description(file)
    except Exception as error:
        raise ValueError(f"{file.name} is no valid FMU: {' '.join(str(error).split())[:400]}") from None
    if not (model.fmiVersion == "2.0" or str(model.fmiVersion).startswith("3.")):
        raise ValueError(f"{file.name} is an FMU of FMI {model.fmiVersion}; expected FMI 2.0 or 3.0")
    found = {"CoSimulation": model.coSimulation, "ModelExchange": model.modelExchange}
    has = [name for name in KINDS if found[name] is not None]
    chosen = kind if kind is not None else next(iter(has), None)
    if chosen is None or found[chosen] is None:
        raise ValueError(f"{file.name} has no {kind or 'co-simulation or model exchange'}; it has {', '.join(has) or 'neither'}")
    folder = Folder(file)
    wanted = fmpy.platform if model.fmiVersion == "2.0" else fmpy.platform_tuple
    platforms = sorted(one.name for one in Path(folder.path, "binaries").glob("*"))
    if wanted not in platforms:
        raise ValueError(f"{file.name} has no binary for {wanted}; it has those for {', '.join(platforms) or 'no platform'}")
    return Description(file.name, model, chosen, found[chosen], folder)


def is_float(variable: Any) -> bool:
    """Whether a variable is a scalar of float64."""
    return variable.type in _FLOATS and not variable.dimensions


def labels(variables: Iterable[Any]) -> tuple[str, ...]:
    """Return names with units in parentheses."""
    found = []
    for v in variables:
        unit = v.unit or (v.declaredType.unit if v.declaredType is not None else None)
        # A parenthesis would begin a unit.
        name = v.name.replace("(", "[").replace(")", "]")
        found.append(f"{name} ({unit})" if unit and unit != "1" else name)
    return tuple(found)


def load_of(
    described: Description, values: dict[str, Any], chosen: list[Any], readers: list[Any], setters: list[Any], measured: list[Any]
) -> dict[str, Any]:
    """Return what the process needs to load the FMU."""
    experiment = described.model.defaultExperiment
    time = experiment.startTime if experiment is not None else None
    for what, variables in (("states", readers), ("outputs", measured)):
        for v in variables:
            described.variable(what, v.name)
    for name in values:
        if name not in (known := [v.name for v in described.model.modelVariables]):
            raise ValueError(f"start_values has {name!r}, which is no variable of {described.name}: {nearest(name, known)[:400]}")
    return {
        "folder": described.folder.path,
        "kind": described.kind,
        "time": float(time) if time is not None else 0.0,
        "start_values": values,
        "inputs": [v.valueReference for v in chosen],
        "action": [float(values.get(v.name, v.start if v.start is not None else 0.0)) for v in chosen],
        "readers": [v.valueReference for v in readers],
        "setters": [v.valueReference for v in setters],
        "outputs": [v.valueReference for v in measured],
        "derivatives": [u.variable.valueReference for u in described.model.derivatives],
        "needs_completed_step": bool(getattr(described.interface, "needsCompletedIntegratorStep", False)),
    }
