"""Chapter 2: three bodies in a row, and a rod between two masses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import gamma
from systems import rigid, rod, wall

from femstruct.impact.collisions import collide
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import rod as rod_basis
from ledger.row import Row

BALL = 0.5  # m_b / m of all of section 2.2
TABLE_2_2 = {0.25: (0.23, 0.11, 0.56), 0.5: (0.1, 0.11, 0.79), 1.0: (0.0, 0.11, 0.89), 1.5: (0.03, 0.11, 0.85)}
TABLE_2_4 = {"omega_b": (1e6, 0.9, 1e2), "omega_d, 0.9 kg": (1e6, 0.9, 1e3), "omega_d, 0.45 kg": (1e6, 0.45, 1.5e3)}
TABLE_2_5 = {6.1e6: 2835.3, 2.2e6: 1562.9, 1.8e5: 477.5, 7.3e4: 318.9, 8.9e3: 95.5}
TABLE_2_6 = {"steel": (1.5e8, 12000), "brass": (8e7, 8900), "aluminium": (6e7, 7700), "plastic": (6e6, 2400)}
YOUNG = {"brass": 103e9, "aluminium": 70e9, "plastic": 3e9}  # of the plates, not printed [Pa]
ROD_DENSITY = 7850.0


def rows() -> list[Row]:
    """All rows of the chapter."""
    return [*restitution(), *springs(), *formulas(), *rods(), *experiments()]


def restitution() -> list[Row]:
    """Table 2.2 and 2.36, from momentum and restitution."""
    found = []
    for rd, printed in TABLE_2_2.items():
        ball, mass, damper = collide([BALL, 1.0, rd], [1.0, 0.0, 0.0], [1.0, 1.0]).energies
        for name, value, ours in zip(("E", "E_b+", "E_d+"), printed, (mass, ball, damper), strict=True):
            rest = 1.0 - printed[1] - printed[2]
            wrong = name == "E" and abs(rest - value) > 0.05
            found.append(
                Row(
                    f"Table 2.2, {name} / E_b- at m_d/m = {rd:g}",
                    value,
                    float(ours),
                    0.01,
                    implied=rest if wrong else None,
                    why="by 2.36 the row must add up to 1; 0.32 with its digits exchanged" if wrong else "",
                    note="" if wrong else "two digits, some of them cut instead of rounded",
                )
            )
    lossy = collide([BALL, 1.0, 1.0], [1.0, 0.0, 0.0], [0.8, 0.8])
    found.append(
        Row(
            "2.36, E / E_b- of the mass at e = 0.8, m_d/m = 1, by 1 - E_b - E_d",
            1.0 - float(lossy.energies[0] + lossy.energies[2]),
            float(lossy.energies[1]),
            1e-3,
            implied=float(lossy.energies[1]),
            why=f"2.36 also counts what the blows dissipate, {lossy.lost:.4f}: it holds for e = 1 only",
        )
    )
    return found


def springs() -> list[Row]:
    """Figures 2.3 to 2.5: contact springs."""
    found = []
    for wb in (1.25, 2.5, 5.0, 10.0, 100.0):
        at, energy = rigid.best_damper(BALL, 0.5, wb)
        found.append(
            Row(
                f"Fig. 2.3, omega_d / omega_b at the peak of E_d+, omega_b / omega = {wb:g}, m_d/m = 0.5",
                1.0,
                at,
                0.35,
                why=f"the peak ({energy:.3f}) moves to omega_d / omega = {at * wb:.2f}: the soft damper that is hit "
                "after the ball has left",
                note="'located close to': a third is allowed",
            )
        )
    equal = rigid.share(BALL, 1.0, 100.0, 100.0)
    at, energy = rigid.best_damper(BALL, 1.0, 100.0)
    found += [
        Row(
            "2.2.2, E_d+ / E_b- of contact springs at omega_b = omega_d = 100 omega, m_d/m = 1, as in Table 2.2",
            0.89,
            equal.damper,
            0.01,
            why="rigid contacts have no single limit: omega_d << omega_b gives 8/9, omega_d >> omega_b 8/25, equal "
            "frequencies 0.7547",
        ),
        Row(
            "2.2.2, the same at the best omega_d",
            0.89,
            energy,
            0.01,
            assumption=f"the point meant in Fig. 2.3(c) is the peak, omega_d = {at:.3f} omega_b",
        ),
        Row(
            "Fig. 2.3(c), E / E_b- at its lowest, omega_b / omega = 100: 'almost all' goes to the damper",
            0.0,
            rigid.share(BALL, 1.0, 100.0, 36.5).mass,
            0.01,
            assumption="the minimum is at omega_d = 0.365 omega_b",
        ),
    ]
    for wb in (1.25, 2.5):
        response = rigid.hit(BALL, 0.5, wb, 15.0)
        found.append(
            Row(
                f"Fig. 2.4/2.5, contacts of mass and damper at omega_d / omega = 15, omega_b / omega = {wb:g}",
                2.0,
                float(response.contacts["damper"].closings),
                0.0,
                relation=">",
                why="the damper is touched once and leaves: 'multiple collisions' are not in the equations",
            )
        )
        first = rigid.hit(BALL, 0.5, wb, wb).contacts["ball"].first_open
        assert first is not None
        found.append(
            Row(
                f"2.13, omega_b t / pi when the ball leaves, omega_b = omega_d = {wb:g} omega, m_d/m = 0.5",
                1.0,
                first * wb / np.pi,
                0.02,
                why="the mass it hits moves, so the ball leaves earlier than from a wall",
            )
        )
    return found


def formulas() -> list[Row]:
    """Misprints of formulas, with what they do to a number."""
    wb, wd, w, rb, rd = 3.0, 5.0, 2.0, BALL, 0.5
    k = np.array(
        [
            [rb * wb**2, -rb * wb**2, 0.0],
            [-rb * wb**2, w**2 + rb * wb**2 + rd * wd**2, -rd * wd**2],
            [0.0, -rd * wd**2, rd * wd**2],
        ]
    )
    constant = float(np.linalg.det(k) / (rb * rd))
    return [
        Row(
            "2.10, constant term of the characteristic polynomial at omega, omega_b, omega_d = 2, 3, 5 rad/s",
            wb**2 * wd**2,
            constant,
            1e-6,
            "1/s^6",
            implied=w**2 * wb**2 * wd**2,
            why="omega^2 is left out, which 2.21 has; the units show it",
        ),
        Row(
            "2.47, E_d+ / E_b- over h_d / h_b for m_d = 0.45 kg",
            1.0,
            0.45 / 0.9,
            0.0,
            implied=0.45 / 0.9,
            why="m g h holds the mass: the factor m_d / m_b of Table 2.4 is left out",
        ),
        Row(
            "2.43-2.45, momentum after over before, rod of 2 m at omega_b = omega_d = 0.8 omega_1",
            1.0,
            _momentum_as_printed(),
            1e-6,
            why="the modes are called normalised but are not: modal mass rho A L for the rigid one, not rho A",
            note="with normalised modes ours is 1 to rounding, see the next row",
        ),
        Row("2.43-2.45, the same with normalised modes", 1.0, _momentum(1.0), 1e-9),
    ]


def _momentum_as_printed() -> float:
    """Momentum gained when psi_0 = 1 is used with the mass per metre: sqrt(L) times the normalised shape."""
    return _momentum(np.sqrt(2.0))


def _momentum(factor: float) -> float:
    """Momentum of ball, damper and rod in the end over the ball's at first; factor scales the rigid shape."""
    case = rod.RodCase(0.8, 0.8)
    area = case.mass / (rod.DENSITY * case.length)
    E = rod.DENSITY * rod.SPEED_OF_SOUND**2
    basis, points = rod_basis(case.length, E, rod.DENSITY, area, case.modes, {"left": 0.0, "right": case.length})
    scale = np.ones(case.modes)
    scale[0] = factor
    basis = replace(basis, shapes=basis.shapes * scale)
    contacts = (
        Contact("ball", points["left"].probe("x"), "ball", Linear(case.stiffness(1.0, case.wb))),
        Contact("damper", "damper", points["right"].probe("x"), Linear(case.stiffness(1.0, case.wd))),
    )
    response = simulate(basis, Scene((Body("ball", 1.0, 1.0), Body("damper", 1.0)), contacts), Clock(5e-3, 4e3))
    speed = points["left"].probe("x").of(basis.shapes)[0] * response.qd[0, -1]  # of the rod as a whole
    bodies = [response.bodies[name].velocity[-1] for name in ("ball", "damper")]
    return float(sum(bodies) + case.mass * speed)


