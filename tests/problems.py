"""Contact problems in Fourier modes, made by hand."""

from asperity.contact.problem import SpectralProblem


def problem_of(lattice, heights, stiffness, rhs):
    """The problem of a stiffness spectrum and a right-hand side, heights from their maximum."""
    return SpectralProblem(lattice, heights - heights.max(), stiffness=stiffness, rhs=rhs)
