"""What the paper prints, misprints included, and how one line beside it is judged.

Source: B. Christiansen, H. Maurer, O. Zirn, Optimal Control of Machine Tool Manipulators.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from math import isnan, nan
from types import MappingProxyType

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, Value

FORCE_LIMIT = 2e3
"""F_max of secs. 5.1, 5.2 and 6 [N]."""
LARGEST_FORCE = 4e3
"""Upper limit of F_max "for mechanical reasons", Table 1 [N]."""
VELOCITY_STEP = 0.1
"""v_s(t_f), eq. (3) [m/s]."""
KALMAN_RANK, JACOBIAN_RANK = 7, 6
"""Rank of eq. (10), and of the Jacobian of the terminal conditions, sec. 5.1."""
SWITCHES = 5
"""Number of switches "for all values of F_max > 0", eq. (11)."""
SWITCHING_TIMES = (0.009337, 0.009668, 0.036552, 0.037653, 0.041942)
"""t_1 ... t_5, eq. (12) [s]."""
T_F = 0.043505
"""t_f, eq. (12) [s]."""
ADJOINT = (-11.87902, 0.0, 14.75425, 0.05508, -0.23018, 0.01149, -1.2503e-6)
"""λ(0), sec. 5.1, in the order of the states."""
TIME_ACCURACY = 1e-4
"""The text calls switching times "correct up to 3-4 decimals", sec. 5 [s]."""
RATE_BOUND = 0.005
"""c_φ, sec. 5.2 [rad/s]."""
BOUNDED_T_F = 0.0522
"""t_f under that bound, sec. 5.2, and t_f of sec. 6 [s]."""
INCREASE = 0.23
"""By how much that is longer than (12), sec. 5.2 [-]."""
BANG_ARCS = (2, 5, 2)
"""Bang arcs before, between and after the two boundary arcs, sec. 5.2."""
PEAKS = (0.008916, 0.005, 0.022444)
"""Sec. 6, printed as ‖φ‖: damping-optimal, bounded and free time-optimal control [rad/s]."""

NUMBERS = {
    "kalman-rank": "5, (10)",
    "adjoint-equations": "5, (8)",
    "switching-time": "5.1, (12)",
    "final-time": "5.1, (12)",
    "terminal-error": "5.1, (12)",
    "adjoint": "5.1",
    "adjoint-implied": "5.1",
    "hamiltonian": "5, (7)",
    "jacobian-rank": "5.1",
    "bounded-time": "5.2",
    "increase": "5.2",
    "largest-rate": "5.2, (13)",
    "peak-rate": "6",
    "weight": "6, (17)",
    "control-law": "6, (16)",
}
"""Sections and equations in which numbers stand, by what is compared."""


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement or formula as the paper prints it."""

    place: str  # Section and equation
    text: str
    corrected: str | Message = ""  # What it must read; "" where it is no misprint


_EVERYWHERE = f"{SWITCHES} for all values of F_max > 0"
_BANG_ARCS = f"{' + '.join(map(str, BANG_ARCS))} = {sum(BANG_ARCS)}"

CLAIMS = {
    "order": Claim("5.2", "order 2: F_set first appears in the second derivative"),
    "active-damping": Claim(
        "3",
        "possible with sensors quite near to the TCP, but the achievable damping is not sufficient",
    ),
    "overshoot": Claim("3, (i)", "the terminal position is not attained precisely: overshooting"),
    "transfer-time": Claim("3, (ii)", "much larger than the minimal transfer time"),
    "jerk-control": Claim(
        "3", "optimum productivity with suitable damping for significant jerk control"
    ),
    "jerk-follows": Claim(
        "3", "the eigenfrequency of the dominating mode; no commissioning rules up to now"
    ),
    "switching-law": Claim("5, (9)", "F_set = -sign(lambda_F) F_max"),
    "law-as-printed": Claim("5.1", "(9) holds with high accuracy"),
    "switches": Claim("5.1, (11)", f"{SWITCHES}, +F_max first"),
    "switches-everywhere": Claim("5, (11)", _EVERYWHERE),
    "switches-beyond": Claim("5, (11)", _EVERYWHERE),
    "boundary-arcs": Claim("5.2", "one with v_phi = +c, then one with v_phi = -c"),
    "bang-arcs": Claim("5.2", _BANG_ARCS),
    "second-derivative": Claim(
        "5.2", "(d^2 - k)/J v_phi + d k/J phi - ...", "(d^2/J - k)/J v_phi + d k/J^2 phi - ..."
    ),
    "boundary-control": Claim(
        "5.2",
        "T (k - d^2)/r v_phi - T d k/r phi + (1 + T d/J) F",
        "T (k - d^2/J)/r v_phi - T d k/(r J) phi + (1 + T d/J) F",
    ),
    "inside": Claim("5.2", "assumed"),
    "switching-function": Claim(
        "5.2, (14)", "lambda_I(t) / T = H_U(t) = 0", "lambda_F(t) / T = H_{F_set}(t) = 0"
    ),
    "multiplier": Claim(
        "5.2, (15)",
        "J/(r m_b) lambda_xb - lambda_phi - J d_b/(r m_b^2) lambda_vb",
        Message("paper-multiplier.correct"),
    ),
    "jumps": Claim("5.2", "lambda_vphi may have jumps at entry and exit"),
    "terms": Claim("6", "all of the same magnitude"),
    "cost": Claim("6, (5)", "no value printed"),
    "continuous": Claim("6", "any optimal control is continuous"),
    "saturated": Claim("7", "linear-quadratic with control constraints (saturated control)"),
    "functional": Claim(
        "6",
        "lambda = -2 D x - lambda A, D = diag(c1, 0, c2, c3, 0, c4)",
        "d lambda/dt = -2 D x - lambda A, D = diag(c1, 0, c2, c3, 0, c4, 0)",
    ),
    "least-time": Claim("4", "t_f > t_f,min"),
    "oscillation": Claim("4", "some of the time-optimal state trajectories are highly oscillatory"),
    "more-force": Claim("5.2", "higher values of F_max lead to higher vibrations"),
    "bound-helps": Claim("5.2", "significant reduction"),
    "rate-between": Claim(
        "6", "notably higher than the bound, significantly smaller than time-optimal"
    ),
    "bounds-damp": Claim("7", "significantly improved by suitable state constraints"),
    "hints": Claim("7", "concrete hints for suitable jerk limitations"),
}
"""Claims by what is compared."""

