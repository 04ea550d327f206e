"""Thumbnails of the gallery: of several panels the first map, else the first with a labeled axis."""

import matplotlib.pyplot as plt
from matplotlib.transforms import Bbox
from sphinx_gallery.scrapers import matplotlib_scraper

SIZE = 4.0, 2.8
"""Of a picture with one panel, in inches: small, so that its text is large."""


def scraper(block, block_vars, gallery_conf):
    """Save one panel as the first image, which becomes the thumbnail, and then the pictures as usual."""
    paths = block_vars["image_path_iterator"]
    if plt.get_fignums() and not len(paths):
        figure = plt.figure(plt.get_fignums()[0])
        size, panels = figure.get_size_inches(), main(figure)
        if len(panels) == 1 and not panels[0].images:
            figure.set_size_inches(SIZE)
        for _ in range(2):  # the second time the layout is settled
            figure.draw_without_rendering()
        figure.savefig(next(paths), dpi=160, bbox_inches=box(figure, panels))
        figure.set_size_inches(size)
    return matplotlib_scraper(block, block_vars, gallery_conf)


def main(figure):
    """Panels without the color bars."""
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]


def box(figure, panels):
    """Box in inches of one panel with its color bar, less what belongs to all panels."""
    if len(panels) == 1:
        return "tight"
    labeled = next((axes for axes in panels if axes.get_xlabel()), panels[0])
    axes = next((axes for axes in panels if axes.images), labeled)
    bars = [bar.ax for image in axes.images if (bar := image.colorbar)]
    frame = Bbox.union([part.get_tightbbox() for part in (axes, *bars)]).padded(2)
    return frame.transformed(figure.dpi_scale_trans.inverted())
