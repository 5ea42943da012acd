"""Actors of SDF: people who follow a script."""

from __future__ import annotations

from trundle.errors import WorldError
from trundle.files.xml_elements import XmlElement
from trundle.worlds.gazebo.values import Place, child, children, read_flag, read_name, read_numbers, read_pose
from trundle.worlds.movers import Mover, Waypoints, person_body


def read_actor(place: Place, element: XmlElement) -> Mover | None:
    """Read an <actor> as a person who passes the waypoints of its trajectories, or None if it has none.

    As in Gazebo they are points of a Catmull-Rom spline with their times, and poses in the world; the actor's own pose
    is where it is without a script. Heights, roll and pitch are ignored, as are skins and animations.

    Raises:
        WorldError: If a waypoint lacks its time, or the times do not increase.
    """
    name = read_name(place, element)
    script = child(element, "script")
    waypoints = [
        waypoint
        for trajectory in (children(script, "trajectory") if script is not None else [])
        for waypoint in children(trajectory, "waypoint")
    ]
    if script is None or not waypoints:
        return None
    delay_element = child(script, "delay_start")
    delay = read_numbers(place, delay_element, 1)[0] if delay_element is not None else 0.0
    points: list[tuple[float, ...]] = []
    for waypoint in waypoints:
        time = child(waypoint, "time")
        if time is None:
            place.fail(waypoint, "a <waypoint> needs a <time>")
        pose = read_pose(place, waypoint).pose
        seconds = read_numbers(place, time, 1)[0]
        points.append((delay + seconds, pose.position[0], pose.position[1], pose.yaw()))
    repeat = "loop" if read_flag(place, script, "loop", default=True) else "once"
    try:
        return Mover(name, person_body(), Waypoints(tuple(points), "catmull_rom", repeat), "person")
    except WorldError as error:
        place.fail(script, f"the actor {name!r}: {error}")