NOTHING: Mapping[str, Value] = MappingProxyType({})
"""What most rows have to say beside their numbers."""


class Verdict(Enum):
    """How a printed number or claim stands beside ours.

    A row is out of tolerance where the paper and we differ and nothing explains it: then either
    the program or this comparison is wrong.
    """

    AGREES = "agrees"
    CORRECTED = "agrees with the correction"
    DIFFERS = "differs, with reason"
    OUT = "OUT OF TOLERANCE"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One number or claim."""

    place: str  # section and equation of the paper that print it
    key: str  # of its texts: what it is, ours, what it was judged by, the reason of a difference
    values: Mapping[str, Value]  # of which they speak
    unit: str = ""  # SI unit; "" for a claim or a plain number
    # printed, corrected, ours: As text; "" where nothing had to be corrected, and where our side
    # of a claim is among the texts.
    printed: str
    corrected: str | Message = ""
    ours: str = ""
    # printed_value, ours_value: As numbers in the unit; nan for a claim.
    printed_value: float = nan
    ours_value: float = nan
    difference: float = nan  # Ours less the printed (or corrected) value; nan for a claim
    tolerance: float = nan  # Largest |difference| that agrees; nan for a claim
    verdict: Verdict

    @property
    def is_claim(self) -> bool:
        """Whether the row is about a statement, not a number."""
        return isnan(self.tolerance)


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """A row in the words and numbers of a language; claims of the paper stay as printed."""

    place: str
    quantity: str  # what it is
    unit: str
    printed: str
    corrected: str
    ours: str
    basis: str  # where the tolerance comes from, or what a claim was tested by
    reason: str  # why paper and we differ, or what to know; "" where there is nothing to say


def tell(row: Row, words: Catalogue) -> Told:
    """Return a row in the words of a catalogue."""

    def say(part: str) -> str:
        kind = f"paper-{row.key}{part}"
        return words.text(kind, **row.values) if words.has(kind) else ""

    def figure(text: str) -> str:
        return text if row.is_claim else text.replace(".", words.format.decimal_mark)

    return Told(
        place=words.text("paper-place", at=row.place),
        quantity=say(""),
        unit=row.unit,
        printed=figure(row.printed),
        corrected=figure(words.say(row.corrected)),
        ours=figure(row.ours) or say(".ours"),
        basis=say(".basis"),
        reason=say(".reason"),
    )


def number(
    key: str,
    printed: float,
    ours: float,
    tolerance: float,
    values: Mapping[str, Value] = NOTHING,
    *,
    unit: str = "",
    corrected: float = nan,
    literal: float = nan,
) -> Row:
    """Return a comparison of two numbers; ``literal`` is ours where the print is taken literally.

    What then is right is a text of the row, "correct".

    Examples
    --------
    >>> number("increase", 2.0, 1.01, 0.1, corrected=1.0).verdict.value
    'agrees with the correction'
    """
    wanted = printed if isnan(corrected) else corrected
    difference, verdict = (ours if isnan(literal) else literal) - printed, Verdict.AGREES
    told: Message | str = ""
    if not abs(difference) <= tolerance:
        difference = ours - wanted
        is_repaired = not (isnan(corrected) and isnan(literal)) and abs(difference) <= tolerance
        verdict = Verdict.CORRECTED if is_repaired else Verdict.OUT
        if not isnan(corrected):
            told = f"{corrected:.7g}"
        elif not isnan(literal):
            told = Message(f"paper-{key}.correct")
    return Row(
        place=NUMBERS[key],
        key=key,
        values=values,
        unit=unit,
        printed=f"{printed:.7g}",
        corrected=told,
        # Two digits where the printed number is 0: the rest is rounding.
        ours=f"{ours:.7g}" if wanted != 0.0 else f"{ours:.2g}",
        printed_value=printed,
        ours_value=ours,
        difference=difference,
        tolerance=tolerance,
        verdict=verdict,
    )


def claim(
    key: str, values: Mapping[str, Value] = NOTHING, *, holds: bool, refuted: bool = False
) -> Row:
    """Return a statement that ``holds`` (as corrected, where that is printed) or is ``refuted``.

    Examples
    --------
    >>> claim("order", {"order": 3}, holds=False).verdict.value
    'OUT OF TOLERANCE'
    """
    printed = CLAIMS[key]
    verdict = Verdict.DIFFERS if refuted else Verdict.OUT
    if holds:
        verdict = Verdict.CORRECTED if printed.corrected else Verdict.AGREES
    return Row(
        place=printed.place,
        key=key,
        values=values,
        printed=printed.text,
        corrected=printed.corrected,
        verdict=verdict,
    )
