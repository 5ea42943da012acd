"""`BatchSimulator` on a device of Warp's: the bits of the kernel on the processor, and arrays that stay there.

Warp's own CPU device runs the same kernels where there is no GPU.
"""

import math

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim import BatchSimulator, MoverRecording

wp = pytest.importorskip("warp", reason="needs Warp, of the extra gpu")

from support.warp_device import is_missing_a_gpu  # noqa: E402 - needs Warp

CARTER = Robot.load("nova_carter")
COUNT = 24
ROBOTS = np.arange(COUNT)
SQUARE = np.array([(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)])


def clutter(seed: int, shape=(120, 160), yaw: float = 0.3) -> OccupancyGrid:
    rng = np.random.default_rng(seed)
    cells = np.zeros(shape, dtype=np.int8)
    for row, col in rng.integers(0, shape, (30, 2)):
        cells[row : row + 4, col : col + 3] = 100
    cells[:2], cells[:, :2], cells[:, -2:] = 100, 100, 100  # open on one side
    return OccupancyGrid(cells, 0.05, Pose2D(-3.0, 2.0, yaw))


def recordings(seed: int = 3) -> list[MoverRecording]:
    """Discs and polygons that wander about the maps."""
    rng = np.random.default_rng(seed)
    steps = rng.uniform(-0.1, 0.1, (4, 30, 3))
    tracks = np.cumsum(steps, axis=1) + rng.uniform((-2.0, 3.0, -3.0), (4.0, 7.0, 3.0), (4, 1, 3))
    return [MoverRecording((SQUARE, 0.4), tracks[:2]), MoverRecording((0.3, SQUARE * 0.8), tracks[2:])]