def rods() -> list[Row]:
    """Section 2.3."""
    case = rod.RodCase(0.8, 0.8)
    small, large = rod.RodCase(0.8, 5.0), rod.RodCase(2.0, 5.0)
    area, mass = 7.85e-5, np.pi / 4 * 0.02**2 * 2.0 * ROD_DENSITY
    peaks = {wb: _peak(wb) for wb in (0.833, 2.0, 5.05)}
    plateau = [rod.energies(rod.RodCase(2.0, wd))[0] for wd in (5.0, 20.0)]
    return [
        Row("2.46, E_d+ / E_b- of a rigid rod of 5 kg", 0.31, float(collide([1, 5, 1], [1, 0, 0], [1, 1]).energies[2]),
            0.005),
        Row("Table 2.3, rho A L of the rod of 2 m", 5.0, mass, 0.1, "kg",
            assumption="steel of 7850 kg/m^3 and the diameter of 20 mm of section 2.4.2"),
        Row("Table 2.3, rho A L of the rod of 3 m", 7.4, 1.5 * mass, 0.05, "kg",
            assumption="as above"),
        Row("Table 2.3, A for rho A L = 5 kg", area, 5.0 / (ROD_DENSITY * 2.0), 1e-6, "m^2",
            implied=5.0 / (ROD_DENSITY * 2.0),
            why=f"7.85e-5 m^2 is a diameter of 10 mm and weighs {area * 2 * ROD_DENSITY:.2f} kg"),
        Row("Table 2.3, omega_2 of the rod of 2 m", 1.58e4, 2 * case.first, 50.0, "rad/s",
            assumption="c = 5042 m/s, from omega_1 = 7.92e3 rad/s"),
        Row("Table 2.3, omega_3 of the rod of 2 m", 2.38e4, 3 * case.first, 50.0, "rad/s", assumption="as above"),
        Row("Table 2.3, omega_1 of the rod of 3 m", 5.28e3, case.first / 1.5, 5.0, "rad/s", assumption="as above"),
        Row("Table 2.3, omega_2 of the rod of 3 m", 1.06e4, 2 * case.first / 1.5, 50.0, "rad/s",
            assumption="as above"),
        Row("2.3, 'reflected energy' at omega_b = 0.8 omega_1, as a ratio of velocities", 0.42,
            abs(rod.ball_speed(small)), 0.03, assumption="final velocity is meant, as its parenthesis says; 50 modes",
            note="'almost 42 %'; travelling waves: 0.442"),
        Row("2.3, the same as an energy (0.8 omega_1)", 0.42, rod.energies(small)[1], 0.03, implied=0.42**2,
            why="the text reads the ratio off the velocity of the ball; its square is the energy"),
        Row("2.3, 'reflected energy' at omega_b = 2 omega_1, as a ratio of velocities", 0.07,
            abs(rod.ball_speed(large)), 0.01, assumption="as above", note="travelling waves: 0.079"),
        Row("2.3, the same as an energy (2 omega_1)", 0.07, rod.energies(large)[1], 0.005, implied=0.07**2,
            why="as above: nearly all goes to the rod, 99.5 % and not 93 %"),
        Row("2.3, more than the rigid rod's 0.31 goes to the damper at omega_b = omega_d = 0.8 omega_1", 0.31,
            rod.energies(case)[0], 0.0, relation=">"),
        Row("2.3, E_d+ is 'nearly constant' for omega_d / omega_1 > 5: E_d+(20) / E_d+(5) at omega_b = 2 omega_1", 1.0,
            plateau[1] / plateau[0], 0.1, note="a tenth is allowed"),
        Row("2.3, E_d+ rises with omega_b: peak at 2 omega_1 over peak at 0.833 omega_1, L = 2 m", 1.0,
            peaks[2.0][1] / peaks[0.833][1], 0.0, relation=">"),
        Row("2.3, the same: peak at 5.05 omega_1 over peak at 2 omega_1", 1.0, peaks[5.05][1] / peaks[2.0][1], 0.0,
            relation=">",
            why="the highest peak is near 2 omega_1, in modes and in travelling waves alike"),
        Row("Fig. 2.7, omega_d / omega_b at the peak of E_d+, omega_b = 2 omega_1", 1.0, peaks[2.0][0], 0.35,
            note="'near': a third is allowed"),
        Row("Fig. 2.7, the same at omega_b = 5.05 omega_1", 1.0, peaks[5.05][0], 0.35,
            why="the peak stays near omega_d = 2.3 omega_1 while omega_b grows"),
    ]  # fmt: skip


