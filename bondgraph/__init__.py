"""bondgraph: from a drawn machine to its equations, its fit and what it leaves out.

The public names are imported on first use, so that ``import bondgraph`` stays quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_HOME = {
    "bondgraph.structure.builder": ("BondGraph",),
    "bondgraph.structure.graph": ("CausalPreference", "FinishedGraph", "Wanted"),
    "bondgraph.structure.elements": (
        "ZeroJunction",
        "OneJunction",
        *("Se", "Sf", "I", "C", "R", "TF", "GY"),
        *("MSe", "MSf", "MTF", "MGY", "MR"),
    ),
    "bondgraph.structure.fields": ("IField", "CField", "ICField", "RField"),
    "bondgraph.structure.detectors": ("De", "Df", "Dp", "Dq"),
    "bondgraph.structure.subgraphs": ("SubGraph",),
    "bondgraph.structure.signals": (
        *("e", "f", "p", "q", "t"),
        *("effort", "flow", "momentum", "displacement", "port", "ports"),
    ),
    "bondgraph.structure.parameters": (
        *("Parameter", "ParameterSet"),
        *("Assumed", "Measured", "Published", "Fitted", "Reconciled"),
    ),
    "bondgraph.structure.edits": (
        "InsertElement",
        "ReplaceRelation",
        "ReplaceMeasurement",
        "ConnectJunctions",
        "LoosenBond",
        "ObstructBond",
        "SeveralEdits",
        "SignalState",
        "WrapInput",
    ),
    "bondgraph.causality.assignment": ("assign_causality",),
    "bondgraph.equations.derivation": ("derive",),
    "bondgraph.equations.linear": (
        "LinearSystem",
        "linearise",
    ),
    "bondgraph.equations.rendering": ("as_text", "as_latex"),
    "bondgraph.numeric.state_space": (
        "SparseStateSpace",
        "sparse_state_space",
        *("StateSpace", "state_space"),
        *("to_control", "transfer_function_to_control"),
    ),
    "bondgraph.recordings.reading": ("read_recording",),
    "bondgraph.recordings.frames": ("from_pandas", "from_xarray"),
    "bondgraph.recordings.recording": ("Recording",),
    "bondgraph.recordings.binding": ("BoundRecording", "bind"),
    "bondgraph.recordings.model_channels": ("bind_to", "read_for"),
    "bondgraph.recordings.clocks": ("ClockOffset", "clock_offset", "on_one_clock"),
    "bondgraph.recordings.resampling": ("resample",),
    "bondgraph.recordings.noise": ("NoiseEstimate", "estimate_noise"),
    "bondgraph.recordings.windows": ("split",),
    "bondgraph.simulation.solvers": (
        "Hold",
        "Sdirk2",
        "Sdirk3",
        "RungeKutta4",
    ),
    "bondgraph.fitting.horizon": (
        *("Automatic", "Seconds", "WholeRecordings", "Windows"),
    ),
    "bondgraph.fitting.estimate": ("FitSettings", "fit"),
    "bondgraph.fitting.result": ("FitResult", "FitStatus"),
    "bondgraph.fitting.simulate": ("Solution", "SolveStatus", "simulate"),
    "bondgraph.diagnosis.diagnose": ("Options", "diagnose"),
    "bondgraph.diagnosis.records": (
        "Diagnosis",
        "Verdict",
        "LawCurve",
    ),
    "bondgraph.reporting.drawing": (
        "draw_png",
        "Colouring",
        "BondLabels",
        "Theme",
        "draw_svg",
    ),
    "bondgraph.reporting.diagnosis_json": ("diagnosis_to_dict", "write_json"),
    "bondgraph.reporting.model_text": ("to_python",),
    "bondgraph.reporting.report": ("report_html", "write_report"),
    "bondgraph.checking.run": ("run_checks",),
    "bondgraph.loading": ("load_model",),
    "bondgraph.notebook": (
        "load_ipython_extension",
        "as_html",
    ),
    "bondgraph.equations.energy": (
        "energy",
        "EnergyBalance",
    ),
    "bondgraph.equations.port_hamiltonian": (
        "port_hamiltonian",
        "PortHamiltonian",
    ),
    "bondgraph.equations.invariants": (
        "invariants",
        "Invariants",
    ),
    "bondgraph.reporting.export.exporting": (
        "C99",
        "Matlab",
        "Modelica",
        "Latex",
        "PythonControl",
        "PythonFunctions",
        "PythonModel",
        "Json",
        "export",
        "ExportedFile",
    ),
    "bondgraph.reporting.differences": ("describe_difference",),
    "bondgraph.equations.transfer_function": ("TransferFunction",),
    "bondgraph.equations.factors": ("PoleZeroGain",),
    "bondgraph.equations.transfer_matrix": ("TransferMatrix",),
    "bondgraph.equations.descriptor": (
        "descriptor",
        "DescriptorSystem",
    ),
    "bondgraph.equations.sensitivities": (
        "sensitivities",
        "Sensitivities",
    ),
    "bondgraph.equations.steady_state": ("SteadyState",),
    "bondgraph.numeric.steady_state": ("steady_state",),
    "bondgraph.numeric.jacobian": ("jacobian",),
    "bondgraph.numeric.nonlinear_io": ("to_nonlinear_io",),
    "bondgraph.numeric.implicit.matrices": (
        "implicit_state_space",
        "ImplicitStateSpace",
    ),
    "bondgraph.simulation.sparse": (
        "simulate_sparse",
        "SparseSolution",
        "SparseStatus",
    ),
    "bondgraph.loopshaping.measures": (
        "measure",
        "LoopMeasures",
        "Stability",
    ),
    "bondgraph.loopshaping.loop": (
        "Loop",
        "zero_pole_gain",
    ),
    "bondgraph.loopshaping.zero_pole_gain": ("ZeroPoleGain",),
    "bondgraph.loopshaping.controllers": (
        "Gain",
        "Lead",
        "LeadLag",
        "PI",
        "Notch",
        "RollOff",
        "Product",
    ),
    "bondgraph.loopshaping.prototype": ("SecondOrderPrototype",),
    "bondgraph.loopshaping.requirements": (
        "Specification",
        "PhaseMargin",
        "GainMargin",
        "DelayMargin",
        "PeakSensitivity",
        "PeakComplementary",
        "Crossover",
        "NoiseGain",
        "Overshoot",
        "SettlingTime",
    ),
    "bondgraph.loopshaping.sizing": ("Free",),
    "bondgraph.loopshaping.shaping": (
        "shape",
        "Design",
        "DesignStatus",
    ),
    "bondgraph.loopshaping.friction": (
        "FrictionRule",
        "with_friction_pole",
    ),
    "bondgraph.reporting.loop_pictures": (
        "loop_sheet",
        "comparison_sheet",
        "write_picture",
        "SheetRow",
    ),
    "bondgraph.reconciliation.reconcile": ("reconcile",),
    "bondgraph.reconciliation.published": (
        "as_printed",
        "PublishedResult",
    ),
    "bondgraph.reconciliation.records": (
        "Reconciliation",
        "ReconciliationStatus",
        "Explanation",
        "Change",
    ),
    "bondgraph.loopshaping.delivery.feedforward": ("gravity_feedforward",),
    "bondgraph.loopshaping.delivery.anti_windup": (
        *("NoAntiWindup", "Clamping", "BackCalculation"),
    ),
    "bondgraph.loopshaping.delivery.discretise": (
        "Tustin",
        "Matched",
        "ExactHold",
    ),
    "bondgraph.loopshaping.synthesis.structure": ("ControllerStructure",),
    "bondgraph.loopshaping.delivery.sampled_loop": (
        *("simulate_sampled", "Encoder", "LinearPlant"),
    ),
    "bondgraph.loopshaping.synthesis.optimise": ("optimise_controller",),
    "bondgraph.loopshaping.synthesis.family": (
        *("Posterior", "Ranges", "PlantHypothesis", "PlantFamily"),
    ),
    "bondgraph.loopshaping.synthesis.objectives": (
        *("FastestCrossover", "LeastNoise", "BestRejection"),
    ),
    "bondgraph.loopshaping.delivery.c_code": ("controller_to_c99",),
    "bondgraph.loopshaping.synthesis.robust": (
        "robust_controller",
        "robustness",
    ),
    "bondgraph.loopshaping.delivery.arithmetic": (
        "Double",
        "Single",
        "FixedPoint",
    ),
    "bondgraph.loopshaping.delivery.digital": (
        *("digital_controller", "DigitalController"),
    ),
    "bondgraph.loopshaping.synthesis.answer": ("OptimisedController",),
    "bondgraph.loopshaping.synthesis.limits": (
        *("ModulusMargin", "FirstCrossover", "CrossoverAtMost", "PeakNoiseGain"),
        *("ActuatorLimit",),
    ),
    "bondgraph.errors": ("BondGraphError",),
    "bondgraph.physics.hypothesis": (
        "AbstractPhysics",
        "Hypothesis",
        "Passivity",
    ),
    "bondgraph.physics.library": ("LIBRARY",),
    "bondgraph.physics.places.base": (
        "Coefficient",
        "Place",
    ),
    "bondgraph.physics.places.junction": (
        "OneJunctionPlace",
        "ZeroJunctionPlace",
    ),
    "bondgraph.physics.places.bond": ("BondPlace",),
    "bondgraph.physics.places.element": ("ElementPlace",),
    "bondgraph.physics.places.pair": ("PairPlace",),
    "bondgraph.physics.places.channels": (
        "InputPlace",
        "OutputPlace",
    ),
    "bondgraph.physics.places.scales": ("Scales",),
    "bondgraph.physics.places.everywhere": ("all_places",),
    "bondgraph.simulation.run": (
        "Run",
        "simulate_inputs",
    ),
    "bondgraph.simulation.trouble": ("RunStatus",),
    "bondgraph.simulation.energy_audit": ("EnergyAudit",),
    "bondgraph.simulation.events": (
        "Event",
        "EventKind",
    ),
    "bondgraph.simulation.adaptive": (
        "Cvode",
        "Ida",
        "Radau",
    ),
    "bondgraph.simulation.engines": (
        "Interpreted",
        "Native",
        "WhenItPays",
    ),
    "bondgraph.simulation.batch": (
        "Batch",
        "SetStatus",
        "simulate_batch",
    ),
    "bondgraph.fitting.strategy": (
        "Direct",
        "GrowingWindows",
        "MultipleShooting",
    ),
    "bondgraph.fitting.starts": (
        "ManyStarts",
        "OneStart",
    ),
    "bondgraph.fitting.loss": (
        "Huber",
        "SquaredError",
        "StudentT",
    ),
    "bondgraph.fitting.noise": (
        "AutoregressiveNoise",
        "WhiteNoise",
    ),
    "bondgraph.fitting.profile": (
        "Profile",
        "ProfileStatus",
        "profile",
    ),
    "bondgraph.fitting.identifiability": (
        "Identifiability",
        "IdentifiabilityStatus",
        "identifiability",
    ),
    "bondgraph.fitting.innovations": (
        "InnovationFit",
        "InnovationStatus",
        "fit_innovations",
    ),
    "bondgraph.fitting.solver_error": (
        "SolverError",
        "SolverErrorStatus",
    ),
    "bondgraph.diagnosis.adequacy.adequacy": ("adequacy",),
    "bondgraph.diagnosis.adequacy.records": (
        "Adequacy",
        "AdequacyStatus",
    ),
    "bondgraph.diagnosis.work.workers": (
        "Here",
        "On",
        "Processes",
    ),
    "bondgraph.diagnosis.location.locate": ("locate",),
    "bondgraph.diagnosis.location.records": (
        "Location",
        "LocationStatus",
        "PlaceEvidence",
    ),
    "bondgraph.diagnosis.separability.separability": ("separability",),
    "bondgraph.diagnosis.separability.records": (
        "Separability",
        "SeparabilityStatus",
    ),
    "bondgraph.diagnosis.experiment.next_experiment": ("next_experiment",),
    "bondgraph.diagnosis.experiment.records": (
        "Experiment",
        "ExperimentStatus",
    ),
    "bondgraph.structure.hard_contact": ("hard_contact",),
    "bondgraph.fitting.kalman_choices": (
        "Extended",
        "Unscented",
    ),
    "bondgraph.physics.descriptions": (
        "Confusion",
        "Description",
        "describe",
    ),
    "bondgraph.progress": ("shown_progress",),
}
_WHERE = {name: home for home, names in _HOME.items() for name in names}

__version__ = "0.1.0"
__all__ = sorted([*_WHERE, "__version__"])  # noqa: PLE0605

if TYPE_CHECKING:
    from bondgraph.causality.assignment import assign_causality as assign_causality
    from bondgraph.checking.run import run_checks as run_checks
    from bondgraph.diagnosis.adequacy.adequacy import adequacy as adequacy
    from bondgraph.diagnosis.adequacy.records import Adequacy as Adequacy
    from bondgraph.diagnosis.adequacy.records import AdequacyStatus as AdequacyStatus
    from bondgraph.diagnosis.diagnose import Options as Options
    from bondgraph.diagnosis.diagnose import diagnose as diagnose
    from bondgraph.diagnosis.experiment.next_experiment import (
        next_experiment as next_experiment,
    )
    from bondgraph.diagnosis.experiment.records import Experiment as Experiment
    from bondgraph.diagnosis.experiment.records import (
        ExperimentStatus as ExperimentStatus,
    )
    from bondgraph.diagnosis.location.locate import locate as locate
    from bondgraph.diagnosis.location.records import Location as Location
    from bondgraph.diagnosis.location.records import LocationStatus as LocationStatus
    from bondgraph.diagnosis.location.records import PlaceEvidence as PlaceEvidence
    from bondgraph.diagnosis.records import Diagnosis as Diagnosis
    from bondgraph.diagnosis.records import LawCurve as LawCurve
    from bondgraph.diagnosis.records import Verdict as Verdict
    from bondgraph.diagnosis.separability.records import Separability as Separability
    from bondgraph.diagnosis.separability.records import (
        SeparabilityStatus as SeparabilityStatus,
    )
    from bondgraph.diagnosis.separability.separability import (
        separability as separability,
    )
    from bondgraph.diagnosis.work.workers import Here as Here
    from bondgraph.diagnosis.work.workers import On as On
    from bondgraph.diagnosis.work.workers import Processes as Processes
    from bondgraph.equations.derivation import derive as derive
    from bondgraph.equations.descriptor import DescriptorSystem as DescriptorSystem
    from bondgraph.equations.descriptor import descriptor as descriptor
    from bondgraph.equations.energy import EnergyBalance as EnergyBalance
    from bondgraph.equations.energy import energy as energy
    from bondgraph.equations.factors import PoleZeroGain as PoleZeroGain
    from bondgraph.equations.invariants import Invariants as Invariants
    from bondgraph.equations.invariants import invariants as invariants
    from bondgraph.equations.linear import LinearSystem as LinearSystem
    from bondgraph.equations.linear import linearise as linearise
    from bondgraph.equations.port_hamiltonian import PortHamiltonian as PortHamiltonian
    from bondgraph.equations.port_hamiltonian import (
        port_hamiltonian as port_hamiltonian,
    )
    from bondgraph.equations.rendering import as_latex as as_latex
    from bondgraph.equations.rendering import as_text as as_text
    from bondgraph.equations.sensitivities import Sensitivities as Sensitivities
    from bondgraph.equations.sensitivities import sensitivities as sensitivities
    from bondgraph.equations.steady_state import SteadyState as SteadyState
    from bondgraph.equations.transfer_function import (
        TransferFunction as TransferFunction,
    )
    from bondgraph.equations.transfer_matrix import TransferMatrix as TransferMatrix
    from bondgraph.errors import BondGraphError as BondGraphError
    from bondgraph.fitting.estimate import FitSettings as FitSettings
    from bondgraph.fitting.estimate import fit as fit
    from bondgraph.fitting.horizon import Automatic as Automatic
    from bondgraph.fitting.horizon import Seconds as Seconds
    from bondgraph.fitting.horizon import WholeRecordings as WholeRecordings
    from bondgraph.fitting.horizon import Windows as Windows
    from bondgraph.fitting.identifiability import Identifiability as Identifiability
    from bondgraph.fitting.identifiability import (
        IdentifiabilityStatus as IdentifiabilityStatus,
    )
    from bondgraph.fitting.identifiability import identifiability as identifiability
    from bondgraph.fitting.innovations import InnovationFit as InnovationFit
    from bondgraph.fitting.innovations import InnovationStatus as InnovationStatus
    from bondgraph.fitting.innovations import fit_innovations as fit_innovations
    from bondgraph.fitting.kalman_choices import Extended as Extended
    from bondgraph.fitting.kalman_choices import Unscented as Unscented
    from bondgraph.fitting.loss import Huber as Huber
    from bondgraph.fitting.loss import SquaredError as SquaredError
    from bondgraph.fitting.loss import StudentT as StudentT
    from bondgraph.fitting.noise import AutoregressiveNoise as AutoregressiveNoise
    from bondgraph.fitting.noise import WhiteNoise as WhiteNoise
    from bondgraph.fitting.profile import Profile as Profile
    from bondgraph.fitting.profile import ProfileStatus as ProfileStatus
    from bondgraph.fitting.profile import profile as profile
    from bondgraph.fitting.result import FitResult as FitResult
    from bondgraph.fitting.result import FitStatus as FitStatus
    from bondgraph.fitting.simulate import Solution as Solution
    from bondgraph.fitting.simulate import SolveStatus as SolveStatus
    from bondgraph.fitting.simulate import simulate as simulate
    from bondgraph.fitting.solver_error import SolverError as SolverError
    from bondgraph.fitting.solver_error import SolverErrorStatus as SolverErrorStatus
    from bondgraph.fitting.starts import ManyStarts as ManyStarts
    from bondgraph.fitting.starts import OneStart as OneStart
    from bondgraph.fitting.strategy import Direct as Direct
    from bondgraph.fitting.strategy import GrowingWindows as GrowingWindows
    from bondgraph.fitting.strategy import MultipleShooting as MultipleShooting
    from bondgraph.loading import load_model as load_model
    from bondgraph.loopshaping.controllers import PI as PI
    from bondgraph.loopshaping.controllers import Gain as Gain
    from bondgraph.loopshaping.controllers import Lead as Lead
    from bondgraph.loopshaping.controllers import LeadLag as LeadLag
    from bondgraph.loopshaping.controllers import Notch as Notch
    from bondgraph.loopshaping.controllers import Product as Product
    from bondgraph.loopshaping.controllers import RollOff as RollOff
    from bondgraph.loopshaping.delivery.anti_windup import (
        BackCalculation as BackCalculation,
    )
    from bondgraph.loopshaping.delivery.anti_windup import Clamping as Clamping
    from bondgraph.loopshaping.delivery.anti_windup import NoAntiWindup as NoAntiWindup
    from bondgraph.loopshaping.delivery.arithmetic import Double as Double
    from bondgraph.loopshaping.delivery.arithmetic import FixedPoint as FixedPoint
    from bondgraph.loopshaping.delivery.arithmetic import Single as Single
    from bondgraph.loopshaping.delivery.c_code import (
        controller_to_c99 as controller_to_c99,
    )
    from bondgraph.loopshaping.delivery.digital import (
        DigitalController as DigitalController,
    )
    from bondgraph.loopshaping.delivery.digital import (
        digital_controller as digital_controller,
    )
    from bondgraph.loopshaping.delivery.discretise import ExactHold as ExactHold
    from bondgraph.loopshaping.delivery.discretise import Matched as Matched
    from bondgraph.loopshaping.delivery.discretise import Tustin as Tustin
    from bondgraph.loopshaping.delivery.feedforward import (
        gravity_feedforward as gravity_feedforward,
    )
    from bondgraph.loopshaping.delivery.sampled_loop import Encoder as Encoder
    from bondgraph.loopshaping.delivery.sampled_loop import LinearPlant as LinearPlant
    from bondgraph.loopshaping.delivery.sampled_loop import (
        simulate_sampled as simulate_sampled,
    )
    from bondgraph.loopshaping.friction import FrictionRule as FrictionRule
    from bondgraph.loopshaping.friction import with_friction_pole as with_friction_pole
    from bondgraph.loopshaping.loop import Loop as Loop
    from bondgraph.loopshaping.loop import zero_pole_gain as zero_pole_gain
    from bondgraph.loopshaping.measures import LoopMeasures as LoopMeasures
    from bondgraph.loopshaping.measures import Stability as Stability
    from bondgraph.loopshaping.measures import measure as measure
    from bondgraph.loopshaping.prototype import (
        SecondOrderPrototype as SecondOrderPrototype,
    )
    from bondgraph.loopshaping.requirements import Crossover as Crossover
    from bondgraph.loopshaping.requirements import DelayMargin as DelayMargin
    from bondgraph.loopshaping.requirements import GainMargin as GainMargin
    from bondgraph.loopshaping.requirements import NoiseGain as NoiseGain
    from bondgraph.loopshaping.requirements import Overshoot as Overshoot
    from bondgraph.loopshaping.requirements import (
        PeakComplementary as PeakComplementary,
    )
    from bondgraph.loopshaping.requirements import PeakSensitivity as PeakSensitivity
    from bondgraph.loopshaping.requirements import PhaseMargin as PhaseMargin
    from bondgraph.loopshaping.requirements import SettlingTime as SettlingTime
    from bondgraph.loopshaping.requirements import Specification as Specification
    from bondgraph.loopshaping.shaping import Design as Design
    from bondgraph.loopshaping.shaping import DesignStatus as DesignStatus
    from bondgraph.loopshaping.shaping import shape as shape
    from bondgraph.loopshaping.sizing import Free as Free
    from bondgraph.loopshaping.synthesis.answer import (
        OptimisedController as OptimisedController,
    )
    from bondgraph.loopshaping.synthesis.family import PlantFamily as PlantFamily
    from bondgraph.loopshaping.synthesis.family import (
        PlantHypothesis as PlantHypothesis,
    )
    from bondgraph.loopshaping.synthesis.family import Posterior as Posterior
    from bondgraph.loopshaping.synthesis.family import Ranges as Ranges
    from bondgraph.loopshaping.synthesis.limits import ActuatorLimit as ActuatorLimit
    from bondgraph.loopshaping.synthesis.limits import (
        CrossoverAtMost as CrossoverAtMost,
    )
    from bondgraph.loopshaping.synthesis.limits import FirstCrossover as FirstCrossover
    from bondgraph.loopshaping.synthesis.limits import ModulusMargin as ModulusMargin
    from bondgraph.loopshaping.synthesis.limits import PeakNoiseGain as PeakNoiseGain
    from bondgraph.loopshaping.synthesis.objectives import (
        BestRejection as BestRejection,
    )
    from bondgraph.loopshaping.synthesis.objectives import (
        FastestCrossover as FastestCrossover,
    )
    from bondgraph.loopshaping.synthesis.objectives import LeastNoise as LeastNoise
    from bondgraph.loopshaping.synthesis.optimise import (
        optimise_controller as optimise_controller,
    )
    from bondgraph.loopshaping.synthesis.robust import (
        robust_controller as robust_controller,
    )
    from bondgraph.loopshaping.synthesis.robust import robustness as robustness
    from bondgraph.loopshaping.synthesis.structure import (
        ControllerStructure as ControllerStructure,
    )
    from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain as ZeroPoleGain
    from bondgraph.notebook import as_html as as_html
    from bondgraph.notebook import load_ipython_extension as load_ipython_extension
    from bondgraph.numeric.implicit.matrices import (
        ImplicitStateSpace as ImplicitStateSpace,
    )
    from bondgraph.numeric.implicit.matrices import (
        implicit_state_space as implicit_state_space,
    )
    from bondgraph.numeric.jacobian import jacobian as jacobian
    from bondgraph.numeric.nonlinear_io import to_nonlinear_io as to_nonlinear_io
    from bondgraph.numeric.state_space import SparseStateSpace as SparseStateSpace
    from bondgraph.numeric.state_space import StateSpace as StateSpace
    from bondgraph.numeric.state_space import sparse_state_space as sparse_state_space
    from bondgraph.numeric.state_space import state_space as state_space
    from bondgraph.numeric.state_space import to_control as to_control
    from bondgraph.numeric.state_space import (
        transfer_function_to_control as transfer_function_to_control,
    )
    from bondgraph.numeric.steady_state import steady_state as steady_state
    from bondgraph.physics.descriptions import Confusion as Confusion
    from bondgraph.physics.descriptions import Description as Description
    from bondgraph.physics.descriptions import describe as describe
    from bondgraph.physics.hypothesis import AbstractPhysics as AbstractPhysics
    from bondgraph.physics.hypothesis import Hypothesis as Hypothesis
    from bondgraph.physics.hypothesis import Passivity as Passivity
    from bondgraph.physics.library import LIBRARY as LIBRARY
    from bondgraph.physics.places.base import Coefficient as Coefficient
    from bondgraph.physics.places.base import Place as Place
    from bondgraph.physics.places.bond import BondPlace as BondPlace
    from bondgraph.physics.places.channels import InputPlace as InputPlace
    from bondgraph.physics.places.channels import OutputPlace as OutputPlace
    from bondgraph.physics.places.element import ElementPlace as ElementPlace
    from bondgraph.physics.places.everywhere import all_places as all_places
    from bondgraph.physics.places.junction import OneJunctionPlace as OneJunctionPlace
    from bondgraph.physics.places.junction import ZeroJunctionPlace as ZeroJunctionPlace
    from bondgraph.physics.places.pair import PairPlace as PairPlace
    from bondgraph.physics.places.scales import Scales as Scales
    from bondgraph.progress import shown_progress as shown_progress
    from bondgraph.reconciliation.published import PublishedResult as PublishedResult
    from bondgraph.reconciliation.published import as_printed as as_printed
    from bondgraph.reconciliation.reconcile import reconcile as reconcile
    from bondgraph.reconciliation.records import Change as Change
    from bondgraph.reconciliation.records import Explanation as Explanation
    from bondgraph.reconciliation.records import Reconciliation as Reconciliation
    from bondgraph.reconciliation.records import (
        ReconciliationStatus as ReconciliationStatus,
    )
    from bondgraph.recordings.binding import BoundRecording as BoundRecording
    from bondgraph.recordings.binding import bind as bind
    from bondgraph.recordings.clocks import ClockOffset as ClockOffset
    from bondgraph.recordings.clocks import clock_offset as clock_offset
    from bondgraph.recordings.clocks import on_one_clock as on_one_clock
    from bondgraph.recordings.frames import from_pandas as from_pandas
    from bondgraph.recordings.frames import from_xarray as from_xarray
    from bondgraph.recordings.model_channels import bind_to as bind_to
    from bondgraph.recordings.model_channels import read_for as read_for
    from bondgraph.recordings.noise import NoiseEstimate as NoiseEstimate
    from bondgraph.recordings.noise import estimate_noise as estimate_noise
    from bondgraph.recordings.reading import read_recording as read_recording
    from bondgraph.recordings.recording import Recording as Recording
    from bondgraph.recordings.resampling import resample as resample
    from bondgraph.recordings.windows import split as split
    from bondgraph.reporting.diagnosis_json import (
        diagnosis_to_dict as diagnosis_to_dict,
    )
    from bondgraph.reporting.diagnosis_json import write_json as write_json
    from bondgraph.reporting.differences import (
        describe_difference as describe_difference,
    )
    from bondgraph.reporting.drawing import BondLabels as BondLabels
    from bondgraph.reporting.drawing import Colouring as Colouring
    from bondgraph.reporting.drawing import Theme as Theme
    from bondgraph.reporting.drawing import draw_png as draw_png
    from bondgraph.reporting.drawing import draw_svg as draw_svg
    from bondgraph.reporting.export.exporting import C99 as C99
    from bondgraph.reporting.export.exporting import ExportedFile as ExportedFile
    from bondgraph.reporting.export.exporting import Json as Json
    from bondgraph.reporting.export.exporting import Latex as Latex
    from bondgraph.reporting.export.exporting import Matlab as Matlab
    from bondgraph.reporting.export.exporting import Modelica as Modelica
    from bondgraph.reporting.export.exporting import PythonControl as PythonControl
    from bondgraph.reporting.export.exporting import PythonFunctions as PythonFunctions
    from bondgraph.reporting.export.exporting import PythonModel as PythonModel
    from bondgraph.reporting.export.exporting import export as export
    from bondgraph.reporting.loop_pictures import SheetRow as SheetRow
    from bondgraph.reporting.loop_pictures import comparison_sheet as comparison_sheet
    from bondgraph.reporting.loop_pictures import loop_sheet as loop_sheet
    from bondgraph.reporting.loop_pictures import write_picture as write_picture
    from bondgraph.reporting.model_text import to_python as to_python
    from bondgraph.reporting.report import report_html as report_html
    from bondgraph.reporting.report import write_report as write_report
    from bondgraph.simulation.adaptive import Cvode as Cvode
    from bondgraph.simulation.adaptive import Ida as Ida
    from bondgraph.simulation.adaptive import Radau as Radau
    from bondgraph.simulation.batch import Batch as Batch
    from bondgraph.simulation.batch import SetStatus as SetStatus
    from bondgraph.simulation.batch import simulate_batch as simulate_batch
    from bondgraph.simulation.energy_audit import EnergyAudit as EnergyAudit
    from bondgraph.simulation.engines import Interpreted as Interpreted
    from bondgraph.simulation.engines import Native as Native
    from bondgraph.simulation.engines import WhenItPays as WhenItPays
    from bondgraph.simulation.events import Event as Event
    from bondgraph.simulation.events import EventKind as EventKind
    from bondgraph.simulation.run import Run as Run
    from bondgraph.simulation.run import simulate_inputs as simulate_inputs
    from bondgraph.simulation.solvers import Hold as Hold
    from bondgraph.simulation.solvers import RungeKutta4 as RungeKutta4
    from bondgraph.simulation.solvers import Sdirk2 as Sdirk2
    from bondgraph.simulation.solvers import Sdirk3 as Sdirk3
    from bondgraph.simulation.sparse import SparseSolution as SparseSolution
    from bondgraph.simulation.sparse import SparseStatus as SparseStatus
    from bondgraph.simulation.sparse import simulate_sparse as simulate_sparse
    from bondgraph.simulation.trouble import RunStatus as RunStatus
    from bondgraph.structure.builder import BondGraph as BondGraph
    from bondgraph.structure.detectors import De as De
    from bondgraph.structure.detectors import Df as Df
    from bondgraph.structure.detectors import Dp as Dp
    from bondgraph.structure.detectors import Dq as Dq
    from bondgraph.structure.edits import ConnectJunctions as ConnectJunctions
    from bondgraph.structure.edits import InsertElement as InsertElement
    from bondgraph.structure.edits import LoosenBond as LoosenBond
    from bondgraph.structure.edits import ObstructBond as ObstructBond
    from bondgraph.structure.edits import ReplaceMeasurement as ReplaceMeasurement
    from bondgraph.structure.edits import ReplaceRelation as ReplaceRelation
    from bondgraph.structure.edits import SeveralEdits as SeveralEdits
    from bondgraph.structure.edits import SignalState as SignalState
    from bondgraph.structure.edits import WrapInput as WrapInput
    from bondgraph.structure.elements import GY as GY
    from bondgraph.structure.elements import MGY as MGY
    from bondgraph.structure.elements import MR as MR
    from bondgraph.structure.elements import MTF as MTF
    from bondgraph.structure.elements import TF as TF
    from bondgraph.structure.elements import C as C
    from bondgraph.structure.elements import I as I
    from bondgraph.structure.elements import MSe as MSe
    from bondgraph.structure.elements import MSf as MSf
    from bondgraph.structure.elements import OneJunction as OneJunction
    from bondgraph.structure.elements import R as R
    from bondgraph.structure.elements import Se as Se
    from bondgraph.structure.elements import Sf as Sf
    from bondgraph.structure.elements import ZeroJunction as ZeroJunction
    from bondgraph.structure.fields import CField as CField
    from bondgraph.structure.fields import ICField as ICField
    from bondgraph.structure.fields import IField as IField
    from bondgraph.structure.fields import RField as RField
    from bondgraph.structure.graph import CausalPreference as CausalPreference
    from bondgraph.structure.graph import FinishedGraph as FinishedGraph
    from bondgraph.structure.graph import Wanted as Wanted
    from bondgraph.structure.hard_contact import hard_contact as hard_contact
    from bondgraph.structure.parameters import Assumed as Assumed
    from bondgraph.structure.parameters import Fitted as Fitted
    from bondgraph.structure.parameters import Measured as Measured
    from bondgraph.structure.parameters import Parameter as Parameter
    from bondgraph.structure.parameters import ParameterSet as ParameterSet
    from bondgraph.structure.parameters import Published as Published
    from bondgraph.structure.parameters import Reconciled as Reconciled
    from bondgraph.structure.signals import displacement as displacement
    from bondgraph.structure.signals import e as e
    from bondgraph.structure.signals import effort as effort
    from bondgraph.structure.signals import f as f
    from bondgraph.structure.signals import flow as flow
    from bondgraph.structure.signals import momentum as momentum
    from bondgraph.structure.signals import p as p
    from bondgraph.structure.signals import port as port
    from bondgraph.structure.signals import ports as ports
    from bondgraph.structure.signals import q as q
    from bondgraph.structure.signals import t as t
    from bondgraph.structure.subgraphs import SubGraph as SubGraph


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        return getattr(import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'bondgraph' has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
