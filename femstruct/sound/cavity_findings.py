"""Findings on cavities: what their air did, and where it is a rough approximation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acoustics.cavities.cavity_air import CavityAir
from acoustics.cavities.equivalent_fluid import LEAST, MOST, Wool
from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.sound.placed_cavity import PlacedCavity

FEW = 0.7  # of the frequency up to which modes are needed
HELD = 0.5  # 1/s


def findings_of(
    basis: ModalBasis,
    coupled: ModalBasis,
    placed: Sequence[PlacedCavity],
    airs: Sequence[CavityAir],
) -> tuple[Finding, ...]:
    """All of them. basis : in vacuo."""
    return (
        _what_it_did(basis, coupled, placed, airs),
        *_few(basis, placed, airs),
        *_wools(basis, placed),
    )


def _what_it_did(
    basis: ModalBasis, coupled: ModalBasis, placed: Sequence[PlacedCavity], airs: Sequence[CavityAir]
) -> Finding:
    added = sum((air.compression[:, : len(basis.omega)] ** 2).sum(axis=0) for air in airs)[basis.modes]
    share = np.divide(added, added + basis.omega[basis.modes] ** 2, out=np.zeros_like(added), where=added > 0)
    stiffened = int(share.argmax())
    # mass-normalised with the air: what a mode has of the motion of the other
    partner = int(_shared(basis.shapes[:, :, stiffened], coupled.shapes[:, :, coupled.modes]).argmax())
    before, after = float(basis.frequency_hz[stiffened]), float(coupled.frequency_hz[partner])
    n = sum(len(air.frequency_hz) for air in airs)
    lowest = min(air.complete_below_hz for air in airs)
    woolly = any(one.cavity.wool is not None for one in placed)
    also = ". With wool they are damped together: damping ratios of single modes do not say how they decay"
    return Finding(
        "cavity-coupling",
        f"The air of {len(placed)} {'cavity' if len(placed) == 1 else 'cavities'} reacts on the structure with {n} "
        f"{'mode' if n == 1 else 'modes'} of its own below {lowest:.4g} Hz; its higher modes add mass. It changes mode "
        f"{stiffened + 1} of the structure most: {before:.2f} Hz without the air, {after:.2f} Hz with it, where it is "
        f"mode {partner + 1}. Mode numbers and frequencies are those with the air{also if woolly else ''}",
        {
            "in_vacuo_hz": before,
            "coupled_hz": after,
            "in_vacuo_mode": stiffened + 1.0,
            "coupled_mode": partner + 1.0,
            "cavity_modes": float(n),
            "cavity_modes_up_to_hz": lowest,
        },
    )


def _shared(shape: Floats, shapes: Floats) -> Floats:
    """How much of every shape [k] lies along one: modes of the air hardly move the structure."""
    alike: Floats = (shape[:, :3].ravel() @ shapes[:, :3].reshape(-1, shapes.shape[2])) ** 2
    return alike


def _few(basis: ModalBasis, placed: Sequence[PlacedCavity], airs: Sequence[CavityAir]) -> tuple[Finding, ...]:
    """The cavity whose modes end lowest, of what the motions of the structure need."""
    top = basis.complete_below_hz
    if not 0 < top < np.inf:
        return ()
    shares = [air.complete_below_hz / one.cavity.kept_hz(top) for one, air in zip(placed, airs, strict=True)]
    worst = int(np.argmin(shares))
    if shares[worst] >= FEW:
        return ()
    one, kept = placed[worst], airs[worst].complete_below_hz
    needed, good = one.cavity.kept_hz(top), _good_up_to(one, kept, top)
    return (
        Finding(
            "cavity-modes-few",
            f"Modes of the air of {one.name} are kept up to {kept:.4g} Hz; motions up to {top:.4g} Hz, the last mode "
            f"of the structure, need {needed:.4g} Hz. Above {good:.4g} Hz the air follows too fast",
            {"kept_hz": kept, "needed_hz": needed, "top_hz": top, "good_up_to_hz": good, "least_share": FEW},
        ),
    )


def _good_up_to(one: PlacedCavity, kept: float, top: float) -> float:
    """Highest frequency for which modes up to `kept` are enough [Hz]."""
    tried = top * np.linspace(0.0, 1.0, 201)[1:]
    enough = np.array([one.cavity.kept_hz(float(hz)) <= kept for hz in tried])
    return float(tried[enough].max(initial=0.0))


def _wools(basis: ModalBasis, placed: Sequence[PlacedCavity]) -> tuple[Finding, ...]:
    told: dict[tuple[str, Wool], Finding] = {}
    for one in placed:
        wool = one.cavity.wool
        if wool is None:
            continue
        sigma = wool.flow_resistivity
        if not LEAST <= sigma <= MOST:
            told.setdefault(
                ("range", wool),
                Finding(
                    "wool-out-of-range",
                    f"Wool of {sigma / 1000:.4g} kPa*s/m^2 in {one.name}: its model was compared between "
                    f"{LEAST / 1000:g} and {MOST / 1000:g} kPa*s/m^2 only",
                    {"flow_resistivity": sigma, "least": LEAST, "most": MOST},
                ),
            )
    held = [one for one in placed if one.cavity.wool is not None and one.cavity.wool.frame == "held"]
    if held and basis.total_mass > 0:
        drag = sum(
            one.cavity.layers[0].box.volume * one.cavity.wool.flow_resistivity
            for one in held
            if one.cavity.wool is not None
        )
        rate = drag / basis.total_mass
        if rate > HELD:
            told[("held", Wool(1.0))] = Finding(
                "held-wool",
                f"Wool held at rest is a dashpot to the ground: it damps the common movement of both surfaces of "
                f"{held[0].name} with up to {rate:.3g} 1/s, which loose wool does not",
                {"rate_1_s": rate, "allowed_1_s": HELD},
            )
    return tuple(told.values())
