"""simulation_interfaces: the state of the simulation, its steps and restarts, and the entities in it."""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path

import pytest

from ros2.bridge.conftest import QUICK_S, wait_for
from ros2.test_types import SEPARATOR

INTERFACES = Path(__file__).parents[1] / "interfaces"
PACKAGE = "simulation_interfaces"
OK, NOT_FOUND, INCORRECT_STATE, FAILED, UNSUPPORTED = 1, 2, 3, 4, 0
STOPPED, PLAYING, PAUSED, QUITTING = range(4)


@cache
def texts():
    """The parts of the package's services and actions, each with the messages in it."""
    folder = INTERFACES / PACKAGE
    names = "|".join(path.stem for path in (folder / "msg").glob("*.msg"))
    messages = {path.stem: qualify(path.read_text(), names) for path in (folder / "msg").glob("*.msg")}
    known = {f"{PACKAGE}/msg/{name}": with_messages(text, messages) for name, text in messages.items()}
    for kind, suffixes in (("srv", ("Request", "Response")), ("action", ("Goal", "Result", "Feedback"))):
        for path in (folder / kind).glob(f"*.{kind}"):
            parts = [part.strip() for part in ("\n" + qualify(path.read_text(), names)).split("\n---")]
            for suffix, part in zip(suffixes, parts, strict=True):
                text = with_messages(part or "uint8 structure_needs_at_least_one_member", messages)
                known[f"{PACKAGE}/{kind}/{path.stem}_{suffix}"] = text
    return known


def qualify(text, names):
    return re.sub(rf"^({names})(\[\])? ", rf"{PACKAGE}/\1\2 ", text, flags=re.MULTILINE)


def with_messages(text, messages):
    found, queue = {}, [text]
    while queue:
        for line in queue.pop().splitlines():
            name = line.split("#")[0].split(" ")[0].removesuffix("[]").removeprefix(f"{PACKAGE}/")
            if name in messages and name not in found:
                found[name] = messages[name]
                queue.append(messages[name])
    return text + "".join(f"{SEPARATOR}{PACKAGE}/{name}\n{each}" for name, each in found.items())


class Client:
    """Calls a bridge's services."""

    def __init__(self, network, served, prefix=""):
        self.network, self.served, self.prefix = network, served, prefix
        self.types = served.bridge.wire.types

    def call(self, name, **fields):
        words = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
        request = self.types.encode(self.types.make(f"{PACKAGE}/srv/{name}_Request", **fields))
        call = self.network.call(f"/{self.prefix}{words}", request)
        data = wait_for(lambda: call.response)
        return self.types.decode(f"{PACKAGE}/srv/{name}_Response", data)

    def set_state(self, number):
        return self.call("SetSimulationState", state=self.types.make(f"{PACKAGE}/msg/SimulationState", state=number))

    @property
    def state(self):
        return self.call("GetSimulationState").state.state

    def place(self, x, y, yaw=0.0, *, entity="nova_carter", frame="", w=None, v=0.0):
        make = self.types.make
        turn = {"z": math.sin(yaw / 2), "w": math.cos(yaw / 2) if w is None else w}
        state = make(
            f"{PACKAGE}/msg/EntityState",
            header=make("std_msgs/msg/Header", frame_id=frame),
            pose=make(
                "geometry_msgs/msg/Pose",
                position=make("geometry_msgs/msg/Point", x=x, y=y),
                orientation=make("geometry_msgs/msg/Quaternion", **turn),
            ),
            twist=make("geometry_msgs/msg/Twist", linear=make("geometry_msgs/msg/Vector3", x=v)),
        )
        return self.call("SetEntityState", entity=entity, state=state).result


@pytest.fixture
def client(serve, network):
    served = serve(speed=5.0, definitions=texts())
    wait_for(lambda: served.bridge.context.periods.count)
    return Client(network, served)


def seconds(client):
    return client.served.bridge.context.clock.now


def test_the_state_is_set_and_read(client):
    assert client.state == PLAYING
    assert client.set_state(PLAYING).result.result == 101
    assert client.set_state(PAUSED).result.result == OK
    assert client.state == PAUSED
    stands = seconds(client)
    assert client.set_state(PAUSED).result.result == 101
    assert seconds(client) == stands
    assert client.set_state(PLAYING).result.result == OK
    wait_for(lambda: seconds(client) > stands)
    assert client.set_state(9).result.result == FAILED


