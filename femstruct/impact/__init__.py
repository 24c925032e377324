"""Impacts on a modal basis: bodies and contacts, laws, time integration, and the energy balance.

``scene`` has bodies, contacts and loads, ``laws`` the contact forces; ``compiled`` turns kernels into machine code.
``collocation`` and ``exact`` are the two integrators ("marches"), ``engine`` is what they share. ``simulate`` runs one
scene, ``estimate`` gives its numerical error; ``result`` has what is returned, ``batch`` many runs of one scene.
"""