def starts(seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    inside = clutter(0).origin.transform_points(rng.uniform((1.0, 1.0), (7.0, 5.5), (COUNT, 2)))
    return np.column_stack([inside, rng.uniform(-9.0, 9.0, COUNT)])


def make(device: str, count: int = COUNT) -> BatchSimulator:
    lidars = {name: each.model_copy(update={"beams": 90}) for name, each in CARTER.lidars.items()}
    robot = CARTER.model_copy(update={"lidars": lidars})
    maps = [clutter(0), clutter(1, (100, 180)), clutter(2, yaw=-2.0)]
    return BatchSimulator(maps, robot, count=count, lidar=True, recordings=recordings(), device=device)


def everywhere() -> dict[str, np.ndarray]:
    """All kinds of places: maps, with movers and without, with errors of the lidars and without."""
    return {
        "maps": ROBOTS % 3,
        "recordings": ROBOTS % 3 - 1,
        "seeds": ROBOTS * 7919,
        "noise": np.where(ROBOTS % 2, 0.02, 0.0),
        "dropouts": np.where(ROBOTS % 4 > 1, 0.1, 0.0),
    }


def assert_same(one: BatchSimulator, other: BatchSimulator) -> None:
    for name in ("poses", "twists", "wheels", "lengths", "steps", "contacts", "places"):
        mine, expected = getattr(other, name).numpy(), getattr(one, name)
        assert np.ascontiguousarray(mine).tobytes() == np.ascontiguousarray(expected).tobytes(), name
    assert other.scan().numpy().tobytes() == one.scan().tobytes()
    assert other.scan_exactly().tobytes() == one.scan_exactly().tobytes()
    assert other.is_off_map().numpy().tolist() == one.is_off_map().tolist()
    assert other.times.tolist() == one.times.tolist()


def test_the_device_has_the_bits_of_the_processor(device):
    one, other = make("cpu"), make("cuda")
    kinds = set()
    rng = np.random.default_rng(2)
    for simulator in (one, other):
        simulator.reset(starts(), **everywhere())
    assert_same(one, other)
    for turn in range(24):
        commands = rng.uniform((-0.8, -2.5), (1.8, 2.5), (COUNT, 2))
        some = ROBOTS % 5 > 0 if turn % 3 == 0 else None
        for simulator in (one, other):
            simulator.step(commands, 0.2 if turn % 4 == 0 else 0.05, robots=some)
            if turn == 11:
                simulator.reset(starts(9)[:5], robots=[3, 1, 8, 2, 20], maps=1)
        assert_same(one, other)
        kinds |= set(one.contacts[:, 0].tolist())
    assert kinds == {0, 1, 2}


def test_a_large_angle_is_reduced_alike(device):
    one, other = make("cpu"), make("cuda")
    poses = starts()
    poses[:, 2] += np.where(ROBOTS % 2, 3e6, -7.5e8)
    for simulator in (one, other):
        simulator.reset(poses)
        simulator.step((0.5, 0.3), 0.05)
    assert_same(one, other)


def test_long_steps_find_the_first_contact_alike(device):
    one, other = make("cpu"), make("cuda")
    for simulator in (one, other):
        simulator.reset(starts(4), recordings=1)
        simulator.step((1.0, 0.1), 1.0)
    assert (one.contacts[:, 3] > 16).any()  # more substeps than are looked at side by side
    assert_same(one, other)


def test_many_robots_find_the_first_contact_alike(device):
    count = 16_500  # so many that a thread looks at a whole footprint
    one, other = make("cpu", count), make("cuda", count)
    poses = np.resize(starts(), (count, 3)) + np.random.default_rng(3).uniform(-0.5, 0.5, (count, 3))
    for simulator in (one, other):
        simulator.reset(poses, recordings=np.arange(count) % 3 - 1)
        simulator.step((0.6, 0.4), 0.05)
    assert set(one.contacts[:, 0].tolist()) == {0, 1, 2}
    assert len(set(one.contacts[:, 3].tolist())) > 5
    assert np.array_equal(other.contacts.numpy(), one.contacts)


def test_arrays_of_the_device_are_taken_and_given_without_the_host(device):
    one, other = make("cpu"), make("cuda")
    where = everywhere()
    on_device = {name: put(other, values) for name, values in where.items()}
    one.reset(starts(), **where)
    other.reset(put(other, starts()), **on_device)
    commands = np.random.default_rng(5).uniform(-1.0, 1.0, (COUNT, 2)).astype(np.float32)
    one.step(commands, 0.05)
    other.step(put(other, commands), 0.05)
    mask = ROBOTS % 3 == 0
    one.reset(starts(8)[mask], robots=mask, maps=2)
    other.reset(put(other, starts(8)), robots=put(other, mask), maps=2)
    other.synchronize()
    assert_same(one, other)


def put(simulator: BatchSimulator, values: np.ndarray):
    return wp.array(values, device=simulator.poses.device)


@pytest.mark.parametrize("name", ["poses", "ranges", "contacts", "twists"])
def test_arrays_pass_by_dlpack_without_a_copy(device, name):
    simulator = make("cuda")
    simulator.reset(starts())
    array = getattr(simulator, name)
    if device == "cpu":
        taken = np.from_dlpack(array)
        assert taken.ctypes.data == array.ptr
    else:
        torch = pytest.importorskip("torch", reason="needs PyTorch")
        taken = torch.from_dlpack(array)
        assert taken.data_ptr() == array.ptr
    before = simulator.poses.numpy().copy()
    simulator.step((0.5, 0.2), 0.05)
    simulator.scan()
    simulator.synchronize()
    assert not np.array_equal(before, simulator.poses.numpy())
    now = taken if device == "cpu" else taken.cpu().numpy()
    assert np.array_equal(now, array.numpy())


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"commands": math.nan}, "command of robot 5 is not finite. No robot has moved"),
        ({"poses": math.inf}, "pose of robot 5 is not finite; nothing was reset"),
        ({"maps": 3}, "robot 5 is to be on a map that is not there; there are 3 maps"),
        ({"recordings": -2}, "robot 5 is to be on a recording that is not there; there are 2 recordings"),
        ({"noise": -1.0}, "noise of robot 5"),
    ],
)
def test_bad_values_on_the_device_are_raised_and_change_nothing(device, change, text):
    simulator = make("cuda")
    simulator.reset(starts(), **everywhere())
    before = simulator.poses.numpy().copy(), simulator.places.numpy().copy()
    given = {"poses": starts(6), "commands": np.full((COUNT, 2), 0.3), **everywhere()}
    for name, value in change.items():
        given[name] = given[name].copy()
        given[name][5] = value
    commands = put(simulator, given.pop("commands"))
    with pytest.raises(InputError, match=text):  # noqa: PT012 - a GPU may tell at the next call
        if "commands" in change:
            simulator.step(commands, 0.05)
        else:
            simulator.reset(**{name: put(simulator, values) for name, values in given.items()})
        simulator.synchronize()
    assert np.array_equal(simulator.poses.numpy(), before[0])
    assert np.array_equal(simulator.places.numpy(), before[1])
    simulator.step((0.3, 0.0), 0.05)  # and all go on
    simulator.synchronize()
    assert (simulator.lengths.numpy() > 0.0).all()


