"""Triangulated periodic tubes: a mesh without a seam, its operators, its discrete energy, and its equilibria as branches."""
