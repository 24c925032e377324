"""Which compiled kernels a study needs, told before its modes are known and once they are."""

from __future__ import annotations

from collections.abc import Sequence

from femstruct.impact.engine.needed_units import BY_COLLOCATION, EXACTLY, Units
from femstruct.impact.engine.system import compile_scene
from femstruct.impact.exact.choice import takes_exact_march
from femstruct.impact.scene.bodies import Clock, Scene
from femstruct.modal.basis import ModalBasis
from femstruct.study.study import Case


def expected_units(cases: Sequence[Case]) -> Units:
    """Kernels that the cases take by the laws of their contacts: what can be compiled while the modes are solved."""
    studies = [case.study for case in cases if case.study.time is not None]
    if not studies:
        return ()
    laws = [body.law for study in studies for body in study.bodies if body.law is not None]
    laws += [contact.law for study in studies for contact in study.contacts]
    blows = any(body.blows is not None for study in studies for body in study.bodies)
    return EXACTLY if not blows and all(law.straight for law in laws) else BY_COLLOCATION


def units_of(basis: ModalBasis, scene: Scene, clock: Clock) -> Units:
    """Kernels that a run of this scene takes."""
    compiled = compile_scene(basis, scene, clock)
    exact = takes_exact_march(compiled.system, compiled.n_samples / clock.sampling)
    return EXACTLY if exact else BY_COLLOCATION
