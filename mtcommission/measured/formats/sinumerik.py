"""SINUMERIK: frequency measurements, servo tuning sessions and servo traces, all XML.

Structure read in a measurement (../tests/data/identify) and in Trace-Tools (E. Rhodén, MIT): root
``ResponseTestCustom`` holds one measurement with its auto and cross spectra [Hz], root
``DynamicModelAxisController`` a tuning session whose ``m_pPlant`` is motor speed per torque, with
``m_pMeasCoherence``; a trace has ``traceData/dataFrame/dataSignal`` and records
``rec time= f1= ...``, in which a missing value keeps the last one. A public session
(eliasrhoden/Sinumerik-Ctrl at 467a421, AST_AX7.xml) holds its frequencies in Hz, up to half the
sampling rate, where its auto-tuning measured to. Numbers are big-endian doubles in base 85: digits,
small letters, capitals and 23 marks count from 0 to 84; five of them make 32 bits, a point stands
for a word of zeros (found by decoding).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import pi
from xml.etree.ElementTree import Element, ParseError, fromstring

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.measured.measurement import (
    Array,
    Column,
    ComplexArray,
    FileContents,
    Given,
    ResponseContents,
    Sensor,
    Signal,
    TimeContents,
    broken,
)

ALPHABET = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ!#$`()*+-/:;=?@[]^_{|}~"
MEASUREMENT, SESSION, TRACE = "ResponseTestCustom", "DynamicModelAxisController", "traceData"
PLANT, COHERENCE = "m_pPlant", "m_pMeasCoherence"
SETPOINT = "setpoint"
"""Input of a response that is measured from the setpoint of a loop, not from a force."""
MOSTLY_GOOD = 0.9
"""Share of lines with numbers that a response must have."""
ABSURD = 1e100
"""Beyond it a number is a broken one."""
AT_NYQUIST = 0.02
"""Relative distance of a session's last line from half the sampling rate."""
UNITY = 0.25
"""How far a loop's response from its setpoint may be from 1 at low frequency."""


def read_sinumerik(data: bytes, response: str, *, file: str) -> FileContents:
    """Return the measurement, session or trace in a file; ``response``: which one, "" for any."""
    if b"<!DOCTYPE" in data[:4096] or b"<!ENTITY" in data:
        raise broken("identify-xml-unknown", root="DOCTYPE")
    try:
        root = fromstring(data)
    except (ParseError, ValueError, LookupError) as error:
        line = error.position[0] if isinstance(error, ParseError) else 0
        raise broken("identify-xml-broken", line=line, reason=str(error)) from error
    if root.tag == MEASUREMENT:
        return _measurement(root)
    if root.tag == SESSION:
        return _session(root, response, file)
    if root.tag == TRACE or root.find(f".//{TRACE}") is not None:
        return _trace(root)
    raise broken("identify-xml-unknown", root=root.tag[:60])


def _named(root: Element, name: str) -> list[Element]:
    return [element for element in root.iter() if element.get("name") == name]


def _text(root: Element, name: str) -> str:
    return next((element.text or "" for element in _named(root, name)), "").strip()


def _number(root: Element, name: str) -> float:
    """The number of that name; 0 where there is none, or no measurement gives it."""
    return next((value for value in _numbers(_named(root, name)[:1]) if abs(value) < ABSURD), 0.0)


def _numbers(elements: Iterable[Element]) -> list[float]:
    found = []
    for element in elements:
        try:
            found.append(float(element.text or ""))
        except ValueError:
            found.append(0.0)
    return found


def _decode(text: str, name: str) -> Array:
    wrong = broken("identify-series-broken", name=name)
    pieces = "".join(text.split()).split(".")
    plain = (5 * ALPHABET[0]).join(pieces)
    if not plain.isascii() or any(len(piece) % 5 for piece in pieces):
        raise wrong
    digits = _DIGITS[np.frombuffer(plain.encode(), dtype=np.uint8)]
    if (digits < 0).any():
        raise wrong
    words = digits.reshape(-1, 5) @ 85 ** np.arange(4, -1, -1, dtype=np.int64)
    if words.size % 2 or (words > 0xFFFFFFFF).any():
        raise wrong
    return np.frombuffer(words.astype(">u4").tobytes(), dtype=">f8").astype(np.float64)


_DIGITS = np.array([ALPHABET.find(chr(sign)) for sign in range(256)], dtype=np.int64)


def _series(parent: Element, name: str) -> Array:
    """A series of doubles, checked against the length beside it."""
    for array in parent.iter("NumericArray"):
        if array.get("name") != name:
            continue
        values = _decode(array.findtext("raw") or "", name)
        complex_ = array.get("elementtype") == "ComplexNumber"
        length = int(_number(array, "m_length")) * (2 if complex_ else 1)
        if values.size != length and _text(array, "m_length"):
            raise _short(name, values.size, length)
        return values
    length, end = int(_number(parent, f"{name}.length")), _number(parent, f"{name}.end")
    if 1 < length <= 10**7:
        return np.linspace(_number(parent, f"{name}.start"), end, length)
    raise _missing(name)


