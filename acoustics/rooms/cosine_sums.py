"""The sound at many places, kept as few histories of cosines until the end: one product of matrices a height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acoustics.arrays import Floats, Integers
from acoustics.rooms.cosine_orders import SEEN


@dataclass(frozen=True, eq=False)
class Plane:
    """The sound at the receivers of one height so far: histories [n_here, nt], those of cosines not yet mixed.

    rows : which of all receivers. places : theirs [n_here, 3] [m]. own : a part of their sound, None for nothing.
    mixes, histories : the other parts, each mix [n_here, n] times histories [n, nt] of cosines. Where cosines are
        fewer than listeners they are mixed only once, at the end: a thousand histories are too much to be added up
        again and again.
    """

    rows: Integers
    places: Floats
    own: Floats | None = None
    mixes: tuple[Floats, ...] = ()
    histories: tuple[Floats, ...] = ()


Heard = tuple[Plane, ...]  # at all heights, from the lowest


def silence(places: Floats) -> Heard:
    """Receivers at places [n, 3] [m] by their heights, without sound yet."""
    heights, plane = np.unique(places[:, 2], return_inverse=True)
    rows = [np.flatnonzero(plane == number) for number in range(len(heights))]
    return tuple(Plane(here, places[here]) for here in rows)


def added(plane: Plane, mix: Floats | None, history: Floats) -> Plane:
    """With histories [n, nt] of cosines, mixed by mix [n_here, n]; of the listeners themselves where it is None."""
    if mix is None:
        own = history if plane.own is None else plane.own + history
        return Plane(plane.rows, plane.places, own, plane.mixes, plane.histories)
    return Plane(plane.rows, plane.places, plane.own, (*plane.mixes, mix), (*plane.histories, history))


def energies(heard: Heard) -> Floats:
    """Energy at every listener [n], sums of squares."""
    energy = np.zeros(sum(len(plane.rows) for plane in heard))
    for plane in heard:
        if plane.own is None and plane.mixes:
            energy[plane.rows] = energy_of(np.hstack(plane.mixes), np.vstack(plane.histories))
        elif plane.own is not None:
            energy[plane.rows] = energy_of(None, _mixed(plane, plane.own.shape[1]))
    return energy


def pressure_of(heard: Heard, nt: int) -> Floats:
    """Pressure at every listener [n, nt], read-only."""
    wholes = [_mixed(plane, nt) for plane in heard]
    p = wholes[0]
    if len(wholes) > 1:
        p = np.empty((sum(map(len, wholes)), nt))
        for plane, whole in zip(heard, wholes, strict=True):
            p[plane.rows] = whole
    p.flags.writeable = False
    return p


def _mixed(plane: Plane, nt: int) -> Floats:
    if not plane.mixes:
        return np.zeros((len(plane.rows), nt)) if plane.own is None else plane.own
    mixed: Floats = np.hstack(plane.mixes) @ np.vstack(plane.histories)
    if plane.own is not None:
        mixed += plane.own
    return mixed


def energy_of(mix: Floats | None, history: Floats) -> Floats:
    """Sums of squares [n_here] of mix @ history, by the products of the histories; of histories where mix is None.

    From about 16,000 samples at least, which tell well enough.
    """
    every = max(1, history.shape[1] // SEEN)
    history = history[:, ::every]
    if mix is None:
        return np.asarray(every * np.einsum("rt,rt->r", history, history))
    mix = mix * np.sqrt(every)
    energy: Floats = np.einsum("rn,rn->r", mix @ (history @ history.T), mix)
    return energy.clip(0.0)
