"""Drive a robot of a USD stage in Newton, in its own Python; prints how far it went and turned, as JSON.

python newton_drive.py STAGE LEFT_JOINT RIGHT_JOINT WHEEL_RADIUS TRACK_WIDTH
"""

import json
import math
import sys
import warnings

import newton
import warp
from newton.usd import SchemaResolverNewton, SchemaResolverPhysx

DT = 0.002
SETTLE_S = 0.5
RAMP_S = 1.0


def load(path):
    builder = newton.ModelBuilder()
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    resolvers = [SchemaResolverNewton(), SchemaResolverPhysx()]
    builder.add_usd(path, collapse_fixed_joints=True, schema_resolvers=resolvers)
    # MuJoCo takes the larger friction of two, PhysX here the robot's: with none on the floor, so do both.
    for index, name in enumerate(builder.shape_label):
        if name.endswith("GroundPlane"):
            builder.shape_material_mu[index] = 0.0
    return builder, builder.finalize(device="cpu")


def drive(model, wheels, left, right, seconds):
    """Ramp the wheels up to speeds [rad/s], hold them, and ramp down; ahead [m] and turned [rad], from the start."""
    # Wheels with stiff drives slip while they speed up unless the integrator knows of the drives.
    options = {"integrator": "implicitfast", "cone": "elliptic", "impratio": 10.0}
    solver = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, **options)
    now, after, control = model.state(), model.state(), model.control()
    settle, end = round(SETTLE_S / DT), round((SETTLE_S + seconds + RAMP_S) / DT)
    for step in range(end + settle):
        time = (step - settle) * DT
        part = max(0.0, min(1.0, time / RAMP_S, (seconds + RAMP_S - time) / RAMP_S))
        targets = control.joint_target_qd.numpy().copy()
        targets[wheels[0]], targets[wheels[1]] = part * left, part * right
        control.joint_target_qd.assign(targets)
        if step == settle:
            start = now.body_q.numpy()[0].copy()
        now.clear_forces()
        solver.step(now, after, control, None, DT)
        now, after = after, now
    end_pose = now.body_q.numpy()[0]
    return [float(number) for number in end_pose[:2] - start[:2]] + [yaw(end_pose) - yaw(start)]


def yaw(pose):
    x, y, z, w = pose[3:7]
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def main():
    warp.config.quiet = True
    warnings.simplefilter("ignore")
    path, *joints = sys.argv[1:4]
    radius, track = float(sys.argv[4]), float(sys.argv[5])
    builder, model = load(path)
    starts = model.joint_qd_start.numpy()
    found = [next(i for i, name in enumerate(builder.joint_label) if name.endswith(f"/{joint}")) for joint in joints]
    wheels = [int(starts[index]) for index in found]
    # The ramps together are as long as one second at full speed.
    speed = min(0.5, 3.0 * radius)
    straight = drive(model, wheels, speed / radius, speed / radius, 2.0 / speed)
    turning = 0.5
    wheel = turning * track / (2.0 * radius)
    turn = drive(model, wheels, -wheel, wheel, math.pi / 2.0 / turning)
    friction = {
        name: float(builder.shape_material_mu[index])
        for index, name in enumerate(builder.shape_label)
        if name.endswith(("collider", "GroundPlane"))
    }
    result = {"straight": straight, "turn": turn, "mass": float(model.body_mass.numpy().sum()), "mu": friction}
    sys.stdout.write(f"{json.dumps(result)}\n")


if __name__ == "__main__":
    main()
