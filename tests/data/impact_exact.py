"""Piecewise-linear impacts at 50 digits, by matrix exponentials: writes impact_exact.json beside it (some minutes).

Shares nothing with the engine: coordinates are physical, states are propagated by mpmath's expm of the regime's whole
first-order matrix (forces of loads are states of it), conditions are scanned 40 times a period of the fastest
eigenvalue with a look at every minimum between, and bracketed roots are refined to 42 digits.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from mpmath import matrix, mp, mpf

mp.dps = 50
ZERO = mpf(10) ** -38
OPEN, CLOSED, CLAMPED = range(3)


class Case:
    """Linear regimes of one scene; y = [q, x, q', x', 1, sine, cosine]."""

    def __init__(self, scene):
        self.scene = scene
        self.k, self.b = len(scene["frequency_hz"]), len(scene["bodies"])
        n = self.n = self.k + self.b
        self.one, self.sine, self.size = 2 * n, 2 * n + 1, 2 * n + 3
        self.mass = [mpf(1)] * self.k + [mpf(b["mass"]) for b in scene["bodies"]]
        omega = [2 * mp.pi * mpf(f) for f in scene["frequency_hz"]]
        self.stiffness = [w**2 for w in omega] + [mpf(0)] * self.b
        self.damping = mp.zeros(n)
        for i, (w, z) in enumerate(zip(omega, scene["ratio"], strict=True)):
            self.damping[i, i] = 2 * mpf(z) * w
        for i, row in enumerate(scene.get("dashpots", [])):
            for j, value in enumerate(row):
                self.damping[i, j] += mpf(value)
        self.contacts = []
        for c in scene["contacts"]:
            row = [p - q for p, q in zip(self.row(c["lower"]), self.row(c["upper"]), strict=True)]
            for side in (1, -1) if c.get("stop") else (1,):
                self.contacts.append({**c, "row": [side * r for r in row]})
        self.links = []
        for link in scene.get("links", []):
            row = [p - q for p, q in zip(self.row(link["lower"]), self.row(link["upper"]), strict=True)]
            self.links.append({**link, "row": row})

    def row(self, end):
        values = [mpf(0)] * self.n
        if end in self.scene["shapes"]:
            values[: self.k] = [mpf(s) for s in self.scene["shapes"][end]]
        elif end != "ground":
            values[self.k + [b["name"] for b in self.scene["bodies"]].index(end)] = mpf(1)
        return values

    def functional(self, a, place, rate, constant):
        """place row.x + rate row.v + constant as a vector over y."""
        w = [mpf(0)] * self.size
        for i, r in enumerate(a["row"]):
            w[i], w[self.n + i] = place * r, rate * r
        w[self.one] = constant
        return w

    def indentation(self, c):
        rest = mpf(c.get("preload", 0)) / mpf(c["stiffness"])
        return self.functional(c, mpf(1), mpf(0), rest - mpf(c.get("gap", 0)))

    def full_force(self, c):
        k, d = mpf(c["stiffness"]), mpf(c.get("damping", 0))
        return [k * p + d * r for p, r in zip(self.indentation(c), self.functional(c, 0, 1, 0), strict=True)]

    def force(self, c, status):
        held = mpf(c.get("preload", 0))
        w = self.full_force(c) if status == CLOSED else [mpf(0)] * self.size
        w[self.one] -= held
        return w

    def link_force(self, link, way, rest):
        if way == 0:
            return [mpf(0)] * self.size
        damping = mpf(link.get("closing" if way > 0 else "opening", 0))
        k = mpf(link.get("stiffness", 0))
        return self.functional(link, k, damping, mpf(link.get("preload", 0)) - k * rest)

    def regime(self, status, ways, rests, loaded_until_kink):
        n, a = self.n, mp.zeros(self.size)
        for i in range(n):
            a[i, n + i] = mpf(1)
            a[n + i, i] = -self.stiffness[i]
            for j in range(n):
                a[n + i, n + j] = -self.damping[i, j]
            if i >= self.k and self.scene["bodies"][i - self.k].get("falls"):
                a[n + i, self.one] -= mpf(self.scene["gravity"]) * self.mass[i]

        def act(row, force, sign):
            for i, r in enumerate(row):
                if r:
                    for j in range(self.size):
                        a[n + i, j] += sign * r * force[j]

        for c, s in zip(self.contacts, status, strict=True):
            act(c["row"], self.force(c, s), -1)
        for link, way, rest in zip(self.links, ways, rests, strict=True):
            act(link["row"], self.link_force(link, way, rest), -1)
        if loaded_until_kink:
            load = self.scene["load"]
            force = [mpf(0)] * self.size
            force[self.sine] = mpf(load["amplitude"])
            act(self.row(load["on"]), force, 1)
        for i in range(n):
            for j in range(self.size):
                a[n + i, j] /= self.mass[i]
        if "load" in self.scene:
            w = 2 * mp.pi * mpf(self.scene["load"]["frequency"])
            a[self.sine, self.sine + 1], a[self.sine + 1, self.sine] = w, -w
        return a

    def conditions(self, status, ways, loaded):
        found = []
        for i, (c, s) in enumerate(zip(self.contacts, status, strict=True)):
            clamps = not c.get("tensile") and c.get("damping", 0) > 0
            depth = self.indentation(c)
            if s in (OPEN, CLAMPED) or not clamps:
                found.append((i, "indentation", [-d for d in depth] if s == OPEN else depth))
            if clamps and s != OPEN:
                force = self.full_force(c)
                found.append((i, "force", force if s == CLOSED else [-f for f in force]))
            if c.get("preload") and s == CLOSED:
                excess, side = self.force(c, s), 1 if loaded[i] else -1
                excess = [side * e for e in excess]
                excess[self.one] += mpf(10) ** -9 * mpf(c["preload"])
                found.append((i, "excess", excess))
        for i, (link, way) in enumerate(zip(self.links, ways, strict=True)):
            if way and link.get("closing", 0) != link.get("opening", 0):
                found.append((i, "speed", self.functional(link, 0, mpf(way), 0)))
        return found

    def energies(self, y, status, ways, rests):
        n = self.n
        structure = sum((y[n + i] ** 2 + self.stiffness[i] * y[i] ** 2) / 2 for i in range(self.k))
        bodies = {b["name"]: self.mass[self.k + i] * y[n + self.k + i] ** 2 / 2
                  for i, b in enumerate(self.scene["bodies"])}  # fmt: skip
        contacts = {c["name"]: mpf(0) for c in self.contacts}
        for c, s in zip(self.contacts, status, strict=True):
            k, held = mpf(c["stiffness"]), mpf(c.get("preload", 0))
            depth, move = dot(self.indentation(c), y), dot(self.functional(c, 1, 0, 0), y)
            energy = k * depth**2 / 2 if s != OPEN else mpf(0)
            contacts[c["name"]] += energy - (held**2 / (2 * k) if held else 0) - held * move
        links = {}
        for link, way, rest in zip(self.links, ways, rests, strict=True):
            k, held = mpf(link.get("stiffness", 0)), mpf(link.get("preload", 0))
            moved = (dot(self.functional(link, 1, 0, 0), y) - rest) if way else mpf(0)
            links[link["name"]] = (held**2 / (2 * k) if k else 0) + k * moved**2 / 2 + held * moved
        return structure, bodies, contacts, links


def dot(w, y):
    return mp.fsum(a * b for a, b in zip(w, y, strict=True) if a)


def leading(w, y, a):
    """Sign of the first derivative of w.y that is not zero."""
    size = max(abs(v) for v in w) * max(abs(v) for v in y)
    for _ in range(9):
        value = dot(w, y)
        if abs(value) > ZERO * size:
            return 1 if value > 0 else -1
        y = a * y
    return 0


def solve(scene):
    case = Case(scene)
    n, end = case.n, mpf(scene["duration"])
    y = matrix([mpf(0)] * case.size)
    for i, v in enumerate(scene.get("velocity", [])):
        y[n + i] = mpf(v)
    for i, b in enumerate(scene["bodies"]):
        y[n + case.k + i] = mpf(b.get("velocity", 0))
    y[case.one], y[case.sine + 1] = mpf(1), mpf(1)
    status = [CLOSED if c.get("preload") else OPEN for c in case.contacts]
    rests, ways, loaded = [mpf(0)] * len(case.links), [0] * len(case.links), [False] * len(case.contacts)
    stops = {end}
    load_end = mpf(1) / (2 * mpf(scene["load"]["frequency"])) if "load" in scene else mpf(0)
    stops |= {load_end} if load_end else set()
    stops |= {mpf(link["release_at"]) for link in case.links if link.get("release_at")}
    t, work, events, separation = mpf(0), mpf(0), [], None
    start = None

    def weight_work(y):
        return -sum(mpf(b["mass"]) * mpf(scene["gravity"]) * y[case.k + i]
                    for i, b in enumerate(scene["bodies"]) if b.get("falls"))  # fmt: skip

    def balance():
        structure, bodies, contacts, links = case.energies(y, status, ways, rests)
        total = structure + sum(bodies.values()) + sum(contacts.values()) + sum(links.values())
        done = work + weight_work(y)
        lost = (start if start is not None else total) + done - total
        return {"t": t, "structure": structure, "bodies": bodies, "contacts": contacts, "links": links,
                "work": done, "lost": lost}, total  # fmt: skip

    def release():
        for i, link in enumerate(case.links):
            if not ways[i] and mpf(link.get("release_at", 0)) <= t:
                rests[i] = dot(case.functional(link, 1, 0, 0), y)
                ways[i] = 1 if dot(case.functional(link, 0, 1, 0), y) >= 0 else -1

    def apply(i, what):
        if what == "speed":
            ways[i] = -ways[i]
            return
        if what == "indentation":
            status[i] = CLOSED if status[i] == OPEN else OPEN
        elif what == "force":
            deep = dot(case.indentation(case.contacts[i]), y) > ZERO
            status[i] = (CLAMPED if deep else OPEN) if status[i] == CLOSED else CLOSED
        before = loaded[i]
        if what == "excess":
            loaded[i] = not loaded[i]
        if status[i] != CLOSED:
            loaded[i] = False
        elif not case.contacts[i].get("preload"):
            loaded[i] = True
        if loaded[i] != before:
            events.append((t, case.contacts[i]["name"], "closes" if loaded[i] else "opens"))

    release()
    start = balance()[1]
    switched = set()
    while t < end:
        loading = t < load_end
        while True:  # all that is at zero is decided by its leading derivative, one at a time, lowest first
            a = case.regime(status, ways, rests, loading)
            now = None
            for i, what, w in case.conditions(status, ways, loaded):
                size = max(abs(v) for v in w) * max(abs(v) for v in y)
                zero = abs(dot(w, y)) <= ZERO * size or (i, what) in switched
                sign = leading(w, a * y if (i, what) in switched else y, a) if zero else dot(w, y)
                if sign < 0:
                    now = (i, what)
                    break
            if not now:
                break
            apply(*now)
        limit = min(s for s in stops if s > t)
        fastest = np.abs(np.linalg.eigvals(np.array(a.tolist(), dtype=float))).max()
        steps = max(int(mp.ceil((limit - t) * mpf(float(fastest)) * 40 / (2 * mp.pi))), 4)
        dt = (limit - t) / steps
        flow = mp.expm(a * dt)
        conditions = case.conditions(status, ways, loaded)
        hit, before = None, y
        for _ in range(steps):
            after = flow * before
            left, right = a * before, a * after
            for i, what, w in conditions:
                f1, d0, d1 = dot(w, after), dot(w, left), dot(w, right)
                high = None
                if f1 < 0:
                    high = dt
                elif d0 < 0 < d1:  # a minimum between: where, and how low?
                    lowest = root(moving(a, before, w, 1), mpf(0), dt, rough=True)
                    if dot(w, at(a, lowest, before)) < 0:
                        high = lowest
                if high is not None:
                    s = root(moving(a, before, [-v for v in w], 0), mpf(0), high)
                    if hit is None or s < hit[0]:
                        hit = (s, i, what)
            if hit:
                break
            before = after
            t += dt
        part = hit[0] if hit else mpf(0)
        if loading:
            raise_ = case.row(scene["load"]["on"])
            begin = y
            span = (t + part) - (limit - dt * steps)

            def power(s, begin=begin, a=a, raise_=raise_):
                z = at(a, s, begin)
                speed = mp.fsum(r * z[n + j] for j, r in enumerate(raise_) if r)
                return mpf(scene["load"]["amplitude"]) * z[case.sine] * speed

            nodes = max(int(span * float(fastest)), 1)
            work += mp.quad(power, [span * j / nodes for j in range(nodes + 1)], maxdegree=4)
        if hit:
            y = at(a, part, before)
            t += part
            switched = {(hit[1], hit[2])}
            apply(hit[1], hit[2])
            if separation is None and events and events[-1][2] == "opens" and not any(loaded):
                separation = balance()[0]
        else:
            y, t, switched = before, limit, set()
            release()
        print(f"  t = {mp.nstr(t, 12)}  {hit[1:] if hit else 'stop'}  events {len(events)}", flush=True)
    return events, separation, balance()[0]


def at(a, s, y):
    """expm(a s) y by its power series, until the terms are below 1e-60 of the sum."""
    total, term, k = y.copy(), y, 0
    while k < 10 or mp.norm(term, mp.inf) > mpf(10) ** -60 * mp.norm(total, mp.inf):
        k += 1
        term = (a * term) * (s / k)
        total += term
    return total


def moving(a, y, w, derivative):
    """w.y(s), or a derivative of it, and its slope: a function of s."""

    def found(s):
        z = at(a, s, y)
        for _ in range(derivative):
            z = a * z
        return dot(w, z), dot(w, a * z)

    return found


def root(f, low, high, rough=False):
    """Safeguarded Newton for f, which is negative at low and positive at high; f returns value and slope."""
    x = (low + high) / 2
    for _ in range(200):
        value, slope = f(x)
        low, high = (x, high) if value < 0 else (low, x)
        new = x - value / slope if slope else low
        if not low < new < high:
            new = (low + high) / 2
        if abs(new - x) <= (mpf(10) ** -8 if rough else mpf(10) ** -42) * high:
            return new
        x = new
    raise ArithmeticError("no root")


PRESS = {
    "frequency_hz": [40 / (2 * np.pi), 1777 / (2 * np.pi)],
    "ratio": [0.0, 0.0],
    "shapes": {"b": [0.14, 0.392], "f": [0.14, -0.07]},
    "bodies": [{"name": "slider", "mass": 1.2, "velocity": -1.2}, {"name": "damper", "mass": 3.5}],
    "links": [{"name": "mount", "upper": "damper", "lower": "f", "stiffness": 1.8e3, "opening": 7e2}],
}


def press(name, ws, wd, duration, ratio=0.0, **other):
    contacts = [
        {"name": "slider", "upper": "slider", "lower": "b", "stiffness": 1.2 * (40 * ws) ** 2},
        {"name": "damper", "upper": "b", "lower": "damper", "stiffness": 3.5 * (40 * wd) ** 2},
    ]
    return {"name": name, **PRESS, "ratio": [ratio, ratio], "contacts": contacts, "duration": duration, **other}


def scenes():
    rng = np.random.default_rng(11)
    twelve = sorted(round(float(f), 3) for f in 10 ** rng.uniform(1.0, 3.0, 12))
    shape = {p: [round(float(s), 4) for s in rng.uniform(-1, 1, 12)] for p in "rs"}
    root_ = rng.uniform(-2, 2, (4, 2))
    return [
        press("press Q", 150, 150, 3e-3),
        press("press with damped modes, meeting again", 20, 10, 0.02, ratio=0.01),
        {
            "name": "three bodies, a gap behind",
            "frequency_hz": [1 / (2 * np.pi)],
            "ratio": [0.0],
            "shapes": {"m": [1.0]},
            "bodies": [{"name": "ball", "mass": 2.0, "velocity": -1.0}, {"name": "d", "mass": 0.8}],
            "contacts": [
                {"name": "ball", "upper": "ball", "lower": "m", "stiffness": 450.0},
                {"name": "d", "upper": "m", "lower": "d", "stiffness": 1280.0, "gap": 0.3},
            ],
            "duration": 6.0,
        },
        {
            "name": "ball falls on a held plate: preload, clamped dashpots, gravity",
            "frequency_hz": [0.0, 18.0, 160.0],
            "ratio": [0.0, 0.03, 0.02],
            "shapes": {"p": [0.4, 0.9, -0.7], "e": [0.4, -0.8, 0.5]},
            "bodies": [{"name": "ball", "mass": 0.3, "velocity": -1.5, "falls": True}, {"name": "d", "mass": 0.6}],
            "contacts": [
                {"name": "ball", "upper": "ball", "lower": "p", "stiffness": 2e5, "damping": 60.0, "gap": 2e-4},
                {"name": "held", "upper": "p", "lower": "d", "stiffness": 4e5, "damping": 25.0, "preload": 40.0},
            ],
            "links": [
                {"name": "back", "upper": "d", "lower": "e", "stiffness": 900.0, "opening": 30.0, "closing": 5.0}
            ],
            "gravity": 9.81,
            "duration": 0.06,
        },
        {
            "name": "twelve damped modes, one-way dashpots, gaps, a tensile dashpot",
            "frequency_hz": twelve,
            "ratio": [0.02] * 12,
            "shapes": shape,
            "bodies": [{"name": "ball", "mass": 0.4, "velocity": -2.0}, {"name": "d", "mass": 0.5}],
            "contacts": [
                {"name": "ball", "upper": "ball", "lower": "r", "stiffness": 3e5, "damping": 20.0, "tensile": True},
                {"name": "d", "upper": "r", "lower": "d", "stiffness": 8e5, "damping": 15.0, "gap": 1e-4},
            ],
            "links": [
                {"name": "one", "upper": "d", "lower": "s", "stiffness": 600.0, "opening": 50.0},
                {"name": "two", "upper": "r", "lower": "s", "closing": 20.0},
            ],
            "duration": 0.02,
        },
        {
            "name": "four modes with full damping, a stop, a released link, a half-sine",
            "frequency_hz": [12.0, 30.0, 95.0, 210.0],
            "ratio": [0.01, 0.01, 0.01, 0.01],
            "dashpots": [[round(float(v), 6) for v in row] for row in root_ @ root_.T],
            "shapes": {"p": [0.7, -0.4, 0.9, 0.5], "r": [0.3, 0.8, -0.6, 0.4]},
            "bodies": [{"name": "b", "mass": 0.25}],
            "contacts": [{"name": "stop", "upper": "b", "lower": "p", "stiffness": 1e5, "gap": 1e-4, "stop": True}],
            "links": [
                {"name": "spring", "upper": "b", "lower": "r", "stiffness": 400.0, "closing": 2.0, "opening": 9.0,
                 "release_at": 0.004, "preload": 6.0}
            ],
            "load": {"on": "p", "amplitude": 150.0, "frequency": 40.0},
            "velocity": [0.0, 0.05, 0.0, 0.0],
            "duration": 0.05,
        },
        *(graze(eps) for eps in (1e-2, 1e-3, 1e-6, 1e-9)),
    ]  # fmt: skip


def graze(eps):
    """x = sin t just reaches a free mass at 1 - eps."""
    return {
        "name": f"graze {eps:g}",
        "frequency_hz": [1 / (2 * np.pi)],
        "ratio": [0.0],
        "shapes": {"m": [1.0]},
        "bodies": [{"name": "d", "mass": 1.0}],
        "contacts": [{"name": "graze", "upper": "d", "lower": "m", "stiffness": 1e6, "gap": 1.0 - eps}],
        "velocity": [1.0],
        "duration": 20.0,
    }


def told(value):
    if isinstance(value, dict):
        return {name: told(v) for name, v in value.items()}
    return mp.nstr(value, 40)


def main():
    file = Path(__file__).with_suffix(".json")
    known = {case["scene"]["name"]: case for case in json.loads(file.read_text())["cases"]} if file.exists() else {}
    about = "Piecewise-linear impacts at 50 digits, made by impact_exact.py with mpmath; 40 digits are written."
    for scene in scenes():
        if known.get(scene["name"], {}).get("scene") != scene:  # only what is new or changed is computed
            print(scene["name"], flush=True)
            events, separation, end = solve({"gravity": 0.0, **scene})
            known[scene["name"]] = {
                "scene": scene,
                "events": [[mp.nstr(t, 40), name, what] for t, name, what in events],
                "separation": separation and told(separation),
                "end": told(end),
            }
            cases = [known[other["name"]] for other in scenes() if other["name"] in known]
            file.write_text(json.dumps({"about": about, "cases": cases}, indent=1) + "\n")


if __name__ == "__main__":
    main()
