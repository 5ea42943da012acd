import mujoco
import numpy as np
import pytest

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot, WheelSpeeds
from trundle.sim import MoverState, RobotState
from trundle.sim.mover_history import MoverHistory, ShownMovers
from trundle.viewer.scene import SceneRenderer
from trundle.viewer.scene_model import SceneModel, movers_at_start
from trundle.worlds import World
from trundle.worlds.movers import Crowd, Mover, Waypoints

CARTER = Robot.load("nova_carter")
CART = Mover(
    "cart",
    (Solid("body", Box((1.0, 0.6, 1.0)), Pose3D((0.0, 0.0, 0.5)), color=(1.0, 0.0, 0.0, 1.0)),),
    Waypoints(((0.0, 3.0, 0.0), (10.0, 3.0, 10.0))),
)
WALLS = tuple(Solid(f"wall_{x:g}", Box((0.2, 24.0, 1.0)), Pose3D((x, 0.0, 0.5))) for x in (-8.0, 8.0))
WORLD = World("hall", WALLS, movers=(CART,))


def shown(y, trail=()):
    return ShownMovers((MoverState("cart", Pose2D(3.0, y)),), (np.array(trail).reshape(-1, 2),))


def body_at(scene, name):
    return scene.data.xpos[scene.model.body(name).id]


def test_a_stage_puts_movers_where_they_are_with_dots_along_their_trails():
    scene = SceneModel(WORLD, CARTER, size=(64, 64))
    trail = [(3.0, 0.1 * index) for index in range(41)]
    scene.place(Pose2D(0.0, 0.0), movers=shown(4.0, trail))
    np.testing.assert_allclose(body_at(scene, "mover:cart")[:2], [3.0, 4.0])
    dots = np.array([body_at(scene, f"viewer:trail:cart:{index}") for index in range(12)])
    assert (np.diff(dots[:, 1]) > 0.2).all()
    assert dots[0, 1] == pytest.approx(0.0)
    assert (dots[:, 2] < 0.01).all()
    assert (dots[:, 2] > 0.0).all()
    scene.place(Pose2D(0.0, 0.0), movers=shown(4.0))
    assert body_at(scene, "viewer:trail:cart:0")[2] < -10.0


def test_a_picture_shows_a_mover_where_it_is():
    with SceneRenderer(WORLD, CARTER, size=(160, 120), camera="top", shadow_size=0) as scene:
        pictures = [scene.render(Pose2D(0.0, 0.0), movers=shown(y)).astype(int) for y in (-2.0, 2.0)]
    rows = []
    for picture in pictures:
        red = (picture[..., 0] > 100) & (picture[..., 1] < 60) & (picture[..., 2] < 60)
        assert red.sum() > 10
        rows.append(np.flatnonzero(red.any(axis=1)).mean())
    assert rows[0] > rows[1] + 10  # north is up


def test_a_world_at_rest_shows_movers_and_crowds_where_they_start():
    world = World("hall", WORLD.solids, movers=(CART, Crowd("people", 2, area=(-6.0, -3.0, 6.0, 3.0))))
    states = movers_at_start(world, CARTER, Pose2D(0.0, 0.0)).states
    assert states[0].name == "cart"
    assert len(states) == 3
    assert (states[0].pose.x, states[0].pose.y) == (3.0, 0.0)
    assert all(state.pose.distance_to(Pose2D(0.0, 0.0)) > 1.0 for state in states)
    assert movers_at_start(World("empty", ()), CARTER, Pose2D(0.0, 0.0)) == ShownMovers()


def test_a_state_carries_its_movers_into_a_history():
    wheels = WheelSpeeds(0.0, 0.0)
    state = RobotState(0.5, Pose2D(0, 0), Twist2D(), wheels, wheels, Pose2D(0, 0), movers=shown(1.0).states)
    history = MoverHistory()
    history.add(state.time, state.movers)
    scene = SceneModel(WORLD, CARTER, size=(64, 64))
    scene.place(state.pose, state.wheel_positions, history.at(state.time))
    mujoco.mj_forward(scene.model, scene.data)
    assert body_at(scene, "mover:cart")[1] == pytest.approx(1.0)
