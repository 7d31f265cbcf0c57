"""A picture as PNG, painted by resvg (the extra ``png``): one wheel, no libraries."""

import re

from bondgraph.errors import BondGraphError, MissingExtraError

MOST_PIXELS = 2e8  # beyond that the picture is not looked at, but fills the memory


def png_of(svg: str, scale: float) -> bytes:
    """Return an SVG picture as PNG.

    Parameters
    ----------
    svg
        The picture, its size in pixels at its root.
    scale
        Pixels of the PNG per pixel of the SVG.

    Raises
    ------
    MissingExtraError
        If resvg is not installed.
    BondGraphError
        If the PNG would be empty or too large to hold.
    """
    try:
        import resvg_py  # noqa: PLC0415  (optional)
    except ImportError:
        raise MissingExtraError(
            "A PNG needs resvg-py, which is not installed.",
            ("resvg-py",),
            "Install bondgraph-workbench[png], or draw an SVG.",
        ) from None
    size = re.search(r'width="(\d+)" height="(\d+)"', svg)
    assert size is not None
    pixels = scale**2 * int(size[1]) * int(size[2])
    if not 1 <= pixels <= MOST_PIXELS:
        raise BondGraphError(
            f"At scale {scale:g} the PNG would have {pixels:.2g} pixels.",
            (),
            "Choose a scale of 1 to 4, or for a very large graph an SVG.",
        )
    return bytes(resvg_py.svg_to_bytes(svg_string=svg, zoom=scale))
