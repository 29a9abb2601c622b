"""Membrane equilibria as boundary-value problems of ordinary differential equations, one file a family."""
