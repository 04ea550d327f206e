"""The commands, and the one place where errors become words.

Exit status: 0 for success, 2 for bad input, 1 for any other failure, 130 when interrupted or
terminated. The engine is imported inside the commands, so that help and mistakes in the arguments appear
at once.
"""

from __future__ import annotations

import logging
import shlex
import signal
import sys
import threading
import warnings
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter
from cyclopts.exceptions import CoercionError, CycloptsError, UnknownCommandError, UnknownOptionError

from asperity.app.cli.command import app, command
from asperity.app.cli.flags import Flags, Open, Out, Quiet, Switch, Whole, flags_for, given
from asperity.app.cli.opening import open_results
from asperity.app.cli.options import FitFlags, FrictionFlags, PredictFlags, Work
from asperity.app.cli.terminal import complain, make_streams_safe, silence_output
from asperity.base.words import closest, has_decimal_comma
from asperity.errors import AsperityError, ConfigError, InputError, Remark

__all__ = ["flags_for", "main"]  # annotations that `command` writes name flags_for

_PREDICT, _FIT, _FRICTION, _WORK = PredictFlags(), FitFlags(), FrictionFlags(), Work()


@command("surface", "preparation", "solid", "contact", "aging", "friction", "output")
def run(
    config: Path | None = None,
    /,
    *,
    out: Out = Path("asperity-out"),
    overwrite: Switch = False,
    quiet: Quiet = False,
    show: Open = False,
    leg: Annotated[list[str] | None, Parameter(negative=(), show_default=False)] = None,
    keys: Flags | None = None,
) -> None:
    """Press an elastic solid onto a rough surface and let the contact age.

    Without arguments: a Gaussian surface of 200 x 200 sites, k1/k0 = 3, nine decades of hold time.
    Flags override the configuration file, whose sections are the groups below. On a half-space or a layer,
    numbers may carry units where the surface has some: --modulus 3.8GPa --pressure "1 MPa".

    Parameters
    ----------
    config
        Configuration, a TOML file; a run writes its own to the results as config.toml.
    out
        Folder for the results, which appears when all is written; it must not exist yet.
    overwrite
        Replace the results of an earlier run.
    quiet
        Print neither progress nor summary.
    show
        Open the picture of the results when they are written.
    leg
        A leg of the history of the load or the separation, as often as there are legs: "hold 10",
        "ramp 5 load=400", "step load=160", "hold 100 hold=area", "slide distance=20 velocity=0.1",
        "repeat 3" (the legs so far).
        [default: one hold]
    """
    flags = given(keys)
    from asperity.app.config.legs import legs_from_words
    from asperity.app.config.reading import read_config

    if leg:
        flags["protocol"] = {"legs": legs_from_words(leg)}

    settings = read_config(config, flags)
    from asperity.app.cli.run import run as run_it

    run_it(settings, out=out, overwrite=overwrite, quiet=quiet)
    if show:
        open_results(out)


@command("prediction")
def predict(
    material: Path | None = None,
    /,
    *,
    surface: Path | None = None,
    ramp: Annotated[str | None, Parameter(metavar="QUANTITY")] = None,
    wanted: PredictFlags = _PREDICT,
    out: Out = Path("prediction"),
    overwrite: Switch = False,
    quiet: Quiet = False,
    show: Open = False,
    keys: Flags | None = None,
) -> None:
    """Predict how the real contact grows, from a material, a scan and a load that stays.

    Quantities are numbers with their units: --pressure 1MPa --last "10 days" --temperature -40degC.

    The result is a folder with a page to read, prediction.html, tables and pictures. Beyond the edges of the
    scan comes its mirror image unless --periodic says otherwise; each contact is counted once. Slides and
    loads that change are for asperity run.

    Parameters
    ----------
    material
        Table of relaxation modulus or creep compliance against time, or of storage and loss modulus against
        frequency; the names of its columns say which, and the units: time_s, E_MPa. Or a TOML file as for
        asperity run, which flags override. Without: a half-space of --young and --branch or --creep.
    surface
        The scan: a surface file of an instrument, a .npy array, or a text matrix, with units.
    ramp
        Time within which the load is put on, in proportion to time, such as 2.4s; all times count from its
        start. [default: at once]
    out
        Folder for the results, which appears when all is written; it must not exist yet.
    overwrite
        Replace the results of an earlier prediction.
    quiet
        Print neither progress nor summary.
    show
        Open the page of the results when they are written.
    """
    flags = given(keys, units=True)
    if surface is not None:
        flags["surface"] = {**flags.get("surface", {}), "path": str(surface)}
    from asperity.app.cli.predict import predict as predict_it

    predict_it(material, flags, wanted, ramp=ramp, out=out, overwrite=overwrite, quiet=quiet)
    if show:
        open_results(out)


