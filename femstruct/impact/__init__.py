"""Impacts on a modal basis: bodies and contacts, time integration, and the energy balance.

``scene`` has bodies, contacts and loads. ``collocation`` and ``exact`` are the two integrators; ``system``, ``motion``,
``propagation``, ``contact_events`` and ``energies`` are what they share. ``simulate`` runs one scene and
``numerical_error`` judges it; ``response`` has what is returned, ``batch`` runs many scenes. Contact forces are
those of ``femstruct.laws``; ``femstruct.compiled`` turns kernels into machine code.
"""
