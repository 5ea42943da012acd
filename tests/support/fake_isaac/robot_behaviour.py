"""What the robot of the stand-in does: its wheels, poses and velocities, one method for each function."""

import numpy as np

from support.fake_isaac.body import Body
from support.fake_isaac.refused import Refused


class RobotBehaviour:
    """The robot's part of `Behaviour`, which has the stage and the timeline."""

    def do_WheeledRobot_new(self, robot, wheel_dof_names, wheel_dof_indices, usd_path, **places):
        path = places.get("prim_path") or places.get("paths")
        if wheel_dof_names is None and wheel_dof_indices is None:
            raise ValueError("WheeledRobot requires either wheel_dof_names or wheel_dof_indices")
        if self.stage is None or not self.stage.GetPrimAtPath(path):
            raise Refused(f"no prim at {path}")
        self.body = Body(self, path, wheel_dof_names)
        if places.get("positions") is not None:
            self.body.place(places["positions"][0], places["orientations"][0])

    def do_WheeledRobot_dof_names(self, robot):
        return list(self.body.dofs)

    def do_WheeledRobot_num_dof(self, robot):
        return len(self.body.dofs)

    def do_WheeledRobot_get_dof_indices(self, robot, names):
        return self._array([self.body.dofs.index(name) for name in names])

    def do_WheeledRobot_is_physics_tensor_entity_valid(self, robot):
        return self.body.valid

    def do_WheeledRobot_apply_wheel_actions(self, robot, actions=None, velocities=None):
        self._need_playing("driving")
        if self.generation == 5:
            if not isinstance(actions, self.modules["isaacsim.core.utils.types"]["ArticulationAction"]):
                raise Refused(f"5.1 takes an ArticulationAction, not {actions!r}")
            velocities = actions.joint_velocities
        self.body.targets = tuple(float(speed) for speed in velocities)

    def do_ArticulationAction_new(self, action, **fields):
        vars(action).update(fields)

    def do_ArticulationAction_get_length(self, action):
        return None if action.joint_velocities is None else len(action.joint_velocities)

    def do_WheeledRobot_set_world_pose(self, robot, position, orientation):
        self.body.place(position, orientation)

    def do_WheeledRobot_set_world_poses(self, robot, positions, orientations, indices):
        self.body.place(positions[0], orientations[0])

    def do_WheeledRobot_get_world_pose(self, robot):
        self._need_playing("a pose")
        return self.body.world_pose()

    def do_WheeledRobot_get_world_poses(self, robot, indices):
        self._need_playing("a pose")
        return tuple(self._array([part]) for part in self.body.world_pose())

    def do_WheeledRobot_get_linear_velocity(self, robot):
        self._need_playing("a velocity")
        return self.body.velocities()[0]

    def do_WheeledRobot_get_angular_velocity(self, robot):
        self._need_playing("a velocity")
        return self.body.velocities()[1]

    def do_WheeledRobot_get_velocities(self, robot, indices):
        self._need_playing("a velocity")
        return tuple(self._array([part]) for part in self.body.velocities())

    def do_WheeledRobot_get_link_coms(self, robot, indices, link_indices):
        self._need_playing("a centre of mass")
        return tuple(self._array(part) for part in self._centers(link_indices))

    def do_Articulation_new(self, view, prim_paths_expr, reset_xform_properties, **_):
        if not self.stage.GetPrimAtPath(prim_paths_expr) or reset_xform_properties:
            raise Refused(f"a view of {prim_paths_expr} that resets the transforms of the robot, or of no prim")
        self.view_valid = False

    def do_Articulation_initialize(self, view, physics_sim_view):
        self._need_playing("a view")
        self.view_valid = True

    def do_Articulation_get_body_coms(self, view, indices, body_indices, clone):
        self._need_playing("a centre of mass")
        if not self.view_valid:
            raise Refused("the view was not initialized after the last start")
        return self._centers(body_indices)

    def _centers(self, links):
        """Of the root, and made up for every other link: shapes (1, K, 3) and (1, K, 4)."""
        centers = [self.center if link == 0 else (9.0, 9.0, 9.0) for link in (range(3) if links is None else links)]
        return np.array([centers]), np.array([[(1.0, 0.0, 0.0, 0.0)] * len(centers)])

    def do_WheeledRobot_set_linear_velocity(self, robot, velocity):
        self._need_playing("a velocity")

    def do_WheeledRobot_set_angular_velocity(self, robot, velocity):
        self._need_playing("a velocity")

    def do_WheeledRobot_set_velocities(self, robot, linear_velocities, angular_velocities, indices):
        self._need_playing("a velocity")

    def do_WheeledRobot_set_joint_velocities(self, robot, velocities, joint_indices):
        self._need_playing("a velocity")
        if len(velocities) != len(self.body.dofs):
            raise Refused(f"{len(velocities)} velocities for {len(self.body.dofs)} joints")
        self.body.speeds = (0.0, 0.0)

    def do_WheeledRobot_set_dof_velocities(self, robot, velocities, indices, dof_indices):
        self._need_playing("a velocity")
        self.body.speeds = (0.0, 0.0)

    def do_WheeledRobot_get_wheel_positions(self, robot):
        self._need_playing("joints")
        return list(self.body.angles)

    def do_WheeledRobot_get_wheel_velocities(self, robot):
        self._need_playing("joints")
        return list(self.body.speeds)

    def do_WheeledRobot_get_dof_positions(self, robot, indices, dof_indices):
        self._need_playing("joints")
        return self._array([self._of_wheels(self.body.angles, dof_indices)])

    def do_WheeledRobot_get_dof_velocities(self, robot, indices, dof_indices):
        self._need_playing("joints")
        return self._array([self._of_wheels(self.body.speeds, dof_indices)])

    def _of_wheels(self, values, dof_indices):
        by_joint = dict.fromkeys(range(len(self.body.dofs)), 0.0)
        by_joint.update(zip((self.body.dofs.index(name) for name in self.body.wheel_names), values, strict=True))
        return [by_joint[index] for index in dof_indices]

    def _array(self, values):
        array = self._bare("warp", "array")
        array.values = np.asarray(values, dtype=np.int32 if isinstance(values[0], int) else np.float32)
        return array

    def do_array_numpy(self, array):
        return array.values

    def do_DifferentialController_new(self, controller, name="", **settings):
        if any(value < 0 for key, value in settings.items() if key.startswith("max")):
            raise ValueError("limits must be >= 0") if self.generation == 6 else AssertionError
        vars(controller).update(settings)

    def do_DifferentialController_forward(self, controller, command):
        # Both answers that NVIDIA publishes come out of this: clip, convert, clip each wheel.
        v, w = (float(part) for part in command)
        v = min(controller.max_linear_speed, max(-controller.max_linear_speed, v))
        w = min(controller.max_angular_speed, max(-controller.max_angular_speed, w))
        across, twice = w * controller.wheel_base, 2.0 * controller.wheel_radius
        most = controller.max_wheel_speed
        speeds = np.clip(np.array([(2.0 * v - across) / twice, (2.0 * v + across) / twice]), -most, most)
        if self.generation == 6:
            return speeds
        return self.modules["isaacsim.core.utils.types"]["ArticulationAction"](joint_velocities=speeds)
