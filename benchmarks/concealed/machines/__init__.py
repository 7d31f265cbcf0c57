"""The machines by name."""

from benchmarks.concealed.machine import Machine
from benchmarks.concealed.machines.dc_motor import DC_MOTOR
from benchmarks.concealed.machines.pendulum import PENDULUM
from benchmarks.concealed.machines.two_mass_drive import TWO_MASS_DRIVE
from benchmarks.concealed.machines.two_tanks import TWO_TANKS

MACHINES: dict[str, Machine] = {
    machine.name: machine for machine in (PENDULUM, TWO_MASS_DRIVE, DC_MOTOR, TWO_TANKS)
}
