"""Stiff plates that move as pistons in several walls of one box: heard, pushed back by its air, and what each gives it.

A case's model has a "study" and its "structure", with the corner of the room that the plates stand around; `pistons_of`
and `box_of` read both again.
"""

from __future__ import annotations

from math import pi
from typing import Any, Final

import numpy as np

from tests.independent import levels
from tests.independent.box_pistons import AXES, Piston, PistonsBox
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.pistons import losses_near, lost_in
from tests.machine.rooms import between, even, lines_of, parts_of, responses, rounded

Draft = dict[str, Any]
WALLS: Final = tuple(AXES)
THICK: Final = 0.05
STIFFER: Final = 3e8  # modulus [Pa] per stiffness of the hardest spring [N/m]: with 1e12 a mode is lost in rounding
_ALONG: Final[dict[str, Draft]] = {  # of a wall, by its axis: local axes are the two others in the order x, y, z
    "x": {"normal": [1, 0, 0], "x_direction": [0, 1, 0]},
    "y": {"normal": [0, -1, 0], "x_direction": [1, 0, 0]},
    "z": {},
}
_FACING: Final = {"floor": "above", "ceiling": "below", "x0": "x", "x1": "-x", "y0": "y", "y1": "-y"}
_WHY = "plates yield 4e-5 of their springs' motion near a force; cosines end at 1e-5 of the pressure; 12 x 12 cells"
_LEFT_OUT = "what damping couples is left out below 1e-3 of the motion of plates and air, several times that of a peak"
_KEPT = "with a leak all damping is kept; cells do not resolve 1e-4 of the mass of the air before a plate, over losses"


def axis_of(name: str) -> str:
    """The direction in which a piston of that wall moves."""
    return "xyz"[AXES[name]]


def _plate(rng: np.random.Generator, structure: Draft, wall: str, size: list[float], hz: float, rho: float) -> None:
    """A piston in a wall, named as it, on a spring at its middle; its force at "of WALL"."""
    axis = AXES[wall]
    along = [one for one in range(3) if one != axis]
    sides = [rounded(size[one] * float(rng.uniform(0.3, 0.8))) for one in along]
    low = [rounded((size[one] - side) * float(rng.uniform(0.05, 0.95))) for one, side in zip(along, sides, strict=True)]
    corner = [0.0, 0.0, 0.0]
    corner[axis] = 0.0 if wall in ("x0", "y0", "floor") else size[axis]
    for one, start in zip(along, low, strict=True):
        corner[one] = start
    way = "xyz"[axis]
    spring = rounded(rho * sides[0] * sides[1] * THICK * (2 * pi * hz) ** 2)
    structure["materials"][f"m {wall}"] = {"E": 0.0, "nu": 0.3, "rho": rho}
    structure["parts"][wall] = {
        "type": "plate", "material": f"m {wall}", "thickness": THICK, "size": sides, "mesh": [12, 12],
        "origin": [round(a + b, 9) for a, b in zip(structure["corner"], corner, strict=True)], **_ALONG[way],
    }  # fmt: skip
    structure["points"][f"of {wall}"] = {"on": wall, "at": [side / 2 for side in sides]}
    structure["parts"][f"spring {wall}"] = {
        "type": "spring", "between": [f"of {wall}", "ground"], "stiffness": {way: spring},
    }  # fmt: skip
    structure["surfaces"][f"in {wall}"] = {"on": wall, "side": _FACING[wall]}
    held = [one for one in "xyz" if one != way]
    structure["supports"][f"edges {wall}"] = {"on": wall, "edge": "all", "fix": [*held, *(f"r{one}" for one in held)]}


def chosen_walls(rng: np.random.Generator, ceiling: bool) -> list[str]:
    """Two or three, opposite ones or such that meet, in the order in which a file has them: the first places the room.

    ceiling : it is one of them, as of a room of cells, which others do not place.
    """
    found = [str(one) for one in rng.choice(WALLS, int(rng.integers(2, 4)), replace=False)]
    return sorted({"ceiling", *found[1:]} if ceiling and "ceiling" not in found else found)


