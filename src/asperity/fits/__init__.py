"""Fits of laws of growth, with uncertainties, to simulated or measured areas."""

from asperity.base.calls import answered as _answered
from asperity.fits.comparison import Comparison as Comparison
from asperity.fits.comparison import compare as compare
from asperity.fits.laws import LogarithmFit as LogarithmFit
from asperity.fits.laws import SaturationFit as SaturationFit
from asperity.fits.laws import logarithm as logarithm
from asperity.fits.laws import saturation as saturation
from asperity.fits.measured import MeasuredGrowth as MeasuredGrowth
from asperity.fits.measured import measured_growth as measured_growth
from asperity.fits.measurements import Measurements as Measurements
from asperity.fits.measurements import read_measurements as read_measurements
from asperity.fits.power import PowerLawFit as PowerLawFit
from asperity.fits.power import local_exponent as local_exponent
from asperity.fits.power import power_law as power_law
from asperity.fits.rate import GrowthRate as GrowthRate
from asperity.fits.rate import growth_rate as growth_rate
from asperity.fits.resampling import EnsembleFit as EnsembleFit
from asperity.fits.resampling import Estimate as Estimate
from asperity.fits.resampling import ensemble as ensemble
from asperity.fits.resampling import jackknife as jackknife
from asperity.fits.result import FitResult as FitResult

__dir__ = _answered(globals())
