"""An oscillator of van der Pol as FMUs of FMI 2 and 3, compiled by the C compiler of the system."""

import shutil
import subprocess
import zipfile
from pathlib import Path

HERE = Path(__file__).parent
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")

# Name, causality, variability, initial, start value, and more attributes; in the order of value references.
_VARIABLES = (
    ("time", "independent", "continuous", None, None, ""),
    ("x0", "output", "continuous", "exact", "2", 'unit="m"'),
    ("der(x0)", "local", "continuous", "calculated", None, 'derivative="{x0}"'),
    ("x1", "local", "continuous", "exact", "0", 'unit="m/s"'),
    ("der(x1)", "local", "continuous", "calculated", None, 'derivative="{x1}"'),
    ("mu", "parameter", "fixed", "exact", "1", ""),
    ("u", "input", "continuous", None, "0", 'unit="m/s2"'),
    ("y", "output", "continuous", "calculated", None, ""),
    ("fault", "parameter", "fixed", "exact", "0", ""),
    ("floor", "parameter", "fixed", "exact", "-1000", ""),
    ("x0_start", "parameter", "fixed", "exact", "2", ""),
)
FAULTS = {"crash": 1, "exit": 2, "hang": 3, "error": 4, "discard": 5, "leak": 6, "faulty restore": 7, "wrong derivative": 8, "fixed inner step": 9}


def make_fmu(folder, version, *, saves=True, directional=True, lists=True, exchange=True, step='stepSize="0.01"', inner=""):
    """Return the path of an FMU.

    ``saves``, ``directional`` and ``lists`` are whether it declares that it saves states, has directional derivatives, and lists its
    derivatives. ``inner`` is an attribute of its co-simulation.
    """
    import fmpy

    platform = fmpy.platform if version == 2 else fmpy.platform_tuple
    library = Path(folder) / f"vanderpol{version}{fmpy.sharedLibraryExtension}"
    if not library.exists():
        headers = Path(fmpy.__file__).parent / "c-code"
        command = [COMPILER, "-shared", "-fPIC", "-O1", "-ffp-contract=off", "-w", f"-I{headers}", f"-I{HERE}"]
        subprocess.run([*command, str(HERE / f"fmi{version}.c"), "-o", str(library), "-lm"], check=True)
    path = Path(folder) / f"vanderpol{version}_{saves:d}{directional:d}{lists:d}{exchange:d}{len(step)}{len(inner)}.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", (_fmi2 if version == 2 else _fmi3)(saves, directional, lists, exchange, step, inner))
        archive.write(library, f"binaries/{platform}/vanderpol{fmpy.sharedLibraryExtension}")
    return path


def _attributes(pairs):
    return " ".join(f'{name}="{value}"' for name, value in pairs if value is not None)


def _flag(value):
    return "true" if value else "false"


def _fmi2(saves, directional, lists, exchange, step, inner):
    units = "".join(f'<Unit name="{unit}"/>' for unit in ("m", "m/s", "m/s2"))
    rows = []
    for k, (name, causality, variability, initial, start, more) in enumerate(_VARIABLES):
        pairs = [("name", name), ("valueReference", k), ("causality", causality), ("variability", variability), ("initial", initial)]
        head = _attributes(pairs)
        more = more.format(x0=2, x1=4) if lists else "" if "derivative" in more else more
        rows.append(f"<ScalarVariable {head}><Real {_attributes([('start', start)])} {more}/></ScalarVariable>")
    common = f'modelIdentifier="vanderpol" canGetAndSetFMUstate="{_flag(saves)}" providesDirectionalDerivative="{_flag(directional)}"'
    derivatives = '<Derivatives><Unknown index="3"/><Unknown index="5"/></Derivatives>' if lists else ""
    unknown = '<Unknown index="3"/><Unknown index="5"/>' if lists else ""
    model_exchange = f"<ModelExchange {common}/>" if exchange else ""
    return (
        '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="2.0" modelName="VanDerPol" guid="{van-der-pol}" '
        f'generationTool="Stub 1.2" numberOfEventIndicators="{1 if exchange else 0}">{model_exchange}'
        f'<CoSimulation {common} {inner} canHandleVariableCommunicationStepSize="true"/><UnitDefinitions>{units}</UnitDefinitions>'
        f'<DefaultExperiment startTime="0" stopTime="1" {step}/><ModelVariables>{"".join(rows)}</ModelVariables><ModelStructure>'
        f'<Outputs><Unknown index="2"/><Unknown index="8"/></Outputs>{derivatives}'
        f'<InitialUnknowns>{unknown}<Unknown index="8"/></InitialUnknowns></ModelStructure></fmiModelDescription>'
    )


def _fmi3(saves, directional, lists, exchange, step, inner):
    units = "".join(f'<Unit name="{unit}"/>' for unit in ("m", "m/s", "m/s2"))
    rows = []
    for k, (name, causality, variability, initial, start, more) in enumerate(_VARIABLES):
        initial = "exact" if causality == "input" else initial
        pairs = [("name", name), ("valueReference", k), ("causality", causality), ("variability", variability), ("initial", initial)]
        more = more.format(x0=1, x1=3) if lists else "" if "derivative" in more else more
        rows.append(f"<Float64 {_attributes([*pairs, ('start', start)])} {more}/>")
    indicated = '<Float64 name="z" valueReference="11" causality="local" variability="continuous" initial="calculated"/>'
    rows.append(indicated if exchange else "")
    common = f'modelIdentifier="vanderpol" canGetAndSetFMUState="{_flag(saves)}" providesDirectionalDerivatives="{_flag(directional)}"'
    derivatives = '<ContinuousStateDerivative valueReference="2"/><ContinuousStateDerivative valueReference="4"/>' if lists else ""
    unknown = "".join(f'<InitialUnknown valueReference="{k}"/>' for k in ((2, 4, 7) if lists else (7,)))
    model_exchange = f"<ModelExchange {common}/>" if exchange else ""
    indicator = '<EventIndicator valueReference="11"/>' if exchange else ""
    return (
        '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="3.0" modelName="VanDerPol" '
        f'generationTool="Stub 1.2" instantiationToken="{{van-der-pol}}">{model_exchange}'
        f'<CoSimulation {common} {inner} canHandleVariableCommunicationStepSize="true"/><UnitDefinitions>{units}</UnitDefinitions>'
        f'<DefaultExperiment startTime="0" stopTime="1" {step}/><ModelVariables>{"".join(rows)}</ModelVariables><ModelStructure>'
        f'<Output valueReference="1"/><Output valueReference="7"/>{derivatives}{unknown}{indicator}</ModelStructure></fmiModelDescription>'
    )
