"""Readers of the files in which other programs write surfaces: points and polygons, as the file has them, or a reason.

They are strict where libraries guess: trimesh splits concave polygons from their first corner (areas wrong by half), passes
over faces that are declared and not there, and takes negative indices from the end; meshio knows neither polygons in PLY nor
legacy files of polygons, nor VTU of several pieces. A reader counts what a file declares beside what it holds, trusts no
declared size before it has seen so many bytes, and neither follows names of other files nor runs anything.
"""
