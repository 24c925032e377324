"""Random impact systems, what must be true of every run of them, and the same equations for scipy.

Drawn from a seed by numpy alone, so that a number names a system for good: 1 to 6 modes, rigid and elastic, damped and
not; 1 to 3 bodies with mass ratios to 1e6; 1 to 3 contacts with stiffness ratios to 1e8 and gaps to 1 mm, with
dashpots, preloads and grazing speeds; one-way links, some released late; gravity at times.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from femstruct.compiled.records import CONSTANT, LINK
from femstruct.impact.response import Outcome, Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Link, Scene
from femstruct.impact.simulate import simulate
from femstruct.impact.system import compile_scene
from femstruct.laws.hertz import CODE, Hertz
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.registry import CODES
from femstruct.laws.stop import Stop
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes

OPEN_LEDGER = 1e-8  # a ledger that is open by more must be a finding
WINDOW, SAMPLES = 5e-3, 200
RADIANS = 2000.0  # the fastest contact, link or mode turns by this much in the window at most: a run is then short
SHALLOW, WEAK = 1e-14, 1e-9  # depth [m] and share of its spring's and dashpot's forces that scipy does not resolve
G = 9.80665
HERTZ = CODES.index(CODE)


@dataclass(frozen=True)
class Drawn:
    """A system and how long it runs."""

    basis: ModalBasis
    scene: Scene
    clock: Clock

    def run(self) -> Response:
        return simulate(self.basis, self.scene, self.clock)

    def nudged(self, by: float) -> Drawn:
        """The same with all start velocities and gaps a little larger: chaos shows."""
        scene = self.scene
        moved = replace(
            scene,
            bodies=tuple(replace(body, velocity=body.velocity * (1 + by) + by * 1e-3) for body in scene.bodies),
            contacts=tuple(replace(contact, gap=contact.gap * (1 + by)) for contact in scene.contacts),
            velocity=None if scene.velocity is None else np.asarray(scene.velocity) * (1 + by),
        )
        return replace(self, scene=moved)

    @property
    def pace(self) -> float:
        """Radians that the fastest contact, link or mode turns in the window: what an integrator has to resolve."""
        system = compile_scene(self.basis, self.scene, self.clock).system
        fastest = max(float(system.omega.max(initial=0.0)), 1.0)
        for a, law in enumerate(system.interfaces):
            stiffness = law["stiffness"] * (1e-2 if law["kind"] == HERTZ else 1.0)  # 0.1 mm deep
            fastest = max(fastest, float(np.sqrt(stiffness * system.mobility[a])))
            fastest = max(fastest, float(max(law["closing"], law["opening"]) * system.mobility[a]))
        return fastest * self.clock.duration


def draw(seed: int) -> Drawn:
    """The system of a number."""
    rng = np.random.default_rng(seed)
    n, n_bodies = int(rng.integers(1, 7)), int(rng.integers(1, 4))
    f = np.sort(10 ** rng.uniform(0, 4, n))
    if rng.random() < 0.3:
        f[: rng.integers(1, n + 1)] = 0.0
    ratio = rng.choice([0.0, 0.01, 0.1, 1.0, 2.0], n)
    basis, points = given_modes(
        list(f), [float(z) if hz else 0.0 for z, hz in zip(ratio, f, strict=True)],
        {"p": list(rng.uniform(-2, 2, n)), "r": list(rng.uniform(-2, 2, n))},
    )  # fmt: skip
    heavy = 10 ** rng.uniform(-4, 2)
    bodies = tuple(
        Body(
            f"b{i}",
            float(np.clip(heavy * 10 ** rng.uniform(-6, 6), 1e-4, 1e2)),
            float(rng.choice([0.0, -1.0, 1.0, 1e-3, -1e-3, 10.0, 1e-7]) * rng.uniform(0.5, 2.0)),
            falls=bool(rng.random() < 0.3),
        )
        for i in range(n_bodies)
    )
    places = [points["p"].probe("z"), points["r"].probe("z"), *(body.name for body in bodies), GROUND]
    contacts, links = [], []
    stiff = 10 ** rng.uniform(1, 9)
    for i in range(rng.integers(1, 4)):
        a, b = rng.choice(len(places), 2, replace=False)
        k = float(np.clip(stiff * 10 ** rng.uniform(-8, 8), 1e1, 1e9))
        c = float(rng.choice([0.0, 10 ** rng.uniform(-1, 3)]))
        tensile = bool(rng.random() < 0.3)
        law: Law = [Hertz(100 * k, c, tensile), Linear(k, c, tensile), Stop(k, c, tensile)][rng.integers(0, 3)]
        gap = float(rng.choice([0.0, 1e-3 * rng.uniform(), 10 ** rng.uniform(-9, -3)]))
        preload = 0.0
        if gap == 0.0 and not isinstance(law, Stop) and rng.random() < 0.3:
            preload = float(10 ** rng.uniform(-1, 2))
        contacts.append(Contact(f"c{i}", places[a], places[b], law, gap, preload))
    for i in range(rng.integers(0, 3)):
        a, b = rng.choice(len(places), 2, replace=False)
        links.append(
            Link(
                f"l{i}", places[a], places[b], float(10 ** rng.uniform(0, 6)), float(rng.choice([0.0, 5.0])),
                float(rng.choice([0.0, 50.0])), float(rng.choice([0.0, 1e-3])), float(rng.choice([0.0, 3.0])),
            )
        )  # fmt: skip
    velocity = rng.choice([0.0, 1.0], n) * rng.uniform(-1, 1, n)
    gravity = G if rng.random() < 0.5 else 0.0
    drawn = Drawn(basis, Scene(bodies, tuple(contacts), tuple(links), (), velocity, gravity), Clock(WINDOW, 40e3))
    window = min(WINDOW, WINDOW * RADIANS / drawn.pace)
    return replace(drawn, clock=Clock(window, SAMPLES / window))


def contradictions(response: Response) -> list[str]:
    """What cannot be true of a run, in words; empty for a sound one."""
    wrong = []
    arrays = [response.q, response.qd, response.qdd, response.ledger.structure, response.ledger.dissipated]
    arrays += [getattr(body, what) for body in response.bodies.values() for what in ("displacement", "velocity")]
    arrays += [getattr(contact, what) for contact in response.contacts.values() for what in ("force", "indentation")]
    if not all(np.isfinite(array).all() for array in arrays):
        wrong.append("a number that is not one")
    residual = response.ledger.residual
    if not residual <= OPEN_LEDGER and "energy-drift" not in {finding.code for finding in response.findings}:
        wrong.append(f"a ledger open by {residual:.1e} that nobody reports")
    times = [event.t for event in response.events]
    if times != sorted(times) or any(not 0.0 <= t <= response.clock.duration for t in times):
        wrong.append("events out of order, or outside the window")
    closed = []
    for contact in response.scene.contacts:
        history = response.contacts[contact.name]
        mine = [event.what for event in response.events if event.contact == contact.name]
        if not isinstance(contact.law, Stop) and mine != ["closes", "opens"] * (len(mine) // 2) + mine[-1:] * (
            len(mine) % 2
        ):
            wrong.append(f"{contact.name} does not close and open in turn")
        if history.closings != mine.count("closes"):
            wrong.append(f"{contact.name} counts {history.closings} closings and logs {mine.count('closes')}")
        closed.append(mine.count("closes") > mine.count("opens"))
        wrong += _forces(contact, response)
    held = any(contact.preload > 0.0 for contact in response.scene.contacts)
    untouched = Outcome.HELD if held else Outcome.NEVER_TOUCHED
    outcome = Outcome.CLOSED_AT_END if any(closed) else Outcome.SEPARATED if times else untouched
    at_rest = Outcome.RESTING if response.scene.gravity > 0.0 else Outcome.HELD
    rests = response.outcome is at_rest and outcome is Outcome.CLOSED_AT_END and (held or response.scene.gravity > 0.0)
    together = response.outcome is Outcome.TOGETHER and all(
        _holds(contact, response) or contact.preload > 0.0
        for contact, shut in zip(response.scene.contacts, closed, strict=True) if shut
    )  # fmt: skip
    if response.outcome is not outcome and not rests and not together:
        wrong.append(f"the outcome is {response.outcome.name}, the events say {outcome.name}")
    return wrong


def _holds(contact: Contact, response: Response) -> bool:
    """Whether a contact that pulls creeps together: c^2 >= 4 k m of the bodies it joins, without a way back out."""
    masses = [body.mass for body in response.scene.bodies if body.name in (contact.upper, contact.lower)]
    joined = 1.0 / sum(1.0 / mass for mass in masses) if masses else 0.0
    law = contact.law
    return law.tensile and isinstance(law, Linear) and law.damping**2 >= 4.0 * law.stiffness * joined > 0.0


def _forces(contact: Contact, response: Response) -> list[str]:
    """Force where there is indentation and only there, of the right size, below the peak."""
    law, history = contact.law, response.contacts[contact.name]
    wrong = []
    depth = history.indentation
    power = 1.5 if isinstance(law, Hertz) else 1.0
    spring = law.stiffness * np.maximum(depth, 0.0) ** power
    touching = depth > 1e-12 + 1e-9 * np.abs(depth).max()
    size = np.abs(history.force)
    if law.damping == 0.0 and (
        np.abs(size - spring)[touching].max(initial=0.0) > 1e-6 * spring.max(initial=0.0) + 1e-300
    ):
        wrong.append(f"{contact.name} is indented without its force")
    if (history.force[depth < -1e-15] != 0).any():
        wrong.append(f"{contact.name} pushes while it is open")
    pulls = history.force < -1e-9 * size.max(initial=0.0)
    if not law.tensile and not isinstance(law, Stop) and pulls.any():
        wrong.append(f"{contact.name} pulls")
    # of a tensile stop the pulls of one side look like pushes of the other
    glued = isinstance(law, Stop) and law.tensile
    if not glued and history.peak_force < (size if isinstance(law, Stop) else history.force).max() * (1 - 1e-6):
        wrong.append(f"{contact.name} has a sample above its peak force")
    if touching.any() and not contact.preload and not history.closings:
        wrong.append(f"{contact.name} is indented and never closed")
    return wrong


@njit(error_model="numpy")  # not cached: a file that runpy runs has no module to load it from
def _rate(t, y, omega2, damping, rows, kinds, numbers, rests, fields):  # type: ignore[no-untyped-def]
    """The right-hand side, written anew: numbers [m, 7] = stiffness, closing, opening, offset, preload, tensile,
    release; fields [n] : constant accelerations."""
    n = len(omega2)
    out = np.empty(2 * n)
    for i in range(n):
        out[i] = y[n + i]
        out[n + i] = fields[i] - omega2[i] * y[i] - damping[i] * y[n + i]
    for a in range(len(kinds)):
        x, u = 0.0, 0.0
        for i in range(n):
            x += rows[a, i] * y[i]
            u += rows[a, i] * y[n + i]
        k, closing, opening, offset, preload, tensile, release = numbers[a]
        if kinds[a] == LINK:
            if t < release:
                continue
            force = k * (x - rests[a]) + (closing if u > 0 else opening) * u + preload
        else:
            delta = x + offset
            force = 0.0
            if delta > 0.0:
                root = np.sqrt(delta) if kinds[a] == HERTZ else 1.0
                force = root * (k * delta + closing * u)
                if tensile == 0.0 and force < 0.0:
                    force = 0.0
            force -= preload
        for i in range(n):
            out[n + i] -= rows[a, i] * force
    return out


def by_scipy(drawn: Drawn, steps: int) -> tuple[dict[str, float], dict[str, tuple[int, int]]]:
    """Velocities of the bodies at the last sample and the closings of the contacts, by DOP853.

    steps : in the window, at least, the first ones much shorter, for gaps that are zero. Closings are counted on the
    dense solution, 8 places a step: all, and those that are more than its rounding; the fewer, the more.
    """
    compiled = compile_scene(drawn.basis, drawn.scene, drawn.clock)
    system, n = compiled.system, len(compiled.system.omega)
    laws = system.interfaces
    m = len(laws)
    words = ("stiffness", "closing", "opening", "offset", "preload", "tensile", "release")
    numbers = np.array([[law[word] for word in words] for law in laws], dtype=np.float64).reshape(m, 7)
    numbers[:, 6] *= system.tick
    fields = np.zeros(n)
    for i, load in enumerate(system.loads):
        assert load["kind"] == CONSTANT
        fields += system.rows[m + i] * load["value"]
    rests = np.zeros(m)
    last = drawn.clock.duration
    state = np.concatenate(compiled.start)
    counts = np.zeros((2, m), dtype=np.int64)
    loaded = np.zeros((2, m), dtype=bool)
    stops = sorted({0.0, last, *(float(release) for release in numbers[:, 6] if 0.0 < release < last)})
    rows = np.ascontiguousarray(system.rows[:m])
    for begin, end in pairwise(stops):
        for a in range(m):
            if laws["kind"][a] == LINK and numbers[a, 6] == begin:
                rests[a] = rows[a] @ state[:n]
        acting = numbers.copy()  # the last stage of the last step is at the end: what begins there has not begun
        acting[:, 6] = np.where(numbers[:, 6] <= begin, 0.0, np.inf)
        args = (system.omega**2, system.damping, rows, laws["kind"].copy(), acting, rests, fields)
        part = solve_ivp(
            _rate, (begin, end), state, "DOP853", rtol=1e-11, atol=1e-15, max_step=last / steps, args=args,
            dense_output=True, first_step=1e-9 * (end - begin),
        )  # fmt: skip
        state = part.y[:, -1]
        times = np.concatenate([np.linspace(a, b, 8, endpoint=False) for a, b in pairwise(part.t)] + [part.t[-1:]])
        y = part.sol(times)
        for a in range(m):
            if laws["kind"][a] == LINK:
                continue
            k, c, _, offset, preload, tensile, _ = numbers[a]
            delta, speed = rows[a] @ y[:n] + offset, rows[a] @ y[n:]
            root = np.sqrt(np.maximum(delta, 0.0)) if laws["kind"][a] == HERTZ else 1.0
            for i, (depth, share) in enumerate(((0.0, 0.0), (SHALLOW, WEAK))):
                force = np.where(delta > depth, root * (k * delta + c * speed), 0.0)
                least = preload * (1 + 1e-9) + share * root * (k * np.abs(delta) + c * np.abs(speed))
                on = (force > least) if preload or not tensile else delta > depth
                counts[i, a] += int(on[0] and not loaded[i, a]) + int((on[1:] & ~on[:-1]).sum())
                loaded[i, a] = on[-1]
    velocity = part.sol((compiled.n_samples - 1) / drawn.clock.sampling)[n:] / compiled.scale
    ends = {body.name: float(velocity[system.n_modes + i]) for i, body in enumerate(drawn.scene.bodies)}
    both = {name: counts[:, list(found)].sum(axis=1) for name, found in compiled.contacts.items()}
    return ends, {name: (int(found.min()), int(found.max())) for name, found in both.items()}
