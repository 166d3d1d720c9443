"""Measured files in every format, made from one axis whose responses are known exactly."""

from __future__ import annotations

import gc
import warnings
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyuff
from numpy.typing import NDArray
from scipy.signal import cont2discrete, dlsim

from mtcommission.measured.formats.sinumerik import ALPHABET

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
REAL = Path(__file__).parent / "data" / "identify"

MASS, VISCOUS, DELAY = 120.0, 900.0, 4e-4
MODES = ((38.0, 0.02, 0.004, -0.006), (117.0, 0.03, 0.003, 0.005))
"""Frequency [Hz], damping ratio, gain at encoder and at tool [1/kg]."""

LINES = np.geomspace(4.0, 400.0, 240)
TWO_PI = 2 * np.pi


def response(frequency_hz: Array, *, sensor: str = "encoder", derivative: int = 1) -> ComplexArray:
    """Output per force: the model of the facts file, written down once more."""
    s = 2j * np.pi * frequency_hz
    place = 2 if sensor == "encoder" else 3
    elastic = sum(
        mode[place] / (s**2 + 2 * mode[1] * TWO_PI * mode[0] * s + (TWO_PI * mode[0]) ** 2)
        for mode in MODES
    )
    rigid = 1.0 / (MASS * s**2 + VISCOUS * s)
    return np.exp(-s * DELAY) * s**derivative * (rigid + elastic)


def _held(step: float) -> tuple[Array, Array, Array, Array]:
    """The axis without its delay, its force held between samples; outputs encoder and tool."""
    size = 2 + 2 * len(MODES)
    A, B, C = np.zeros((size, size)), np.zeros((size, 1)), np.zeros((2, size))
    A[0, 1], A[1, 1], B[1, 0] = 1.0, -VISCOUS / MASS, 1.0 / MASS
    C[:, 0] = 1.0
    for number, (hertz, zeta, encoder, tool) in enumerate(MODES, start=1):
        place, omega = 2 * number, TWO_PI * hertz
        A[place, place + 1] = 1.0
        A[place + 1, place : place + 2] = -(omega**2), -2 * zeta * omega
        B[place + 1, 0] = 1.0
        C[:, place] = encoder, tool
    A, B, C, D, _ = cont2discrete((A, B, C, np.zeros((2, 1))), step)
    return A, B, C, D


def positions(force: Array, step: float) -> tuple[Array, Array]:
    """Encoder and tool at samples of a force that is held between them."""
    _, y, _ = dlsim((*_held(step), step), force[:, None])
    return y[:, 0], y[:, 1]


def held(frequency_hz: Array, step: float, *, sensor: str = "encoder") -> ComplexArray:
    """Samples of the position per sample of a force that is held between them."""
    A, B, C, _ = _held(step)
    row, eye = C[0 if sensor == "encoder" else 1], np.eye(len(A))
    shifts = np.exp(2j * np.pi * frequency_hz * step)
    return np.array([row @ np.linalg.solve(z * eye - A, B)[:, 0] for z in shifts])


def multisine(size: int, step: float, low: float, high: float) -> Array:
    """One period with Schroeder's phases."""
    lines = np.arange(int(np.ceil(low * size * step)), int(high * size * step) + 1)
    t = step * np.arange(size)
    phases = -np.pi * np.arange(lines.size) * (np.arange(lines.size) + 1) / lines.size
    return np.cos(TWO_PI * np.outer(t / (size * step), lines) + phases).sum(axis=1)


def table(
    heads: list[str], columns: list[Array], *, separator: str = ",", decimal: str = ".",
    comments: str = "", digits: int = 12, end: str = "\n",
) -> bytes:  # fmt: skip
    rows = [separator.join(heads)] if heads else []
    rows += [
        separator.join(f"{x:.{digits}g}".replace(".", decimal) for x in row)
        for row in zip(*columns, strict=True)
    ]
    return (comments + end.join(rows) + end).encode()