@command("preparation", name="surface")
def show_surface(
    file: Path, /, *, out: Out | None = None, overwrite: Switch = False, keys: Flags | None = None
) -> None:
    """Say what a surface file holds and what a run would make of it, and draw it.

    Parameters
    ----------
    file
        A surface file of an instrument, a .npy array, or a text matrix.
    out
        Figure to write (.png, .pdf or .svg); by default the file's name with .png, in the current folder.
    overwrite
        Replace the figure if it exists.
    """
    from asperity.app.cli.new_files import FIGURE_SUFFIXES, check_new_file
    from asperity.app.config.reading import file_surface

    settings = file_surface(file, given(keys).get("surface", {}))
    target = Path(f"{file.stem}.png") if out is None else out
    check_new_file("--out", target, FIGURE_SUFFIXES, overwrite=overwrite)
    from asperity.app.cli.show import show  # takes seconds

    show(settings, target)


@command(name="fit")
def fit_table(file: Path, /, *, wanted: FitFlags = _FIT) -> None:
    """Fit laws of growth to measured values against hold time: contact area, or static friction.

    A value at time 0, if there is one, is taken as exact; several, or one with a standard error, are
    measurements like others.

    Parameters
    ----------
    file
        A table: two columns or more, separated by anything; also the aging.csv of a run. Lines
        beginning with #, % or ; are comments.
    """
    from asperity.app.cli.fit import fit

    fit(file, wanted)


@command()
def friction(
    records: list[Path],
    /,
    *,
    wanted: FrictionFlags = _FRICTION,
    out: Out = Path("friction"),
    overwrite: Switch = False,
    quiet: Quiet = False,
    show: Open = False,
) -> None:
    """Fit rate-and-state friction to records of sliding with holds or velocity steps.

    The result is a folder with the parameters a, b, D_c, mu_0 and V_0, their 95 % intervals and units, for
    codes of earthquakes (friction.toml, friction.csv), a picture, and a verdict on the aging law against
    the slip law.

    Parameters
    ----------
    records
        The folder of a run that slid, or of a campaign over seeds; or a table of time, velocity or
        displacement, and friction (or shear and normal stress or force), with units in its header: time_s,
        displacement_um, friction. Several are surfaces under one protocol; their scatter gives the intervals.
    out
        Folder for the results, which appears when all is written; it must not exist yet.
    overwrite
        Replace the results of an earlier fit.
    quiet
        Print nothing.
    show
        Open the picture of the results when they are written.
    """
    from asperity.app.cli.friction import friction as fit_friction

    fit_friction(records, wanted, out=out, overwrite=overwrite, quiet=quiet)
    if show:
        open_results(out)


@command()
def sweep(plan: Path, /, *, out: Out, work: Work = _WORK) -> None:
    """Do a campaign: many runs from one file, in one folder. The same command again does what is missing.

    Parameters
    ----------
    plan
        A TOML file as for a run, with a section [sweep] of lists: load = [200.0, 800.0], seeds = 32, ...
    out
        Folder of the campaign; made, or gone on with.
    """
    work.check()
    from asperity.app.campaign import read_plan
    from asperity.app.cli import campaign

    settings = read_plan(plan)
    (campaign.dry_run if work.dry_run else campaign.sweep)(settings, out, work)


@command()
def status(out: Path, /) -> None:
    """Say how many runs of a campaign are done, running, failed (and why), and left.

    Parameters
    ----------
    out
        Folder of the campaign.
    """
    _check_campaign("status", out)
    from asperity.app.cli import campaign

    campaign.status(out)


@command()
def gather(out: Path, /, *, to: Path | None = None, overwrite: Switch = False) -> None:
    """Gather a campaign into one Dataset with ensemble means, a table (CSV) of its runs, and a figure.

    Parameters
    ----------
    out
        Folder of the campaign.
    to
        Name to write, ending in .zarr, or in .nc for netCDF; table and figure go beside it.
        [default: gathered.zarr in the folder]
    overwrite
        Replace what was gathered there.
    """
    _check_campaign("gather", out)
    from asperity.app.cli import campaign

    campaign.gather(out, to=to, overwrite=overwrite)


@command()
def explore(
    folder: Path | None = None,
    /,
    *,
    port: Whole | None = None,
    no_browser: Switch = False,
    export: Path | None = None,
    overwrite: Switch = False,
) -> None:
    """Show a page on which contacts age, in the browser of this machine, or write it to a file.

    Without a folder: choose a surface, a solid and a load, press, and watch. With the folder of a run, a
    prediction or a campaign, or of several: what they found. Ctrl-C ends it.

    Parameters
    ----------
    folder
        Folder of results to show.
    port
        Port to listen on. [default: the first free one from 8765]
    no_browser
        Only print the address.
    export
        File to write (.html) in place of all that: the page with the results of the folder, which opens
        anywhere without a server.
    overwrite
        Replace that file if it exists.
    """
    from asperity.app.cli import explore as door

    if export is not None:
        door.export(folder, export, overwrite=overwrite)
    else:
        door.explore(folder, port=port, browser=not no_browser)


