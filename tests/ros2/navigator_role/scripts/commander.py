"""Uses trundle as a script for Nav2 does, and prints what came of each call as a line of JSON."""

import json
import math

import rclpy
from geometry_msgs.msg import PoseStamped
from nav2_simple_commander.robot_navigator import BasicNavigator


def say(what, **values):
    print(json.dumps({"what": what, **values}), flush=True)


def make_pose(navigator, x, y, yaw=0.0):
    pose = PoseStamped()
    pose.header.frame_id = "map"
    pose.header.stamp = navigator.get_clock().now().to_msg()
    pose.pose.position.x, pose.pose.position.y = x, y
    pose.pose.orientation.z, pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return pose


def finish(navigator):
    """Wait for the end of a task; how it ended, its code and its last feedback."""
    while not navigator.isTaskComplete():
        pass
    answer = navigator.result_future.result().result if navigator.result_future else None
    return {"result": navigator.getResult().name, "code": getattr(answer, "error_code", None)}


def main():
    rclpy.init()
    navigator = BasicNavigator()
    start = make_pose(navigator, 1.5, 1.5)
    navigator.setInitialPose(start)
    navigator.waitUntilNav2Active()
    say("active")

    there = make_pose(navigator, 1.5, 4.5, math.pi / 2)
    path = navigator.getPath(start, there, use_start=True)
    say("path", poses=len(path.poses), ends=[path.poses[-1].pose.position.x, path.poses[-1].pose.position.y])
    say("wall path", none=navigator.getPath(start, make_pose(navigator, 4.0, 1.0)) is None)
    through = navigator.getPathThroughPoses(start, [there, make_pose(navigator, 3.0, 4.5)], use_start=True)
    say("path through", poses=len(through.poses))

    say("go", accepted=bool(navigator.goToPose(there)))
    while not navigator.isTaskComplete():
        if navigator.getFeedback() and navigator.getFeedback().navigation_time.sec >= 1:
            break
    feedback = navigator.getFeedback()
    say("feedback", left=feedback.distance_remaining, frame=feedback.current_pose.header.frame_id)
    navigator.cancelTask()
    say("cancelled", **finish(navigator))

    navigator.goToPose(there)
    say("arrived", **finish(navigator), at=feedback_place(navigator))

    navigator.goToPose(make_pose(navigator, 6.5, 1.5))
    first = navigator.result_future
    while not navigator.getFeedback() or navigator.getFeedback().distance_remaining < 3.0:
        navigator.isTaskComplete()
    navigator.goToPose(make_pose(navigator, 3.0, 4.5))
    second = finish(navigator)
    say("preempted", **second, first=first.result().status)

    navigator.goToPose(make_pose(navigator, 4.0, 1.0))
    say("wall", **finish(navigator))

    navigator.goThroughPoses([make_pose(navigator, 4.5, 4.5), make_pose(navigator, 6.0, 4.5)])
    say("through", **finish(navigator))
    here = navigator.getFeedback().current_pose
    navigator.followPath(navigator.smoothPath(navigator.getPath(here, make_pose(navigator, 4.0, 4.5), use_start=True)))
    say("followed", **finish(navigator))
    navigator.spin(spin_dist=1.57)
    say("spun", **finish(navigator), turned=navigator.getFeedback().angular_distance_traveled)
    navigator.backup(backup_dist=0.3, backup_speed=0.2)
    say("backed up", **finish(navigator), driven=navigator.getFeedback().distance_traveled)
    navigator.driveOnHeading(dist=0.3, speed=0.2)
    say("driven", **finish(navigator))

    navigator.clearAllCostmaps()
    costmap, window = navigator.getGlobalCostmap(), navigator.getLocalCostmap()
    say(
        "costmaps",
        cells=len(costmap.data),
        size=costmap.metadata.size_x * costmap.metadata.size_y,
        local=len(window.data),
    )

    say("map", changed=navigator.changeMap("other.yaml"))
    for name, call in (
        ("teleop", navigator.assistedTeleop),
        ("dock", lambda: navigator.dockRobotByID("home")),
        ("waypoints", lambda: navigator.followWaypoints([there])),
    ):
        accepted = call()
        say(name, result=finish(navigator)["result"] if accepted else "REJECTED")
    smoothed = navigator.smoothPath(path)
    say("smooth", poses=0 if smoothed is None else len(smoothed.poses))

    navigator.lifecycleShutdown()
    say("shut down", accepted=bool(navigator.goToPose(there)))
    rclpy.shutdown()


def feedback_place(navigator):
    at = navigator.getFeedback().current_pose.pose.position
    return [at.x, at.y]


main()
