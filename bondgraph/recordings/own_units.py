"""How large an error is, in the unit that the recording has.

A model computes in SI; who recorded millimetres of mercury reads those.
"""

from collections.abc import Sequence

from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.units import conversion


def own_unit(
    recordings: Sequence[BoundRecording], output: str, unit: str
) -> tuple[float, str]:
    """Return what a size of an output in `unit` is times in its recordings' own unit.

    Of sizes and differences, not of values: a kelvin is a degree Celsius. Where the
    recordings have several units, or none that is known, it stays in `unit`.
    """
    own = {
        dict(zip(one.output_names, one.recorded_units, strict=False)).get(output, "")
        for one in recordings
    }
    if len(own) != 1 or not all(own):
        return 1.0, unit
    (recorded,) = own
    return conversion(unit, recorded)[0], recorded
