"""The robot of the stand-in: its pose, and its wheels."""

import math

import numpy as np

from support.fake_isaac.refused import Refused
from trundle.geometry import Pose2D, Twist2D, integrate_twist, wrap_angle
from trundle.robots import WheelSpeeds


class Body:
    """The robot: its pose, and its wheels, which follow commands at once."""

    def __init__(self, fake, path, wheel_names):
        pxr = fake.pxr
        self.fake, self.path, self.wheel_names = fake, path, wheel_names
        prims = list(pxr.Usd.PrimRange(fake.stage.GetPrimAtPath(path)))
        self.dofs = [prim.GetName() for prim in prims if prim.IsA(pxr.UsdPhysics.RevoluteJoint)]
        bodies = [prim for prim in prims if prim.HasAPI(pxr.UsdPhysics.RigidBodyAPI)]
        self.reports = self.slow = False
        self.parts = [str(prim.GetPath()) for prim in bodies]
        self.valid = False
        self.place(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        self.angles = self.speeds = self.targets = (0.0, 0.0)

    def start(self):
        # PhysX reads on start which bodies report contacts. usd-core knows the schema by its name alone.
        bodies = [self.fake.stage.GetPrimAtPath(path) for path in self.parts]
        self.reports = all("PhysxContactReportAPI" in prim.GetPrimTypeInfo().GetAppliedAPISchemas() for prim in bodies)
        limits = [prim.GetAttribute("physxRigidBody:maxDepenetrationVelocity").Get() for prim in bodies]
        self.slow = all(limit is not None and limit <= 0.101 for limit in limits)
        self.inside = None  # not known before the first step
        self.valid = True
        self.angles = self.speeds = self.targets = (0.0, 0.0)
        self.motion = Twist2D()

    def place(self, position, orientation):
        if position is not None:
            self.position = [float(part) for part in position]
        if orientation is not None:
            w, x, y, z = (float(part) for part in orientation)
            if abs(w * w + x * x + y * y + z * z - 1.0) > 1e-6:
                raise Refused(f"{orientation} is no rotation")
            self.yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        self.motion = Twist2D()

    def step(self, dt, floor):
        self.speeds = self.targets
        self.motion = self.fake.robot.twist(WheelSpeeds(*self.speeds))
        if self.inside is None:
            self.inside = self.fake.pushes and bool(self.overlaps())
        elif self.inside:
            # PhysX pushes a robot out of a solid as fast as it may; without a limit its pose ends as NaN.
            self.position[0] += -0.1 * dt if self.slow else math.nan
        x, y, yaw = integrate_twist(self.position[0], self.position[1], self.yaw, self.motion.v, self.motion.w, dt)
        self.yaw = wrap_angle(yaw)  # it reports rotations, which have no turns
        self.position = [x, y, 0.0 if floor else self.position[2] - 9.81 * dt]
        # PhysX keeps the angle of a joint without limits within two turns.
        self.angles = tuple(
            math.fmod(angle + speed * dt, 4.0 * math.pi) for angle, speed in zip(self.angles, self.speeds, strict=True)
        )

    def world_pose(self):
        """Of the articulation's root, which lies at `fake.root` in the robot's prim."""
        root = Pose2D(self.position[0], self.position[1], self.yaw) @ self.fake.root
        half = root.yaw / 2.0
        position = np.array([root.x, root.y, self.position[2]], dtype=np.float32)
        return position, np.array([math.cos(half), 0.0, 0.0, math.sin(half)], dtype=np.float32)

    def velocities(self):
        v, w = self.motion.v, self.motion.w
        root = Pose2D(0.0, 0.0, self.yaw) @ self.fake.root
        # Not of the root's origin, but of its centre of mass.
        center = Pose2D(root.x, root.y, root.yaw) @ Pose2D(*self.fake.center[:2])
        linear = [v * math.cos(self.yaw) - w * center.y, v * math.sin(self.yaw) + w * center.x, 0.0]
        return np.array(linear, dtype=np.float32), np.array([0.0, 0.0, w], dtype=np.float32)

    def contacts(self):
        """Wheels on the floor, and what the footprint overlaps: the robot's prim, the other's prim, and where."""
        x, y, z = self.position
        found = [(part, "/World/GroundPlane", (x, y, z)) for part in self.parts if "wheel" in part]
        prims = self.fake.solids[1]
        for contact in self.overlaps():
            prim = prims.get(contact.other, contact.other)
            found.append((self.parts[0], prim, (contact.x, contact.y, z + 0.3)))
        return found

    def overlaps(self):
        """What the footprint overlaps; nothing once the pose is not finite."""
        checker, _ = self.fake.solids
        if checker is None or not np.isfinite(self.position).all():
            return ()
        return checker.find(np.array([Pose2D(self.position[0], self.position[1], self.yaw).as_tuple()]))