def _check_campaign(command: str, out: Path) -> None:
    """Say what else a folder is that is no campaign's."""
    if (out / "plan.json").exists():  # what was gathered there has a seed, as a study has
        return
    word = shlex.quote(str(out))
    if (out / "studies").is_dir():
        raise InputError(
            command,
            expected="the folder of a campaign",
            got=f"{out}, that of a reproduction",
            advice=f"asperity {command} {word}/studies/NAME for one of its studies, "
            f"or asperity reproduce --out {word} for what is missing",
        )
    if inside := next((path.parent for path in out.glob("*/seed")), None):
        raise InputError(
            command,
            expected="the folder of a campaign",
            got=f"{out}, that of a study",
            advice=f"asperity {command} {shlex.quote(str(inside))}/CAMPAIGN",
        )
    if (out / "history.zarr").is_dir():
        got = f"{out}, that of a run"
        raise InputError(command, expected="the folder of a campaign", got=got, advice="its summary.txt")


@command(name="--install-completion")
def install_completion(*, shell: Literal["bash", "zsh", "fish", "powershell"] | None = None) -> None:
    """Let the shell complete commands and flags at the Tab key, from its next start on.

    Parameters
    ----------
    shell
        Which shell. [default: the one that this runs in]
    """
    from cyclopts.completion.detect import ShellDetectionError

    try:
        path = app.install_completion(shell=shell)
    except ShellDetectionError:
        advice = "--install-completion --shell bash"
        raise InputError("--shell", expected="a shell", got="none that is known", advice=advice) from None
    print(f"written {path}; completion begins with the next shell")


for _found in entry_points(group="asperity.commands"):
    _found.load()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments
        The words after ``asperity``; by default those of the process.

    Returns
    -------
    int
        The exit status.
    """
    make_streams_safe()
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where it keeps its fonts is no user's concern
    with warnings.catch_warnings():
        warnings.showwarning = _show_warning
        in_main = threading.current_thread() is threading.main_thread()
        if in_main and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends with what Ctrl-C says
        return _run(sys.argv[1:] if arguments is None else list(arguments))


def _run(arguments: list[str]) -> int:
    try:
        app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
    except CycloptsError as error:
        return _complain(2, _usage(error))
    except ConfigError as error:
        return _complain(2, *error.shown)
    except InputError as error:
        return _complain(2, str(error))
    except AsperityError as error:
        return _complain(1, str(error))
    except BrokenPipeError:
        silence_output()
        return 1
    except OSError as error:
        return _complain(
            1, f"{error.filename}: {error.strerror}" if error.filename else error.strerror or str(error)
        )
    except MemoryError as error:
        return _complain(1, f"not enough memory: {error or 'try a smaller surface'}")
    except KeyboardInterrupt as interrupt:
        return _complain(130, str(interrupt) or "interrupted; nothing was written")
    return 0


def _show_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, *_: Any, **__: Any
) -> None:
    """Print a remark as one line, and any other warning as Python does."""
    if issubclass(category, Remark):
        print("remark:", " ".join(str(message).split()), file=sys.stderr)
    else:
        sys.stderr.write(warnings.formatwarning(message, category, filename, lineno))


def _complain(status: int, *problems: str) -> int:
    complain(*problems)
    return status


_NO_SUCH_FLAG = {
    "--E": "; the elastic constants are --k0 and --k1, or --modulus of --solid half_space",
    "--leg": "; legs and slides are for asperity run",
    "--half-space": "; try --solid half_space --modulus 3.8GPa",
    "--activation-energy": "; that of creep is --creep-energy",
    "--activation-volume": "; that of creep is --creep-volume",
}
"""What is said of flags that people expect, and that there are not."""


_OF_RESEARCH = ("challenge", "reproduce", "study")
"""Commands of the distribution asperity-research."""


def _usage(error: CycloptsError) -> str:
    """Spell an error of the arguments, with a way out."""
    text = str(error).rstrip(".")
    if isinstance(error, UnknownOptionError):
        flag = (error.token.keyword or error.token.value).split("=")[0]
        known = [name for argument in error.argument_collection if argument.parse for name in argument.names]
        text = f"unknown option {flag}{_NO_SUCH_FLAG.get(flag) or _meant(flag, known)}"
    elif isinstance(error, UnknownCommandError):
        commands = [name for name in app if not name.startswith("-")]
        word = (error.unused_tokens or [""])[0]
        if word in _OF_RESEARCH:
            return f"asperity {word} comes with asperity-research; try pip install asperity-research"
        text = f"unknown command {word}{_meant(word, commands)}; there are {', '.join(commands)}"
    elif error.unused_tokens and "Unused Tokens" in text:
        text = f"too many arguments: {' '.join(error.unused_tokens)}"
    elif (
        isinstance(error, CoercionError)
        and error.token
        and error.target_type is float
        and has_decimal_comma(error.token.value)
    ):
        text += f"; try {error.token.value.replace(',', '.')}"
    return f"{text} (see asperity --help)"


def _meant(word: str, known: Sequence[str]) -> str:
    dashes = word[: len(word) - len(word.lstrip("-"))]
    meant = closest(word.lstrip("-"), [name.lstrip("-") for name in known if name.startswith(dashes or name)])
    return f"; did you mean {dashes}{meant}?" if meant else ""
