"""Laws of the growth of the contact area, fitted with uncertainties."""

from asperity.fits.laws import LogarithmFit, SaturationFit, logarithm, saturation

__all__ = ["LogarithmFit", "SaturationFit", "logarithm", "saturation"]
