"""A stand-in for `BasicNavigator`: the same calls, which send the same goals and requests in the same order.

It runs in ROS's Python, and is written from Nav2's documentation of its simple commander.
"""

import enum
import time

import rclpy
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, PoseStamped, PoseWithCovarianceStamped
from lifecycle_msgs.srv import GetState
from nav2_msgs import action, srv
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile


class TaskResult(enum.Enum):
    UNKNOWN = 0
    SUCCEEDED = 1
    CANCELED = 2
    FAILED = 3


ACTIONS = {
    "navigate_to_pose": action.NavigateToPose,
    "navigate_through_poses": action.NavigateThroughPoses,
    "follow_waypoints": action.FollowWaypoints,
    "follow_gps_waypoints": action.FollowGPSWaypoints,
    "follow_path": action.FollowPath,
    "compute_path_to_pose": action.ComputePathToPose,
    "compute_path_through_poses": action.ComputePathThroughPoses,
    "smooth_path": action.SmoothPath,
    "spin": action.Spin,
    "backup": action.BackUp,
    "drive_on_heading": action.DriveOnHeading,
    "assisted_teleop": action.AssistedTeleop,
    "dock_robot": action.DockRobot,
    "undock_robot": action.UndockRobot,
}
SERVICES = {
    "map_server/load_map": srv.LoadMap,
    "global_costmap/clear_entirely_global_costmap": srv.ClearEntireCostmap,
    "local_costmap/clear_entirely_local_costmap": srv.ClearEntireCostmap,
    "global_costmap/get_costmap": srv.GetCostmap,
    "local_costmap/get_costmap": srv.GetCostmap,
}