def scene(
    rng: np.random.Generator, own: tuple[float, float], heavy: tuple[float, float], ceiling: bool = False
) -> Draft:
    """Pistons in walls of a room, with their own frequencies as shares of the first mode of the room."""
    size = [even(rng, 2.0, 4.0), even(rng, 2.0, 4.0), even(rng, 1.5, 3.0)]
    air = {"c": even(rng, 320, 360), "rho": even(rng, 1.0, 1.4)}
    first, walls, ratio = air["c"] / 2 / max(size), chosen_walls(rng, ceiling), even(rng, 0.02, 0.05)
    structure: Draft = {
        "corner": [even(rng, -3, 3) for _ in range(3)],
        **{key: {} for key in ("materials", "parts", "points", "surfaces", "supports")},
        "damping": {"ratio": ratio} if rng.random() < 0.5 else {"loss_factor": 2 * ratio},
    }
    for wall in walls:
        _plate(rng, structure, wall, size, rounded(first * float(rng.uniform(*own))), between(rng, *heavy))
    parts, materials = structure["parts"], structure["materials"]
    hardest = max(max(one["stiffness"].values()) for one in parts.values() if one["type"] == "spring")
    structure["materials"] = {name: {**one, "E": rounded(STIFFER * hardest)} for name, one in materials.items()}
    placing = walls[0]
    along = [one for one in range(3) if one != AXES[placing]]
    middle = [
        round(parts[placing]["origin"][one] - structure["corner"][one] + side / 2, 9)
        for one, side in zip(along, parts[placing]["size"], strict=True)
    ]
    room: Draft = {
        "size": size, "air": air, "losses": losses_near(rng, first), "at": middle,
        "surfaces": {wall: f"in {wall}" for wall in walls},
        "receivers": {"mic": [rounded(side * float(rng.uniform(0.1, 0.9))) for side in size]},
    }  # fmt: skip
    if placing == "ceiling" and rng.random() < 0.5:
        room["under"] = room["surfaces"].pop("ceiling")
    if "t60" not in room["losses"]:
        room["form"] = str(rng.choice(["causal", "source"]))
    study = {"modes": {"up_to": rounded(12 * first)}, "rooms": {"room": room}}
    return {"study": study, "structure": structure, "walls": walls, "first": first}


def with_response(rng: np.random.Generator, model: Draft) -> Draft:
    """Of a force on one of the pistons: the sound, or by a source in the room the motion."""
    walls, first = model["walls"], model["first"]
    struck = str(rng.choice(walls))
    spot = f"of {struck}.{axis_of(struck)}"
    heard = {"drive": spot, "response": "room.mic.pressure", "kind": "pressure"}
    if rng.random() < 0.3:
        heard = {"drive": "room.mic.volume_velocity", "response": spot, "kind": "mobility"}
    low, high = rounded(0.2 * first), rounded(2.0 * first)
    model["study"]["frf"] = {"f": {**heard, "band": [low, high], "step": rounded(high / 60)}}
    return model


def with_lever(rng: np.random.Generator, model: Draft) -> Draft:
    """Two of the pistons move together, the one a share of the other."""
    one, other = model["walls"][:2]
    share = rounded(float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.4, 2.5)))
    lever = {f"of {one}.{axis_of(one)}": 1.0, f"of {other}.{axis_of(other)}": share}
    model["structure"]["constraints"] = {"lever": {"equation": lever}}
    return model


# ---- read again


def pistons_of(model: Model) -> list[Piston]:
    structure, found = model["structure"], []
    for wall in model["walls"]:
        part = structure["parts"][wall]
        low = np.subtract(part["origin"], structure["corner"])
        along = [axis for axis in range(3) if axis != AXES[wall]]
        found.append(Piston(wall, (float(low[along[0]]), float(low[along[1]])), tuple(part["size"])))
    return found


def box_of(model: Model, orders: int = 60) -> PistonsBox:
    stated = model["study"]["rooms"]["room"]
    return PistonsBox(tuple(stated["size"]), **stated["air"], **lost_in(stated), orders=orders)