def _peak(wb: float) -> tuple[float, float]:
    """omega_d / omega_b at the largest energy of the damper, and that energy, on a fine grid."""
    ratios = np.geomspace(0.8, 4.0, 24)
    values = [rod.energies(rod.RodCase(wb, wd))[0] for wd in ratios]
    best = int(np.argmax(values))
    return float(ratios[best]) / wb, values[best]


def experiments() -> list[Row]:
    """Tables 2.4 to 2.6: stiffness, mass and frequency that must fit each other."""
    found = []
    for name, (k, m, printed) in TABLE_2_4.items():
        own = float(np.sqrt(k / m))
        wrong = abs(own / printed - 1) > 0.1
        found.append(
            Row(f"Table 2.4, {name}", printed, own, 0.06 * printed, "rad/s", implied=own if wrong else None,
                why="sqrt(k/m) of the same table; the exponent of 1e2 should be 3" if wrong else "",
                note="" if wrong else "two digits, cut")
        )  # fmt: skip
    for k, printed in TABLE_2_5.items():
        own = float(np.sqrt(k / 1.8))
        found.append(
            Row(f"Table 2.5, omega of the supported rod at k = {k:g} N/m", printed, own, 0.05 * printed, "rad/s",
                implied=own,
                why=f"sqrt(k/m) with m = 1.8 kg of Table 2.4; the printed frequency needs {k / printed**2:.2f} kg, "
                "another mass in every line")
        )  # fmt: skip
    for name, (k, printed) in TABLE_2_6.items():
        found.append(
            Row(f"Table 2.6, contact frequency, steel on {name}", float(printed), float(np.sqrt(k / 1.0)),
                0.025 * printed, "rad/s", assumption="the mass is that of the rod experiment, 1 kg",
                note="two digits, cut")
        )  # fmt: skip
    steel = _hertz_as_spring(206e9, 206e9)
    found.append(
        Row("Table 2.6, contact stiffness of steel on steel, R = 12.5 mm", 1.5e8, steel, 1.5e7,
            "N/m", assumption="1 kg at 1 m/s, E = 206 GPa, nu = 0.3; the spring with the contact time of Hertz")
    )  # fmt: skip
    for name, E in YOUNG.items():
        ratio = TABLE_2_6[name][0] / TABLE_2_6["steel"][0]
        found.append(
            Row(f"Table 2.6, contact stiffness on {name} over that on steel, by Hertz", ratio,
                _hertz_as_spring(206e9, E) / steel, 0.1 * ratio, assumption=f"E = {E / 1e9:g} GPa, nu = 0.3",
                why="the ratio of two Hertz contacts of one ball depends on neither mass nor speed: the plates gave "
                "way by more than their contact, or their supports did", note="a tenth")
        )  # fmt: skip
    for name, record in wall.collisions().items():
        k = TABLE_2_6[name][0]
        one = wall.found_linear(record)
        half = 0.5 * (one.high["stiffness"] - one.low["stiffness"])
        found.append(
            Row(f"Table 2.6, contact stiffness, steel on {name}, found from a record by least squares", k,
                one.values["stiffness"], 0.05 * k, "N/m",
                assumption="the records are not printed: this one is the printed stiffness, 1 kg at 1 m/s, and noise "
                "of 1 % of the peak", note=f"95 % interval +- {100 * half / k:.2f} %: what 300 samples can tell, the "
                "table has one or two digits")
        )  # fmt: skip
    return found


def _hertz_as_spring(first: float, second: float, radius: float = 0.0125, m: float = 1.0, v: float = 1.0) -> float:
    """Stiffness of the linear spring whose half period is the contact time of Hertz [N/m]."""
    plane = 1.0 / ((1 - 0.3**2) / first + (1 - 0.3**2) / second)
    k = 4.0 / 3.0 * plane * np.sqrt(radius)
    depth = (1.25 * m * v**2 / k) ** 0.4
    contact = 4.0 * np.sqrt(np.pi) * gamma(0.4) / (5.0 * gamma(0.9)) * depth / v
    return float(m * (np.pi / contact) ** 2)
