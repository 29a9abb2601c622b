"""Tubes in reduced modes: each cross-section about its own centre, Fourier sums around the tube and along it."""
