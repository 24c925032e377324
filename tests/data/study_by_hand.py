"""A study's result written down by hand: closed-form shapes of a simply supported plate, made-up histories.

Loaded with ``runpy`` by the tests of files and pictures, which need the nouns but not the numerics.
"""

import numpy as np

from acoustics.fields.rectangular import Room
from acoustics.levels.sound_levels import sound_levels
from acoustics.losses import losses_from_beta
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from femstruct.conventions import N_COMPONENTS, RX, RY, TWIST, UZ
from femstruct.errors import Finding
from femstruct.evaluations.known_evaluations import EVALUATIONS
from femstruct.impact.motion import sampled_motion
from femstruct.impact.numerical_error import ErrorEstimate, Resolved
from femstruct.impact.response import BodyHistory, ContactHistory, EnergyBalance, EnergyLedger, Event, Outcome, Response
from femstruct.impact.scene import Body, Clock, Contact, Link, Scene
from femstruct.laws.hertz import Hertz
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.damping import Damping, Ratio
from femstruct.model.materials import Material
from femstruct.model.model import Mesh, Model
from femstruct.model.probe import Point, Probe, Surface
from femstruct.model.regions import sparse_rows
from femstruct.model.sections import circle
from femstruct.model.structure import Structure
from femstruct.parts.frame import Frame, FrameMesh
from femstruct.parts.plate import Plate, PlateMesh
from femstruct.study.asked import Extent, FrfRequest, RoomPlan, Spot, TimePlan
from femstruct.study.recorded import Channel
from femstruct.study.results import CaseComparison, CaseResult, Comparison, Frf, PeakChange, StudyResult
from femstruct.study.study import Case, Plan, Study

LX, LY = 0.4, 0.32
INDICES = ((1, 1), (2, 1), (1, 2), (2, 2), (3, 1))


def plate_modes(points, indices=INDICES):
    """[n, 7, k]: heave, then sin sin with its slopes and twist."""
    x, y = points[:, 0], points[:, 1]
    shapes = np.zeros((len(points), N_COMPONENTS, 1 + len(indices)))
    shapes[:, UZ, 0] = 1.0
    for k, (i, j) in enumerate(indices, start=1):
        a, b = i * np.pi / LX, j * np.pi / LY
        shapes[:, UZ, k] = np.sin(a * x) * np.sin(b * y)
        shapes[:, RX, k] = b * np.sin(a * x) * np.cos(b * y)
        shapes[:, RY, k] = -a * np.cos(a * x) * np.sin(b * y)
        shapes[:, TWIST, k] = a * b * np.cos(a * x) * np.cos(b * y)
    return shapes


