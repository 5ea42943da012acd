"""Simulators of other packages behind the seam, as they are and through the adapter."""

import copy

import mujoco
import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.sim import Simulator, add_solid, place_robot, simulate, simulator_names, world_of
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.contacts import ContactReader
from trundle.sim.mujoco.model import build_spec
from trundle.sim.simulator import SIMULATORS, as_simulator
from trundle.sim.wrapper import DelayedSimulator
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
EMPTY = World("empty", ())
POST = Solid("post", Box((0.2, 0.2, 1.0)), Pose3D((5.0, 0.0, 0.5)))
THERE = Pose2D(1.0, 2.0)
DT = 0.05


class Least:
    """With what every simulator must have, and no more."""

    def __init__(self, sim):
        self._sim, self.robot, self.closed = sim, sim.robot, False

    def reset(self, pose, *, seed=0):
        return self._sim.reset(pose, seed=seed)

    def step(self, command, dt):
        return self._sim.step(command, dt)

    def close(self):
        self.closed = True

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Around(Least):
    """A wrapper of another package, which keeps what it wraps as `inner`."""

    def __init__(self, sim):
        super().__init__(sim)
        self.inner = sim


class OlderWatch(Least):
    """Reports physics steps, by an attribute."""

    on_substep = None


def make(kind):
    return kind(KinematicSimulator(EMPTY, CARTER))


@pytest.mark.parametrize("backend", [name for name in simulator_names() if name in ("kinematic", "mujoco")])
def test_our_simulators_need_no_adapter(backend):
    with simulate(EMPTY, CARTER, backend=backend) as sim:
        assert as_simulator(sim) is sim
    late = DelayedSimulator(sim, 0.1)
    assert as_simulator(late) is late


def test_a_simulator_with_the_least_has_the_defaults():
    least = make(Least)
    sim = as_simulator(least)
    assert isinstance(sim, Simulator)
    assert (sim.world, sim.timestep, sim.watch_substeps(print)) == (None, None, False)
    with pytest.raises(InputError, match="Least cannot put anything into its world during a run; use the backend"):
        sim.add_solid(POST)
    with pytest.raises(InputError, match="Least cannot place the robot during a run; use the backend"):
        sim.place(THERE)


def test_what_is_no_simulator_is_refused():
    with pytest.raises(InputError, match="a run's simulator must be of type Simulator, got int; trundle"):
        as_simulator(5, "a run's simulator")


def test_a_class_that_derives_from_the_seam_has_the_defaults():
    class Derived(Least, Simulator):
        robot = CARTER

    derived = make(Derived)
    assert as_simulator(derived) is derived
    assert (derived.world, derived.timestep, derived.watch_substeps(print)) == (None, None, False)
    with pytest.raises(InputError, match="Derived cannot place the robot"):
        derived.place(THERE)


def test_a_simulator_with_the_least_drives_and_is_closed_by_a_with_statement():
    least = make(Least)
    with as_simulator(least) as sim:
        assert sim.robot is CARTER
        sim.reset(Pose2D(0.0, 0.0), seed=1)
        assert sim.step(Twist2D(0.3, 0.0), DT).time == pytest.approx(DT)
    assert least.closed


def test_what_an_adapted_simulator_has_besides_can_be_read():
    sim = as_simulator(make(Least))
    assert not sim.closed
    assert copy.copy(sim).simulator is sim.simulator


def test_a_wrapper_with_an_inner_simulator_reaches_it():
    kinematic = KinematicSimulator(EMPTY, CARTER)
    sim, seen = as_simulator(Around(Around(kinematic))), []
    assert sim.world is EMPTY
    assert sim.timestep == kinematic.timestep
    assert sim.watch_substeps(seen.append)
    sim.reset(Pose2D(0.0, 0.0))
    sim.step(Twist2D(0.3, 0.0), DT)
    assert len(seen) == round(DT / kinematic.timestep)
    sim.add_solid(POST)
    assert kinematic.world.solids == (POST,)
    assert sim.place(THERE).pose == THERE


def test_our_wrappers_hand_everything_on():
    kinematic, seen = KinematicSimulator(EMPTY, CARTER), []
    sim = DelayedSimulator(kinematic, 0.0)
    assert (sim.world, sim.timestep) == (EMPTY, kinematic.timestep)
    assert sim.watch_substeps(seen.append)
    sim.reset(Pose2D(0.0, 0.0))
    sim.step(Twist2D(0.3, 0.0), DT)
    assert seen
    sim.add_solid(POST)
    assert sim.world.solids == (POST,)
    assert sim.place(THERE).pose == THERE


def test_our_wrappers_take_a_simulator_with_the_least():
    sim = DelayedSimulator(make(Least), 0.02)
    assert (sim.world, sim.timestep) == (None, None)
    assert sim.reset(Pose2D(0.0, 0.0)).time == 0.0


def test_an_attribute_on_substep_is_set():
    older = make(OlderWatch)
    assert as_simulator(older).watch_substeps(print)
    assert older.on_substep is print


def test_the_functions_take_any_simulator():
    kinematic = KinematicSimulator(EMPTY, CARTER)
    around = Around(kinematic)
    assert world_of(around) is EMPTY
    add_solid(around, POST)
    assert world_of(around).solids == (POST,)
    assert place_robot(around, THERE).pose == THERE


def test_a_registered_simulator_with_the_least_is_adapted(monkeypatch):
    class Registered(Least):
        def __init__(self, world, robot):
            super().__init__(KinematicSimulator(world, robot))

    monkeypatch.setattr(SIMULATORS, "load", lambda _: Registered)
    with simulate(EMPTY, CARTER, backend="registered") as sim:
        assert isinstance(sim, Simulator)
        assert isinstance(sim.simulator, Registered)


def test_contacts_between_others_are_not_the_robots():
    """Two bodies that fall onto each other beside the robot, as parts of another robot would."""
    spec = build_spec(EMPTY, CARTER, looks=False)
    for name, height in (("a", 2.0), ("b", 2.15)):
        body = spec.worldbody.add_body(name=name, pos=[5.0, 0.0, height])
        body.add_freejoint()
        body.add_geom(name=f"other:{name}", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.1])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = {model.geom(geom).name for pair in data.contact.geom.tolist() for geom in pair}
    assert {"other:a", "other:b"} <= names
    touched = {}
    ContactReader(model, EMPTY, {}).read(data, touched)
    assert touched == {}


def test_a_contact_with_another_body_that_moves_has_its_name():
    spec = build_spec(EMPTY, CARTER, looks=False)
    body = spec.worldbody.add_body(name="a", pos=[0.0, 0.0, 0.3])
    body.add_freejoint()
    body.add_geom(name="other:a", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.5, 0.5, 0.1])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    touched = {}
    ContactReader(model, EMPTY, {}).read(data, touched)
    assert {other for _, other in touched} == {"other:a"}
    assert all(part.startswith(("chassis", "wheel", "caster")) for part, _ in touched)