def together(model: Model) -> tuple[Floats, Floats, Floats]:
    """Motions of all pistons along their axes per coordinate [n, k]; masses and stiffnesses of the coordinates [k]."""
    structure, walls = model["structure"], model["walls"]
    masses, springs = [], []
    for wall in walls:
        part = structure["parts"][wall]
        masses.append(structure["materials"][f"m {wall}"]["rho"] * THICK * part["size"][0] * part["size"][1])
        springs.append(structure["parts"][f"spring {wall}"]["stiffness"][axis_of(wall)])
    joined = np.eye(len(walls))
    if "constraints" in structure:
        factors = structure["constraints"]["lever"]["equation"]
        one, other = (factors[f"of {wall}.{axis_of(wall)}"] for wall in walls[:2])
        joined = np.delete(joined, 0, axis=1)
        joined[0, 0] = -other / one
    of_each = joined**2  # a motion has one coordinate, so that these stay apart
    return joined, of_each.T @ masses, of_each.T @ springs


def _let_out(model: Model, s: Floats, air: Floats) -> Floats:
    """What velocity the flow through an opening, spread over all pistons, takes from each, per velocity of each
    [nf, n]: their mean pressure drives it. air : forces on each per velocity of each."""
    leak, area = model["study"]["rooms"]["room"].get("leak"), sum(one.area for one in pistons_of(model))
    if leak is None:
        return np.zeros(air.shape[:2])
    opening = s * leak["inertance"] + leak["resistance"]
    return np.asarray(air.sum(axis=1) / (area**2 * opening + air.sum(axis=(1, 2)))[:, None])


def motions(model: Model, s: Floats, forces: Floats) -> Floats:
    """Velocities [nf, n] of all pistons along their axes under forces along these [nf, n]."""
    joined, masses, springs = together(model)
    damping, own = model["structure"]["damping"], np.sqrt(springs / masses)
    lost = np.outer(s, 2 * damping.get("ratio", 0.0) * own * masses) + 1j * damping.get("loss_factor", 0.0) * springs
    D = np.einsum("fk,kl->fkl", np.outer(s * s, masses) + springs + lost, np.eye(len(masses)))
    if model["study"]["rooms"]["room"].get("coupling") == "two-way":
        pistons = pistons_of(model)
        turned = np.array([one.inward for one in pistons])[:, None] * joined
        air = box_of(model).between(s, pistons)
        air = air - air.sum(axis=2)[..., None] * _let_out(model, s, air)[:, None]
        D = D + s[:, None, None] * (turned.T @ air @ turned)
    moved = np.linalg.solve(D, (forces @ joined)[..., None])[..., 0]
    return np.asarray(s[:, None] * (moved @ joined.T))


def _right(model: Model, _: Door) -> Floats:
    asked, pistons = model["study"]["frf"]["f"], pistons_of(model)
    s = 2j * pi * lines_of(model)
    backwards = "volume_velocity" in asked["drive"]
    struck = asked["response" if backwards else "drive"][3:-2]
    forces = np.zeros((len(s), len(pistons)), complex)
    forces[:, model["walls"].index(struck)] = 1.0
    v = motions(model, s, forces) * [one.inward for one in pistons]
    room, box = model["study"]["rooms"]["room"], box_of(model)
    if "leak" in room:
        v = v - (_let_out(model, s, box.between(s, pistons)) * v).sum(axis=1)[:, None]
    found = np.einsum("nf,fn->f", box.at(s, pistons, room["receivers"]["mic"]), v)
    return parts_of(-found if backwards else found)


def written(model: Model) -> Draft:
    """The structure without what is only for the reference."""
    structure = {key: one for key, one in model["structure"].items() if key != "corner"}
    return {"study": model["study"], "structure": structure}


def _asked(model: Model, door: Door) -> Floats:
    return stiff_told(door, parts_of(responses(written(model), door)))


def stiff_told(door: Door, found: Floats) -> Floats:
    """What was found, without what is said of plates that are to be stiff."""
    door.told[:] = [one for one in door.told if not one.startswith(("implausible-material", "thick-plate"))]
    return found


# ---- sound per force


@capability("rooms: pistons in several walls", "independent")
def _(rng: np.random.Generator) -> Case:
    """Each hears none of the others; two may be joined by a lever."""
    model = with_response(rng, scene(rng, (0.7, 1.3), (500, 5000)))
    return Case(with_lever(rng, model) if rng.random() < 0.7 else model, _asked, _right, 3e-4, _WHY)