def test_stopping_begins_again_at_zero_and_stands(client):
    assert client.set_state(STOPPED).result.result == OK
    assert (client.state, seconds(client)) == (STOPPED, 0.0)
    assert client.call("StepSimulation", steps=1).result.result == OK
    assert client.state == PAUSED
    assert client.set_state(STOPPED).result.result == OK
    assert client.set_state(PAUSED).result.result == OK
    assert client.state == PAUSED


def test_quitting_ends_the_bridge(client):
    assert client.set_state(QUITTING).result.result == OK
    client.served._thread.join(QUICK_S)
    assert "asked to quit" in client.served.episode.message


def test_steps_are_control_periods_and_need_a_pause(client):
    refused = client.call("StepSimulation", steps=2).result
    assert (refused.result, "pause it first" in refused.error_message) == (FAILED, True)
    client.set_state(PAUSED)
    before = seconds(client)
    assert client.call("StepSimulation", steps=5).result.result == OK
    assert seconds(client) - before == pytest.approx(0.1)
    assert client.state == PAUSED
    assert client.call("StepSimulation", steps=0).result.result == FAILED
    assert client.call("StepSimulation", steps=2**40).result.result == FAILED


def test_commands_are_heard_while_it_steps(client, peer):
    client.set_state(PAUSED)
    peer.send("/cmd_vel", peer.twist(0.5))
    wait_for(lambda: client.served.bridge.wire.inlets[0].received)
    client.call("StepSimulation", steps=20)
    assert client.served.bridge.context.session.state.twist.v == pytest.approx(0.5)


@pytest.mark.parametrize(("scope", "goes_on"), [(0, True), (2, True), (1, False), (255, False)])
def test_a_reset_goes_back_and_the_time_only_if_asked(client, peer, scope, goes_on):
    peer.send("/cmd_vel", peer.twist(0.5))
    start = client.served.bridge.mission.start
    wait_for(lambda: client.served.bridge.context.session.state.pose.distance_to(start) > 0.1)
    client.set_state(PAUSED)
    before = seconds(client)
    assert client.call("ResetSimulation", scope=scope).result.result == OK
    assert client.state == PAUSED
    moved = client.served.bridge.context.session.state.pose.distance_to(start)
    assert (moved > 0.1) == (scope == 1)
    assert seconds(client) == (math.floor(before) + 1.0 if goes_on else 0.0)


def test_a_reset_of_what_cannot_be_reset_alone_is_refused(client):
    assert client.call("ResetSimulation", scope=4).result.result == UNSUPPORTED
    assert client.call("ResetSimulation", scope=64).result.result == UNSUPPORTED


def test_a_running_simulation_runs_on_after_a_reset(client):
    assert client.call("ResetSimulation").result.result == OK
    assert client.state == PLAYING


def test_entities_are_listed_and_filtered(client):
    make = client.types.make
    everything = client.call("GetEntities").entities
    assert everything[0] == "nova_carter"
    assert len(everything) > 3
    named = make(f"{PACKAGE}/msg/EntityFilters", filter="^nova")
    assert client.call("GetEntities", filters=named).entities == ["nova_carter"]
    robots = make(f"{PACKAGE}/msg/EntityFilters", categories=[make(f"{PACKAGE}/msg/EntityCategory", category=2)])
    assert client.call("GetEntities", filters=robots).entities == ["nova_carter"]
    bad = make(f"{PACKAGE}/msg/EntityFilters", filter="(")
    assert client.call("GetEntities", filters=bad).result.result == FAILED
    here = client.served.bridge.context.session.state.pose
    points = [make("geometry_msgs/msg/Vector3", x=here.x, y=here.y), make("geometry_msgs/msg/Vector3", x=0.05)]
    near = make(f"{PACKAGE}/msg/EntityFilters", bounds=make(f"{PACKAGE}/msg/Bounds", type=3, points=points))
    assert client.call("GetEntities", filters=near).entities == ["nova_carter"]
    hull = make(f"{PACKAGE}/msg/EntityFilters", bounds=make(f"{PACKAGE}/msg/Bounds", type=2, points=points))
    assert client.call("GetEntities", filters=hull).result.result == UNSUPPORTED


def test_states_are_the_truth_in_the_map_frame(client, peer):
    client.set_state(PAUSED)
    peer.send("/cmd_vel", peer.twist(0.5))
    wait_for(lambda: client.served.bridge.wire.inlets[0].received)
    client.call("StepSimulation", steps=20)
    state = client.call("GetEntityState", entity="nova_carter").state
    true = client.served.bridge.context.session.state
    assert (state.header.frame_id, state.pose.position.x, state.pose.position.y) == ("map", true.pose.x, true.pose.y)
    assert math.hypot(state.twist.linear.x, state.twist.linear.y) == pytest.approx(0.5)
    info = client.call("GetEntityInfo", entity="nova_carter").info
    assert (info.category.category, info.description) == (2, "robot")
    several = client.call("GetEntitiesStates")
    assert several.entities == client.call("GetEntities").entities
    assert several.states[0].pose.position.x == true.pose.x
    missing = client.call("GetEntityState", entity="nova_cater").result
    assert missing.result == NOT_FOUND
    assert "nova_carter" in missing.error_message


