"""Impacts on a modal basis: what meets, the laws, the march through time, and where the energy goes.

``scene`` says what meets, ``laws`` with which force; ``compiled`` turns kernels into machine code; ``engine`` is what
both marches share, ``collocation`` and ``exact`` are the marches; ``simulate`` runs one scene, ``estimate`` says how
far off it is; ``result`` is what it brought, ``batch`` many runs of one scene.
"""
