"""Damping that couples the modes: pairs of complex modes as oscillators that move by themselves, exactly."""
