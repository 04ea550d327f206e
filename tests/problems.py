"""Contact problems in Fourier modes, made by hand."""

from asperity.contact.problem import ContactProblem


def problem_of(lattice, heights, stiffness, pull):
    """The problem of a stiffness spectrum and a pull, with the heights measured from their maximum."""
    return ContactProblem(
        lattice,
        heights - heights.max(),
        stiffness=stiffness,
        pull=pull,
        load_controlled=bool(stiffness.flat[0] == 0),
    )
