"""Closed-form robot dynamics, identification from recordings, and diagnosis of missing physics."""

from ._dynid import (
    Diagnosis,
    Error,
    Finding,
    Fit,
    Recording,
    Robot,
    diagnose,
    identify,
    load,
    open,
    robots,
)

__all__ = [
    "Diagnosis",
    "Error",
    "Finding",
    "Fit",
    "Recording",
    "Robot",
    "diagnose",
    "identify",
    "load",
    "open",
    "robots",
]