def model_by_hand(divisions=8):
    """A plate on its own grid, and one post of two bars below its corner."""
    steel = Material("steel", 210e9, 0.3, 7850.0)
    x, y = np.linspace(0, LX, divisions + 1), np.linspace(0, LY, divisions + 1)
    nodes = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    post = np.array([[0.0, 0.0, -0.2], [0.0, 0.0, -0.1], [0.0, 0.0, 0.0]])
    points = np.concatenate([np.column_stack([grid, np.zeros(len(grid))]), post])
    plate = PlateMesh(Plate("floor", steel, 0.005, (0, 0, 0), (LX, LY), (divisions, divisions)), 0, np.eye(3), x, y)
    first = len(grid)
    bars = np.array([[first, first + 1], [first + 1, first + 2]])
    lines = (tuple(tuple(map(float, p)) for p in post),)
    axes = np.tile(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), (2, 1, 1))
    frame = FrameMesh(
        Frame("post", steel, circle("round", 0.01), lines, element="timoshenko"),
        first,
        post,
        bars,
        points[bars[:, 0]],
        points[bars[:, 1]],
        np.zeros((2, 2, 3)),
        axes,
    )
    centre = nodes[divisions // 2, divisions // 2]
    place = Point("O_f", points[centre], [centre], [UZ], np.eye(6)[2][:, None], [0.0, 0.0, 1.0])
    mesh = Mesh(
        points,
        plate.quads,
        bars,
        {"floor": nodes.ravel(), "post": np.arange(first, first + 3)},
    )
    surfaces = {"ceiling": ceiling_by_hand(plate, len(points))}
    structure = Structure("Plate and post", (plate.part, frame.part))
    return Model(structure, mesh, {"floor": plate, "post": frame}, (), (), (), {"O_f": place}, surfaces)


def ceiling_by_hand(plate, n_nodes):
    """The underside of the plate, by the midpoints of the quarters of its cells."""
    x, y = np.arange(0.5, 16) * LX / 16, np.arange(0.5, 16) * LY / 16
    places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    nodes, rows = plate.rows(places)
    points = np.column_stack([places, np.zeros(len(places))])
    weights = np.full(len(places), LX * LY / len(places))
    rows = sparse_rows(nodes, -rows[:, 2:3], n_nodes)
    down = np.tile([0, 0, -1], (len(points), 1))
    corners = [[0, LY, 0], [LX, LY, 0], [LX, 0, 0], [0, 0, 0]]
    return Surface("ceiling", points, weights, down, [[1, 0, 0], [0, -1, 0]], corners, rows)


def basis_by_hand(model):
    """Six modes; the post only shares in the heave."""
    shapes = plate_modes(model.mesh.points)
    shapes[-3:, :, 1:] = 0.0
    omega = 2 * np.pi * np.array([0.0, 19.9, 151.1, 274.4, 347.1, 448.3])
    k = len(omega)
    return ModalBasis(
        omega=omega,
        kind=("rigid",) + ("elastic",) * (k - 1),
        shapes=shapes,
        points=model.mesh.points,
        viscous=np.diag(2 * 0.02 * omega),
        hysteretic=np.zeros((k, k)),
        outputs={"ground.z": ForceRow(omega**2, np.zeros(k), np.zeros(k), direct=Probe([3, 40], [2, 4], [0.25, -0.5]))},
        part_stiffness={"floor": np.diag(0.7 * omega**2), "post": np.diag(0.3 * omega**2)},
        loss_factors={},
        residual_norm=np.full(k, 1e-12),
        complete_below_hz=500.0,
        momentum=np.ones((3, k)),
        total_mass=2.0,
        findings=(Finding("hand", "Made by hand.", {"number": float("nan")}),),
    )


def _response(basis, study, factor):
    fs, duration = study.time.sampling, study.time.duration
    t = np.arange(round(fs * duration)) / fs
    decay = factor * np.exp(-2 * t[None] * np.arange(1, 7)[:, None])
    phase = basis.omega[:, None] * t[None]
    q, qd = 1e-4 * decay * np.sin(phase), 1e-4 * basis.omega[:, None] * decay * np.cos(phase)
    force = factor * 200 * np.sin(np.pi * t / 5e-3) * (t < 5e-3)
    ball = BodyHistory(
        np.where(t < 5e-3, -2.1 * t, -0.0105 + 1.2 * (t - 5e-3)), np.where(t < 5e-3, -2.1, 1.2), 0.0 * t, 1.2
    )
    energy = np.full_like(t, 0.05)
    balance = EnergyBalance(
        0.0, {"ball": 0.12}, 0.0, {"ball on floor": 0.0}, {}, 0.0, {"ball on floor": 0.0}, {}, 0.0, 0.0
    )
    ledger = EnergyLedger(
        balance,
        balance,
        balance,
        t,
        {"ball": energy},
        0.04 * np.exp(-2 * t),
        0 * t,
        0.05 - 0.04 * np.exp(-2 * t),
        {"ball on floor": np.full_like(t, 0.02)},
        {},
        0 * t,
        0 * t,
        1e-11,
    )
    probe = Probe([40], [UZ], [1.0])
    scene = Scene(
        (Body("ball", 0.054, -2.1, True),),
        (Contact("ball on floor", "ball", probe, Hertz(3.7e5)),),
        (Link("tether", "ball", probe, 10.0),),
    )
    return Response(
        basis,
        scene,
        Clock(duration, fs),
        t,
        sampled_motion(q, qd),
        np.zeros((0, len(q))),
        np.zeros((0, len(t))),
        {"ball": ball},
        {"ball on floor": ContactHistory(force, -ball.displacement, factor * 200.0, 2.5e-3, 1, 5e-3)},
        {"tether": 10 * ball.displacement},
        (Event(0.0, "ball on floor", "closes"), Event(5e-3, "ball on floor", "opens")),
        (),
        ledger,
        Outcome.SEPARATED,
        (),
    )


def study_by_hand(duration=0.25, sampling=4800.0, save_modal=True, tag=1.0):
    """Two cases of one structure in one room; `tag` scales everything, to tell one run from another."""
    model = model_by_hand()
    basis = basis_by_hand(model)
    request = FrfRequest("centre", Spot("O_f", "z"), Spot("O_f", "z"), "accelerance", (1.0, 500.0), 0.5)
    mic = Receiver("mic", [0.2, 0.16, 0.05])
    room = Room([LX, LY, 0.1], losses=losses_from_beta(0.0116, 293))
    study = Study(
        "By hand",
        Structure("Plate and post", ()),
        Damping(Ratio(0.02)),
        Extent(up_to_hz=500.0),
        (request,),
        time=TimePlan(duration, sampling),
        rooms=(RoomPlan("box", room, "ceiling", (mic,)),),
        save_modal=save_modal,
    )
    f = np.arange(1.0, 500.0, 0.5)
    w = 2 * np.pi * f[:, None]
    frf = -(w[:, 0] ** 2) * (1 / (basis.omega**2 - w**2 + 1j * w * np.diag(basis.viscous))).sum(axis=1)
    cases = {}
    for name, factor in (("without damper", 1.0 * tag), ("damper 0.6 / new", 0.5 * tag)):
        response = _response(basis, study, factor)
        velocity, acceleration = response.qd.sum(axis=0), response.qdd.sum(axis=0)
        pressure = 0.3 * acceleration / 10
        channels = {
            "O_f.z velocity": (velocity, "m/s"),
            "O_f.z acceleration": (acceleration, "m/s^2"),
            "ball on floor force": (response.contacts["ball on floor"].force, "N"),
            "ball travel": (response.bodies["ball"].displacement, "m"),
            "box.mic pressure": (pressure, "Pa"),
        }
        heard = RoomResponse((mic,), response.t, pressure[None])
        cases[name] = CaseResult(
            Case(name, study, {"bodies.damper.mass": "0.45 kg"}),
            "abc123",
            basis,
            response,
            {"centre": Frf(request, f, frf, "m/(N s^2)")},
            {n: Channel(n, v, u, abs(v[:96]).max(), abs(v).max()) for n, (v, u) in channels.items()},
            {"box": heard},
            {"box.mic": sound_levels(pressure, 1 / sampling)},
            (Finding("air-stiffness", "The air is stiff.", {"ratio": 0.88}),),
            errors=ErrorEstimate(
                1e-8,
                1e-10,
                duration,
                {"ball on floor": Resolved(factor * 200.0, 1e-9, factor * 200.0)},
                {"ball on floor": Resolved(factor * 200.0, float("inf"), factor * 200.0)},
                {"ball": Resolved(1.2, 1e-9, 2.1)},
            ),
            evaluations={key: {} for key in EVALUATIONS},
        )
    compared = CaseComparison(
        {"O_f.z velocity": PeakChange(-50.0, None)},
        {"box.mic": {25.0: 6.02, 31.5: float("nan")}},
        {"O_f.z velocity": {2: 6.0}, "box.mic pressure": {2: 5.9}},
        {2: (2, 19.9, 1.0)},
    )
    plan = Plan(
        "By hand", tuple(case.case for case in cases.values()), "without damper", {"models/by_hand.yaml": "title: ü\n"}
    )
    return StudyResult(
        plan,
        {"abc123": basis},
        {"abc123": model},
        cases,
        Comparison("without damper", {"damper 0.6 / new": compared}, "no filter"),
        (),
        {"modes": 0.1},
        {"femstruct": "0.1.0"},
    )