def response_table(
    frequency_hz: Array,
    values: ComplexArray,
    coherence: Array | float,
    *,
    unit: str = "m/s/N",
    averages: int = 16,
    comments: str = "",
) -> bytes:
    """Real and imaginary part by frequency, as an analyser writes them."""
    heads = ["frequency_hz", f"re [{unit}]", f"im [{unit}]", "coherence"]
    columns = [frequency_hz, values.real, values.imag, coherence + 0.0 * frequency_hz]
    return table(heads, columns, comments=f"# averages = {averages}\n{comments}")


def save_response(
    path: Path,
    frequency_hz: Array,
    values: ComplexArray,
    *,
    noise: float,
    averages: int = 16,
    seed: int = 0,
    unit: str = "m/s/N",
    comments: str = "",
) -> str:
    """A measured response: noise, relative in real and imaginary part, and its coherence."""
    scatter = np.random.default_rng(seed).normal(size=(2, values.size))
    seen = values * (1.0 + noise * (scatter[0] + 1j * scatter[1]))
    gamma2 = 1.0 / (1.0 + 2 * averages * noise**2)
    how = {"unit": unit, "averages": averages, "comments": comments}
    path.write_bytes(response_table(frequency_hz, seen, gamma2, **how))  # type: ignore[arg-type]
    return str(path)


