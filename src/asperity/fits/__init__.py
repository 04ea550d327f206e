"""Fits of laws of growth, with uncertainties, to simulated or measured areas."""

from asperity.base.calls import answered as _answered
from asperity.fits import rows as rows  # defines MeasuredGrowth.rows
from asperity.fits.comparison import Comparison, compare
from asperity.fits.laws import LogarithmFit, SaturationFit, logarithm, saturation
from asperity.fits.measured import MeasuredGrowth, measured_growth
from asperity.fits.measurements import Measurements, read_measurements
from asperity.fits.power import PowerLawFit, local_exponent, power_law
from asperity.fits.rate import GrowthRate, growth_rate
from asperity.fits.resampling import EnsembleFit, Estimate, ensemble, jackknife
from asperity.fits.result import FitResult

__all__ = [
    "Comparison",
    "EnsembleFit",
    "Estimate",
    "FitResult",
    "GrowthRate",
    "LogarithmFit",
    "MeasuredGrowth",
    "Measurements",
    "PowerLawFit",
    "SaturationFit",
    "compare",
    "ensemble",
    "growth_rate",
    "jackknife",
    "local_exponent",
    "logarithm",
    "measured_growth",
    "power_law",
    "read_measurements",
    "saturation",
]
__dir__ = _answered(globals())
