"""The machines by name."""

from benchmarks.concealed.machine import Machine
from benchmarks.concealed.machines.cart import CART
from benchmarks.concealed.machines.cart_pendulum import CART_PENDULUM
from benchmarks.concealed.machines.cylinder import CYLINDER
from benchmarks.concealed.machines.dc_motor import DC_MOTOR
from benchmarks.concealed.machines.flegx_drive import FLEGX_DRIVE
from benchmarks.concealed.machines.mass_chain import MASS_CHAIN
from benchmarks.concealed.machines.pendulum import PENDULUM
from benchmarks.concealed.machines.planar_leg import PLANAR_LEG
from benchmarks.concealed.machines.rlc_circuit import RLC_CIRCUIT
from benchmarks.concealed.machines.thermal_zones import THERMAL_ZONES
from benchmarks.concealed.machines.two_mass_drive import TWO_MASS_DRIVE
from benchmarks.concealed.machines.two_tanks import TWO_TANKS

MACHINES: dict[str, Machine] = {
    machine.name: machine
    for machine in (
        FLEGX_DRIVE,
        TWO_MASS_DRIVE,
        DC_MOTOR,
        PENDULUM,
        CART,
        MASS_CHAIN,
        TWO_TANKS,
        CYLINDER,
        RLC_CIRCUIT,
        THERMAL_ZONES,
        PLANAR_LEG,
        CART_PENDULUM,
    )
}