class BasicNavigator(Node):
    def __init__(self, node_name="basic_navigator", namespace=""):
        super().__init__(node_name, namespace=namespace)
        self.initial_pose = PoseStamped()
        self.initial_pose.header.frame_id = "map"
        self.initial_pose_received = False
        self.goal_handle = self.result_future = self.feedback = self.status = None
        self._goals_of = {name: ActionClient(self, kind, name) for name, kind in ACTIONS.items()}
        self._requests_of = {name: self.create_client(kind, name) for name, kind in SERVICES.items()}
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(PoseWithCovarianceStamped, "amcl_pose", self._located, latched)
        self._initial = self.create_publisher(PoseWithCovarianceStamped, "initialpose", 10)

    # Start ------------------------------------------------------------------------------------------------------------

    def setInitialPose(self, initial_pose):
        self.initial_pose_received = False
        self.initial_pose = initial_pose
        self._tell_pose()

    def waitUntilNav2Active(self, navigator="bt_navigator", localizer="amcl"):
        self._wait_for(localizer)
        if localizer == "amcl":
            while not self.initial_pose_received:
                self._tell_pose()
                rclpy.spin_once(self, timeout_sec=1.0)
        self._wait_for(navigator)

    def _wait_for(self, node):
        client = self.create_client(GetState, f"{node}/get_state")
        while not client.wait_for_service(timeout_sec=1.0):
            pass
        while self._call(client, GetState.Request()).current_state.label != "active":
            time.sleep(0.2)

    def _tell_pose(self):
        message = PoseWithCovarianceStamped(header=self.initial_pose.header)
        message.pose.pose = self.initial_pose.pose
        self._initial.publish(message)

    def _located(self, message):
        self.initial_pose_received = True

    # Tasks ------------------------------------------------------------------------------------------------------------

    def goToPose(self, pose, behavior_tree=""):
        return self._send("navigate_to_pose", pose=pose, behavior_tree=behavior_tree)

    def goThroughPoses(self, poses, behavior_tree=""):
        goals = action.NavigateThroughPoses.Goal(behavior_tree=behavior_tree)
        _put(goals, "poses", poses)
        return self._send_goal("navigate_through_poses", goals)

    def followWaypoints(self, poses):
        return self._send("follow_waypoints", poses=poses)

    def followPath(self, path, controller_id="", goal_checker_id=""):
        return self._send("follow_path", path=path, controller_id=controller_id, goal_checker_id=goal_checker_id)

    def spin(self, spin_dist=1.57, time_allowance=10):
        return self._send("spin", target_yaw=spin_dist, time_allowance=Duration(sec=time_allowance))

    def backup(self, backup_dist=0.15, backup_speed=0.025, time_allowance=10):
        target = Point(x=float(backup_dist))
        return self._send("backup", target=target, speed=backup_speed, time_allowance=Duration(sec=time_allowance))

    def driveOnHeading(self, dist=0.15, speed=0.025, time_allowance=10):
        target = Point(x=float(dist))
        return self._send("drive_on_heading", target=target, speed=speed, time_allowance=Duration(sec=time_allowance))

    def assistedTeleop(self, time_allowance=30):
        return self._send("assisted_teleop", time_allowance=Duration(sec=time_allowance))

    def dockRobotByID(self, dock_id, nav_to_dock=True):
        return self._send("dock_robot", use_dock_id=True, dock_id=dock_id, navigate_to_staging_pose=nav_to_dock)

    def cancelTask(self):
        if self.result_future:
            rclpy.spin_until_future_complete(self, self.goal_handle.cancel_goal_async())

    def isTaskComplete(self):
        if not self.result_future:
            return True
        rclpy.spin_until_future_complete(self, self.result_future, timeout_sec=0.1)
        if not self.result_future.result():
            return False
        self.status = self.result_future.result().status
        return True

    def getFeedback(self):
        return self.feedback

    def getResult(self):
        known = {
            GoalStatus.STATUS_SUCCEEDED: TaskResult.SUCCEEDED,
            GoalStatus.STATUS_CANCELED: TaskResult.CANCELED,
            GoalStatus.STATUS_ABORTED: TaskResult.FAILED,
        }
        return known.get(self.status, TaskResult.UNKNOWN)

    # Paths ------------------------------------------------------------------------------------------------------------

    def getPath(self, start, goal, planner_id="", use_start=False):
        wanted = action.ComputePathToPose.Goal(start=start, goal=goal, planner_id=planner_id, use_start=use_start)
        return self._ask("compute_path_to_pose", wanted)

    def getPathThroughPoses(self, start, goals, planner_id="", use_start=False):
        wanted = action.ComputePathThroughPoses.Goal(start=start, planner_id=planner_id, use_start=use_start)
        _put(wanted, "goals", goals)
        return self._ask("compute_path_through_poses", wanted)

    def smoothPath(self, path, smoother_id="", max_duration=2.0, check_for_collision=False):
        return self._ask("smooth_path", action.SmoothPath.Goal(path=path, smoother_id=smoother_id))

    def _ask(self, name, goal):
        if not self._send_goal(name, goal):
            return None
        rclpy.spin_until_future_complete(self, self.result_future)
        answer = self.result_future.result()
        self.status = answer.status
        return answer.result.path if answer.status == GoalStatus.STATUS_SUCCEEDED else None

    # Costmaps, maps and nodes -----------------------------------------------------------------------------------------

    def changeMap(self, map_filepath):
        return self._request("map_server/load_map", srv.LoadMap.Request(map_url=map_filepath)).result == 0

    def clearAllCostmaps(self):
        self.clearLocalCostmap()
        self.clearGlobalCostmap()

    def clearLocalCostmap(self):
        self._request("local_costmap/clear_entirely_local_costmap", srv.ClearEntireCostmap.Request())

    def clearGlobalCostmap(self):
        self._request("global_costmap/clear_entirely_global_costmap", srv.ClearEntireCostmap.Request())

    def getGlobalCostmap(self):
        return self._request("global_costmap/get_costmap", srv.GetCostmap.Request()).map

    def getLocalCostmap(self):
        return self._request("local_costmap/get_costmap", srv.GetCostmap.Request()).map

    def lifecycleStartup(self):
        self._manage(srv.ManageLifecycleNodes.Request.STARTUP)

    def lifecycleShutdown(self):
        self._manage(srv.ManageLifecycleNodes.Request.SHUTDOWN)

    def _manage(self, command):
        for name, kinds in self.get_service_names_and_types():
            if kinds[0] == "nav2_msgs/srv/ManageLifecycleNodes":
                client = self.create_client(srv.ManageLifecycleNodes, name)
                client.wait_for_service()
                self._call(client, srv.ManageLifecycleNodes.Request(command=command))

    # Sending ----------------------------------------------------------------------------------------------------------

    def _send(self, name, **fields):
        return self._send_goal(name, ACTIONS[name].Goal(**fields))

    def _send_goal(self, name, goal):
        client = self._goals_of[name]
        while not client.wait_for_server(timeout_sec=1.0):
            pass
        sent = client.send_goal_async(goal, self._take_feedback)
        rclpy.spin_until_future_complete(self, sent)
        self.goal_handle = sent.result()
        if not self.goal_handle.accepted:
            self.result_future = None
            return False
        self.result_future = self.goal_handle.get_result_async()
        return True

    def _take_feedback(self, message):
        self.feedback = message.feedback

    def _request(self, name, request):
        client = self._requests_of[name]
        while not client.wait_for_service(timeout_sec=1.0):
            pass
        return self._call(client, request)

    def _call(self, client, request):
        future = client.call_async(request)
        rclpy.spin_until_future_complete(self, future)
        return future.result()


def _put(goal, field, poses):
    """Give a goal its poses: a list, or from Kilted on a message with a list."""
    holder = getattr(goal, field)
    if hasattr(holder, "goals"):
        holder.goals = poses
    else:
        setattr(goal, field, poses)
