"""FlegX: what the thesis prints, what its parameters give, and the friction pole.

Run with ``python examples/flegx_gains.py``.
"""

from bondgraph import derive, linearise
from flegx_models import gains
from flegx_models.models import lowerleg_flight, lowerleg_stance
from flegx_models.parameters import PRINTED, RECONCILED


def main() -> None:
    print("Derived from the drawings, in symbols:")
    for factory in (lowerleg_flight, lowerleg_stance):
        system = linearise(derive(factory().finish()))
        transfer_function = system.transfer_function("theta", "T_motor")
        print(f"  {factory.__name__}: gain = {transfer_function.gain}")

    print("\nWhat RECONCILED changes, and why:")
    for parameter in RECONCILED.members:
        printed = PRINTED[parameter.name]
        if parameter != printed:
            before = "not printed" if printed.value is None else f"{printed.value:g}"
            print(
                f"  {parameter.name}: {before} -> {parameter.value:g} {parameter.unit}"
            )
            print(f"    {parameter.source.reason}")

    print("\nPrinted and derived:")
    print(gains.as_text(gains.table()))


if __name__ == "__main__":
    main()
