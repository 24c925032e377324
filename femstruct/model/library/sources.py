"""Works that several families quote, and what they print in common."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Fact, Source

_COPY: Final = "read in the transcription of the public package phonometry"
HOPKINS: Final = Source("C. Hopkins, Sound Insulation, Elsevier 2007, table A2", _COPY)
HOPKINS_LAYERS: Final = Source("C. Hopkins, Sound Insulation, Elsevier 2007, table A3, p. 610", _COPY)
VIGRAN: Final = Source("T. E. Vigran, Building Acoustics, Taylor & Francis 2008, table 3.1, p. 88", _COPY)
VIGRAN_MODULI: Final = Source("T. E. Vigran, Building Acoustics, Taylor & Francis 2008, table 8.3, p. 318", _COPY)
ESTIMATE: Final = "an estimate of the author"


def of_vigran(E: float, nu: float, rho: tuple[float, float], loss_factor: tuple[float, float]) -> tuple[Fact, ...]:
    """A row of Vigran's table 3.1: E [Pa], and of density [kg/m^3] and loss factor the middle of what is printed.

    >>> [one.value for one in of_vigran(3.8e9, 0.2, (650.0, 800.0), (0.01, 0.03))]
    [3800000000.0, 0.2, 725.0, 0.02]
    """
    middle = "middle of the range"
    return (
        Fact("E", E, VIGRAN, note="dynamic"),
        Fact("nu", nu, VIGRAN, note="approximate"),
        Fact("rho", sum(rho) / 2.0, VIGRAN, rho, middle),
        Fact("loss_factor", sum(loss_factor) / 2.0, VIGRAN, loss_factor, f"internal, {middle}"),
    )


def of_hopkins(
    speed: float,
    nu: float,
    rho: float,
    loss_factor: float | None,
    estimated: bool = True,
    speeds: tuple[float, float] | None = None,
) -> tuple[Fact, ...]:
    """E, nu, rho and the internal loss factor of a row of Hopkins' table A2, which prints the speed c of longitudinal
    waves in plates [m/s]: E = rho c^2 (1 - nu^2).

    estimated : whether the loss factor is the author's estimate; all ratios nu but of metals and glass are.
    speeds : the range of c that is printed beside it.

    >>> [round(one.value / 1e9, 2) for one in of_hopkins(3800.0, 0.2, 2200.0, 0.005) if one.key == "E"]
    [30.5]
    """
    per_speed = rho * (1.0 - nu**2)
    between = None if speeds is None else (per_speed * speeds[0] ** 2, per_speed * speeds[1] ** 2)
    facts = [
        Fact("E", per_speed * speed**2, HOPKINS, between, f"dynamic: rho c^2 (1 - nu^2) with c = {speed:g} m/s"),
        Fact("nu", nu, HOPKINS, note=ESTIMATE),
        Fact("rho", rho, HOPKINS),
    ]
    if loss_factor is not None:
        facts.append(Fact("loss_factor", loss_factor, HOPKINS, note=f"internal{', ' + ESTIMATE if estimated else ''}"))
    return tuple(facts)
