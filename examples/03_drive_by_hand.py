"""Step 3 of 5: drive it by hand through a differential controller.

You say how fast to go (v, in metres a second) and to turn (w, in radians a second, counter-clockwise); the
differential drive makes wheel speeds of that, and physics makes a motion of those.
"""

import trundle

robot = trundle.Robot.load("nova_carter")
floor = trundle.World(name="floor", solids=())

# What the differential drive does: two wheel speeds [rad/s] for a twist, clipped as Isaac Sim's controller clips.
print("wheel speeds for 0.4 m/s straight on:", robot.wheel_command(trundle.Twist2D(0.4, 0.0)))
print("wheel speeds for turning on the spot:", robot.wheel_command(trundle.Twist2D(0.0, 0.7)))

# One step is one control period. The simulator keeps to the robot's limits in speed and acceleration.
period = 0.05
with trundle.simulate(floor, robot, backend="mujoco") as sim:
    sim.reset(trundle.Pose2D(0.0, 0.0, 0.0))
    for v, w, seconds in [(0.4, 0.0, 5.0), (0.0, 0.7, 3.0), (0.25, -0.5, 4.0)]:
        for _ in range(round(seconds / period)):
            state = sim.step(trundle.Twist2D(v, w), period)
        x, y, yaw = state.pose.as_tuple()
        print(f"after {seconds:g} s of v={v:g}, w={w:g}: x {x:.3f} m, y {y:.3f} m, yaw {yaw:.3f} rad")
