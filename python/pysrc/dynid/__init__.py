"""Closed-form robot dynamics, identification from recordings, and diagnosis of missing physics."""

from ._dynid import (
    Diagnosis,
    Error,
    Factors,
    Finding,
    Fit,
    Recording,
    Robot,
    diagnose,
    factor,
    identify,
    load,
    merge,
    open,
    robots,
    solve,
)

__all__ = [
    "Diagnosis",
    "Error",
    "Factors",
    "Finding",
    "Fit",
    "Recording",
    "Robot",
    "diagnose",
    "factor",
    "identify",
    "load",
    "merge",
    "open",
    "robots",
    "solve",
]