def test_the_robot_is_placed_at_once_where_it_fits(client):
    client.set_state(PAUSED)
    start = client.served.bridge.mission.start
    assert client.place(start.x, start.y, 1.0, frame="map").result == OK
    state = client.call("GetEntityState", entity="nova_carter").state
    assert state.pose.orientation.z == pytest.approx(math.sin(0.5))


@pytest.mark.parametrize(
    ("options", "code", "text"),
    [
        ({"frame": "odom"}, FAILED, "frame"),
        ({"w": 0.0}, FAILED, "quaternion"),
        ({"v": 1.0}, UNSUPPORTED, "at rest"),
        ({"entity": "nobody"}, NOT_FOUND, "nobody"),
        ({"x": math.nan}, FAILED, "not finite"),
    ],
)
def test_bad_places_are_refused(client, options, code, text):
    start = client.served.bridge.mission.start
    result = client.place(options.pop("x", start.x), start.y, **options)
    assert (result.result, text in result.error_message) == (code, True)


def test_only_the_robot_can_be_placed_and_not_into_a_solid(client):
    solid = client.served.bridge.mission.world.solids[0]
    refused = client.place(0.0, 0.0, entity=solid.name)
    assert (refused.result, "stands in the world" in refused.error_message) == (UNSUPPORTED, True)
    x, y, _ = solid.pose.position
    into = client.place(x, y)
    assert (into.result, "would touch" in into.error_message) == (FAILED, True)


def test_features_are_those_that_are_served(client):
    features = client.call("GetSimulatorFeatures").features
    kind = client.types.kind(f"{PACKAGE}/msg/SimulatorFeatures")
    assert {kind.ENTITY_STATE_SETTING, kind.SIMULATION_RESET_TIME, kind.STEP_SIMULATION_ACTION} <= set(
        features.features
    )
    assert kind.SPAWNING not in features.features


def goal(client, steps):
    return client.network.send_goal(
        "/simulate_steps", client.types.encode(client.types.make(f"{PACKAGE}/action/SimulateSteps_Goal", steps=steps))
    )


def test_the_action_steps_with_feedback(client):
    client.set_state(PAUSED)
    before = seconds(client)
    sent = goal(client, 4)
    wait_for(lambda: sent.status == "succeeded")
    assert seconds(client) - before == pytest.approx(0.08)
    feedback = [client.types.decode(f"{PACKAGE}/action/SimulateSteps_Feedback", data) for data in sent.feedback]
    assert [(one.completed_steps, one.remaining_steps) for one in feedback] == [(1, 3), (2, 2), (3, 1), (4, 0)]
    result = client.types.decode(f"{PACKAGE}/action/SimulateSteps_Result", sent.result).result
    assert result.result == OK


def test_the_action_is_cancelled_and_takes_one_goal_at_a_time(client):
    client.set_state(PAUSED)
    sent = goal(client, 10**5)
    wait_for(lambda: sent.feedback)
    second = goal(client, 1)
    wait_for(lambda: second.status == "rejected")
    assert client.call("StepSimulation", steps=1).result.result == INCORRECT_STATE
    client.network.cancel("/simulate_steps", sent)
    wait_for(lambda: sent.status == "canceled")
    assert client.state == PAUSED


def test_the_action_needs_a_pause(client):
    sent = goal(client, 3)
    wait_for(lambda: sent.status == "aborted")


def test_without_the_types_nothing_is_served(serve):
    served = serve(start=False)
    assert "/step_simulation" in served.bridge.wire.missing
    assert not [name for name, _ in served.bridge.wire.services if "simulation" in name]


def test_without_services_names_are_missing_and_topics_work(serve):
    served = serve(start=False, has_services=False, definitions=texts())
    assert "/simulate_steps" in served.bridge.wire.missing
    assert served.bridge.wire.services == []


def test_the_profile_of_gazebo_has_its_prefix(serve):
    served = serve(start=False, profile="turtlebot3", scenario={"robot": "turtlebot3_waffle"}, definitions=texts())
    assert "/gzserver/step_simulation" in [name for name, _ in served.bridge.wire.services]
