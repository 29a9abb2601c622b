"""Second variation of an axisymmetric profile: Bloch growth rates, Floquet multipliers. Does not know who solved for it."""
