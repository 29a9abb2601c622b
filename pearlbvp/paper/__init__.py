"""The paper that the package's cases come from, figure by figure: its panels computed anew, its numbers beside ours.

A. Meiners and H. Uecker, *Helfrich cylinders: instabilities, bifurcations and amplitude equations*.
"""