@capability("rooms: pistons in several walls push each other by the air", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = with_response(rng, scene(rng, (0.2, 0.6), (60, 500)))
    room = model["study"]["rooms"]["room"]
    room["coupling"] = "two-way"
    if rng.random() < 0.4:
        return Case(model, _asked, _right, 5e-3, _LEFT_OUT)
    inertance = room["air"]["rho"] * (room["air"]["c"] / (pi * model["first"])) ** 2 / float(np.prod(room["size"]))
    resistance = inertance * model["first"] * float(rng.uniform(0.1, 1.0))
    room["leak"] = {"inertance": rounded(inertance * float(rng.uniform(1, 4))), "resistance": rounded(resistance)}
    return Case(model, _asked, _right, 5e-3, _KEPT)


# ---- a push: what is heard in time, and the energy that each gives the air

_RATE: Final = 12800.0  # Hz
_HIGHEST: Final = 2500.0  # Hz, towards which the transform of the reference fades
_THIRDS: Final = (16, 20, 25, 31.5, 40, 50, 63, 80, 100, 125)
_IN_TIME = "the push begins and ends with a kink, which 13 samples of a millisecond round: 1e-3 of the sound there"
_ENERGY = "lines of a record in a band, parted at its edges: 2e-3 of a third; motion at the end of a record: 1e-3 of it"


def pushed(rng: np.random.Generator, both: bool, ceiling: bool = False) -> Draft:
    """A half sine on one of the pistons, quiet again within the record; two on a lever, or all by the air."""
    model = scene(rng, (0.5, 0.9), (60, 500) if both else (500, 5000), ceiling)
    structure, room, first = model["structure"], model["study"]["rooms"]["room"], model["first"]
    structure["damping"] = {"ratio": even(rng, 0.05, 0.09)}
    room.pop("form", None)
    ratio, at = even(rng, 0.03, 0.06), rounded(first * float(rng.uniform(0.6, 1.2)))
    room["losses"] = {"t60": even(rng, 0.2, 0.35)} if rng.random() < 0.7 else {"beta": ratio, "at": at}
    room["receivers"]["mic"] = [rounded(side * float(rng.uniform(0.2, 0.8))) for side in room["size"]]
    if both:
        room["coupling"] = "two-way"
    else:
        with_lever(rng, model)
    struck = model["walls"][int(rng.integers(2))]
    push = {"amplitude": between(rng, 1, 1000), "frequency": even(rng, 30, 60)}
    model["study"]["loads"] = {"push": {"at": f"of {struck}.{axis_of(struck)}", "half_sine": push,
                                        "first": even(rng, 0.001, 0.02)}}  # fmt: skip
    model["study"]["modes"]["up_to"] = 1000.0 if not both else rounded(12 * first)
    model["study"]["time"] = {"duration": 1.4, "sampling": _RATE}
    return model


def push_of(model: Model, s: Floats) -> Floats:
    """Transform of the forces on all pistons [nf, n]."""
    load = model["study"]["loads"]["push"]
    own, half = 2 * pi * load["half_sine"]["frequency"], 0.5 / load["half_sine"]["frequency"]
    force = load["half_sine"]["amplitude"] * own * (1 + np.exp(-s * half)) / (s * s + own * own)
    found = np.zeros((len(s), len(model["walls"])), complex)
    found[:, model["walls"].index(load["at"][3:-2])] = force * np.exp(-s * load["first"])
    return found


def into(model: Model, s: Floats) -> Floats:
    """Transform of the velocities into the room [n, nf]."""
    return np.asarray((motions(model, s, push_of(model, s)) * [one.inward for one in pistons_of(model)]).T)


def _history(model: Model, _: Door) -> Floats:
    """The pressure at the microphone, along a line that is damped to 1e-6 at the end of twice the record."""
    count = round(model["study"]["time"]["duration"] * _RATE)
    n, less = 2 * count, np.log(1e6) * _RATE / (2 * count)
    s = less + 2j * pi * np.fft.rfftfreq(n, 1 / _RATE)
    some = s[s.imag < 2 * pi * _HIGHEST]
    place = model["study"]["rooms"]["room"]["receivers"]["mic"]
    spectrum = np.zeros(len(s), complex)
    heard = box_of(model, 24).at(some, pistons_of(model), place)
    spectrum[: len(some)] = np.einsum("nf,nf->f", heard, into(model, some))
    spectrum *= (1 + np.cos(pi * np.clip(2.5 * s.imag / (2 * pi * _HIGHEST) - 1.5, 0, 1))) / 2
    t = np.arange(count) / _RATE
    return np.asarray(_RATE * np.fft.irfft(spectrum, n)[:count] * np.exp(less * t))


@capability("rooms: sound in time of pistons in several walls", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    def asked(model: Model, door: Door) -> Floats:
        said = written(model)
        found = door.histories({"model": "s.yaml", **said["study"]}, s=said["structure"])
        return stiff_told(door, np.asarray(found["room.mic pressure"]))

    return Case(pushed(rng, False), asked, _history, 3e-3, _IN_TIME)


def bands_of(model: Model) -> list[float]:
    """Where there is sound enough, and modes."""
    hz = np.sqrt(together(model)[2] / together(model)[1]) / (2 * pi)
    return [band for band in _THIRDS if 0.6 * hz.min() < band < 1.4 * model["first"]]


def shares_of(model: Model) -> dict[str, Floats]:
    """By band: the energy that each piston gives the air, squares of sound of each alone, and of all."""
    pistons, box, place = pistons_of(model), box_of(model), model["study"]["rooms"]["room"]["receivers"]["mic"]
    found: dict[str, list[Floats]] = {"energy": [], "alone": [], "together": []}
    for band in bands_of(model):
        low, high = (levels.exact(band) * 10**way for way in (-0.05, 0.05))
        node, share = np.polynomial.legendre.leggauss(60)
        s, df = 2j * pi * (low + (node + 1) / 2 * (high - low)), share / 2 * (high - low)
        v = into(model, s)
        force = np.einsum("fij,jf->if", box.between(s, pistons), v)
        p = box.at(s, pistons, place) * v
        found["energy"].append(2 * (force * v.conj()).real @ df)
        found["alone"].append(2 * np.abs(p) ** 2 @ df)
        found["together"].append(2 * np.abs(p.sum(axis=0)) ** 2 @ df)
    return {name: np.array(one) for name, one in found.items()}


def _energies(model: Model, door: Door) -> Floats:
    """Over what is right of a band: energies over the sum of their sizes, squares of sound over the loudest."""
    said = written(model)
    answer = door.ask({"model": "s.yaml", **said["study"]}, "run", "--no-pictures", s=said["structure"])
    door.told[:] = []  # of the sound, whatever it is
    found, right, rows = answer["cases"]["as given"]["by_surface"]["room"], shares_of(model), []
    for at, band in enumerate(bands_of(model)):
        key = f"{band:g}"
        each = [found["surfaces"][f"in {wall}"] for wall in model["walls"]]
        alone = [0.0 if one["alone_db"][key] is None else one["alone_db"][key] for one in each]
        squares = levels.P0**2 * 10 ** (np.array([*alone, found["together_db"][key]]) / 10)
        energy = np.array([*(one["energy_j"][key] for one in each), found["total_j"][key]])
        rows += [*energy / np.abs(right["energy"][at]).sum(), *squares / right["alone"][at].max()]
    return np.array(rows)


def _shares(model: Model, _: Door) -> Floats:
    right, rows = shares_of(model), []
    for energy, alone, whole in zip(right["energy"], right["alone"], right["together"], strict=True):
        rows += [*energy / np.abs(energy).sum(), energy.sum() / np.abs(energy).sum()]
        rows += [*alone / alone.max(), whole / alone.max()]
    return np.array(rows)


@capability("rooms: energy that each of several walls gives the air", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Two on a lever, and one that stands still; or all by the air, of which one is pushed."""
    model = pushed(rng, bool(rng.random() < 0.5))
    model["study"]["modes"]["up_to"] = rounded(8 * model["first"])
    model["study"]["time"] = {"duration": 1.2, "sampling": 3000.0}
    return Case(model, _energies, _shares, 0.01, _ENERGY)