def encode_doubles(values: Array) -> str:
    """Base 85, two words of five signs a number, ``.`` for a word of zeros."""
    words = np.frombuffer(values.astype(">f8").tobytes(), dtype=">u4").astype(np.int64)
    return "".join(
        "".join(ALPHABET[word // 85**power % 85] for power in range(4, -1, -1)) if word else "."
        for word in words
    )


def numeric_array(name: str, kind: str, values: Array) -> str:
    length = values.size // (2 if kind == "ComplexNumber" else 1)
    return (
        f'<NumericArray elementtype="{kind}" format="base85" name="{name}">'
        f'<unsigned_int name="m_length">{length}</unsigned_int>'
        f'<raw name="m_pNumberArray"><![CDATA[\n  {encode_doubles(values)}\n]]></raw>'
        "</NumericArray>"
    )


def _function(name: str, frequency: Array, values: Array) -> str:
    pairs = np.ascontiguousarray(values.astype(np.complex128)).view(np.float64)
    return (
        f'<FrequencyResponseFunction name="{name}">'
        + numeric_array("m_ValueVector", "ComplexNumber", pairs)
        + numeric_array("m_FrequencyVector", "double", frequency)
        + "</FrequencyResponseFunction>"
    )


def session(
    frequency_hz: Array,
    values: Array,
    coherence: Array,
    *,
    ratio: float = 0.0,
    per_hz: float = 1.0,
    step: float | None = None,
    repeats: int = 1,
) -> bytes:
    """A servo tuning session: motor speed per torque, up to half the sampling rate.

    ``per_hz`` is 2 pi for one in rad/s, ``step`` 0 for one without a sampling time; of several
    records only the last holds ``values``.
    """
    f = per_hz * frequency_hz
    step = 0.5 / frequency_hz[-1] if step is None else step
    turn = f'<float name="m_dMotorToAxisRatio">{ratio}</float>' if ratio else ""
    cycle = f'<float name="m_dUpdateTimeSeconds">{step:.24f}</float>' if step else ""
    records = "".join(
        '<PlantMeasRecord name="m_listMechPlants_el">'
        + _function("m_pPlant", f, values * (1 + 0.5 * (repeats - number)))
        + _function("m_pMeasCoherence", f, coherence + 0j)
        + "</PlantMeasRecord>"
        for number in range(1, repeats + 1)
    )
    return (
        '<?xml version="1.0" encoding="ISO-8859-1"?>\n<DynamicModelAxisController>'
        f'<string name="m_szAxisName">X1</string>{turn}'
        '<DynamicModelList name="m_PositionControllerList">'
        '<float name="m_dUpdateTimeSeconds">0.002</float></DynamicModelList>'
        f'<DynamicModelList name="m_SpeedControllerList">{cycle}'
        '<TransferFunction name="m_pPlant"></TransferFunction>'
        f"{records}</DynamicModelList>"
        + _function("m_CurrentControllerResponse", f, 1.0 / (1.0 + 0.3e-3j * TWO_PI * frequency_hz))
        + "</DynamicModelAxisController>\n"
    ).encode("latin-1")


def _spectrum(tag: str, node: int, other: int, frequency: Array, values: Array) -> str:
    pairs = np.ascontiguousarray(values.astype(np.complex128)).view(np.float64)
    return (
        f'<SigNodeCrossSpectrumInfo name="{tag}"><unsigned_int name="m_uSignodeId">{node}'
        f'</unsigned_int><unsigned_int name="m_uSecondId">{other}</unsigned_int>'
        '<unsigned_int name="m_uNumSpectraInAvg">6</unsigned_int><CrossSpectrum>'
        + numeric_array("m_ValueVector", "ComplexNumber", pairs)
        + numeric_array("m_FrequencyVector", "double", frequency)
        + "</CrossSpectrum></SigNodeCrossSpectrumInfo>"
    )


def measurement(frequency_hz: Array, values: Array, coherence: Array) -> bytes:
    """A stand-alone frequency measurement: spectra of input and output, and between them."""
    power = np.linspace(2.0, 1.0, values.size)
    out = np.abs(values) ** 2 * power / coherence
    nodes = [
        _spectrum("m_autospectrumInfo", 61, 0, frequency_hz, out)
        + _spectrum("m_crossSpecInfoList_el", 62, 61, frequency_hz, np.conj(values) * power),
        _spectrum("m_autospectrumInfo", 62, 0, frequency_hz, power),
    ]
    made = "".join(
        f'<PlatformSignalNode><unsigned_int name="m_uNodeId">{61 + number}</unsigned_int>'
        f'<integer name="m_iUniqueInstanceId">{number}</integer>{inner}</PlatformSignalNode>'
        for number, inner in enumerate(nodes)
    )
    return (
        '<?xml version="1.0" encoding="ISO-8859-1"?>\n<ResponseTestCustom>'
        f"{made}<PrimaryFreqRespSigNodeData>"
        '<integer name="m_iInputSigNodeUniqueInstanceID">1</integer>'
        '<integer name="m_iOutputSigNodeUniqueInstanceID">0</integer>'
        "</PrimaryFreqRespSigNodeData></ResponseTestCustom>"
    ).encode("latin-1")


def servo_trace(t: Array, columns: dict[str, Array]) -> bytes:
    """A servo trace in which a value that does not change is left out."""
    signals = "".join(f'<dataSignal key="k{n}" id="f{n}"/>' for n in range(1, len(columns) + 1))
    shown = "".join(
        f'<signal key="k{n}" name="{name}" description="/nc/{n}"/>'
        for n, name in enumerate(columns, start=1)
    )
    last: list[str] = [""] * len(columns)
    rows = []
    for k, time in enumerate(t):
        cells = [f"{values[k]:.9g}" for values in columns.values()]
        fields = "".join(
            f' f{n}="{cell}"' for n, cell in enumerate(cells, start=1) if cell != last[n - 1]
        )
        rows.append(f'<rec time="{time:.9g}"{fields}/>')
        last = cells
    return (
        "<?xml version='1.0' encoding='UTF-8'?><trace><traceDisplaySetup><signals>"
        f"{shown}</signals></traceDisplaySetup><traceData><dataFrame>{signals}{''.join(rows)}"
        "</dataFrame></traceData></trace>"
    ).encode()


def twincat(
    t: Array, columns: dict[str, tuple[str, Array]], *, separator: str = "\t", decimal: str = ",",
    shared: bool = True, full: bool = False, last: str = "",
) -> bytes:  # fmt: skip
    """An export of TwinCAT Scope, one column of times for all channels or for each."""
    names = list(columns)
    step = 1e3 * float(t[1] - t[0])
    clocks = [True] + [False] * len(names) if shared else [True, False] * len(names)

    def row(head: str, values: list[str]) -> str:
        cells = iter(values)
        return separator.join(head if clock else next(cells) for clock in clocks)

    def shown(value: float) -> str:
        return f"{value:.10g}".replace(".", decimal)

    lines = [
        f"Name{separator}scope",
        f"File{separator}C:\\a.svdx",
        f"Starttime of export{separator}1",
        "",
    ]
    lines += [row("Name", names), row("SampleTime[ms]", [shown(step)] * len(names))]
    lines += [row("ScaleFactor", ["1"] * len(names))]
    lines += [
        row("Unit", [f"{unit} (x)" if unit else "(None)" for unit, _ in columns.values()]),
        "",
    ]
    for k, time in enumerate(t):
        stamp = f"{132959733843760000 + round(1e7 * time)}" if full else shown(1e3 * time)
        lines.append(row(stamp, [shown(values[k]) for _, values in columns.values()]))
    return ("\r\n".join([*lines, last]) + "\r\n").encode("utf-8")


def uff(*sets: dict[str, object]) -> bytes:
    """A universal file, written by pyuff."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.uff"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResourceWarning)  # pyuff leaves the file open
            pyuff.UFF(str(path)).write_sets(list(sets), "overwrite")
            gc.collect()
        return path.read_bytes()


def uff_function(
    kind: int, frequency: Array, values: Array, *, above: int = 12, below: int = 13,
    units: tuple[str, str] = ("", ""), binary: int = 0,
) -> dict[str, object]:  # fmt: skip
    return {
        "type": 58, "binary": binary, "func_type": kind, "rsp_node": 1, "rsp_dir": 1,
        "ref_node": 2, "ref_dir": 1, "data": values, "x": frequency, "id1": "a", "id2": "b",
        "id3": "12-Nov-26", "id4": "", "id5": "", "rsp_ent_name": "", "ref_ent_name": "",
        "abscissa_spacing": 0, "abscissa_min": float(frequency[0]), "abscissa_inc": 0.0,
        "abscissa_spec_data_type": 18, "ordinate_spec_data_type": above,
        "orddenom_spec_data_type": below, "ordinate_axis_units_lab": units[0],
        "orddenom_axis_units_lab": units[1],
    }  # fmt: skip


def mutated(data: bytes, rng: np.random.Generator) -> bytes:
    """A file broken in one of the ways in which files break."""
    broken = bytearray(data)
    place = int(rng.integers(len(broken)))
    length = int(rng.integers(1, 200))
    ways: list[Callable[[], bytes]] = [
        lambda: bytes(broken[:place]),
        lambda: bytes(broken[:place] + broken[place + length :]),
        lambda: bytes(broken[:place] + rng.bytes(length) + broken[place:]),
        lambda: bytes(broken[:place] + broken[place : place + length] * 3 + broken[place:]),
        lambda: _lines(data, rng),
        lambda: data.replace(
            rng.choice([b",", b".", b";", b"\t", b" "]), rng.choice([b",", b".", b""])
        ),
        lambda: data.replace(
            b"1", rng.choice([b"nan", b"-1", b"1e400", b"x"]), int(rng.integers(1, 9))
        ),
        lambda: data.decode("latin-1").encode(rng.choice(["utf-16", "utf-8", "utf-8-sig"])),
    ]
    return ways[int(rng.integers(len(ways)))]()


def _lines(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.split(b"\n")
    one, other = rng.integers(len(lines), size=2)
    lines[one], lines[other] = lines[other], lines[one]
    return b"\n".join(lines)