def _short(name: str, got: int, wanted: int) -> InputError:
    return broken("identify-series-short", name=name, got=got, wanted=wanted)


def _missing(name: str) -> InputError:
    return broken("identify-series-missing", name=name)


def _complex_series(parent: Element) -> tuple[Array, ComplexArray]:
    """Frequencies, in the file's unit, and values."""
    pairs = _series(parent, "m_ValueVector")
    frequency = _series(parent, "m_FrequencyVector")
    if pairs.size == frequency.size:  # a series of real numbers
        return frequency, pairs.astype(np.complex128)
    if pairs.size != 2 * frequency.size:
        raise _short("m_FrequencyVector", frequency.size, pairs.size // 2)
    return frequency, pairs.view(np.complex128)


def _good_lines(frequency: Array, values: ComplexArray, *, name: str) -> NDArray[np.bool_]:
    """Lines with numbers: 0 / 0 at 0 Hz is one without."""
    good = np.isfinite(values) & np.isfinite(frequency)
    if not good.size or good.mean() < MOSTLY_GOOD:
        raise broken("identify-series-not-finite", name=name)
    return good


def _is_rotary(root: Element) -> bool:
    return _text(root, "m_bIsLinearMotor") != "true"


def _measured_on(root: Element) -> str:
    date = _text(root, "Date")
    if len(date) == 8 and date.isdigit():
        return f"{date[:4]}-{date[4:6]}-{date[6:]}"
    return _text(root, "m_szInitTime")[:40]


def _motor_turn(root: Element) -> float:
    is_turning = _text(root, "m_bIsRotaryAxis") == "true"
    return 0.0 if is_turning else abs(_number(root, "m_dMotorToAxisRatio"))


def _measurement(root: Element) -> FileContents:
    pair = next(root.iter("PrimaryFreqRespSigNodeData"), None)
    if pair is None:
        raise _missing("PrimaryFreqRespSigNodeData")
    by_id = {
        int(_number(node, "m_iUniqueInstanceId")): node for node in root.iter("PlatformSignalNode")
    }
    ends = [int(_number(pair, f"m_i{end}SigNodeUniqueInstanceID")) for end in ("Input", "Output")]
    if not set(ends) <= set(by_id):
        raise _missing("PlatformSignalNode")
    nodes = [by_id[end] for end in ends]
    names = [str(int(_number(node, "m_uNodeId"))) for node in nodes]
    cross = [
        info
        for info in nodes[1].iter("SigNodeCrossSpectrumInfo")
        if info.get("name") != "m_autospectrumInfo" and _text(info, "m_uSignodeId") == names[0]
    ]
    if not cross:
        raise _missing("SigNodeCrossSpectrumInfo")
    frequency, spectrum = _complex_series(cross[0])
    powers = []
    for node in nodes:
        infos = _named(node, "m_autospectrumInfo")
        if not infos:
            raise _missing("m_autospectrumInfo")
        powers.append(_complex_series(infos[0])[1].real.copy())
    if any(one.size != spectrum.size for one in powers):
        raise _short("CrossSpectrum", powers[0].size, spectrum.size)
    with np.errstate(all="ignore"):
        values = spectrum.conj() / powers[0]  # the file has input times the output's conjugate
        coherence = np.abs(spectrum) ** 2 / (powers[0] * powers[1])
    good = _good_lines(frequency, values * coherence, name="CrossSpectrum")
    good &= frequency > 0.0
    lowest = np.abs(values[good][:8])
    is_setpoint = lowest.size and abs(float(np.median(lowest)) - 1.0) < UNITY
    item = ResponseContents(
        label=" → ".join(names),
        frequency_hz=frequency[good],
        values=values[good],
        scale=1.0,
        said=Given(
            input=SETPOINT if is_setpoint else "",
            output=Signal.VELOCITY if is_setpoint else None,
            sensor=Sensor.ENCODER,
            motor_turn=_motor_turn(root),
        ),
        rotary=_is_rotary(root),
        coherence=np.clip(coherence[good], 0.0, 1.0),
        averages=float(max(int(_number(cross[0], "m_uNumSpectraInAvg")), 1)),
        resolution_hz=0.0,  # a periodic excitation, averaged over whole periods
    )
    return FileContents(
        items=(item,),
        measured_on=_measured_on(root),
    )


def _session(root: Element, response: str, file: str) -> FileContents:
    """The last plant that was measured, or the response that is asked for."""
    speed = next(iter(_named(root, "m_SpeedControllerList")), root)
    plants = _measured(speed, PLANT)
    if not plants and not response:
        raise _missing(PLANT)
    count = len(plants)
    named = {f"{PLANT}[{n}]" if count > 1 else PLANT: one for n, one in enumerate(plants, 1)}
    taken = list(named)[-1] if named else ""
    for one in _measured(root):
        if (name := one.get("name", "")) and name not in (PLANT, COHERENCE):
            named.setdefault(name, one)
    if (response or taken) not in named:
        raise broken("identify-not-there", got=response, found=", ".join(named))
    chosen = named[response or taken]
    unit, remarks = _frequency_unit(root, speed, chosen)
    if axis := _text(root, "m_szAxisName"):
        remarks.append(Message("identify-axis-of-file", name=axis))
    if not response and len(named) > 1:
        others = ", ".join(name for name in named if name != taken)
        kind = "identify-response-taken" if count == 1 else "identify-last-response-taken"
        remarks.append(Message(kind, name=taken, others=others, file=file))
    item = _response_of(root, speed, chosen)
    return FileContents(
        items=(replace(item, label=response, frequency_hz=unit * item.frequency_hz),),
        measured_on=_measured_on(root),
        remarks=tuple(remarks),
    )


def _measured(root: Element, name: str = "") -> list[Element]:
    """Responses with values, of one name or all; what two sets of gains repeat is there once."""
    found = {one.findtext(".//raw"): one for one in root.iter("FrequencyResponseFunction")
             if name in ("", one.get("name"))}  # fmt: skip
    return [one for text, one in found.items() if text]


def _frequency_unit(
    root: Element, speed: Element, response: Element
) -> tuple[float, list[Message]]:
    """Hz per unit of the file's frequencies, which reach to half of one of its sampling rates."""
    last = float(np.max(_series(response, "m_FrequencyVector"), initial=0.0))
    cycles = (*_named(speed, "m_dUpdateTimeSeconds"), *_named(root, "m_dSamplingInterval"))
    steps = [step for step in _numbers(cycles) if 1e-7 < step < 1.0]
    if not steps:
        return 1.0, [Message("identify-hz-assumed", last=last)]
    for unit in (1.0, 1.0 / (2 * pi)):
        if any(abs(2.0 * step * unit * last - 1.0) < AT_NYQUIST for step in steps):
            return unit, []
    step = min(steps)
    raise broken("identify-frequency-neither", last=last, nyquist=0.5 / step, step=step)


def _response_of(root: Element, speed: Element, element: Element) -> ResponseContents:
    """A response, and for motor speed per torque what it is, with the coherence beside it."""
    name = element.get("name", "")
    frequency, values = _complex_series(element)
    good = _good_lines(frequency, values, name=name)
    found = ResponseContents(frequency_hz=frequency[good], values=values[good])
    if name != PLANT:  # only its name is known: input and output are for the user to say
        return found
    beside = next((one for one in speed.iter() if element in list(one)), speed)
    coherence = None
    for one in _measured(beside, COHERENCE) or _measured(speed, COHERENCE):
        _, gamma = _complex_series(one)
        if gamma.size == values.size:
            coherence = np.nan_to_num(np.clip(gamma.real, 0.0, 1.0))[good]
    rotary = _is_rotary(root)
    return replace(
        found,
        scale=1.0,
        said=Given(
            input="torque" if rotary else "force",
            output=Signal.VELOCITY,
            sensor=Sensor.ENCODER,
            motor_turn=_motor_turn(root),
        ),
        rotary=rotary,
        coherence=coherence,
        averages=max(_numbers(_named(root, "m_uNumberOfAverages")), default=0.0) or None,
    )


def _trace(root: Element) -> FileContents:
    frame = root.find(".//dataFrame")
    signals = list(frame.iter("dataSignal")) if frame is not None else []
    if frame is None or not signals:
        raise _missing("dataSignal")
    shown = {one.get("key"): one for one in root.iter("signal") if one.get("key")}
    fields = [one.get("id", "") for one in signals]
    if not all(key.startswith("f") for key in fields):
        fields = [f"f{place}" for place in range(1, len(signals) + 1)]
    rows: list[list[float]] = []
    row = [np.nan] * (len(fields) + 1)
    for record in frame.iter("rec"):
        row = list(row)
        for place, name in enumerate(("time", *fields)):
            if (text := record.get(name)) is None:
                continue
            try:
                row[place] = float(text)
            except ValueError as error:
                at = len(rows) + 1
                raise broken("identify-record-broken", got=text[:40], row=at) from error
        rows.append(row)
    values = np.asarray(rows, dtype=np.float64).reshape(-1, len(fields) + 1)
    whole = np.isfinite(values).all(axis=1)
    values = values[int(np.argmax(whole)) :] if whole.any() else values[:0]
    if values.shape[0] < 2 or not np.isfinite(values).all():
        raise _missing("rec")
    columns = []
    for place, (one, key) in enumerate(zip(signals, fields, strict=True), start=1):
        more = shown.get(one.get("key"), one)
        name = more.get("name") or one.get("name") or more.get("description") or key
        unit = next((v for k, v in (*one.items(), *more.items()) if "unit" in k.casefold()), "")
        columns.append(Column(name=name, unit=unit, values=values[:, place]))
    record_ = TimeContents(clock=values[:, 0], columns=tuple(columns))
    return FileContents(items=(record_,))
