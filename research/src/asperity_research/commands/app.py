"""The commands ``reproduce``, ``study`` and ``challenge``; what computes is imported inside them."""

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from asperity.app.cli.command import app, command
from asperity.app.cli.flags import Out, Switch
from asperity.app.cli.options import Work
from asperity_research.commands.ensembles import Ensembles

_ENSEMBLES, _WORK = Ensembles(), Work()


@command()
def reproduce(*, out: Out, ensembles: Ensembles = _ENSEMBLES, work: Work = _WORK) -> None:
    """Reproduce the paper: every figure and every claim, from simulations of your own, as one report.

    The paper is E. A. Jagla's on the time dependence of contact area. The report, report.html in the
    folder, explains itself. The same command again does what is missing, and draws the report anew.

    Parameters
    ----------
    out
        Folder of the reproduction; new, or to be continued.
    """
    work.check()
    from asperity_research.commands import study as studying
    from asperity_research.paper.reproduce import PAPER

    studying.answer(PAPER, ["reproduce"], out, ensembles, work)


@command()
def study(
    name: str | None = None,
    /,
    *,
    out: Out | None = None,
    ensembles: Ensembles = _ENSEMBLES,
    work: Work = _WORK,
) -> None:
    """Answer an open question from simulations of your own: numbers, a verdict and a figure.

    Without a name: list the studies. The report is report.md in the folder. The same command again does what
    is missing, and writes the report anew.

    Parameters
    ----------
    name
        Which study.
    out
        Folder of the study; new, or to be continued. [default: asperity-study-NAME]
    """
    work.check()
    from asperity_research.commands import study as studying
    from asperity_research.studies import named

    if name is None:
        studying.say_studies()
    else:
        folder = out or Path(f"asperity-study-{name}")
        studying.answer(named(name), ["study", name], folder, ensembles, work)


references = App(name="challenge", help="Reference problems with certified answers, for any code.")
app.command(references)


@command(name="list", of=references)
@references.default
def list_references() -> None:
    """List the reference problems: what each asks, and how closely its answer is known."""
    from asperity_research.commands.challenge import list_problems

    list_problems()


@command(name="write", of=references)
def write_references(
    directory: Path,
    /,
    *,
    problem: Annotated[list[str] | None, Parameter(negative=(), consume_multiple=True)] = None,
    scan: Path | None = None,
    overwrite: Switch = False,
) -> None:
    """Write the inputs of reference problems: heights, parameters, words, and a form for the answer.

    Parameters
    ----------
    directory
        Folder for them; each problem has one in it.
    problem
        Names of problems. [default: all]
    scan
        The file of the measured problem, which does not come with this package.
    overwrite
        Replace problems that were written there before.
    """
    from asperity_research.commands.challenge import write_inputs

    write_inputs(directory, problem or (), scan=scan, overwrite=overwrite)


@command(name="score", of=references)
def score_result(
    result: Path, /, *, problem: str | None = None, out: Out | None = None, overwrite: Switch = False
) -> None:
    """Compare an answer with the certified one, number by number.

    Parameters
    ----------
    result
        A table with the columns of the form, answer.csv; also the aging.csv of a run.
    problem
        Name of the problem. [default: the file says it, in a line "# problem: NAME"]
    out
        Figure to write (.png, .pdf or .svg). [default: none]
    overwrite
        Replace the figure if it exists.
    """
    from asperity_research.commands.challenge import score_file

    score_file(result, problem=problem, out=out, overwrite=overwrite)


@command()
def experiment(
    name: str | None = None,
    /,
    *,
    out: Out | None = None,
    surface: Annotated[list[Path] | None, Parameter(negative=(), consume_multiple=True)] = None,
    record: Path | None = None,
    ensembles: Ensembles = _ENSEMBLES,
    work: Work = _WORK,
) -> None:
    """Set simulations beside a measured contact: numbers with intervals, verdicts, and a figure.

    Without a name: list the experiments. Without --out: print the numbers of one, with their sources. The
    same command again computes what is missing, and writes the report anew.

    Parameters
    ----------
    name
        Which experiment; or a file of your own (.toml), which is checked and shown.
    out
        Folder for the comparison: report.md, verdicts.csv, figure and data; new, or to be continued.
    surface
        Scans of your own, with units, in place of surfaces that are made: each is one sample. For fractures,
        the apertures of each specimen in order: numbers or pictures.
    record
        File of the measured record, for experiments whose record is not in the package.
    """
    work.check()
    from asperity_research.commands import experiment as experimenting

    if name is None:
        experimenting.say_experiments()
    elif out is None:
        experimenting.say_experiment(name)
    else:
        experimenting.compare(name, out, surface or (), record, ensembles, work)