def test_shapes_on_the_device_are_named(device):
    simulator = make("cuda")
    with pytest.raises(InputError, match=r"commands on a device need shape \(24, 2\), got \(3, 2\)"):
        simulator.step(put(simulator, np.zeros((3, 2))), 0.05)
    with pytest.raises(InputError, match="poses must be numbers"):
        simulator.reset(wp.zeros(COUNT, dtype=wp.vec3d, device=simulator.poses.device))


def test_host_arrays_are_checked_as_on_the_processor(device):
    simulator = make("cuda")
    with pytest.raises(InputError, match=r"command of robot 1 .*No robot has moved"):
        simulator.step([(0.0, 0.0), (math.nan, 0.0), *[(0.0, 0.0)] * (COUNT - 2)], 0.05)
    with pytest.raises(InputError, match="robot 0 is to be on map 7"):
        simulator.reset(starts(), maps=7)


def test_host_arrays_beside_those_of_the_device_are_checked_too(device):
    simulator, poses = make("cuda"), starts(9)
    simulator.reset(starts())
    before = simulator.poses.numpy().copy()
    on_device = put(simulator, poses)
    for given, text in (
        ({"maps": 0.9}, "maps must be integers"),
        ({"noise": [0.1]}, "noise need shape"),
        ({"robots": [COUNT]}, "different indices"),
    ):
        with pytest.raises(InputError, match=text):
            simulator.reset(on_device, **given)
    with pytest.raises(InputError, match="commands need shape"):
        simulator.step([0.1], 0.05, robots=put(simulator, np.ones(COUNT, bool)))
    simulator.reset(on_device, robots=[0, 2])
    simulator.synchronize()
    chosen = np.isin(ROBOTS, [0, 2])
    assert np.array_equal(simulator.poses.numpy(), np.where(chosen[:, None], poses, before))


@pytest.mark.skipif(not is_missing_a_gpu(), reason="has a GPU")
def test_a_gpu_that_is_not_there_is_named():
    with pytest.raises(InputError, match=r'device="cuda": this machine has no such GPU.*use device="cpu"'):
        make("cuda")


@pytest.mark.skipif(is_missing_a_gpu(), reason="needs a GPU of NVIDIA's")
def test_a_number_that_no_gpu_has_is_named():
    with pytest.raises(InputError, match="has cuda:0"):
        make("cuda:99")


def test_scans_after_a_reset_know_nothing_of_those_before_where_a_recording_is_empty(device):
    walls = np.zeros((160, 240), np.int8)
    walls[[0, -1], :] = walls[:, [0, -1]] = 100
    empty = MoverRecording((), np.zeros((0, 1, 3)))
    sims = [
        BatchSimulator(OccupancyGrid(walls, 0.05), CARTER, count=1, lidar=True, recordings=[empty], device=where)
        for where in ("cpu", "cuda")
    ]
    for sim in sims:
        for pose in ((1.2, 4.0, 0.0), (6.0, 4.0, 0.0)):
            sim.reset(np.array([pose]), recordings=0)
            sim.scan()
    assert np.asarray(sims[1].ranges.numpy()).tobytes() == np.asarray(sims[0].ranges).tobytes()
