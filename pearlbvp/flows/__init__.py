"""Constrained gradient flow of membranes on SUNDIALS IDA: one driver for every discretization."""
